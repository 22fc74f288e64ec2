// MAP of the service: what it says of what was given, when it is kept, and that nothing else depends on it.
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/bus/memory_bus.hpp"
#include "services/tracker/map_wire.hpp"
#include "services/tracker/service.hpp"
#include "tests/unit/tracker_shell/messages.hpp"

namespace lookout::tracker::map_telling {
namespace {

constexpr std::int64_t kMinuteUs = 60'000'000;

// What the tracker sent of a run in which a thing stands 20 m to the north, and something that is called land lies about, from a boat that sails
// towards the thing.
struct Run {
  std::vector<map_t> maps;
  std::vector<std::vector<std::uint8_t>> alerts;
  std::vector<tracks_t> tracks;
  std::int64_t num_alerts = 0;
};

OwnMap MapOfDays(int num_days) {
  OwnMap map;
  auto& thing = map.things.emplace_back();
  const auto place = Datum{43.7, -72.3, 100.0}.Map().Reverse({0.2, 20.2, 0.0});
  thing.id = 1;
  thing.latitude_deg = place.latitude_deg;
  thing.longitude_deg = place.longitude_deg;
  thing.deviation_m = 0.5;
  thing.length_m = 0.7;
  thing.top_above_water_m = 1.0;
  thing.outline_m = {{-0.3, -0.3}, {0.3, -0.3}, {0.0, 0.3}};
  for (int day = 0; day < num_days; ++day) thing.days.push_back({20'000 + day, 5});
  // Where the boat sails.
  const auto cell = earth_grid::CellAt(43.7, -72.3);
  map.land.push_back({cell.tile, {}, {20'000}, {cell.index}});
  return map;
}

Run RunWith(const std::optional<OwnMap>& map, int num_scans, double speed_mps = 0.5) {
  auto params = test::MakeParams();
  params.look_out.limits.guard_zone = {.range_m = 10.0, .bearing = {0.0, 6.283}};
  if (map) params.map = std::make_shared<const OwnMap>(*map);
  bus::MemoryBus bus;
  Service service(bus, params);
  Run run;
  bus::Subscribe<map_t>(bus, bus::kMap, [&run](const map_t& message) { run.maps.push_back(message); });
  bus::Subscribe<tracks_t>(bus, bus::kTracks, [&run](const tracks_t& message) { run.tracks.push_back(message); });
  bus.SubscribeRaw(bus::kAlerts, [&run](std::string_view, Bytes bytes) {
    run.alerts.emplace_back(bytes.begin(), bytes.end());
    run.num_alerts += bus::Decode<alerts_t>(bytes)->num_alerts;
  });
  const auto send = [&bus](const bus::Channel& channel, const auto& message) {
    bus::Publish(bus, channel, message);
    while (bus.HandleOnce()) {
    }
  };
  for (int i = 0; i < num_scans; ++i) {
    const auto offset_us = test::kScanUs * i;
    for (auto pose_us = offset_us; pose_us < offset_us + test::kScanUs; pose_us += 20'000) {
      auto pose = test::MakePose(pose_us, pose_us / 20'000);
      pose.position_map_m[1] = 1e-6 * speed_mps * static_cast<double>(pose_us);
      pose.velocity_map_mps[1] = speed_mps;
      send(bus::kPose, pose);
    }
    send(bus::kLidarScan, test::MakeScan(offset_us, i));
    send(bus::kSegments, test::MakeSegments(offset_us, i));
    auto land = test::MakeObstacle(2, test::kStartUs + offset_us + 50'000, {-30.0, 5.0});
    land.kind = obstacle_t::KIND_LAND;
    send(bus::kObstacles, test::MakeObstacles(offset_us, i, {test::MakeObstacle(1, test::kStartUs + offset_us + 50'000, {0.0, 20.0}), land}));
  }
  return run;
}

MapLabel GivenLabel() {
  MapLabel label;
  label.source = map_t::SOURCE_GIVEN;
  return label;
}

TEST(MapTelling, BeginsWithWhatWasGiven) {
  const auto with = RunWith(MapOfDays(3), 5);
  ASSERT_EQ(with.maps.size(), 1U);
  const auto& given = with.maps[0];
  EXPECT_EQ(given.source, map_t::SOURCE_GIVEN);
  EXPECT_EQ(given.utime_us, test::kStartUs);
  EXPECT_EQ(given.begin_utime_us, test::kStartUs);
  EXPECT_EQ(given.seq, 0);
  EXPECT_EQ(given.num_parts, 1);
  EXPECT_TRUE(std::isnan(given.datum_latitude_deg));
  ASSERT_EQ(given.num_things, 1);
  EXPECT_EQ(given.things[0].num_days, 3);
  ASSERT_EQ(given.num_land, 1);
  EXPECT_EQ(given.land[0].num_cells, 1);

  const auto without = RunWith(std::nullopt, 5);
  ASSERT_EQ(without.maps.size(), 1U) << "that there is none is told";
  EXPECT_EQ(without.maps[0].source, map_t::SOURCE_GIVEN);
  EXPECT_EQ(without.maps[0].num_things + without.maps[0].num_land, 0);
}

TEST(MapTelling, KeepsEachMinuteWhatHasChanged) {
  static_assert(test::kStartUs % kMinuteUs == 0);
  const auto run = RunWith(std::nullopt, 1350, 0.0);
  ASSERT_EQ(run.maps.size(), 3U);
  for (int minute = 1; minute <= 2; ++minute) {
    const auto& kept = run.maps[static_cast<std::size_t>(minute)];
    EXPECT_EQ(kept.source, map_t::SOURCE_KEPT);
    EXPECT_EQ(kept.seq, minute);
    EXPECT_EQ(kept.end_utime_us / kMinuteUs, test::kStartUs / kMinuteUs + minute) << "the first scan that ends in the minute";
    EXPECT_LT(kept.end_utime_us % kMinuteUs, test::kScanUs);
    EXPECT_EQ(kept.datum_latitude_deg, 43.7);
    ASSERT_EQ(kept.num_things, 1);
    const auto& thing = kept.things[0];
    EXPECT_EQ(thing.id, 1);
    EXPECT_EQ(thing.state, map_thing_t::STATE_SEEN);
    const auto place_m = Datum{43.7, -72.3, 100.0}.Map().Forward({thing.latitude_deg, thing.longitude_deg, 100.0});
    EXPECT_NEAR(place_m.x(), 0.25, 0.3);
    EXPECT_NEAR(place_m.y(), 20.25, 0.3);
    ASSERT_EQ(thing.num_days, 1);
    EXPECT_EQ(thing.day[0], DayOf(Utime(std::chrono::microseconds(test::kStartUs))));
    EXPECT_GE(thing.num_day_scans[0], 400 * minute);
    ASSERT_GE(kept.num_land, 1);
    EXPECT_EQ(kept.land[0].day, thing.day);
    EXPECT_GE(kept.land[0].num_cells, 1);
  }
}

// A map may be wrong, and what is known may be hit all the same.
TEST(MapTelling, ChangesNoAlert) {
  const auto without = RunWith(std::nullopt, 300);
  const auto with = RunWith(MapOfDays(5), 300);
  ASSERT_GT(without.num_alerts, 0) << "an alert is wanted";
  EXPECT_TRUE(without.alerts == with.alerts);
  ASSERT_EQ(with.tracks.size(), without.tracks.size());
  bool is_known = false;
  for (std::size_t i = 0; i < with.tracks.size(); ++i) {
    auto tracks = with.tracks[i];
    for (auto& track : tracks.tracks) {
      is_known |= track.known_days == 5;
      track.known_days = 0;
    }
    EXPECT_TRUE(bus::Encode(tracks) == bus::Encode(without.tracks[i])) << i;
  }
  EXPECT_TRUE(is_known);
}

TEST(MapTelling, KeepsWhatWasGivenUnderItsNumber) {
  const auto run = RunWith(MapOfDays(3), 700, 0.0);
  ASSERT_EQ(run.maps.size(), 2U);
  ASSERT_EQ(run.maps[1].num_things, 1);
  EXPECT_EQ(run.maps[1].things[0].id, run.maps[0].things[0].id);
  ASSERT_EQ(run.maps[1].things[0].num_days, 1) << "what this process saw; the days before stand in what was given";
}

TEST(MapMessages, GoInPartsAndComeBackTheSame) {
  auto map = MapOfDays(2);
  for (int i = 0; i < 3000; ++i) {
    map.things.push_back(map.things[0]);
    map.things.back().id = i + 2;
  }
  const auto parts = ToMessages(GivenLabel(), map, bus::kMaxMessageBytes);
  ASSERT_GT(parts.size(), 2U);
  OwnMap back;
  for (const auto& part : parts) {
    EXPECT_EQ(part.num_parts, static_cast<std::int32_t>(parts.size()));
    EXPECT_LE(bus::Encode(part).size(), static_cast<std::size_t>(bus::kMaxMessageBytes));
    const auto one = ToOwnMap(part);
    ASSERT_TRUE(one);
    back.things.insert(back.things.end(), one->things.begin(), one->things.end());
    back.land.insert(back.land.end(), one->land.begin(), one->land.end());
  }
  const auto again = ToMessages(GivenLabel(), back, bus::kMaxMessageBytes);
  ASSERT_EQ(again.size(), parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) EXPECT_TRUE(bus::Encode(again[i]) == bus::Encode(parts[i])) << i;
}

TEST(MapMessages, AreRefusedWhereTheyCannotBe) {
  const auto good = ToMessages(GivenLabel(), MapOfDays(2), bus::kMaxMessageBytes).front();
  ASSERT_TRUE(ToOwnMap(good));
  const auto is_refused = [&good](auto change) {
    auto message = good;
    change(message);
    return !ToOwnMap(message);
  };
  EXPECT_TRUE(is_refused([](map_t& map) { map.source = 0; }));
  EXPECT_TRUE(is_refused([](map_t& map) { map.part_index = 1; }));
  EXPECT_TRUE(is_refused([](map_t& map) { map.water_up_m = kNan; }));
  EXPECT_TRUE(is_refused([](map_t& map) { map.datum_latitude_deg = 91.0; }));
  EXPECT_TRUE(is_refused([](map_t& map) { map.things[0].latitude_deg = kNan; }));
  EXPECT_TRUE(is_refused([](map_t& map) { map.things[0].deviation_m = -1.0F; }));
  EXPECT_TRUE(is_refused([](map_t& map) { map.things[0].kind = 5; }));
  EXPECT_TRUE(is_refused([](map_t& map) { map.things[0].state = 3; }));
  EXPECT_TRUE(is_refused([](map_t& map) { map.things[0].id = 0; }));
  EXPECT_TRUE(is_refused([](map_t& map) { map.things[0].day = {5, 5}; }));
  EXPECT_TRUE(is_refused([](map_t& map) { map.things[0].num_day_scans = {1}; }));
  EXPECT_TRUE(is_refused([](map_t& map) { map.things[0].outline_east_m.clear(); }));
  EXPECT_TRUE(is_refused([](map_t& map) { map.things[0].seen_utime_us = kMaxUtimeUs + 1; }));
  EXPECT_TRUE(is_refused([](map_t& map) { map.land[0].cell = {1024}; }));
  EXPECT_TRUE(is_refused([](map_t& map) { map.land[0].cell = {7, 6}; }));
  EXPECT_TRUE(is_refused([](map_t& map) { map.land[0].tile_north = -1; }));
  const auto is_refused_as_kept = [&is_refused](std::int32_t tile) {
    return is_refused([tile](map_t& map) {
      map.source = map_t::SOURCE_KEPT;
      map.land[0].tile_east = map.land[0].tile_north = tile;
    });
  };
  EXPECT_FALSE(is_refused_as_kept(-5));
  EXPECT_TRUE(is_refused_as_kept(std::numeric_limits<std::int32_t>::min()));
  EXPECT_TRUE(is_refused_as_kept(std::numeric_limits<std::int32_t>::max()));
}

}  // namespace
}  // namespace lookout::tracker::map_telling
