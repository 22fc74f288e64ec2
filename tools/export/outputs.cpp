#include "tools/export/outputs.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "common/config/boat.hpp"
#include "common/config/text_config.hpp"
#include "common/runtime/version.hpp"
#include "tools/export/map_formats.hpp"
#include "tools/export/map_sinks.hpp"
#include "tools/export/map_table.hpp"
#include "tools/export/sinks.hpp"

namespace lookout::exporter {

namespace {

// @throws config::ConfigError
segmenter::Params MergingParams(const std::filesystem::path& config_folder) {
  auto params = segmenter::LoadParams(config_folder);
  if (params.method == segmenter::Method::kLookout) return params;
  throw config::ConfigError({config::FaultLine(config_folder / "segmenter.txtpb", "method", "PAPER merges no pairs: --table merges is of LOOKOUT")});
}

std::unique_ptr<Sink> MakeCsv(const Request& request) { return MakeCsvSink(request.table, request.near); }
std::unique_ptr<Sink> MakePly(const Request& request) { return MakePlySink(request.scan); }
std::unique_ptr<Sink> MakePcd(const Request& request) {
  const bool is_of_one = IsOfOneScan(request);
  return MakeCloudSink(MakePcdWriter(request.frame, is_of_one), request.frame, request.scan, is_of_one);
}
std::unique_ptr<Sink> MakeLas(const Request& request) {
  return MakeCloudSink(MakeLasWriter(request.frame, "lookout-export " + runtime::Version()), request.frame, request.scan, IsOfOneScan(request));
}
template <ChosenScan::Of what>
std::unique_ptr<Sink> MakeScanPicture(const Request& request) {
  return MakeScanSvgSink(what, request.scan);
}
template <bool has_tracks>
std::unique_ptr<Sink> MakeTrackPicture(const Request& /*request*/) {
  return MakeTrackSvgSink(has_tracks);
}
std::unique_ptr<Sink> MakeMergesCsv(const Request& request) {
  return MakeMergesSink(MergingParams(*request.config), request.scan, request.all_scans);
}
std::unique_ptr<Sink> MakeMergesPicture(const Request& request) {
  return MakeMergesSvgSink(MergingParams(*request.config), config::LoadBoat(*request.config), request.scan);
}

Scans ScansOf(const Request& request) { return {request.scan || request.is_last_scan, request.scan}; }
std::unique_ptr<MapWriter> WriterOf(const Request& request) {
  return std::ranges::find(kMapFormats, request.format, &MapFormat::name)->make(request.table);
}
std::unique_ptr<Sink> MakeObstacleMap(const Request& request) { return MakeObstacleMapSink(WriterOf(request), request.near, ScansOf(request)); }
template <bool has_tracks>
std::unique_ptr<Sink> MakeTrackMap(const Request& request) {
  return MakeTrackMapSink(WriterOf(request), has_tracks, request.near, ScansOf(request));
}
template <bool is_geojson>
std::unique_ptr<Sink> MakeOwnMap(const Request& /*request*/) {
  return MakeMapSink(is_geojson);
}

constexpr unsigned kPartOfLog = kSpanOption | kNearOption;
constexpr unsigned kPartOrScan = kPartOfLog | kScanOption | kLastScanOption;
constexpr unsigned kOfCloud = kScanOption | kAllScansOption | kSpanOption | kFrameOption | kLidarOption;
constexpr std::string_view kNoPlace = "no pose knows its position";

constexpr std::array kRows{Output{"returns", "csv", kSpanOption | kLidarOption, MakeCsv},
                           Output{"returns", "ply", kScanOption | kLidarOption, MakePly},
                           Output{"returns", "pcd", kOfCloud, MakePcd},
                           Output{"returns", "las", kOfCloud, MakeLas},
                           Output{"returns", "svg", kScanOption | kLidarOption, MakeScanPicture<ChosenScan::Of::kReturns>},
                           Output{"segments", "csv", kSpanOption | kLidarOption, MakeCsv},
                           Output{"obstacles", "csv", kPartOfLog, MakeCsv},
                           Output{"obstacles", "svg", kScanOption, MakeScanPicture<ChosenScan::Of::kObstacles>},
                           Output{"tracks", "csv", kPartOfLog, MakeCsv},
                           Output{.table = "tracks", .format = "svg", .options = kNoOption, .make = MakeTrackPicture<true>, .when_empty = kNoPlace},
                           Output{"ais", "csv", kSpanOption, MakeCsv},
                           Output{"alerts", "csv", kSpanOption, MakeCsv},
                           Output{"pose", "csv", kPartOfLog, MakeCsv},
                           Output{.table = "pose", .format = "svg", .options = kNoOption, .make = MakeTrackPicture<false>, .when_empty = kNoPlace},
                           Output{"clock", "csv", kSpanOption | kLidarOption, MakeCsv},
                           Output{"fixes", "csv", kSpanOption, MakeCsv},
                           Output{"attitude", "csv", kSpanOption, MakeCsv},
                           Output{"health", "csv", kSpanOption, MakeCsv},
                           Output{"traffic", "csv", kSpanOption, MakeCsv},
                           Output{"counters", "csv", kSpanOption, MakeCsv},
                           Output{.table = "map", .format = "csv", .options = kNoOption, .make = MakeOwnMap<false>, .is_by_time = true},
                           Output{.table = "map", .format = "geojson", .options = kNoOption, .make = MakeOwnMap<true>, .is_by_time = true},
                           Output{"merges", "csv", kSpanOption | kScanOption | kAllScansOption | kConfigOption, MakeMergesCsv},
                           Output{"merges", "svg", kScanOption | kConfigOption, MakeMergesPicture}};

// "a, b and c"
std::string Joined(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 < words.size() ? ", " : " and ";
    text += words[i];
  }
  return text;
}

std::vector<std::string> TablesOf(std::string_view format, unsigned options) {
  std::vector<std::string> tables;
  for (const auto& row : Outputs()) {
    if (row.format == format && (row.options & options) == options) tables.emplace_back(row.table);
  }
  return tables;
}

// Formats with the same tables stand together. Where an option is for most of a format's tables, the others are named.
std::string FormatsWith(unsigned options) {
  std::vector<std::pair<std::string, std::vector<std::string>>> groups;  // tables in words, formats
  for (const auto& format : FormatNames()) {
    const auto tables = TablesOf(format, options);
    auto others = TablesOf(format, kNoOption);
    std::erase_if(others, [&](const std::string& table) { return std::ranges::find(tables, table) != tables.end(); });
    if (tables.empty()) continue;
    const bool has_every_table = tables.size() + others.size() == TableNames().size();
    std::string text = "of " + Joined(tables);
    if (has_every_table && others.size() < tables.size()) text = others.empty() ? "of every table" : "of every table but " + Joined(others);
    const auto group = std::ranges::find(groups, text, [](const auto& one) { return one.first; });
    if (group == groups.end()) {
      groups.emplace_back(text, std::vector<std::string>{format});
    } else {
      group->second.push_back(format);
    }
  }
  std::string text;
  for (const auto& [tables, formats] : groups) text += (text.empty() ? "" : "; ") + Joined(formats) + " " + tables;
  return text;
}

}  // namespace

const std::vector<Output>& Outputs() {
  static const std::vector<Output> kAll = [] {
    std::vector<Output> rows(kRows.begin(), kRows.end());
    for (const auto& format : kMapFormats) {
      rows.push_back({.table = "obstacles", .format = format.name, .options = kPartOrScan, .make = MakeObstacleMap});
      rows.push_back({.table = "tracks", .format = format.name, .options = kPartOrScan, .make = MakeTrackMap<true>, .when_empty = kNoPlace});
      rows.push_back({.table = "pose", .format = format.name, .options = kPartOfLog, .make = MakeTrackMap<false>, .when_empty = kNoPlace});
    }
    return rows;
  }();
  return kAll;
}

const Output* FindOutput(std::string_view table, std::string_view format) {
  const auto row = std::ranges::find_if(Outputs(), [&](const Output& one) { return one.table == table && one.format == format; });
  return row == Outputs().end() ? nullptr : &*row;
}

std::vector<std::string> FormatNames() {
  std::vector<std::string> names{"csv", "ply", "pcd", "las", "svg"};
  for (const auto& row : Outputs()) {
    if (std::ranges::find(names, row.format) == names.end()) names.emplace_back(row.format);
  }
  return names;
}

std::string FormatsText() { return FormatsWith(kNoOption); }
std::string PlacesText(Option option) { return FormatsWith(option); }

bool IsOfOneScan(const Request& request) { return !request.all_scans && request.span.IsAll() && request.from.empty() && request.to.empty(); }

std::string OutputFault(const Request& request) {
  const auto names = TableNames();
  if (std::ranges::find(names, request.table) == names.end()) return "there is no table " + request.table;
  const auto formats = FormatNames();
  if (std::ranges::find(formats, request.format) == formats.end()) return "there is no format " + request.format;
  const auto* const row = FindOutput(request.table, request.format);
  if (row == nullptr) return "--format " + request.format + " is for --table " + Joined(TablesOf(request.format, kNoOption)) + " only";

  struct GivenOption {
    Option option;
    bool is_given;
    std::string_view names;
  };
  const bool is_part = !request.span.IsAll() || !request.from.empty() || !request.to.empty();
  const bool is_map = std::ranges::find(kMapFormats, request.format, &MapFormat::name) != kMapFormats.end();
  for (const auto& [option, is_given, option_names] :
       {GivenOption{kScanOption, request.scan.has_value(), "--scan is"},
        GivenOption{kLastScanOption, is_map && request.is_last_scan, "--scan last is"},
        GivenOption{kAllScansOption, request.all_scans, "--scan all is"}, GivenOption{kSpanOption, is_part, "--from and --to are"},
        GivenOption{kFrameOption, request.frame != CloudFrame::kLidar, "--frame is"}, GivenOption{kNearOption, request.near.has_value(), "--near is"},
        GivenOption{kConfigOption, request.config.has_value(), "--config is"}, GivenOption{kLidarOption, request.lidar == 2, "--lidar 2 is"}}) {
    if (is_given && (row->options & option) == 0) return std::string(option_names) + " for " + PlacesText(option) + " only";
  }
  if ((row->options & kFrameOption) != 0 && !IsOfOneScan(request)) {
    if (request.scan || request.is_last_scan) return "--scan NUMBER and --scan last do not go with --from and --to";
    if (!request.output) return "--format " + request.format + " of several scans needs --out: its head is written last";
  }
  if ((row->options & kConfigOption) != 0 && !request.config) return "--table " + request.table + " needs --config: scans are segmented again by it";
  return "";
}

}  // namespace lookout::exporter
