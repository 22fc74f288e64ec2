// The plotter process: TRACKS, ALERTS and POSE in; NMEA 0183, Signal K, NMEA 2000 and MAVLink out; ALERT_ACK out.
#include <chrono>
#include <spdlog/spdlog.h>
#include <thread>

#include "common/runtime/service_main.hpp"
#include "common/runtime/version.hpp"
#include "services/plotter/outputs.hpp"
#include "services/plotter/params.hpp"
#include "services/plotter/service.hpp"

namespace {

constexpr std::chrono::milliseconds kTick(5);
constexpr std::chrono::seconds kRemarkPeriod(1);

void Run(lookout::runtime::Process& process, const lookout::plotter::Params& loaded) {
  auto params = loaded;
  params.version = lookout::runtime::Version();
  lookout::plotter::Links links;
  lookout::plotter::Service service(process.bus(), params, lookout::plotter::OpenOutputs(params, links));
  process.Every(kTick, [&] {
    links.Poll();
    service.AdvanceTo(lookout::runtime::HostNow());
    links.Poll();
  });
  process.Every(kRemarkPeriod, [&service] {
    for (const auto& line : service.TakeRemarks()) spdlog::info("{}", line);
  });
  process.Run([&service] { return service.Report(); });
  service.Finish();
  // The last messages are given a moment to go out.
  constexpr int kLastPolls = 20;
  for (int i = 0; i < kLastPolls; ++i) {
    links.Poll();
    std::this_thread::sleep_for(kTick);
  }
}

}  // namespace

int main(int argc, char** argv) {
  return lookout::runtime::ServiceMain<lookout::plotter::Params>(
      argc, argv,
      {.name = "plotter",
       .purpose = "TRACKS, ALERTS and POSE in, NMEA 0183, Signal K, NMEA 2000 and MAVLink out",
       .load = lookout::plotter::LoadParams,
       .run = Run,
       .remarks = lookout::plotter::InWords});
}
