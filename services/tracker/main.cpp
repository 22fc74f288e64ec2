// The tracker process: OBSTACLES, SEGMENTS, LIDAR_SCAN, POSE, ALERT_ACK and ORDERS in, TRACKS and ALERTS out.
#include <chrono>

#include "common/runtime/service_main.hpp"
#include "services/tracker/handover.hpp"
#include "services/tracker/params.hpp"
#include "services/tracker/params_text.hpp"
#include "services/tracker/service.hpp"

namespace {

// How late a time-out may come; the least that config allows is 50 ms.
constexpr std::chrono::milliseconds kTick(10);

void Run(lookout::runtime::Process& process, const lookout::tracker::Params& params) {
  auto handover = lookout::tracker::Handover::FromEnvironment();
  lookout::tracker::Service service(
      process.bus(), params,
      {.before = handover.Read(), .hand_over = [&handover](const auto& alerts, const auto& tracks) { handover.Write(alerts, tracks); }});
  process.Every(kTick, [&] {
    service.AdvanceTo(lookout::runtime::HostNow());
    if (service.TakeWatchChange()) process.ReportNow();
  });
  process.Run([&service] { return service.Report(); });
}

}  // namespace

int main(int argc, char** argv) {
  return lookout::runtime::ServiceMain<lookout::tracker::Params>(argc, argv,
                                                                 {.name = "tracker",
                                                                  .purpose = "OBSTACLES, SEGMENTS, LIDAR_SCAN and POSE in, TRACKS and ALERTS out",
                                                                  .load = [](const auto& folder) { return lookout::tracker::LoadParams(folder); },
                                                                  .run = Run,
                                                                  .remarks = lookout::tracker::ZoneRemarksAsComments});
}
