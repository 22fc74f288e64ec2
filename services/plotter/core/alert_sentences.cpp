#include "services/plotter/core/alert_sentences.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "common/core/sentence.hpp"
#include "services/plotter/core/nmea0183.hpp"

namespace lookout::plotter {

namespace {

// Maker and first identifier of this project's alerts in ALF and ACN: identifiers from 10000 on are free for makers, who name themselves by three
// letters.
constexpr std::string_view kMaker = "LKO";
constexpr int kFirstIdentifier = 10000;
constexpr std::int64_t kMostInstance = 999'999;

// The text of an alert within a sentence: all of it where it fits; else in short words, first those that cost least; else up to the end of a word,
// since who, where and how far stand first.
std::string AlertWithin(std::string text, std::size_t max_bytes) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kShort{{{" in the guard zone", " in zone"},
                                                                                 {"closest approach", "CPA"},
                                                                                 {" deg to starboard", " deg stbd"},
                                                                                 {" deg to port", " deg port"},
                                                                                 {", ", " "}}};
  for (const auto& [words, shorter] : kShort) {
    for (auto place = text.find(words); text.size() > max_bytes && place != std::string::npos; place = text.find(words)) {
      text.replace(place, words.size(), shorter);
    }
  }
  if (text.size() > max_bytes) {
    const auto end_of_word = text.rfind(' ', max_bytes);
    text.resize(end_of_word == std::string::npos || end_of_word == 0 ? max_bytes : end_of_word);
    while (!text.empty() && std::string_view(" ,;:-").find(text.back()) != std::string_view::npos) text.pop_back();
  }
  return FieldText(text, max_bytes);
}

// The cause that weighs most may change while one thing stays dangerous: a receiver that was told of it by one identifier must be told of its end by
// the same.
int IdentifierOf(Cause cause) { return kFirstIdentifier + static_cast<int>(cause == Cause::kGuardZone ? Cause::kClosestApproach : cause); }

// 1 to 999998; the watch's ids run from -1 down. 999999 is the plotter's own, of which there is one of a cause.
std::int64_t InstanceOf(const Notice& notice) { return notice.id == 0 ? kMostInstance : (std::abs(notice.id) - 1) % (kMostInstance - 1) + 1; }

std::string_view TitleOf(Cause cause) {
  switch (cause) {
    case Cause::kGuardZone:
    case Cause::kClosestApproach:
      return "CLOSE APPROACH";
    case Cause::kPosition:
      return "NO OWN POSITION";
    case Cause::kPartUnseen:
      return "LOOK-OUT GAP";
    default:
      return "NO LOOK-OUT";
  }
}

}  // namespace

int AlarmNumber(const Notice& notice) {
  constexpr std::int64_t kMost = 997;
  constexpr int kOwnWatch = 998;
  constexpr int kOwnPosition = 999;
  if (notice.id == 0) return notice.cause == Cause::kPosition ? kOwnPosition : kOwnWatch;
  return notice.id < 0 ? 0 : static_cast<int>((notice.id - 1) % kMost + 1);
}

std::string Alr(std::string_view talker, const Notice& notice, Utime time) {
  const bool holds = notice.state == NoticeState::kActive || notice.state == NoticeState::kAcknowledged;
  const bool is_acknowledged = notice.state == NoticeState::kAcknowledged || notice.state == NoticeState::kCleared;
  const auto before =
      fmt::format("{}ALR,{},{:03},{},{},", talker, TimeOfDay(time), AlarmNumber(notice), holds ? 'A' : 'V', is_acknowledged ? 'A' : 'V');
  return Sentence(before + AlertWithin(notice.text, RoomFor(before, "")));
}

char AlfStateOf(const Notice& notice) {
  switch (notice.state) {
    case NoticeState::kActive:
      return notice.level == Level::kCaution ? 'A' : notice.sound == Sound::kSilenced ? 'S' : 'V';
    case NoticeState::kAcknowledged:
      return 'A';
    case NoticeState::kRectified:
      return 'U';
    default:
      return 'N';
  }
}

std::string Alf(std::string_view talker, const Notice& notice, Utime time, int sequence, int revision) {
  const auto title =
      fmt::format("{}ALF,2,1,{},{},B,{},{},{},{},{},{},{},{}", talker, sequence, TimeOfDay(time), notice.level == Level::kCaution ? 'C' : 'W',
                  AlfStateOf(notice), kMaker, IdentifierOf(notice.cause), InstanceOf(notice), revision, notice.escalation, TitleOf(notice.cause));
  const auto before = fmt::format("{}ALF,2,2,{},,,,,,,,,,", talker, sequence);
  return Sentence(title) + Sentence(before + AlertWithin(notice.text, RoomFor(before, "")));
}

std::string Alc(std::string_view talker, std::span<const ToldNotice> notices, int sequence) {
  constexpr std::size_t kMostSentences = 99;
  const auto head = [talker, sequence](std::size_t num_sentences, std::size_t number, std::size_t num_entries) {
    return fmt::format("{}ALC,{:02},{:02},{:02},{}", talker, num_sentences, number, sequence, num_entries);
  };
  const auto room = RoomFor(head(kMostSentences, kMostSentences, 9), "");
  std::vector<std::pair<std::string, std::size_t>> lists(1);  // entries of each sentence, and how many
  for (const auto& [notice, revision] : notices) {
    const auto entry = fmt::format(",{},{},{},{}", kMaker, IdentifierOf(notice.cause), InstanceOf(notice), revision);
    if (lists.back().first.size() + entry.size() > room) {
      if (lists.size() == kMostSentences) break;
      lists.emplace_back();
    }
    lists.back().first += entry;
    ++lists.back().second;
  }
  std::string lines;
  for (std::size_t i = 0; i < lists.size(); ++i) lines += Sentence(head(lists.size(), i + 1, lists[i].second) + lists[i].first);
  return lines;
}

std::string Hbt(std::string_view talker, std::chrono::seconds period, bool is_well, int sequence) {
  return Sentence(fmt::format("{}HBT,{},{},{}", talker, period.count(), is_well ? 'A' : 'V', sequence));
}

std::string Arc(std::string_view talker, const AlertCommand& command, Utime time) {
  return Sentence(
      fmt::format("{}ARC,{},{},{},{},{}", talker, TimeOfDay(time), kMaker, command.identifier, command.number, static_cast<char>(command.kind)));
}

LineKind ReadLine(std::string_view line, AlertCommand& command) {
  constexpr std::size_t kTalkerBytes = 2;
  const auto framed = Frame(line);
  if (framed.fault != SentenceFault::kNone) return LineKind::kWrong;
  const auto address = framed.sentence.address;
  const auto type = address.size() > kTalkerBytes ? address.substr(kTalkerBytes) : std::string_view();
  FieldReader fields(framed.sentence.fields);
  command = {};
  if (type == "ACK") {
    command.is_alarm_number = true;
    command.number = fields.Count(0, 999);
    return fields.fault() == SentenceFault::kNone && command.number >= 0 ? LineKind::kCommand : LineKind::kWrong;
  }
  if (type != "ACN") return LineKind::kOther;
  // hhmmss.ss, maker, identifier, instance, command, status C.
  const auto maker = fields.Text(1);
  command.identifier = fields.Count(2, 9'999'999);
  command.number = fields.Count(3, static_cast<int>(kMostInstance));
  const auto kind = fields.Letter(4, "AQOS");
  const auto status = fields.Letter(5, "C");
  if (fields.fault() != SentenceFault::kNone || command.identifier < 0 || command.number < 0 || kind == '\0' || status == '\0')
    return LineKind::kWrong;
  command.kind = static_cast<AlertCommand::Kind>(kind);
  return maker == kMaker ? LineKind::kCommand : LineKind::kOther;
}

bool Means(const AlertCommand& command, const Notice& notice) {
  if (command.is_alarm_number) return command.number == AlarmNumber(notice);
  return command.identifier == IdentifierOf(notice.cause) && command.number == InstanceOf(notice);
}

}  // namespace lookout::plotter
