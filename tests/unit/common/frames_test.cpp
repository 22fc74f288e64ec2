#include "common/core/frames.hpp"

#include <gtest/gtest.h>

#include "common/core/angles.hpp"

namespace lookout {
namespace {

using Eigen::Vector3d;

void ExpectNear(const Vector3d& actual, const Vector3d& expected) {
  EXPECT_NEAR((actual - expected).norm(), 0.0, 1e-12) << "actual " << actual.transpose() << ", expected " << expected.transpose();
}

TEST(BeamDirection, TurnsClockwiseSeenFromAbove) {
  ExpectNear(BeamDirection(0.0, 0.0), Vector3d::UnitX());
  ExpectNear(BeamDirection(kPi / 2.0, 0.0), -Vector3d::UnitY());
  ExpectNear(BeamDirection(0.0, kPi / 2.0), Vector3d::UnitZ());
}

TEST(RotationMapVessel, PutsTheBowAlongTheHeading) {
  ExpectNear(RotationMapVessel(0.0, 0.0, 0.0) * Vector3d::UnitX(), Vector3d::UnitY());               // north
  ExpectNear(RotationMapVessel(DegToRad(90.0), 0.0, 0.0) * Vector3d::UnitX(), Vector3d::UnitX());    // east
  ExpectNear(RotationMapVessel(DegToRad(90.0), 0.0, 0.0) * Vector3d::UnitY(), Vector3d::UnitY());    // port is north
  ExpectNear(RotationMapVessel(DegToRad(180.0), 0.0, 0.0) * Vector3d::UnitX(), -Vector3d::UnitY());  // south
}

TEST(RotationMapVessel, PitchIsPositiveBowUp) {
  EXPECT_NEAR((RotationMapVessel(1.0, DegToRad(10.0), 0.0) * Vector3d::UnitX()).z(), std::sin(DegToRad(10.0)), 1e-12);
}

TEST(RotationMapVessel, RollIsPositiveStarboardDown) {
  const Vector3d starboard = -Vector3d::UnitY();
  EXPECT_NEAR((RotationMapVessel(2.0, 0.0, DegToRad(10.0)) * starboard).z(), -std::sin(DegToRad(10.0)), 1e-12);
}

TEST(RotationMapVessel, AppliesHeadingThenPitchThenRoll) {
  // Bow 90 degrees up and then rolled starboard down: with heading north, port turns from west by the roll about the vertical bow.
  const Eigen::Matrix3d R_map_vessel = RotationMapVessel(0.0, kPi / 2.0, kPi / 2.0);
  ExpectNear(R_map_vessel * Vector3d::UnitX(), Vector3d::UnitZ());
  ExpectNear(R_map_vessel * Vector3d::UnitY(), -Vector3d::UnitY());
}

TEST(TransformVesselSensor, YawTurnsCounterClockwise) {
  Mounting mounting;
  mounting.p_vessel_m = {1.0, 2.0, 3.0};
  mounting.yaw_rad = kPi / 2.0;
  ExpectNear(TransformVesselSensor(mounting) * Vector3d::UnitX(), Vector3d(1.0, 3.0, 3.0));
}

TEST(TransformVesselSensor, PitchTurnsTheXAxisDownAndRollTheYAxisUp) {
  Mounting mounting;
  mounting.pitch_rad = 0.1;
  EXPECT_NEAR((TransformVesselSensor(mounting) * Vector3d::UnitX()).z(), -std::sin(0.1), 1e-12);
  mounting = {};
  mounting.roll_rad = 0.1;
  EXPECT_NEAR((TransformVesselSensor(mounting) * Vector3d::UnitY()).z(), std::sin(0.1), 1e-12);
}

}  // namespace
}  // namespace lookout
