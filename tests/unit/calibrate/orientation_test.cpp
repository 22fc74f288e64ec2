#include "tools/calibrate/orientation.hpp"

#include <gtest/gtest.h>

#include "common/core/angles.hpp"

namespace lookout::calibrate {
namespace {

TEST(Orientation, AnglesAndRotationAreInverse) {
  for (const double roll_deg : {-179.0, -90.0, 0.0, 3.0, 170.0}) {
    for (const double pitch_deg : {-89.0, -10.0, 0.0, 60.0}) {
      for (const double yaw_deg : {-175.0, 0.0, 5.0, 90.0}) {
        const auto angles = AnglesOf(RotationOf({DegToRad(roll_deg), DegToRad(pitch_deg), DegToRad(yaw_deg)}));
        EXPECT_NEAR(RadToDeg(angles.roll_rad), roll_deg, 1e-9);
        EXPECT_NEAR(RadToDeg(angles.pitch_rad), pitch_deg, 1e-9);
        EXPECT_NEAR(RadToDeg(angles.yaw_rad), yaw_deg, 1e-9);
      }
    }
  }
}

TEST(Orientation, StraightUpTheRotationIsKept) {
  const auto R = RotationOf({DegToRad(20.0), DegToRad(90.0), DegToRad(30.0)});
  EXPECT_TRUE(RotationOf(AnglesOf(R)).isApprox(R, 1e-6));
}

TEST(Orientation, ACubeHas24Rotations) {
  const auto rotations = CubeRotations();
  ASSERT_EQ(rotations.size(), 24U);
  EXPECT_TRUE(rotations.front().isIdentity());
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    EXPECT_NEAR(rotations[i].determinant(), 1.0, 1e-12);
    EXPECT_TRUE((rotations[i] * rotations[i].transpose()).isIdentity());
    for (std::size_t k = 0; k < i; ++k) EXPECT_GT(AngleOf(rotations[i].transpose() * rotations[k]), 1.0);
  }
}

TEST(Orientation, TheNearestRightAngleIsFoundTenDegreesOff) {
  for (const auto& cube : CubeRotations()) {
    const Eigen::Matrix3d R = cube * RotationOf({DegToRad(10.0), DegToRad(-10.0), DegToRad(10.0)});
    EXPECT_TRUE(NearestCubeRotation(R).isApprox(cube));
  }
}

TEST(Orientation, WordsNameTheTurn) {
  EXPECT_EQ(TurnInWords(Eigen::Matrix3d::Identity()), "");
  EXPECT_EQ(TurnInWords(RotationAboutZ(kPi / 2)), "turned by 90 deg to port: what counts as ahead is to port");
  EXPECT_EQ(TurnInWords(RotationAboutZ(-kPi / 2)), "turned by 90 deg to starboard: what counts as ahead is to starboard");
  EXPECT_EQ(TurnInWords(RotationAboutZ(kPi)), "turned by 180 deg about up: what counts as ahead is astern");
  EXPECT_EQ(TurnInWords(RotationAboutX(kPi)), "upside down: what counts as ahead is forward, what counts as up is down");
  EXPECT_EQ(TurnInWords(RotationAboutX(kPi / 2)), "rolled by 90 deg: what counts as ahead is forward, what counts as up is to starboard");
  EXPECT_EQ(TurnInWords(RotationAboutY(kPi / 2)), "pitched by 90 deg: what counts as ahead is down, what counts as up is forward");
  EXPECT_EQ(TurnInWords(RotationAboutZ(kPi / 2) * RotationAboutX(kPi / 2)),
            "its axes are swapped: what counts as ahead is to port, what counts as up is forward");
}

}  // namespace
}  // namespace lookout::calibrate
