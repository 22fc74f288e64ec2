// Obstacles of a boat far from its datum: places against GeographicLib, deviations against drawn errors. Heading, roll and pitch are those where the
// boat is; taken for angles against the axes of the map they put an obstacle 100 m off 7 m beside its place, 260 km from the datum at 60 N.
#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "common/core/angles.hpp"
#include "common/core/frames.hpp"
#include "services/georeferencer/core/placement.hpp"
#include "tests/unit/georeferencer/messages.hpp"

namespace lookout::georeferencer {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using GeographicLib::LocalCartesian;

struct FarCase {
  const char* name;
  Datum datum;
  double latitude_deg;
  double longitude_deg;
};
const FarCase kFarCases[] = {
    {"260 km east at 60 N", {60.0, 8.0, 20.0}, 60.0, 12.67},
    {"200 km beside the datum", {45.0, 5.46, 0.0}, 45.0, 8.0},
    {"over 180 deg", {-16.0, 178.0, 30.0}, -16.5, -179.0},
    {"at 89 N", {89.0, 10.0, 0.0}, 89.2, 130.0},
    {"swapped latitude and longitude", {-72.15, 43.63, 0.0}, 43.63, -72.15},
};

struct Boat {
  explicit Boat(const FarCase& one)
      : map(one.datum.latitude_deg, one.datum.longitude_deg, one.datum.ellipsoid_height_m), here(one.latitude_deg, one.longitude_deg, 30.0) {
    pose.datum = one.datum;
    map.Forward(one.latitude_deg, one.longitude_deg, 30.0, pose.position_map_m.x(), pose.position_map_m.y(), pose.position_map_m.z());
    pose.heading_rad = DegToRad(70.0);
  }

  // To the map, from east, north, up at the boat.
  Vector3d ToMap(const Vector3d& p_here_m) const {
    double latitude_deg = 0.0;
    double longitude_deg = 0.0;
    double height_m = 0.0;
    here.Reverse(p_here_m.x(), p_here_m.y(), p_here_m.z(), latitude_deg, longitude_deg, height_m);
    Vector3d p_map_m;
    map.Forward(latitude_deg, longitude_deg, height_m, p_map_m.x(), p_map_m.y(), p_map_m.z());
    return p_map_m;
  }

  LocalCartesian map;
  LocalCartesian here;
  Pose pose = test::MakePose(0);
};

PoseHistory PosesOf(Pose pose) {
  PoseHistory poses;
  poses.Add(pose);
  pose.time += std::chrono::milliseconds(20);
  poses.Add(pose);
  return poses;
}

TEST(GeoreferencerFarFromItsDatum, PlacesAnObstacleWhereItIs) {
  for (const auto& one : kFarCases) {
    SCOPED_TRACE(one.name);
    const Boat boat(one);
    const Vector3d ahead_here_m(100.0 * std::sin(boat.pose.heading_rad), 100.0 * std::cos(boat.pose.heading_rad), 0.0);
    // A square of 4 m about it, on the level of the boat.
    Segment segment = test::MakePoint(10'000, 100.0, 0.0, 0.0);
    segment.hull.clear();
    for (const Vector2d& corner_m : {Vector2d(98, -2), Vector2d(102, -2), Vector2d(102, 2), Vector2d(98, 2)}) {
      segment.hull.push_back({corner_m, test::At(10'000)});
    }
    const auto obstacle = PlaceSegment(segment, PosesOf(boat.pose), one.datum, false, {});
    ASSERT_EQ(obstacle.status, ObstacleStatus::kOk);
    Vector3d found_here_m;
    boat.here.Forward(obstacle.latitude_deg, obstacle.longitude_deg, 30.0, found_here_m.x(), found_here_m.y(), found_here_m.z());
    EXPECT_LT((found_here_m - ahead_here_m).head<2>().norm(), 1e-3);
    EXPECT_LT((obstacle.position_map_m - boat.ToMap(ahead_here_m).head<2>()).norm(), 1e-3);
    EXPECT_LT((obstacle.center_vessel_m - Vector2d(100.0, 0.0)).norm(), 1e-3);
    EXPECT_NEAR(obstacle.top_above_water_m, 0.0, 1e-6);
  }
}

// A small error of heading, roll and pitch, and of the position in the map frame, moves the obstacle in the map frame as the covariance says.
TEST(GeoreferencerFarFromItsDatum, StatesTheDeviationsOfTheMapFrame) {
  for (const auto& one : kFarCases) {
    SCOPED_TRACE(one.name);
    Boat boat(one);
    const Vector3d sds_rad(DegToRad(0.3), DegToRad(0.5), DegToRad(1.0));  // roll, pitch, heading
    boat.pose.covariance.setZero();
    boat.pose.covariance.diagonal() << 0.3 * 0.3, 0.1 * 0.1, sds_rad[0] * sds_rad[0], sds_rad[1] * sds_rad[1], sds_rad[2] * sds_rad[2];
    const Vector3d p_vessel_m(100.0, 5.0, 3.0);
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    constexpr int kNumFarDraws = 20'000;
    Matrix2d drawn = Matrix2d::Zero();
    const Vector3d place_map_m = boat.ToMap(RotationMapVessel(boat.pose.heading_rad, 0.0, 0.0) * p_vessel_m);
    for (int i = 0; i < kNumFarDraws; ++i) {
      const Vector3d error_rad(sds_rad[0] * normal(random), sds_rad[1] * normal(random), sds_rad[2] * normal(random));
      const Vector3d moved_m = boat.ToMap(RotationMapVessel(boat.pose.heading_rad + error_rad[2], error_rad[1], error_rad[0]) * p_vessel_m);
      const Vector2d error_m = (moved_m - place_map_m).head<2>() + Vector2d(0.3 * normal(random), 0.1 * normal(random));
      drawn += error_m * error_m.transpose() / kNumFarDraws;
    }
    const Matrix2d stated = PositionCovariance(p_vessel_m, *PosesOf(boat.pose).At(test::At(0)), {});
    EXPECT_LT((stated - drawn).norm() / drawn.norm(), 0.05) << stated << "\nagainst\n" << drawn;
  }
}

}  // namespace
}  // namespace lookout::georeferencer
