#include "services/plotter/nmea_output.hpp"

#include "services/plotter/core/nmea0183.hpp"

namespace lookout::plotter {

namespace {

constexpr std::size_t kAmpleRoomBytes = 2000;
constexpr std::chrono::milliseconds kFreshOwnShip(100);

}  // namespace

void NmeaOutput::SendOwnShip(const Told& told) {
  own_ship_sent_ = told.passed;
  if (params().sends_own_ship) {
    Send(Rmc(params().own_ship_talker, told.own));
    if (const auto heading = Hdt(params().own_ship_talker, told.own)) Send(*heading);
  }
  if (params().targets == SentTargets::kTtm) Send(Osd(params().target_talker, told.own, params().unit));
}

std::string NmeaOutput::Line(const Told& told, const Target& target, int number) const {
  if (params().targets == SentTargets::kTll) return Tll(params().target_talker, target, number, told.own.time);
  return Ttm(params().target_talker, told.own, target, number, params().unit);
}

void NmeaOutput::SendTargets(const Told& told) {
  if (params().targets == SentTargets::kNone) return;
  for (const auto& ended : targets_.TakeEnded(told.targets)) SendSurely(Line(told, ended.target, ended.number));
  const auto due = targets_.Due(told.targets, told.passed);
  // A plotter draws TTM beside the position that it had last: where there is room, that is one of now.
  const bool has_room = link().room_bytes() >= kAmpleRoomBytes;
  if (!due.empty() && has_room && (!own_ship_sent_ || told.passed - *own_ship_sent_ >= kFreshOwnShip)) SendOwnShip(told);
  for (const auto* target : due) {
    const auto number = told.numbers.Of(target->id);
    if (!number) continue;
    if (!Send(Line(told, *target, *number))) return;
    targets_.NoteSent(*target, *number, told.passed);
  }
}

void NmeaOutput::SendNotices(const Told& told) {
  if (params().alerts == SentAlerts::kNone) return;
  constexpr int kSequences = 10;
  for (const auto& [notice, revision] : notices_.Take(told.notices, told.passed)) {
    if (params().alerts == SentAlerts::kAlr) {
      SendSurely(Alr(params().target_talker, notice, notice.changed));
    } else {
      SendSurely(Alf(params().target_talker, notice, notice.changed, sequence_, revision));
      sequence_ = (sequence_ + 1) % kSequences;
    }
  }
}

void NmeaOutput::SendAnew() {
  targets_.SendAnew();
  notices_.SendAnew();
}

std::vector<std::int64_t> NmeaOutput::Read(const std::string& message, const Told& told) {
  AcknowledgedNumber acknowledged;
  const auto kind = ReadLine(message, acknowledged);
  if (kind == LineKind::kWrong) CountRefused();
  std::vector<std::int64_t> keys;
  if (kind != LineKind::kAcknowledgement) return keys;
  for (const auto& notice : told.notices) {
    if (notice.id != 0 && Means(acknowledged, notice)) keys.push_back(KeyOf(notice));
  }
  return keys;
}

}  // namespace lookout::plotter
