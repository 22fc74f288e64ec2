// The odometer process: LIDAR_SCAN in, LIDAR_ODOMETRY out.
#include <chrono>

#include "common/runtime/service_main.hpp"
#include "services/odometer/params.hpp"
#include "services/odometer/service.hpp"

namespace {

constexpr std::chrono::milliseconds kTick(1000);

void Run(lookout::runtime::Process& process, const lookout::odometer::Params& params) {
  lookout::odometer::Service service(process.bus(), params);
  process.Every(kTick, [&service] { service.AdvanceTo(lookout::runtime::HostNow()); });
  process.Run([&service] { return service.Report(); });
}

}  // namespace

int main(int argc, char** argv) {
  return lookout::runtime::ServiceMain<lookout::odometer::Params>(
      argc, argv, {.name = "odometer", .purpose = "LIDAR_SCAN in, LIDAR_ODOMETRY out", .load = lookout::odometer::LoadParams, .run = Run});
}
