#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <optional>
#include <ostream>

#include "common/bus/channels.hpp"
#include "common/core/log_time.hpp"
#include "common/io/file_kind.hpp"
#include "tools/log/commands.hpp"
#include "tools/log/event_reader.hpp"
#include "tools/log/log_output.hpp"
#include "tools/log/log_span.hpp"

namespace lookout::log {

namespace {

// Copies events. They keep their numbers, which are not always 0, 1, 2: a log to which a recorder appended begins anew, and some writers give each
// the same. From the first event on that is left out they are numbered on from the last, as LCM's own tools do.
class Copier {
 public:
  explicit Copier(LogOutput& output) : output_(output) {}

  void Write(const EventReader& reader, const bus::LogEvent& event) {
    const auto number = is_numbered_anew_ ? output_.next_number() : event.number;
    output_.WriteNumbered(number, event.time, event.channel, event.bytes, event.num_data_bytes);
    reader.ReadRest(event, [this](Bytes bytes) { output_.Append(bytes); });
  }

  void NumberAnew() { is_numbered_anew_ = true; }

 private:
  LogOutput& output_;
  bool is_numbered_anew_ = false;
};

std::optional<Utime> LimitOf(const std::string& option, const std::string& text, const LogSpan& span) {
  if (text.empty()) return std::nullopt;
  const auto found = FindTime(option, text, span);
  if (!found.time) throw UsageError(found.fault);
  return found.time;
}

}  // namespace

void Slice(const SliceRequest& request, std::ostream& out, std::ostream& errors, std::FILE* progress) {
  const auto span = SpanOf(request.inputs);
  const auto from = LimitOf("--from", request.from, span);
  const auto to = LimitOf("--to", request.to, span);
  if (from && to && *from >= *to) throw UsageError("--from must be before --to");

  // All inputs are opened first: a mistyped name must not cost an hour of reading.
  std::deque<EventReader> readers;
  for (const auto& file : request.inputs) readers.emplace_back(file);
  LogOutput output(request.output, {.force = request.force, .inputs = request.inputs});
  Copier copier(output);
  std::optional<bus::LogEvent> run_info;  // the last in front of the slice
  std::int64_t num_events = 0;            // of the slice
  ReadProgress shown(progress, request.inputs);
  for (std::size_t i = 0; i < readers.size(); ++i) {
    auto& reader = readers[i];
    const auto& file = request.inputs[i];
    if (i > 0) copier.NumberAnew();  // rotated logs, each with numbers from 0, become one log
    while (auto event = reader.Next()) {
      shown.Show(reader.position_bytes());
      const bool is_run_info = event->channel == bus::kRunInfo.name;
      const bool is_wanted = request.channels.empty() || std::ranges::find(request.channels, event->channel) != request.channels.end();
      if (is_wanted && (!from || event->time >= *from) && (!to || event->time < *to)) {
        if (num_events == 0 && run_info && !is_run_info) {
          run_info->time = event->time;
          copier.Write(reader, *run_info);
        }
        copier.Write(reader, *event);
        ++num_events;
        continue;
      }
      copier.NumberAnew();
      if (is_run_info && num_events == 0 && event->bytes.size() == event->num_data_bytes) run_info = std::move(event);
    }
    shown.EndFile(reader.size_bytes());
    if (!reader.damage().empty()) errors << fmt::format("{}: {} damaged stretches were skipped\n", file.string(), reader.damage().size());
  }
  if (num_events == 0) throw std::runtime_error("no event of that time and channel");
  auto& lines = output.IsStandardOutput() ? errors : out;  // a log that goes there is not mixed with lines
  output.Commit();
  lines << fmt::format("{}: {} events\n", request.output.string(), output.num_events());
}

void Repair(const std::filesystem::path& input, const std::filesystem::path& output_file, bool force, std::ostream& out, std::ostream& errors,
            std::FILE* progress) {
  EventReader reader(input);
  ReadProgress shown(progress, {input});
  LogOutput output(output_file, {.force = force, .inputs = {input}});
  Copier copier(output);
  auto& lines = output.IsStandardOutput() ? errors : out;  // a log that goes there is not mixed with lines
  std::optional<Utime> last;
  std::size_t num_named = 0;
  const auto name_damage = [&](const std::string& next) {
    for (; num_named < reader.damage().size(); ++num_named) {
      const auto& stretch = reader.damage()[num_named];
      shown.Clear();
      lines << fmt::format("lost: {} bytes at byte {}, between {} and {}\n", stretch.size_bytes, stretch.offset_bytes,
                           last ? TimeText(*last) : "the start", next);
    }
  };
  while (const auto event = reader.Next()) {
    shown.Show(reader.position_bytes());
    name_damage(TimeText(event->time));
    copier.Write(reader, *event);
    last = event->time;
  }
  shown.Clear();
  name_damage("the end");
  if (reader.num_events() == 0) throw std::runtime_error(io::NoEventText(input));
  output.Commit();
  lines << fmt::format("{}: {} events of {} kept, {} bytes lost in {} stretches\n", output_file.string(), output.num_events(), input.string(),
                       reader.num_damaged_bytes(), reader.damage().size());
}

}  // namespace lookout::log
