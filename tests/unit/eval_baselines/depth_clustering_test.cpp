#include "lab/eval/baselines/depth_clustering.hpp"

#include <gtest/gtest.h>

#include "tests/unit/eval_baselines/labels.hpp"

namespace lookout::eval {
namespace {

using namespace test;

DepthClusteringParams WithoutGround() {
  DepthClusteringParams params;
  params.ground.reset();
  params.limits = SizeLimits{};
  return params;
}

Labelling Segment(const segmenter::Scan& scan, const DepthClusteringParams& params) {
  return Peer("depth clustering", {}, params.limits, DepthGrouping(params)).Segment(scan);
}

DepthImage Column(std::vector<float> range_m) {
  DepthImage image;
  image.num_columns = 1;
  for (std::size_t ring = 0; ring < range_m.size(); ++ring) image.elevation_rad.push_back(DegToRad(-15.0 + 2.0 * static_cast<double>(ring)));
  image.range_m = std::move(range_m);
  image.joins_next.assign(1, false);
  return image;
}

// Seen from 1 m above a plane, with an upright wall at 20 m behind it: rings 0 to 6 meet the plane.
segmenter::Scan PlaneAndWall() {
  auto scan = Turn(16);
  for (int ring = 0; ring < 16; ++ring) {
    const double elevation_rad = scan.head.rings[static_cast<std::size_t>(ring)].elevation_rad;
    const double wall_m = 20.0 / std::cos(elevation_rad);
    const double plane_m = elevation_rad < 0.0 ? 1.0 / std::sin(-elevation_rad) : 1e9;
    SetPatch(scan, 0, 359, ring, ring, std::min(wall_m, plane_m));
  }
  return scan;
}

TEST(DepthClustering, OfAnEmptyTurnIsEmpty) {
  const auto scan = Turn();
  for (const auto& params : {WithoutGround(), DepthClusteringParams{}}) {
    EXPECT_EQ(Segment(scan, params).label, std::vector<std::int32_t>(scan.num_cells(), 0));
  }
}

TEST(DepthClustering, ASingleReturnIsASegment) {
  auto scan = Turn();
  SetReturn(scan, 17, 2, 10.0);
  EXPECT_EQ(LabelAt(scan, Segment(scan, WithoutGround()), 17, 2), 1);
}

TEST(DepthClustering, PartsWhereTheLineBetweenFacesTheSensorTooFlatly) {
  // Columns 1 degree apart, one return at 10 m, the next at 10 m + d: beta = atan2(10 sin 1, 10 + d - 10 cos 1) is 10 degrees at
  // d = 10 sin 1 / tan 10 - 10 (1 - cos 1) = 0.990 - 0.002 = 0.988 m.
  auto scan = Turn();
  SetPatch(scan, 10, 14, 1, 1, 10.0);
  SetPatch(scan, 15, 19, 1, 1, 10.96);
  auto labelling = Segment(scan, WithoutGround());
  EXPECT_EQ(LabelAt(scan, labelling, 10, 1), LabelAt(scan, labelling, 19, 1));
  SetPatch(scan, 15, 19, 1, 1, 11.02);
  labelling = Segment(scan, WithoutGround());
  EXPECT_EQ(LabelAt(scan, labelling, 14, 1), 1);
  EXPECT_EQ(LabelAt(scan, labelling, 15, 1), 2);
}

TEST(DepthClustering, StepsOverEmptyPixelsAsFarAsItReaches) {
  auto scan = Turn();
  SetPatch(scan, 10, 12, 1, 1, 10.0);
  SetPatch(scan, 16, 18, 1, 1, 10.0);  // three empty columns between
  SetPatch(scan, 10, 12, 3, 3, 10.0);  // one empty ring between
  auto params = WithoutGround();
  EXPECT_EQ(Segment(scan, params).is_sure.size(), 3U);
  params.reach_columns = 3;
  EXPECT_EQ(Segment(scan, params).is_sure.size(), 3U);
  params.reach_columns = 4;
  EXPECT_EQ(Segment(scan, params).is_sure.size(), 2U);
  params.reach_rings = 2;
  EXPECT_EQ(Segment(scan, params).is_sure.size(), 1U);
}

TEST(DepthClustering, HasNoSeamAtZero) {
  auto scan = Turn();
  SetPatch(scan, -3, 3, 1, 1, 10.0);
  const auto labelling = Segment(scan, WithoutGround());
  EXPECT_EQ(labelling.is_sure.size(), 1U);
  EXPECT_EQ(LabelAt(scan, labelling, 357, 1), 1);
}

TEST(DepthClustering, EndsOfAPartialTurnAreNoNeighbours) {
  auto scan = EmptyScan({.num_columns = 90, .num_rings = 4, .width_rad = DegToRad(90.0)});
  SetReturn(scan, 0, 1, 10.0);
  SetReturn(scan, 89, 1, 10.0);
  auto params = WithoutGround();
  params.reach_columns = 4;
  EXPECT_EQ(Segment(scan, params).is_sure.size(), 2U);
}

TEST(DepthClustering, LooksAtAllReturnsOfADualShot) {
  auto scan = Turn(4, 2);
  SetPatch(scan, 10, 14, 1, 1, 30.0, 0);
  SetPatch(scan, 10, 14, 1, 1, 10.0, 1);
  SetPatch(scan, 20, 20, 1, 1, 10.0, 0);
  SetPatch(scan, 20, 20, 1, 1, 10.0, 1);
  const auto labelling = Segment(scan, WithoutGround());
  EXPECT_EQ(labelling.is_sure.size(), 3U);
  EXPECT_EQ(LabelAt(scan, labelling, 10, 1, 0), LabelAt(scan, labelling, 14, 1, 0));
  EXPECT_EQ(LabelAt(scan, labelling, 10, 1, 1), LabelAt(scan, labelling, 14, 1, 1));
  EXPECT_NE(LabelAt(scan, labelling, 10, 1, 0), LabelAt(scan, labelling, 10, 1, 1));
  EXPECT_EQ(LabelAt(scan, labelling, 20, 1, 0), LabelAt(scan, labelling, 20, 1, 1));
}

TEST(DepthGround, FillsAPixelBetweenTwoThatAgree) {
  auto image = Column({10.0F, 0.0F, 10.5F, 0.0F, 12.0F});
  FillGaps(image, {});
  EXPECT_FLOAT_EQ(image.range_m[1], 10.25F);
  EXPECT_FLOAT_EQ(image.range_m[3], 0.0F);  // 10.5 and 12 m do not
}

TEST(DepthGround, SlopeIsZeroOnAPlaneAndARightAngleOnAWall) {
  std::vector<float> range_m;
  for (int ring = 0; ring < 4; ++ring) range_m.push_back(static_cast<float>(1.0 / std::sin(DegToRad(15.0 - 2.0 * ring))));
  auto params = DepthGroundParams{};
  for (const double slope_rad : SlopesOf(Column(range_m), params)) EXPECT_NEAR(slope_rad, 0.0, 1e-6);

  range_m.clear();
  for (int ring = 0; ring < 15; ++ring) range_m.push_back(static_cast<float>(8.0 / std::cos(DegToRad(15.0 - 2.0 * ring))));
  const auto slope_rad = SlopesOf(Column(range_m), params);
  EXPECT_NEAR(slope_rad[4], kPi / 2.0, 1e-3);
  // The top ring has no slope; the filter's weight there is 59 / 231.
  EXPECT_NEAR(slope_rad[14], kPi / 2.0 * (1.0 - 59.0 / 231.0), 1e-3);
}

TEST(DepthGround, TakesAPlaneForGroundAndLeavesTheWallBehindIt) {
  const auto scan = PlaneAndWall();
  DepthClusteringParams params;
  const auto labelling = Segment(scan, params);
  // Above them the filter, made for 64 rings, mixes wall and plane.
  for (const int ring : {0, 1, 2}) EXPECT_EQ(LabelAt(scan, labelling, 90, ring), 0) << ring;
  EXPECT_GT(LabelAt(scan, labelling, 90, 12), 0);
  EXPECT_EQ(LabelAt(scan, labelling, 90, 12), LabelAt(scan, labelling, 270, 12));
  params.ground.reset();
  EXPECT_GT(LabelAt(scan, Segment(scan, params), 90, 0), 0);
}

TEST(DepthGround, OfASingleRingIsWellDefined) {
  auto scan = Turn(1);
  SetPatch(scan, 10, 40, 0, 0, 10.0);
  // A single ring has no slope, so all of it is ground.
  EXPECT_EQ(Segment(scan, DepthClusteringParams{}).is_sure.size(), 0U);
}

}  // namespace
}  // namespace lookout::eval
