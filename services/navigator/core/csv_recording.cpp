#include "services/navigator/core/csv_recording.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <vector>

#include "services/navigator/core/lines.hpp"

namespace lookout::navigator {

namespace {

using std::chrono::microseconds;

std::string_view Trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") + 1 - first);
}

bool IsStart(std::string_view text) { return !text.empty() && std::string_view("$!\\").find(text.front()) != std::string_view::npos; }

// A text whose closing quotes are missing goes to the end of the line.
std::string QuotedText(std::string_view& rest) {
  std::string text;
  rest.remove_prefix(1);
  for (; !rest.empty(); rest.remove_prefix(1)) {
    if (rest.front() == '"') {
      rest.remove_prefix(1);
      if (rest.empty() || rest.front() != '"') break;
    }
    text += rest.front();
  }
  rest.remove_prefix(std::min(rest.find(','), rest.size()));
  return text;
}

// A sentence without quotes holds commas of its own: it goes to its checksum, or to the end of the line.
std::size_t EndOfSentence(std::string_view text) {
  constexpr std::size_t kChecksumCharacters = 3;
  for (auto star = text.find('*'); star != std::string_view::npos; star = text.find('*', star + 1)) {
    if (EndsInChecksum(text.substr(0, star + kChecksumCharacters))) return std::min(text.find(',', star), text.size());
  }
  return text.size();
}

std::vector<std::string> FieldsOf(std::string_view line) {
  std::vector<std::string> fields;
  for (auto rest = line;;) {
    rest.remove_prefix(std::min(rest.find_first_not_of(" \t"), rest.size()));
    if (!rest.empty() && rest.front() == '"') {
      fields.emplace_back(Trimmed(QuotedText(rest)));
    } else {
      const auto end = IsStart(rest) ? EndOfSentence(rest) : std::min(rest.find(','), rest.size());
      fields.emplace_back(Trimmed(rest.substr(0, end)));
      rest.remove_prefix(end);
    }
    if (rest.empty()) return fields;
    rest.remove_prefix(1);  // the comma
  }
}

std::string Lower(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](char letter) { return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter; });
  return text;
}

// The number of `size` digits at `begin`.
std::optional<int> Digits(std::string_view text, std::size_t begin, std::size_t size) {
  const auto digits = text.substr(std::min(begin, text.size()), size);
  if (digits.size() != size || digits.find_first_not_of("0123456789") != std::string_view::npos) return std::nullopt;
  int value = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return value;
}

// "Z", "", "+02:00", "-0230", "+02".
std::optional<std::chrono::minutes> OffsetOf(std::string_view text) {
  text = Trimmed(text);
  if (text.empty() || text == "Z" || text == "z") return std::chrono::minutes(0);
  if (text.front() != '+' && text.front() != '-') return std::nullopt;
  const auto hours = Digits(text, 1, 2);
  const std::size_t minutes_at = text.size() > 3 && text[3] == ':' ? 4 : 3;
  const auto minutes = text.size() == 3 ? std::optional(0) : Digits(text, minutes_at, 2);
  constexpr int kMaxHours = 15;
  if (!hours || !minutes || *hours > kMaxHours || *minutes > 59 || (text.size() != 3 && text.size() != minutes_at + 2)) return std::nullopt;
  const auto offset = std::chrono::hours(*hours) + std::chrono::minutes(*minutes);
  return text.front() == '-' ? -offset : offset;
}

// The zone of a time: without a head nobody knows the zone of a time that does not state it.
bool SaysZone(std::string_view time) { return time.back() == 'Z' || time.back() == 'z' || time.find_last_of("+-") > time.find(':'); }

}  // namespace

std::optional<Utime> ParseIsoTime(std::string_view text) {
  // 0123456789012345678
  // 2026-08-29T10:00:00
  constexpr std::size_t kSize = 19;
  text = Trimmed(text);
  if (text.size() < kSize || text[4] != '-' || text[7] != '-' || (text[10] != 'T' && text[10] != ' ') || text[13] != ':' || text[16] != ':') {
    return std::nullopt;
  }
  const auto year = Digits(text, 0, 4);
  const auto month = Digits(text, 5, 2);
  const auto day = Digits(text, 8, 2);
  const auto hour = Digits(text, 11, 2);
  const auto minute = Digits(text, 14, 2);
  const auto second = Digits(text, 17, 2);
  if (!year || !month || !day || !hour || !minute || !second) return std::nullopt;
  const std::chrono::year_month_day date(std::chrono::year(*year), std::chrono::month(static_cast<unsigned>(*month)),
                                         std::chrono::day(static_cast<unsigned>(*day)));
  constexpr int kLeapSecond = 60;
  if (!date.ok() || *hour > 23 || *minute > 59 || *second > kLeapSecond) return std::nullopt;
  text.remove_prefix(kSize);
  // Parts of a microsecond are dropped.
  microseconds fraction(0);
  if (!text.empty() && (text.front() == '.' || text.front() == ',')) {
    text.remove_prefix(1);
    microseconds unit = std::chrono::milliseconds(100);
    for (; !text.empty() && text.front() >= '0' && text.front() <= '9'; text.remove_prefix(1), unit /= 10) fraction += (text.front() - '0') * unit;
  }
  const auto offset = OffsetOf(text);
  if (!offset) return std::nullopt;
  const Utime time =
      std::chrono::sys_days(date) + std::chrono::hours(*hour) + std::chrono::minutes(*minute) + std::chrono::seconds(*second) + fraction - *offset;
  return UtimeFromWire(ToUtimeUs(time));
}

std::optional<CsvColumns> FindCsvColumns(std::string_view line) {
  constexpr std::array<std::string_view, 2> kTimes{"timestamp", "time"};
  constexpr std::array<std::string_view, 5> kMessages{"message", "raw_data", "sentence", "payload", "data"};
  if (line.empty() || line.front() == '#' || IsStart(line)) return std::nullopt;
  const auto fields = FieldsOf(line);
  if (fields.size() < 2) return std::nullopt;
  if (ParseIsoTime(fields.front())) {
    const bool is_row = SaysZone(fields.front()) && std::ranges::any_of(fields, IsStart);
    return is_row ? std::optional(CsvColumns{}) : std::nullopt;
  }
  const auto find = [&fields](const auto& names) -> std::optional<std::size_t> {
    for (const auto name : names) {
      const auto field = std::ranges::find_if(fields, [name](const std::string& candidate) { return Lower(candidate) == name; });
      if (field != fields.end()) return static_cast<std::size_t>(field - fields.begin());
    }
    return std::nullopt;
  };
  const auto time = find(kTimes);
  const auto message = find(kMessages);
  if (!time || !message) return std::nullopt;
  return CsvColumns{*time, message};
}

CsvRow ReadCsvRow(std::string_view line, const CsvColumns& columns) {
  const auto fields = FieldsOf(line);
  CsvRow row;
  if (columns.time < fields.size()) row.time = ParseIsoTime(fields[columns.time]);
  const auto message = columns.message ? fields.begin() + static_cast<std::ptrdiff_t>(std::min(*columns.message, fields.size()))
                                       : std::ranges::find_if(fields, IsStart);
  if (message != fields.end()) row.message = *message;
  row.is_sentence = IsStart(row.message);
  return row;
}

}  // namespace lookout::navigator
