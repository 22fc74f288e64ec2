// Guarded decoding and encoding of wire messages, and their beginning without decoding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/core/bytes.hpp"

namespace lookout::bus {

/// @return the message; nullopt when the bytes are of another type, are cut short, hold a count that they cannot fill, go on behind the
///         message, or are more than kMaxMessageBytes. Never throws. lcmtypes/ guards every count, so that at most one element per
///         byte is made: some 30 MB for the largest message of the largest element.
template <typename T>
std::optional<T> Decode(Bytes bytes) {
  if (bytes.size() > kMaxMessageBytes) return std::nullopt;
  const int num_bytes = static_cast<int>(bytes.size());
  try {
    T message{};
    if (message.decode(bytes.data(), 0, num_bytes) != num_bytes) return std::nullopt;
    return message;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

/// @throws std::logic_error when a count of the message does not agree with its array
template <typename T>
std::vector<std::uint8_t> Encode(const T& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  if (message.encode(bytes.data(), 0, static_cast<int>(bytes.size())) != static_cast<int>(bytes.size())) {
    throw std::logic_error(std::string("encoding failed: ") + T::getTypeName());
  }
  return bytes;
}

/// The first members of every message of package lookout: 8 bytes each, big-endian.
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
