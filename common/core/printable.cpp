#include "common/core/printable.hpp"

#include <cstddef>
#include <cstdint>

namespace lookout {

namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFF;

// Length of the character at the start of `text` (not empty), or 0 where it is no UTF-8 (RFC 3629: none longer than it must be, no surrogates).
std::size_t CharacterBytes(std::string_view text, std::uint32_t& code) {
  const auto byte = [text](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i])); };
  code = byte(0);
  if (code < 0x80) return 1;
  const std::size_t size = code >= 0xF0 && code < 0xF8 ? 4 : code >= 0xE0 && code < 0xF0 ? 3 : code >= 0xC0 && code < 0xE0 ? 2 : 0;
  if (size == 0 || text.size() < size) return 0;
  code &= 0x7FU >> size;
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) return 0;
    code = code << 6 | (byte(i) & 0x3FU);
  }
  const std::uint32_t least = size == 2 ? 0x80 : size == 3 ? 0x800 : 0x10000;
  const bool is_surrogate = code >= 0xD800 && code < 0xE000;
  return code < least || code > 0x10FFFF || is_surrogate ? 0 : size;
}

bool IsControl(std::uint32_t code) {
  // C0, DEL and C1; the separators of lines and paragraphs; what turns the direction of writing around (a name could read as another).
  return code < 0x20 || (code >= 0x7F && code < 0xA0) || code == 0x2028 || code == 0x2029 || (code >= 0x202A && code <= 0x202E) ||
         (code >= 0x2066 && code <= 0x2069);
}

// No writing needs it, and nobody sees it: soft hyphen, zero width space, marks of direction, word joiner and invisible operators, byte order mark,
// interlinear annotations, tags, and code points that are no characters.
bool IsHidden(std::uint32_t code) {
  return code == 0xAD || code == 0x61C || code == 0x180E || code == 0x200B || code == 0x200E || code == 0x200F ||
         (code >= 0x2060 && code <= 0x206F) || code == 0xFEFF || (code >= 0xFFF0 && code <= 0xFFFB) || (code >= 0xFDD0 && code <= 0xFDEF) ||
         (code & 0xFFFEU) == 0xFFFE || (code >= 0xE0000 && code <= 0xE00FF);
}

// Spaces and fillers of all scripts, joiners and variation selectors: nothing to see where they are all.
bool IsBlank(std::uint32_t code) {
  return code == 0x20 || code == 0xA0 || code == 0x34F || code == 0x115F || code == 0x1160 || code == 0x1680 || code == 0x17B4 || code == 0x17B5 ||
         (code >= 0x180B && code <= 0x180F) || (code >= 0x2000 && code <= 0x200A) || code == 0x200C || code == 0x200D || code == 0x202F ||
         code == 0x205F || code == 0x2800 || code == 0x3000 || code == 0x3164 || code == 0xFFA0 || (code >= 0xFE00 && code <= 0xFE0F) ||
         (code >= 0xE0100 && code <= 0xE01EF);
}

std::string Replaced(std::string_view text, std::string_view end_of_line) {
  std::string printable;
  printable.reserve(text.size());
  while (!text.empty()) {
    std::uint32_t code = kNone;
    const auto size = CharacterBytes(text, code);
    if (size == 1 && code == '\n') {
      printable += end_of_line;
    } else if (size == 0 || IsControl(code)) {
      printable += '?';
    } else {
      printable += text.substr(0, size);
    }
    text.remove_prefix(size == 0 ? 1 : size);
  }
  return printable;
}

}  // namespace

std::string Printable(std::string_view text) {
  std::string printable(text);
  for (char& letter : printable) {
    if (letter < ' ' || letter > '~') letter = '?';
  }
  return printable;
}

std::string PrintableLines(std::string_view text) { return Replaced(text, "\n  "); }

bool IsPrintableLine(std::string_view text) { return Replaced(text, "?") == text && text.find('\n') == std::string_view::npos; }

bool IsName(std::string_view text) {
  if (text.size() > kMostNameBytes || !IsPrintableLine(text)) return false;
  bool has_seen = false;
  while (!text.empty()) {
    std::uint32_t code = kNone;
    text.remove_prefix(CharacterBytes(text, code));  // not 0: the line is printable
    if (IsHidden(code)) return false;
    has_seen = has_seen || !IsBlank(code);
  }
  return has_seen;
}

std::string CsvText(std::string_view text) {
  auto printable = Replaced(text, "\n");
  // A tab or CR before it is a "?" by now.
  const auto first = printable.find_first_not_of(" \n");
  if (first != std::string::npos && std::string_view("=+-@").find(printable[first]) != std::string_view::npos) printable.insert(0, 1, '\'');
  if (printable.find_first_of(",\"\n") == std::string::npos) return printable;
  std::string quoted = "\"";
  for (const char letter : printable) {
    if (letter == '"') quoted += '"';
    quoted += letter;
  }
  return quoted + '"';
}

}  // namespace lookout
