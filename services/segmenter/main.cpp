// The segmenter process: LIDAR_SCAN in, SEGMENTS out.
#include <chrono>

#include "common/runtime/service_main.hpp"
#include "services/segmenter/params.hpp"
#include "services/segmenter/service.hpp"

namespace {

constexpr std::chrono::milliseconds kTick(1000);

void Run(lookout::runtime::Process& process, const lookout::segmenter::Lanes& params) {
  lookout::segmenter::Service service(process.bus(), params);
  process.Every(kTick, [&service] { service.AdvanceTo(lookout::runtime::HostNow()); });
  process.Run([&service] { return service.Report(); });
}

}  // namespace

int main(int argc, char** argv) {
  return lookout::runtime::ServiceMain<lookout::segmenter::Lanes>(
      argc, argv, {.name = "segmenter", .purpose = "LIDAR_SCAN in, SEGMENTS out", .load = lookout::segmenter::LoadLanes, .run = Run});
}
