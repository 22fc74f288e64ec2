#include "services/georeferencer/core/placement.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "common/core/frames.hpp"
#include "tests/unit/georeferencer/messages.hpp"

namespace lookout::georeferencer {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::At;
using test::MakePoint;
using test::MakePose;

PlacementParams Bare() { return {}; }

// One pose before and one after the point at 10 ms.
PoseHistory Around(const Pose& pose) {
  PoseHistory poses;
  for (const std::int64_t offset_us : {0, 20'000}) {
    Pose copy = pose;
    copy.time = At(offset_us);
    poses.Add(copy);
  }
  return poses;
}

Obstacle Place(const Segment& segment, const Pose& pose, const PlacementParams& params) {
  return PlaceSegment(segment, Around(pose), test::kLake, false, params);
}

TEST(PlaceSegment, AheadOfABoatThatHeadsEastIsEast) {
  Pose pose = MakePose(0);
  pose.heading_rad = DegToRad(90.0);
  pose.position_map_m = {100.0, 50.0, 1.0};
  const auto obstacle = Place(MakePoint(10'000, 10.0, 0.0, 0.0), pose, Bare());
  EXPECT_EQ(obstacle.status, ObstacleStatus::kOk);
  // East is that of the boat: 100 m from the datum it points 15 microradians north of the map's.
  const double convergence_rad = 100.0 / 6.388e6 * std::tan(DegToRad(test::kLake.latitude_deg));
  EXPECT_NEAR(obstacle.position_map_m.x(), 110.0, 1e-8);
  EXPECT_NEAR(obstacle.position_map_m.y(), 50.0 + 10.0 * convergence_rad, 1e-6);
  EXPECT_NEAR(obstacle.center_vessel_m.x(), 10.0, 1e-9);
  EXPECT_NEAR(obstacle.range_m, 10.0, 1e-12);
  EXPECT_EQ(obstacle.bearing_rad, 0.0);
  ASSERT_EQ(obstacle.footprint_map_m.size(), 1U);
}

TEST(PlaceSegment, PortOfABoatThatHeadsNorthIsWestAndBears270) {
  const auto obstacle = Place(MakePoint(10'000, 0.0, 20.0, 0.0), MakePose(0), Bare());
  EXPECT_NEAR(obstacle.position_map_m.x(), -20.0, 1e-9);
  EXPECT_NEAR(obstacle.position_map_m.y(), 0.0, 1e-9);
  EXPECT_NEAR(RadToDeg(obstacle.bearing_rad), 270.0, 1e-9);
}

TEST(PlaceSegment, LatitudeAndLongitudeAgreeWithOneMinuteOfArc) {
  // A minute of latitude at 43.7 N is 1851.8 m on the ellipsoid (plus 29 mm at 100 m of height); 0.1 % of it is asked for.
  Pose pose = MakePose(0);
  pose.position_map_m = {0.0, 1851.8, 0.0};
  const auto obstacle = Place(MakePoint(10'000, 0.0, 0.0, 0.0), pose, Bare());
  EXPECT_NEAR(obstacle.latitude_deg, 43.7 + 1.0 / 60.0, 1e-3 / 60.0);
  EXPECT_NEAR(obstacle.longitude_deg, -72.3, 1e-9);
}

TEST(PlaceSegment, UsesMountingAndTilt) {
  PlacementParams params;
  Mounting mounting;
  mounting.p_vessel_m = {1.0, 2.0, 3.0};
  mounting.yaw_rad = DegToRad(90.0);
  params.T_vessel_lidar = TransformVesselSensor(mounting);
  Pose pose = MakePose(0);
  pose.roll_rad = DegToRad(30.0);  // starboard down
  // Lidar x is port: vessel (1, 12, 3). Rolled: y' = y cos - z sin, z' = y sin + z cos; heading north: east is -y', north is x.
  const auto obstacle = Place(MakePoint(10'000, 10.0, 0.0, 0.0), pose, params);
  EXPECT_NEAR(obstacle.position_map_m.x(), -(12.0 * std::cos(DegToRad(30.0)) - 3.0 * 0.5), 1e-9);
  EXPECT_NEAR(obstacle.position_map_m.y(), 1.0, 1e-9);
  EXPECT_NEAR(obstacle.top_above_water_m, 12.0 * 0.5 + 3.0 * std::cos(DegToRad(30.0)), 1e-9);
  EXPECT_NEAR(obstacle.center_vessel_m.y(), 12.0, 1e-9);
}

TEST(PlaceSegment, EachCornerIsPlacedByThePoseAtItsOwnTime) {
  PoseHistory poses;
  for (int i = 0; i <= 5; ++i) {
    Pose pose = MakePose(20'000 * i);
    pose.position_map_m.y() = 5.0 * 0.02 * i;  // 5 m/s to the north
    poses.Add(pose);
  }
  Segment segment = MakePoint(50'000, 10.0, 0.0, 0.0);
  segment.hull = {{{10.0, 0.0}, At(0)}, {{9.75, 0.0}, At(50'000)}, {{9.5, 0.0}, At(100'000)}};  // one and the same place
  const auto obstacle = PlaceSegment(segment, poses, test::kLake, false, Bare());
  ASSERT_EQ(obstacle.footprint_map_m.size(), 3U);
  for (const auto& vertex : obstacle.footprint_map_m) EXPECT_NEAR(vertex.y(), 10.0, 1e-9);
  EXPECT_NEAR(obstacle.position_map_m.y(), 10.0, 1e-9);
  EXPECT_NEAR(obstacle.center_vessel_m.x(), 9.75, 1e-9) << "the same point, at the time of the segment";
  EXPECT_NEAR(obstacle.footprint_vessel_m[0].x(), 10.0, 1e-9) << "as seen";
}

// A straight shore 30 m to the north of a boat that turns at 20 degrees a second and moves: seen during 100 ms, its bearing changes by 2 degrees.
TEST(PlaceSegment, AWaterlineSeenFromATurningBoatIsStraightOnTheMap) {
  const auto pose_at = [](std::int64_t offset_us) {
    const double time_s = static_cast<double>(offset_us) * 1e-6;
    Pose pose = MakePose(offset_us);
    pose.heading_rad = WrapTo2Pi(DegToRad(359.0 + 20.0 * time_s));  // across north
    pose.position_map_m = {3.0 * time_s, 4.0 * time_s, 0.0};
    return pose;
  };
  PoseHistory poses;
  for (int i = 0; i <= 5; ++i) poses.Add(pose_at(20'000 * i));
  PlacementParams params;
  Mounting mounting;
  mounting.p_vessel_m = {0.5, -0.25, 1.5};
  mounting.yaw_rad = DegToRad(30.0);
  params.T_vessel_lidar = TransformVesselSensor(mounting);

  Segment segment = MakePoint(50'000, 0.0, 0.0, -1.5);
  segment.rating.kind = Kind::kLand;
  const auto add = [&](std::int64_t offset_us, double east_m, std::vector<HullVertex>& corners) {
    const Pose pose = pose_at(offset_us);
    const Eigen::Vector3d p_vessel_m =
        RotationMapVessel(pose.heading_rad, 0.0, 0.0).transpose() * (Vector3d(east_m, 30.0, 0.0) - pose.position_map_m);
    const Vector3d p_lidar_m = params.T_vessel_lidar.inverse() * p_vessel_m;
    corners.push_back({p_lidar_m.head<2>(), At(offset_us)});
    return p_vessel_m;
  };
  segment.hull.clear();
  add(50'000, 0.0, segment.hull);
  std::vector<Vector3d> seen_vessel_m;
  for (int i = 0; i <= 10; ++i) seen_vessel_m.push_back(add(10'000 * i, -40.0 + 8.0 * i, segment.waterline));

  const auto obstacle = PlaceSegment(segment, poses, test::kLake, false, params);
  ASSERT_EQ(obstacle.status, ObstacleStatus::kOk);
  EXPECT_EQ(obstacle.rating.kind, Kind::kLand);
  ASSERT_EQ(obstacle.waterline_map_m.size(), 11U);
  for (std::size_t i = 0; i <= 10; ++i) {
    // Within the metre that the boat goes, north turns by a tenth of a microradian.
    EXPECT_NEAR(obstacle.waterline_map_m[i].x(), -40.0 + 8.0 * static_cast<double>(i), 1e-5) << i;
    EXPECT_NEAR(obstacle.waterline_map_m[i].y(), 30.0, 1e-5) << i;
    EXPECT_TRUE(obstacle.waterline_vessel_m[i].isApprox(seen_vessel_m[i].head<2>(), 1e-9)) << "as seen";
  }
  EXPECT_NEAR(obstacle.position_map_m.x(), 0.0, 1e-5) << "the centre of the footprint, whatever the waterline";
  // By one pose for all, the ends would be off by 50 m x 1 degree.
  EXPECT_GT((obstacle.waterline_vessel_m[0] - RotationMapVessel(pose_at(50'000).heading_rad, 0.0, 0.0).topLeftCorner<2, 2>().transpose() *
                                                  (Vector2d(-40.0, 30.0) - Vector2d(0.15, 0.2)))
                .norm(),
            0.7);
}

TEST(PlaceSegment, WithoutAPoseTellsWhatTheVesselSees) {
  PlacementParams params;
  params.T_vessel_lidar.translation() = Vector3d(0.0, 0.0, 1.1);
  params.reference_point_above_water_m = 0.4;
  const auto obstacle = PlaceSegment(MakePoint(10'000, 3.0, -4.0, 0.5), PoseHistory{}, Datum{}, false, params);
  EXPECT_EQ(obstacle.status, ObstacleStatus::kVesselFrameOnly);
  EXPECT_TRUE(std::isnan(obstacle.latitude_deg) && std::isnan(obstacle.longitude_deg));
  EXPECT_TRUE(obstacle.position_map_m.hasNaN() && obstacle.covariance_m2.hasNaN() && obstacle.covariance_relative_m2.hasNaN());
  EXPECT_TRUE(obstacle.footprint_map_m.empty());
  EXPECT_NEAR(obstacle.range_m, 5.0, 1e-12);
  EXPECT_NEAR(RadToDeg(obstacle.bearing_rad), RadToDeg(std::atan2(4.0, 3.0)), 1e-9);
  EXPECT_NEAR(obstacle.top_above_water_m, 2.0, 1e-12) << "level";
  EXPECT_NEAR(obstacle.center_vessel_m.y(), -4.0, 1e-12);
}

TEST(PlaceSegment, WithoutHeadingStillUsesTiltAndHeaveForTheTop) {
  Pose pose = MakePose(0);
  pose.is_placed = false;
  pose.heading_rad = kNan;
  pose.position_map_m.setConstant(kNan);
  pose.pitch_rad = DegToRad(30.0);  // bow up
  pose.heave_m = 0.25;
  PlacementParams params;
  params.reference_point_above_water_m = 1.0;
  const auto obstacle = Place(MakePoint(10'000, 10.0, 0.0, 0.0), pose, params);
  EXPECT_EQ(obstacle.status, ObstacleStatus::kVesselFrameOnly);
  EXPECT_NEAR(obstacle.top_above_water_m, 5.0 + 1.0 + 0.25, 1e-9);
}

TEST(PlaceSegment, ACornerWithoutAPoseKeepsTheWholeObstacleOffTheMap) {
  Segment segment = MakePoint(10'000, 10.0, 0.0, 0.0);
  segment.hull.push_back({{11.0, 0.0}, At(20'001)});
  const auto poses = Around(MakePose(0));
  EXPECT_EQ(PlaceSegment(segment, poses, test::kLake, false, Bare()).status, ObstacleStatus::kVesselFrameOnly);
  EXPECT_EQ(PlaceSegment(segment, poses, test::kLake, true, Bare()).status, ObstacleStatus::kPoseTimeout);
}

TEST(PlaceSegment, SoDoesACornerOfTheWaterline) {
  Segment segment = MakePoint(10'000, 10.0, 0.0, 0.0);
  segment.waterline = {{{11.0, 0.0}, At(0)}, {{11.0, -1.0}, At(20'001)}};
  const auto poses = Around(MakePose(0));
  const auto obstacle = PlaceSegment(segment, poses, test::kLake, false, Bare());
  EXPECT_EQ(obstacle.status, ObstacleStatus::kVesselFrameOnly);
  EXPECT_TRUE(obstacle.footprint_map_m.empty() && obstacle.waterline_map_m.empty());
  EXPECT_EQ(obstacle.waterline_vessel_m.size(), 2U);
  EXPECT_EQ(PlaceSegment(segment, poses, test::kLake, true, Bare()).status, ObstacleStatus::kPoseTimeout);
}

TEST(PlaceSegment, AfterATimeoutWhatPoseHasPassedIsNoTimeout) {
  Pose unplaced = MakePose(0);
  unplaced.is_placed = false;
  const auto segment = MakePoint(10'000, 10.0, 0.0, 0.0);
  EXPECT_EQ(PlaceSegment(segment, Around(unplaced), test::kLake, true, Bare()).status, ObstacleStatus::kVesselFrameOnly);
  EXPECT_EQ(PlaceSegment(segment, Around(MakePose(0)), test::kLake, true, Bare()).status, ObstacleStatus::kOk);
  EXPECT_EQ(PlaceSegment(segment, PoseHistory{}, Datum{}, true, Bare()).status, ObstacleStatus::kPoseTimeout);
}

TEST(PlaceSegment, APoseInAnotherMapFrameDoesNotCount) {
  Datum other = test::kLake;
  other.longitude_deg += 1e-9;
  EXPECT_EQ(PlaceSegment(MakePoint(10'000, 1.0, 0.0, 0.0), Around(MakePose(0)), other, false, Bare()).status, ObstacleStatus::kVesselFrameOnly);
}

TEST(PlaceSegment, OfALidarUpsideDownKeepsTheOutlineCounterClockwiseAndFindsTheTop) {
  PlacementParams params;
  Mounting mounting;
  mounting.roll_rad = kPi;
  mounting.p_vessel_m = {0.0, 0.0, 2.0};
  params.T_vessel_lidar = TransformVesselSensor(mounting);
  Segment segment = MakePoint(10'000, 11.0, 1.0, 0.0);
  segment.min_z_m = -1.5;
  segment.max_z_m = 0.5;
  segment.top_m = {11.0, 1.0, -1.5};  // the lowest in the lidar's own frame
  segment.hull = {{{10.0, 0.0}, At(10'000)}, {{12.0, 0.0}, At(10'000)}, {{12.0, 2.0}, At(10'000)}, {{10.0, 2.0}, At(10'000)}};
  segment.waterline = {{{10.0, 2.0}, At(10'000)}, {{10.0, 0.0}, At(10'000)}};
  const auto obstacle = Place(segment, MakePose(0), params);
  ASSERT_EQ(obstacle.waterline_vessel_m.size(), 2U);
  EXPECT_GT(obstacle.waterline_vessel_m[0].y(), obstacle.waterline_vessel_m[1].y()) << "ahead, and from left to right";
  double doubled_area_m2 = 0.0;
  const auto& outline = obstacle.footprint_vessel_m;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const auto& next = outline[(i + 1) % outline.size()];
    doubled_area_m2 += outline[i].x() * next.y() - outline[i].y() * next.x();
  }
  EXPECT_NEAR(doubled_area_m2, 8.0, 1e-9);
  EXPECT_NEAR(obstacle.top_above_water_m, 3.5, 1e-9);
  EXPECT_NEAR(obstacle.height_m, 2.0, 1e-12);
}

TEST(FootprintCenter, OfOnePointIsThePoint) { EXPECT_EQ(FootprintCenter({{1.0, 2.0, 3.0}}), Vector3d(1.0, 2.0, 3.0)); }

TEST(FootprintCenter, OfTwoPointsIsBetweenThem) {
  EXPECT_TRUE(FootprintCenter({{0.0, 0.0, 0.0}, {2.0, 4.0, 6.0}}).isApprox(Vector3d(1.0, 2.0, 3.0)));
}

TEST(FootprintCenter, OfAnAreaDoesNotFollowWhereTheVerticesAreMany) {
  // A square of side 2, one side of it with many vertices.
  std::vector<Vector3d> vertices{{0.0, 0.0, 0.0}, {2.0, 0.0, 0.0}, {2.0, 2.0, 0.0}};
  for (int i = 0; i <= 20; ++i) vertices.emplace_back(0.0, 2.0 - 0.1 * i, 0.0);
  EXPECT_TRUE(FootprintCenter(vertices).isApprox(Vector3d(1.0, 1.0, 0.0), 1e-12));
}

TEST(FootprintCenter, LiesOnATiltedOutlineAndIsTheSameInEitherSense) {
  const std::vector<Vector3d> triangle{{0.0, 0.0, 0.0}, {3.0, 0.0, 3.0}, {0.0, 3.0, 0.0}};
  EXPECT_TRUE(FootprintCenter(triangle).isApprox(Vector3d(1.0, 1.0, 1.0)));
  EXPECT_TRUE(FootprintCenter({triangle.rbegin(), triangle.rend()}).isApprox(Vector3d(1.0, 1.0, 1.0)));
}

TEST(FootprintCenter, OfALineWithRoundingErrorsStaysOnIt) {
  const auto center = FootprintCenter({{0.0, 0.0, 0.0}, {5.0, 1e-6, 0.0}, {10.0, 0.0, 0.0}, {5.0, 1.1e-6, 0.0}});
  EXPECT_NEAR(center.x(), 5.0, 1e-9);
  EXPECT_NEAR(center.y(), 0.0, 1e-5);
}

TEST(FootprintCenter, FarFromTheDatumLosesNoDigits) {
  const Vector3d far(1e6, -1e6, 0.0);
  const auto center = FootprintCenter({far, far + Vector3d(0.2, 0.0, 0.0), far + Vector3d(0.2, 0.2, 0.0), far + Vector3d(0.0, 0.2, 0.0)});
  EXPECT_NEAR(center.x() - far.x(), 0.1, 1e-9);
  EXPECT_NEAR(center.y() - far.y(), 0.1, 1e-9);
}

TEST(FootprintCenter, OfCoincidentPointsIsThatPoint) {
  EXPECT_EQ(FootprintCenter({{1.0, 1.0, 0.0}, {1.0, 1.0, 0.0}, {1.0, 1.0, 0.0}}), Vector3d(1.0, 1.0, 0.0));
}

TEST(Thinned, KeepsOutlinesUpToTheLimitAndSpreadsTheRest) {
  for (const std::size_t size : {std::size_t{1}, kMaxFootprintVertices, kMaxFootprintVertices + 1, std::size_t{9999}}) {
    std::vector<HullVertex> hull(size);
    for (std::size_t i = 0; i < size; ++i) hull[i].p_lidar_m.x() = static_cast<double>(i);
    const auto thinned = Thinned(hull);
    ASSERT_EQ(thinned.size(), std::min(size, kMaxFootprintVertices));
    EXPECT_EQ(thinned.front().p_lidar_m.x(), 0.0);
    for (std::size_t i = 1; i < thinned.size(); ++i) EXPECT_GT(thinned[i].p_lidar_m.x(), thinned[i - 1].p_lidar_m.x());
  }
}

TEST(ThinnedLine, KeepsLinesUpToTheLimitAndBothEndsOfLongerOnes) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, kMaxWaterlineVertices, kMaxWaterlineVertices + 1, std::size_t{9999}}) {
    std::vector<HullVertex> line(size);
    for (std::size_t i = 0; i < size; ++i) line[i].p_lidar_m.x() = static_cast<double>(i);
    const auto thinned = ThinnedLine(line);
    ASSERT_EQ(thinned.size(), std::min(size, kMaxWaterlineVertices));
    if (size == 0) continue;
    EXPECT_EQ(thinned.front().p_lidar_m.x(), 0.0);
    EXPECT_EQ(thinned.back().p_lidar_m.x(), static_cast<double>(size - 1));
    for (std::size_t i = 1; i < thinned.size(); ++i) EXPECT_GT(thinned[i].p_lidar_m.x(), thinned[i - 1].p_lidar_m.x());
  }
}

TEST(Thinned, OfACircleOf100MetresLeavesNoPointFartherThan25Millimetres) {
  // Sagitta of a chord over 1/140 of the circle.
  EXPECT_LT(100.0 * (1.0 - std::cos(kPi / static_cast<double>(kMaxFootprintVertices))), 0.0255);
}

TEST(RelativeCovariance, LeavesOutTheErrorOfTheOwnPosition) {
  Pose pose = MakePose(0);
  pose.covariance(4, 4) = 0.01 * 0.01;
  const auto relative = RelativeCovariance({100.0, 0.0, 0.0}, pose, Bare());
  EXPECT_NEAR(relative(0, 0), 1.0, 1e-9);
  // 2 m of GNSS, and a heading that knows of it: neither moves the obstacle against the boat.
  pose.covariance(0, 0) = pose.covariance(1, 1) = 4.0;
  pose.covariance(0, 4) = pose.covariance(4, 0) = 0.01;
  EXPECT_EQ(RelativeCovariance({100.0, 0.0, 0.0}, pose, Bare()), relative);
  EXPECT_GT(PositionCovariance({100.0, 0.0, 0.0}, pose, Bare())(0, 0), 6.0);
}

TEST(PositionCovariance, HeadingErrorWorksAcrossTheLeverOnly) {
  Pose pose = MakePose(0);
  pose.covariance(4, 4) = 0.01 * 0.01;
  const auto covariance = PositionCovariance({100.0, 0.0, 0.0}, pose, Bare());  // 100 m to the north
  EXPECT_NEAR(covariance(0, 0), 1.0, 1e-9);
  EXPECT_NEAR(covariance(0, 1), 0.0, 1e-9);
  EXPECT_NEAR(covariance(1, 1), 0.0, 1e-9);
}

TEST(PositionCovariance, RangeErrorWorksAlongTheBeamOnly) {
  PlacementParams params;
  params.range_sd_m = 0.03;
  const auto covariance = PositionCovariance({100.0, 0.0, 0.0}, MakePose(0), params);
  EXPECT_NEAR(covariance(0, 0), 0.0, 1e-12);
  EXPECT_NEAR(covariance(1, 1), 9e-4, 1e-12);
}

TEST(PositionCovariance, AzimuthErrorWorksAcrossTheBeamAndStartsAtTheLidar) {
  PlacementParams params;
  params.azimuth_sd_rad = 0.01;
  params.T_vessel_lidar.translation() = Vector3d(50.0, 0.0, 1.0);
  const auto covariance = PositionCovariance({100.0, 0.0, 0.0}, MakePose(0), params);
  EXPECT_NEAR(covariance(0, 0), 0.25, 1e-9);  // 0.01 rad of 50 m
  EXPECT_NEAR(covariance(1, 1), 0.0, 1e-9);
}

// Corners are placed at the mean height: a mast of 6 m in front of a boat that rolls by 0.1 rad is up to 0.3 m beside it.
TEST(PlaceSegment, HeightsThatAreNotKnownOfEachCornerWidenTheEllipseOfABoatThatLeans) {
  Pose pose = MakePose(0);
  auto mast = MakePoint(10'000, 20.0, 0.0, 0.0);
  const auto level = Place(mast, pose, Bare()).covariance_m2;
  mast.min_z_m = -1.0;
  mast.max_z_m = 5.0;
  EXPECT_EQ(Place(mast, pose, Bare()).covariance_m2, level);
  pose.roll_rad = 0.1;
  const auto leaning = Place(mast, pose, Bare()).covariance_m2;
  EXPECT_NEAR(leaning(0, 0) - level(0, 0), 36.0 / 12.0 * std::pow(std::sin(0.1), 2), 1e-9);  // the boat heads north: roll leans east and west
  EXPECT_NEAR(leaning(1, 1), level(1, 1), 1e-9);
}

TEST(PositionCovariance, MountingErrorStartsAtTheLidarNotAtTheReferencePoint) {
  PlacementParams params;
  params.mounting_sd_rad = 0.01;
  params.T_vessel_lidar.translation() = Vector3d(40.0, 0.0, 0.0);
  const auto covariance = PositionCovariance({100.0, 0.0, 0.0}, MakePose(0), params);
  EXPECT_NEAR(covariance(0, 0), 0.36, 1e-9);
  EXPECT_NEAR(covariance(1, 1), 0.0, 1e-9);
}

TEST(PositionCovariance, IsUnknownWhereThePoseDoesNotKnowItsOwn) {
  Pose pose = MakePose(0);
  pose.covariance(0, 0) = kNan;
  EXPECT_TRUE(PositionCovariance({1.0, 0.0, 0.0}, pose, Bare()).hasNaN());
}

TEST(PositionCovariance, AtTheLidarItselfIsThatOfThePose) {
  Pose pose = MakePose(0);
  pose.covariance(0, 0) = 4.0;
  PlacementParams params;
  params.range_sd_m = params.mounting_sd_rad = 0.1;
  const auto covariance = PositionCovariance(Vector3d::Zero(), pose, params);
  EXPECT_EQ(covariance(0, 0), 4.0);
  EXPECT_EQ(covariance(1, 1), 0.0);
}

}  // namespace
}  // namespace lookout::georeferencer
