#include "services/plotter/nmea_output.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "services/plotter/core/nmea0183.hpp"

namespace lookout::plotter {

namespace {

constexpr std::size_t kAmpleRoomBytes = 2000;
constexpr std::size_t kOwnShipBytes = 3 * kMaxSentenceBytes;
constexpr std::chrono::milliseconds kFreshOwnShip(100);
constexpr std::chrono::seconds kSlowRepeat(1);
constexpr std::chrono::milliseconds kRefusalPeriod(100);

}  // namespace

NmeaOutput::NmeaOutput(const OutputParams& params, std::unique_ptr<Link> link, std::chrono::microseconds target_period, RevisionFile revisions)
    : Output(params, std::move(link)), targets_(target_period), revisions_(std::move(revisions)) {
  notices_.Recall(revisions_.Read());
}

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

// ALR has no word for sound, and ALF one for silence.
std::vector<Notice> NmeaOutput::AsTold(const Told& told) const {
  const bool is_alf = params().alerts == SentAlerts::kAlf;
  std::vector<Notice> notices(told.notices.begin(), told.notices.end());
  for (auto& notice : notices) {
    if (!is_alf || notice.sound != Sound::kSilenced) notice.sound = Sound::kQuiet;
    if (is_alf) notice.escalation = EscalationOf(notice);
  }
  return notices;
}

void NmeaOutput::SendNotices(const Told& told) {
  if (params().alerts == SentAlerts::kNone) return;
  constexpr int kSequences = 10;
  for (const auto& [notice, revision, is_repeat] : notices_.Take(AsTold(told), told.passed)) {
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
  if (params().alerts == SentAlerts::kAlf) SendList(told);
}

void NmeaOutput::SendList(const Told& told) {
  constexpr int kHeartbeats = 10;
  constexpr int kLists = 100;
  const auto standing = notices_.Standing();
  revisions_.Write(notices_.Kept());
  const bool is_well = std::ranges::none_of(told.notices, [](const Notice& notice) {
    return notice.cause == Cause::kWatch && (notice.state == NoticeState::kActive || notice.state == NoticeState::kAcknowledged);
  });
  if (list_sent_ && told.passed - *list_sent_ < kListPeriod && is_well == told_well_) return;
  told_well_ = is_well;
  SendSurely(Hbt(params().target_talker, kListPeriod, is_well, heartbeat_sequence_), "HBT");
  // Each sentence by itself: a slow port has no room for all at once.
  const auto list = Alc(params().target_talker, standing, list_sequence_);
  DropWaiting("ALC ");  // of the list before, which may have been longer
  for (std::size_t begin = 0, number = 1; begin < list.size(); ++number) {
    const auto end = list.find('\n', begin) + 1;
    SendSurely(list.substr(begin, end - begin), "ALC " + std::to_string(number));
    begin = end;
  }
  list_sent_ = told.passed;
  heartbeat_sequence_ = (heartbeat_sequence_ + 1) % kHeartbeats;
  list_sequence_ = (list_sequence_ + 1) % kLists;
}

void NmeaOutput::SendAnew() {
  targets_.Forget();
  notices_.SendAnew();
  list_sent_.reset();
}

Commands NmeaOutput::Read(const std::string& message, const Told& told) {
  AlertCommand command;
  const auto kind = ReadLine(message, command);
  if (kind == LineKind::kWrong) CountRefused();
  // A command counts only in the kind of sentence by which this output tells alerts.
  if (kind != LineKind::kCommand || params().alerts != (command.is_alarm_number ? SentAlerts::kAlr : SentAlerts::kAlf)) return {};
  return Obey(command, told);
}

Commands NmeaOutput::Obey(const AlertCommand& command, const Told& told) {
  // Where two notices have the number, the one raised later is meant.
  const auto notices = AsTold(told);
  const Notice* meant = nullptr;
  for (const auto& notice : notices) {
    if (notice.id != 0 && Means(command, notice) && (meant == nullptr || meant->raised < notice.raised)) meant = &notice;
  }
  Commands commands;
  if (command.is_alarm_number) {
    if (meant != nullptr) commands.acknowledged = {KeyOf(*meant)};
    return commands;
  }
  const char state = meant == nullptr ? 'N' : AlfStateOf(*meant);
  if (command.kind == AlertCommand::Kind::kTellAgain && state != 'N') {
    notices_.TellAgain(*meant);
  } else if (command.kind == AlertCommand::Kind::kAcknowledge && params().takes_acknowledgements && (state == 'V' || state == 'S' || state == 'U')) {
    commands.acknowledged = {KeyOf(*meant)};
  } else if (command.kind == AlertCommand::Kind::kSilence && params().takes_acknowledgements && (state == 'V' || state == 'S') && meant->id > 0) {
    commands.silences = true;
  } else {
    Refuse(command, told);
  }
  return commands;
}

void NmeaOutput::Refuse(const AlertCommand& command, const Told& told) {
  if (refused_ && told.passed - *refused_ < kRefusalPeriod) return;
  refused_ = told.passed;
  Send(Arc(params().target_talker, command, told.host_time));
}

}  // namespace lookout::plotter
