// A lidar that was bumped: from what the boat saw to the words of the doctor.
#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "common/core/frames.hpp"
#include "tests/unit/calibrate/made_basin.hpp"
#include "tests/unit/doctor/healthy.hpp"
#include "tools/doctor/mounting_watch.hpp"

namespace lookout::doctor::test {
namespace {

MountingSeen Turned(double forward_deg, double port_deg, double up_deg, double sd_deg = 0.05, double reference_sd_deg = 0.1) {
  MountingSeen mounting;
  mounting.watched_s = 60.0;
  const std::array turned_deg{forward_deg, port_deg, up_deg};
  for (std::size_t i = 0; i < turned_deg.size(); ++i) {
    mounting.axes.at(i) = {DegToRad(turned_deg.at(i)), DegToRad(sd_deg), DegToRad(reference_sd_deg)};
  }
  return mounting;
}

Said Say(const MountingSeen& mounting) {
  Observations seen;
  seen.mounting = mounting;
  return About(CheckMountingSeen(seen), "mounting");
}

TEST(DoctorBump, IsNoMatterWhereNobodyAsked) { EXPECT_TRUE(CheckMountingSeen(Healthy()).empty()); }

TEST(DoctorBump, IsToldAboutEachAxisAndBothWays) {
  EXPECT_SAYS(
      Say(Turned(2.0, 0.1, -0.2)), kWarning,
      "by what stood around the boat for 60 s the lidar leans 2.0 deg (deviation 0.05) farther to starboard than boat.txtpb says: was it bumped?");
  EXPECT_SAYS(Say(Turned(-2.0, 0.1, -0.2)), kWarning, "the lidar leans 2.0 deg (deviation 0.05) farther to port than");
  EXPECT_SAYS(Say(Turned(0.0, 2.0, 0.0)), kWarning, "the lidar leans 2.0 deg (deviation 0.05) farther forward than");
  EXPECT_SAYS(Say(Turned(0.0, -2.0, 0.0)), kWarning, "the lidar leans 2.0 deg (deviation 0.05) farther aft than");
  EXPECT_SAYS(Say(Turned(0.0, 0.0, 2.0)), kWarning, "the lidar is turned 2.0 deg (deviation 0.05) farther to port than");
  EXPECT_SAYS(Say(Turned(0.0, 0.0, -2.0)), kWarning, "the lidar is turned 2.0 deg (deviation 0.05) farther to starboard than");
  EXPECT_SAYS(Say(Turned(2.0, 0.0, -3.0)), kWarning,
              "leans 2.0 deg (deviation 0.05) farther to starboard, is turned 3.0 deg (deviation 0.05) farther to starboard than");
}

TEST(DoctorBump, NamesTheSensorThatWouldLookTheSame) {
  EXPECT_SAYS(Say(Turned(2.0, 0.0, 0.0)), kWarning,
              "stop and look at its mount, and at the attitude sensor, whose error looks the same; then lookout-calibrate");
  EXPECT_SAYS(Say(Turned(0.0, 0.0, 2.0)), kWarning, "and at the heading sensor, whose error looks the same");
  EXPECT_SAYS(Say(Turned(0.0, 2.0, 2.0)), kWarning, "and at the heading or attitude sensor, whose error looks the same");
}

TEST(DoctorBump, IsNotToldBelowADegreeNorFourDeviations) {
  EXPECT_SAYS(Say(Turned(0.9, -0.9, 0.9)), kOk,
              "points as boat.txtpb says: it leans 0.9 deg (deviation 0.05) farther to starboard, leans 0.9 deg (deviation 0.05) farther aft, is "
              "turned 0.9 deg "
              "(deviation 0.05) farther to port; a bump is told from 1.0, 1.0, 1.0 deg on");
  EXPECT_EQ(Say(Turned(0.0, 0.0, 2.0, 0.6)).grade, kOk);
  EXPECT_EQ(Say(Turned(0.0, 0.0, 2.5, 0.6)).grade, kWarning);
}

// A compass that is off by what it says of itself was called a bump.
TEST(DoctorBump, IsNotToldWhereTheHeadingIsAsPoor) {
  EXPECT_SAYS(Say(Turned(0.0, 0.0, 3.0, 0.1, 2.0)), kOk,
              "is turned 3.0 deg (deviation 0.10) farther to port; a bump is told from 8.0, 8.0, 8.0 deg on");
  EXPECT_EQ(Say(Turned(0.0, 0.0, 9.0, 0.1, 2.0)).grade, kWarning);
}

TEST(DoctorBump, SaysWhyNothingIsKnown) {
  MountingSeen mounting;
  mounting.not_known = "the boat turned too little";
  mounting.missing = {"turn twice", "go 50 m"};
  EXPECT_SAYS(Say(mounting), kWarning, "whether the lidar was bumped is not known: the boat turned too little; missing: turn twice, go 50 m");
}

TEST(DoctorBump, SaysWhichAngleIsNotKnown) {
  auto mounting = Turned(0.1, 0.2, 5.0);
  mounting.missing = {"go 50 m"};
  mounting.axes[2].sd_rad = DegToRad(3.0);
  EXPECT_SAYS(Say(mounting), kOk, "farther forward; a bump is told from 1.0, 1.0 deg on; not known: its turn; missing: go 50 m");
  for (auto& axis : mounting.axes) axis.sd_rad = DegToRad(3.0);
  EXPECT_SAYS(Say(mounting), kWarning, "whether the lidar was bumped is not known: the deviations are too large; missing: go 50 m");
  mounting.axes[0] = {DegToRad(-2.0), DegToRad(0.05), DegToRad(0.1)};
  EXPECT_SAYS(Say(mounting), kWarning, "the lidar leans 2.0 deg (deviation 0.05) farther to port than");
}

TEST(DoctorBump, NamesALidarThatIsTurnedByARightAngle) {
  auto mounting = Turned(0.0, 0.0, 90.0);
  mounting.turned_in_words = "turned by 90 deg to port";
  EXPECT_SAYS(Say(mounting), kWarning, "the lidar is not mounted as boat.txtpb says: turned by 90 deg to port");
}

// The made boat's lidar is level and looks ahead. After a bump by `D` about the axes of the vessel boat.txtpb says what was true before it: D^-1.
Said AfterBump(const Eigen::Matrix3d& D) { return Say(CompareMounting(calibrate::Basin(), calibrate::ParamsWith(D.transpose()))); }

TEST(DoctorBump, IsFoundInScansAndPosesAboutEachAxisAndBothWays) {
  EXPECT_SAYS(AfterBump(Eigen::Matrix3d::Identity()), kOk, "points as boat.txtpb says");
  const Eigen::Vector3d bump_rad = DegToRad(2.0) * Eigen::Vector3d::Ones();
  const auto one_way = AfterBump(calibrate::RotationBy(bump_rad));
  EXPECT_SAYS(one_way, kWarning, "the lidar leans 2.0 deg");
  EXPECT_SAYS(one_way, kWarning, "farther to starboard, leans 2.0 deg");
  EXPECT_SAYS(one_way, kWarning, "farther forward, is turned 2.0 deg");
  EXPECT_SAYS(one_way, kWarning, "farther to port than boat.txtpb says: was it bumped?");
  const auto other_way = AfterBump(calibrate::RotationBy(-bump_rad));
  EXPECT_SAYS(other_way, kWarning, "farther to port, leans 2.0 deg");
  EXPECT_SAYS(other_way, kWarning, "farther aft, is turned 2.0 deg");
  EXPECT_SAYS(other_way, kWarning, "farther to starboard than boat.txtpb says: was it bumped?");
}

TEST(DoctorBump, IsNotLookedForWithoutStandingThingsOrPoses) {
  calibrate::Recording empty;
  EXPECT_SAYS(Say(CompareMounting(empty, calibrate::ParamsWith(Eigen::Matrix3d::Identity()))), kWarning,
              "whether the lidar was bumped is not known: ");
}

// Each angle counts where the recording is too short for a calibration of all three.
TEST(DoctorBump, IsToldByTheAngleThatIsKnownWhereAnotherIsNot) {
  calibrate::Calibration calibration;
  calibration.has_fit = true;
  calibration.refusal = "the recording shows too little of the mounting";
  calibration.turned_rad = {DegToRad(2.0), 0.0, DegToRad(2.0)};
  calibration.turned_sd_rad = {DegToRad(0.1), DegToRad(0.1), DegToRad(0.8)};
  EXPECT_SAYS(Say(MountingOf(calibration, {})), kWarning, "is not known: the recording shows too little");
  calibration.is_only_weak = true;
  const auto said = Say(MountingOf(calibration, {}));
  EXPECT_SAYS(said, kWarning, "leans 2.0 deg (deviation 0.10) farther to starboard than");
  EXPECT_EQ(said.text.find("is turned"), std::string::npos) << said.text;
}

}  // namespace
}  // namespace lookout::doctor::test
