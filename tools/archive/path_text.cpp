#include "tools/archive/path_text.hpp"

#include <array>
#include <cstddef>

#include "common/core/printable.hpp"

namespace lookout::archive {

namespace {

constexpr std::string_view kDigits = "0123456789ABCDEF";

std::string Escaped(unsigned char byte) {
  const std::array<char, 3> text{'%', kDigits[byte >> 4U], kDigits[byte & 15U]};
  return {text.data(), text.size()};
}

// Bytes of the character that begins here; 0: none of UTF-8 that a terminal may see.
std::size_t CharacterBytes(std::string_view text) {
  constexpr std::size_t kMostBytes = 4;
  for (std::size_t size = 1; size <= kMostBytes && size <= text.size(); ++size) {
    if (IsPrintableLine(text.substr(0, size))) return size;
  }
  return 0;
}

}  // namespace

std::string PathText(const std::filesystem::path& path) {
  const std::string& bytes = path.native();
  std::string text;
  text.reserve(bytes.size());
  for (std::size_t i = 0; i < bytes.size();) {
    const auto size = bytes[i] == '%' ? 0 : CharacterBytes(std::string_view(bytes).substr(i));
    if (size == 0) {
      text += Escaped(static_cast<unsigned char>(bytes[i++]));
    } else {
      text.append(bytes, i, size);
      i += size;
    }
  }
  return text;
}

std::optional<std::filesystem::path> PathOfText(std::string_view text) {
  std::string bytes;
  bytes.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      bytes += text[i];
      continue;
    }
    if (i + 2 >= text.size()) return std::nullopt;
    const auto high = kDigits.find(text[i + 1]);
    const auto low = kDigits.find(text[i + 2]);
    if (high == std::string_view::npos || low == std::string_view::npos || high + low == 0) return std::nullopt;
    bytes += static_cast<char>(high << 4U | low);
    i += 2;
  }
  return std::filesystem::path(bytes);
}

}  // namespace lookout::archive
