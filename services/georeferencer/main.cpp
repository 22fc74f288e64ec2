// The georeferencer process: SEGMENTS and POSE in, OBSTACLES out.
#include <chrono>
#include <iostream>

#include "common/runtime/options.hpp"
#include "common/runtime/process.hpp"
#include "common/runtime/run_info.hpp"
#include "services/georeferencer/params.hpp"
#include "services/georeferencer/service.hpp"

namespace {

// How late a time-out may come; the least that config allows is 50 ms.
constexpr std::chrono::milliseconds kTick(10);

}  // namespace

int main(int argc, char** argv) {
  const auto options = lookout::runtime::ParseOptions(argc, argv, "lookout-georeferencer", "SEGMENTS and POSE in, OBSTACLES out");
  return lookout::runtime::RunMain("georeferencer", [&options] {
    const auto params = lookout::georeferencer::LoadParams(options.config_folder);
    if (options.check_only) {
      std::cout << lookout::runtime::EffectiveConfig(options.config_folder, {"boat.txtpb", "georeferencer.txtpb"});
      return;
    }
    lookout::runtime::Process process("georeferencer", options.lcm_url);
    lookout::georeferencer::Service service(process.bus(), params);
    process.Every(kTick, [&] {
      service.AdvanceTo(lookout::runtime::HostNow());
      if (service.TakeAlarmChange()) process.ReportNow();
    });
    process.Run([&service] { return service.Report(); });
    service.Finish();
  });
}
