#include "tools/export/export.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <system_error>

#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "common/config/text_config.hpp"
#include "common/core/log_time.hpp"
#include "common/core/printable.hpp"
#include "common/io/file_kind.hpp"
#include "common/io/output_file.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/progress.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/tracks_t.hpp"
#include "tools/export/outputs.hpp"
#include "tools/export/second_lidar.hpp"
#include "tools/export/sinks.hpp"
#include "tools/log/log_span.hpp"
#include "tools/log/other_type.hpp"
#include "tools/log/pose_counts.hpp"

namespace lookout::exporter {

namespace {

constexpr std::string_view kProgram = "lookout-export: ";

// Messages on the sink's channels.
struct Tally {
  bus::Channel channel;
  std::int64_t num_taken = 0;
  std::int64_t num_of_other_type = 0;
  std::int64_t num_undecodable = 0;
  std::int64_t num_inconsistent = 0;
};

std::string SpanFault(const Span& span) { return span.from_us && span.to_us && *span.from_us >= *span.to_us ? "--from is not before --to" : ""; }

// @return the fault of the request; empty when there is none
std::string Fault(const Request& request) {
  if (auto fault = OutputFault(request); !fault.empty()) return fault;
  if (auto fault = SpanFault(request.span); !fault.empty()) return fault;
  for (const auto& input : request.inputs) {
    std::error_code error;
    if (request.output && std::filesystem::equivalent(input, *request.output, error)) return "--out is one of the inputs: " + input.string();
  }
  return "";
}

// By their first events: a map is made in the order of time, whatever the order of the logs.
std::vector<std::filesystem::path> InOrderOfTime(std::vector<std::filesystem::path> inputs) {
  std::vector<std::pair<Utime, std::filesystem::path>> by_time;
  by_time.reserve(inputs.size());
  for (auto& input : inputs) {
    bus::LogReader reader(input, io::ThrowIfStopAsked);
    const auto event = reader.NextView([](std::string_view) { return false; });
    by_time.emplace_back(event ? event->time : Utime(), std::move(input));
  }
  std::ranges::sort(by_time);
  std::ranges::transform(by_time, inputs.begin(), [](auto& one) { return std::move(one.second); });
  return inputs;
}

// How much later events were logged than measured, where this is more than a live bus explains: the log was recorded while an old log was played.
// The first message of the table decides.
std::chrono::microseconds AgeOfMessages(const std::vector<std::filesystem::path>& inputs, const std::string& channel) {
  constexpr std::chrono::minutes kUsual(1);
  for (const auto& input : inputs) {
    bus::LogReader reader(input, io::ThrowIfStopAsked);
    while (const auto event = reader.NextHead([&](std::string_view name) { return name == channel ? kTimeEndBytes : 0; })) {
      io::ThrowIfStopAsked();
      const auto utime_us = event->channel == channel ? UtimeUsOf(event->bytes) : std::nullopt;
      const auto time = utime_us ? UtimeFromWire(*utime_us) : std::nullopt;
      if (!time) continue;
      const auto age = event->time - *time;
      return std::chrono::abs(age) > kUsual ? age : std::chrono::microseconds(0);
    }
  }
  return std::chrono::microseconds(0);
}

// A command line that is wrong for this log.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// @throws UsageError
Span SpanOf(const Request& request, const std::string& channel) {
  if (request.from.empty() && request.to.empty()) return request.span;
  auto log = log::SpanOf(request.inputs);
  const auto age = AgeOfMessages(request.inputs, channel);
  log = {log.begin - age, log.end - age};
  const auto time_of = [&](const char* option, const std::string& text) -> std::optional<std::int64_t> {
    if (text.empty()) return std::nullopt;
    const auto found = FindTime(option, text, log);
    if (!found.time) throw UsageError(found.fault);
    return ToUtimeUs(*found.time);
  };
  const Span span{time_of("--from", request.from), time_of("--to", request.to)};
  if (const auto fault = SpanFault(span); !fault.empty()) throw UsageError(fault);
  return span;
}

void Tell(std::ostream& errors, const Sink& sink, const std::vector<Tally>& tallies) {
  for (const auto& tally : tallies) {
    if (tally.num_of_other_type > 0) errors << kProgram << log::OtherTypeText(tally.channel, tally.num_of_other_type) << '\n';
    if (tally.num_undecodable > 0) errors << kProgram << tally.num_undecodable << " messages of " << tally.channel.name << " could not be decoded\n";
    if (tally.num_inconsistent > 0)
      errors << kProgram << tally.num_inconsistent << " messages of " << tally.channel.name << " contradict themselves\n";
  }
  for (const auto& remark : sink.Remarks()) errors << kProgram << remark << '\n';
}

// Whether the requested table has a place on the earth, and why not.
class PlacedRows {
 public:
  explicit PlacedRows(const Request& request) : is_tracks_(request.table == "tracks"), is_asked_(is_tracks_ || request.table == "obstacles") {}

  void Add(std::string_view channel, Bytes bytes) {
    if (!is_asked_) return;
    if (channel == bus::kPose.name) {
      if (const auto pose = bus::Decode<pose_t>(bytes)) poses_.Add(*pose);
    } else if (num_placed_ > 0) {
      return;
    } else if (is_tracks_ && channel == bus::kTracks.name) {
      const auto message = bus::Decode<tracks_t>(bytes);
      num_placed_ += message ? message->num_tracks : 0;
    } else if (!is_tracks_ && channel == bus::kObstacles.name) {
      const auto message = bus::Decode<obstacles_t>(bytes);
      if (message) num_placed_ += std::ranges::count(message->obstacles, obstacle_t::STATUS_OK, &obstacle_t::status);
    }
  }

  // Why there are none; empty where there are, or nobody knows why not.
  std::string Remark() const {
    if (is_asked_ && num_placed_ > 0 && poses_.num_relative > 0) {
      return "some or all rows have no latitude and longitude, as the earth was not known: " + poses_.RelativeInWords();
    }
    const auto why = is_asked_ && num_placed_ == 0 ? poses_.WhyNotPlaced() : "";
    if (why.empty()) return "";
    return is_tracks_ ? "there are no tracks, as " + why + ": what is around the boat stands in the table obstacles, in the vessel frame"
                      : "no obstacle has a place on the earth, as " + why + ": range, bearing and the outline in the vessel frame are all there is";
  }

 private:
  bool is_tracks_;
  bool is_asked_;
  log::PoseCounts poses_;
  std::int64_t num_placed_ = 0;
};

// For people: nothing where rows go to a terminal or to another program.
std::FILE* ProgressOf(const Request& request) {
  struct stat output {};
  const bool is_file = request.output || (fstat(STDOUT_FILENO, &output) == 0 && S_ISREG(output.st_mode));
  return is_file ? request.progress : nullptr;
}

int Export(const Request& request, const Output& row, std::ostream& errors) {
  constexpr std::size_t kBlockBytes = 1 << 18;
  auto sink = row.make(request);
  if (request.lidar == 2) sink = OfSecondLidar(std::move(sink));
  std::vector<Tally> tallies;
  for (const auto& channel : sink->Channels()) tallies.push_back({.channel = channel});
  // All inputs are opened first: a mistyped name must not cost an hour of reading.
  std::vector<std::unique_ptr<bus::LogReader>> readers;
  for (const auto& input : request.inputs) readers.push_back(std::make_unique<bus::LogReader>(input, io::ThrowIfStopAsked));
  const auto span = SpanOf(request, std::string(tallies.front().channel.name));

  io::OutputFile output(
      request.output.value_or("/dev/stdout"),
      {.force = request.force, .inputs = request.inputs, .tell = [&errors](const std::string& line) { errors << kProgram << line << '\n'; }});
  std::string text;
  PlacedRows placed(request);
  bool holds_events = false;
  bool has_written = false;
  runtime::Progress progress("lookout-export", ProgressOf(request));
  std::int64_t total_bytes = 1;
  for (const auto& reader : readers) total_bytes += reader->size_bytes();
  std::int64_t done_bytes = 0;
  for (std::size_t i = 0; i < readers.size(); ++i) {
    while (const auto event = sink->IsDone() ? std::nullopt : readers[i]->Next()) {
      io::ThrowIfStopAsked();
      holds_events = true;
      progress.Update(static_cast<double>(done_bytes + readers[i]->position_bytes()) / static_cast<double>(total_bytes));
      const auto tally = std::ranges::find(tallies, event->channel, [](const Tally& one) { return one.channel.name; });
      if (!span.Holds(event->bytes) && !sink->IsWantedAtAnyTime(event->channel)) continue;
      placed.Add(event->channel, event->bytes);
      if (tally == tallies.end()) continue;
      const auto taken = sink->Take(event->channel, event->bytes, text);
      // The header comes with the first message, so that nothing is written where there is nothing.
      const bool is_first = taken == Taken::kOk && tally == tallies.begin() && tally->num_taken == 0;
      if (is_first && request.format == "csv") text.insert(0, std::string(TableHeader(request.table)) + '\n');
      tally->num_taken += taken == Taken::kOk ? 1 : 0;
      if (taken == Taken::kUndecodable) ++(log::IsOfOtherType(tally->channel, event->bytes) ? tally->num_of_other_type : tally->num_undecodable);
      tally->num_inconsistent += taken == Taken::kInconsistent ? 1 : 0;
      if (text.size() >= kBlockBytes) {
        output.Write(text);
        text.clear();
        has_written = true;
      }
    }
    done_bytes += readers[i]->size_bytes();
    const auto num_damaged = readers[i]->num_damaged();
    if (num_damaged == 0) continue;
    progress.Clear();
    errors << kProgram << request.inputs[i].string() << ": " << num_damaged << " damaged stretches skipped\n";
  }
  progress.Clear();
  if (!holds_events) throw std::runtime_error(io::NoEventText(request.inputs.front()));
  if (tallies.front().num_taken > 0) sink->Finish(text);
  Tell(errors, *sink, tallies);
  const auto why = placed.Remark();
  if (!why.empty() && !sink->IsDone()) errors << kProgram << why << '\n';
  if (tallies.front().num_taken == 0) {
    const auto when = TextOf(span);
    const auto of_this = tallies.front().num_of_other_type > 0 ? " of this version's type" : "";
    throw std::runtime_error("the input holds no " + std::string(tallies.front().channel.name) + of_this + (when.empty() ? "" : " " + when));
  }
  if (request.format != "csv" && text.empty() && !has_written) {
    throw std::runtime_error(request.scan ? "the input holds no scan " + std::to_string(*request.scan) : std::string(row.when_empty));
  }
  output.Write(text);
  if (const auto head = sink->Head(); !head.empty()) output.OverwriteStart(head);
  output.Commit();
  return kExitFine;
}

}  // namespace

int Run(const Request& request, std::ostream& errors) {
  const auto fault = Fault(request);
  if (!fault.empty()) {
    errors << kProgram << PrintableLines(fault) << '\n';
    return kExitUsage;
  }
  try {
    const auto& row = *FindOutput(request.table, request.format);
    if (!row.is_by_time) return Export(request, row, errors);
    Request ordered = request;
    ordered.inputs = InOrderOfTime(request.inputs);
    return Export(ordered, row, errors);
  } catch (const io::BrokenPipe&) {  // no fault: `| head` ends quietly
    return kExitFine;
  } catch (const UsageError& error) {
    errors << kProgram << PrintableLines(error.what()) << '\n';
    return kExitUsage;
  } catch (const config::ConfigError& error) {
    errors << PrintableLines(error.what()) << '\n';
    return kExitUsage;
  } catch (const std::exception& error) {
    errors << kProgram << PrintableLines(error.what()) << '\n';
    return kExitFailed;
  }
}

}  // namespace lookout::exporter
