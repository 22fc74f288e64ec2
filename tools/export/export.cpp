#include "tools/export/export.hpp"

#include <algorithm>
#include <initializer_list>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <system_error>

#include "common/bus/log_file.hpp"
#include "common/config/boat.hpp"
#include "common/config/text_config.hpp"
#include "common/core/printable.hpp"
#include "common/io/file_kind.hpp"
#include "common/io/output_file.hpp"
#include "common/io/stop_signal.hpp"
#include "tools/export/map_sinks.hpp"
#include "tools/export/map_table.hpp"
#include "tools/export/sinks.hpp"

namespace lookout::exporter {

namespace {

constexpr std::string_view kProgram = "lookout-export: ";

// What was met on one of the sink's channels.
struct Tally {
  bus::Channel channel;
  std::int64_t num_taken = 0;
  std::int64_t num_undecodable = 0;
  std::int64_t num_inconsistent = 0;
};

bool IsOneOf(const std::string& table, std::initializer_list<std::string_view> tables) { return std::ranges::find(tables, table) != tables.end(); }

bool IsMap(const Request& request) { return IsOneOf(request.format, {"geojson", "kml", "gpx"}); }

// @return what is wrong with the choice of a part of the log; empty when nothing
std::string SelectionFault(const Request& request) {
  const bool is_csv_or_map = request.format == "csv" || IsMap(request);
  if (!request.span.IsAll() && request.table == "map") return "--from and --to are not for --table map: it is of whole logs";
  if (!request.span.IsAll() && !is_csv_or_map) return "--from and --to are not for --format " + request.format;
  if (request.span.from_us && request.span.to_us && *request.span.from_us >= *request.span.to_us) return "--from is not before --to";
  if (request.near && !(is_csv_or_map && IsOneOf(request.table, {"obstacles", "tracks", "pose"}))) {
    return "--near is for --table obstacles, tracks or pose only, as csv or a map";
  }
  return "";
}

// @return what is wrong with the request; empty when nothing
std::string Fault(const Request& request) {
  const auto names = TableNames();
  if (std::ranges::find(names, request.table) == names.end()) return "there is no table " + request.table;
  if (request.format == "ply" && request.table != "returns") return "--format ply is for --table returns only";
  if (request.format == "svg" && !IsOneOf(request.table, {"returns", "merges", "obstacles", "pose", "tracks"})) {
    return "--format svg is for --table returns, merges, obstacles, pose or tracks only";
  }
  const bool is_own_map = request.table == "map";
  if (is_own_map && !IsOneOf(request.format, {"csv", "geojson"})) return "--table map is csv or geojson only";
  if (IsMap(request) && !is_own_map && !IsOneOf(request.table, {"obstacles", "tracks", "pose"})) {
    return "--format " + request.format + " is for --table obstacles, tracks or pose only" + (request.format == "geojson" ? ", or map" : "");
  }
  const bool has_scan = request.scan || (IsMap(request) && request.is_last_scan);
  if ((request.table == "pose" || is_own_map || (request.table == "tracks" && !IsMap(request))) && has_scan) {
    return "--scan is not for --table " + request.table + (request.table == "tracks" ? " as " + request.format : "");
  }
  if (!IsOneOf(request.format, {"csv", "ply", "svg"}) && !IsMap(request)) return "there is no format " + request.format;
  if (request.format == "csv" && request.table != "merges" && request.scan) return "--scan is for clouds, pictures and maps, or --table merges";
  if (request.all_scans && (request.format != "csv" || request.table != "merges")) return "--scan all is for --table merges only, as csv";
  if ((request.table == "merges") != request.config.has_value()) return "--config and --table merges go together: scans are segmented again by it";
  if (auto fault = SelectionFault(request); !fault.empty()) return fault;
  for (const auto& input : request.inputs) {
    std::error_code error;
    if (request.output && std::filesystem::equivalent(input, *request.output, error)) return "--out is one of the inputs: " + input.string();
  }
  return "";
}

// @throws config::ConfigError
segmenter::Params MergingParams(const std::filesystem::path& config_folder) {
  auto params = segmenter::LoadParams(config_folder);
  if (params.method == segmenter::Method::kLookout) return params;
  throw config::ConfigError({config::FaultLine(config_folder / "segmenter.txtpb", "method", "PAPER merges no pairs: --table merges is of LOOKOUT")});
}

// @throws config::ConfigError
std::unique_ptr<Sink> MakeSink(const Request& request) {
  if (request.table == "merges") {
    const auto params = MergingParams(*request.config);
    if (request.format == "svg") return MakeMergesSvgSink(params, config::LoadBoat(*request.config), request.scan);
    return MakeMergesSink(params, request.scan, request.all_scans);
  }
  if (request.table == "map" && request.format == "geojson") return MakeMapSink(true);
  if (IsMap(request)) {
    const Scans scans{request.scan || request.is_last_scan, request.scan};
    if (request.table == "obstacles") return MakeObstacleMapSink(MakeMapWriter(request.format), request.near, scans);
    return MakeTrackMapSink(MakeMapWriter(request.format), request.table == "tracks", request.near, scans);
  }
  if (request.format == "ply") return MakePlySink(request.scan);
  if (request.format == "svg" && IsOneOf(request.table, {"pose", "tracks"})) return MakeTrackSvgSink(request.table == "tracks");
  if (request.format == "svg") {
    return MakeScanSvgSink(request.table == "returns" ? ChosenScan::Of::kReturns : ChosenScan::Of::kObstacles, request.scan);
  }
  return MakeCsvSink(request.table, request.near);
}

void Tell(std::ostream& errors, const Sink& sink, const std::vector<Tally>& tallies) {
  for (const auto& tally : tallies) {
    if (tally.num_undecodable > 0) errors << kProgram << tally.num_undecodable << " messages of " << tally.channel.name << " could not be decoded\n";
    if (tally.num_inconsistent > 0)
      errors << kProgram << tally.num_inconsistent << " messages of " << tally.channel.name << " contradict themselves\n";
  }
  for (const auto& remark : sink.Remarks()) errors << kProgram << remark << '\n';
}

int Export(const Request& request, std::ostream& errors) {
  constexpr std::size_t kBlockBytes = 1 << 18;
  const auto sink = MakeSink(request);
  std::vector<Tally> tallies;
  for (const auto& channel : sink->Channels()) tallies.push_back({.channel = channel});
  // All inputs are opened first: a mistyped name must not cost an hour of reading.
  std::vector<std::unique_ptr<bus::LogReader>> readers;
  for (const auto& input : request.inputs) readers.push_back(std::make_unique<bus::LogReader>(input, io::ThrowIfStopAsked));

  io::OutputFile output(
      request.output.value_or("/dev/stdout"),
      {.force = request.force, .inputs = request.inputs, .tell = [&errors](const std::string& line) { errors << kProgram << line << '\n'; }});
  std::string text;
  bool holds_events = false;
  for (std::size_t i = 0; i < readers.size(); ++i) {
    while (const auto event = sink->IsDone() ? std::nullopt : readers[i]->Next()) {
      io::ThrowIfStopAsked();
      holds_events = true;
      const auto tally = std::ranges::find(tallies, event->channel, [](const Tally& one) { return one.channel.name; });
      if (tally == tallies.end() || !request.span.Holds(event->bytes)) continue;
      const auto taken = sink->Take(event->channel, event->bytes, text);
      // The header comes with the first message, so that nothing is written where there is nothing.
      const bool is_first = taken == Taken::kOk && tally == tallies.begin() && tally->num_taken == 0;
      if (is_first && request.format == "csv") text.insert(0, std::string(TableHeader(request.table)) + '\n');
      tally->num_taken += taken == Taken::kOk ? 1 : 0;
      tally->num_undecodable += taken == Taken::kUndecodable ? 1 : 0;
      tally->num_inconsistent += taken == Taken::kInconsistent ? 1 : 0;
      if (text.size() >= kBlockBytes) {
        output.Write(text);
        text.clear();
      }
    }
    const auto num_damaged = readers[i]->num_damaged();
    if (num_damaged > 0) errors << kProgram << request.inputs[i].string() << ": " << num_damaged << " damaged stretches skipped\n";
  }
  if (!holds_events) throw std::runtime_error(io::NoEventText(request.inputs.front()));
  if (tallies.front().num_taken > 0) sink->Finish(text);
  Tell(errors, *sink, tallies);
  if (tallies.front().num_taken == 0) {
    const auto span = TextOf(request.span);
    throw std::runtime_error("the input holds no " + std::string(tallies.front().channel.name) + (span.empty() ? "" : " " + span));
  }
  if (request.format != "csv" && text.empty()) {  // the end of what was written before is not empty
    if (IsOneOf(request.table, {"pose", "tracks"}) && !request.scan) throw std::runtime_error("no pose knows its position");
    throw std::runtime_error(request.scan ? "the input holds no scan " + std::to_string(*request.scan) : "the input holds no scan");
  }
  output.Write(text);
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
    return Export(request, errors);
  } catch (const io::BrokenPipe&) {  // no fault: `| head` ends quietly
    return kExitFine;
  } catch (const config::ConfigError& error) {
    errors << PrintableLines(error.what()) << '\n';
    return kExitUsage;
  } catch (const std::exception& error) {
    errors << kProgram << PrintableLines(error.what()) << '\n';
    return kExitFailed;
  }
}

}  // namespace lookout::exporter
