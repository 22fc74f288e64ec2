// Motion from scan to scan, of scenes with known motion.
#include "services/odometer/core/odometer.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "common/core/angles.hpp"
#include "services/odometer/core/local_map.hpp"
#include "tests/unit/odometer/made_scene.hpp"

namespace lookout::odometer {
namespace {

std::vector<Motion> MotionsOf(const std::vector<Wall>& walls, const Arc& arc, int num_scans, const OdometerParams& params = MadeParams()) {
  Odometer odometer(params);
  std::vector<Motion> motions;
  for (int i = 0; i < num_scans; ++i) motions.push_back(odometer.Consume(MakeScan(i, walls, arc)));
  return motions;
}

int NumKnown(const std::vector<Motion>& motions) {
  return static_cast<int>(std::ranges::count_if(motions, [](const Motion& motion) { return motion.is_known(); }));
}

TEST(Odometer, SaysHowFarTheBoatWentForward) {
  const auto motions = MotionsOf(Basin(), {2.0, 0.0}, 30);
  EXPECT_EQ(motions[0].reason, Reason::kFirstScan);
  EXPECT_GE(NumKnown(motions), 24);
  const auto& last = motions.back();
  EXPECT_NEAR(last.displacement_m.x(), 0.2, 0.01);
  EXPECT_NEAR(last.displacement_m.y(), 0.0, 0.01);
  EXPECT_NEAR(last.turn_rad, 0.0, DegToRad(0.05));
  EXPECT_EQ(last.end - last.begin, std::chrono::milliseconds(100));
}

TEST(Odometer, TurnsAreClockwiseAndPortIsPositive) {
  // To starboard at 10 deg/s.
  const auto right = MotionsOf(Basin(), {1.0, DegToRad(10.0)}, 20).back();
  ASSERT_TRUE(right.is_known());
  EXPECT_NEAR(right.turn_rad, DegToRad(1.0), DegToRad(0.05));
  EXPECT_NEAR(right.displacement_m.x(), 0.1, 0.01);
  EXPECT_LT(right.displacement_m.y(), 0.002);
  const auto left = MotionsOf(Basin(), {1.0, DegToRad(-10.0)}, 20).back();
  EXPECT_NEAR(left.turn_rad, DegToRad(-1.0), DegToRad(0.05));
}

TEST(Odometer, ASumOfMotionsStaysNearTheWay) {
  const Arc arc{1.5, DegToRad(6.0)};
  const auto motions = MotionsOf(Basin(), arc, 60);
  Eigen::Vector2d p_m = Eigen::Vector2d::Zero();
  double bearing_rad = 0.0;
  constexpr std::size_t kFirst = 7;
  for (std::size_t i = kFirst; i < motions.size(); ++i) {
    ASSERT_TRUE(motions[i].is_known()) << i << " reason " << static_cast<int>(motions[i].reason);
    const auto& way_m = motions[i].displacement_m;
    p_m += Eigen::Vector2d(std::cos(bearing_rad) * way_m.x() - std::sin(bearing_rad) * way_m.y(),
                           std::sin(bearing_rad) * way_m.x() + std::cos(bearing_rad) * way_m.y());
    bearing_rad -= motions[i].turn_rad;
  }
  const double begin_s = kFirst * kScanS;
  const double end_s = 60 * kScanS;
  const double turned_rad = arc.BearingRad(begin_s);
  const Eigen::Vector2d truth_m = arc.PlaceM(end_s) - arc.PlaceM(begin_s);
  const Eigen::Vector2d turned_m(std::cos(turned_rad) * truth_m.x() + std::sin(turned_rad) * truth_m.y(),
                                 -std::sin(turned_rad) * truth_m.x() + std::cos(turned_rad) * truth_m.y());
  EXPECT_LT((p_m - turned_m).norm(), 0.01 * 1.5 * (end_s - begin_s));  // 1 % of the way
  EXPECT_NEAR(bearing_rad, arc.BearingRad(end_s) - turned_rad, DegToRad(0.1));
}

TEST(Odometer, WhatMovesIsLeftOut) {
  auto walls = Basin();
  AddBox({10.0, -12.0}, 8.0, 3.0, {-2.0, 1.5}, walls);
  AddBox({-15.0, 5.0}, 6.0, 2.5, {1.0, -1.0}, walls);
  const auto motions = MotionsOf(walls, {1.0, 0.0}, 40);
  EXPECT_GE(NumKnown(motions), 34);
  for (std::size_t i = 8; i < motions.size(); ++i) {
    if (!motions[i].is_known()) continue;
    EXPECT_NEAR(motions[i].displacement_m.x(), 0.1, 0.02) << i;
    EXPECT_NEAR(motions[i].displacement_m.y(), 0.0, 0.02) << i;
  }
}

TEST(Odometer, OpenWaterIsUnknown) {
  for (const auto& motion : MotionsOf({}, {2.0, 0.0}, 10)) EXPECT_FALSE(motion.is_known());
  EXPECT_EQ(MotionsOf({}, {2.0, 0.0}, 3).back().reason, Reason::kFewReturns);
}

// One boat that moves must not be taken for the shore.
TEST(Odometer, OneBoatAloneIsUnknown) {
  std::vector<Wall> walls;
  AddBox({15.0, 8.0}, 10.0, 4.0, {1.0, -0.5}, walls);
  EXPECT_EQ(NumKnown(MotionsOf(walls, {2.0, 0.0}, 30)), 0);
}

// A barge at 1.5 m/s, along which a boat would go in reverse.
TEST(Odometer, ABargeAloneIsUnknown) {
  std::vector<Wall> walls;
  AddBox({10.0, 10.0}, 70.0, 8.0, {1.5, 0.0}, walls);
  EXPECT_EQ(NumKnown(MotionsOf(walls, {0.5, 0.0}, 30)), 0);
}

// In a lock, where everything is within 8 m.
TEST(Odometer, WallsAllAroundAreNotOneThing) {
  std::vector<Wall> walls;
  AddBox({0.0, 0.0}, 16.0, 8.0, Eigen::Vector2d::Zero(), walls);
  EXPECT_GE(NumKnown(MotionsOf(walls, {0.2, 0.0}, 20)), 12);
}

// A straight quay says nothing of the motion along it: it is unknown from the start, and told by the covariance where it was known before.
TEST(Odometer, AStraightQuayLeavesTheWayAlongItOpen) {
  const std::vector<Wall> quay{{{-300.0, 10.0}, {300.0, 10.0}}};
  const auto motions = MotionsOf(quay, {2.0, 0.0}, 20);
  EXPECT_EQ(NumKnown(motions), 0);
  EXPECT_EQ(motions.back().reason, Reason::kUndetermined);
  EXPECT_GT(motions.back().covariance(0, 0), 100.0 * motions.back().covariance(1, 1));
}

// Straight on, and slower from a time on.
struct Braking {
  double speed_mps = 3.0;
  double from_s = 3.0;
  double deceleration_mps2 = 1.0;

  double BearingRad(double /*time_s*/) const { return 0.0; }
  Eigen::Vector2d PlaceM(double time_s) const {
    const double braked_s = std::clamp(time_s - from_s, 0.0, speed_mps / deceleration_mps2);
    return {speed_mps * std::min(time_s, from_s + braked_s) - 0.5 * deceleration_mps2 * braked_s * braked_s, 0.0};
  }
};

// The boxes leave the sight of 30 m, and nothing but the quay remains. Normals that noise turns by degrees, and an acceleration that was taken as new
// with each scan, had the way along it known for ever: 20 m off with 0.5 m stated.
TEST(Odometer, AlongAQuayAloneTheWayIsSoonUnknown) {
  std::vector<Wall> walls{{{-300.0, 8.0}, {300.0, 8.0}}};
  AddBox({-27.0, -8.0}, 6.0, 3.0, Eigen::Vector2d::Zero(), walls);
  AddBox({-24.0, -12.0}, 8.0, 3.0, Eigen::Vector2d::Zero(), walls);
  AddBox({-20.0, -15.0}, 6.0, 3.0, Eigen::Vector2d::Zero(), walls);
  AddBox({-19.0, 7.0}, 2.0, 2.0, Eigen::Vector2d::Zero(), walls);
  auto params = MadeParams();
  params.standing.max_range_m = 30.0;
  for (const double noise_m : {0.0, 0.02}) {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    const Braking way;
    Odometer odometer(params);
    int num_known = 0;
    double error_m = 0.0;
    for (int i = 0; i < 140; ++i) {
      auto scan = MakeScan(i, walls, way);
      for (auto& range : scan.range) {
        if (range > 0) range = static_cast<std::uint16_t>(range + std::lround(noise_m / scan.range_unit_m * normal(random)));
      }
      const auto motion = odometer.Consume(scan);
      if (i >= 70) {
        // As much of the quay as is in sight might be a ship.
        EXPECT_EQ(motion.reason, Reason::kOneThing) << i << " noise " << noise_m;
      }
      if (!motion.is_known()) continue;
      ++num_known;
      const double off_m = motion.displacement_m.x() - (way.PlaceM((i + 1) * kScanS) - way.PlaceM(i * kScanS)).x();
      EXPECT_LT(std::abs(off_m), 3.0 * std::sqrt(motion.covariance(0, 0))) << i << " noise " << noise_m;
      error_m += off_m;
    }
    EXPECT_GE(num_known, 15);
    EXPECT_LT(std::abs(error_m), 0.2);
  }
}

// The boat begins to turn: 20 deg/s after a second.
struct TurningIn {
  double from_s = 2.0;

  double BearingRad(double time_s) const {
    const double turned_s = std::max(0.0, time_s - from_s);
    return -0.35 * (turned_s < 1.0 ? 0.5 * turned_s * turned_s : turned_s - 0.5);
  }
  Eigen::Vector2d PlaceM(double /*time_s*/) const { return Eigen::Vector2d::Zero(); }
};

// After scans in which nothing was seen a motion begins where the boat was only thought to be: 2 deg off with 0.03 deg stated.
TEST(Odometer, AMotionAfterLostScansHoldsTheErrorOfItsBegin) {
  for (const int num_lost : {1, 2, 3, 4}) {
    const TurningIn way;
    Odometer odometer(MadeParams());
    int num_known = 0;
    for (int i = 0; i < 30; ++i) {
      const bool is_lost = i >= 22 && i < 22 + num_lost;
      const auto motion = odometer.Consume(MakeScan(i, is_lost ? std::vector<Wall>{} : Basin(), way));
      if (i < 22 || !motion.is_known()) continue;
      ASSERT_FALSE(is_lost);
      ++num_known;
      const double off_rad = motion.turn_rad - (way.BearingRad(i * kScanS) - way.BearingRad((i + 1) * kScanS));
      // A turn that grows bends each scan a little, which is no matter of its begin.
      EXPECT_LT(std::abs(off_rad), 3.0 * std::sqrt(motion.covariance(2, 2)) + DegToRad(0.1)) << i << " lost " << num_lost;
    }
    EXPECT_GE(num_known, 30 - 22 - num_lost - 2) << num_lost;
  }
}

TEST(Odometer, LostLockIsToldAtOnce) {
  Odometer odometer(MadeParams());
  const Arc arc{1.0, 0.0};
  for (int i = 0; i < 20; ++i) odometer.Consume(MakeScan(i, Basin(), arc));
  for (int i = 20; i < 25; ++i) EXPECT_FALSE(odometer.Consume(MakeScan(i, {}, arc)).is_known()) << i;
  // And it is found again.
  Motion motion;
  for (int i = 25; i < 40; ++i) motion = odometer.Consume(MakeScan(i, Basin(), arc));
  EXPECT_TRUE(motion.is_known());
  EXPECT_NEAR(motion.displacement_m.x(), 0.1, 0.02);
}

TEST(Odometer, AGapIsUnknown) {
  Odometer odometer(MadeParams());
  for (int i = 0; i < 10; ++i) odometer.Consume(MakeScan(i, Basin(), {1.0, 0.0}));
  const auto motion = odometer.Consume(MakeScan(30, Basin(), {1.0, 0.0}));
  EXPECT_EQ(motion.reason, Reason::kGap);
  EXPECT_EQ(motion.begin, motion.end);
}

// A sensor that starts again tears scans off; under the address sanitizer this also shows that no neighbour beyond them is read.
TEST(Odometer, ATornScanOfFewColumnsIsUnknown) {
  for (const std::size_t num_columns : {1U, 2U, 6U, 7U}) {
    Odometer odometer(MadeParams());
    for (int i = 0; i < 10; ++i) odometer.Consume(MakeScan(i, Basin(), {1.0, 0.0}));
    auto scan = MakeScan(10, Basin(), {1.0, 0.0});
    scan.azimuth_rad.resize(num_columns);
    scan.time_ns.resize(num_columns);
    scan.range.resize(num_columns * scan.rings.size());
    EXPECT_FALSE(odometer.Consume(scan).is_known()) << num_columns;
    EXPECT_EQ(StandingPoints(scan, 0.5, MadeParams().standing).empty(), num_columns < 7) << num_columns;
  }
}

// Returns that stand alone are drops.
TEST(Odometer, RainOnOpenWaterIsUnknown) {
  std::mt19937 random(7);
  Odometer odometer(MadeParams());
  for (int i = 0; i < 20; ++i) {
    auto scan = MakeScan(i, {}, {1.0, 0.0});
    for (int drop = 0; drop < 600; ++drop) scan.range[random() % scan.range.size()] = static_cast<std::uint16_t>(1000 + random() % 8000);
    EXPECT_FALSE(odometer.Consume(scan).is_known()) << i;
  }
}

TEST(Odometer, TheSameScansGiveTheSameNumbers) {
  const auto one = MotionsOf(Basin(), {1.5, DegToRad(6.0)}, 15);
  const auto other = MotionsOf(Basin(), {1.5, DegToRad(6.0)}, 15);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].displacement_m, other[i].displacement_m);
    EXPECT_EQ(one[i].turn_rad, other[i].turn_rad);
    EXPECT_EQ(one[i].covariance, other[i].covariance);
  }
}

TEST(Odometer, TheOwnBoatAndLowReturnsAreLeftOut) {
  auto params = MadeParams().standing;
  std::vector<Wall> walls;
  AddBox({0.0, 0.0}, 4.0, 4.0, Eigen::Vector2d::Zero(), walls);  // gear around the lidar
  walls.push_back({{10.0, -5.0}, {10.0, 5.0}, 0.3});             // a crest
  const auto scan = MakeScan(0, walls, {});
  EXPECT_FALSE(StandingPoints(scan, 0.5, params).empty());
  params.own_vessel_box_m = Eigen::AlignedBox3d(Eigen::Vector3d(-3.0, -3.0, -1.0), Eigen::Vector3d(3.0, 3.0, 4.0));
  EXPECT_TRUE(StandingPoints(scan, 0.5, params).empty());
}

TEST(Odometer, AWallHasItsNormalAndAPostHasBothDirections) {
  std::vector<Wall> walls{{{10.0, -20.0}, {10.0, 20.0}}};
  AddBox({-8.0, 0.0}, 0.3, 0.3, Eigen::Vector2d::Zero(), walls);
  int num_walls = 0;
  int num_posts = 0;
  for (const auto& point : StandingPoints(MakeScan(0, walls, {}), 0.5, MadeParams().standing)) {
    if (point.p_vessel_m.x() < 0.0) {
      EXPECT_EQ(point.shape, Shape::kPost);
      ++num_posts;
    } else if (std::abs(point.p_vessel_m.y()) < 15.0) {
      ASSERT_EQ(point.shape, Shape::kSurface);
      EXPECT_GT(std::abs(point.normal.x()), 0.99);
      ++num_walls;
    }
  }
  EXPECT_GT(num_walls, 20);
  EXPECT_GT(num_posts, 2);
}

// It lay where the sweep met it first, half of its width to one side.
TEST(Odometer, ARoundPostLiesAtItsCentreFromWhereverItIsSeen) {
  constexpr double kRadiusM = 0.2;
  constexpr int kCorners = 16;
  for (const Eigen::Vector2d& centre_m : {Eigen::Vector2d(-8.0, 0.0), {0.0, 8.0}, {0.0, -8.0}, {4.0, -3.0}, {-15.0, 16.0}}) {
    const auto corner_m = [&](int i) {
      const double angle_rad = 2.0 * std::numbers::pi * i / kCorners;
      return Eigen::Vector2d(centre_m + kRadiusM * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad)));
    };
    std::vector<Wall> walls;
    for (int i = 0; i < kCorners; ++i) walls.push_back({corner_m(i), corner_m(i + 1)});
    const auto points = StandingPoints(MakeScan(0, walls, {}), 0.5, MadeParams().standing);
    EXPECT_GT(points.size(), 2U);
    for (const auto& point : points) {
      EXPECT_EQ(point.shape, Shape::kPost);
      // Half a column: 0.4 deg here.
      EXPECT_LT((point.p_vessel_m.head<2>() - centre_m).norm(), 0.03 + 0.0035 * centre_m.norm()) << point.p_vessel_m.transpose();
    }
  }
}

// As when two returns of a bush are neighbours and one lies deeper in it.
TEST(Odometer, APostIsAsWideAsItsColumnsNotAsDeep) {
  auto scan = MakeScan(0, {}, {});
  const auto at = [&scan](std::size_t column, std::size_t ring, double range_m) {
    scan.range[column * scan.rings.size() + ring] = static_cast<std::uint16_t>(range_m / scan.range_unit_m);
  };
  for (const std::size_t ring : {8U, 9U}) {
    at(450, ring, 50.0);
    at(451, ring, 51.1);
  }
  const auto points = StandingPoints(scan, 0.5, MadeParams().standing);
  ASSERT_FALSE(points.empty());
  for (const auto& point : points) {
    EXPECT_EQ(point.shape, Shape::kPost);
    EXPECT_NEAR(point.p_vessel_m.head<2>().norm(), 50.55 + 0.78 * 0.35, 0.1);
  }
}

// A lidar that sees a post at both ends of its scan has come nearer in between: each end is a time of its own.
TEST(Odometer, TheEndsOfAScanAreNotAveraged) {
  std::vector<Wall> walls;
  AddBox({20.0, 0.0}, 0.4, 0.4, Eigen::Vector2d::Zero(), walls);
  constexpr double kSpeedMps = 5.0;
  int num_first = 0;
  int num_last = 0;
  for (const auto& point : StandingPoints(MakeScan(0, walls, {kSpeedMps, 0.0}), 0.1, MadeParams().standing)) {
    if (point.shape != Shape::kPost) continue;
    const bool is_first = point.before_end_s > 0.05;
    EXPECT_NEAR(point.p_vessel_m.x(), is_first ? 20.0 : 20.0 - kScanS * kSpeedMps, 0.1);
    ++(is_first ? num_first : num_last);
  }
  EXPECT_GT(num_first, 0);
  EXPECT_GT(num_last, 0);
}

TEST(LocalMap, TheNearestPointMayLieInAnotherCube) {
  LocalMap map;
  const auto post = [](double x_m, double z_m) { return MapPoint{{x_m, 0.0, z_m}, Eigen::Vector3d::Zero(), Shape::kPost}; };
  map.Add(post(0.1, 0.9));    // below, 0.60 m away
  map.Add(post(-0.4, 1.55));  // to the side, 0.50 m away
  const auto nearest_x_m = [&](double radius_m) {
    const auto match = map.Nearest(post(0.1, 1.5), radius_m);
    return match ? match->p_map_m.x() : std::numeric_limits<double>::quiet_NaN();
  };
  EXPECT_NEAR(nearest_x_m(1.0), -0.4, 1e-6);
  EXPECT_TRUE(std::isnan(nearest_x_m(0.45)));
  map.Add(post(0.1, 1.1));
  EXPECT_NEAR(nearest_x_m(1.0), 0.1, 1e-6);
}

// A search that looks into few cubes finds what a search through all points finds.
TEST(LocalMap, TheNearestPointIsThatOfASearchThroughAll) {
  std::mt19937 random(1);
  const auto draw = [&random](double half_m) { return half_m * (2.0 * (static_cast<double>(random()) / 4294967295.0) - 1.0); };
  LocalMap map;
  std::vector<Eigen::Vector3d> kept_m;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d p_m(draw(4.0), draw(4.0), draw(4.0));
    // Those that the map would leave out as too near to another.
    if (std::ranges::any_of(kept_m, [&](const Eigen::Vector3d& other_m) { return (other_m - p_m).norm() < 0.3; })) continue;
    kept_m.push_back(p_m);
    map.Add({p_m, Eigen::Vector3d::Zero(), Shape::kPost});
  }
  for (const double radius_m : {0.5, 2.0, 6.0}) {
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector3d p_m(draw(6.0), draw(6.0), draw(6.0));
      const auto nearest_m = std::ranges::min_element(kept_m, {}, [&](const Eigen::Vector3d& other_m) { return (other_m - p_m).norm(); });
      const auto match = map.Nearest({p_m, Eigen::Vector3d::Zero(), Shape::kPost}, radius_m);
      ASSERT_EQ(match.has_value(), (*nearest_m - p_m).norm() < radius_m);
      if (match) {
        EXPECT_LT((match->p_map_m - *nearest_m).norm(), 1e-5);
      }
    }
  }
}

TEST(LocalMap, NoNumberHasNoNearestPoint) {
  LocalMap map;
  map.Add({{0.0, 0.0, 0.0}, Eigen::Vector3d::Zero(), Shape::kPost});
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(map.Nearest({{0.0, 0.0, 0.0}, Eigen::Vector3d::Zero(), Shape::kPost}, none));
}

// The columns from `first` on alone, as of a sensor with a limited field of view.
Scan WindowOf(Scan scan, std::ptrdiff_t first, std::ptrdiff_t num_columns) {
  const auto cut = [first, num_columns](auto& values, std::ptrdiff_t per_column) {
    values.erase(values.begin() + (first + num_columns) * per_column, values.end());
    values.erase(values.begin(), values.begin() + first * per_column);
  };
  cut(scan.azimuth_rad, 1);
  cut(scan.time_ns, 1);
  cut(scan.range, std::ssize(scan.rings));
  return scan;
}

// The width of a column was taken as if the columns that there are went all around.
TEST(Odometer, APostIsAPostInANarrowFieldOfView) {
  std::vector<Wall> walls;
  AddBox({-8.0, 0.0}, 0.4, 0.4, Eigen::Vector2d::Zero(), walls);
  AddBox({-9.0, 5.0}, 1.0, 1.0, Eigen::Vector2d::Zero(), walls);
  const auto scan = MakeScan(0, walls, {});
  for (const std::ptrdiff_t num_columns : {200, 400, 900}) {
    int num_posts = 0;
    for (const auto& point : StandingPoints(WindowOf(scan, 450 - num_columns / 2, num_columns), 0.1, MadeParams().standing)) {
      EXPECT_EQ(point.shape == Shape::kPost, point.p_vessel_m.y() < 2.0) << num_columns << " columns, at " << point.p_vessel_m.transpose();
      if (point.shape == Shape::kPost) ++num_posts;
    }
    EXPECT_GT(num_posts, 10) << num_columns;
  }
}

// The rest of a wall may lie where the sensor does not look.
TEST(Odometer, TheEdgeOfTheFieldOfViewIsNoFreeSight) {
  const auto scan = MakeScan(0, {{{-8.0, -10.0}, {-8.0, 10.0}}}, {});
  const auto points = StandingPoints(WindowOf(scan, 573, 200), 0.1, MadeParams().standing);
  EXPECT_FALSE(points.empty());
  for (const auto& point : points) EXPECT_NE(point.shape, Shape::kPost) << point.p_vessel_m.transpose();
}

// A drop at each edge, as far away: they stand alone.
TEST(Odometer, TheEdgesOfTheFieldOfViewAreNoNeighbours) {
  auto scan = WindowOf(MakeScan(0, {}, {}), 300, 200);
  scan.range[10] = scan.range[199 * scan.rings.size() + 10] = 5000;
  EXPECT_TRUE(StandingPoints(scan, 0.5, MadeParams().standing).empty());
  // All around they are.
  auto whole = MakeScan(0, {}, {});
  whole.range[10] = whole.range[(kNumColumns - 1) * whole.rings.size() + 10] = 5000;
  whole.range[16 + 10] = 5000;
  EXPECT_FALSE(StandingPoints(whole, 0.5, MadeParams().standing).empty());
}

}  // namespace
}  // namespace lookout::odometer
