// The navigation process: sentences of all inputs and LIDAR_NMEA, or NAV_RAW, in; NAV_RAW, GNSS_FIX, ATTITUDE and POSE out.
#include <fmt/format.h>

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
#include "services/navigator/io/text_log_player.hpp"
#include "services/navigator/params.hpp"
#include "services/navigator/service.hpp"
#include "services/navigator/sources.hpp"

namespace {

using lookout::Utime;
using lookout::navigator::Params;
using lookout::navigator::Service;
using lookout::navigator::Source;
using lookout::navigator::TextLogPlayer;
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

  // @return arrival of the latest piece; Utime() without one
  Utime Drain(Service& service) {
    Utime latest{};
    for (int i = 0; i < kMaxPiecesPerRound; ++i) {
      const auto piece = source->Receive(HostNow());
      if (source->num_lost() != num_lost) service.OnStreamEnd(name);
      num_lost = source->num_lost();
      if (!piece) break;
      latest = std::max(latest, piece->host_time);
      if (piece->is_datagram) {
        service.OnDatagram(piece->host_time, piece->bytes, name);
      } else {
        service.OnStream(piece->host_time, piece->bytes, name);
      }
    }
    TellFault();
    return latest;
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

// 2014-04-03 08:54:11
std::string DayAndTime(lookout::Utime time) {
  const auto day = std::chrono::floor<std::chrono::days>(time);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss clock(std::chrono::floor<std::chrono::seconds>(time - day));
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02}:{:02}", static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                     static_cast<unsigned>(date.day()), clock.hours().count(), clock.minutes().count(), clock.seconds().count());
}

// Text logs have times of their own: the clock of this computer tells no more than when a line is due.
void RunTextLogs(lookout::runtime::Process& process, const Params& params) {
  Service service(process.bus(), params);
  std::vector<TextLogPlayer::Log> logs;
  for (const auto& connection : params.connections) {
    if (!lookout::navigator::IsTextLog(connection.file)) {
      throw std::runtime_error("text log " + connection.file.string() + ": holds no sentence of NMEA 0183");
    }
    logs.push_back({connection.name, connection.file, connection.day});
  }
  TextLogPlayer player(logs, params.connections.front().speed);
  std::string reason = "plays a text log of " + DayAndTime(player.start()) + " UTC, so POSE is not of now: what is measured now finds none";
  for (const auto& name : player.dateless()) reason += "; no sentence of input '" + name + "' tells a date, set text_log.date";
  spdlog::warn("{}", reason);
  const TextLogPlayer::Taker taker{
      [&service](lookout::Utime time) { service.AdvanceTo(time); },
      [&service](lookout::Utime time, lookout::Bytes line, const std::string& name) { service.OnDatagram(time, line, name); }};
  process.Every(kTick, [&] {
    player.Play(std::chrono::steady_clock::now(), taker);
    if (player.is_finished()) process.Stop();
  });
  process.Run([&] {
    auto report = service.Report();
    for (const auto& counter : player.counters()) report.counters.push_back(counter);
    report.state = std::max(report.state, lookout::HealthState::kDegraded);
    report.reason = reason + (report.reason.empty() ? "" : "; ") + report.reason;
    return report;
  });
  service.Finish(player.time());
}

bool IsTextLogs(const Params& params) {
  const auto is_text_log = [](const auto& connection) { return connection.kind == lookout::navigator::Connection::Kind::kTextLog; };
  return !params.connections.empty() && std::ranges::all_of(params.connections, is_text_log);
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
    auto latest = now;
    for (auto& feed : feeds) {
      feed.source->Poll(now);
      // Also without an event: libgps may hold lines that it has read already.
      latest = std::max(latest, feed.Drain(service));
    }
    // Where the process stood still since `now`, that is behind what it took: it would look like a clock that was set back.
    service.AdvanceTo(latest);
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
    } else if (IsTextLogs(params)) {
      RunTextLogs(process, params);
    } else {
      RunLive(process, params);
    }
  });
  if (code != EXIT_SUCCESS || !starts_again) return code;
  return lookout::runtime::RunMain("navigator", [argv] { lookout::runtime::ExecuteAgain(argv); });
}
