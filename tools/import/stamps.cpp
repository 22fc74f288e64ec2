#include "tools/import/stamps.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <utility>

namespace lookout::importer {

namespace {

constexpr std::int64_t kStampNsPerS = 1'000'000'000;
constexpr std::int64_t kMaxStampNs = 4'102'444'800 * kStampNsPerS;  // the year 2100
constexpr std::size_t kFractionDigits = 9;

bool IsDigit(char letter) { return letter >= '0' && letter <= '9'; }
bool AreDigits(std::string_view text) { return !text.empty() && std::ranges::all_of(text, IsDigit); }

std::string_view Trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const auto begin = text.find_first_not_of(kBlanks);
  return begin == std::string_view::npos ? std::string_view{} : text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

// Precondition: digits, at most 18.
std::int64_t WholeOf(std::string_view digits) {
  std::int64_t value = 0;
  for (const char digit : digits) value = 10 * value + (digit - '0');
  return value;
}

// Nanoseconds of the digits behind a point: ".5" of seconds is 500 000 000 of unit_ns = 1e9.
std::int64_t FractionNs(std::string_view digits, std::int64_t unit_ns) {
  std::int64_t place_ns = unit_ns;
  std::int64_t sum_ns = 0;
  for (const char digit : digits.substr(0, kFractionDigits)) {
    place_ns /= 10;
    sum_ns += (digit - '0') * place_ns;
  }
  return sum_ns;
}

std::int64_t UnitNsOf(double value) {
  constexpr double kLeastNs = 1e17;
  constexpr double kLeastUs = 1e14;
  constexpr double kLeastMs = 1e11;
  return value >= kLeastNs ? 1 : value >= kLeastUs ? 1'000 : value >= kLeastMs ? 1'000'000 : kStampNsPerS;
}

std::optional<Stamp> ToStamp(std::int64_t time_ns) {
  constexpr std::int64_t kLeastDatedNs = 100'000'000 * kStampNsPerS;
  if (time_ns < 0 || time_ns > kMaxStampNs) return std::nullopt;
  return Stamp{time_ns, time_ns >= kLeastDatedNs, false};
}

std::optional<Stamp> StampOfNumber(std::string_view text) {
  constexpr std::size_t kMostDigits = 18;
  constexpr std::size_t kNsDigits = 19;  // of now
  const auto point = text.find('.');
  const auto whole = text.substr(0, point);
  const auto fraction = point == std::string_view::npos ? std::string_view{} : text.substr(point + 1);
  if (AreDigits(whole) && (fraction.empty() || AreDigits(fraction))) {
    if (whole.size() == kNsDigits) {
      std::int64_t time_ns = 0;
      const auto [end, fault] = std::from_chars(whole.data(), whole.data() + whole.size(), time_ns);
      return fault == std::errc() ? ToStamp(time_ns) : std::nullopt;
    }
    if (whole.size() > kMostDigits) return std::nullopt;
    const auto value = WholeOf(whole);
    const auto unit_ns = UnitNsOf(static_cast<double>(value));
    std::int64_t time_ns = 0;
    if (__builtin_mul_overflow(value, unit_ns, &time_ns)) return std::nullopt;
    return ToStamp(time_ns + FractionNs(fraction, unit_ns));
  }
  if (text.empty() || !IsDigit(text.front())) return std::nullopt;  // "nan", "inf"
  double value = 0.0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (fault != std::errc() || end != text.data() + text.size()) return std::nullopt;
  const double time_ns = value * static_cast<double>(UnitNsOf(value));
  if (!(time_ns <= static_cast<double>(kMaxStampNs))) return std::nullopt;
  return ToStamp(std::llround(time_ns));
}

// yyyy-mm-dd hh:mm:ss[.fraction][Z], with any letter that is no digit between.
std::optional<Stamp> StampOfDate(std::string_view text) {
  constexpr std::size_t kDateCharacters = 19;
  if (text.size() < kDateCharacters) return std::nullopt;
  for (std::size_t i = 0; i < kDateCharacters; ++i) {
    const bool is_between = i == 4 || i == 7 || i == 10 || i == 13 || i == 16;
    if (is_between == IsDigit(text[i])) return std::nullopt;
  }
  auto rest = text.substr(kDateCharacters);
  const bool has_zone = rest.ends_with('Z');
  if (has_zone) rest.remove_suffix(1);
  if (!rest.empty() && (rest.size() < 2 || IsDigit(rest.front()) || !AreDigits(rest.substr(1)))) return std::nullopt;
  const auto number = [&](std::size_t at, std::size_t count) { return WholeOf(text.substr(at, count)); };
  const std::chrono::year_month_day date(std::chrono::year(static_cast<int>(number(0, 4))), std::chrono::month(static_cast<unsigned>(number(5, 2))),
                                         std::chrono::day(static_cast<unsigned>(number(8, 2))));
  constexpr std::int64_t kLastHour = 23;
  constexpr std::int64_t kLastMinute = 59;
  constexpr std::int64_t kLeapSecond = 60;
  if (!date.ok() || number(11, 2) > kLastHour || number(14, 2) > kLastMinute || number(17, 2) > kLeapSecond) return std::nullopt;
  constexpr std::int64_t kFirstYear = 1970;
  constexpr std::int64_t kLastYear = 2099;
  if (number(0, 4) < kFirstYear || number(0, 4) > kLastYear) return std::nullopt;
  const auto day_s = std::chrono::duration_cast<std::chrono::seconds>(std::chrono::sys_days(date).time_since_epoch()).count();
  const auto time_s = day_s + (number(11, 2) * 60 + number(14, 2)) * 60 + number(17, 2);
  return Stamp{time_s * kStampNsPerS + (rest.empty() ? 0 : FractionNs(rest.substr(1), kStampNsPerS)), true, !has_zone};
}

bool IsWordEnd(char letter) { return letter == ' ' || letter == '\t' || letter == ',' || letter == ';' || letter == '\r'; }

std::vector<std::string_view> WordsOf(std::string_view line) {
  std::vector<std::string_view> words;
  constexpr std::size_t kMostWords = 64;
  for (auto at = line.begin(); at != line.end() && words.size() < kMostWords;) {
    at = std::find_if_not(at, line.end(), IsWordEnd);
    const auto end = std::find_if(at, line.end(), IsWordEnd);
    if (at != end) words.emplace_back(at, end);
    at = end;
  }
  return words;
}

// "velodyne/000012.bin" -> "000012"
std::string StemOf(std::string_view name) {
  name = name.substr(name.find_last_of('/') + 1);  // npos + 1 is 0
  for (const std::string_view extension : {".bin", ".pcd"}) {
    if (name.ends_with(extension)) name.remove_suffix(extension.size());
  }
  return std::string(name);
}

}  // namespace

std::optional<Stamp> ParseStamp(std::string_view text) {
  text = Trimmed(text);
  const auto stamp = StampOfNumber(text);
  return stamp ? stamp : StampOfDate(text);
}

std::optional<Stamp> StampOfName(std::string_view stem) {
  const auto dated = [](std::optional<Stamp> stamp) { return stamp && stamp->is_dated ? stamp : std::nullopt; };
  if (const auto stamp = dated(ParseStamp(stem))) return stamp;
  const auto last = stem.find_last_of("-_");
  if (last == std::string_view::npos) return std::nullopt;
  const auto tail = stem.substr(last + 1);
  if (const auto stamp = dated(ParseStamp(tail))) {
    // The last of two numbers in a row is a fraction of a second: see below.
    if (tail.size() != kFractionDigits) return stamp;
  }
  if (!AreDigits(tail) || tail.size() != kFractionDigits) return std::nullopt;
  const auto before = stem.substr(0, last);
  const auto seconds = before.substr(before.find_last_of("-_") + 1);
  constexpr std::size_t kSecondDigits = 10;
  if (!AreDigits(seconds) || seconds.size() != kSecondDigits) return std::nullopt;
  return dated(ToStamp(WholeOf(seconds) * kStampNsPerS + WholeOf(tail)));
}

TimeList::TimeList(std::string_view text) {
  bool is_first = true;
  while (!text.empty() && lines_.size() < kMaxTimes) {
    const auto end = text.find('\n');
    const auto line = Trimmed(text.substr(0, std::min(end, kMaxTimeLineBytes)));
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
    if (line.starts_with('#')) continue;
    const bool is_heading = std::exchange(is_first, false);
    if (const auto stamp = ParseStamp(line); stamp || line.empty()) {
      lines_.push_back(stamp);
      continue;
    }
    const auto words = WordsOf(line);
    const bool is_pair = words.size() >= 2;
    const auto second = is_pair ? ParseStamp(line.substr(static_cast<std::size_t>(words[1].data() - line.data()))) : std::nullopt;
    const auto stamp = second ? second : is_pair ? ParseStamp(words[1]) : std::nullopt;
    const auto first = stamp || !is_pair ? std::nullopt : ParseStamp(words[0]);
    if (stamp) by_name_.emplace(StemOf(words[0]), *stamp);
    if (first) by_name_.emplace(StemOf(words[1]), *first);
    if (stamp || first) {
      lines_.push_back(stamp ? stamp : first);
      continue;
    }
    if (is_heading) continue;
    lines_.emplace_back();
    ++num_bad_;
  }
  while (!lines_.empty() && !lines_.back()) lines_.pop_back();
}

std::optional<Stamp> TimeList::Of(std::string_view stem, std::size_t place, std::size_t count) const {
  if (const auto named = by_name_.find(stem); named != by_name_.end()) return named->second;
  if (lines_.size() == count) return place < lines_.size() ? lines_[place] : std::nullopt;
  constexpr std::size_t kMostNameDigits = 18;
  if (!AreDigits(stem) || stem.size() > kMostNameDigits) return std::nullopt;
  const auto number = static_cast<std::size_t>(WholeOf(stem));
  return number < lines_.size() ? lines_[number] : std::nullopt;
}

}  // namespace lookout::importer
