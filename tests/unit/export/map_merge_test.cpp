// Maps of many days made one.
#include "tools/export/map_merge.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "lookout/tracks_t.hpp"
#include "tests/support/messages.hpp"
#include "tests/unit/export/export_logs.hpp"
#include "tests/unit/export/map_tracks.hpp"
#include "tools/export/own_map_text.hpp"

namespace lookout::exporter::map_merge {
namespace {

using std::chrono::hours;

constexpr std::int32_t kDay = 19'675;  // 2023-11-14, the day of kStartUs
const Datum kDatum{43.63, -72.15, 200.0};

Utime At(int day, double second) {
  return Utime(std::chrono::microseconds(kStartUs)) + hours(24 * day) + std::chrono::microseconds(static_cast<std::int64_t>(1e6 * second));
}

// TRACKS of a process that began on a day: things that stand since 30 s before, so far to the east of the datum.
tracks_t Tracks(int day, double second, const std::vector<double>& east_m) {
  auto message = support::OfScan<tracks_t>(ToUtimeUs(At(day, second)), static_cast<std::int64_t>(10.0 * second), 100'000);
  message.begin_utime_us = ToUtimeUs(At(day, 0.0));
  message.sight = tracks_t::SIGHT_KNOWN;
  support::SetDatum(message, kDatum);
  std::vector<track_t> tracks;
  for (std::size_t i = 0; i < east_m.size(); ++i) {
    tracks.push_back(test::StandingTrack(static_cast<std::int64_t>(i) + 1, kDatum, {east_m[i], 0.0}, At(day, second - 30.0), At(day, second)));
  }
  support::Fill(message, tracks);
  return message;
}

void Add(MapMerge& merge, const tracks_t& message) {
  StandingScan scan{*UtimeFromWire(message.utime_us), *UtimeFromWire(message.end_utime_us), kDatum, {}};
  for (const auto& track : message.tracks) scan.tracks.push_back(*ToStandingTrack(track));
  merge.Add({*UtimeFromWire(message.begin_utime_us), message.begin_seq}, scan, nullptr);
}

OwnMap MapOfDays(const std::vector<std::vector<double>>& east_m) {
  MapMerge merge;
  for (int day = 0; day < std::ssize(east_m); ++day) {
    for (int second = 0; second < 3; ++second) Add(merge, Tracks(day, second, east_m[static_cast<std::size_t>(day)]));
  }
  return merge.Merged();
}

TEST(MapMerge, MakesOneOfAThingThatStoodOnManyDays) {
  const auto map = MapOfDays({{10.0}, {10.8, 30.0}, {10.3}});
  ASSERT_EQ(map.things.size(), 2U);
  const auto& thing = *std::ranges::max_element(map.things, {}, [](const MapThing& one) { return one.days.size(); });
  EXPECT_EQ(thing.days, (std::vector<DayScans>{{kDay, 3}, {kDay + 1, 3}, {kDay + 2, 3}}));
  EXPECT_EQ(thing.first, At(0, -30.0));
  EXPECT_EQ(thing.seen, At(2, 2.1));
  EXPECT_NEAR(thing.longitude_deg, Tracks(2, 0.0, {10.3}).tracks[0].longitude_deg, 1e-9) << "it is where it was seen last";
}

// In a row of boats each has a neighbour that is near enough to be its own place of the day before.
TEST(MapMerge, NeverMakesOneOfTwoThingsOfAProcess) {
  const auto map = MapOfDays({{10.0, 11.2}, {10.4, 11.6}});
  ASSERT_EQ(map.things.size(), 2U);
  for (const auto& thing : map.things) EXPECT_EQ(thing.days.size(), 2U);
}

TEST(MapMerge, AddsUpTheProcessesOfADay) {
  MapMerge merge;
  Add(merge, Tracks(0, 0.0, {10.0}));
  auto again = Tracks(0, 3600.0, {10.2});
  again.begin_utime_us = again.utime_us;
  Add(merge, again);
  const auto map = merge.Merged();
  ASSERT_EQ(map.things.size(), 1U);
  EXPECT_EQ(map.things[0].days, (std::vector<DayScans>{{kDay, 2}}));
}

TEST(MapMerge, LeavesOutTheLongestUnseenBeyondItsBounds) {
  std::vector<double> first_day;
  std::vector<double> second_day;
  for (int i = 0; i < 15; ++i) first_day.push_back(-12.0 * i);
  for (int i = 1; i <= 3995; ++i) second_day.push_back(12.0 * i);
  MapMerge merge;
  Add(merge, Tracks(0, 0.0, first_day));
  Add(merge, Tracks(1, 0.0, second_day));
  const auto map = merge.Merged();
  EXPECT_EQ(map.things.size(), kMostMapThings);
  EXPECT_EQ(merge.num_things_left_out(), 10);
  EXPECT_EQ(std::ranges::count(map.things, kDay, [](const MapThing& thing) { return thing.days.front().day; }), 5);
}

TEST(MapMerge, MergesLandOfManyDaysCellByCell) {
  MapMerge merge;
  const auto middles_m = [](const std::vector<int>& cells) {
    std::vector<Eigen::Vector2d> places_m;
    for (const int cell : cells) places_m.emplace_back(0.5 * cell + 0.25, 0.25);
    return places_m;
  };
  for (int second = 0; second <= 10; ++second) merge.AddLand(At(0, second), kDatum, middles_m({0, 1, 2}));
  for (int second = 0; second <= 10; ++second) merge.AddLand(At(1, second), kDatum, middles_m({1, 2, 3}));
  // It was land for a moment, once a day.
  for (const int day : {0, 1}) merge.AddLand(At(day, 5.0), kDatum, middles_m({40}));
  const std::vector<Eigen::Vector2d> nowhere{{kNaN, 0.0}, {0.0, 1e300}};
  for (int second = 0; second <= 10; ++second) merge.AddLand(At(1, second), kDatum, nowhere);
  std::size_t num_cells = 0;
  std::size_t num_both = 0;
  for (const auto& land : merge.Merged().land) {
    num_cells += land.cells.size();
    if (land.days != std::vector<std::int32_t>{kDay, kDay + 1}) continue;
    num_both += land.cells.size();
    EXPECT_EQ(land.seen, At(1, 10.0));
  }
  EXPECT_EQ(num_cells, 4U);
  EXPECT_EQ(num_both, 2U);
}

class MapTable : public ExportTest {
 protected:
  void AddTracks(const tracks_t& message) { AddBytesAt(message.end_utime_us, bus::kTracks.name, bus::Encode(message)); }
  void AddDay(int day, int num_scans = 3) {
    for (int i = 0; i < num_scans; ++i) {
      auto message = Tracks(day, i, {10.0, 30.0});
      message.num_waterline = 2;
      message.waterline_east_m = {0.25F, 0.75F};
      message.waterline_north_m = {50.25F, 50.25F};
      AddTracks(message);
    }
  }
};

TEST_F(MapTable, IsGeoJson) {
  AddDay(0, 12);
  ASSERT_EQ(Export("map", "geojson"), kExitFine) << errors_;
  const auto features = nlohmann::json::parse(text_).at("features");
  ASSERT_EQ(features.size(), 3U);
  EXPECT_EQ(features.at(0).at("properties").at("scans"), 12);
  EXPECT_EQ(features.at(2).at("properties").at("cells"), 2);
  EXPECT_NE(errors_.find("what is gone is not known: that takes LIDAR_SCAN, POSE, and the boat's config in RUN_INFO"), std::string::npos) << errors_;
}

TEST_F(MapTable, IsATableToo) {
  AddDay(0, 12);
  AddDay(1);
  ASSERT_EQ(Export("map"), kExitFine) << errors_;
  ASSERT_EQ(Rows().size(), 3U);
  EXPECT_TRUE(Rows()[0].starts_with("thing,buoy,43.6")) << Rows()[0];
  EXPECT_TRUE(Rows()[0].ends_with(",2,15,")) << Rows()[0];
  EXPECT_TRUE(Rows()[2].starts_with("land,,43.63")) << Rows()[2];
  EXPECT_TRUE(Rows()[2].ends_with(",1,,2")) << Rows()[2];
  const auto commas = [](const std::string& line) { return std::ranges::count(line, ','); };
  EXPECT_EQ(commas(Rows()[0]), commas(text_.substr(0, text_.find('\n'))));
  EXPECT_EQ(commas(Rows()[2]), commas(Rows()[0]));
}

TEST_F(MapTable, DoesNotDependOnTheOrderNorOnALogThatIsThereTwice) {
  std::vector<std::filesystem::path> logs;
  for (int day = 0; day < 3; ++day) {
    log_ = folder_ / ("log" + std::to_string(day));
    logs.push_back(log_);
    AddDay(day);
    writer_.reset();
  }
  const auto text_of = [&](const std::vector<std::filesystem::path>& inputs) {
    EXPECT_EQ(Export(Request{.inputs = inputs, .table = "map", .format = "geojson", .output = folder_ / "out", .force = true}), kExitFine) << errors_;
    return text_;
  };
  const auto text = text_of(logs);
  EXPECT_NE(text.find(R"("days":3)"), std::string::npos) << text;
  EXPECT_EQ(text_of({logs[2], logs[0], logs[2], logs[1], logs[0]}), text);
}

TEST_F(MapTable, LeavesOutMessagesThatAreNone) {
  auto nowhere = Tracks(0, 0.0, {10.0});
  nowhere.datum_latitude_deg = kNaN;
  AddTracks(nowhere);
  auto part = Tracks(0, 1.0, {10.0});
  part.part_index = 7;
  AddTracks(part);
  auto never = Tracks(0, 2.0, {10.0});
  never.begin_utime_us = std::numeric_limits<std::int64_t>::min();
  AddBytes(bus::kTracks.name, bus::Encode(never));
  ASSERT_EQ(Export("map"), kExitFine) << errors_;
  EXPECT_TRUE(Rows().empty());
  EXPECT_NE(errors_.find("2 messages of TRACKS contradict themselves"), std::string::npos) << errors_;
}

TEST_F(MapTable, SaysWhatALogLacksAndWhatIsNoFormatOfIt) {
  Add(bus::kLidarScan, MakeScan(0));
  EXPECT_EQ(Export("map", "geojson"), kExitFailed);
  EXPECT_NE(errors_.find("holds no TRACKS"), std::string::npos) << errors_;
  EXPECT_EQ(Export("map", "svg"), kExitUsage);
  EXPECT_EQ(Export("map", "ply"), kExitUsage);
  EXPECT_EQ(Export("map", "kml"), kExitUsage);
  EXPECT_EQ(Export("map", "geojson", 7), kExitUsage) << errors_;
  EXPECT_EQ(Export(Request{.inputs = {log_}, .table = "map", .format = "geojson", .output = folder_ / "out", .span = {7, std::nullopt}}), kExitUsage);
}

}  // namespace
}  // namespace lookout::exporter::map_merge
