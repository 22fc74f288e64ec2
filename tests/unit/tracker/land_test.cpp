#include "services/tracker/core/land.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "common/core/angles.hpp"
#include "services/tracker/core/outline.hpp"
#include "services/tracker/core/tracker.hpp"
#include "tests/unit/tracker/scans.hpp"

namespace lookout::tracker::coast {
namespace {

constexpr double kLidarM = 1.5;  // over the water
constexpr int kRings = 16;
constexpr int kColumns = 900;

// A wall that stands in the water, seen from above.
struct Wall {
  Eigen::Vector2d from_m;
  Eigen::Vector2d to_m;
  double top_m = 0.0;
  int thing = 0;
};

std::vector<Wall> Box(const Eigen::Vector2d& middle_m, double east_m, double north_m, double top_m, int thing) {
  const Eigen::Vector2d half(0.5 * east_m, 0.5 * north_m);
  const Eigen::Vector2d a = middle_m - half;
  const Eigen::Vector2d b(middle_m.x() + half.x(), middle_m.y() - half.y());
  const Eigen::Vector2d c = middle_m + half;
  const Eigen::Vector2d d(middle_m.x() - half.x(), middle_m.y() + half.y());
  return {{a, b, top_m, thing}, {b, c, top_m, thing}, {c, d, top_m, thing}, {d, a, top_m, thing}};
}

// Distance to a wall along a unit vector; infinite where it is not met.
double MeetsAfter(const Wall& wall, const Eigen::Vector2d& from_m, const Eigen::Vector2d& direction) {
  const Eigen::Vector2d along = wall.to_m - wall.from_m;
  const double turn = Cross(direction, along);
  if (std::abs(turn) < 1e-12) return std::numeric_limits<double>::infinity();
  const Eigen::Vector2d off = wall.from_m - from_m;
  const double distance_m = Cross(off, along) / turn;
  const double share = Cross(off, direction) / turn;
  return distance_m > 0.0 && share >= 0.0 && share <= 1.0 ? distance_m : std::numeric_limits<double>::infinity();
}

struct Called {
  int segment_id = 0;
  bool is_land = false;
};
using Segmenter = std::function<Called(int thing, const Eigen::Vector2d& place_m)>;

// What a lidar on a boat that heads north sees of walls, and what the segmenter makes of it.
ScanInput Look(int scan, const Eigen::Vector2d& own_m, const std::vector<Wall>& walls, const Segmenter& segmenter, std::mt19937_64& random) {
  ScanInput input = test::MakeScan(scan, own_m);
  Sweep sweep;
  for (int ring = 0; ring < kRings; ++ring) {
    sweep.elevation_rad.push_back(static_cast<float>((-15.0 + 2.0 * ring) * kPi / 180.0));
    sweep.azimuth_offset_rad.push_back(0.0F);
  }
  std::uniform_real_distribution<double> noise_m(-0.03, 0.03);
  struct Segment {
    std::vector<Eigen::Vector2d> places_m;
    bool is_land = false;
    double top_m = 0.0;
  };
  std::map<int, Segment> segments;
  for (int column = 0; column < kColumns; ++column) {
    const double azimuth_rad = kTwoPi * column / kColumns;
    const Eigen::Vector2d direction(std::sin(azimuth_rad), std::cos(azimuth_rad));
    std::vector<std::pair<double, const Wall*>> met;
    for (const auto& wall : walls) {
      const double distance_m = MeetsAfter(wall, own_m, direction);
      if (distance_m < 90.0) met.emplace_back(distance_m, &wall);
    }
    std::ranges::sort(met);
    sweep.azimuth_rad.push_back(static_cast<float>(azimuth_rad));
    sweep.time.push_back(input.time);
    for (const float elevation_rad : sweep.elevation_rad) {
      float range_m = 0.0F;
      int label = 0;
      for (const auto& [distance_m, wall] : met) {
        const double z = kLidarM + distance_m * std::tan(elevation_rad);
        if (z < 0.0) break;  // the water does not reflect
        if (z > wall->top_m) continue;
        const double seen_m = distance_m + noise_m(random);
        const Eigen::Vector2d place_m = own_m + seen_m * direction;
        const Called called = segmenter(wall->thing, place_m);
        range_m = static_cast<float>(seen_m / std::cos(elevation_rad));
        label = called.segment_id;
        auto& segment = segments[label];
        segment.places_m.push_back(place_m);
        segment.is_land = called.is_land;
        segment.top_m = std::max(segment.top_m, z);
        break;
      }
      sweep.range_m.push_back(range_m);
      sweep.label.push_back(static_cast<std::int16_t>(label));
    }
  }
  for (const auto& [id, segment] : segments) {
    if (segment.places_m.size() < 3) continue;
    Seen seen;
    seen.segment_id = id;
    seen.time = input.end_time;
    seen.is_land = segment.is_land;
    seen.num_returns = static_cast<int>(segment.places_m.size());
    seen.outline_m = Polygon(SupportOf(segment.places_m));
    for (const auto& corner : seen.outline_m) seen.position_m += corner / static_cast<double>(seen.outline_m.size());
    seen.covariance_relative_m2 = 0.0004 * Eigen::Matrix2d::Identity();
    seen.covariance_m2 = 0.01 * Eigen::Matrix2d::Identity();
    seen.top_above_water_m = segment.top_m;
    input.seen.push_back(seen);
  }
  input.sweep = std::move(sweep);
  return input;
}

TrackerParams Params() {
  TrackerParams params;
  params.reference_point_above_water_m = kLidarM;
  params.max_range_m = 100.0;
  return params;
}

bool IsReported(const Track& track) { return track.status == TrackStatus::kConfirmed || track.status == TrackStatus::kCoasting; }

constexpr int kQuay = 1;
constexpr int kBoat = 2;
const std::vector<Wall> kQuayWalls{{{-60.0, 20.0}, {60.0, 20.0}, 2.0, kQuay}, {{-60.0, 26.0}, {60.0, 26.0}, 7.0, kQuay}};

TEST(LandInTracker, QuayInChangingPiecesNeverBecomesATrack) {
  Tracker tracker(Params());
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
  Tracker tracker(Params());
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
  Tracker tracker(Params());
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
