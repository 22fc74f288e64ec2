#include "services/navigator/core/lines.hpp"

#include <algorithm>

#include "common/core/sentence.hpp"

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

// The whole sentence at the end of a line that does not begin as one: behind binary whose last bytes look like text, or behind a sentence that was
// broken off. Empty when there is none.
std::string_view SentenceBehind(std::string_view line) {
  line.remove_prefix(line.size() - std::min(line.size(), kMaxLineCharacters));
  // From the last start on: of two that have a right checksum the later is the sentence, an even number of $ before it does not change the sum.
  for (auto end = line.size(); end > 0;) {
    const auto start = line.find_last_of("$!", end - 1);
    if (start == std::string_view::npos) break;
    const auto sentence = line.substr(start);
    if (std::ranges::all_of(sentence, IsPrintable) && Frame(sentence).fault == SentenceFault::kNone) return sentence;
    end = start;
  }
  return {};
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
    auto line = FromStart(whole_line);
    // Behind bytes that are no text (another protocol on the same line) a whole sentence may stand.
    const auto last_byte = std::ranges::find_if_not(whole_line.rbegin(), whole_line.rend(), IsPrintable);
    if (last_byte != whole_line.rend()) {
      const auto behind = FromStart(whole_line.substr(static_cast<std::size_t>(whole_line.rend() - last_byte)));
      if (!behind.empty()) line = behind;
    }
    if (line.size() > kMaxLineCharacters || Frame(line).fault != SentenceFault::kNone) {
      const auto behind = SentenceBehind(whole_line);
      if (!behind.empty()) line = behind;
    }
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

bool IsSourceName(std::string_view name) {
  constexpr std::size_t kMaxCharacters = 32;
  return !name.empty() && name.size() <= kMaxCharacters &&
         std::ranges::all_of(name, [](char character) { return (character >= 'a' && character <= 'z') || (character >= '0' && character <= '9'); });
}

DatagramLines LineAssembler::Add(Bytes bytes) {
  // A tag block and junk may stand before a line of full length.
  constexpr std::size_t kMaxHeld = 4 * kMaxLineCharacters;
  rest_.append(bytes.begin(), bytes.end());
  const auto end = rest_.find_last_of("\r\n");
  const std::size_t num_whole = end == std::string::npos ? 0 : end + 1;
  auto lines = SplitDatagram({reinterpret_cast<const std::uint8_t*>(rest_.data()), num_whole});
  rest_.erase(0, num_whole);
  if (rest_.size() > kMaxHeld) {
    ++lines.num_too_long;
    rest_.clear();
  }
  return lines;
}

bool IsLine(std::string_view line) {
  return !line.empty() && line.size() <= kMaxLineCharacters && (line.front() == '$' || line.front() == '!') && std::ranges::all_of(line, IsPrintable);
}

}  // namespace lookout::navigator
