#include "common/runtime/source_reader.hpp"

#include <algorithm>
#include <set>
#include <spdlog/spdlog.h>
#include <utility>

namespace lookout::runtime {

namespace {

std::string Label(const LiveReader::NamedSource& source) { return source.name.empty() ? "" : "input '" + source.name + "': "; }

}  // namespace

LiveReader::LiveReader(std::vector<NamedSource> sources, const Limits& limits, Handlers handlers)
    : SourceReader(limits.period), sources_(std::move(sources)), limits_(limits), handlers_(std::move(handlers)) {}

// @return arrival of the latest piece; Utime() without one
Utime LiveReader::ReadOne(NamedSource& source) {
  Utime latest{};
  const auto end = SteadyNow() + limits_.max_time;
  for (int i = 0; i < limits_.max_pieces && SteadyNow() < end; ++i) {
    if (const auto piece = source.source->Receive(HostNow())) {
      latest = std::max(latest, piece->host_time);
      handlers_.on_piece(source.name, *piece);
    } else if (source.source->is_empty()) {
      break;
    }
  }
  return latest;
}

bool LiveReader::Read() {
  const auto now = HostNow();  // earlier bytes are read below
  Round round{now, now, now};
  for (auto& entry : sources_) {
    auto& source = *entry.source;
    const auto change = source.Poll(now);
    if (!change.empty() && source.fault().empty()) spdlog::info("{}{}", Label(entry), change);
    if (!change.empty() && !source.fault().empty()) spdlog::warn("{}{}", Label(entry), change);
    round.latest = std::max(round.latest, ReadOne(entry));
    if (!source.is_empty()) round.read_before = std::min(round.read_before, source.last_time());
  }
  handlers_.on_round(round);
  return true;
}

void LiveReader::WatchReadable(Process& process) {
  if (!limits_.reads_when_readable) return;
  for (auto& source : sources_) {
    if (source.source->file_descriptor() >= 0) process.OnReadable(source.source->file_descriptor(), [this, &source] { ReadOne(source); });
  }
}

std::string LiveReader::fault() const {
  std::set<std::string> faults;
  for (const auto& entry : sources_) {
    const auto fault = entry.source->fault();
    if (!fault.empty()) faults.insert(Label(entry) + fault);
  }
  std::string text;
  for (const auto& fault : faults) text += (text.empty() ? "" : "; ") + fault;
  return text;
}

std::vector<Counter> LiveReader::counters() const {
  std::vector<Counter> sums;
  for (const auto& entry : sources_) {
    for (const auto& [name, count] : entry.source->counters()) {
      auto same = std::ranges::find(sums, name, &Counter::name);
      if (same == sums.end()) same = sums.insert(same, {name, 0});
      same->count += count;
    }
  }
  return sums;
}

Utime RunSources(Process& process, SourceReader* sources, const std::function<HealthReport()>& report) {
  if (sources == nullptr) {
    process.Run(report);
    return HostNow();
  }
  sources->WatchReadable(process);
  process.Every(sources->period(), [&] {
    if (!sources->Read()) process.Stop();
  });
  process.Run([&] {
    auto result = report();
    for (const auto& counter : sources->counters()) result.counters.push_back(counter);
    if (const auto fault = sources->fault(); !fault.empty()) {
      result.state = std::max(result.state, HealthState::kDegraded);
      result.reason = fault + (result.reason.empty() ? "" : "; ") + result.reason;
    }
    return result;
  });
  return sources->Now();
}

}  // namespace lookout::runtime
