// Any bytes as packets of each of Velodyne's models of more than 16 lasers.
#include <cstddef>
#include <cstdint>

#include "services/lidar/core/models/velodyne.hpp"
#include "tests/fuzz/packet_reader_check.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lookout;
  using namespace lookout::lidar;
  if (size == 0) return 0;
  VelodyneReader reader(static_cast<VelodyneModel>(data[0] % kNumVelodyneModels));
  fuzz::ReadAll(reader, Bytes(data, size).subspan(1));
  return 0;
}
