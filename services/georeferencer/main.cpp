// The georeferencer process: SEGMENTS and POSE in, OBSTACLES out.
#include <chrono>

#include "common/runtime/service_main.hpp"
#include "services/georeferencer/params.hpp"
#include "services/georeferencer/service.hpp"

namespace {

// How late a time-out may come; the least that config allows is 50 ms.
constexpr std::chrono::milliseconds kTick(10);

void Run(lookout::runtime::Process& process, const lookout::georeferencer::Params& params) {
  lookout::georeferencer::Service service(process.bus(), params);
  process.Every(kTick, [&service] { service.AdvanceTo(lookout::runtime::HostNow()); });
  process.Run([&service] { return service.Report(); });
  service.Finish();
}

}  // namespace

int main(int argc, char** argv) {
  return lookout::runtime::ServiceMain<lookout::georeferencer::Params>(
      argc, argv,
      {.name = "georeferencer", .purpose = "SEGMENTS and POSE in, OBSTACLES out", .load = lookout::georeferencer::LoadParams, .run = Run});
}
