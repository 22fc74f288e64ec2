// The lidar process: datagrams of a VLP-16, captures of them, or LIDAR_PACKETS in; LIDAR_PACKETS, LIDAR_NMEA, LIDAR_CLOCK, LIDAR_SCAN out.
#include <algorithm>
#include <chrono>
#include <iostream>
#include <spdlog/spdlog.h>

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

namespace {

using lookout::HealthReport;
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

// Gives to `take` what `next` has, for kMaxRound at most. @return whether nothing waits any more
template <typename Next, typename Take>
bool Drain(const Next& next, const Take& take) {
  const auto end = std::chrono::steady_clock::now() + kMaxRound;
  while (std::chrono::steady_clock::now() < end) {
    const auto datagram = next();
    if (!datagram) return true;
    take(*datagram);
  }
  return false;
}

// What is text in the params and must be right before anything starts.
void CheckSources(const std::filesystem::path& config_folder, const Sources& sources) {
  const auto file = config_folder / "vlp16.txtpb";
  std::vector<std::string> faults;
  const auto require = [&](bool is_fine, const char* field, const std::string& reason) {
    if (!is_fine) faults.push_back(lookout::config::FaultLine(file, field, reason));
  };
  for (const auto& text : sources.allowed_source_addresses) {
    const auto address = lookout::io::ParseIpAddress(text);
    require(address && !address->is_multicast(), "allowed_source_address", "'" + text + "' is no numeric address of a sensor");
  }
  const auto bound = lookout::io::ParseIpAddress(sources.bind_address.substr(0, sources.bind_address.find('%')));
  if (sources.kind == Sources::Kind::kUdp) require(bound.has_value(), "bind_address", "'" + sources.bind_address + "' is no numeric address");
  if (!sources.multicast_group.empty()) {
    const auto group = lookout::io::ParseIpAddress(sources.multicast_group);
    require(group && group->is_multicast(), "multicast_group", "'" + sources.multicast_group + "' is no multicast address (224.0.0.0/4, ff00::/8)");
    require(!group || !bound || group->is_ipv4() == bound->is_ipv4(), "multicast_group", "must be of the same family as bind_address");
  }
  if (!sources.bpf_filter.empty()) {
    const auto fault = lookout::vlp16::FilterFault(sources.bpf_filter);
    require(fault.empty(), "bpf_filter", fault);
  }
  if (!faults.empty()) throw lookout::config::ConfigError(faults);
}

Params LoadChecked(const std::filesystem::path& config_folder) {
  auto params = lookout::vlp16::LoadParams(config_folder);
  CheckSources(config_folder, params.sources);
  return params;
}

void LogNotice(const std::string& notice) { spdlog::info("{}", notice); }

void RunLog(lookout::runtime::Process& process, const Params& params) {
  lookout::vlp16::Service service(process.bus(), params);
  service.OnNotice(LogNotice);
  process.Run([&service] { return service.Report(); });
  service.Finish(HostNow());
}

lookout::io::UdpOptions ToUdpOptions(const Sources& sources, int port) {
  return {.bind_address = sources.bind_address,
          .port = port,
          .receive_buffer_bytes = sources.receive_buffer_bytes,
          .interface = sources.interface,
          .multicast_group = sources.multicast_group,
          .allowed_source_addresses = sources.allowed_source_addresses};
}

void RunUdp(lookout::runtime::Process& process, const Params& params) {
  lookout::vlp16::Service service(process.bus(), params);
  service.OnNotice(LogNotice);
  lookout::io::UdpReceiver data(ToUdpOptions(params.sources, params.data_port));
  lookout::io::UdpReceiver position(ToUdpOptions(params.sources, params.position_port));
  for (auto* receiver : {&data, &position}) {
    if (receiver->receive_buffer_bytes() >= params.sources.receive_buffer_bytes) continue;
    spdlog::warn("port {}: the kernel grants a receive buffer of {} bytes, {} were asked for (sysctl net.core.rmem_max)", receiver->port(),
                 receiver->receive_buffer_bytes(), params.sources.receive_buffer_bytes);
  }
  process.Every(kDrainPeriod, [&] {
    const auto now = HostNow();  // what was stamped before it is taken below
    bool is_empty = true;
    for (auto* receiver : {&data, &position}) {
      is_empty = Drain([receiver] { return receiver->Receive(); },
                       [&](const auto& datagram) { service.OnDatagram(datagram.host_time, datagram.port, datagram.payload); }) &&
                 is_empty;
    }
    if (is_empty) service.AdvanceTo(now);
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
    return report;
  });
  service.Finish(HostNow());
}

lookout::vlp16::LiveOptions ToLiveOptions(const Params& params) {
  lookout::vlp16::LiveOptions options;
  options.interface = params.sources.interface;
  options.filter = params.sources.bpf_filter;
  options.data_port = params.data_port;
  options.position_port = params.position_port;
  options.receive_buffer_bytes = params.sources.receive_buffer_bytes;
  for (const auto& text : params.sources.allowed_source_addresses) {
    options.allowed_source_addresses.push_back(lookout::io::ToText(*lookout::io::ParseIpAddress(text)));
  }
  return options;
}

void RunInterface(lookout::runtime::Process& process, const Params& params) {
  lookout::vlp16::Service service(process.bus(), params);
  service.OnNotice(LogNotice);
  lookout::vlp16::LiveCapture capture(ToLiveOptions(params));
  if (capture.fault().empty()) {
    spdlog::info("captures on interface '{}', filter: {}", params.sources.interface, capture.filter());
  } else {
    spdlog::warn("{}; waiting for it", capture.fault());
  }
  process.Every(kDrainPeriod, [&] {
    const auto now = HostNow();  // what was stamped before it is taken below
    const bool is_empty =
        Drain([&capture] { return capture.Next(); },
              [&service](const auto& datagram) { service.OnDatagram(datagram.host_time, datagram.destination_port, datagram.payload); });
    if (is_empty) service.AdvanceTo(now);
  });
  process.Every(kInterfacePeriod, [&] {
    const auto event = capture.FollowInterface();
    if (!event.empty()) spdlog::warn("{}", event);
  });
  process.Run([&] {
    HealthReport report = service.Report();
    for (const auto& counter : capture.counters()) report.counters.push_back(counter);
    if (!capture.fault().empty()) {
      report.state = std::max(report.state, lookout::HealthState::kDegraded);
      report.reason = capture.fault() + (report.reason.empty() ? "" : "; ") + report.reason;
    }
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
    Drain([&] { return player.NextDue(elapsed()); },
          [&service](const auto& datagram) { service.OnDatagram(datagram.host_time, datagram.destination_port, datagram.payload); });
    service.AdvanceTo(player.CaptureTime(elapsed()));
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

// SIGHUP: a wrong config is told and changes nothing; a right one ends the run, to begin again with it.
bool IsConfigRight(const std::filesystem::path& config_folder) {
  try {
    const auto params = LoadChecked(config_folder);
    for (const auto& file : params.sources.capture_files) lookout::vlp16::CaptureReader{file};
    lookout::runtime::EffectiveConfig(config_folder, {"boat.txtpb"});
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
  const auto options = lookout::runtime::ParseOptions(argc, argv, "lookout-vlp16", "VLP-16 datagrams in; LIDAR_PACKETS, LIDAR_SCAN out");
  bool starts_again = false;
  const int code = lookout::runtime::RunMain("vlp16", [&] {
    const auto params = LoadChecked(options.config_folder);
    if (options.check_only) {
      std::cout << lookout::runtime::EffectiveConfig(options.config_folder, {"boat.txtpb", "vlp16.txtpb"});
      return;
    }
    lookout::runtime::Process process("vlp16", options.lcm_url);
    process.OnHangup([&] {
      if (!IsConfigRight(options.config_folder)) return;
      spdlog::info("SIGHUP: starts again with the new config");
      starts_again = true;
      process.Stop();
    });
    RunSource(process, params);
  });
  if (code != EXIT_SUCCESS || !starts_again) return code;
  return lookout::runtime::RunMain("vlp16", [argv] { lookout::runtime::ExecuteAgain(argv); });
}
