// The AIS process: NAV_RAW, TRACKS and POSE in, AIS out.
#include <chrono>

#include "common/runtime/service_main.hpp"
#include "services/ais/params.hpp"
#include "services/ais/service.hpp"

namespace {

constexpr std::chrono::milliseconds kTick(100);

void Run(lookout::runtime::Process& process, const lookout::ais::Params& params) {
  lookout::ais::Service service(process.bus(), params);
  process.Every(kTick, [&service] { service.AdvanceTo(lookout::runtime::HostNow()); });
  process.Run([&service] { return service.Report(); });
}

}  // namespace

int main(int argc, char** argv) {
  return lookout::runtime::ServiceMain<lookout::ais::Params>(
      argc, argv, {.name = "ais", .purpose = "NAV_RAW, TRACKS and POSE in, AIS out", .load = lookout::ais::LoadParams, .run = Run});
}
