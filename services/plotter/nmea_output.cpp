#include "services/plotter/nmea_output.hpp"

#include <algorithm>

#include "services/plotter/core/nmea0183.hpp"

namespace lookout::plotter {

namespace {

constexpr std::size_t kAmpleRoomBytes = 2000;
constexpr std::size_t kOwnShipBytes = 3 * kMaxSentenceBytes;
constexpr std::chrono::milliseconds kFreshOwnShip(100);
constexpr std::chrono::seconds kSlowRepeat(1);

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

void NmeaOutput::SendEnded(const Told& told, std::span<const Target> targets) {
  for (auto& ended : targets_.TakeEnded(targets)) SendSurely(Line(told, EndedAt(ended, told.own.time), ended.number));
}

void NmeaOutput::SendTargets(const Told& told) {
  if (params().targets == SentTargets::kNone) return;
  SendEnded(told, told.targets);
  const auto due = targets_.Due(told.targets, told.passed);
  // A plotter draws TTM beside the position that it had last: where there is room, that is one of now.
  const bool has_room = room_bytes() >= std::min(kAmpleRoomBytes, kOwnShipBytes + due.size() * kMaxSentenceBytes);
  if (!due.empty() && has_room && (!own_ship_sent_ || told.passed - *own_ship_sent_ >= kFreshOwnShip)) SendOwnShip(told);
  for (const auto* target : due) {
    const auto number = told.numbers.Of(target->id);
    if (!number) continue;
    if (!Send(Line(told, *target, *number))) return;
    targets_.NoteSent(*target, told.own.time, *number, told.passed);
  }
}

void NmeaOutput::FinishTargets(const Told& told) {
  if (params().targets != SentTargets::kNone && told.own.is_placed()) SendEnded(told, {});
}

void NmeaOutput::SendNotices(const Told& told) {
  if (params().alerts == SentAlerts::kNone) return;
  constexpr int kSequences = 10;
  // ALR has no word for sound, and ALF one for silence.
  std::vector<Notice> notices(told.notices.begin(), told.notices.end());
  for (auto& notice : notices) {
    const bool is_said = params().alerts == SentAlerts::kAlf && notice.sound == Sound::kSilenced;
    if (!is_said) notice.sound = Sound::kQuiet;
  }
  for (const auto& [notice, revision, is_repeat] : notices_.Take(notices, told.passed)) {
    // Repeats give way to all else, and on a slow port one of them a second is enough.
    if (is_repeat && room_bytes() < kAmpleRoomBytes && repeat_sent_ && told.passed - *repeat_sent_ < kSlowRepeat) continue;
    std::string lines;
    if (params().alerts == SentAlerts::kAlr) {
      lines = Alr(params().target_talker, notice, notice.changed);
    } else {
      lines = Alf(params().target_talker, notice, notice.changed, sequence_, revision);
      sequence_ = (sequence_ + 1) % kSequences;
    }
    if (is_repeat) {
      if (Send(lines)) repeat_sent_ = told.passed;
    } else {
      SendSurely(lines, SubjectOf(notice));
    }
  }
}

void NmeaOutput::SendAnew() {
  targets_.Forget();
  notices_.SendAnew();
}

std::vector<std::int64_t> NmeaOutput::Read(const std::string& message, const Told& told) {
  AcknowledgedNumber acknowledged;
  const auto kind = ReadLine(message, acknowledged);
  if (kind == LineKind::kWrong) CountRefused();
  if (kind != LineKind::kAcknowledgement) return {};
  // In the words in which this output was told of alerts; of two of one number the later.
  if (params().alerts != (acknowledged.is_alarm_number ? SentAlerts::kAlr : SentAlerts::kAlf)) return {};
  const Notice* meant = nullptr;
  for (const auto& notice : told.notices) {
    if (notice.id != 0 && Means(acknowledged, notice) && (meant == nullptr || meant->raised < notice.raised)) meant = &notice;
  }
  return meant == nullptr ? std::vector<std::int64_t>{} : std::vector{KeyOf(*meant)};
}

}  // namespace lookout::plotter
