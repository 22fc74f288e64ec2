#include "tools/eval/turn_collector.hpp"

#include <gtest/gtest.h>
#include <limits>
#include <vector>

namespace lookout::eval {
namespace {

obstacles_t Obstacles(std::int64_t seq, int part_index, int num_parts) {
  obstacles_t message{};
  message.utime_us = 1000 * seq;
  message.seq = seq;
  message.part_index = part_index;
  message.num_parts = num_parts;
  return message;
}

TEST(TurnCollector, GivesATurnWhenItsLastPartCame) {
  std::vector<std::size_t> part_counts;
  TurnCollector collector([&](const Turn& turn) { part_counts.push_back(turn.obstacles.size()); });
  EXPECT_TRUE(collector.Add(Obstacles(1, 0, 2)));
  EXPECT_TRUE(part_counts.empty());
  EXPECT_TRUE(collector.Add(Obstacles(2, 0, 1)));
  EXPECT_TRUE(collector.Add(Obstacles(1, 1, 2)));
  EXPECT_EQ(part_counts, (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(collector.num_incomplete(), 0);
}

TEST(TurnCollector, CountsTurnsThatLackAPart) {
  TurnCollector collector([](const Turn&) { FAIL(); });
  for (int seq = 0; seq < 1000; ++seq) collector.Add(Obstacles(seq, 0, 2));
  EXPECT_EQ(collector.num_incomplete(), 1000);
}

TEST(TurnCollector, RefusesCountsThatDoNotAgree) {
  TurnCollector collector([](const Turn&) { FAIL(); });
  lidar_scan_t scan{};
  scan.num_parts = 1;
  scan.num_columns = 2;
  scan.num_rings = 16;
  scan.num_returns = 1;
  scan.num_cells = 31;
  EXPECT_FALSE(collector.Add(scan));
  scan.num_cells = -32;
  EXPECT_FALSE(collector.Add(scan));
  EXPECT_FALSE(collector.Add(Obstacles(1, 2, 2)));
  EXPECT_FALSE(collector.Add(Obstacles(1, -1, 2)));
  auto obstacles = Obstacles(1, 0, 1);
  obstacles.utime_us = std::numeric_limits<std::int64_t>::max();
  EXPECT_FALSE(collector.Add(obstacles));
  obstacles = Obstacles(1, 0, 1);
  obstacles.num_obstacles = 1;
  obstacles.obstacles.resize(1);
  obstacles.obstacles[0] = obstacle_t{};
  obstacles.obstacles[0].num_map = 3;
  EXPECT_FALSE(collector.Add(obstacles));
}

TEST(Turn, IsWholeWithoutPartialFlags) {
  Turn turn;
  turn.obstacles[0] = Obstacles(1, 0, 1);
  EXPECT_TRUE(turn.IsWhole());
  turn.obstacles[0].scan_flags = lidar_scan_t::FLAG_HOLE;
  EXPECT_TRUE(turn.IsWhole());
  turn.obstacles[0].scan_flags = lidar_scan_t::FLAG_PARTIAL_START;
  EXPECT_FALSE(turn.IsWhole());
}

}  // namespace
}  // namespace lookout::eval
