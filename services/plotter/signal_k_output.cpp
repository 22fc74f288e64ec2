#include "services/plotter/signal_k_output.hpp"

#include <algorithm>
#include <utility>

#include "services/plotter/core/signal_k.hpp"

namespace lookout::plotter {

SignalKOutput::SignalKOutput(const OutputParams& params, std::unique_ptr<Link> link, const std::string& boat)
    : Output(params, std::move(link)), boat_(BoatWord(boat)) {}

void SignalKOutput::SendOwnShip(const Told& told) {
  if (params().sends_own_ship) Send(OwnShipDelta(told.own));
}

void SignalKOutput::SendTargets(const Told& told) {
  for (const auto& ended : targets_.TakeEnded(told.targets)) SendSurely(TargetEndDelta(boat_, ended.target.id, told.own.time));
  for (const auto* target : targets_.Due(told.targets, told.passed)) {
    if (!Send(TargetDelta(boat_, *target, told.own.time))) return;
    targets_.NoteSent(*target, -1, told.passed);
  }
}

// A server shows the last values until it is told otherwise.
void SignalKOutput::EndTargets(const Told& told) {
  for (const auto& ended : targets_.TakeEnded({})) SendSurely(TargetEndDelta(boat_, ended.target.id, told.own.time));
}

void SignalKOutput::SendNotices(const Told& told) {
  for (const auto& due : notices_.Take(told.notices, told.passed)) SendSurely(NoticeDelta(due.notice, told.host_time));
}

void SignalKOutput::SendAnew() {
  targets_.SendAnew();
  notices_.SendAnew();
  if (params().takes_acknowledgements) Send(NoticeSubscription());
}

std::vector<std::int64_t> SignalKOutput::Read(const std::string& message, const Told& told) {
  const auto read = ReadDelta(message);
  if (read.is_wrong) CountRefused();
  std::vector<std::int64_t> keys;
  for (const auto& notice : told.notices) {
    const bool is_open = notice.state == NoticeState::kActive || notice.state == NoticeState::kRectified;
    if (notice.id != 0 && is_open && std::ranges::find(read.words, NoticeWord(notice)) != read.words.end()) keys.push_back(KeyOf(notice));
  }
  return keys;
}

}  // namespace lookout::plotter
