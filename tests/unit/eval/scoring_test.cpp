// Scores: answers worked out by hand.
#include "lab/eval/methods/scoring.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "tests/unit/eval/scoring_case.hpp"

namespace lookout::eval {
namespace {

TEST(Scoring, PerfectLabelsGiveOneHundred) {
  std::vector<Cell> cells;
  AddCells(cells, 40, {1, 7});
  AddCells(cells, 5, {2, 3});
  AddCells(cells, 1, {3, 1});
  AddCells(cells, 6, {kNoTrueObject, 0});
  const auto score = ScoreOf(cells);
  EXPECT_DOUBLE_EQ(score.iou.value(), 1.0);
  EXPECT_DOUBLE_EQ(score.water_iou.value(), 1.0);
  EXPECT_DOUBLE_EQ(score.true_positives.value(), 1.0);
  EXPECT_EQ(score.segments.sum, 3);
  EXPECT_EQ(score.false_segments.sum, 0);
  EXPECT_EQ(score.over_segmented.sum, 0);
  EXPECT_EQ(score.under_segmented.sum, 0);
  EXPECT_EQ(score.over_segmented.count, 3);
}

TEST(Scoring, AllInOneGivesEachObjectItsShareOfAll) {
  // 60 + 30 + 10 returns of objects and 20 strays in one segment of 120: the IoUs are 60, 30 and 10 of 120.
  std::vector<Cell> cells;
  AddCells(cells, 60, {1, 1});
  AddCells(cells, 30, {2, 1});
  AddCells(cells, 10, {3, 1});
  AddCells(cells, 20, {kNoTrueObject, 1});
  const auto score = ScoreOf(cells);
  EXPECT_DOUBLE_EQ(score.iou.value(), (60.0 + 30.0 + 10.0) / 120.0 / 3.0);
  EXPECT_DOUBLE_EQ(score.water_iou.value(), (60.0 + 10.0) / 120.0 / 2.0) << "objects 1 and 3 are in the water";
  EXPECT_DOUBLE_EQ(score.true_positives.value(), 0.6) << "the segment belongs to object 1";
  EXPECT_EQ(score.under_segmented.sum, 1);
  EXPECT_EQ(score.over_segmented.sum, 0);
  EXPECT_EQ(score.false_segments.sum, 0);
}

TEST(Scoring, AllApartGivesOneThroughTheReturnsOfTheObject) {
  // Objects of 4 and 20 returns, each return a segment by itself: 1/4 and 1/20. Two strays are two false segments.
  std::vector<Cell> cells;
  std::int32_t label = 0;
  for (int i = 0; i < 4; ++i) cells.push_back({1, ++label});
  for (int i = 0; i < 20; ++i) cells.push_back({2, ++label});
  for (int i = 0; i < 2; ++i) cells.push_back({kNoTrueObject, ++label});
  const auto score = ScoreOf(cells);
  EXPECT_DOUBLE_EQ(score.iou.value(), (1.0 / 4.0 + 1.0 / 20.0) / 2.0);
  EXPECT_DOUBLE_EQ(score.true_positives.value(), 1.0);
  EXPECT_EQ(score.segments.sum, 26);
  EXPECT_EQ(score.false_segments.sum, 2);
  EXPECT_EQ(score.over_segmented.sum, 1) << "each part of object 1 is a quarter; those of object 2 are a twentieth, too small to count";
  EXPECT_EQ(score.under_segmented.sum, 0);
}

TEST(Scoring, ReturnsInNoSegmentLowerIouAndTruePositives) {
  std::vector<Cell> cells;
  AddCells(cells, 6, {1, 1});
  AddCells(cells, 4, {1, 0});
  const auto score = ScoreOf(cells);
  EXPECT_DOUBLE_EQ(score.iou.value(), 0.6);
  EXPECT_DOUBLE_EQ(score.true_positives.value(), 0.6);
}

TEST(Scoring, ObjectInNoSegmentCountsWithZero) {
  std::vector<Cell> cells;
  AddCells(cells, 6, {1, 1});
  AddCells(cells, 4, {2, 0});
  EXPECT_DOUBLE_EQ(ScoreOf(cells).iou.value(), 0.5);
}

TEST(Scoring, OwnVesselAndStraysAreNoObjectsButLowerIou) {
  std::vector<Cell> cells;
  AddCells(cells, 6, {1, 1});
  AddCells(cells, 3, {kOwnVesselObject, 1});
  AddCells(cells, 1, {kNoTrueObject, 1});
  AddCells(cells, 2, {kOwnVesselObject, 2});
  const auto score = ScoreOf(cells);
  EXPECT_EQ(score.over_segmented.count, 1);
  EXPECT_DOUBLE_EQ(score.iou.value(), 0.6);
  EXPECT_EQ(score.false_segments.sum, 1) << "the own boat as an obstacle is false";
}

TEST(Scoring, SegmentThatStraysLeadGivesNoTruePositives) {
  std::vector<Cell> cells;
  AddCells(cells, 3, {1, 1});
  AddCells(cells, 4, {kNoTrueObject, 1});
  AddCells(cells, 3, {2, 2});
  AddCells(cells, 3, {kOwnVesselObject, 2});
  EXPECT_DOUBLE_EQ(ScoreOf(cells).true_positives.value(), 0.5) << "of equals the object leads";
}

TEST(Scoring, TentativeSegmentsAreAnOperatingPointOfTheirOwn) {
  auto one = MakeCase({{1, 1}, {1, 1}, {3, 2}, {kNoTrueObject, 3}, {kNoTrueObject, 4}});
  one.labelling.is_sure = {true, false, true, false};
  const auto all = ScoreScan(one.truth, one.labelling);
  EXPECT_DOUBLE_EQ(all.iou.value(), 1.0);
  EXPECT_EQ(all.false_segments.sum, 2);
  const auto sure = ScoreScan(one.truth, SureOnly(one.labelling));
  EXPECT_DOUBLE_EQ(sure.iou.value(), 0.5);
  EXPECT_EQ(sure.false_segments.sum, 1);
  EXPECT_EQ(sure.segments.sum, 2);
  EXPECT_DOUBLE_EQ(sure.true_positives.value(), 2.0 / 3.0);
}

TEST(Scoring, WhereNothingIsTentativeTheSureOnesAreAll) {
  auto one = MakeCase({{1, 1}, {3, 2}, {5, 0}, {5, kNotScored}});
  EXPECT_EQ(SureOnly(one.labelling).label, one.labelling.label) << "no word on it: all are sure";
  one.labelling.is_sure = {true, true};
  EXPECT_EQ(SureOnly(one.labelling).label, one.labelling.label);
}

TEST(Scoring, AThingHasASegmentWhenMoreThanHalfOfOneIsIts) {
  const auto things = [](int count, int of_others) {
    std::vector<Cell> cells;
    AddCells(cells, count, {1, 1});
    AddCells(cells, of_others, {kNoTrueObject, 1});
    return ScoreOf(cells);
  };
  EXPECT_EQ(things(4, 0).with_segment.count, 0) << "four returns are no thing";
  EXPECT_TRUE(std::isnan(things(4, 0).with_segment.value()));
  EXPECT_DOUBLE_EQ(things(5, 4).with_segment.value(), 1.0);
  EXPECT_DOUBLE_EQ(things(5, 5).with_segment.value(), 0.0) << "half is not more than half";
  // A piece of it is a segment that is its, however small.
  std::vector<Cell> cells;
  AddCells(cells, 9, {1, 0});
  AddCells(cells, 1, {1, 1});
  EXPECT_DOUBLE_EQ(ScoreOf(cells).with_segment.value(), 1.0);
  auto total = things(5, 4);
  total.Add(things(5, 5));
  EXPECT_DOUBLE_EQ(total.with_segment.value(), 0.5);
}

TEST(Scoring, ReturnsThatAreNotScoredDoNotCountAnywhere) {
  std::vector<Cell> cells;
  AddCells(cells, 6, {1, 1});
  AddCells(cells, 9, {1, kNotScored});
  AddCells(cells, 9, {2, kNotScored});
  const auto score = ScoreOf(cells);
  EXPECT_DOUBLE_EQ(score.iou.value(), 1.0);
  EXPECT_EQ(score.over_segmented.count, 1);
  EXPECT_EQ(score.true_positives.count, 6);
  EXPECT_EQ(score.num_not_scored, 18);
}

TEST(Scoring, CellsWithoutReturnDoNotCount) {
  auto one = MakeCase({{1, 1}, {1, 1}, {2, 1}});
  one.truth.scan.columns.range[2] = 0;
  const auto score = ScoreScan(one.truth, one.labelling);
  EXPECT_EQ(score.over_segmented.count, 1);
  EXPECT_DOUBLE_EQ(score.iou.value(), 1.0);
}

TEST(Scoring, OpenWaterHasNoIou) {
  const auto score = ScoreOf({{kNoTrueObject, 1}, {kNoTrueObject, 0}});
  EXPECT_EQ(score.iou.count, 0);
  EXPECT_TRUE(std::isnan(score.iou.value()));
  EXPECT_DOUBLE_EQ(score.false_segments.value(), 1.0);
  EXPECT_TRUE(std::isnan(ScoreOf({}).iou.value()));
}

TEST(Scoring, RangeIsThatOfTheNearestReturn) {
  const auto score = ScoreOf({{1, 1, 35.0}, {1, 1, 9.9}, {2, 0, 10.1}});
  EXPECT_EQ(score.recall_by_range.at(0), (Mean{1, 1.0}));
  EXPECT_EQ(score.recall_by_range.at(1), (Mean{1, 0.0}));
  EXPECT_EQ(score.recall_by_range.size(), 2U);
  EXPECT_DOUBLE_EQ(score.iou_by_kind.at("kayak").sum, 1.0);
  EXPECT_DOUBLE_EQ(score.iou_by_kind.at("dock").sum, 0.0);
}

TEST(Scoring, WhatIsNearIsCountedByKindAtEitherOperatingPoint) {
  // Kayaks 1 and 3 are near, 5 lies just beyond 25 m; dock 2 is near by its nearest return. Segment 3 is tentative.
  auto one = MakeCase({{1, 1, 10.0}, {3, 3, 24.9}, {5, 5, 25.1}, {2, 2, 60.0}, {2, 0, 60.0}, {2, 0, 5.0}});
  one.labelling.is_sure = {true, true, false, true, true};
  const auto score = ScoreScan(one.truth, one.labelling);
  const auto sure = ScoreScan(one.truth, SureOnly(one.labelling));
  ASSERT_EQ(score.near_recall_by_kind.size(), 2U);
  const auto& kayaks = score.near_recall_by_kind.at("kayak");
  EXPECT_EQ(kayaks.count, 2);
  EXPECT_EQ(kayaks.sum, 2);
  EXPECT_EQ(sure.near_recall_by_kind.at("kayak").count, 2);
  EXPECT_EQ(sure.near_recall_by_kind.at("kayak").sum, 1);
  const auto& docks = score.near_recall_by_kind.at("dock");
  EXPECT_EQ(docks.count, 1);
  EXPECT_EQ(docks.sum, 0) << "a third of it";
  EXPECT_DOUBLE_EQ(score.water_iou.value(), 1.0);
  EXPECT_DOUBLE_EQ(sure.water_iou.value(), 2.0 / 3.0);
  EXPECT_EQ(score.iou_by_kind.at("kayak"), (Mean{3, 3.0}));
  EXPECT_EQ(sure.iou_by_kind.at("kayak"), (Mean{3, 2.0}));
  EXPECT_EQ(score.recall_by_range.at(2), (Mean{2, 2.0}));
  EXPECT_EQ(sure.recall_by_range.at(2), (Mean{2, 1.0}));
  Score total = score;
  total.Add(score);
  EXPECT_EQ(total.near_recall_by_kind.at("kayak").sum, 4);
  EXPECT_EQ(total.recall_by_range.at(2).sum, 4);
  EXPECT_EQ(total.iou_by_kind.at("kayak").sum, 6.0);
}

TEST(Scoring, ComponentsAreAMeanOverTheScansThatHaveThem) {
  auto one = MakeCase({{1, 1}});
  EXPECT_TRUE(std::isnan(ScoreScan(one.truth, one.labelling).components.value()));
  one.labelling.num_components = 3;
  Score total = ScoreScan(one.truth, one.labelling);
  one.labelling.num_components = 4;
  total.Add(ScoreScan(one.truth, one.labelling));
  EXPECT_DOUBLE_EQ(total.components.value(), 3.5);
}

TEST(Scoring, HalfIsFound) {
  std::vector<Cell> cells;
  AddCells(cells, 5, {1, 1});
  AddCells(cells, 5, {1, 0});
  EXPECT_EQ(ScoreOf(cells).recall_by_range.at(2).sum, 1);
}

TEST(Scoring, ScoresAddUp) {
  Score total = ScoreOf({{1, 1}, {1, 1}});
  total.Add(ScoreOf({{1, 1}, {1, 0}, {kNoTrueObject, 2}}));
  total.Add(ScoreOf({{kNoTrueObject, 2}}));
  EXPECT_EQ(total.num_scans(), 3);
  EXPECT_DOUBLE_EQ(total.iou.value(), 0.75) << "the scan without objects has no IoU";
  EXPECT_DOUBLE_EQ(total.false_segments.value(), 2.0 / 3.0);
  EXPECT_EQ(total.iou_by_kind.at("kayak"), (Mean{2, 1.5}));
}

TEST(Scoring, LabelsThatDoNotFitTheCellsAreRefused) {
  auto one = MakeCase({{1, 1}, {1, 1}});
  one.labelling.label.pop_back();
  EXPECT_THROW(ScoreScan(one.truth, one.labelling), std::logic_error);
}

}  // namespace
}  // namespace lookout::eval
