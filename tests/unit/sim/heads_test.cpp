#include "lab/sim/heads.hpp"

#include <algorithm>
#include <chrono>
#include <gtest/gtest.h>
#include <set>
#include <stdexcept>
#include <string_view>
#include <variant>

#include "common/core/angles.hpp"
#include "common/core/frames.hpp"
#include "lab/sim/head_lidar.hpp"
#include "lab/sim/head_simulation.hpp"
#include "tests/unit/sim/sim_fixture.hpp"

namespace lookout::sim {
namespace {

constexpr Utime kHeadsStart{std::chrono::microseconds(1'781'532'600'000'000)};

// A wall 12 m ahead, without strays and noise of the range.
Scene SceneOfHeads() {
  Scene scene = StillScene(0.0, {{Prism{Rectangle(12.0, 13.0, -20.0, 20.0), 0.0, 6.0}, {0.6}}});
  scene.effects.set_range_sd_m(0.0);
  scene.effects.set_stray_probability(0.0);
  return scene;
}

TEST(Heads, AreWhatTheWireCanHold) {
  std::set<std::string_view> names;
  for (const Head& head : Heads()) {
    EXPECT_TRUE(names.insert(head.name).second) << head.name;
    EXPECT_EQ(FindHead(head.name), &head);
    EXPECT_NE(head.name, kVlp16Name);
    EXPECT_NE(head.name, kHiResName);
    EXPECT_LE(head.beams.size(), 128U);
    EXPECT_TRUE(std::ranges::is_sorted(head.beams, {}, &HeadBeam::elevation_deg)) << head.name;
    EXPECT_LE(head.ranges.max_m, 65'535.0 * head.ranges.unit_m) << head.name;
    EXPECT_NE(head.column_period_us > 0.0, head.columns_per_turn > 0) << head.name;
  }
  EXPECT_EQ(FindHead("vlp16"), nullptr);
  EXPECT_EQ(FindHead("os9"), nullptr);
}

// Tables of the makers: the ends, and how far apart the rings are in the middle.
TEST(Heads, HaveTheBeamsOfTheirMakers) {
  struct Row {
    const char* name;
    std::size_t rings;
    double lowest_deg;
    double highest_deg;
    double least_step_deg;
  };
  for (const Row& row : {Row{"vlp-32c", 32, -25.0, 15.0, 0.333}, Row{"hdl-32e", 32, -30.667, 10.667, 1.333}, Row{"os1-64", 64, -16.6, 16.6, 0.527},
                         Row{"os1-128", 128, -21.15, 21.15, 0.333}, Row{"xt32", 32, -16.0, 15.0, 1.0}, Row{"qt64", 64, -52.121, 52.121, 1.45}}) {
    const auto& beams = FindHead(row.name)->beams;
    ASSERT_EQ(beams.size(), row.rings) << row.name;
    EXPECT_NEAR(beams.front().elevation_deg, row.lowest_deg, 0.01) << row.name;
    EXPECT_NEAR(beams.back().elevation_deg, row.highest_deg, 0.01) << row.name;
    double least_deg = 90.0;
    for (std::size_t ring = 1; ring < beams.size(); ++ring)
      least_deg = std::min(least_deg, beams[ring].elevation_deg - beams[ring - 1].elevation_deg);
    EXPECT_NEAR(least_deg, row.least_step_deg, 0.01) << row.name;
  }
}

// By the beam table of the scan a return lies where the truth has it.
TEST(HeadLidar, PlacesReturnsWhereTheTruthIs) {
  for (const Head& head : Heads()) {
    const auto scene = SceneOfHeads();
    HeadLidar lidar(scene, SmallBoat(), head, 600.0, {}, kHeadsStart, 1);
    const auto made = lidar.Next();
    ASSERT_GT(made.returns.size(), 10U) << head.name;
    const auto num_rings = head.beams.size();
    for (const auto& truth : made.returns) {
      const auto cell = static_cast<std::size_t>(truth.slot);
      const auto& ring = made.scan.head.rings[cell % num_rings];
      const double azimuth_rad = double{made.scan.columns.azimuth_rad[cell / num_rings]} + ring.azimuth_offset_rad;
      const double range_m = made.scan.columns.range[cell] * head.ranges.unit_m;
      const Eigen::Vector3d p_m = range_m * BeamDirection(azimuth_rad, ring.elevation_rad) + Eigen::Vector3d(0.0, 0.0, ring.origin_height_m);
      // The wire lacks the level part of the beams' origin (LIDAR_SCAN): up to 2 mm.
      EXPECT_LT((p_m - truth.p_lidar_m).norm(), head.ranges.unit_m + 0.004) << head.name;
      EXPECT_EQ(truth.ring, static_cast<int>(cell % num_rings));
      EXPECT_EQ(made.object_id[cell], truth.object_id);
    }
  }
}

TEST(HeadLidar, GoesRoundOnceAScan) {
  for (const Head& head : Heads()) {
    const auto scene = SceneOfHeads();
    HeadLidar lidar(scene, SmallBoat(), head, 600.0, {}, kHeadsStart, 2);
    const auto first = lidar.Next();
    const auto second = lidar.Next();
    EXPECT_EQ(second.scan.head.seq, first.scan.head.seq + 1);
    EXPECT_NEAR(ToSeconds(second.scan.head.time - first.scan.head.time), 0.1, 0.001) << head.name;
    const auto& azimuth_rad = first.scan.columns.azimuth_rad;
    EXPECT_TRUE(std::ranges::is_sorted(azimuth_rad)) << head.name;
    EXPECT_LT(azimuth_rad.front(), DegToRad(1.0));
    EXPECT_GT(azimuth_rad.back(), DegToRad(359.0));
    EXPECT_EQ(first.scan.num_cells(), azimuth_rad.size() * head.beams.size());
    if (head.columns_per_turn > 0) {
      EXPECT_EQ(first.scan.columns.size(), head.columns_per_turn);
    }
  }
}

TEST(HeadSimulation, GivesScansAndSentencesInOrderAndRefusesFaultsOfPackets) {
  const auto scene = SceneOfHeads();
  SimulationParams params;
  params.start = kHeadsStart;
  params.duration = std::chrono::seconds(1);
  HeadSimulation simulation(scene, SmallBoat(), *FindHead("qt64"), params, nullptr);
  Utime last{};
  int num_scans = 0;
  int num_datagrams = 0;
  while (const auto event = simulation.Next()) {
    EXPECT_GE(event->time, last);
    last = event->time;
    ++(std::holds_alternative<HeadScan>(event->heard) ? num_scans : num_datagrams);
  }
  EXPECT_GE(num_scans, 8);
  EXPECT_GT(num_datagrams, 20);
  params.faults = {ParseTimedFault("free_run:0:1")};
  EXPECT_THROW(HeadSimulation(scene, SmallBoat(), *FindHead("qt64"), params, nullptr), std::invalid_argument);
  params.faults = {ParseTimedFault("gnss_gap:0:1")};
  EXPECT_NO_THROW(HeadSimulation(scene, SmallBoat(), *FindHead("qt64"), params, nullptr));
}

}  // namespace
}  // namespace lookout::sim
