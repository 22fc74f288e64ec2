#include "lab/eval/baselines/euclidean.hpp"

#include <gtest/gtest.h>

#include "tests/unit/eval_baselines/labels.hpp"

namespace lookout::eval {
namespace {

using namespace test;

Labelling Segment(const segmenter::Scan& scan, double distance_m, SizeLimits limits = {}, const segmenter::ReturnFilter& filter = {}) {
  return Peer("Euclidean", filter, limits, EuclideanGrouping(distance_m)).Segment(scan);
}

TEST(EuclideanClustering, OfAnEmptyTurnIsEmpty) {
  const auto scan = Turn();
  const auto labelling = Segment(scan, 1.0);
  EXPECT_EQ(labelling.label, std::vector<std::int32_t>(scan.num_cells(), 0));
  EXPECT_TRUE(labelling.is_sure.empty());
}

TEST(EuclideanClustering, ASingleReturnIsASegment) {
  auto scan = Turn();
  SetReturn(scan, 17, 2, 10.0);
  const auto labelling = Segment(scan, 1.0);
  EXPECT_EQ(LabelAt(scan, labelling, 17, 2), 1);
  EXPECT_EQ(std::ranges::count(labelling.label, 0), static_cast<std::ptrdiff_t>(scan.num_cells()) - 1);
  EXPECT_EQ(labelling.is_sure, std::vector<bool>{true});
}

TEST(EuclideanClustering, JoinsWhatIsNearAndPartsWhatIsApart) {
  // At 10 m neighbouring columns are 0.1745 m apart, so a gap of 5 columns is 2 * 10 * sin(2.5 deg) = 0.872 m.
  auto scan = Turn();
  SetPatch(scan, 10, 15, 1, 1, 10.0);
  SetPatch(scan, 20, 25, 1, 1, 10.0);
  const auto one = Segment(scan, 0.88);
  EXPECT_EQ(LabelAt(scan, one, 10, 1), 1);
  EXPECT_EQ(LabelAt(scan, one, 25, 1), 1);
  const auto two = Segment(scan, 0.86);
  EXPECT_EQ(LabelAt(scan, two, 15, 1), 1);
  EXPECT_EQ(LabelAt(scan, two, 20, 1), 2);
  EXPECT_EQ(two.is_sure.size(), 2U);
}

TEST(EuclideanClustering, HasNoSeamAtZero) {
  auto scan = Turn();
  SetPatch(scan, -3, 3, 1, 1, 10.0);
  const auto labelling = Segment(scan, 0.2);
  EXPECT_EQ(labelling.is_sure.size(), 1U);
  EXPECT_EQ(LabelAt(scan, labelling, 357, 1), LabelAt(scan, labelling, 3, 1));
}

TEST(EuclideanClustering, LeavesOutWhatIsTooSmallOrTooLarge) {
  auto scan = Turn();
  SetPatch(scan, 10, 10, 1, 1, 10.0);
  SetPatch(scan, 100, 102, 1, 1, 10.0);
  SetPatch(scan, 200, 209, 1, 1, 10.0);
  const auto labelling = Segment(scan, 0.2, {2, 9});
  EXPECT_EQ(LabelAt(scan, labelling, 10, 1), 0);
  EXPECT_EQ(LabelAt(scan, labelling, 101, 1), 1);
  EXPECT_EQ(LabelAt(scan, labelling, 205, 1), 0);
  EXPECT_EQ(labelling.is_sure.size(), 1U);
}

TEST(EuclideanClustering, LooksAtWhatTheFilterLeaves) {
  auto scan = Turn();
  SetReturn(scan, 0, 1, 1.0);
  SetReturn(scan, 0, 2, 20.0);
  segmenter::ReturnFilter filter;
  filter.own_vessel_box_m = {Eigen::Vector3d(-2.0, -2.0, -2.0), Eigen::Vector3d(2.0, 2.0, 2.0)};
  const auto labelling = Segment(scan, 0.5, {}, filter);
  EXPECT_EQ(LabelAt(scan, labelling, 0, 1), 0);
  EXPECT_EQ(LabelAt(scan, labelling, 0, 2), 1);
}

TEST(EuclideanClustering, GivesBothReturnsOfADualShotALabel) {
  auto scan = Turn(4, 2);
  SetReturn(scan, 5, 1, 10.0, 0);
  SetReturn(scan, 5, 1, 10.0, 1);  // the same echo once more
  SetReturn(scan, 9, 1, 30.0, 0);
  SetReturn(scan, 9, 1, 20.0, 1);
  const auto labelling = Segment(scan, 1.0);
  EXPECT_EQ(LabelAt(scan, labelling, 5, 1, 0), 1);
  EXPECT_EQ(LabelAt(scan, labelling, 5, 1, 1), 1);
  EXPECT_EQ(LabelAt(scan, labelling, 9, 1, 0), 2);
  EXPECT_EQ(LabelAt(scan, labelling, 9, 1, 1), 3);
}

TEST(EuclideanClustering, NamesItsStages) {
  const auto labelling = Segment(Turn(), 1.0);
  ASSERT_EQ(labelling.stages.size(), 4U);
  EXPECT_EQ(labelling.stages[0].first, "returns");
  EXPECT_EQ(labelling.stages[2].first, "clusters");
}

}  // namespace
}  // namespace lookout::eval
