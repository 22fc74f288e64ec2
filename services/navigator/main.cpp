// The navigation process: NMEA 0183 over UDP and LIDAR_NMEA, or NAV_RAW, in; NAV_RAW, GNSS_FIX, ATTITUDE and POSE out.
#include <chrono>
#include <iostream>

#include "common/io/udp_receiver.hpp"
#include "common/runtime/options.hpp"
#include "common/runtime/process.hpp"
#include "common/runtime/run_info.hpp"
#include "services/navigator/params.hpp"
#include "services/navigator/service.hpp"

namespace {

// How late a tick may come: a tenth of its period.
constexpr std::chrono::milliseconds kTick(10);
// Seconds of sentences at 115200 baud; more can only be a flood.
constexpr int kReceiveBufferBytes = 256 * 1024;
// Datagrams taken from the socket before the bus and the timers get their turn again.
constexpr int kMaxDatagramsPerRound = 64;

void RunLog(lookout::runtime::Process& process, const lookout::navigator::Params& params) {
  lookout::navigator::Service service(process.bus(), params);
  process.Run([&service] { return service.Report(); });
  service.Finish(lookout::runtime::HostNow());
}

void RunUdp(lookout::runtime::Process& process, const lookout::navigator::Params& params) {
  lookout::navigator::Service service(process.bus(), params);
  lookout::io::UdpReceiver receiver({.bind_address = params.bind_address, .port = params.nmea_port, .receive_buffer_bytes = kReceiveBufferBytes});
  process.OnReadable(receiver.file_descriptor(), [&] {
    for (int i = 0; i < kMaxDatagramsPerRound; ++i) {
      const auto datagram = receiver.Receive();
      if (!datagram) return;
      service.OnDatagram(datagram->host_time, datagram->payload);
    }
  });
  process.Every(kTick, [&service] { service.AdvanceTo(lookout::runtime::HostNow()); });
  process.Run([&] {
    auto report = service.Report();
    report.counters.push_back({"kernel_drops", receiver.num_kernel_drops()});
    return report;
  });
  service.Finish(lookout::runtime::HostNow());
}

}  // namespace

int main(int argc, char** argv) {
  const auto options = lookout::runtime::ParseOptions(argc, argv, "lookout-navigator", "NMEA 0183 in; NAV_RAW, GNSS_FIX, ATTITUDE, POSE out");
  return lookout::runtime::RunMain("navigator", [&options] {
    const auto params = lookout::navigator::LoadParams(options.config_folder);
    if (options.check_only) {
      std::cout << lookout::runtime::EffectiveConfig(options.config_folder, {"boat.txtpb", "navigator.txtpb"});
      return;
    }
    lookout::runtime::Process process("navigator", options.lcm_url);
    if (params.input == lookout::navigator::Input::kLog) {
      RunLog(process, params);
    } else {
      RunUdp(process, params);
    }
  });
}
