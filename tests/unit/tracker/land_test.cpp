#include "services/tracker/core/land.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <set>
#include <vector>

#include "services/tracker/core/tracker.hpp"
#include "tests/unit/tracker/walls.hpp"

namespace lookout::tracker::coast {
namespace {

using test::Box;
using test::Called;
using test::IsReported;
using test::Look;
using test::Wall;
using test::WallParams;

constexpr int kQuay = 1;
constexpr int kBoat = 2;
const std::vector<Wall> kQuayWalls{{{-60.0, 20.0}, {60.0, 20.0}, 2.0, kQuay}, {{-60.0, 26.0}, {60.0, 26.0}, 7.0, kQuay}};

TEST(LandInTracker, QuayInChangingPiecesNeverBecomesATrack) {
  Tracker tracker(WallParams());
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int scan = 0; scan < 300; ++scan) {
    std::vector<double> cuts_m;  // in order
    std::vector<bool> is_land;
    for (double cut_m = -60.0; cut_m < 60.0; cut_m += 3.0 + 20.0 * share(random)) {
      cuts_m.push_back(cut_m);
      is_land.push_back(share(random) < 0.8);
    }
    const auto input = Look(
        scan, {-15.0 + 0.1 * scan, 0.0}, kQuayWalls,
        [&](int, const Eigen::Vector2d& place_m) {
          const auto piece = std::ranges::upper_bound(cuts_m, place_m.x()) - cuts_m.begin();
          return Called{static_cast<int>(piece) + 1, is_land[static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, piece - 1))]};
        },
        random);
    const auto& picture = tracker.Update(input);
    for (const auto& track : picture.tracks) ASSERT_FALSE(IsReported(track)) << "scan " << scan << ", track " << track.id;
    if (scan > 20) {
      EXPECT_EQ(picture.land_segment_ids.size(), input.seen.size()) << "scan " << scan;
    }
  }
}

TEST(LandInTracker, BargeThatLeavesAQuayBecomesATrackAndLeavesNoLand) {
  constexpr int kLeaves = 100;
  Tracker tracker(WallParams());
  std::mt19937_64 random(4);
  int first = 0;
  std::set<std::int64_t> ids;
  std::vector<Eigen::Vector2d> waterline_m;
  for (int scan = 0; scan < 500; ++scan) {
    const double way_m = std::max(0.0, test::kScanS * (scan - kLeaves));
    auto walls = kQuayWalls;
    for (const auto& wall : Box({5.0 + way_m, 17.0}, 16.0, 4.0, 2.5, kBoat)) walls.push_back(wall);
    const auto input = Look(
        scan, {0.0, 0.0}, walls,
        [](int thing, const Eigen::Vector2d&) {
          return Called{thing, true};
        },
        random);
    const auto& picture = tracker.Update(input);
    for (const auto& track : picture.tracks) {
      if (!IsReported(track)) continue;
      ASSERT_GE(scan, kLeaves);
      if (first == 0) first = scan;
      ids.insert(track.id);
    }
    if (!picture.waterline_m.empty()) waterline_m = picture.waterline_m;
  }
  EXPECT_GT(first, kLeaves);
  EXPECT_LT(first, kLeaves + 50);
  EXPECT_EQ(ids.size(), 1U);
  const auto lies_where_it_was = [](const Eigen::Vector2d& place_m) {
    return std::abs(place_m.x() - 5.0) < 8.0 && place_m.y() > 14.0 && place_m.y() < 18.4;  // nearer to the quay it cannot be told from it
  };
  EXPECT_EQ(std::ranges::count_if(waterline_m, lies_where_it_was), 0);
  EXPECT_GT(waterline_m.size(), 100U);  // of the quay
}

TEST(LandInTracker, BoatThatComesAlongsideKeepsItsId) {
  constexpr int kArrives = 150;
  Tracker tracker(WallParams());
  std::mt19937_64 random(5);
  std::set<std::int64_t> ids;
  int num_reported = 0;
  for (int scan = 0; scan < kArrives + 600; ++scan) {
    const double to_go_m = 1.0 * test::kScanS * std::max(0, kArrives - scan);
    auto walls = kQuayWalls;
    for (const auto& wall : Box({-5.0 - 0.8 * to_go_m, 18.5 - 0.6 * to_go_m}, 7.0, 2.4, 1.4, kBoat)) walls.push_back(wall);
    // Once it lies there it is one segment with the quay.
    const auto input = Look(
        scan, {0.0, 0.0}, walls,
        [scan](int thing, const Eigen::Vector2d&) {
          return thing == kBoat && scan < kArrives ? Called{kBoat, false} : Called{kQuay, true};
        },
        random);
    for (const auto& track : tracker.Update(input).tracks) {
      if (!IsReported(track)) continue;
      ids.insert(track.id);
      if (scan >= kArrives && std::abs(track.position_m.x() + 5.0) < 2.0 && std::abs(track.position_m.y() - 18.5) < 1.5) ++num_reported;
    }
  }
  EXPECT_EQ(ids.size(), 1U);
  EXPECT_EQ(num_reported, 600);
}

TEST(LandMemory, OneScanMakesNoLand) {
  LandMemory land;
  const std::vector<Eigen::Vector2d> places_m(50, Eigen::Vector2d(3.2, -7.1));
  land.Add(places_m, {}, LandMemory::Said::kLand);
  EXPECT_FALSE(land.IsLand(places_m[0]));
  for (int scan = 0; scan < 5; ++scan) land.Add(places_m, {}, LandMemory::Said::kLand);
  EXPECT_TRUE(land.IsLand(places_m[0]));
  for (int scan = 0; scan < 5; ++scan) land.Add(places_m, {}, LandMemory::Said::kThing);
  EXPECT_FALSE(land.IsLand(places_m[0]));
}

TEST(LandMemory, StaysBelowItsBoundAlongAHundredKilometresOfCoast) {
  LandMemory land;
  std::size_t most = 0;
  for (double east_m = 0.0; east_m < 100'000.0; east_m += 20.0) {
    std::vector<Eigen::Vector2d> places_m;
    for (double along_m = -100.0; along_m <= 100.0; along_m += 8.0) {
      for (double off_m = 20.0; off_m < 100.0; off_m += 8.0) places_m.emplace_back(east_m + along_m, off_m);
    }
    for (int scan = 0; scan < 4; ++scan) land.Add(places_m, {}, LandMemory::Said::kLand);
    land.Forget({east_m, 0.0});
    most = std::max(most, land.num_tiles());
  }
  EXPECT_LE(most, LandMemory::kMostTiles);
  EXPECT_GT(most, LandMemory::kMostTiles / 2);
  EXPECT_TRUE(land.IsLand({99'900.0, 20.0}));
  EXPECT_FALSE(land.IsLand({100.0, 20.0}));
}

}  // namespace
}  // namespace lookout::tracker::coast
