// The lidar process: datagrams of a lidar, captures of them, or LIDAR_PACKETS in; LIDAR_PACKETS, LIDAR_BEAMS, LIDAR_NMEA, LIDAR_CLOCK, LIDAR_SCAN
// out.
#include <chrono>
#include <filesystem>
#include <spdlog/spdlog.h>
#include <string>

#include "common/runtime/service_main.hpp"
#include "services/lidar/sensor_beams.hpp"
#include "services/lidar/service.hpp"
#include "services/lidar/sources.hpp"

namespace {

void Run(lookout::runtime::Process& process, const lookout::lidar::Params& params) {
  lookout::lidar::Service service(process.bus(), params);
  service.OnNotice([](const std::string& notice) { spdlog::info("{}", notice); });
  const auto sources = lookout::lidar::OpenSources(params, service);
  lookout::lidar::SensorBeams beams(params, service);
  process.Every(std::chrono::milliseconds(500), [&beams] {
    if (const auto line = beams.Poll(lookout::runtime::HostNow()); !line.empty()) spdlog::warn("{}", line);
  });
  service.Finish(lookout::runtime::RunSources(process, sources.get(), [&] {
    auto report = service.Report();
    beams.AddTo(report);
    return report;
  }));
}

}  // namespace

// lookout-lidar_2 is the same program for the second lidar of a boat, of lidar_2.txtpb.
int main(int argc, char** argv) {
  const int number = std::string(argv[0]).ends_with("lookout-lidar_2") ? 2 : 1;
  return lookout::runtime::ServiceMain<lookout::lidar::Params>(
      argc, argv,
      {.name = number == 1 ? "lidar" : "lidar_2",
       .purpose = "datagrams of a lidar in; LIDAR_PACKETS, LIDAR_BEAMS, LIDAR_SCAN, LIDAR_CLOCK, LIDAR_NMEA out",
       .hangup = lookout::runtime::Hangup::kNewRun,
       .load = [number](const std::filesystem::path& folder) { return lookout::lidar::LoadChecked(folder, number); },
       .run = Run,
       .try_sources = lookout::lidar::TrySources});
}
