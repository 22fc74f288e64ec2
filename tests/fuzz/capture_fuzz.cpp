// Any bytes as a capture file, and as a frame of each link type.
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "services/lidar/io/capture_reader.hpp"

namespace {

void ReadAsFile(const std::uint8_t* data, std::size_t size) {
  const int file = memfd_create("capture", MFD_CLOEXEC);
  if (file < 0) std::abort();
  if (write(file, data, size) != static_cast<ssize_t>(size)) std::abort();
  try {
    lookout::lidar::CaptureReader reader("/proc/self/fd/" + std::to_string(file));
    while (reader.Next()) continue;
  } catch (const std::runtime_error&) {
    // No capture: said, not a fault.
  }
  close(file);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr int kHighestLinkType = 300;
  for (int link_type = 0; link_type < kHighestLinkType; ++link_type) {
    if (lookout::lidar::IsLinkTypeUnderstood(link_type)) lookout::lidar::ParseFrame(link_type, {data, size}, size % 2 == 0);
  }
  ReadAsFile(data, size);
  return 0;
}
