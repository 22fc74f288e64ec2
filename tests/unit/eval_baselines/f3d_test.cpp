#include "lab/eval/baselines/f3d.hpp"

#include <gtest/gtest.h>

#include "lab/eval/baselines/peers.hpp"
#include "tests/unit/eval_baselines/labels.hpp"

namespace lookout::eval {
namespace {

using namespace test;

F3dParams F3dWithoutGround() {
  F3dParams params;
  params.ground.reset();
  return params;
}

Labelling Segment(const segmenter::Scan& scan, const F3dParams& params) {
  return Peer("F3D", {}, {}, F3dGrouping(params, segmenter::ReturnFilter{}.T_vessel_lidar)).Segment(scan);
}

TEST(F3d, OfAnEmptyTurnIsEmpty) {
  const auto scan = Turn();
  for (const auto& params : {F3dWithoutGround(), F3dParams{}}) {
    EXPECT_EQ(Segment(scan, params).label, std::vector<std::int32_t>(scan.num_cells(), 0));
  }
}

TEST(F3d, ASingleReturnIsASegmentUnlessGroundIsSought) {
  auto scan = Turn();
  SetReturn(scan, 17, 2, 10.0);
  EXPECT_EQ(LabelAt(scan, Segment(scan, F3dWithoutGround()), 17, 2), 1);
  // The lowest point is the ground's height, so it is ground: too few for a plane, but a seed.
  EXPECT_EQ(LabelAt(scan, Segment(scan, F3dParams{}), 17, 2), 0);
}

TEST(F3d, RunsEndWhereSuccessiveReturnsAreFarApart) {
  // At 10 m: 0.1745 m from column to column; 3 columns 0.5236 m, 2 columns 0.349 m.
  auto scan = Turn();
  SetPatch(scan, 10, 12, 1, 1, 10.0);
  SetPatch(scan, 14, 15, 1, 1, 10.0);
  SetPatch(scan, 18, 19, 1, 1, 10.0);
  const auto labelling = Segment(scan, F3dWithoutGround());
  EXPECT_EQ(LabelAt(scan, labelling, 10, 1), 1);
  EXPECT_EQ(LabelAt(scan, labelling, 15, 1), 1);
  EXPECT_EQ(LabelAt(scan, labelling, 18, 1), 2);
  EXPECT_EQ(labelling.is_sure.size(), 2U);
}

TEST(F3d, MergesWithTheRingAboveAndWithNoneFurtherUp) {
  // Rings 2 degrees apart: 0.349 m at 10 m, 1.047 m at 30 m.
  auto scan = Turn();
  SetReturn(scan, 10, 1, 10.0);
  SetReturn(scan, 10, 2, 10.0);
  SetReturn(scan, 50, 1, 30.0);
  SetReturn(scan, 50, 2, 30.0);
  SetReturn(scan, 90, 1, 10.0);
  SetReturn(scan, 90, 3, 10.0);
  const auto labelling = Segment(scan, F3dWithoutGround());
  EXPECT_EQ(LabelAt(scan, labelling, 10, 1), LabelAt(scan, labelling, 10, 2));
  EXPECT_NE(LabelAt(scan, labelling, 50, 1), LabelAt(scan, labelling, 50, 2));
  EXPECT_NE(LabelAt(scan, labelling, 90, 1), LabelAt(scan, labelling, 90, 3));
  EXPECT_EQ(labelling.is_sure.size(), 5U);
}

TEST(F3d, ARunThatTouchesTwoLabelsUnitesThem) {
  // Two runs on ring 2, five columns (0.87 m) apart, and one on ring 1 below both.
  auto scan = Turn();
  SetPatch(scan, 10, 12, 2, 2, 10.0);
  SetPatch(scan, 17, 19, 2, 2, 10.0);
  EXPECT_EQ(Segment(scan, F3dWithoutGround()).is_sure.size(), 2U);
  SetPatch(scan, 10, 19, 1, 1, 10.0);
  EXPECT_EQ(Segment(scan, F3dWithoutGround()).is_sure.size(), 1U);
}

TEST(F3d, HasNoSeamAtZero) {
  auto scan = Turn();
  SetPatch(scan, -3, 3, 1, 1, 10.0);
  EXPECT_EQ(Segment(scan, F3dWithoutGround()).is_sure.size(), 1U);
}

TEST(F3d, ARunGoesOnThroughEitherReturnOfADualShot) {
  auto scan = Turn(4, 2);
  SetPatch(scan, 10, 14, 1, 1, 10.0, 0);
  SetReturn(scan, 12, 1, 30.0, 0);
  SetReturn(scan, 12, 1, 10.0, 1);
  const auto labelling = Segment(scan, F3dWithoutGround());
  EXPECT_EQ(labelling.is_sure.size(), 2U);
  EXPECT_EQ(LabelAt(scan, labelling, 10, 1, 0), LabelAt(scan, labelling, 14, 1, 0));
  EXPECT_EQ(LabelAt(scan, labelling, 12, 1, 1), LabelAt(scan, labelling, 10, 1, 0));
  EXPECT_NE(LabelAt(scan, labelling, 12, 1, 0), 0);
}

TEST(GroundPlane, IsWhatLiesNearATiltedPlaneAndBelow) {
  std::vector<Eigen::Vector3d> points_m;
  for (int x = 0; x < 10; ++x) {
    for (int y = 0; y < 10; ++y) points_m.emplace_back(x, y, 0.02 * x);
  }
  const auto num_plane = points_m.size();
  points_m.emplace_back(5.0, 5.0, 0.1 + 0.1);   // 0.1 m over the plane
  points_m.emplace_back(5.0, 5.0, 0.1 + 0.35);  // 0.35 m over it
  points_m.emplace_back(5.0, 5.0, 0.1 - 1.0);   // below: far enough to tilt the first guess a little, not to turn it
  const auto is_ground = FitGround(points_m, GroundPlaneParams{.num_segments = 1});
  EXPECT_EQ(std::count(is_ground.begin(), is_ground.begin() + static_cast<std::ptrdiff_t>(num_plane), true), 100);
  EXPECT_TRUE(is_ground[num_plane]);
  EXPECT_FALSE(is_ground[num_plane + 1]);
  EXPECT_TRUE(is_ground[num_plane + 2]);
}

TEST(GroundPlane, OfNoPointsIsEmpty) { EXPECT_TRUE(FitGround({}, {}).empty()); }

TEST(Peers, HaveNamesOfTheirOwnAndLabelEveryCell) {
  auto scan = Turn(16);
  SetPatch(scan, 10, 30, 4, 12, 10.0);
  std::vector<std::string> names;
  for (const auto& method : MakePeers({})) {
    names.push_back(method->name());
    const auto labelling = method->Segment(scan);
    EXPECT_EQ(labelling.label.size(), scan.num_cells()) << names.back();
    for (const auto label : labelling.label) EXPECT_LE(label, static_cast<std::int32_t>(labelling.is_sure.size())) << names.back();
    EXPECT_EQ(labelling.label, method->Segment(scan).label) << names.back();
  }
  std::ranges::sort(names);
  EXPECT_EQ(std::ranges::unique(names).size(), 0U);
  EXPECT_GE(names.size(), 7U);
}

}  // namespace
}  // namespace lookout::eval
