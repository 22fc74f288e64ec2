#include "lab/eval/navigation/kiss_icp_motions.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "common/core/frames.hpp"
#include "common/core/utime.hpp"

namespace lookout::eval {
namespace {

using namespace std::chrono_literals;
using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr Utime kStart{1'781'532'600s};

config::BoatFacts Boat() {
  config::BoatFacts boat;
  boat.lidar = {.p_vessel_m = {0.5, -0.1, 1.1}, .roll_rad = DegToRad(1.0), .pitch_rad = DegToRad(-0.5), .yaw_rad = DegToRad(35.0)};
  boat.T_vessel_lidar = TransformVesselSensor(boat.lidar);
  return boat;
}

// Things on the shores of a basin of 30 m x 24 m, as far apart as to have a voxel each.
std::vector<Vector3d> Basin() {
  std::vector<Vector3d> points_m;
  for (int i = 0; i <= 10; ++i) {
    for (int k = 0; k <= 8; ++k) {
      if (i % 10 != 0 && k % 8 != 0) continue;
      for (int z = 0; z < 3; ++z) points_m.emplace_back(3.0 * i - 14.3, 3.0 * k - 11.2, 3.0 * z + 0.4);
    }
  }
  return points_m;
}

// Each thing has a column and a ring of its own, so that the scan meets it exactly. All shots are at the end.
odometer::Scan ScanAt(Utime time, const std::vector<Vector3d>& points_map_m, const Isometry3d& T_map_lidar) {
  odometer::Scan scan;
  scan.time = scan.end_time = time;
  scan.range_unit_m = 0.001;
  scan.rings.resize(points_map_m.size());
  scan.range.assign(points_map_m.size() * points_map_m.size(), 0);
  for (std::size_t i = 0; i < points_map_m.size(); ++i) {
    const Vector3d p_m = T_map_lidar.inverse() * points_map_m[i];
    scan.azimuth_rad.push_back(WrapTo2Pi(-std::atan2(p_m.y(), p_m.x())));
    scan.time_ns.push_back(0);
    scan.rings[i].elevation_rad = std::asin(p_m.z() / p_m.norm());
    scan.range[i * points_map_m.size() + i] = static_cast<std::uint16_t>(std::lround(1000.0 * p_m.norm()));
  }
  return scan;
}

Isometry3d VesselAt(const Vector3d& p_map_m, double heading_deg, double pitch_deg, double roll_deg) {
  Isometry3d T_map_vessel = Isometry3d::Identity();
  T_map_vessel.linear() = RotationMapVessel(DegToRad(heading_deg), DegToRad(pitch_deg), DegToRad(roll_deg));
  T_map_vessel.translation() = p_map_m;
  return T_map_vessel;
}

TEST(KissIcpMotions, AreThoseOfTheReferencePointOnTheWaterThoughTheBoatRollsPitchesAndHeaves) {
  const auto boat = Boat();
  const auto basin = Basin();
  KissIcpMotions motions(boat, RotationMapVessel(0.5 * kPi, DegToRad(2.0), DegToRad(-4.0)));
  // North-east, then 0.3 m along the bow and 0.1 m to port of it, 2 deg to starboard.
  const auto first = motions.Consume(ScanAt(kStart, basin, VesselAt({0.0, 0.0, 0.4}, 45.0, 2.0, -4.0) * boat.T_vessel_lidar));
  EXPECT_EQ(first.status, lidar_odometry_t::STATUS_UNKNOWN);
  EXPECT_EQ(first.reason, lidar_odometry_t::REASON_FIRST_SCAN);
  EXPECT_TRUE(std::isnan(first.displacement_m[0]));
  const double half = std::sqrt(0.5);
  const Vector3d second_m(half * (0.3 - 0.1), half * (0.3 + 0.1), 0.5);
  const auto second = motions.Consume(ScanAt(kStart + 100ms, basin, VesselAt(second_m, 47.0, 1.0, -1.5) * boat.T_vessel_lidar));
  EXPECT_EQ(second.status, lidar_odometry_t::STATUS_OK);
  EXPECT_EQ(second.begin_utime_us, ToUtimeUs(kStart));
  EXPECT_EQ(second.utime_us, ToUtimeUs(kStart + 100ms));
  EXPECT_NEAR(second.displacement_m[0], 0.3, 0.002);
  EXPECT_NEAR(second.displacement_m[1], 0.1, 0.002);
  EXPECT_NEAR(RadToDeg(second.turn_rad), 2.0, 0.01);
  // Along the new bow, from there.
  const Vector3d third_m = second_m + 0.25 * Vector3d(std::sin(DegToRad(47.0)), std::cos(DegToRad(47.0)), -0.4);
  const auto third = motions.Consume(ScanAt(kStart + 200ms, basin, VesselAt(third_m, 46.0, -1.0, 2.0) * boat.T_vessel_lidar));
  EXPECT_NEAR(third.displacement_m[0], 0.25, 0.002);
  EXPECT_NEAR(third.displacement_m[1], 0.0, 0.002);
  EXPECT_NEAR(RadToDeg(third.turn_rad), -1.0, 0.01);
}

TEST(LidarPoints, AreAllReturnsOutsideOfTheOwnVesselWithTheirTimes) {
  auto boat = Boat();
  boat.T_vessel_lidar = Isometry3d::Identity();
  boat.own_vessel_box_m = Eigen::AlignedBox3d(Vector3d(-1.0, -1.0, -1.0), Vector3d(1.0, 1.0, 1.0));
  odometer::Scan scan;
  scan.time = kStart;
  scan.end_time = kStart + 100ms;
  scan.range_unit_m = 0.01;
  scan.rings = {{}, {.azimuth_offset_rad = 0.5 * kPi, .time_offset_ns = 1000, .origin_height_m = 0.25}};
  scan.azimuth_rad = {0.0, kPi};
  scan.time_ns = {0, 60'000'000};
  scan.range = {500, 0, 50, 300};  // column by column; 0.5 m astern is the own vessel
  const auto points = LidarPoints(scan, boat);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_TRUE(points[0].p_lidar_m.isApprox(Vector3d(5.0, 0.0, 0.0), 1e-12));
  EXPECT_NEAR(points[0].before_end_s, 0.1, 1e-12);
  // Clockwise by three quarters: to port.
  EXPECT_TRUE(points[1].p_lidar_m.isApprox(Vector3d(0.0, 3.0, 0.25), 1e-12));
  EXPECT_NEAR(points[1].before_end_s, 0.1 - 0.06 - 1e-6, 1e-12);
}

}  // namespace
}  // namespace lookout::eval
