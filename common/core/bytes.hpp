// Little-endian numbers at fixed places of a payload. The size of the span is checked once, by the caller, for the whole payload.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace lookout {

using Bytes = std::span<const std::uint8_t>;

/// Precondition: offset + 2 <= bytes.size().
constexpr std::uint16_t ReadU16LittleEndian(Bytes bytes, std::size_t offset) {
  return static_cast<std::uint16_t>(bytes[offset] | (bytes[offset + 1] << 8));
}

/// Precondition: offset + 4 <= bytes.size().
constexpr std::uint32_t ReadU32LittleEndian(Bytes bytes, std::size_t offset) {
  return static_cast<std::uint32_t>(ReadU16LittleEndian(bytes, offset)) | static_cast<std::uint32_t>(ReadU16LittleEndian(bytes, offset + 2)) << 16;
}

/// Precondition: offset + 8 <= bytes.size().
constexpr std::uint64_t ReadU64LittleEndian(Bytes bytes, std::size_t offset) {
  return static_cast<std::uint64_t>(ReadU32LittleEndian(bytes, offset)) | static_cast<std::uint64_t>(ReadU32LittleEndian(bytes, offset + 4)) << 32;
}

/// Precondition: offset + 2 <= bytes.size().
constexpr void WriteU16LittleEndian(std::span<std::uint8_t> bytes, std::size_t offset, std::uint16_t value) {
  bytes[offset] = static_cast<std::uint8_t>(value & 0xFF);
  bytes[offset + 1] = static_cast<std::uint8_t>(value >> 8);
}

/// Precondition: offset + 4 <= bytes.size().
constexpr void WriteU32LittleEndian(std::span<std::uint8_t> bytes, std::size_t offset, std::uint32_t value) {
  WriteU16LittleEndian(bytes, offset, static_cast<std::uint16_t>(value & 0xFFFF));
  WriteU16LittleEndian(bytes, offset + 2, static_cast<std::uint16_t>(value >> 16));
}

}  // namespace lookout
