// Receivers that repeat an old place while the boat moves on.
#include "services/navigator/core/filter/frozen_place.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "tests/unit/navigator/filter_measurements.hpp"

namespace lookout::navigator {
namespace {

constexpr double kMetresPerLatitudeDeg = 111'100.0;

// A fix of a boat that goes north, as a receiver prints it: four decimals of a minute.
GnssFix PrintedFix(double t, double way_m, double speed_mps, const char* type = "RMC") {
  auto fix = std::isnan(speed_mps) ? Fix(t, type) : MovingFix(t, speed_mps, 0.0);
  fix.sentence_type = type;
  fix.position->latitude_deg = std::round((kLatitudeDeg + way_m / kMetresPerLatitudeDeg) * 600'000.0) / 600'000.0;
  return fix;
}

OdometryMotion MotionOf(double end_s, double speed_mps) {
  OdometryMotion motion{NoonPlus(end_s - 0.1), NoonPlus(end_s), true, {0.1 * speed_mps, 0.0}, 0.0, {}};
  motion.covariance = Eigen::Vector3d(1e-5, 1e-5, 1e-8).asDiagonal();
  return motion;
}

TEST(FrozenPlaces, AMovingReceiverIsNone) {
  for (const double speed_mps : {0.1, 0.6, 3.0, 20.0}) {
    FrozenPlaces places;
    for (int i = 0; i < 600; ++i) EXPECT_FALSE(places.Judge(PrintedFix(0.1 * i, 0.1 * i * speed_mps, speed_mps))) << speed_mps << " " << i;
  }
}

TEST(FrozenPlaces, ABoatAtRestIsNone) {
  FrozenPlaces places;
  for (int i = 0; i < 6000; ++i) {
    EXPECT_FALSE(places.Judge(PrintedFix(0.1 * i, 0.0, i % 3 == 0 ? 0.4 : 0.0))) << i;
    places.Add(MotionOf(0.1 * i, 2.0));  // a ship that leaves looks like a shore that moves
  }
}

TEST(FrozenPlaces, ItsOwnSpeedTellsAFrozenReceiver) {
  FrozenPlaces places;
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(places.Judge(PrintedFix(0.2 * i, 0.6 * i, 3.0)));
  int first = 0;
  for (int i = 100; i < 200 && first == 0; ++i) {
    if (places.Judge(PrintedFix(0.2 * i, 60.0, 3.0))) first = i;
  }
  EXPECT_GE(first, 105);
  EXPECT_LE(first, 107) << "after 3 m";
  ASSERT_TRUE(places.last());
  EXPECT_NEAR(places.last()->way_m, 3.6, 0.7);
  // It moves again.
  EXPECT_FALSE(places.Judge(PrintedFix(40.2, 120.6, 3.0)));
}

TEST(FrozenPlaces, TheLidarTellsAReceiverWithoutASpeed) {
  for (const bool moves : {false, true}) {
    FrozenPlaces places;
    bool is_frozen = false;
    for (int i = 0; i < 100; ++i) {
      places.Add(MotionOf(0.1 * i, moves ? 3.0 : 0.2));
      is_frozen = places.Judge(PrintedFix(0.1 * i, 0.3 * std::min(i, 10), kNan, "GGA"));
    }
    EXPECT_EQ(is_frozen, moves);
  }
}

// At anchor, with GGA alone from a receiver that holds its place: the ship that leaves an hour later must not take the fixes away.
TEST(FrozenPlaces, AShipThatLeavesDoesNotFreezeAPlaceThatStood) {
  FrozenPlaces places;
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(places.Judge(PrintedFix(0.1 * i, 0.3 * i, kNan, "GGA")));
  for (int i = 100; i < 600; ++i) {
    places.Add(MotionOf(0.1 * i, i < 300 ? 0.0 : 3.0));
    EXPECT_FALSE(places.Judge(PrintedFix(0.1 * i, 30.0, kNan, "GGA"))) << i;
  }
}

// Noise of the odometer adds up to no way.
TEST(FrozenPlaces, NoiseOfTheLidarIsNoWay) {
  FrozenPlaces places;
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 6000; ++i) {
    auto motion = MotionOf(0.05 * i, 0.0);
    motion.displacement_m = 0.02 * Eigen::Vector2d(normal(random), normal(random));
    places.Add(motion);
    EXPECT_FALSE(places.Judge(PrintedFix(0.05 * i, i < 3 ? 2.0 * i : 6.0, kNan, "GGA"))) << i;
  }
}

// A converter with two decimals of a minute: steps of 18.5 m.
TEST(FrozenPlaces, AReceiverOfFewDigitsIsNone) {
  for (const double speed_mps : {1.0, 6.0}) {
    FrozenPlaces places;
    for (int i = 0; i < 1000; ++i) {
      auto fix = PrintedFix(1.0 * i, speed_mps * i, speed_mps);
      fix.position->latitude_deg = std::floor(fix.position->latitude_deg * 6000.0) / 6000.0;
      EXPECT_FALSE(places.Judge(fix)) << speed_mps << " " << i;
    }
  }
}

// GGA comes before the VTG of its epoch, once a second, at a fast stop beside which the receiver holds its place.
TEST(FrozenPlaces, AFastStopIsNone) {
  FrozenPlaces places;
  double way_m = 0.0;
  for (int i = 0; i < 100; ++i) {
    const double speed_mps = std::max(0.0, i < 50 ? 2.5 : 2.5 - 2.0 * (i - 50));
    way_m += speed_mps;
    EXPECT_FALSE(places.Judge(PrintedFix(1.0 * i, way_m, kNan, "GGA"))) << i;
    places.Judge(GroundVelocity{NoonPlus(1.0 * i), speed_mps, speed_mps < 0.2 ? kNan : 0.0, "udp"});
  }
}

TEST(FrozenPlaces, AVelocityOfAFrozenReceiverIsNotUsed) {
  FrozenPlaces places;
  bool is_frozen = false;
  for (int i = 0; i < 100; ++i) {
    places.Judge(PrintedFix(0.2 * i, i < 2 ? 0.6 * i : 1.2, kNan, "GGA"));
    is_frozen = places.Judge(GroundVelocity{NoonPlus(0.2 * i), 3.0, 0.0, "udp"});
  }
  EXPECT_TRUE(is_frozen);
  EXPECT_FALSE(places.Judge(GroundVelocity{NoonPlus(20.0), 3.0, 0.0, "other"}));
}

// Without it POSE stood with the receiver, stated to be within 2 m.
TEST(FrozenPlaces, PoseDoesNotStandWithAFrozenReceiver) {
  for (const bool has_lidar : {false, true}) {
    PoseFilter filter(TestFilterParams());
    double greatest_m = 0.0;
    for (int i = 0; i <= 400; ++i) {
      const double t = 0.1 * i;
      filter.Add(HeadingSample(t, 0.1 * (i % 3 - 1)));
      if (i % 2 == 0) filter.Add(PrintedFix(t, 3.0 * std::min(t, 20.0), 3.0));
      if (has_lidar && i > 0) filter.Add(MotionOf(t, 3.0));
      const auto pose = filter.At(NoonPlus(t));
      const bool has_place = pose.status == PoseStatus::kOk || pose.status == PoseStatus::kCoasting;
      if (has_place) greatest_m = std::max(greatest_m, std::abs((pose.latitude_deg - kLatitudeDeg) * kMetresPerLatitudeDeg - 3.0 * t));
      if (i == 400) {
        EXPECT_EQ(pose.status, has_lidar ? PoseStatus::kCoasting : PoseStatus::kNoPosition);
        EXPECT_NE(filter.doubted().find("fixes of input 'udp' repeat one place for "), std::string::npos) << filter.doubted();
      }
    }
    EXPECT_LT(greatest_m, 5.0) << has_lidar;
    auto counts = filter.counts();
    EXPECT_GT(counts["frozen_fix"], 80);
  }
}

}  // namespace
}  // namespace lookout::navigator
