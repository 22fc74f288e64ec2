// The navigation process: sentences of all inputs and LIDAR_NMEA, or NAV_RAW, in; NAV_RAW, GNSS_FIX, ATTITUDE and POSE out.
#include <algorithm>
#include <chrono>
#include <iostream>
#include <memory>
#include <spdlog/spdlog.h>
#include <string>
#include <vector>

#include "common/config/text_config.hpp"
#include "common/runtime/execute_again.hpp"
#include "common/runtime/options.hpp"
#include "common/runtime/process.hpp"
#include "common/runtime/run_info.hpp"
#include "services/navigator/io/source.hpp"
#include "services/navigator/params.hpp"
#include "services/navigator/service.hpp"
#include "services/navigator/sources.hpp"

namespace {

using lookout::navigator::Params;
using lookout::navigator::Service;
using lookout::navigator::Source;
using lookout::runtime::HostNow;

// How late a tick may come: a tenth of its period.
constexpr std::chrono::milliseconds kTick(10);
// Pieces taken from a source before the bus and the timers get their turn again.
constexpr int kMaxPiecesPerRound = 64;

// One source, and what main remembers of it.
struct Feed {
  std::string name;
  std::unique_ptr<Source> source;
  std::int64_t num_lost = 0;
  std::string last_fault = {};

  void Drain(Service& service) {
    for (int i = 0; i < kMaxPiecesPerRound; ++i) {
      const auto piece = source->Receive(HostNow());
      if (source->num_lost() != num_lost) service.OnStreamEnd(name);
      num_lost = source->num_lost();
      if (!piece) break;
      if (piece->is_datagram) {
        service.OnDatagram(piece->host_time, piece->bytes, name);
      } else {
        service.OnStream(piece->host_time, piece->bytes, name);
      }
    }
    TellFault();
  }

  // Once for each change.
  void TellFault() {
    const auto fault = source->fault();
    if (fault == last_fault) return;
    if (fault.empty()) {
      spdlog::info("input '{}' is open", name);
    } else {
      spdlog::warn("input '{}': {}", name, fault);
    }
    last_fault = fault;
  }
};

void RunLog(lookout::runtime::Process& process, const Params& params) {
  Service service(process.bus(), params);
  process.Run([&service] { return service.Report(); });
  service.Finish(HostNow());
}

void RunLive(lookout::runtime::Process& process, const Params& params) {
  Service service(process.bus(), params);
  std::vector<Feed> feeds;
  for (const auto& connection : params.connections) feeds.push_back({.name = connection.name, .source = lookout::navigator::OpenSource(connection)});
  for (auto& feed : feeds) {
    if (feed.source->file_descriptor() >= 0) process.OnReadable(feed.source->file_descriptor(), [&feed, &service] { feed.Drain(service); });
  }
  process.Every(kTick, [&] {
    const auto now = HostNow();
    for (auto& feed : feeds) {
      feed.source->Poll(now);
      // Also without an event: libgps may hold lines that it has read already, and a text log goes by time.
      feed.Drain(service);
    }
    service.AdvanceTo(now);
    const bool is_over =
        !feeds.empty() && !params.use_lidar_nmea && std::ranges::all_of(feeds, [](const Feed& f) { return f.source->is_finished(); });
    if (is_over) process.Stop();
  });
  process.Run([&] {
    auto report = service.Report();
    for (auto& feed : feeds) {
      for (const auto& counter : feed.source->counters()) report.counters.push_back(counter);
      const auto fault = feed.source->fault();
      if (fault.empty()) continue;
      report.state = std::max(report.state, lookout::HealthState::kDegraded);
      report.reason = "input '" + feed.name + "': " + fault + (report.reason.empty() ? "" : "; ") + report.reason;
    }
    return report;
  });
  service.Finish(HostNow());
}

// SIGHUP: a wrong config is told and changes nothing; a right one ends the run, to begin again with it.
bool IsConfigRight(const std::filesystem::path& config_folder) {
  try {
    lookout::navigator::LoadParams(config_folder);
    return true;
  } catch (const lookout::config::ConfigError& error) {
    for (const auto& fault : error.faults()) spdlog::error("{}", fault);
  }
  spdlog::error("SIGHUP: the new config is wrong; goes on with the old one");
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  lookout::runtime::BlockStopSignals();
  const auto options = lookout::runtime::ParseOptions(argc, argv, "lookout-navigator", "NMEA 0183 in; NAV_RAW, GNSS_FIX, ATTITUDE, POSE out");
  bool starts_again = false;
  const int code = lookout::runtime::RunMain("navigator", [&] {
    const auto params = lookout::navigator::LoadParams(options.config_folder);
    if (options.check_only) {
      std::cout << lookout::runtime::EffectiveConfig(options.config_folder, {"boat.txtpb", "navigator.txtpb"}) << lookout::navigator::InWords(params);
      return;
    }
    lookout::runtime::Process process("navigator", options.lcm_url);
    process.OnHangup([&] {
      if (!IsConfigRight(options.config_folder)) return;
      spdlog::info("SIGHUP: starts again with the new config");
      starts_again = true;
      process.Stop();
    });
    if (params.input == lookout::navigator::Input::kLog) {
      RunLog(process, params);
    } else {
      RunLive(process, params);
    }
  });
  if (code != EXIT_SUCCESS || !starts_again) return code;
  return lookout::runtime::RunMain("navigator", [argv] { lookout::runtime::ExecuteAgain(argv); });
}
