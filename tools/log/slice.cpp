#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <optional>
#include <ostream>

#include "common/bus/channels.hpp"
#include "tools/log/commands.hpp"
#include "tools/log/event_reader.hpp"
#include "tools/log/log_output.hpp"
#include "tools/log/time_text.hpp"

namespace lookout::log {

namespace {

Utime FirstTime(const std::vector<std::filesystem::path>& files) {
  for (const auto& file : files) {
    EventReader reader(file);
    if (const auto event = reader.Next()) return event->time;
  }
  throw std::runtime_error(files.front().string() + ": is no lcm-log: it holds no event");
}

std::optional<Utime> LimitOf(const std::string& option, const std::string& text, Utime start) {
  if (text.empty()) return std::nullopt;
  const auto time = ParseTime(text, start);
  if (!time) throw UsageError(option + " " + text + ": is neither seconds from the start (12.5) nor UTC (2026-11-21T13:45:01.5Z)");
  return time;
}

}  // namespace

void Slice(const SliceRequest& request, std::ostream& out, std::ostream& errors) {
  const auto start = FirstTime(request.inputs);
  const auto from = LimitOf("--from", request.from, start);
  const auto to = LimitOf("--to", request.to, start);
  if (from && to && *from >= *to) throw UsageError("--from must be before --to");

  // All inputs are opened first: a mistyped name must not cost an hour of reading.
  std::deque<EventReader> readers;
  for (const auto& file : request.inputs) readers.emplace_back(file);
  LogOutput output(request.output, {.force = request.force, .inputs = request.inputs});
  std::optional<bus::LogEvent> run_info;  // the last in front of the slice
  std::int64_t num_events = 0;            // of the slice
  for (std::size_t i = 0; i < readers.size(); ++i) {
    auto& reader = readers[i];
    const auto& file = request.inputs[i];
    while (auto event = reader.Next()) {
      const bool is_run_info = event->channel == bus::kRunInfo.name;
      const bool is_wanted = request.channels.empty() || std::ranges::find(request.channels, event->channel) != request.channels.end();
      if (is_wanted && (!from || event->time >= *from) && (!to || event->time < *to)) {
        if (num_events == 0 && run_info && !is_run_info) output.Write(event->time, run_info->channel, run_info->bytes);
        output.Write(*event);
        ++num_events;
      } else if (is_run_info && num_events == 0) {
        run_info = std::move(event);
      }
    }
    if (!reader.damage().empty()) errors << fmt::format("{}: {} damaged stretches were skipped\n", file.string(), reader.damage().size());
  }
  if (num_events == 0) throw std::runtime_error("no event of that time and channel");
  auto& lines = output.IsStandardOutput() ? errors : out;  // a log that goes there is not mixed with lines
  output.Commit();
  lines << fmt::format("{}: {} events\n", request.output.string(), output.num_events());
}

}  // namespace lookout::log
