#include "lab/eval/tracks/alert_tables.hpp"

#include <gtest/gtest.h>
#include <limits>

#include "common/core/angles.hpp"
#include "lab/eval/methods/figures.hpp"

namespace lookout::eval {
namespace {

AlertRow RowOf(const std::string& scene, double hours, std::int64_t num_right, std::int64_t num_far, double delay_s) {
  AlertRow row{scene, {}};
  row.scores.num_runs = 1;
  row.scores.seconds = 3600.0 * hours;
  row.scores.num_alerts[1][static_cast<std::size_t>(AlertVerdict::kRight)] = num_right;
  row.scores.num_alerts[0][static_cast<std::size_t>(AlertVerdict::kFar)] = num_far;
  if (scene == "moored") {
    row.scores.berth_s = row.scores.seconds;
    row.scores.num_false_in_berth = num_far;
  }
  row.scores.num_dangers[static_cast<std::size_t>(std::isinf(delay_s) ? DangerVerdict::kMissed : DangerVerdict::kInTime)] = 1;
  row.scores.delay_s.Add(delay_s);
  return row;
}

const Table& TableOf(const std::vector<NamedTable>& tables, const std::string& name) {
  return std::ranges::find(tables, name, &NamedTable::name)->table;
}

TEST(AlertTables, RatesAreOfAllRunsTogether) {
  const auto scenes = AddUpAlerts({RowOf("a", 0.5, 3, 1, 0.5), RowOf("a", 1.5, 1, 0, 1.5), RowOf("moored", 2.0, 0, 1, 1.0)});
  ASSERT_EQ(scenes.size(), 2U);
  EXPECT_EQ(scenes[0].scores.num_runs, 2);
  const auto tables = AlertTablesOf({{"own scenes", scenes, "all scenes"}});
  const auto& verdicts = TableOf(tables, "alerts_verdicts");
  ASSERT_EQ(verdicts.rows().size(), 4U);  // with the header and the sum
  EXPECT_EQ(verdicts.rows()[1], (Table::Row{"a", "2", "2.00", "5", "2.5", "2.0", "0.0", "0.5", "0.0", "0.0", "0.5", "0.0"}));
  EXPECT_EQ(verdicts.rows()[3].front(), "all scenes");
  EXPECT_EQ(verdicts.rows()[3][10], "0.5");
  const auto& targets = TableOf(tables, "alerts_targets");
  EXPECT_EQ(targets.rows()[1], (Table::Row{"own scenes", "false alerts an hour, moored", "<= 0.0", "0.5", "MISSED", "0.5 moored", "4.00"}));
  EXPECT_EQ(targets.rows()[2], (Table::Row{"own scenes", "false alerts an hour, under way, clear", "<= 1.0", "0.5", "yes", "0.5 a", "4.00"}));
}

TEST(AlertTables, WhatIsMissedHasNoDelay) {
  const auto tables = AlertTablesOf({{"own scenes", {RowOf("a", 1.0, 0, 0, std::numeric_limits<double>::infinity())}, "all scenes"}});
  EXPECT_EQ(TableOf(tables, "alerts_dangers").rows()[1], (Table::Row{"a", "1", "0", "0", "1", "never", "never"}));
}

TEST(AlertTables, CausesAreSharesOfTheFalseAndOfTheRepeated) {
  auto row = RowOf("quay", 1.0, 0, 3, 0.5);
  row.scores.num_alerts[0][static_cast<std::size_t>(AlertVerdict::kRepeated)] = 2;
  auto& far = row.scores.num_faults[static_cast<std::size_t>(AlertVerdict::kFar)];
  far[static_cast<std::size_t>(AlertFault::kOtherCourse)] = 1;
  far[static_cast<std::size_t>(AlertFault::kPieceMoves)] = 2;
  row.scores.num_faults[static_cast<std::size_t>(AlertVerdict::kRepeated)][static_cast<std::size_t>(AlertFault::kPieceMoves)] = 1;
  const auto tables = AlertTablesOf({{"own scenes", {RowOf("a", 1.0, 0, 0, 0.5), row}, "all scenes"}});
  const auto& causes = TableOf(tables, "alerts_causes");
  ASSERT_EQ(causes.rows().size(), 3U);
  EXPECT_EQ(causes.rows()[1], (Table::Row{"own scenes", "piece moves", "2", "0", "1", "67", "50", "quay"}));
  EXPECT_EQ(causes.rows()[2], (Table::Row{"own scenes", "other course", "1", "0", "0", "33", "0", "quay"}));
}

// ALERTS.md has a block of each.
TEST(AlertTables, AreFiguresOfPages) {
  for (const auto& table : AlertTablesOf({})) {
    EXPECT_TRUE(table.table.empty()) << table.name;
    EXPECT_NO_THROW(FillBlocks("<!-- figures: " + table.name + " -->\n<!-- end -->\n", {}, "page"));
  }
}

TEST(AlertTables, AnEventIsARowOfTheList) {
  AlertEvent event;
  event.second = 12.34;
  event.what = "far";
  event.level = "warning";
  event.cause = "zone";
  event.alert_id = 3;
  event.track_id = 17;
  event.thing = "boat_1";
  event.kind = "boat";
  event.distance_m = 14.0;
  event.approach_m = std::numeric_limits<double>::infinity();
  event.told_distance_m = 9.5;
  event.told_bearing_rad = DegToRad(350.0);
  event.fault = AlertFault::kPieceMoves;
  event.true_speed_mps = 0.0;
  event.told_speed_mps = 1.25;
  event.existence_probability = 0.875;
  event.text = "boat 17 in the guard zone: 9.5 m, 10 deg to port";
  EXPECT_EQ(
      AlertEventRow("marina", 101, event),
      "marina,101,12.3,far,warning,zone,3,17,boat_1,boat,14.00,inf,9.50,350,,piece moves,0.0,1.2,0.88,\"boat 17 in the guard zone: 9.5 m, 10 deg to "
      "port\"\n");
  const auto header = AlertEventHeader();
  EXPECT_EQ(std::ranges::count(header, ','), 19);
}

}  // namespace
}  // namespace lookout::eval
