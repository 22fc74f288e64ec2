// Stated probabilities: thresholds and reliability, worked out by hand.
#include "lab/eval/methods/confidence.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "tests/unit/eval/scoring_case.hpp"

namespace lookout::eval {
namespace {

// Two things with a segment each, one that has none, and two false segments.
Score ScoreWithProbabilities() {
  std::vector<Cell> cells;
  AddCells(cells, 5, {1, 1});
  AddCells(cells, 5, {2, 2});
  AddCells(cells, 5, {3, 0});
  AddCells(cells, 1, {kNoTrueObject, 3});
  AddCells(cells, 1, {kNoTrueObject, 4});
  auto one = MakeCase(cells);
  one.labelling.is_sure = {true, true, true, true};
  one.labelling.probability = {{1.0, 0.55, 0.52, 0.004}};
  return ScoreScan(one.truth, one.labelling);
}

OperatingPoint At(const Confidence& confidence, double threshold) {
  const auto points = OperatingPointsOf(confidence);
  const auto found = std::ranges::find(points, threshold, &OperatingPoint::threshold);
  EXPECT_NE(found, points.end()) << threshold;
  return found == points.end() ? OperatingPoint{} : *found;
}

TEST(OperatingPoints, LeaveOutWhatIsBelowTheThreshold) {
  auto score = ScoreWithProbabilities();
  score.Add(ScoreWithProbabilities());
  const auto& confidence = score.confidence;
  EXPECT_DOUBLE_EQ(At(confidence, 0.0).recall, 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(At(confidence, 0.0).recall, score.with_segment.value()) << "with all segments it is the figure of the tables";
  EXPECT_DOUBLE_EQ(At(confidence, 0.0).false_segments, 2.0);
  EXPECT_DOUBLE_EQ(At(confidence, 0.5).false_segments, 1.0);
  EXPECT_DOUBLE_EQ(At(confidence, 0.5).recall, 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(At(confidence, 0.6).recall, 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(At(confidence, 0.6).false_segments, 0.0);
  EXPECT_DOUBLE_EQ(At(confidence, 0.999).recall, 1.0 / 3.0);
}

TEST(Reliability, HasTenBinsAndOneIsInTheLast) {
  const auto bins = ReliabilityOf(ScoreWithProbabilities().confidence);
  ASSERT_EQ(bins.size(), 10U);
  EXPECT_EQ(bins[0].count, 1);
  EXPECT_DOUBLE_EQ(bins[0].observed, 0.0);
  EXPECT_EQ(bins[5].count, 2);
  EXPECT_NEAR(bins[5].stated, 0.535, 1e-12);
  EXPECT_DOUBLE_EQ(bins[5].observed, 0.5);
  EXPECT_EQ(bins[9].count, 1);
  EXPECT_DOUBLE_EQ(bins[9].stated, 1.0);
  EXPECT_TRUE(std::isnan(bins[3].stated));
}

TEST(Confidence, IsEmptyWithoutProbabilitiesAndOfTheSureOnesAlone) {
  auto one = MakeCase({{1, 1}, {3, 2}});
  EXPECT_EQ(ScoreScan(one.truth, one.labelling).confidence, Confidence{});
  one.labelling.is_sure = {true, false};
  one.labelling.probability = {{0.9, 0.1}};
  EXPECT_EQ(ScoreScan(one.truth, SureOnly(one.labelling)).confidence, Confidence{});
  EXPECT_TRUE(OperatingPointsOf({}).empty());
  EXPECT_TRUE(ReliabilityOf({}).empty());
}

}  // namespace
}  // namespace lookout::eval
