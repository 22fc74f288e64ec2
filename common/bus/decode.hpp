// Guarded decoding and encoding of wire messages.
#pragma once

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

}  // namespace lookout::bus
