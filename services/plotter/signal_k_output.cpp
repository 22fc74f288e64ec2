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
  for (const auto& [notice, revision] : notices_.Take(told.notices, told.passed)) {
    const auto key = KeyOf(notice);
    const auto [raised, is_new] = raised_.try_emplace(key, Raised{NoticeWord(notice), notice});
    const Notice& last = raised->second.notice;
    const bool is_raised_again = !is_new && notice.state == NoticeState::kActive &&
                                 (last.state == NoticeState::kAcknowledged || notice.level > last.level || notice.raised != last.raised);
    if (is_raised_again) {
      auto ended = last;
      ended.state = NoticeState::kCleared;
      SendSurely(NoticeDelta(ended, raised->second.word, told.host_time));
      raised->second.word = NoticeWord(notice);
    }
    raised->second.notice = notice;
    SendSurely(NoticeDelta(notice, raised->second.word, told.host_time));
    if (notice.state == NoticeState::kCleared) raised_.erase(raised);
  }
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
    const auto raised = raised_.find(KeyOf(notice));
    // What was told as acknowledged or as over went out without sound, and comes back so.
    if (notice.id == 0 || raised == raised_.end() || raised->second.notice.state != notice.state) continue;
    const bool is_active = notice.state == NoticeState::kActive;
    if (!is_active && notice.state != NoticeState::kRectified) continue;
    const bool is_acknowledged = std::ranges::any_of(read.echoes, [&](const NoticeEcho& echo) {
      return echo.word == raised->second.word && (echo.is_acknowledged || (is_active && echo.is_quiet));
    });
    if (is_acknowledged) keys.push_back(raised->first);
  }
  return keys;
}

}  // namespace lookout::plotter
