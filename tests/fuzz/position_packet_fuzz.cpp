// Any bytes as a position packet: what is accepted is text that may go on the wire.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "services/lidar/core/vlp16/position_packet.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto result = lookout::vlp16::ParsePositionPacket({data, size});
  if (result.fault != lookout::vlp16::PositionFault::kNone) return 0;
  for (const char character : result.packet.sentence) {
    if (character < 0x20 || character > 0x7E) std::abort();
  }
  return 0;
}
