#include "services/navigator/core/sentence.hpp"

#include <algorithm>
#include <optional>

namespace lookout::navigator {

namespace {

bool IsPrintable(char character) { return character >= 0x20 && character <= 0x7E; }

// What stands behind a tag block and junk; empty when there is no start of a sentence.
std::string_view FromStart(std::string_view line) {
  const auto first = line.find_first_of("\\$!");
  if (first == std::string_view::npos) return {};
  line.remove_prefix(first);
  if (line.front() != '\\') return line;
  // A tag block may hold a $ of its own. One that does not end is junk.
  const auto block_end = line.find('\\', 1);
  line.remove_prefix(block_end == std::string_view::npos ? 1 : block_end + 1);
  const auto start = line.find_first_of("$!");
  return start == std::string_view::npos ? std::string_view{} : line.substr(start);
}

std::optional<unsigned> HexDigit(char digit) {
  if (digit >= '0' && digit <= '9') return static_cast<unsigned>(digit - '0');
  if (digit >= 'A' && digit <= 'F') return static_cast<unsigned>(digit - 'A' + 10);
  if (digit >= 'a' && digit <= 'f') return static_cast<unsigned>(digit - 'a' + 10);
  return std::nullopt;
}

bool IsChecksumOf(std::string_view digits, std::string_view body) {
  if (digits.size() != 2) return false;
  const auto high = HexDigit(digits[0]);
  const auto low = HexDigit(digits[1]);
  unsigned checksum = 0;
  for (const char character : body) checksum ^= static_cast<unsigned char>(character);
  return high && low && (*high << 4 | *low) == checksum;
}

}  // namespace

DatagramLines SplitDatagram(Bytes payload) {
  DatagramLines result;
  const std::string text(payload.begin(), payload.end());
  std::string_view rest = text;
  while (!rest.empty()) {
    const auto end = std::min(rest.find_first_of("\r\n"), rest.size());
    const auto whole_line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (whole_line.empty()) continue;
    const auto line = FromStart(whole_line);
    if (line.empty()) {
      ++result.num_no_start;
    } else if (line.size() > kMaxLineCharacters) {
      ++result.num_too_long;
    } else if (!std::ranges::all_of(line, IsPrintable)) {
      ++result.num_not_printable;
    } else {
      result.lines.emplace_back(line);
    }
  }
  return result;
}

bool IsLine(std::string_view line) {
  return !line.empty() && line.size() <= kMaxLineCharacters && (line.front() == '$' || line.front() == '!') && std::ranges::all_of(line, IsPrintable);
}

FrameResult Frame(std::string_view line, bool requires_checksum) {
  const auto star = line.rfind('*');
  const bool has_star = star != std::string_view::npos && star != 0;
  if (!has_star && (requires_checksum || line.empty())) return {SentenceFault::kNoChecksum, {}};
  auto body = has_star ? line.substr(1, star - 1) : line.substr(1);
  if (has_star && !IsChecksumOf(line.substr(star + 1), body)) return {SentenceFault::kBadChecksum, {}};

  FrameResult result;
  const auto address_end = std::min(body.find(','), body.size());
  result.sentence.address = body.substr(0, address_end);
  body.remove_prefix(address_end);
  while (!body.empty()) {
    body.remove_prefix(1);  // the comma
    const auto end = std::min(body.find(','), body.size());
    result.sentence.fields.push_back(body.substr(0, end));
    body.remove_prefix(end);
  }
  return result;
}

}  // namespace lookout::navigator
