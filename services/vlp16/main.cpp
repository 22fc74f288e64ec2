// The lidar process: datagrams of a VLP-16, captures of them, or LIDAR_PACKETS in; LIDAR_PACKETS, LIDAR_NMEA, LIDAR_CLOCK, LIDAR_SCAN out.
#include <algorithm>
#include <chrono>
#include <iostream>
#include <optional>
#include <spdlog/spdlog.h>
#include <string>
#include <vector>

#include "common/config/text_config.hpp"
#include "common/io/udp_receiver.hpp"
#include "common/runtime/execute_again.hpp"
#include "common/runtime/options.hpp"
#include "common/runtime/process.hpp"
#include "common/runtime/run_info.hpp"
#include "services/vlp16/io/capture_player.hpp"
#include "services/vlp16/io/live_capture.hpp"
#include "services/vlp16/params.hpp"
#include "services/vlp16/service.hpp"
#include "services/vlp16/sources.hpp"

namespace {

using lookout::HealthReport;
using lookout::Utime;
using lookout::runtime::HostNow;
using lookout::vlp16::Params;
using lookout::vlp16::Sources;

// Sources are emptied at this period, not at each datagram: the kernel has stamped them, so this costs latency and no accuracy, and saves wake-ups
// (README, "Sources").
constexpr std::chrono::milliseconds kDrainPeriod(5);
constexpr std::chrono::milliseconds kCaptureTick(10);
// Work on one source before signals, the bus, timers and the other source get their turn again.
constexpr std::chrono::milliseconds kMaxRound(20);
constexpr std::chrono::milliseconds kInterfacePeriod(1000);

// Gives to `take` what `next` has, for kMaxRound at most. A call that ends at what was refused (not `is_empty`) does not end the round.
template <typename Next, typename IsEmpty, typename Take>
void Drain(const Next& next, const IsEmpty& is_empty, const Take& take) {
  const auto end = std::chrono::steady_clock::now() + kMaxRound;
  while (std::chrono::steady_clock::now() < end) {
    if (const auto datagram = next()) {
      take(*datagram);
    } else if (is_empty()) {
      return;
    }
  }
}

// Host time before which everything that came has been taken.
template <typename Source>
Utime TakenUntil(const Source& source, Utime now) {
  return source.is_empty() ? now : std::min(now, source.last_time());
}

// What is wrong with a source stands before what comes of it.
void AddFault(HealthReport& report, const std::string& fault) {
  if (fault.empty()) return;
  report.state = std::max(report.state, lookout::HealthState::kDegraded);
  report.reason = fault + (report.reason.empty() ? "" : "; ") + report.reason;
}

lookout::vlp16::Sender SenderOf(const lookout::io::ReceivedDatagram& datagram) {
  return {lookout::io::ToText(datagram.source), datagram.source_port};
}

template <typename Captured>
lookout::vlp16::Sender SenderOf(const Captured& datagram) {
  return {datagram.source_address, datagram.source_port};
}

void LogNotice(const std::string& notice) { spdlog::info("{}", notice); }

void RunLog(lookout::runtime::Process& process, const Params& params) {
  lookout::vlp16::Service service(process.bus(), params);
  service.OnNotice(LogNotice);
  process.Run([&service] { return service.Report(); });
  service.Finish(HostNow());
}

void RunUdp(lookout::runtime::Process& process, const Params& params) {
  lookout::vlp16::Service service(process.bus(), params);
  service.OnNotice(LogNotice);
  lookout::io::UdpReceiver data(lookout::vlp16::ToUdpOptions(params.sources, params.data_port));
  lookout::io::UdpReceiver position(lookout::vlp16::ToUdpOptions(params.sources, params.position_port));
  for (auto* receiver : {&data, &position}) {
    if (receiver->receive_buffer_bytes() >= params.sources.receive_buffer_bytes) continue;
    spdlog::warn("port {}: the kernel grants a receive buffer of {} bytes, {} were asked for (sysctl net.core.rmem_max)", receiver->port(),
                 receiver->receive_buffer_bytes(), params.sources.receive_buffer_bytes);
  }
  if (const auto bound = lookout::vlp16::BoundAddress(params.sources); bound && !bound->is_any() && !bound->is_multicast()) {
    spdlog::info("hears only what is sent to {}; the sensor as delivered sends to 255.255.255.255, which needs bind_address \"0.0.0.0\"",
                 params.sources.bind_address);
  }
  process.Every(kDrainPeriod, [&] {
    const auto now = HostNow();  // what was stamped before it is taken below
    for (auto* receiver : {&data, &position}) {
      Drain([receiver] { return receiver->Receive(); }, [receiver] { return receiver->is_empty(); },
            [&](const auto& datagram) { service.OnDatagram(datagram.host_time, datagram.port, datagram.payload, SenderOf(datagram)); });
    }
    service.AdvanceTo(now, std::min(TakenUntil(data, now), TakenUntil(position, now)));
  });
  process.Every(kInterfacePeriod, [&] {
    for (auto* receiver : {&data, &position}) {
      const auto event = receiver->FollowInterface();
      if (!event.empty()) spdlog::warn("port {}: {}", receiver->port(), event);
    }
  });
  process.Run([&] {
    HealthReport report = service.Report();
    report.counters.push_back({"data_kernel_drops", data.num_kernel_drops()});
    report.counters.push_back({"position_kernel_drops", position.num_kernel_drops()});
    report.counters.push_back({"data_source_refused", data.num_source_refused()});
    report.counters.push_back({"position_source_refused", position.num_source_refused()});
    report.counters.push_back({"sockets_reopened", data.num_reopened() + position.num_reopened()});
    AddFault(report, data.fault().empty() ? position.fault() : data.fault());
    return report;
  });
  service.Finish(HostNow());
}

void RunInterface(lookout::runtime::Process& process, const Params& params) {
  lookout::vlp16::Service service(process.bus(), params);
  service.OnNotice(LogNotice);
  lookout::vlp16::LiveCapture capture(lookout::vlp16::ToLiveOptions(params));
  if (capture.fault().empty()) {
    spdlog::info("captures on interface '{}', filter: {}", params.sources.interface, capture.filter());
  } else {
    spdlog::warn("{}; waiting for it", capture.fault());
  }
  process.Every(kDrainPeriod, [&] {
    const auto now = HostNow();  // what was stamped before it is taken below
    Drain([&capture] { return capture.Next(); }, [&capture] { return capture.is_empty(); },
          [&service](const auto& datagram) {
            service.OnDatagram(datagram.host_time, datagram.destination_port, datagram.payload, SenderOf(datagram));
          });
    service.AdvanceTo(now, TakenUntil(capture, now));
  });
  process.Every(kInterfacePeriod, [&] {
    const auto event = capture.FollowInterface();
    if (!event.empty()) spdlog::warn("{}", event);
  });
  process.Run([&] {
    HealthReport report = service.Report();
    for (const auto& counter : capture.counters()) report.counters.push_back(counter);
    AddFault(report, capture.fault());
    return report;
  });
  service.Finish(HostNow());
}

void RunCapture(lookout::runtime::Process& process, const Params& params) {
  lookout::vlp16::Service service(process.bus(), params);
  service.OnNotice(LogNotice);
  lookout::vlp16::CapturePlayer player(params.sources.capture_files, params.sources.capture_speed);
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [start] { return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start); };
  process.Every(kCaptureTick, [&] {
    Drain([&] { return player.NextDue(elapsed()); }, [&player] { return player.is_empty(); },
          [&service](const auto& datagram) {
            service.OnDatagram(datagram.host_time, datagram.destination_port, datagram.payload, SenderOf(datagram));
          });
    if (player.has_begun()) service.AdvanceTo(player.CaptureTime(elapsed()));
    if (player.is_finished()) process.Stop();
  });
  process.Run([&] {
    HealthReport report = service.Report();
    for (const auto& counter : player.counters()) report.counters.push_back(counter);
    return report;
  });
  service.Finish(player.CaptureTime(elapsed()));
  for (const auto& warning : player.Warnings()) spdlog::warn("{}", warning);
}

void RunSource(lookout::runtime::Process& process, const Params& params) {
  switch (params.sources.kind) {
    case Sources::Kind::kLog:
      return RunLog(process, params);
    case Sources::Kind::kCapture:
      return RunCapture(process, params);
    case Sources::Kind::kInterface:
      return RunInterface(process, params);
    case Sources::Kind::kUdp:
      return RunUdp(process, params);
  }
}

// Opens the sources of a new config beside those that run, and closes them. @throws std::runtime_error when one cannot be opened
void TrySources(const Params& params, const Params& running) {
  const auto& sources = params.sources;
  if (sources.kind == Sources::Kind::kUdp) {
    for (const int port : {params.data_port, params.position_port}) {
      // A port that this process holds is tried without it.
      const bool is_held = running.sources.kind == Sources::Kind::kUdp && (port == running.data_port || port == running.position_port);
      const lookout::io::UdpReceiver receiver(lookout::vlp16::ToUdpOptions(sources, is_held ? 0 : port));
    }
  } else if (sources.kind == Sources::Kind::kInterface) {
    const lookout::vlp16::LiveCapture capture(lookout::vlp16::ToLiveOptions(params));
  }
}

// SIGHUP: a wrong config is told and changes nothing; a right one ends the run, to begin again with it.
bool IsConfigRight(const std::filesystem::path& config_folder, const Params& running) {
  try {
    lookout::config::FaultList faults;
    faults.Try([&] { lookout::runtime::EffectiveConfig(config_folder, {"boat.txtpb"}); });
    const auto params = faults.Take([&] { return lookout::vlp16::LoadChecked(config_folder); });
    faults.ThrowIfAny();
    TrySources(*params, running);
    return true;
  } catch (const lookout::config::ConfigError& error) {
    for (const auto& fault : error.faults()) spdlog::error("{}", fault);
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
  }
  spdlog::error("SIGHUP: the new config is wrong; goes on with the old one");
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  lookout::runtime::BlockStopSignals();
  const auto options =
      lookout::runtime::ParseOptions(argc, argv, "lookout-vlp16", "VLP-16 datagrams in; LIDAR_PACKETS, LIDAR_SCAN, LIDAR_CLOCK, LIDAR_NMEA out");
  bool starts_again = false;
  const int code = lookout::runtime::RunMain("vlp16", [&] {
    if (options.check_only) {
      lookout::config::FaultList faults;
      const auto text = faults.Take([&] { return lookout::runtime::EffectiveConfig(options.config_folder, {"boat.txtpb", "vlp16.txtpb"}); });
      faults.Try([&] { lookout::vlp16::LoadChecked(options.config_folder); });
      faults.ThrowIfAny();
      std::cout << *text;
      return;
    }
    const auto params = lookout::vlp16::LoadChecked(options.config_folder);
    lookout::runtime::Process process("vlp16", options.lcm_url);
    process.OnHangup([&] {
      if (!IsConfigRight(options.config_folder, params)) return;
      spdlog::info("SIGHUP: starts again with the new config");
      starts_again = true;
      process.Stop();
    });
    RunSource(process, params);
  });
  if (code != EXIT_SUCCESS || !starts_again) return code;
  return lookout::runtime::RunMain("vlp16", [argv] { lookout::runtime::ExecuteAgain(argv); });
}
