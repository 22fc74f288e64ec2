// The binary frame that carries one LCM message to a browser (PROTOCOL.md).
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/utime.hpp"

namespace lookout::page {

inline constexpr std::size_t kFrameHeadBytes = 16;
inline constexpr std::uint8_t kLiveSource = 255;

/// Bytes that several clients are sent: made once.
using SharedBytes = std::shared_ptr<const std::vector<std::uint8_t>>;

struct FrameHead {
  std::uint8_t source = kLiveSource;
  std::uint16_t channel = 0;  // index into the names of hello
  std::uint32_t request = 0;  // 0: live
  Utime time;                 // of reception, or of the event in the log
};

/// Head and message in one piece, as they go out.
std::vector<std::uint8_t> ToFrame(const FrameHead& head, Bytes message);

}  // namespace lookout::page
