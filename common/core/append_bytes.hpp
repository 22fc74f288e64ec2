// Numbers of binary outputs.
#pragma once

#include <bit>
#include <cstdint>
#include <string>

namespace lookout {

/// The lowest bytes of a number, the lowest first.
inline void AppendLittleEndian(std::uint64_t value, int num_bytes, std::string& text) {
  for (int i = 0; i < num_bytes; ++i) text += static_cast<char>(value >> (8 * i) & 0xFF);
}

/// IEEE 754, 4 bytes.
inline void AppendFloat(double value, std::string& text) { AppendLittleEndian(std::bit_cast<std::uint32_t>(static_cast<float>(value)), 4, text); }

}  // namespace lookout
