// Maps of many days made one.
#include "tools/export/map_merge.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <utility>
#include <vector>

#include "services/tracker/map_file.hpp"
#include "services/tracker/map_wire.hpp"
#include "tests/unit/export/export_logs.hpp"

namespace lookout::exporter::map_merge {
namespace {

using std::chrono::hours;
using tracker::DayScans;
using tracker::MapThing;

constexpr std::int32_t kDay = 19'675;  // 2023-11-14, the day of kStartUs

Utime At(int day, int minute) { return Utime(std::chrono::microseconds(kStartUs)) + hours(24 * day) + std::chrono::minutes(minute); }

constexpr double kLatitudeDeg = 43.63;
constexpr double kLongitudeDeg = -72.15;

// 2 m by 1 m, so far to the east of the datum.
MapThing ThingAt(std::int64_t id, double east_m, Utime seen, std::vector<DayScans> days) {
  MapThing thing;
  thing.id = id;
  thing.kind = tracker::TrackKind::kBuoy;
  thing.state = MapThing::State::kSeen;
  const auto place = LocalFrame({kLatitudeDeg, kLongitudeDeg, 0.0}).Reverse({east_m, 0.0, 0.0});
  thing.latitude_deg = place.latitude_deg;
  thing.longitude_deg = place.longitude_deg;
  thing.deviation_m = 0.25;
  thing.length_m = 2.0;
  thing.width_m = 1.0;
  thing.first = seen - std::chrono::minutes(5);
  thing.seen = seen;
  thing.days = std::move(days);
  thing.outline_m = {{-1.0, -0.5}, {1.0, -0.5}, {1.0, 0.5}, {-1.0, 0.5}};
  return thing;
}

// MAP of a process that began on a day, a minute before midnight in its own count.
map_t MapOf(int day, int minute, std::int32_t source, const tracker::OwnMap& map) {
  tracker::MapLabel label;
  label.source = source;
  label.seq = minute;
  label.scan.key = {At(day, minute), 600 * minute};
  label.scan.begin = {At(day, 0), 0};
  label.scan.end_time = label.scan.key.time + std::chrono::milliseconds(100);
  if (source == map_t::SOURCE_KEPT) {
    label.scan.datum = {kLatitudeDeg, kLongitudeDeg, 200.0};
    label.land_begin = At(day, 0);
  }
  return tracker::ToMessages(label, map, bus::kMaxMessageBytes).front();
}
map_t Kept(int day, int minute, std::vector<MapThing> things, std::vector<tracker::MapLand> land = {}) {
  return MapOf(day, minute, map_t::SOURCE_KEPT, {std::move(things), std::move(land)});
}
map_t Given(int day, tracker::OwnMap map) { return MapOf(day, 0, map_t::SOURCE_GIVEN, map); }

tracker::OwnMap Merged(const std::vector<map_t>& messages) {
  MapMerge merge;
  for (const auto& message : messages) EXPECT_TRUE(merge.Add(message));
  return merge.Merged();
}

TEST(MapMerge, MakesOneOfAThingThatStoodOnManyDays) {
  const auto map = Merged({Kept(0, 1, {ThingAt(1, 10.0, At(0, 1), {{kDay, 5}})}),
                           Kept(1, 1, {ThingAt(4, 10.8, At(1, 1), {{kDay + 1, 6}}), ThingAt(5, 30.0, At(1, 1), {{kDay + 1, 2}})}),
                           Kept(2, 1, {ThingAt(2, 10.3, At(2, 1), {{kDay + 2, 7}})})});
  ASSERT_EQ(map.things.size(), 2U);
  const auto& thing = *std::ranges::max_element(map.things, {}, [](const MapThing& one) { return one.days.size(); });
  EXPECT_EQ(thing.days, (std::vector<DayScans>{{kDay, 5}, {kDay + 1, 6}, {kDay + 2, 7}}));
  EXPECT_EQ(thing.first, At(0, 1) - std::chrono::minutes(5));
  EXPECT_EQ(thing.seen, At(2, 1));
  EXPECT_NEAR(thing.longitude_deg, ThingAt(2, 10.3, At(2, 1), {}).longitude_deg, 1e-9) << "it is where it was seen last";
}

TEST(MapMerge, LetsTheLaterWordOfAProcessCount) {
  const auto map = Merged({Kept(0, 2, {ThingAt(1, 11.0, At(0, 2), {{kDay, 9}})}), Kept(0, 1, {ThingAt(1, 10.0, At(0, 1), {{kDay, 5}})})});
  ASSERT_EQ(map.things.size(), 1U);
  EXPECT_EQ(map.things[0].days, (std::vector<DayScans>{{kDay, 9}}));
  EXPECT_EQ(map.things[0].seen, At(0, 2));
}

TEST(MapMerge, DoesNotDependOnTheOrderNorOnALogThatIsThereTwice) {
  std::vector<map_t> messages;
  for (int day = 0; day < 4; ++day) {
    std::vector<MapThing> things;
    for (int i = 0; i < 20; ++i) things.push_back(ThingAt(i + 1, 1.1 * i + 0.3 * day, At(day, 1), {{kDay + day, i + 1}}));
    messages.push_back(Kept(day, 1, things, {{{day, 0}, At(day, 1), {kDay + day}, {1, 2, 3}}}));
  }
  const auto text = tracker::MapText(Merged(messages));
  auto twice = messages;
  std::ranges::reverse(twice);
  twice.insert(twice.end(), messages.begin(), messages.end());
  EXPECT_EQ(tracker::MapText(Merged(twice)), text);
}

// In a row of boats each has a neighbour that is near enough to be its own place of the day before.
TEST(MapMerge, NeverMakesOneOfTwoThingsOfAProcess) {
  const auto map = Merged({Kept(0, 1, {ThingAt(1, 10.0, At(0, 1), {{kDay, 1}}), ThingAt(2, 11.2, At(0, 1), {{kDay, 1}})}),
                           Kept(1, 1, {ThingAt(1, 10.4, At(1, 1), {{kDay + 1, 1}}), ThingAt(2, 11.6, At(1, 1), {{kDay + 1, 1}})})});
  ASSERT_EQ(map.things.size(), 2U);
  for (const auto& thing : map.things) EXPECT_EQ(thing.days.size(), 2U);
}

TEST(MapMerge, CountsWhatWasGivenOnce) {
  const tracker::OwnMap given{{ThingAt(1, 10.0, At(0, 1), {{kDay, 5}, {kDay + 1, 6}})}, {}};
  const tracker::OwnMap later{{ThingAt(1, 10.1, At(2, 1), {{kDay, 5}, {kDay + 1, 6}, {kDay + 2, 7}})}, {}};
  // Two days that began with the map, one that began with what was made of it, and the log of a day that is in it.
  const auto map = Merged({Given(2, given), Kept(2, 1, {ThingAt(1, 10.2, At(2, 1), {{kDay + 2, 7}})}), Given(3, later),
                           Kept(3, 1, {ThingAt(1, 10.3, At(3, 1), {{kDay + 3, 8}})})});
  ASSERT_EQ(map.things.size(), 1U);
  EXPECT_EQ(map.things[0].days, (std::vector<DayScans>{{kDay, 5}, {kDay + 1, 6}, {kDay + 2, 7}, {kDay + 3, 8}}));
}

TEST(MapMerge, KeepsWhatWasGivenAndNotSeen) {
  const auto map = Merged({Given(2, {{ThingAt(1, 10.0, At(0, 1), {{kDay, 5}})}, {{{100, 200}, At(0, 1), {kDay}, {7}}}}), Kept(2, 1, {})});
  ASSERT_EQ(map.things.size(), 1U);
  EXPECT_EQ(map.things[0].seen, At(0, 1));
  EXPECT_EQ(map.things[0].gone, std::nullopt);
  ASSERT_EQ(map.land.size(), 1U);
  EXPECT_EQ(map.land[0].cells, (std::vector<std::int16_t>{7}));
}

TEST(MapMerge, TellsWhatIsGoneUnlessItWasSeenLater) {
  auto gone = ThingAt(1, 10.0, At(0, 1), {});
  gone.state = MapThing::State::kGone;
  gone.gone = At(2, 1);
  const std::vector<map_t> days{Given(2, {{ThingAt(1, 10.0, At(0, 1), {{kDay, 5}})}, {}}), Kept(2, 1, {gone})};
  const auto map = Merged(days);
  ASSERT_EQ(map.things.size(), 1U);
  EXPECT_EQ(map.things[0].gone, At(2, 1));
  EXPECT_EQ(map.things[0].seen, At(0, 1));
  EXPECT_EQ(map.things[0].days.size(), 1U);

  auto back = days;
  back.push_back(Kept(3, 1, {ThingAt(9, 10.1, At(3, 1), {{kDay + 3, 4}})}));
  EXPECT_EQ(Merged(back).things.at(0).gone, std::nullopt);
  EXPECT_EQ(Merged(back).things.at(0).days.size(), 2U);
}

TEST(MapMerge, MergesLandOfManyDaysCellByCell) {
  const auto map = Merged({Kept(0, 1, {}, {{{0, 0}, At(0, 1), {kDay}, {0, 1, 2}}}), Kept(1, 1, {}, {{{0, 0}, At(1, 1), {kDay + 1}, {1, 2, 3}}}),
                           // It was land for a minute.
                           Kept(1, 2, {}, {{{5, 5}, At(1, 2), {kDay + 1}, {}}})});
  std::size_t num_cells = 0;
  std::size_t num_both = 0;
  for (const auto& land : map.land) {
    num_cells += land.cells.size();
    if (land.days.size() == 2) {
      num_both += land.cells.size();
      EXPECT_EQ(land.seen, At(1, 1));
    }
    EXPECT_TRUE(tracker::earth_grid::Has(land.tile));
  }
  EXPECT_EQ(num_cells, 4U);
  EXPECT_EQ(num_both, 2U);
}

TEST(MapMerge, TakesLandOfALaterWordForAllOfItsTile) {
  const auto map = Merged({Kept(0, 1, {}, {{{0, 0}, At(0, 1), {kDay}, {0, 1, 2}}}), Kept(0, 2, {}, {{{0, 0}, At(0, 1), {kDay}, {1}}})});
  ASSERT_EQ(map.land.size(), 1U);
  EXPECT_EQ(map.land[0].cells.size(), 1U);
}

TEST(MapMerge, LeavesOutTheLongestUnseenBeyondItsBounds) {
  std::vector<MapThing> things;
  for (int i = 0; i < 4010; ++i) things.push_back(ThingAt(i + 1, 12.0 * i, At(i < 15 ? 0 : 1, 0), {{kDay, 1}}));
  things[20].gone = At(2, 0);
  MapMerge merge;
  tracker::MapLabel label;
  label.scan.key = label.scan.begin = {At(1, 0), 0};
  label.scan.end_time = At(1, 0);
  for (const auto& part : tracker::ToMessages(label, {things, {}}, bus::kMaxMessageBytes)) EXPECT_TRUE(merge.Add(part));
  const auto map = merge.Merged();
  EXPECT_EQ(map.things.size(), tracker::kMostMapThings);
  EXPECT_EQ(merge.num_things_left_out(), 10);
  EXPECT_TRUE(std::ranges::none_of(map.things, [](const MapThing& thing) { return thing.gone.has_value(); })) << "what is gone goes first";
  EXPECT_EQ(std::ranges::count(map.things, At(0, 0), &MapThing::seen), 6);
}

tracks_t TracksAt(int day, double minute_s, double east_m, double speed_mps) {
  tracks_t message{};
  message.utime_us = ToUtimeUs(At(day, 0)) + static_cast<std::int64_t>(1e6 * minute_s);
  message.num_parts = 1;
  message.begin_utime_us = ToUtimeUs(At(day, 0));
  message.num_tracks = 1;
  auto& track = message.tracks.emplace_back();
  track = {};
  const auto thing = ThingAt(1, east_m, At(day, 0), {});
  track.id = 77;
  track.status = track_t::STATUS_CONFIRMED;
  track.latitude_deg = thing.latitude_deg;
  track.longitude_deg = thing.longitude_deg;
  track.seen_utime_us = message.utime_us;
  track.first_utime_us = message.utime_us - 30'000'000;
  track.velocity_map_mps[0] = speed_mps;
  track.covariance[0][0] = track.covariance[1][1] = 0.0625;
  track.length_m = 2.0F;
  track.width_m = 1.0F;
  track.num_outline = 1;
  track.outline_east_m = track.outline_north_m = {0.0F};
  return message;
}

TEST(MapMerge, TakesWhatStandsInTheLastTracks) {
  MapMerge merge;
  EXPECT_TRUE(merge.Add(Kept(0, 1, {ThingAt(1, 10.0, At(0, 1), {{kDay, 5}})})));
  EXPECT_TRUE(merge.Add(TracksAt(0, 70.0, 40.0, 0.0)));  // not the last
  auto last = TracksAt(0, 90.0, 10.2, 0.0);
  last.tracks.push_back(TracksAt(0, 90.0, 60.0, 0.0).tracks[0]);
  last.tracks.back().id = 78;
  last.tracks.push_back(TracksAt(0, 90.0, 80.0, 1.0).tracks[0]);  // it moves
  last.tracks.back().id = 79;
  last.tracks.push_back(TracksAt(0, 90.0, 100.0, 0.0).tracks[0]);
  last.tracks.back().id = 80;
  last.tracks.back().outline_east_m[0] = std::numeric_limits<float>::quiet_NaN();  // it is nowhere
  last.num_tracks = 4;
  EXPECT_TRUE(merge.Add(last));
  const auto map = merge.Merged();
  ASSERT_EQ(map.things.size(), 2U);
  const auto old = std::ranges::find(map.things, std::vector<DayScans>{{kDay, 5}}, &MapThing::days);
  ASSERT_NE(old, map.things.end()) << "seen again, by how many scans more is not known";
  EXPECT_EQ(ToUtimeUs(old->seen), last.utime_us);
}

// With each copy of a log its last TRACKS came again.
TEST(MapMerge, CountsTheLastTracksOfALogThatIsThereTwiceOnce) {
  MapMerge merge;
  for (int copy = 0; copy < 2; ++copy) {
    EXPECT_TRUE(merge.Add(Kept(0, 1, {})));
    EXPECT_TRUE(merge.Add(TracksAt(0, 90.0, 40.0, 0.0)));
  }
  EXPECT_EQ(merge.Merged().things.size(), 1U);
}

TEST(MapMerge, LeavesOutMessagesThatAreNone) {
  MapMerge merge;
  auto message = Kept(0, 1, {ThingAt(1, 10.0, At(0, 1), {{kDay, 5}})});
  message.things[0].latitude_deg = kNaN;
  EXPECT_FALSE(merge.Add(message));
  EXPECT_TRUE(merge.Merged().things.empty());
}

class MapTable : public ExportTest {};

TEST_F(MapTable, IsGeoJsonThatTheTrackerReads) {
  Add(bus::kMap, Kept(0, 1, {ThingAt(1, 10.0, At(0, 1), {{kDay, 5}})}, {{{0, 0}, At(0, 1), {kDay}, {0, 1, 2}}}));
  ASSERT_EQ(Export("map", "geojson"), kExitFine) << errors_;
  const auto map = tracker::ParseMap(text_);
  EXPECT_EQ(map.things.size(), 1U);
  ASSERT_EQ(map.land.size(), 1U);
  EXPECT_EQ(map.land[0].cells.size(), 3U);
  EXPECT_NE(text_.find(R"("last_seen":"2023-11-14T22:14:20Z")"), std::string::npos) << text_;
}

TEST_F(MapTable, IsATableToo) {
  Add(bus::kMap, Kept(0, 1, {ThingAt(1, 10.0, At(0, 1), {{kDay, 5}, {kDay + 1, 7}})}, {{{0, 0}, At(0, 1), {kDay}, {0, 1, 2}}}));
  ASSERT_EQ(Export("map"), kExitFine) << errors_;
  ASSERT_EQ(Rows().size(), 2U);
  EXPECT_TRUE(Rows()[0].starts_with("thing,buoy,43.63")) << Rows()[0];
  EXPECT_TRUE(Rows()[0].ends_with(",2,12,")) << Rows()[0];
  EXPECT_TRUE(Rows()[1].starts_with("land,,43.63")) << Rows()[1];
  EXPECT_TRUE(Rows()[1].ends_with(",1,,3")) << Rows()[1];
  const auto commas = [](const std::string& line) { return std::ranges::count(line, ','); };
  EXPECT_EQ(commas(Rows()[0]), commas(text_.substr(0, text_.find('\n'))));
  EXPECT_EQ(commas(Rows()[1]), commas(Rows()[0]));
}

TEST_F(MapTable, SaysWhatALogLacksAndWhatIsNoFormatOfIt) {
  Add(bus::kLidarScan, MakeScan(0));
  EXPECT_EQ(Export("map", "geojson"), kExitFailed);
  EXPECT_NE(errors_.find("holds no MAP"), std::string::npos) << errors_;
  EXPECT_EQ(Export("map", "svg"), kExitUsage);
  EXPECT_EQ(Export("map", "ply"), kExitUsage);
  EXPECT_EQ(Export("map", "kml"), kExitUsage);
  EXPECT_EQ(Export("map", "geojson", 7), kExitUsage) << errors_;
  EXPECT_EQ(Export(Request{.inputs = {log_}, .table = "map", .format = "geojson", .output = folder_ / "out", .span = {7, std::nullopt}}), kExitUsage);
}

}  // namespace
}  // namespace lookout::exporter::map_merge
