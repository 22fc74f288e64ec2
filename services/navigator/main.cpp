// The navigation process: sentences of all inputs and LIDAR_NMEA, or NAV_RAW, in; NAV_RAW, GNSS_FIX, ATTITUDE and POSE out.
#include "common/runtime/service_main.hpp"
#include "services/navigator/service.hpp"
#include "services/navigator/sources.hpp"

namespace {

void Run(lookout::runtime::Process& process, const lookout::navigator::Params& params) {
  lookout::navigator::Service service(process.bus(), params);
  const auto sources = lookout::navigator::OpenSources(params, service);
  service.Finish(lookout::runtime::RunSources(process, sources.get(), [&service] { return service.Report(); }));
}

}  // namespace

int main(int argc, char** argv) {
  return lookout::runtime::ServiceMain<lookout::navigator::Params>(argc, argv,
                                                                   {.name = "navigator",
                                                                    .purpose = "NMEA 0183 in; NAV_RAW, GNSS_FIX, ATTITUDE, POSE out",
                                                                    .hangup = lookout::runtime::Hangup::kNewRun,
                                                                    .load = lookout::navigator::LoadParams,
                                                                    .run = Run,
                                                                    .remarks = lookout::navigator::InWords});
}
