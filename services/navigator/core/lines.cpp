#include "services/navigator/core/lines.hpp"

#include <algorithm>

#include "common/core/sentence.hpp"

namespace lookout::navigator {

namespace {

bool IsPrintable(char character) { return character >= 0x20 && character <= 0x7E; }

// The text behind a tag block and junk; empty when there is no start of a sentence.
std::string_view FromStart(std::string_view line) {
  const auto first = line.find_first_of("\\$!");
  if (first == std::string_view::npos) return {};
  line.remove_prefix(first);
  if (line.front() != '\\') return line;
  // A tag block may hold a $ of its own. A tag block that does not end is junk.
  const auto block_end = line.find('\\', 1);
  line.remove_prefix(block_end == std::string_view::npos ? 1 : block_end + 1);
  const auto start = line.find_first_of("$!");
  return start == std::string_view::npos ? std::string_view{} : line.substr(start);
}

bool IsAlphanumeric(char character) {
  return (character >= '0' && character <= '9') || (character >= 'A' && character <= 'Z') || (character >= 'a' && character <= 'z');
}

int HexDigit(char character) {
  if (character >= '0' && character <= '9') return character - '0';
  if (character >= 'A' && character <= 'F') return character - 'A' + 10;
  return character >= 'a' && character <= 'f' ? character - 'a' + 10 : -1;
}

std::string_view WithoutBlanksBehind(std::string_view text) {
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\0')) text.remove_suffix(1);
  return text;
}

constexpr std::size_t kChecksumCharacters = 3;  // with the *
constexpr std::ptrdiff_t kMinAddressLetters = 3;
constexpr std::ptrdiff_t kMaxAddressLetters = 10;  // talker and type, or a maker's word

bool IsStart(char character) { return character == '$' || character == '!'; }

// The sentence whose checksum stands at `star`; empty when there is none.
std::string_view SentenceBefore(std::string_view text, std::size_t star) {
  if (star + kChecksumCharacters > text.size() || !EndsInChecksum(text.substr(star, kChecksumCharacters))) return {};
  const auto end = star + kChecksumCharacters;
  if (end < text.size() && IsAlphanumeric(text[end])) return {};
  const auto stated = static_cast<unsigned>(HexDigit(text[star + 1]) * 16 + HexDigit(text[star + 2]));
  unsigned checksum = 0;
  // From the last start on: of two that have a right checksum the later is the sentence, an even number of $ before it does not change the sum.
  for (auto start = star; start > 0 && end - start < kMaxLineCharacters && IsPrintable(text[start - 1]); --start) {
    const char character = text[start - 1];
    if (IsStart(character) && checksum == stated) return text.substr(start - 1, end - start + 1);
    checksum ^= static_cast<unsigned char>(character);
  }
  return {};
}

// The first sentence with a right checksum; empty when there is none.
std::string_view FirstSentence(std::string_view text) {
  for (auto star = text.find('*'); star != std::string_view::npos; star = text.find('*', star + 1)) {
    const auto sentence = SentenceBefore(text, star);
    if (!sentence.empty()) return sentence;
  }
  return {};
}

bool HoldsBegin(std::string_view text) {
  for (auto start = text.find_first_of("$!"); start != std::string_view::npos; start = text.find_first_of("$!", start + 1)) {
    if (BeginsAsSentence(text.substr(start))) return true;
  }
  return false;
}

// Whether a sentence or its tag block begins, behind blanks.
bool BeginsAnew(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  return first != std::string_view::npos && std::string_view("$!\\").find(text[first]) != std::string_view::npos;
}

bool IsSentence(std::string_view line) {
  return line.size() <= kMaxLineCharacters && std::ranges::all_of(line, IsPrintable) && Frame(line).fault == SentenceFault::kNone;
}

// Text that begins as a sentence but has no right checksum, as it stands.
void AddAsItStands(std::string_view text, DatagramLines& result) {
  auto line = FromStart(text);
  // Behind bytes that are no text (another protocol on the same line) a whole sentence may stand.
  const auto last_byte = std::ranges::find_if_not(text.rbegin(), text.rend(), IsPrintable);
  if (last_byte != text.rend()) {
    const auto behind = FromStart(text.substr(static_cast<std::size_t>(text.rend() - last_byte)));
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

void AddLine(std::string_view whole_line, DatagramLines& result) {
  auto rest = WithoutBlanksBehind(whole_line);
  for (bool has_sentence = false;; has_sentence = true) {
    const auto line = FromStart(rest);
    if (line.empty() && has_sentence) return;
    const auto sentence = FirstSentence(line);
    const auto begin = sentence.empty() ? 0 : static_cast<std::size_t>(sentence.data() - line.data());
    // The checksum of a second sentence may be right for both sentences together: always so, where the first checksum is 7F.
    const bool is_followed = begin == 0 && !sentence.empty() && BeginsAnew(line.substr(sentence.size()));
    if (!is_followed && !line.empty() && IsSentence(line)) {
      result.lines.emplace_back(line);
      return;
    }
    if (sentence.empty()) return AddAsItStands(rest, result);
    result.num_cut_off += HoldsBegin(line.substr(0, begin)) ? 1 : 0;
    result.lines.emplace_back(sentence);
    rest = line.substr(begin + sentence.size());
  }
}

// Whether a sentence begins so, if only by the first letters of its address.
bool MayBegin(std::string_view line) {
  const auto rest = line.substr(1);
  const auto end = std::ranges::find_if_not(rest, IsAlphanumeric);
  return end - rest.begin() <= kMaxAddressLetters && (end == rest.end() || *end == ',' || *end == '*');
}

// Where a line that is not whole yet begins in `text`, behind the last end of line and the last checksum; npos where there is none.
std::size_t UnfinishedFrom(std::string_view text) {
  const auto line_end = text.find_last_of("\r\n");
  const auto begin = line_end == std::string_view::npos ? 0 : line_end + 1;
  const auto tail = text.substr(begin);
  const auto start = tail.find_last_of("$!");
  if (start == std::string_view::npos) return std::string_view::npos;
  const auto line = tail.substr(start);
  const auto star = line.rfind('*');
  const bool is_whole = star != std::string_view::npos && line.size() - star >= kChecksumCharacters;
  const bool may_go_on = line.size() <= kMaxLineCharacters && std::ranges::all_of(line, IsPrintable) && MayBegin(line);
  return is_whole || !may_go_on ? std::string_view::npos : begin + start;
}

bool IsLineEnd(char character) { return character == '\r' || character == '\n'; }

DatagramLines SplitText(std::string_view text) { return SplitDatagram({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}); }

}  // namespace

bool BeginsAsSentence(std::string_view line) {
  if (line.empty() || !IsStart(line.front())) return false;
  const auto rest = line.substr(1);
  const auto end = std::ranges::find_if_not(rest, [](char letter) { return IsAlphanumeric(letter) && (letter < 'a' || letter > 'z'); });
  const auto num_letters = end - rest.begin();
  return num_letters >= kMinAddressLetters && num_letters <= kMaxAddressLetters && end != rest.end() && *end == ',';
}

bool EndsInChecksum(std::string_view text) {
  if (text.size() < kChecksumCharacters) return false;
  const auto end = text.substr(text.size() - kChecksumCharacters);
  return end[0] == '*' && HexDigit(end[1]) >= 0 && HexDigit(end[2]) >= 0;
}

DatagramLines SplitDatagram(Bytes payload) {
  DatagramLines result;
  std::string_view rest(reinterpret_cast<const char*>(payload.data()), payload.size());
  while (!rest.empty()) {
    const auto end = std::min(rest.find_first_of("\r\n"), rest.size());
    const auto whole_line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (!whole_line.empty()) AddLine(whole_line, result);
  }
  return result;
}

// The text that was not given yet is a line of its own.
void DatagramJoiner::GiveUp(const Held& held, std::string& text) {
  if (!held.is_given) text += held.text + "\n";
}

// The sender that was heard longest ago goes.
void DatagramJoiner::MakeRoom(std::string& text) {
  if (held_.size() < kMaxSenders) return;
  const auto oldest = std::ranges::min_element(held_, {}, [](const auto& entry) { return entry.second.arrival; });
  text += '\n';
  GiveUp(oldest->second, text);
  held_.erase(oldest);
}

DatagramLines DatagramJoiner::Add(Utime arrival, Bytes payload, const std::string& sender, bool requires_checksum) {
  const std::string_view added(reinterpret_cast<const char*>(payload.data()), payload.size());
  std::string text;
  bool goes_on = false;
  if (const auto found = held_.find(sender); found != held_.end()) {
    const auto& held = found->second;
    const bool is_in_time = arrival >= held.arrival && arrival - held.arrival <= kMaxWait;
    const bool ends_line = !added.empty() && IsLineEnd(added.front());
    goes_on = is_in_time && !BeginsAnew(added) && !(ends_line && held.is_given);
    if (goes_on) {
      text = held.text;
    } else {
      GiveUp(held, text);
    }
    held_.erase(found);
  }
  text += added;
  const auto unfinished = UnfinishedFrom(text);
  if (unfinished == std::string::npos) return SplitText(text);
  const Held held{text.substr(unfinished), arrival, !requires_checksum && !goes_on};
  if (!held.is_given) {
    text.resize(unfinished);
    // A tag block before it is dropped with it.
    const auto line_end = text.find_last_of("\r\n");
    const auto begin = line_end == std::string::npos ? 0 : line_end + 1;
    if (begin < text.size() && text[begin] == '\\') text.resize(begin);
  }
  MakeRoom(text);
  held_.emplace(sender, held);
  return SplitText(text);
}

DatagramLines DatagramJoiner::AdvanceTo(Utime now) {
  std::string text;
  std::erase_if(held_, [&](const auto& entry) {
    const auto age = now - entry.second.arrival;
    if (age >= std::chrono::microseconds(0) && age <= kMaxWait) return false;
    GiveUp(entry.second, text);
    return true;
  });
  return SplitText(text);
}

DatagramLines DatagramJoiner::Finish() {
  std::string text;
  for (const auto& [sender, held] : held_) GiveUp(held, text);
  held_.clear();
  return SplitText(text);
}

bool IsSourceName(std::string_view name) {
  constexpr std::size_t kMaxCharacters = 32;
  return !name.empty() && name.size() <= kMaxCharacters &&
         std::ranges::all_of(name, [](char character) { return (character >= 'a' && character <= 'z') || (character >= '0' && character <= '9'); });
}

bool IsImportedSource(std::string_view name) {
  return name.starts_with(kImportedSource) && name.size() > kImportedSource.size() && name.size() <= kMaxImportedSourceCharacters &&
         std::ranges::all_of(name, [](char character) { return character > ' ' && character < '\x7F'; });
}

DatagramLines LineAssembler::Add(Bytes bytes) {
  // A tag block and junk may stand before a line of full length.
  constexpr std::size_t kMaxHeld = 4 * kMaxLineCharacters;
  rest_.append(bytes.begin(), bytes.end());
  const auto end = rest_.find_last_of("\r\n");
  std::size_t num_whole = end == std::string::npos ? 0 : end + 1;
  // A sender that sets no end of line: the last sentence is whole, too, once its checksum is there.
  const std::string_view text = rest_;
  const auto start = text.find_last_of("$!");
  if (start != std::string_view::npos && start > num_whole && EndsInChecksum(text.substr(0, start))) {
    num_whole = IsSentence(text.substr(start)) ? text.size() : start;
  }
  auto lines = SplitText(text.substr(0, num_whole));
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
