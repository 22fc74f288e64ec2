#include "services/ais/core/payload.hpp"

#include <algorithm>

namespace lookout::ais {

namespace {

constexpr std::size_t kSextet = 6;

// The armour has two runs of characters: 0 to W are 0 to 39, ` to w are 40 to 63.
std::optional<std::uint8_t> SextetOf(char character) {
  if (character >= '0' && character <= 'W') return static_cast<std::uint8_t>(character - '0');
  if (character >= '`' && character <= 'w') return static_cast<std::uint8_t>(character - '`' + 40);
  return std::nullopt;
}

}  // namespace

bool Payload::Append(std::string_view armour, std::size_t num_fill_bits) {
  if (num_fill_bits >= kSextet || (armour.empty() && num_fill_bits > 0)) return false;
  // Fill bits stand at the end of a message: behind them nothing can follow.
  if (num_bits_ != kSextet * sextets_.size()) return false;
  if (!std::ranges::all_of(armour, [](char character) { return SextetOf(character).has_value(); })) return false;
  sextets_.reserve(sextets_.size() + armour.size());
  for (const char character : armour) sextets_.push_back(*SextetOf(character));
  num_bits_ = kSextet * sextets_.size() - num_fill_bits;
  return true;
}

std::uint32_t Payload::Unsigned(std::size_t first, std::size_t width) const {
  std::uint32_t value = 0;
  for (std::size_t i = first; i < first + width; ++i) {
    const std::uint32_t bit = i < num_bits_ ? (sextets_[i / kSextet] >> (kSextet - 1 - i % kSextet)) & 1U : 0U;
    value = (value << 1U) | bit;
  }
  return value;
}

std::int32_t Payload::Signed(std::size_t first, std::size_t width) const {
  const auto value = static_cast<std::int64_t>(Unsigned(first, width));
  const auto limit = std::int64_t{1} << (width - 1);
  return static_cast<std::int32_t>(value >= limit ? value - 2 * limit : value);
}

std::string Payload::Text(std::size_t first, std::size_t num_characters, std::size_t first_more, std::size_t num_more) const {
  std::string text;
  text.reserve(num_characters + num_more);
  for (std::size_t i = 0; i < num_characters + num_more; ++i) {
    const auto bit = i < num_characters ? first + kSextet * i : first_more + kSextet * (i - num_characters);
    const auto code = bit + kSextet <= num_bits_ ? Unsigned(bit, kSextet) : 0U;
    if (code == 0) break;  // @: the end
    text += static_cast<char>(code < 32 ? code + 64 : code);
  }
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

std::optional<Payload> ToPayload(std::string_view armour, std::size_t num_fill_bits) {
  Payload payload;
  if (!payload.Append(armour, num_fill_bits)) return std::nullopt;
  return payload;
}

}  // namespace lookout::ais
