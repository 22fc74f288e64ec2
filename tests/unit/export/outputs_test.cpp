// The table of outputs: what --help says and what is refused follow from its rows.
#include "tools/export/outputs.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <set>

#include "tools/export/map_formats.hpp"
#include "tools/export/sinks.hpp"

namespace lookout::exporter {
namespace {

TEST(Outputs, HoldEachTableAsCsvAndNothingTwice) {
  std::set<std::pair<std::string_view, std::string_view>> seen;
  const auto tables = TableNames();
  for (const auto& row : Outputs()) {
    EXPECT_TRUE(seen.emplace(row.table, row.format).second) << row.table << " as " << row.format;
    EXPECT_NE(std::ranges::find(tables, row.table), tables.end()) << row.table;
  }
  for (const auto table : tables) EXPECT_NE(FindOutput(table, "csv"), nullptr) << table;
}

// A map format is one row of kMapFormats: all maps are written in it.
TEST(Outputs, HoldEachMapInEachFormatOfMaps) {
  for (const auto& format : kMapFormats) {
    for (const auto* table : {"obstacles", "tracks", "pose"}) {
      const auto* const row = FindOutput(table, format.name);
      ASSERT_NE(row, nullptr) << table << " as " << format.name;
      EXPECT_NE(row->make({.inputs = {}, .table = table, .format = std::string(format.name)}), nullptr);
    }
  }
}

TEST(Outputs, SayWhereFormatsAndOptionsCanBeGiven) {
  EXPECT_EQ(FormatNames(), (std::vector<std::string>{"csv", "ply", "pcd", "las", "svg", "geojson", "kml", "gpx"}));
  EXPECT_EQ(
      FormatsText(),
      "csv of every table; ply, pcd and las of returns; svg of returns, obstacles, tracks, pose and merges; geojson of map, obstacles, tracks and "
      "pose; kml and "
      "gpx of obstacles, tracks and pose");
  EXPECT_EQ(PlacesText(kSpanOption), "csv of every table but map; pcd and las of returns; geojson, kml and gpx of obstacles, tracks and pose");
  EXPECT_EQ(PlacesText(kNearOption), "csv, geojson, kml and gpx of obstacles, tracks and pose");
  EXPECT_EQ(PlacesText(kScanOption),
            "csv of merges; ply, pcd and las of returns; svg of returns, obstacles and merges; geojson, kml and gpx of obstacles and tracks");
  EXPECT_EQ(PlacesText(kLastScanOption), "geojson, kml and gpx of obstacles and tracks");
  EXPECT_EQ(PlacesText(kAllScansOption), "csv of merges; pcd and las of returns");
  EXPECT_EQ(PlacesText(kFrameOption), "pcd and las of returns");
  EXPECT_EQ(PlacesText(kConfigOption), "csv and svg of merges");
}

struct Refused {
  Request request;
  const char* text;  // "" = accepted
};

TEST(Outputs, RefuseWhatTheirRowDoesNotHave) {
  const auto circle = ParseCircle("1,2,3");
  for (const auto& [request, text] : std::initializer_list<Refused>{
           {{.inputs = {}, .table = "retruns"}, "there is no table retruns"},
           {{.inputs = {}, .table = "returns", .format = "xlsx"}, "there is no format xlsx"},
           {{.inputs = {}, .table = "pose", .format = "ply"}, "--format ply is for --table returns only"},
           {{.inputs = {}, .table = "map", .format = "kml"}, "--format kml is for --table obstacles, tracks and pose only"},
           {{.inputs = {}, .table = "returns", .scan = 3}, "--scan is for csv of merges; "},
           {{.inputs = {}, .table = "pose", .format = "svg", .scan = 3}, "--scan is for csv of merges; "},
           {{.inputs = {}, .table = "pose", .format = "gpx", .is_last_scan = true},
            "--scan last is for geojson, kml and gpx of obstacles and tracks only"},
           {{.inputs = {}, .table = "returns", .is_last_scan = true}, ""},  // says what is so without it
           {{.inputs = {}, .table = "tracks", .format = "kml", .is_last_scan = true}, ""},
           {{.inputs = {}, .table = "merges", .format = "svg", .all_scans = true, .config = "x"},
            "--scan all is for csv of merges; pcd and las of returns only"},
           {{.inputs = {}, .table = "returns", .format = "ply", .all_scans = true}, "--scan all is for csv of merges; "},
           {{.inputs = {}, .table = "returns", .format = "ply", .frame = CloudFrame::kEarth}, "--frame is for pcd and las of returns only"},
           {{.inputs = {}, .table = "returns", .format = "las", .output = "x", .all_scans = true, .frame = CloudFrame::kEarth}, ""},
           {{.inputs = {}, .table = "returns", .format = "las", .all_scans = true}, "--format las of several scans needs --out"},
           {{.inputs = {}, .table = "merges", .all_scans = true, .config = "x"}, ""},
           {{.inputs = {}, .table = "merges"}, "--table merges needs --config: scans are segmented again by it"},
           {{.inputs = {}, .table = "returns", .config = "x"}, "--config is for csv and svg of merges only"},
           {{.inputs = {}, .table = "map", .from = "10"}, "--from and --to are for csv of every table but map; "},
           {{.inputs = {}, .table = "pose", .format = "svg", .span = {1, std::nullopt}}, "--from and --to are for csv of every table but map; "},
           {{.inputs = {}, .table = "alerts", .near = circle}, "--near is for csv, geojson, kml and gpx of obstacles, tracks and pose only"},
           {{.inputs = {}, .table = "obstacles", .format = "geojson", .scan = 3, .to = "10", .near = circle}, ""}}) {
    const auto fault = OutputFault(request);
    EXPECT_TRUE(*text == '\0' ? fault.empty() : fault.starts_with(text)) << request.table << " as " << request.format << ": " << fault;
  }
}

}  // namespace
}  // namespace lookout::exporter
