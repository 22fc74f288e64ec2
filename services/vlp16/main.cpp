// The lidar process: datagrams of a VLP-16, a capture of them, or LIDAR_PACKETS in; LIDAR_PACKETS, LIDAR_NMEA, LIDAR_CLOCK, LIDAR_SCAN out.
#include <chrono>
#include <iostream>
#include <spdlog/spdlog.h>

#include "common/io/udp_receiver.hpp"
#include "common/runtime/options.hpp"
#include "common/runtime/process.hpp"
#include "common/runtime/run_info.hpp"
#include "services/vlp16/io/capture_reader.hpp"
#include "services/vlp16/params.hpp"
#include "services/vlp16/service.hpp"

namespace {

using lookout::HealthReport;
using lookout::Utime;

// A bundle waits for 100 ms at most: a tenth of that is how late its time-out may come.
constexpr std::chrono::milliseconds kTick(10);
// Datagrams taken from a socket before the bus and the timers get their turn again.
constexpr int kMaxDatagramsPerRound = 64;
// A capture whose stamps pause for longer, or go back, has a bad stamp or was put together: it is not waited for.
constexpr std::chrono::seconds kMaxPause(5);

void RunLog(lookout::runtime::Process& process, const lookout::vlp16::Params& params) {
  lookout::vlp16::Service service(process.bus(), params);
  process.Run([&service] { return service.Report(); });
  service.Finish(lookout::runtime::HostNow());
}

void RunUdp(lookout::runtime::Process& process, const lookout::vlp16::Params& params) {
  lookout::vlp16::Service service(process.bus(), params);
  lookout::io::UdpReceiver data(params.bind_address, params.data_port, params.receive_buffer_bytes);
  lookout::io::UdpReceiver position(params.bind_address, params.position_port, params.receive_buffer_bytes);
  for (auto* receiver : {&data, &position}) {
    if (receiver->receive_buffer_bytes() < params.receive_buffer_bytes) {
      spdlog::warn("port {}: the kernel grants a receive buffer of {} bytes, {} were asked for (sysctl net.core.rmem_max)", receiver->port(),
                   receiver->receive_buffer_bytes(), params.receive_buffer_bytes);
    }
    process.OnReadable(receiver->file_descriptor(), [receiver, &service] {
      for (int i = 0; i < kMaxDatagramsPerRound; ++i) {
        const auto datagram = receiver->Receive();
        if (!datagram) return;
        service.OnDatagram(datagram->host_time, datagram->port, datagram->payload);
      }
    });
  }
  process.Every(kTick, [&service] { service.AdvanceTo(lookout::runtime::HostNow()); });
  process.Run([&] {
    HealthReport report = service.Report();
    report.counters.push_back({"data_kernel_drops", data.num_kernel_drops()});
    report.counters.push_back({"position_kernel_drops", position.num_kernel_drops()});
    return report;
  });
  service.Finish(lookout::runtime::HostNow());
}

// At the speed at which it was recorded: the capture's first stamp is now, and what is stamped later comes as much later.
void RunCapture(lookout::runtime::Process& process, const lookout::vlp16::Params& params) {
  lookout::vlp16::Service service(process.bus(), params);
  lookout::vlp16::CaptureReader reader(*params.capture_file);
  auto next = reader.Next();
  Utime last_stamp = next ? next->host_time : Utime{};
  std::chrono::microseconds last_due{0};  // since the start of playing
  std::chrono::microseconds next_due{0};
  Utime capture_time = last_stamp;
  std::int64_t num_stamp_jumps = 0;
  const auto started = std::chrono::steady_clock::now();
  process.Every(kTick, [&] {
    const auto elapsed = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - started);
    while (next && next_due <= elapsed) {
      service.OnDatagram(next->host_time, next->destination_port, next->payload);
      last_stamp = next->host_time;
      last_due = next_due;
      next = reader.Next();
      if (!next) break;
      const auto step = next->host_time - last_stamp;
      const bool is_jump = step < std::chrono::microseconds(0) || step > kMaxPause;
      num_stamp_jumps += is_jump ? 1 : 0;
      if (!is_jump) next_due += step;
    }
    capture_time = last_stamp + (elapsed - last_due);
    service.AdvanceTo(capture_time);
    if (next) return;
    service.Finish(capture_time);
    process.Stop();
  });
  process.Run([&] {
    HealthReport report = service.Report();
    for (const auto& counter : reader.counters()) report.counters.push_back(counter);
    report.counters.push_back({"capture_stamp_jumps", num_stamp_jumps});
    return report;
  });
  service.Finish(capture_time);  // when a signal came first; else it has been done
  if (reader.num_damaged() > 0) spdlog::warn("{}: {}", params.capture_file->string(), reader.damage());
  if (reader.num_datagrams() == 0) spdlog::warn("{}: no datagram in {} frames", params.capture_file->string(), reader.num_frames());
}

}  // namespace

int main(int argc, char** argv) {
  const auto options = lookout::runtime::ParseOptions(argc, argv, "lookout-vlp16", "VLP-16 datagrams in; LIDAR_PACKETS, LIDAR_SCAN out");
  return lookout::runtime::RunMain("vlp16", [&options] {
    const auto params = lookout::vlp16::LoadParams(options.config_folder);
    if (options.check_only) {
      std::cout << lookout::runtime::EffectiveConfig(options.config_folder, {"boat.txtpb", "vlp16.txtpb"});
      return;
    }
    lookout::runtime::Process process("vlp16", options.lcm_url);
    if (params.input == lookout::vlp16::Input::kLog) {
      RunLog(process, params);
    } else if (params.capture_file) {
      RunCapture(process, params);
    } else {
      RunUdp(process, params);
    }
  });
}
