#include "services/page/core/frame.hpp"

#include <algorithm>
#include <bit>

namespace lookout::page {

std::vector<std::uint8_t> ToFrame(const FrameHead& head, Bytes message) {
  std::vector<std::uint8_t> frame(kFrameHeadBytes + message.size());
  frame[0] = 1;  // kind: message
  frame[1] = head.source;
  WriteU16LittleEndian(frame, 2, head.channel);
  WriteU32LittleEndian(frame, 4, head.request);
  const auto time = std::bit_cast<std::uint64_t>(ToUtimeUs(head.time));
  WriteU32LittleEndian(frame, 8, static_cast<std::uint32_t>(time));
  WriteU32LittleEndian(frame, 12, static_cast<std::uint32_t>(time >> 32U));
  std::ranges::copy(message, frame.begin() + kFrameHeadBytes);
  return frame;
}

}  // namespace lookout::page
