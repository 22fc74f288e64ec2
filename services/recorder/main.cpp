// The recorder process: every channel into an lcm-log.
#include <chrono>
#include <iostream>
#include <spdlog/spdlog.h>

#include "common/config/text_config.hpp"
#include "common/runtime/options.hpp"
#include "common/runtime/process.hpp"
#include "common/runtime/run_info.hpp"
#include "services/recorder/params.hpp"
#include "services/recorder/service.hpp"

namespace {

constexpr std::chrono::milliseconds kTick(500);
// At the end messages that wait are still taken, but others may go on sending.
constexpr int kMaxLastMessages = 10'000;

}  // namespace

int main(int argc, char** argv) {
  const auto options = lookout::runtime::ParseOptions(argc, argv, "lookout-recorder", "every channel into an lcm-log");
  lookout::runtime::BlockStopSignals();
  return lookout::runtime::RunMain("recorder", [&options] {
    lookout::config::FaultList faults;
    const auto loaded_run_info = faults.Take([&options] { return lookout::runtime::MakeRunInfo("recorder", options.config_folder); });
    const auto loaded = faults.Take([&options] { return lookout::recorder::LoadParams(options.config_folder); });
    faults.ThrowIfAny();
    const auto& run_info = *loaded_run_info;
    const auto& params = *loaded;
    if (options.check_only) {
      std::cout << lookout::runtime::EffectiveConfig(options.config_folder, {"boat.txtpb", "recorder.txtpb"});
      return;
    }
    lookout::runtime::Process process("recorder", options.lcm_url);
    lookout::recorder::Service service(process.bus(), params, run_info, lookout::runtime::HostNow);
    spdlog::info("writing {}", service.log_file().string());
    auto log_file = service.log_file();
    process.OnHangup([&service] { service.Rotate(lookout::runtime::HostNow()); });
    process.Every(kTick, [&] {
      service.AdvanceTo(lookout::runtime::HostNow());
      for (const auto& warning : service.TakeWarnings()) spdlog::warn("{}", warning);
      if (service.log_file() != log_file && service.Report().state != lookout::HealthState::kFailed) {
        log_file = service.log_file();
        spdlog::info("writing {}", log_file.string());
      }
    });
    process.Run([&service] { return service.Report(); });
    for (int i = 0; i < kMaxLastMessages && process.bus().HandleOnce(std::chrono::milliseconds(0)); ++i) {
    }
    service.Flush();
    for (const auto& warning : service.TakeWarnings()) spdlog::warn("{}", warning);
  });
}
