// A place on the earth, as a lidar on a moving boat would see it, comes back from the georeferencer. The way there is computed here, from latitude
// and longitude down to the lidar frame, apart from the code under test.
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

using Eigen::Matrix3d;
using Eigen::Vector3d;
using GeographicLib::LocalCartesian;
using test::At;

double Between(std::mt19937& random, double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }

// Axes written out, by the definition of the angles: bow from heading and pitch, port from roll.
Matrix3d VesselAxes(double heading_rad, double pitch_rad, double roll_rad) {
  const Vector3d bow(std::sin(heading_rad) * std::cos(pitch_rad), std::cos(heading_rad) * std::cos(pitch_rad), std::sin(pitch_rad));
  const Vector3d level_port(-std::cos(heading_rad), std::sin(heading_rad), 0.0);
  const Vector3d tilted_up = bow.cross(level_port);
  const Vector3d port = std::cos(roll_rad) * level_port + std::sin(roll_rad) * tilted_up;  // starboard down is port up
  Matrix3d axes;
  axes << bow, port, bow.cross(port);
  return axes;
}

// East, north and up at a place of the map, along the axes of the map.
Matrix3d AxesOfPlace(const Vector3d& p_map_m, const LocalCartesian& map) {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double height_m = 0.0;
  std::vector<double> rotation(9);
  map.Reverse(p_map_m.x(), p_map_m.y(), p_map_m.z(), latitude_deg, longitude_deg, height_m, rotation);
  // Reverse gives the rotation from east, north, up at the place to the axes of the map.
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  return Eigen::Map<const RowMajor>(rotation.data());
}

// A boat that moves and turns evenly, so that the poses between those of the grid are on the line.
struct Voyage {
  Vector3d start_m;
  Vector3d velocity_mps;
  double heading_rad;
  double heading_rate_radps;
  double pitch_rad;
  double roll_rad;
  double roll_rate_radps;

  Vector3d PositionAt(double time_s) const { return start_m + time_s * velocity_mps; }
  // Heading, roll and pitch are against north and up where the boat is.
  Matrix3d AxesAt(double time_s, const LocalCartesian& map) const {
    return AxesOfPlace(PositionAt(time_s), map) *
           VesselAxes(heading_rad + time_s * heading_rate_radps, pitch_rad, roll_rad + time_s * roll_rate_radps);
  }
};

Voyage RandomVoyage(std::mt19937& random) {
  return {Vector3d(Between(random, -2000, 2000), Between(random, -2000, 2000), Between(random, -5, 5)),
          Vector3d(Between(random, -10, 10), Between(random, -10, 10), Between(random, -0.5, 0.5)),
          Between(random, 0, kTwoPi),
          Between(random, -1, 1),
          Between(random, -0.3, 0.3),
          Between(random, -0.3, 0.3),
          Between(random, -0.5, 0.5)};
}

PoseHistory PosesOf(const Voyage& voyage, const Datum& datum) {
  PoseHistory poses;
  for (int i = 0; i <= 6; ++i) {
    Pose pose = test::MakePose(20'000 * i);
    const double time_s = 0.02 * i;
    pose.datum = datum;
    pose.position_map_m = voyage.PositionAt(time_s);
    pose.heading_rad = WrapTo2Pi(voyage.heading_rad + time_s * voyage.heading_rate_radps);
    pose.pitch_rad = voyage.pitch_rad;
    pose.roll_rad = voyage.roll_rad + time_s * voyage.roll_rate_radps;
    poses.Add(pose);
  }
  return poses;
}

PlacementParams RandomMounting(std::mt19937& random) {
  Mounting mounting;
  mounting.p_vessel_m = {Between(random, -3, 3), Between(random, -1, 1), Between(random, 0, 3)};
  mounting.roll_rad = Between(random, -0.2, 0.2);
  mounting.pitch_rad = Between(random, -0.2, 0.2);
  mounting.yaw_rad = Between(random, -kPi, kPi);
  PlacementParams params;
  params.T_vessel_lidar = TransformVesselSensor(mounting);
  return params;
}

TEST(GeoreferencerRoundTrip, APlaceWithin200MetresComesBackWithinAMillimetre) {
  double worst_m = 0.0;
  for (std::uint32_t seed = 1; seed <= 2000; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const Datum datum{Between(random, -89, 89), Between(random, -180, 180), Between(random, -100, 3000)};
    const LocalCartesian map(datum.latitude_deg, datum.longitude_deg, datum.ellipsoid_height_m);
    const Voyage voyage = RandomVoyage(random);
    const auto params = RandomMounting(random);
    const auto offset_us = static_cast<std::int64_t>(Between(random, 0, 120'000));
    const double time_s = 1e-6 * static_cast<double>(offset_us);

    // The place, as latitude, longitude and height; then down to the lidar.
    const double bearing_rad = Between(random, 0, kTwoPi);
    const double distance_m = Between(random, 1, 200);
    const Vector3d near_m =
        voyage.PositionAt(time_s) + Vector3d(distance_m * std::sin(bearing_rad), distance_m * std::cos(bearing_rad), Between(random, -3, 5));
    double latitude_deg = 0.0;
    double longitude_deg = 0.0;
    double height_m = 0.0;
    map.Reverse(near_m.x(), near_m.y(), near_m.z(), latitude_deg, longitude_deg, height_m);
    Vector3d place_map_m;
    map.Forward(latitude_deg, longitude_deg, height_m, place_map_m.x(), place_map_m.y(), place_map_m.z());
    const Vector3d p_vessel_m = voyage.AxesAt(time_s, map).transpose() * (place_map_m - voyage.PositionAt(time_s));
    const Vector3d p_lidar_m = params.T_vessel_lidar.inverse() * p_vessel_m;

    const auto segment = test::MakePoint(offset_us, p_lidar_m.x(), p_lidar_m.y(), p_lidar_m.z());
    const auto obstacle = PlaceSegment(segment, PosesOf(voyage, datum), datum, false, params);
    ASSERT_EQ(obstacle.status, ObstacleStatus::kOk);
    Vector3d found_m;
    map.Forward(obstacle.latitude_deg, obstacle.longitude_deg, height_m, found_m.x(), found_m.y(), found_m.z());
    const double above_boat_m = AxesOfPlace(voyage.PositionAt(time_s), map).col(2).dot(place_map_m - voyage.PositionAt(time_s));
    worst_m = std::max({worst_m, (found_m - place_map_m).norm(), (obstacle.position_map_m - place_map_m.head<2>()).norm(),
                        (obstacle.footprint_map_m[0] - place_map_m.head<2>()).norm(), std::abs(obstacle.top_above_water_m - above_boat_m)});
    EXPECT_NEAR((obstacle.center_vessel_m - p_vessel_m.head<2>()).norm(), 0.0, 1e-6);
  }
  RecordProperty("worst_m", std::to_string(worst_m));
  EXPECT_LT(worst_m, 1e-3);
  std::printf("worst error %.3g m\n", worst_m);
}

TEST(GeoreferencerRoundTrip, AnOutlineSeenDuringATurnOfABoatThatTurnsKeepsItsShape) {
  for (std::uint32_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const LocalCartesian map(test::kLake.latitude_deg, test::kLake.longitude_deg, test::kLake.ellipsoid_height_m);
    Voyage voyage = RandomVoyage(random);
    voyage.pitch_rad = voyage.roll_rad = voyage.roll_rate_radps = 0.0;  // level: the height of a corner does not matter
    voyage.velocity_mps.z() = 0.0;
    PlacementParams params;
    params.T_vessel_lidar.translation() = Vector3d(1.0, -0.5, 2.0);
    // A rectangle of 40 m x 10 m beside the boat.
    const Vector3d corner_m = voyage.start_m + Vector3d(Between(random, 20, 50), Between(random, -20, 20), 0.0);
    const std::vector<Vector3d> corners{corner_m, corner_m + Vector3d(10, 0, 0), corner_m + Vector3d(10, 40, 0), corner_m + Vector3d(0, 40, 0)};
    Segment segment = test::MakePoint(50'000, 0.0, 0.0, -2.0);
    segment.hull.clear();
    const auto seen_at_some_time = [&](const Vector3d& place_map_m) {
      const auto offset_us = static_cast<std::int64_t>(Between(random, 0, 100'000));
      const double time_s = 1e-6 * static_cast<double>(offset_us);
      const Vector3d p_lidar_m =
          params.T_vessel_lidar.inverse() * (voyage.AxesAt(time_s, map).transpose() * (place_map_m - voyage.PositionAt(time_s)));
      return HullVertex{p_lidar_m.head<2>(), At(offset_us)};
    };
    for (const auto& corner : corners) segment.hull.push_back(seen_at_some_time(corner));
    for (const auto& corner : corners) segment.waterline.push_back(seen_at_some_time(corner));
    const auto obstacle = PlaceSegment(segment, PosesOf(voyage, test::kLake), test::kLake, false, params);
    ASSERT_EQ(obstacle.status, ObstacleStatus::kOk);
    // 2 km from the datum the map leans by 0.3 mrad: corners 50 m away that are level with the boat on the map are 15 mm above or below it.
    for (std::size_t i = 0; i < corners.size(); ++i) {
      EXPECT_LT((obstacle.footprint_map_m[i] - corners[i].head<2>()).norm(), 2e-5);
      EXPECT_LT((obstacle.waterline_map_m[i] - corners[i].head<2>()).norm(), 2e-5);
    }
    EXPECT_LT((obstacle.position_map_m - (corner_m + Vector3d(5, 20, 0)).head<2>()).norm(), 2e-5);
  }
}

}  // namespace
}  // namespace lookout::georeferencer
