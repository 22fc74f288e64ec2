// The recorder process: every channel into an lcm-log.
#include <chrono>
#include <spdlog/spdlog.h>

#include "common/config/text_config.hpp"
#include "common/runtime/run_info.hpp"
#include "common/runtime/service_main.hpp"
#include "services/recorder/params.hpp"
#include "services/recorder/service.hpp"

namespace {

using lookout::runtime::HostNow;

constexpr std::chrono::milliseconds kTick(500);
// At the end messages that wait are still recorded, but others may go on sending.
constexpr int kMaxLastMessages = 10'000;

struct Config {
  lookout::recorder::Params params;
  lookout::run_info_t run_info;
};

Config Load(const std::filesystem::path& config_folder) {
  lookout::config::FaultList faults;
  const auto run_info = faults.Take([&] { return lookout::runtime::MakeRunInfo("recorder", config_folder); });
  const auto params = faults.Take([&] { return lookout::recorder::LoadParams(config_folder); });
  faults.ThrowIfAny();
  return {*params, *run_info};
}

void Run(lookout::runtime::Process& process, const Config& config) {
  lookout::recorder::Service service(process.bus(), config.params, config.run_info, HostNow);
  spdlog::info("writing {}", service.log_file().string());
  auto log_file = service.log_file();
  process.OnHangup([&service] { service.Rotate(HostNow()); });
  process.Every(kTick, [&] {
    service.AdvanceTo(HostNow());
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
}

}  // namespace

int main(int argc, char** argv) {
  return lookout::runtime::ServiceMain<Config>(argc, argv,
                                               {.name = "recorder", .purpose = "every channel into an lcm-log", .load = Load, .run = Run});
}
