// The judge is judged: answers worked out by hand, laws, and an obvious computation over random labels.
#include "tools/eval/scoring.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numeric>
#include <set>

#include "tools/sim/random.hpp"

namespace lookout::eval {
namespace {

constexpr double kRangeUnitM = 0.002;

struct Cell {
  std::int32_t object;
  std::int32_t label;
  double range_m = 20.0;
};

struct Case {
  LabelledScan truth;
  Labelling labelling;
};

// Objects 1, 2, ... are kayaks (odd) and docks (even).
Case MakeCase(const std::vector<Cell>& cells) {
  Case one;
  one.truth.scan.head.range_unit_m = kRangeUnitM;
  for (const auto& cell : cells) {
    one.truth.scan.columns.range.push_back(static_cast<std::uint16_t>(std::lround(cell.range_m / kRangeUnitM)));
    one.truth.object.push_back(cell.object);
    one.labelling.label.push_back(cell.label);
    if (cell.object <= 0) continue;
    const bool is_kayak = cell.object % 2 == 1;
    one.truth.objects[cell.object] = {"object", is_kayak ? "kayak" : "dock", is_kayak};
  }
  return one;
}

Score ScoreOf(const std::vector<Cell>& cells) {
  const auto one = MakeCase(cells);
  return ScoreTurn(one.truth, one.labelling);
}

void AddCells(std::vector<Cell>& cells, int count, Cell cell) { cells.insert(cells.end(), static_cast<std::size_t>(count), cell); }

TEST(Scoring, PerfectLabelsGiveOneHundred) {
  std::vector<Cell> cells;
  AddCells(cells, 40, {1, 7});
  AddCells(cells, 5, {2, 3});
  AddCells(cells, 1, {3, 1});
  AddCells(cells, 6, {kNoTrueObject, 0});
  const auto score = ScoreOf(cells);
  EXPECT_DOUBLE_EQ(MeanIou(score), 1.0);
  EXPECT_DOUBLE_EQ(MeanWaterIou(score), 1.0);
  EXPECT_DOUBLE_EQ(MeanSureIou(score), 1.0);
  EXPECT_DOUBLE_EQ(TruePositiveRatio(score), 1.0);
  EXPECT_EQ(score.num_segments, 3);
  EXPECT_EQ(score.num_false_segments, 0);
  EXPECT_EQ(score.num_over_segmented, 0);
  EXPECT_EQ(score.num_under_segmented, 0);
  EXPECT_EQ(score.num_object_turns, 3);
}

TEST(Scoring, AllInOneGivesEachObjectItsShareOfAll) {
  // 60 + 30 + 10 returns of objects and 20 strays in one segment of 120: the IoUs are 60, 30 and 10 of 120.
  std::vector<Cell> cells;
  AddCells(cells, 60, {1, 1});
  AddCells(cells, 30, {2, 1});
  AddCells(cells, 10, {3, 1});
  AddCells(cells, 20, {kNoTrueObject, 1});
  const auto score = ScoreOf(cells);
  EXPECT_DOUBLE_EQ(MeanIou(score), (60.0 + 30.0 + 10.0) / 120.0 / 3.0);
  EXPECT_DOUBLE_EQ(MeanWaterIou(score), (60.0 + 10.0) / 120.0 / 2.0) << "objects 1 and 3 are in the water";
  EXPECT_DOUBLE_EQ(TruePositiveRatio(score), 0.6) << "the segment belongs to object 1";
  EXPECT_EQ(score.num_under_segmented, 1);
  EXPECT_EQ(score.num_over_segmented, 0);
  EXPECT_EQ(score.num_false_segments, 0);
}

TEST(Scoring, AllApartGivesOneThroughTheReturnsOfTheObject) {
  // Objects of 4 and 20 returns, each return a segment by itself: 1/4 and 1/20. Two strays are two false segments.
  std::vector<Cell> cells;
  std::int32_t label = 0;
  for (int i = 0; i < 4; ++i) cells.push_back({1, ++label});
  for (int i = 0; i < 20; ++i) cells.push_back({2, ++label});
  for (int i = 0; i < 2; ++i) cells.push_back({kNoTrueObject, ++label});
  const auto score = ScoreOf(cells);
  EXPECT_DOUBLE_EQ(MeanIou(score), (1.0 / 4.0 + 1.0 / 20.0) / 2.0);
  EXPECT_DOUBLE_EQ(TruePositiveRatio(score), 1.0);
  EXPECT_EQ(score.num_segments, 26);
  EXPECT_EQ(score.num_false_segments, 2);
  EXPECT_EQ(score.num_over_segmented, 1) << "each part of object 1 is a quarter; those of object 2 are a twentieth, too small to count";
  EXPECT_EQ(score.num_under_segmented, 0);
}

TEST(Scoring, ReturnsInNoSegmentLowerIouAndTruePositives) {
  std::vector<Cell> cells;
  AddCells(cells, 6, {1, 1});
  AddCells(cells, 4, {1, 0});
  const auto score = ScoreOf(cells);
  EXPECT_DOUBLE_EQ(MeanIou(score), 0.6);
  EXPECT_DOUBLE_EQ(TruePositiveRatio(score), 0.6);
}

TEST(Scoring, ObjectInNoSegmentCountsWithZero) {
  std::vector<Cell> cells;
  AddCells(cells, 6, {1, 1});
  AddCells(cells, 4, {2, 0});
  EXPECT_DOUBLE_EQ(MeanIou(ScoreOf(cells)), 0.5);
}

TEST(Scoring, OwnVesselAndStraysAreNoObjectsButLowerIou) {
  std::vector<Cell> cells;
  AddCells(cells, 6, {1, 1});
  AddCells(cells, 3, {kOwnVesselObject, 1});
  AddCells(cells, 1, {kNoTrueObject, 1});
  AddCells(cells, 2, {kOwnVesselObject, 2});
  const auto score = ScoreOf(cells);
  EXPECT_EQ(score.num_object_turns, 1);
  EXPECT_DOUBLE_EQ(MeanIou(score), 0.6);
  EXPECT_EQ(score.num_false_segments, 1) << "the own boat as an obstacle is false";
}

TEST(Scoring, SegmentThatStraysLeadGivesNoTruePositives) {
  std::vector<Cell> cells;
  AddCells(cells, 3, {1, 1});
  AddCells(cells, 4, {kNoTrueObject, 1});
  AddCells(cells, 3, {2, 2});
  AddCells(cells, 3, {kOwnVesselObject, 2});
  EXPECT_DOUBLE_EQ(TruePositiveRatio(ScoreOf(cells)), 0.5) << "of equals the object leads";
}

TEST(Scoring, TentativeSegmentsCountApart) {
  auto one = MakeCase({{1, 1}, {1, 1}, {3, 2}, {kNoTrueObject, 3}, {kNoTrueObject, 4}});
  one.labelling.is_sure = {true, false, true, false};
  const auto score = ScoreTurn(one.truth, one.labelling);
  EXPECT_DOUBLE_EQ(MeanIou(score), 1.0);
  EXPECT_DOUBLE_EQ(MeanSureIou(score), 0.5);
  EXPECT_EQ(score.num_false_segments, 2);
  EXPECT_EQ(score.num_sure_false_segments, 1);
}

TEST(Scoring, ReturnsThatAreNotJudgedDoNotCountAnywhere) {
  std::vector<Cell> cells;
  AddCells(cells, 6, {1, 1});
  AddCells(cells, 9, {1, kNotJudged});
  AddCells(cells, 9, {2, kNotJudged});
  const auto score = ScoreOf(cells);
  EXPECT_DOUBLE_EQ(MeanIou(score), 1.0);
  EXPECT_EQ(score.num_object_turns, 1);
  EXPECT_EQ(score.num_returns, 6);
  EXPECT_EQ(score.num_not_judged, 18);
}

TEST(Scoring, CellsWithoutReturnDoNotCount) {
  auto one = MakeCase({{1, 1}, {1, 1}, {2, 1}});
  one.truth.scan.columns.range[2] = 0;
  const auto score = ScoreTurn(one.truth, one.labelling);
  EXPECT_EQ(score.num_object_turns, 1);
  EXPECT_DOUBLE_EQ(MeanIou(score), 1.0);
}

TEST(Scoring, OpenWaterHasNoIou) {
  const auto score = ScoreOf({{kNoTrueObject, 1}, {kNoTrueObject, 0}});
  EXPECT_EQ(score.num_turns_with_object, 0);
  EXPECT_TRUE(std::isnan(MeanIou(score)));
  EXPECT_DOUBLE_EQ(FalseSegmentsPerTurn(score), 1.0);
  EXPECT_TRUE(std::isnan(MeanIou(ScoreOf({}))));
}

TEST(Scoring, RangeIsThatOfTheNearestReturn) {
  const auto score = ScoreOf({{1, 1, 35.0}, {1, 1, 9.9}, {2, 0, 10.1}});
  EXPECT_EQ(score.recall_by_range.at(0), std::pair(std::int64_t{1}, std::int64_t{1}));
  EXPECT_EQ(score.recall_by_range.at(1), std::pair(std::int64_t{1}, std::int64_t{0}));
  EXPECT_EQ(score.recall_by_range.size(), 2U);
  EXPECT_DOUBLE_EQ(score.iou_by_kind.at("kayak").second, 1.0);
  EXPECT_DOUBLE_EQ(score.iou_by_kind.at("dock").second, 0.0);
}

TEST(Scoring, WhatIsNearIsCountedByKindAtAnyConfidenceAndAtSure) {
  // Kayaks 1 and 3 are near, 5 lies just beyond 25 m; dock 2 is near by its nearest return. Segment 3 is tentative.
  auto one = MakeCase({{1, 1, 10.0}, {3, 3, 24.9}, {5, 5, 25.1}, {2, 2, 60.0}, {2, 0, 60.0}, {2, 0, 5.0}});
  one.labelling.is_sure = {true, true, false, true, true};
  const auto score = ScoreTurn(one.truth, one.labelling);
  ASSERT_EQ(score.near_recall_by_kind.size(), 2U);
  const auto& kayaks = score.near_recall_by_kind.at("kayak");
  EXPECT_EQ(kayaks.num_object_turns, 2);
  EXPECT_EQ(kayaks.num_found, 2);
  EXPECT_EQ(kayaks.num_surely_found, 1);
  const auto& docks = score.near_recall_by_kind.at("dock");
  EXPECT_EQ(docks.num_object_turns, 1);
  EXPECT_EQ(docks.num_found, 0) << "a third of it";
  EXPECT_DOUBLE_EQ(MeanWaterIou(score), 1.0);
  EXPECT_DOUBLE_EQ(MeanSureWaterIou(score), 2.0 / 3.0);
  EXPECT_EQ(score.iou_by_kind.at("kayak"), std::pair(std::int64_t{3}, 3.0));
  EXPECT_EQ(score.sure_iou_by_kind.at("kayak"), std::pair(std::int64_t{3}, 2.0));
  EXPECT_EQ(score.recall_by_range.at(2), std::pair(std::int64_t{2}, std::int64_t{2}));
  EXPECT_EQ(score.sure_recall_by_range.at(2), std::pair(std::int64_t{2}, std::int64_t{1}));
  Score total = score;
  total.Add(score);
  EXPECT_EQ(total.near_recall_by_kind.at("kayak").num_surely_found, 2);
  EXPECT_EQ(total.near_recall_by_kind.at("kayak").num_found, 4);
  EXPECT_EQ(total.sure_recall_by_range.at(2).second, 2);
  EXPECT_EQ(total.sure_iou_by_kind.at("kayak").second, 4.0);
}

TEST(Scoring, ComponentsAreAMeanOverTheTurnsThatHaveThem) {
  auto one = MakeCase({{1, 1}});
  EXPECT_TRUE(std::isnan(ComponentsPerTurn(ScoreTurn(one.truth, one.labelling))));
  one.labelling.num_components = 3;
  Score total = ScoreTurn(one.truth, one.labelling);
  one.labelling.num_components = 4;
  total.Add(ScoreTurn(one.truth, one.labelling));
  EXPECT_DOUBLE_EQ(ComponentsPerTurn(total), 3.5);
}

TEST(Scoring, HalfIsFound) {
  std::vector<Cell> cells;
  AddCells(cells, 5, {1, 1});
  AddCells(cells, 5, {1, 0});
  EXPECT_EQ(ScoreOf(cells).recall_by_range.at(2).second, 1);
}

TEST(Scoring, ScoresAddUp) {
  Score total = ScoreOf({{1, 1}, {1, 1}});
  total.Add(ScoreOf({{1, 1}, {1, 0}, {kNoTrueObject, 2}}));
  total.Add(ScoreOf({{kNoTrueObject, 2}}));
  EXPECT_EQ(total.num_turns, 3);
  EXPECT_DOUBLE_EQ(MeanIou(total), 0.75) << "the turn without objects has no IoU";
  EXPECT_DOUBLE_EQ(FalseSegmentsPerTurn(total), 2.0 / 3.0);
  EXPECT_EQ(total.iou_by_kind.at("kayak"), std::pair(std::int64_t{2}, 1.5));
}

TEST(Scoring, LabelsThatDoNotFitTheCellsAreRefused) {
  auto one = MakeCase({{1, 1}, {1, 1}});
  one.labelling.label.pop_back();
  EXPECT_THROW(ScoreTurn(one.truth, one.labelling), std::logic_error);
}

// --- laws over random labels ---

Case RandomCase(std::uint64_t seed) {
  sim::Random random(seed, 0);
  const auto below = [&random](int count) { return static_cast<std::int32_t>(random.Uniform() * count); };
  std::vector<Cell> cells;
  const int num_cells = 1 + below(200);
  const int num_objects = 1 + below(6);
  const int num_labels = 1 + below(12);
  for (int i = 0; i < num_cells; ++i) {
    cells.push_back({below(num_objects + 2) - 1, below(num_labels + 2) - 1, random.Uniform(0.5, 100.0)});
    if (below(10) == 0) cells.back().range_m = 0.0;
  }
  auto one = MakeCase(cells);
  for (int i = 0; i < num_labels; ++i) one.labelling.is_sure.push_back(below(3) > 0);
  return one;
}

// The definitions as they stand in scoring.hpp, counted cell by cell for each pair of object and segment.
struct Obvious {
  double iou = 0.0;
  double sure_iou = 0.0;
  double water_iou = 0.0;
  int num_objects = 0;
  int num_found = 0;
  int num_near = 0;
  int num_near_found = 0;
  int num_near_surely_found = 0;
  int num_segments = 0;
  int num_false = 0;
  int num_over = 0;
  int num_under = 0;
  int num_true_positives = 0;
};

double NearestM(const Case& one, int object) {
  double nearest_m = 1e9;
  for (std::size_t cell = 0; cell < one.truth.object.size(); ++cell) {
    if (one.truth.object[cell] != object || one.labelling.label[cell] == kNotJudged || one.truth.scan.columns.range[cell] == 0) continue;
    nearest_m = std::min(nearest_m, one.truth.scan.columns.range[cell] * kRangeUnitM);
  }
  return nearest_m;
}

Obvious Compute(const Case& one) {
  const auto& label = one.labelling.label;
  const auto& object = one.truth.object;
  const auto count = [&](auto of) {
    int number = 0;
    for (std::size_t cell = 0; cell < label.size(); ++cell) {
      if (one.truth.scan.columns.range[cell] != 0 && label[cell] != kNotJudged && of(object[cell], label[cell])) ++number;
    }
    return number;
  };
  const auto both = [&](int i, int j) { return count([=](int o, int l) { return o == i && l == j; }); };
  const auto of_object = [&](int i) { return count([=](int o, int) { return o == i; }); };
  const auto of_segment = [&](int j) { return count([=](int, int l) { return l == j; }); };
  std::set<int> objects;
  std::set<int> segments;
  for (int i = 1; i <= 6; ++i) {
    if (of_object(i) > 0) objects.insert(i);
  }
  for (int j = 1; j <= 12; ++j) {
    if (of_segment(j) > 0) segments.insert(j);
  }
  Obvious result;
  int num_water = 0;
  for (const int i : objects) {
    double best = 0.0;
    double best_sure = 0.0;
    int num_parts = 0;
    for (const int j : segments) {
      const double iou = static_cast<double>(both(i, j)) / (of_object(i) + of_segment(j) - both(i, j));
      best = std::max(best, iou);
      if (one.labelling.is_sure[static_cast<std::size_t>(j - 1)]) best_sure = std::max(best_sure, iou);
      if (both(i, j) > 0 && 10 * both(i, j) >= of_object(i)) ++num_parts;
    }
    result.iou += best / static_cast<double>(objects.size());
    result.sure_iou += best_sure / static_cast<double>(objects.size());
    if (i % 2 == 1) {
      result.water_iou += best;
      ++num_water;
    }
    if (best >= 0.5) ++result.num_found;
    if (NearestM(one, i) < 25.0) {
      ++result.num_near;
      if (best >= 0.5) ++result.num_near_found;
      if (best_sure >= 0.5) ++result.num_near_surely_found;
    }
    if (num_parts >= 2) ++result.num_over;
  }
  if (num_water > 0) result.water_iou /= num_water;
  result.num_objects = static_cast<int>(objects.size());
  for (const int j : segments) {
    int most = 0;
    int num_parts = 0;
    for (const int i : objects) {
      most = std::max(most, both(i, j));
      if (both(i, j) > 0 && 10 * both(i, j) >= of_object(i)) ++num_parts;
    }
    if (most == 0) ++result.num_false;
    if (num_parts >= 2) ++result.num_under;
    if (most >= both(kOwnVesselObject, j) && most >= both(kNoTrueObject, j)) result.num_true_positives += most;
  }
  result.num_segments = static_cast<int>(segments.size());
  return result;
}

TEST(Scoring, AgreesWithAnObviousComputationOnRandomLabels) {
  constexpr std::uint64_t kNumCases = 600;
  for (std::uint64_t seed = 1; seed <= kNumCases; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const auto one = RandomCase(seed);
    const auto score = ScoreTurn(one.truth, one.labelling);
    const auto expected = Compute(one);
    EXPECT_EQ(score.num_object_turns, expected.num_objects);
    EXPECT_NEAR(score.sum_iou, expected.iou, 1e-12);
    EXPECT_NEAR(score.sum_sure_iou, expected.sure_iou, 1e-12);
    EXPECT_NEAR(score.sum_water_iou, expected.water_iou, 1e-12);
    EXPECT_EQ(score.num_segments, expected.num_segments);
    EXPECT_EQ(score.num_false_segments, expected.num_false);
    EXPECT_EQ(score.num_over_segmented, expected.num_over);
    EXPECT_EQ(score.num_under_segmented, expected.num_under);
    EXPECT_EQ(score.num_labelled_returns, expected.num_true_positives);
    std::int64_t num_found = 0;
    for (const auto& [bin, recall] : score.recall_by_range) num_found += recall.second;
    EXPECT_EQ(num_found, expected.num_found);
    Score::Recall near;
    for (const auto& [kind, recall] : score.near_recall_by_kind) {
      near.num_object_turns += recall.num_object_turns;
      near.num_found += recall.num_found;
      near.num_surely_found += recall.num_surely_found;
    }
    EXPECT_EQ(near.num_object_turns, expected.num_near);
    EXPECT_EQ(near.num_found, expected.num_near_found);
    EXPECT_EQ(near.num_surely_found, expected.num_near_surely_found);
    if (HasFailure()) break;
  }
}

TEST(Scoring, ShuffledIdsChangeNothing) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    auto one = RandomCase(seed);
    const auto before = ScoreTurn(one.truth, one.labelling);
    // Ids are dealt anew, with gaps between them.
    const std::size_t num_labels = one.labelling.is_sure.size();
    std::vector<std::int32_t> new_id(num_labels);
    std::iota(new_id.begin(), new_id.end(), 0);
    sim::Random random(seed, 1);
    for (std::size_t i = num_labels; i > 1; --i)
      std::swap(new_id[i - 1], new_id[static_cast<std::size_t>(random.Uniform() * static_cast<double>(i))]);
    std::vector<bool> is_sure(3 * num_labels, false);
    for (auto& id : new_id) id = 3 * id + 2;
    for (std::size_t i = 0; i < num_labels; ++i) is_sure[static_cast<std::size_t>(new_id[i] - 1)] = one.labelling.is_sure[i];
    for (auto& label : one.labelling.label) {
      if (label > 0) label = new_id[static_cast<std::size_t>(label - 1)];
    }
    one.labelling.is_sure = is_sure;
    const auto after = ScoreTurn(one.truth, one.labelling);
    EXPECT_DOUBLE_EQ(after.sum_iou, before.sum_iou);
    EXPECT_DOUBLE_EQ(after.sum_sure_iou, before.sum_sure_iou);
    EXPECT_DOUBLE_EQ(after.sum_water_iou, before.sum_water_iou);
    EXPECT_EQ(after.num_segments, before.num_segments);
    EXPECT_EQ(after.num_false_segments, before.num_false_segments);
    EXPECT_EQ(after.num_sure_false_segments, before.num_sure_false_segments);
    EXPECT_EQ(after.num_over_segmented, before.num_over_segmented);
    EXPECT_EQ(after.num_under_segmented, before.num_under_segmented);
    EXPECT_EQ(after.num_labelled_returns, before.num_labelled_returns);
    EXPECT_EQ(after.recall_by_range, before.recall_by_range);
  }
}

}  // namespace
}  // namespace lookout::eval
