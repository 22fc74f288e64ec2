#include "tools/replay/live_run.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <map>
#include <utility>

#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "common/io/stop_signal.hpp"
#include "lookout/alerts_t.hpp"
#include "services/tracker/wire.hpp"

namespace lookout::replay {

namespace {

// Messages of ALERTS of one process, one behind the other in the log, while time goes on.
struct Told {
  tracker::ScanKey begin;  // at which the process began
  tracker::ScanKey first;
  tracker::ScanKey last;
  std::map<tracker::ScanKey, std::vector<tracker::Acknowledgement>> acknowledged;
  std::map<tracker::ScanKey, std::vector<tracker::Order>> orders;
};

void Add(const alerts_t& message, std::vector<Told>& log) {
  const auto time = UtimeFromWire(message.utime_us);
  const auto begin_time = UtimeFromWire(message.begin_utime_us);
  if (message.is_watch || !time || !begin_time) return;  // of the watch: by the host's clock
  const tracker::ScanKey key{*time, message.seq};
  const tracker::ScanKey begin{*begin_time, message.begin_seq};
  if (log.empty() || log.back().begin != begin || key < log.back().last) log.push_back({begin, key, key, {}, {}});
  log.back().last = key;
  for (const auto& acknowledgement : message.acknowledged) {
    if (!messages::FaultOf(acknowledgement)) log.back().acknowledged[key].push_back(tracker::ToAcknowledgement(acknowledgement));
  }
  for (const auto& order : message.orders) {
    if (!messages::FaultOf(order)) log.back().orders[key].push_back(tracker::ToOrder(order));
  }
}

// From the first to the last ALERTS of a process, by their place in the log.
struct Heard {
  tracker::ScanKey begin;
  std::size_t first;
  std::size_t last;
};

// The processes of the run, each first and last heard later than the one before. An intruder is a second tracker: it is heard only between two ALERTS
// of another process, or from before one process ended until after the next began.
std::vector<Heard> ProcessesOfTheRun(const std::vector<Told>& log) {
  std::vector<Heard> heard;
  std::map<tracker::ScanKey, std::size_t> place_of;
  for (std::size_t i = 0; i < log.size(); ++i) {
    const auto [place, is_new] = place_of.try_emplace(log[i].begin, heard.size());
    if (is_new) heard.push_back({log[i].begin, i, i});
    heard[place->second].last = i;
  }
  std::vector<Heard> run;
  for (const auto& one : heard) {
    if (!run.empty() && one.last < run.back().last) continue;
    if (run.size() >= 2) {
      const auto& before = run[run.size() - 2];
      const auto& between = run.back();
      if (between.first < before.last && before.last < one.first && one.first < between.last) run.pop_back();
    }
    run.push_back(one);
  }
  return run;
}

// Where two processes overlap, the later one counts from its first ALERTS on, the earlier one until then.
std::vector<Told> WithoutIntruders(std::vector<Told> log) {
  std::vector<Told> rest;
  const auto run = ProcessesOfTheRun(log);
  for (auto process = run.begin(); process != run.end(); ++process) {
    const auto end = std::next(process) == run.end() ? log.size() : std::next(process)->first;
    for (auto i = process->first; i < end; ++i) {
      if (log[i].begin == process->begin) rest.push_back(std::move(log[i]));
    }
  }
  return rest;
}

tracker::Script ToScript(const std::vector<Told>& log) {
  tracker::Script script;
  auto& stretches = script.stretches;
  for (const auto& told : log) {
    if (stretches.empty() || stretches.back().begin != told.begin) {
      stretches.push_back({told.begin, told.begin, told.last});  // also where the first ALERTS were lost
    } else if (told.first < stretches.back().last) {
      stretches.push_back({told.begin, told.first, told.last});
    } else {
      stretches.back().last = told.last;
    }
    for (const auto& [key, acknowledgements] : told.acknowledged) {
      std::ranges::copy(acknowledgements, std::back_inserter(script.acknowledged[key]));
    }
    for (const auto& [key, orders] : told.orders) std::ranges::copy(orders, std::back_inserter(script.orders[key]));
  }
  return script;
}

}  // namespace

std::optional<tracker::Script> ReadScript(const std::vector<std::filesystem::path>& logs, const std::function<void(std::int64_t)>& show) {
  std::vector<Told> told;
  std::int64_t done_bytes = 0;
  for (const auto& log : logs) {
    bus::LogReader reader(log, io::ThrowIfStopAsked);
    const auto is_read = [](std::string_view channel) { return channel == bus::kAlerts.name; };
    while (const auto event = reader.NextView(is_read)) {
      io::ThrowIfStopAsked();
      if (show) show(done_bytes + reader.position_bytes());
      if (event->channel != bus::kAlerts.name) continue;
      if (const auto message = bus::Decode<alerts_t>(event->bytes)) Add(*message, told);
    }
    done_bytes += reader.size_bytes();
  }
  if (told.empty()) return std::nullopt;
  return ToScript(WithoutIntruders(std::move(told)));
}

}  // namespace lookout::replay
