// The lidar process: datagrams of a VLP-16, captures of them, or LIDAR_PACKETS in; LIDAR_PACKETS, LIDAR_NMEA, LIDAR_CLOCK, LIDAR_SCAN out.
#include <spdlog/spdlog.h>
#include <string>

#include "common/runtime/service_main.hpp"
#include "services/lidar/service.hpp"
#include "services/lidar/sources.hpp"

namespace {

void Run(lookout::runtime::Process& process, const lookout::lidar::Params& params) {
  lookout::lidar::Service service(process.bus(), params);
  service.OnNotice([](const std::string& notice) { spdlog::info("{}", notice); });
  const auto sources = lookout::lidar::OpenSources(params, service);
  service.Finish(lookout::runtime::RunSources(process, sources.get(), [&service] { return service.Report(); }));
}

}  // namespace

int main(int argc, char** argv) {
  return lookout::runtime::ServiceMain<lookout::lidar::Params>(
      argc, argv,
      {.name = "lidar",
       .purpose = "VLP-16 datagrams in; LIDAR_PACKETS, LIDAR_SCAN, LIDAR_CLOCK, LIDAR_NMEA out",
       .hangup = lookout::runtime::Hangup::kNewRun,
       .load = lookout::lidar::LoadChecked,
       .run = Run,
       .try_sources = lookout::lidar::TrySources});
}
