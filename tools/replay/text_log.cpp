#include "tools/replay/text_log.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <variant>

#include "services/navigator/core/nmea.hpp"
#include "services/navigator/core/sentence.hpp"

namespace lookout::replay {

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
  const auto lines = navigator::SplitDatagram({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()});
  if (lines.lines.empty()) return {};
  const auto parsed = navigator::ParseSentence(lines.lines.front(), false);
  if (parsed.fault != navigator::SentenceFault::kNone) return {};
  return std::visit(
      [](const auto& sentence) {
        SaidTime said;
        if constexpr (requires { sentence.time_of_day; }) said.of_day = sentence.time_of_day;
        if constexpr (requires { sentence.date; }) said.date = sentence.date;
        return said;
      },
      parsed.sentence);
}

// From one time of day to the next a day has gone by.
bool IsOverMidnight(microseconds from, microseconds to) { return from - to > kDay / 2; }

}  // namespace

bool IsTextLog(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file.string() + ": cannot be read");
  constexpr std::size_t kLooked = 4096;
  std::array<char, kLooked> start{};
  in.read(start.data(), start.size());
  const auto end = start.begin() + in.gcount();
  const bool is_text = std::all_of(start.begin(), end, [](char letter) {
    const auto byte = static_cast<unsigned char>(letter);
    return letter == '\n' || letter == '\r' || letter == '\t' || (byte >= 0x20 && byte < 0x7F);
  });
  return is_text && std::any_of(start.begin(), end, [](char letter) { return letter == '$' || letter == '!'; });
}

TextLogReader::TextLogReader(const std::filesystem::path& file) : in_(file, std::ios::binary) {
  if (!in_) throw std::runtime_error(file.string() + ": cannot be read");
  std::optional<microseconds> first;
  std::optional<microseconds> before;
  std::chrono::days num_midnights{0};
  while (!has_date_ && std::getline(in_, line_)) {
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
}

std::optional<TextLogReader::Line> TextLogReader::Next() {
  if (!std::getline(in_, line_)) return std::nullopt;
  position_ += static_cast<std::int64_t>(line_.size()) + 1;
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

}  // namespace lookout::replay
