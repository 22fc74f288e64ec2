#include "services/segmenter/core/turn_gatherer.hpp"

#include <gtest/gtest.h>

namespace lookout::segmenter {
namespace {

// Columns [first, first + num) of a turn of 10 in `num_parts`, one ring; the range of a cell is its column + 1.
ScanPart Part(std::int64_t seq, int part_index, int num_parts, int first_column, int num_columns) {
  ScanPart part;
  part.head.seq = seq;
  part.head.num_parts = num_parts;
  part.head.range_unit_m = 0.002;
  part.head.rings.resize(1);
  part.head.num_turn_columns = 10;
  part.part_index = part_index;
  part.first_column = first_column;
  for (int column = first_column; column < first_column + num_columns; ++column) {
    part.columns.azimuth_rad.push_back(0.1F * static_cast<float>(column));
    part.columns.time_ns.push_back(column);
    part.columns.range.push_back(static_cast<std::uint16_t>(column + 1));
    part.columns.reflectivity.push_back(static_cast<std::uint8_t>(column));
  }
  return part;
}

void ExpectWhole(const std::optional<Scan>& scan, std::size_t num_parts) {
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->columns.range, (std::vector<std::uint16_t>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10}));
  EXPECT_EQ(scan->columns.size(), 10);
  EXPECT_EQ(scan->columns.time_ns.size(), 10U);
  EXPECT_EQ(scan->columns.reflectivity.size(), 10U);
  EXPECT_EQ(scan->parts.size(), num_parts);
}

TEST(TurnGatherer, GivesATurnOfOnePartAtOnceEachTimeItComes) {
  TurnGatherer gatherer;
  for (int i = 0; i < 2; ++i) ExpectWhole(gatherer.Add(Part(7, 0, 1, 0, 10)), 1);
  EXPECT_EQ(gatherer.counts().duplicate_parts, 0);
}

TEST(TurnGatherer, PutsPartsTogetherInAnyOrder) {
  for (const auto& order : {std::vector{0, 1, 2}, {2, 1, 0}, {1, 2, 0}}) {
    TurnGatherer gatherer;
    const int first[]{0, 4, 7};
    const int count[]{4, 3, 3};
    std::optional<Scan> scan;
    for (const int part : order) {
      EXPECT_FALSE(scan);
      scan = gatherer.Add(Part(7, part, 3, first[part], count[part]));
    }
    ExpectWhole(scan, 3);
    EXPECT_EQ(scan->parts[1].first_column, 4);
    EXPECT_EQ(scan->parts[1].num_columns, 3);
  }
}

TEST(TurnGatherer, DropsAndCountsATurnThatTheNextOvertakes) {
  TurnGatherer gatherer;
  EXPECT_FALSE(gatherer.Add(Part(7, 0, 2, 0, 5)));
  EXPECT_FALSE(gatherer.Add(Part(8, 0, 2, 0, 5)));
  EXPECT_EQ(gatherer.counts().incomplete_turns, 1);
  ExpectWhole(gatherer.Add(Part(8, 1, 2, 5, 5)), 2);
  EXPECT_FALSE(gatherer.Add(Part(7, 1, 2, 5, 5)));  // too late
}

TEST(TurnGatherer, TakesTheSameNumberAtAnotherTimeForAnotherTurn) {
  // The publisher was started again.
  TurnGatherer gatherer;
  EXPECT_FALSE(gatherer.Add(Part(0, 0, 2, 0, 5)));
  auto part = Part(0, 0, 2, 0, 5);
  part.head.time += std::chrono::seconds(9);
  EXPECT_FALSE(gatherer.Add(part));
  EXPECT_EQ(gatherer.counts().incomplete_turns, 1);
}

TEST(TurnGatherer, RefusesAPartThatCameBefore) {
  TurnGatherer gatherer;
  EXPECT_FALSE(gatherer.Add(Part(7, 0, 2, 0, 5)));
  EXPECT_FALSE(gatherer.Add(Part(7, 0, 2, 0, 5)));
  EXPECT_EQ(gatherer.counts().duplicate_parts, 1);
  ExpectWhole(gatherer.Add(Part(7, 1, 2, 5, 5)), 2);
}

TEST(TurnGatherer, RefusesAPartThatDisagreesAboutTheTurn) {
  TurnGatherer gatherer;
  EXPECT_FALSE(gatherer.Add(Part(7, 0, 2, 0, 5)));
  auto other = Part(7, 1, 2, 5, 5);
  other.head.rings[0].elevation_rad = 0.1F;
  EXPECT_FALSE(gatherer.Add(other));
  EXPECT_FALSE(gatherer.Add(Part(7, 1, 3, 5, 5)));
  EXPECT_EQ(gatherer.counts().inconsistent_parts, 2);
  ExpectWhole(gatherer.Add(Part(7, 1, 2, 5, 5)), 2);
}

TEST(TurnGatherer, DropsATurnWhoseColumnsOverlapOrLeaveGaps) {
  TurnGatherer gatherer;
  const std::pair<int, int> seconds[]{{4, 5}, {6, 4}, {5, 4}};  // first column and number of the second of two parts
  for (const auto& [first_column, num_columns] : seconds) {
    EXPECT_FALSE(gatherer.Add(Part(7, 0, 2, 0, 5)));
    EXPECT_FALSE(gatherer.Add(Part(7, 1, 2, first_column, num_columns)));
  }
  EXPECT_EQ(gatherer.counts().inconsistent_turns, 3);
  EXPECT_EQ(gatherer.counts().incomplete_turns, 0);
}

}  // namespace
}  // namespace lookout::segmenter
