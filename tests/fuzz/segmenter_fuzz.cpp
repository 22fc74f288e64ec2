// A LIDAR_SCAN message as it may come from anyone, through the whole service.
#include <cstddef>
#include <cstdint>

#include "services/segmenter/service.hpp"
#include "tests/support/memory_bus.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > static_cast<std::size_t>(lookout::bus::kMaxMessageBytes)) return 0;
  lookout::bus::MemoryBus bus;
  lookout::segmenter::Params params;
  // The first byte chooses method and image, the rest is the message.
  if (size > 0 && data[0] % 3 != 0) {
    params.method = lookout::segmenter::Method::kPaper;
    params.labelling.image_columns = data[0] % 3 == 1 ? 0 : 64;
  }
  const lookout::segmenter::Service service(bus, params);
  bus.Publish(lookout::bus::kLidarScan, {data + (size > 0 ? 1 : 0), data + size});
  lookout::support::HandleAll(bus);
  static_cast<void>(service.Report());
  return 0;
}
