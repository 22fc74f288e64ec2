#include "lab/eval/report/evaluation.hpp"

#include <gtest/gtest.h>
#include <limits>
#include <sstream>

#include "common/core/angles.hpp"
#include "lab/eval/report/report.hpp"
#include "tests/unit/eval/truth_fixture.hpp"

namespace lookout::eval {
namespace {

// Two columns of two rings, 55 us apart: the ferry twice, the pile, a stray. Segment 1 holds the ferry, segment 2 pile and stray.
messages::ScanMessages SmallTurn() {
  messages::ScanMessages turn;
  lidar_scan_t scan{};
  scan.utime_us = kStartUs;
  scan.num_parts = 1;
  scan.range_unit_m = 0.002;
  scan.num_rings = 9;
  scan.num_returns = 1;
  scan.num_columns = 2;
  scan.num_cells = 18;
  scan.time_ns = {0, 55'296};
  scan.time_offset_ns.assign(9, 0);
  scan.time_offset_ns[8] = 2304;
  scan.range.assign(18, 0);
  for (const std::size_t cell : {0U, 8U, 9U, 17U}) scan.range[cell] = 1000;
  turn.scans[0] = scan;

  segments_t segments{};
  segments.utime_us = kStartUs;
  segments.num_parts = 1;
  segments.num_rings = 9;
  segments.num_returns = 1;
  segments.num_columns = 2;
  segments.num_cells = 18;
  segments.label.assign(18, 0);
  segments.label[0] = segments.label[8] = 1;
  segments.label[9] = segments.label[17] = 2;
  for (const int id : {1, 2}) {
    segment_t segment{};
    segment.id = id;
    segment.num_hull = 2;
    segment.hull_x_m = {0.0F, 0.0F};
    segment.hull_y_m = {0.0F, 0.0F};
    segment.hull_time_us = id == 1 ? std::vector<std::int32_t>{0, 2} : std::vector<std::int32_t>{55, 57};
    segments.segments.push_back(segment);
  }
  segments.num_segments = 2;
  turn.segments[0] = segments;

  obstacles_t obstacles{};
  obstacles.utime_us = kStartUs;
  obstacles.num_parts = 1;
  obstacles.datum_latitude_deg = kDatumLatitudeDeg;
  obstacles.datum_longitude_deg = kDatumLongitudeDeg;
  obstacles.datum_ellipsoid_height_m = kDatumHeightM;
  for (const int id : {1, 2}) {
    obstacle_t obstacle{};
    obstacle.utime_us = kStartUs;
    obstacle.id = id;
    obstacle.num_footprint = obstacle.num_map = 2;
    obstacle.footprint_vessel_x_m = obstacle.footprint_vessel_y_m = {0.0F, 0.0F};
    // Ferry: 0.5 m west of it and 0.25 m inside. Pile: 0.3 m south of it, and the stray far away.
    obstacle.footprint_east_m = id == 1 ? std::vector<float>{-0.5F, 0.25F} : std::vector<float>{11.0F, 500.0F};
    obstacle.footprint_north_m = id == 1 ? std::vector<float>{1.0F, 1.0F} : std::vector<float>{-0.3F, 500.0F};
    obstacle.position_map_m[0] = id == 1 ? 1.0 : 13.0;
    obstacle.position_map_m[1] = 1.0;
    obstacles.obstacles.push_back(obstacle);
  }
  obstacles.num_obstacles = 2;
  turn.obstacles[0] = obstacles;
  return turn;
}

class EvaluationTest : public testing::Test {
 protected:
  support::TempDir folder_;
  Truth truth_{WriteTruth(folder_)};
};

TEST_F(EvaluationTest, MeasuresVerticesAgainstTheObjectThatReturnedThem) {
  Evaluation evaluation(&truth_, 1);
  evaluation.Add(SmallTurn());
  const auto& ferry = evaluation.errors_by_kind.at({"boat", true});
  ASSERT_EQ(ferry.vertex_edge_m.count(), 2U);
  EXPECT_NEAR(ferry.vertex_edge_m.Max(), 0.5, 1e-3);
  EXPECT_NEAR(ferry.vertex_edge_m.Median(), 0.25, 1e-3);
  EXPECT_NEAR(ferry.vertex_outside_m.Median(), 0.0, 1e-3);
  EXPECT_NEAR(ferry.position_outside_m.Max(), 0.0, 1e-9);
  const auto& pile = evaluation.errors_by_kind.at({"pile", false});
  ASSERT_EQ(pile.vertex_edge_m.count(), 1U) << "the vertex that a stray made does not count";
  EXPECT_NEAR(pile.vertex_edge_m.Max(), 0.3, 1e-3);
  EXPECT_NEAR(pile.position_outside_m.Max(), 1.0, 1e-3);
}

// A stray of its own segment, fired within a microsecond of the pile's return, used to be measured against the pile: 48 m off in a lake.
TEST_F(EvaluationTest, VertexOfAStrayIsNotMeasuredAgainstAReturnOfAnotherSegment) {
  Evaluation evaluation(&truth_, 1);
  auto turn = SmallTurn();
  turn.scans[0].time_offset_ns[8] = 900;
  turn.segments[0].label[17] = 3;
  turn.segments[0].segments[1].id = 3;
  turn.segments[0].segments[1].hull_time_us = {56, 56};
  turn.obstacles[0].obstacles[1].id = 3;
  evaluation.Add(turn);
  EXPECT_FALSE(evaluation.errors_by_kind.contains({"pile", false}));
  EXPECT_EQ(evaluation.rows[1].object_name, "stray");
  EXPECT_FALSE(evaluation.rows[1].vertex_outside_m);
}

TEST_F(EvaluationTest, ScoresSegmentsByReturns) {
  Evaluation evaluation(&truth_, 1);
  evaluation.Add(SmallTurn());
  EXPECT_EQ(evaluation.num_returns, 4);
  EXPECT_EQ(evaluation.num_joined, 4);
  // Ferry 2 of 2, pile 1 of 2 (the other is a stray).
  EXPECT_DOUBLE_EQ(evaluation.scan_iou.value(), 0.75);
  EXPECT_EQ(evaluation.scores_by_kind.at("boat").recall.sum, 1);
  EXPECT_EQ(evaluation.scores_by_kind.at("pile").recall.count, 1);
  EXPECT_EQ(evaluation.scores_by_kind.at("pile").recall.sum, 0) << "half of a segment is not its own";
  EXPECT_DOUBLE_EQ(evaluation.clutter_segments.value(), 0.0);
}

// The stray has a segment of its own, beside those of ferry and pile.
TEST_F(EvaluationTest, SegmentsOfStraysAreCountedAlsoAtSure) {
  auto turn = SmallTurn();
  turn.segments[0].label[17] = 3;
  auto stray = turn.segments[0].segments[1];
  stray.id = 3;
  turn.segments[0].segments.push_back(stray);
  turn.segments[0].num_segments = 3;
  for (const auto& [confidence, num_sure] : {std::pair{1, 0.0}, {2, 1.0}}) {
    Evaluation evaluation(&truth_, 1);
    for (auto& segment : turn.segments[0].segments) segment.confidence = segment_t::CONFIDENCE_SURE;
    turn.segments[0].segments[2].confidence = confidence;
    evaluation.Add(turn);
    EXPECT_DOUBLE_EQ(evaluation.clutter_segments.value(), 1.0);
    EXPECT_DOUBLE_EQ(evaluation.sure_clutter_segments.value(), num_sure);
    std::ostringstream text;
    PrintSegmentation(text, evaluation, 1);
    EXPECT_NE(text.str().find(num_sure > 0.0 ? "of pure clutter 1.00, of these sure 1.00" : "of pure clutter 1.00, of these sure 0.00"),
              std::string::npos)
        << text.str();
  }
}

TEST_F(EvaluationTest, TheFirstTableShowsConfidenceAndKind) {
  Evaluation evaluation(&truth_, 1);
  auto turn = SmallTurn();
  turn.obstacles[0].obstacles[0].confidence = obstacle_t::CONFIDENCE_TENTATIVE;
  turn.obstacles[0].obstacles[1].confidence = obstacle_t::CONFIDENCE_SURE;
  turn.obstacles[0].obstacles[1].kind = obstacle_t::KIND_LAND;
  evaluation.Add(turn);
  std::ostringstream text;
  PrintObstacles(text, evaluation, true);
  std::istringstream lines(text.str());
  std::string line;
  std::vector<std::string> found;
  while (std::getline(lines, line)) {
    if (line.find(" ok ") == std::string::npos) continue;
    found.push_back(line);
  }
  ASSERT_EQ(found.size(), 2U) << text.str();
  EXPECT_NE(found[0].find("tentative"), std::string::npos) << found[0];
  EXPECT_NE(found[0].find("obstacle"), std::string::npos) << found[0];
  EXPECT_NE(found[1].find("sure"), std::string::npos) << found[1];
  EXPECT_NE(found[1].find("land"), std::string::npos) << found[1];
}

TEST_F(EvaluationTest, ObjectsWithFewReturnsDoNotCountForRecall) {
  Evaluation evaluation(&truth_, 2);
  evaluation.Add(SmallTurn());
  EXPECT_EQ(evaluation.scores_by_kind.at("boat").recall.count, 1);
  EXPECT_EQ(evaluation.scores_by_kind.at("pile").recall.count, 0);
}

TEST_F(EvaluationTest, ObstaclesThatAreNotOnTheEarthHaveNoDistance) {
  Evaluation evaluation(&truth_, 1);
  auto turn = SmallTurn();
  for (auto& obstacle : turn.obstacles[0].obstacles) {
    obstacle.status = obstacle_t::STATUS_VESSEL_FRAME_ONLY;
    obstacle.num_map = 0;
  }
  turn.obstacles[0].datum_latitude_deg = std::numeric_limits<double>::quiet_NaN();
  evaluation.Add(turn);
  EXPECT_TRUE(evaluation.errors_by_kind.empty());
  EXPECT_EQ(evaluation.num_by_status.at(obstacle_t::STATUS_VESSEL_FRAME_ONLY), 2);
  EXPECT_EQ(evaluation.rows[0].object_name, "ferry");
}

TEST_F(EvaluationTest, WithoutHullTimesTheObjectOfTheSegmentCounts) {
  Evaluation evaluation(&truth_, 1);
  auto turn = SmallTurn();
  for (auto& segment : turn.segments[0].segments) segment.num_hull = 1;
  evaluation.Add(turn);
  EXPECT_EQ(evaluation.errors_by_kind.at({"boat", true}).vertex_edge_m.count(), 2U);
}

TEST_F(EvaluationTest, KeepsTheLastWholeTurnForTheTable) {
  Evaluation evaluation(&truth_, 1);
  evaluation.Add(SmallTurn());
  auto partial = SmallTurn();
  partial.obstacles[0].utime_us += 100'000;
  partial.obstacles[0].scan_flags = lidar_scan_t::FLAG_PARTIAL_END;
  partial.obstacles[0].obstacles.pop_back();
  evaluation.Add(partial);
  EXPECT_EQ(evaluation.table_utime_us, kStartUs);
  EXPECT_EQ(evaluation.rows.size(), 2U);
  EXPECT_EQ(evaluation.num_scans, 2);
  EXPECT_EQ(evaluation.num_whole_scans, 1);
}

TEST_F(EvaluationTest, PoseErrorsGoTheShortWayRound) {
  Evaluation evaluation(&truth_, 1);
  pose_t pose{};
  pose.utime_us = kStartUs;
  pose.status = pose_t::STATUS_OK;
  pose.has_attitude = 1;
  pose.latitude_deg = 43.63;
  pose.longitude_deg = -72.15;
  pose.heading_rad = DegToRad(0.2);  // the truth is 359.9
  pose.roll_rad = DegToRad(1.5);
  pose.pitch_rad = DegToRad(1.9);
  evaluation.Add(pose);
  pose.utime_us += 7;  // not in the truth
  evaluation.Add(pose);
  ASSERT_EQ(evaluation.pose_errors[1].count(), 1U);
  EXPECT_NEAR(evaluation.pose_errors[0].Max(), 0.0, 1e-6);
  EXPECT_NEAR(evaluation.pose_errors[1].Max(), 0.3, 1e-9);
  EXPECT_NEAR(evaluation.pose_errors[2].Max(), 0.5, 1e-9);
  EXPECT_NEAR(evaluation.pose_errors[3].Max(), 0.1, 1e-9);
}

TEST(Evaluation, WorksWithoutTruth) {
  Evaluation evaluation(nullptr, 1);
  auto turn = SmallTurn();
  turn.scans.clear();
  turn.segments.clear();
  evaluation.Add(turn);
  std::ostringstream text;
  PrintObstacles(text, evaluation, false);
  EXPECT_EQ(text.str().find("outside_m"), std::string::npos);
  EXPECT_NE(text.str().find("1 scans, 1 of them whole; 2 obstacles, 2 ok"), std::string::npos) << text.str();
}

TEST_F(EvaluationTest, TablesArePrintedAlsoWhenNothingWasMeasured) {
  const Evaluation evaluation(&truth_, 1);
  std::ostringstream text;
  PrintObstacles(text, evaluation, true);
  PrintAccuracy(text, evaluation);
  PrintSegmentation(text, evaluation, 1);
  EXPECT_NE(text.str().find("fixed"), std::string::npos);
}

}  // namespace
}  // namespace lookout::eval
