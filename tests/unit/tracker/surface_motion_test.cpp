#include "services/tracker/core/surface_motion.hpp"

#include <Eigen/LU>
#include <chrono>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "services/tracker/core/body.hpp"

namespace lookout::tracker {
namespace {

constexpr double kSurfaceLookS = 0.1;
const Eigen::Vector2d kStandingMps(0.0, 0.0);

Utime SurfaceTime(double time_s) { return Utime(std::chrono::microseconds(std::llround(1e6 * (1000.0 + time_s)))); }

struct HullReturns {
  std::vector<Eigen::Vector2d> places_m;
  std::vector<double> heights_m;

  void Add(const Eigen::Vector2d& place_m, double height_m) {
    places_m.push_back(place_m);
    heights_m.push_back(height_m);
  }
};

// A hull of 12 x 4 m whose bow points north, seen from the west and south: its port side, its stern and a cabin, by beams 0.2 m apart.
HullReturns HullAt(const Eigen::Vector2d& middle_m, double seen_from_m, double seen_to_m, std::mt19937_64& random) {
  std::normal_distribution<double> noise(0.0, 0.03);
  std::uniform_real_distribution<double> phase(0.0, 0.2);
  HullReturns hull;
  const auto add = [&](double east_m, double north_m, double height_m) {
    hull.Add(middle_m + Eigen::Vector2d(east_m + noise(random), north_m + noise(random)), height_m);
  };
  for (const double height_m : {0.3, 0.9}) {
    for (double at_m = -6.0 + phase(random); at_m < 6.0; at_m += 0.2) {
      if (at_m >= seen_from_m && at_m < seen_to_m) add(at_m < 3.0 ? -2.0 : -2.0 + 0.6 * (at_m - 3.0), at_m, height_m);
    }
  }
  for (double at_m = -2.0 + phase(random); at_m < 2.0; at_m += 0.2) add(at_m, -6.0, 0.6);
  for (double at_m = -1.0 + phase(random); at_m < 1.0; at_m += 0.2) add(at_m, -1.0, 1.8);
  return hull;
}

struct FoundShift {
  std::optional<SurfaceShift> shift;
  Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();
};

template <typename At>
std::vector<FoundShift> WatchSurface(SurfaceMotion& motion, int num_looks, const At& at) {
  std::vector<FoundShift> seen;
  for (int look = 0; look < num_looks; ++look) {
    const HullReturns returns = at(look * kSurfaceLookS);
    const auto shift = motion.Update(SurfaceTime(look * kSurfaceLookS), returns.places_m, returns.heights_m, kStandingMps);
    seen.push_back({shift, shift ? Eigen::Vector2d(shift->shift_m / shift->over_s) : Eigen::Vector2d(0.0, 0.0)});
  }
  return seen;
}

TEST(SurfaceMotion, OfALargeHullIsKnownWithinASecond) {
  std::mt19937_64 random(1);
  const Eigen::Vector2d velocity_mps(0.4, -1.5);
  SurfaceMotion motion;
  const auto seen = WatchSurface(motion, 30, [&](double time_s) { return HullAt(time_s * velocity_mps, -6.0, 6.0, random); });
  for (int look = 0; look < 30; ++look) {
    const auto& [shift, found_mps] = seen[look];
    ASSERT_EQ(shift.has_value(), look >= 4) << look;  // 0.35 s
    if (!shift) continue;
    const Eigen::Vector2d off_mps = found_mps - velocity_mps;
    const double nees = 0.5 * off_mps.dot((shift->covariance_m2 / (shift->over_s * shift->over_s)).inverse() * off_mps);
    EXPECT_LT(nees, 4.0) << look;
    EXPECT_LT(off_mps.norm(), look < 10 ? 0.4 : 0.15) << look;
  }
  EXPECT_NEAR(seen[20].shift->over_s, 1.0, 1e-9);
  EXPECT_NEAR(seen[4].shift->new_s, seen[4].shift->over_s, 1e-9) << "nothing of it was known before";
  EXPECT_NEAR(seen[20].shift->new_s, kSurfaceLookS, 1e-9) << "all but the last tenth was";
}

// An outline would move by 3 m a second.
TEST(SurfaceMotion, ThatComesIntoSightIsNone) {
  std::mt19937_64 random(2);
  SurfaceMotion motion;
  const auto seen = WatchSurface(motion, 30, [&](double time_s) { return HullAt({20.0, 5.0}, 3.0 - 3.0 * time_s, 6.0, random); });
  for (int look = 10; look < 30; ++look) {
    ASSERT_TRUE(seen[look].shift) << look;
    EXPECT_LT(seen[look].velocity_mps.norm(), 0.15) << look;
  }
}

TEST(SurfaceMotion, AlongAPlainWallIsUnknown) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, 0.03);
  std::uniform_real_distribution<double> phase(0.0, 0.2);
  SurfaceMotion motion;
  const auto seen = WatchSurface(motion, 20, [&](double time_s) {
    HullReturns wall;
    const double from_m = 2.0 * time_s;  // the part that is seen runs along the wall
    for (double at_m = from_m + phase(random); at_m < from_m + 10.0; at_m += 0.2) wall.Add({at_m, noise(random)}, 0.5);
    return wall;
  });
  ASSERT_TRUE(seen.back().shift);
  const auto& covariance_m2 = seen.back().shift->covariance_m2;
  EXPECT_GT(std::sqrt(covariance_m2(0, 0)), 0.5);
  EXPECT_LT(std::sqrt(covariance_m2(1, 1)), 0.15);
  EXPECT_LT(std::abs(seen.back().velocity_mps.y()), 0.15);
  EXPECT_LT(std::abs(seen.back().velocity_mps.x()), 2.0 * std::sqrt(covariance_m2(0, 0)));
}

TEST(SurfaceMotion, OfAFastBoatIsFoundByWayOfTheLastLook) {
  std::mt19937_64 random(4);
  const Eigen::Vector2d velocity_mps(-3.0, 7.0);
  SurfaceMotion motion;
  const auto seen = WatchSurface(motion, 20, [&](double time_s) { return HullAt(time_s * velocity_mps, -6.0, 6.0, random); });
  for (int look = 10; look < 20; ++look) {
    ASSERT_TRUE(seen[look].shift) << look;
    EXPECT_LT((seen[look].velocity_mps - velocity_mps).norm(), 0.2) << look;
  }
}

TEST(SurfaceMotion, IsUnknownWithoutCounterparts) {
  std::mt19937_64 random(5);
  SurfaceMotion motion;
  // Another thing, 30 m off, is in its place from the tenth look on.
  const auto seen = WatchSurface(motion, 14, [&](double time_s) { return HullAt({time_s < 0.95 ? 0.0 : 30.0, 0.0}, -6.0, 6.0, random); });
  EXPECT_TRUE(seen[9].shift);
  for (int look = 10; look < 14; ++look) EXPECT_FALSE(seen[look].shift) << look;
}

TEST(SurfaceMotion, NeedsReturnsWithHeightsInTheirOrder) {
  std::mt19937_64 random(6);
  const auto hull = HullAt({0.0, 0.0}, -6.0, 6.0, random);
  SurfaceMotion motion;
  const std::vector<Eigen::Vector2d> few_m(hull.places_m.begin(), hull.places_m.begin() + SurfaceMotion::kLeastReturns - 1);
  const std::vector<double> few_heights_m(few_m.size(), 0.5);
  for (int look = 0; look < 10; ++look) {
    EXPECT_FALSE(motion.Update(SurfaceTime(look * kSurfaceLookS), few_m, few_heights_m, kStandingMps));
    EXPECT_FALSE(motion.Update(SurfaceTime(look * kSurfaceLookS), hull.places_m, {}, kStandingMps));
    EXPECT_FALSE(motion.Update(SurfaceTime(look * kSurfaceLookS), {}, {}, kStandingMps));
  }
  for (int look = 10; look < 20; ++look) motion.Update(SurfaceTime(look * kSurfaceLookS), hull.places_m, hull.heights_m, kStandingMps);
  // A time that comes again begins anew, and so does one after a gap.
  EXPECT_FALSE(motion.Update(SurfaceTime(1.9), hull.places_m, hull.heights_m, kStandingMps));
  EXPECT_FALSE(motion.Update(SurfaceTime(1.5), hull.places_m, hull.heights_m, kStandingMps));
  EXPECT_FALSE(motion.Update(SurfaceTime(9.0), hull.places_m, hull.heights_m, kStandingMps));
  EXPECT_FALSE(motion.Update(SurfaceTime(9.1), hull.places_m, hull.heights_m, kStandingMps));
  const auto again = motion.Update(SurfaceTime(9.5), hull.places_m, hull.heights_m, kStandingMps);
  ASSERT_TRUE(again);
  EXPECT_NEAR(again->new_s, 0.5, 1e-9);
  EXPECT_LT(again->shift_m.norm(), 1e-6);
}

TEST(SurfaceMotion, ABetterOwnPositionIsNone) {
  std::mt19937_64 random(7);
  const Eigen::Vector2d by_m(1.5, -0.8);
  SurfaceMotion motion;
  WatchSurface(motion, 10, [&](double) { return HullAt({0.0, 0.0}, -6.0, 6.0, random); });
  motion.Translate(by_m);
  const auto hull = HullAt(by_m, -6.0, 6.0, random);
  const auto shift = motion.Update(SurfaceTime(1.0), hull.places_m, hull.heights_m, kStandingMps);
  ASSERT_TRUE(shift);
  EXPECT_LT(shift->shift_m.norm(), 0.1);
}

TEST(SurfaceMotion, OfAPointIsThatPoint) {
  // All returns at one place: no direction is longer than another.
  SurfaceMotion motion;
  const std::vector<double> heights_m(20, 1.0);
  std::optional<SurfaceShift> shift;
  for (int look = 0; look < 12; ++look) {
    const std::vector<Eigen::Vector2d> places_m(20, Eigen::Vector2d(0.05 * look, 7.0));
    shift = motion.Update(SurfaceTime(look * kSurfaceLookS), places_m, heights_m, kStandingMps);
  }
  ASSERT_TRUE(shift);
  EXPECT_NEAR(shift->shift_m.x() / shift->over_s, 0.5, 0.01);
  EXPECT_TRUE(shift->covariance_m2.allFinite());
}

// Piles 1.5 m apart behind a gap that runs along them: those that are seen fit their neighbours one by one, and one better than themselves.
TEST(SurfaceMotion, OfPilesBehindARunningGapIsNone) {
  std::mt19937_64 random(9);
  std::normal_distribution<double> noise(0.0, 0.02);
  for (const double gap_mps : {0.5, 1.0, 1.5, 2.0, 3.0}) {
    SurfaceMotion motion;
    for (int look = 0; look < 60; ++look) {
      const double from_m = gap_mps * look * kSurfaceLookS;
      HullReturns piles;
      for (int pile = 0; pile < 40; ++pile) {
        if (1.5 * pile < from_m || 1.5 * pile > from_m + 12.0) continue;
        for (int k = 0; k < 6; ++k) piles.Add({1.5 * pile + 0.05 * (k % 3) + noise(random), 20.0 + noise(random)}, 0.3 + 0.4 * (k / 3));
      }
      const auto shift = motion.Update(SurfaceTime(look * kSurfaceLookS), piles.places_m, piles.heights_m, std::nullopt);
      const double moved_m = shift ? shift->shift_m.norm() : 0.0;
      EXPECT_LT(moved_m, 0.25) << gap_mps << " m/s, look " << look;
    }
  }
}

// Seen coarsely, too: thinned to 64 points.
TEST(SurfaceMotion, AlongALongWallIsUnknown) {
  std::mt19937_64 random(10);
  std::normal_distribution<double> noise(0.0, 0.03);
  for (const double length_m : {20.0, 40.0, 60.0}) {
    SurfaceMotion motion;
    std::optional<SurfaceShift> shift;
    for (int look = 0; look < 30; ++look) {
      HullReturns wall;
      const double from_m = 3.0 * look * kSurfaceLookS;
      for (const double height_m : {0.5, 1.3}) {
        for (double at_m = from_m; at_m < from_m + length_m; at_m += 0.1) wall.Add({at_m + noise(random), noise(random)}, height_m);
      }
      shift = motion.Update(SurfaceTime(look * kSurfaceLookS), wall.places_m, wall.heights_m, std::nullopt);
    }
    if (!shift) continue;
    const double sd_m = std::sqrt(shift->covariance_m2(0, 0));
    EXPECT_GT(sd_m, 0.7) << length_m;
    EXPECT_LT(std::abs(shift->shift_m.x()), 2.0 * sd_m) << length_m;
    EXPECT_LT(std::abs(shift->shift_m.y()), 0.15) << length_m;
  }
}

// A time that goes back after a gap, and what was of something else, too.
TEST(SurfaceMotion, BeginsAnew) {
  std::mt19937_64 random(11);
  const auto hull = HullAt({0.0, 0.0}, -6.0, 6.0, random);
  SurfaceMotion motion;
  const auto begin_at = [&](double time_s) {
    std::optional<SurfaceShift> shift;
    for (int look = 0; look <= 6; ++look)
      shift = motion.Update(SurfaceTime(time_s + look * kSurfaceLookS), hull.places_m, hull.heights_m, kStandingMps);
    ASSERT_TRUE(shift) << time_s;
    EXPECT_GT(shift->new_s, 0.0);
    EXPECT_LE(shift->new_s, shift->over_s);
    EXPECT_NEAR(shift->over_s, 0.6, 1e-9) << time_s;
  };
  begin_at(100.0);
  begin_at(150.0);
  begin_at(20.0);
  motion.Clear();
  begin_at(20.7);
}

// What a body makes of it.
const Eigen::Matrix2d kSternNoise = Eigen::Matrix2d::Identity() * 0.03 * 0.03;
const std::vector<Eigen::Vector2d> kStern{{18.0, 1.0}, {18.0, -1.0}, {18.1, 0.0}};

SurfaceShift ShiftBy(const Eigen::Vector2d& velocity_mps, double sd_m = 0.1) {
  return {.shift_m = velocity_mps, .covariance_m2 = sd_m * sd_m * Eigen::Matrix2d::Identity(), .over_s = 1.0, .new_s = 0.1};
}

TEST(Body, MovesAsItsSurfaceDoes) {
  const Eigen::Vector2d velocity_mps(-0.5, 1.2);
  Body body(kStern, {}, kSternNoise, 18.0);
  for (int scan = 0; scan < 15; ++scan) {
    body.Predict(kSurfaceLookS);
    body.Update(ShiftBy(velocity_mps), {}, kSternNoise, 18.0);
  }
  EXPECT_LT((body.velocity_mps() - velocity_mps).norm(), 0.05);
  // Fifteen shifts over the same second say little more than one.
  const double sd_mps = std::sqrt(body.covariance()(2, 2));
  EXPECT_GT(sd_mps, 0.08);
  EXPECT_LT(sd_mps, 0.6);
}

TEST(Body, WhoseSurfaceStaysStands) {
  std::mt19937_64 random(8);
  std::normal_distribution<double> noise(0.0, 0.1);
  Body body(kStern, {}, kSternNoise, 18.0);
  Eigen::Vector2d wander_mps(0.0, 0.0);
  for (int scan = 0; scan < 3000; ++scan) {
    wander_mps += 0.1 * (Eigen::Vector2d(noise(random), noise(random)) * 4.0 - wander_mps);  // as shifts that overlap
    body.Predict(kSurfaceLookS);
    body.Update(kStern, {}, kSternNoise, 18.0, true);
    body.Update(ShiftBy(wander_mps), {}, kSternNoise, 18.0);
    ASSERT_FALSE(body.IsMoving(0.95)) << scan;
  }
}

}  // namespace
}  // namespace lookout::tracker
