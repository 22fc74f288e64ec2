#include "services/tracker/map_file.hpp"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>

#include "common/config/text_config.hpp"
#include "services/tracker/params.hpp"
#include "tests/support/files.hpp"

namespace lookout::tracker::map_file {
namespace {

MapThing MakeThing() {
  MapThing thing;
  thing.kind = TrackKind::kBuoy;
  thing.latitude_deg = 43.63012345678;
  thing.longitude_deg = -72.15;
  thing.deviation_m = 0.25;
  thing.length_m = 1.25;
  thing.width_m = 0.5;
  thing.length_bearing_rad = 1.0;
  thing.top_above_water_m = 1.75;
  thing.first = Utime(std::chrono::seconds(1'700'000'000));
  thing.seen = Utime(std::chrono::seconds(1'700'200'000));
  thing.days = {{19'675, 7}, {19'677, 9}};
  thing.outline_m = {{-0.6, -0.2}, {0.6, -0.2}, {0.0, 0.25}};
  return thing;
}

OwnMap MakeMap() {
  OwnMap map;
  map.things = {MakeThing(), MakeThing(), MakeThing()};
  map.things[1].outline_m = {{0.0, 0.0}};
  map.things[1].gone = Utime(std::chrono::seconds(1'700'300'000));
  map.things[2].outline_m = {{-0.5, 0.0}, {0.5, 0.0}};
  map.things[2].kind = TrackKind::kUnknown;
  const auto cell = earth_grid::CellAt(43.6302, -72.1503);
  map.land = {{cell.tile, Utime(std::chrono::seconds(1'700'200'000)), {19'675, 19'677}, {0, 5, cell.index, 1023}},
              {cell.tile, Utime(std::chrono::seconds(1'700'100'000)), {19'676}, {7}}};
  return map;
}

std::string FaultOf(const std::string& text) {
  try {
    ParseMap(text);
  } catch (const MapFileError& error) {
    return error.what();
  }
  return "";
}

std::string With(const std::string& text, const std::string& replacement) {
  auto whole = MapText({.things = {MakeThing()}, .land = MakeMap().land});
  const auto place = whole.find(text);
  EXPECT_NE(place, std::string::npos) << text;
  return whole.replace(place, text.size(), replacement);
}

TEST(MapFile, IsReadAsItWasWritten) {
  const auto map = MakeMap();
  const auto text = MapText(map);
  const auto read = ParseMap(text);
  EXPECT_EQ(MapText(read), text);
  ASSERT_EQ(read.things.size(), 3U);
  const auto& thing = read.things[0];
  EXPECT_EQ(thing.id, 1);
  EXPECT_EQ(thing.kind, TrackKind::kBuoy);
  EXPECT_NEAR(thing.latitude_deg, map.things[0].latitude_deg, 1e-9);
  EXPECT_EQ(thing.first, map.things[0].first);
  EXPECT_EQ(thing.seen, map.things[0].seen);
  EXPECT_EQ(thing.gone, std::nullopt);
  EXPECT_EQ(thing.days, map.things[0].days);
  ASSERT_EQ(thing.outline_m.size(), 3U);
  EXPECT_LT((thing.outline_m[2] - map.things[0].outline_m[2]).norm(), 2e-4);
  EXPECT_EQ(read.things[1].gone, map.things[1].gone);
  ASSERT_EQ(read.land.size(), 2U);
  EXPECT_EQ(read.land[0].tile, map.land[0].tile);
  EXPECT_EQ(read.land[0].cells, map.land[0].cells);
  EXPECT_EQ(read.land[0].days, map.land[0].days);
  EXPECT_EQ(read.land[1].cells, map.land[1].cells);
}

TEST(MapFile, MayBeEmpty) {
  const auto map = ParseMap(MapText({}));
  EXPECT_TRUE(map.things.empty());
  EXPECT_TRUE(map.land.empty());
}

TEST(MapFile, SaysWhatIsWrongWithIt) {
  EXPECT_EQ(FaultOf(""), "line 1: is no JSON");
  EXPECT_EQ(FaultOf(MapText(MakeMap()).substr(0, 300)), "line 2: is no JSON");
  EXPECT_NE(FaultOf("{}").find("is no map of lookout-export"), std::string::npos);
  EXPECT_NE(FaultOf("[1, 2]").find("is no map of lookout-export"), std::string::npos);
  EXPECT_NE(FaultOf(R"({"type":"FeatureCollection","features":[]})").find("is no map of lookout-export"), std::string::npos);
  EXPECT_EQ(FaultOf(R"({"type":"FeatureCollection","lookout_map":1})"), "has no features");
  EXPECT_EQ(FaultOf(R"({"type":"FeatureCollection","lookout_map":1,"features":[7]})"), "feature 1: type: must be Feature");
  EXPECT_EQ(FaultOf(With(R"("type":"thing")", R"("type":"ship")")), "feature 1: type: must be thing or land");
  EXPECT_EQ(FaultOf(With(R"("kind":"buoy")", R"("kind":"whale")")), "feature 1: kind: must be obstacle, buoy, boat, structure or unknown");
  EXPECT_EQ(FaultOf(With(R"("kind":"buoy")", R"("kind":null)")), "feature 1: kind: must be a text");
  EXPECT_EQ(FaultOf(With(R"("deviation_m":0.250)", R"("deviation_m":-1)")), "feature 1: deviation_m: must be a number from 0 to 1000");
  EXPECT_EQ(FaultOf(With(R"("deviation_m":0.250,)", "")), "feature 1: deviation_m: is missing");
  EXPECT_NE(FaultOf(With(R"("latitude_deg":43.630123457)", R"("latitude_deg":91)")).find("feature 1: latitude_deg"), std::string::npos);
  EXPECT_NE(FaultOf(With(R"("latitude_deg":43.630123457)", R"("latitude_deg":43.7)")).find("farther than 1.5 km"), std::string::npos);
  // The library has an exception of its own for it.
  EXPECT_EQ(FaultOf(With(R"("deviation_m":0.250)", R"("deviation_m":1e999)")), "holds a number that is too large");
  EXPECT_NE(FaultOf(With("2023-11-17T", "2023-02-30T")).find("feature 1: last_seen: must be a time"), std::string::npos);
  EXPECT_NE(FaultOf(With("2023-11-14T", "2024-11-14T")).find("is before first_seen"), std::string::npos);
  EXPECT_NE(FaultOf(With(R"("2023-11-14":7)", R"("2023-11-14":-7)")).find("scans_by_day"), std::string::npos);
  EXPECT_NE(FaultOf(With(R"("2023-11-14":7)", R"("2023-11-14":1e9)")).find("scans_by_day"), std::string::npos);
  EXPECT_NE(FaultOf(With(R"("2023-11-14":7)", R"("tomorrow":7)")).find("scans_by_day: must have days"), std::string::npos);
  EXPECT_NE(FaultOf(With(R"("seen_on":["2023-11-14")", R"("seen_on":[12)")).find("feature 2: seen_on"), std::string::npos);
  EXPECT_NE(FaultOf(With("MultiPoint", "Polygon")).find("feature 2: geometry: must be a MultiPoint"), std::string::npos);
  EXPECT_NE(FaultOf(With(R"("Polygon","coordinates":[[[)", R"("Polygon","coordinates":[[["a",)")).find("must be [longitude, latitude]"),
            std::string::npos);
}

// Nothing that stands anywhere in a file may end the process, or be taken for a number that it is not.
TEST(MapFile, CutOrSpoiltAnywhereIsRefusedOrAMap) {
  const auto text = MapText({.things = {MakeThing()}, .land = {MakeMap().land[1]}});
  for (std::size_t i = 0; i + 1 < text.size(); ++i) {  // without the end of the last line it is whole
    EXPECT_NE(FaultOf(text.substr(0, i)), "") << i;
    for (const char wrong : {'\0', '"', '9', '-', ']', '}', '\xff'}) {
      auto spoilt = text;
      spoilt[i] = wrong;
      try {
        const auto map = ParseMap(spoilt);
        EXPECT_EQ(map.things.size() + map.land.size(), 2U) << i;
        EXPECT_EQ(MapText(ParseMap(MapText(map))), MapText(map)) << i << " " << wrong;
      } catch (const MapFileError&) {
        continue;
      }
    }
  }
}

TEST(MapFile, IsBounded) {
  OwnMap map;
  map.things.assign(kMostMapThings + 1, MakeThing());
  EXPECT_EQ(FaultOf(MapText(map)), "has more than 4000 things");
  EXPECT_EQ(FaultOf(std::string(kMaxMapBytes + 1, ' ')), "has more than 32 MB");
  const auto deep = R"({"type":"FeatureCollection","lookout_map":1,"features":)" + std::string(1'000'000, '[');
  EXPECT_EQ(FaultOf(deep), "is nested too deep, or holds too many values");
  EXPECT_NE(FaultOf(deep + std::string(1'000'000, ']') + "}"), "");
}

class MapConfig : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const auto* file : {"boat.txtpb", "segmenter.txtpb"}) std::filesystem::copy_file(support::kDemoConfig / file, folder_ / file);
  }
  std::string Load(const std::string& map, MapFile map_file = MapFile::kRead) {
    std::ofstream(folder_ / "tracker.txtpb") << "map: \"" + map + "\"\n";
    try {
      params_ = LoadParams(folder_, map_file);
    } catch (const config::ConfigError& error) {
      return error.faults().at(0);
    }
    return "";
  }
  support::TempDir folder_;
  Params params_;
};

TEST_F(MapConfig, ReadsTheFileFromTheFolderOrByItsWholePath) {
  std::ofstream(folder_ / "map.geojson") << MapText(MakeMap());
  EXPECT_EQ(Load("map.geojson"), "");
  ASSERT_NE(params_.map, nullptr);
  EXPECT_EQ(params_.map->things.size(), 3U);
  EXPECT_EQ(Load((folder_ / "map.geojson").string()), "");
  EXPECT_EQ(Load("map.geojson", MapFile::kLeave), "");
  EXPECT_EQ(params_.map, nullptr);
}

TEST_F(MapConfig, SaysWhichFileIsNoMapAndWhy) {
  const auto fault = Load("nowhere.geojson");
  EXPECT_NE(fault.find("tracker.txtpb:1: map: '"), std::string::npos) << fault;
  EXPECT_NE(fault.find("nowhere.geojson' is no file that can be read"), std::string::npos) << fault;
  std::ofstream(folder_ / "map.geojson") << "{";
  EXPECT_NE(Load("map.geojson").find("map.geojson' line 1: is no JSON"), std::string::npos);
  EXPECT_NE(Load(".").find("is no file that can be read"), std::string::npos) << "a folder";
  EXPECT_EQ(Load("nowhere.geojson", MapFile::kLeave), "") << "a replay has what the log says was given";
}

}  // namespace
}  // namespace lookout::tracker::map_file
