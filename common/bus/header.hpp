// What every message of package lookout begins with, read without decoding it: fingerprint, utime_us, seq, 8 bytes each, big-endian.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/core/bytes.hpp"

namespace lookout::bus {

struct MessageHeader {
  std::uint64_t fingerprint = 0;  // of the type
  std::int64_t utime_us = 0;
  std::int64_t seq = 0;
};

/// Precondition: offset + 8 <= bytes.size().
constexpr std::uint64_t ReadU64BigEndian(Bytes bytes, std::size_t offset) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 8; ++i) value = value << 8 | bytes[offset + i];
  return value;
}

/// @return nullopt when the bytes are too few. Whether they are a message of package lookout its fingerprint tells.
constexpr std::optional<MessageHeader> ReadHeader(Bytes bytes) {
  if (bytes.size() < 24) return std::nullopt;
  return MessageHeader{ReadU64BigEndian(bytes, 0), static_cast<std::int64_t>(ReadU64BigEndian(bytes, 8)),
                       static_cast<std::int64_t>(ReadU64BigEndian(bytes, 16))};
}

}  // namespace lookout::bus
