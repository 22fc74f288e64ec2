// The bits of an AIS message out of its six-bit armour.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lookout::ais {

/// A message as bits. A field that lies behind the end reads as if zeros followed, as gpsd reads truncated messages; callers check the length of what
/// must be there.
class Payload {
 public:
  std::size_t num_bits() const { return num_bits_; }

  /// Adds the characters of one sentence: each carries six bits (ITU-R M.1371, IEC 61162-1: 0 to W and ` to w).
  ///
  /// @param num_fill_bits  of the last character that say nothing, 0 to 5
  /// @return false: a character that is none of the armour, or more fill bits than there are. Then nothing was added
  bool Append(std::string_view armour, std::size_t num_fill_bits);

  /// @param width  1 to 32
  std::uint32_t Unsigned(std::size_t first, std::size_t width) const;
  /// Two's complement.
  std::int32_t Signed(std::size_t first, std::size_t width) const;
  bool Flag(std::size_t first) const { return Unsigned(first, 1) != 0; }
  /// Six-bit text up to its first @, without spaces at its end: printable ASCII.
  ///
  /// @param first_more  where a text that fills its place goes on, for so many characters
  std::string Text(std::size_t first, std::size_t num_characters, std::size_t first_more = 0, std::size_t num_more = 0) const;

 private:
  std::vector<std::uint8_t> sextets_;
  std::size_t num_bits_ = 0;
};

/// @return nullopt where Append would refuse
std::optional<Payload> ToPayload(std::string_view armour, std::size_t num_fill_bits);

}  // namespace lookout::ais
