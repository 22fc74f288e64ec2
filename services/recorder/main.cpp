// The recorder: every channel into an lcm-log.
#include <fmt/format.h>

#include <spdlog/spdlog.h>

#include "common/runtime/options.hpp"
#include "common/runtime/process.hpp"
#include "common/runtime/run_info.hpp"
#include "services/recorder/params.hpp"
#include "services/recorder/service.hpp"

int main(int argc, char** argv) {
  const auto options = lookout::runtime::ParseOptions(argc, argv, "lookout-recorder", "every channel into an lcm-log, RUN_INFO first");
  return lookout::runtime::RunMain("recorder", [&options] {
    const auto params = lookout::recorder::LoadParams(options.config_folder);
    if (options.check_only) {
      fmt::print("{}", lookout::runtime::EffectiveConfig(options.config_folder, {"recorder.txtpb"}));
      return;
    }
    lookout::runtime::Process process("recorder", options.lcm_url);
    lookout::recorder::Service service(process.bus(), params, lookout::runtime::MakeRunInfo("recorder", options.config_folder),
                                       lookout::runtime::HostNow);
    spdlog::info("writing {}", service.log_file().string());
    process.Every(std::chrono::milliseconds(100), [&service] { service.AdvanceTo(lookout::runtime::HostNow()); });
    process.Run([&service] { return service.Report(); });
  });
}
