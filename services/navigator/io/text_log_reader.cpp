#include "services/navigator/io/text_log_reader.hpp"

#include <algorithm>
#include <stdexcept>

#include "services/navigator/core/lines.hpp"
#include "services/navigator/core/nmea.hpp"

namespace lookout::navigator {

namespace {

using std::chrono::microseconds;
using std::chrono::sys_days;

constexpr microseconds kDay = std::chrono::days(1);

struct SaidTime {
  std::optional<microseconds> of_day;
  std::optional<sys_days> date;
};

// A damaged sentence tells no time: a wrong one would move all that follow.
SaidTime TimeIn(const std::string& line) {
  const auto lines = SplitDatagram({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()});
  if (lines.lines.empty()) return {};
  const auto parsed = ParseSentence(lines.lines.front(), false);
  if (parsed.fault != SentenceFault::kNone) return {};
  return {parsed.sentence.time_of_day, parsed.sentence.date};
}

bool IsLineEnd(char letter) { return letter == '\n' || letter == '\r'; }

bool IsText(char letter) { return IsLineEnd(letter) || letter == '\t' || (letter >= 0x20 && letter < 0x7F); }

// Talker and type: GPRMC, PASHR, 04HDM.
bool IsAddress(std::string_view address) {
  constexpr std::size_t kMinLetters = 3;
  constexpr std::size_t kMaxLetters = 10;
  return address.size() >= kMinLetters && address.size() <= kMaxLetters &&
         std::ranges::all_of(address, [](char letter) { return (letter >= 'A' && letter <= 'Z') || (letter >= '0' && letter <= '9'); });
}

// From one time of day to the next a day has gone by.
bool IsOverMidnight(microseconds from, microseconds to) { return from - to > kDay / 2; }

}  // namespace

bool IsTextLog(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file.string() + ": cannot be read");
  constexpr std::size_t kLooked = 1024UL * 1024;
  // A file system that lost its power leaves blocks of zeros.
  while (in.peek() == 0) in.get();
  std::string start(kLooked, '\0');
  in.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(in.gcount()));
  // Of ten bytes: less than this is another kind of file, in which a $ may stand anywhere.
  constexpr std::ptrdiff_t kMinTextOfTen = 9;
  const bool is_text = 10 * std::ranges::count_if(start, IsText) >= kMinTextOfTen * static_cast<std::ptrdiff_t>(start.size());
  const auto lines = SplitDatagram({reinterpret_cast<const std::uint8_t*>(start.data()), start.size()});
  return std::ranges::any_of(lines.lines, [is_text](const std::string& line) {
    const auto comma = line.find(',');
    const bool begins_as_one = comma != std::string::npos && IsAddress(std::string_view(line).substr(1, comma - 1));
    return begins_as_one && (is_text || Frame(line).fault == SentenceFault::kNone);
  });
}

TextLogReader::TextLogReader(const std::filesystem::path& file, std::optional<sys_days> day) : in_(file, std::ios::binary) {
  if (!in_) throw std::runtime_error(file.string() + ": cannot be read");
  std::optional<microseconds> first;
  std::optional<microseconds> before;
  std::chrono::days num_midnights{0};
  if (day) day_ = *day;
  while (!has_date_ && ReadLine()) {
    const auto said = TimeIn(line_);
    if (!said.of_day) continue;
    if (!first) first = said.of_day;
    if (before && IsOverMidnight(*before, *said.of_day)) ++num_midnights;
    before = said.of_day;
    if (!said.date) continue;
    day_ = *said.date - num_midnights;
    has_date_ = true;
  }
  if (!first) throw std::runtime_error(file.string() + ": no sentence in it tells a time");
  last_ = day_ + *first;
  in_.clear();
  in_.seekg(0);
  position_ = 0;
}

// Sets line_ to the next that is not empty.
bool TextLogReader::ReadLine() {
  line_.clear();
  for (char letter = 0; in_.get(letter);) {
    ++position_;
    if (!IsLineEnd(letter)) {
      // No sentence is so long: what goes is binary, and a sentence may stand behind it.
      if (line_.size() == kMaxLineBytes) line_.erase(0, kMaxLineBytes / 2);
      line_ += letter;
    } else if (!line_.empty()) {
      return true;
    }
  }
  return !line_.empty();
}

std::optional<TextLogReader::Line> TextLogReader::Next() {
  if (!ReadLine()) return std::nullopt;
  const auto said = TimeIn(line_);
  // Just after midnight one of the day before may still come.
  const auto of_yesterday = said.of_day ? Utime(day_ - std::chrono::days(1) + *said.of_day) : Utime{};
  const bool is_late = of_day_ && of_yesterday <= last_ && last_ - of_yesterday <= kMaxLate;
  if (said.of_day && !is_late) {
    if (of_day_ && IsOverMidnight(*of_day_, *said.of_day)) day_ += std::chrono::days(1);
    // Forward only: of two receivers that tell different years (a week number that wrapped) the later one counts, and the log does not leap to and
    // fro.
    if (said.date && *said.date > day_) day_ = *said.date;
    of_day_ = said.of_day;
    const Utime time = day_ + *said.of_day;
    if (time >= last_ || last_ - time > kMaxLate) last_ = time;
  }
  return Line{last_, {reinterpret_cast<const std::uint8_t*>(line_.data()), line_.size()}};
}

}  // namespace lookout::navigator
