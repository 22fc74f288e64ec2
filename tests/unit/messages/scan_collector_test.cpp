#include "common/messages/scan_collector.hpp"

#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <sstream>
#include <string>

#include "tests/support/files.hpp"

namespace lookout::messages {
namespace {

template <typename Message>
Message Part(std::int64_t seq, int part_index, int num_parts) {
  Message message{};
  message.utime_us = 1000 * seq;
  message.seq = seq;
  message.part_index = part_index;
  message.num_parts = num_parts;
  return message;
}

bool IsSegmented(const ScanMessages& scan) { return HasAllParts(scan.scans) && HasAllParts(scan.segments); }
bool HasObstacles(const ScanMessages& scan) { return HasAllParts(scan.obstacles); }

// What was handed on: seq, parts of the scan, of its segments, of its obstacles.
class ScanCollectorTest : public ::testing::Test {
 protected:
  ScanCollector Make(ScanCollector::Predicate is_complete, ScanCollector::Order order, std::size_t max_waiting = 10) {
    return {is_complete, order, max_waiting, [this](const ScanMessages& scan) {
              std::ostringstream text;
              text << (out_.empty() ? "" : " ") << scan.seq << ":" << scan.scans.size() << scan.segments.size() << scan.obstacles.size();
              out_ += text.str();
            }};
  }
  std::string out_;
};

TEST_F(ScanCollectorTest, HandsOnEachScanWithItsSegmentsThoughTheyComeLate) {
  auto collector = Make(IsSegmented, ScanCollector::Order::kOfArrival);
  for (const int seq : {0, 1}) EXPECT_TRUE(collector.Add(Part<lidar_scan_t>(seq, 0, 1)));
  EXPECT_EQ(out_, "");
  EXPECT_TRUE(collector.Add(Part<segments_t>(0, 0, 1)));
  EXPECT_EQ(out_, "0:110");
  EXPECT_TRUE(collector.Add(Part<segments_t>(1, 0, 1)));
  EXPECT_EQ(out_, "0:110 1:110");
}

TEST_F(ScanCollectorTest, HandsOnScansInTheirOrderWhenOneHasNoSegments) {
  auto collector = Make(IsSegmented, ScanCollector::Order::kOfArrival);
  for (const int seq : {0, 1, 2}) collector.Add(Part<lidar_scan_t>(seq, 0, 1));
  collector.Add(Part<segments_t>(1, 0, 1));
  EXPECT_EQ(out_, "0:100 1:110");
  collector.Finish();
  EXPECT_EQ(out_, "0:100 1:110 2:100");
}

TEST_F(ScanCollectorTest, HandsOnScansAsTheyAreCompleted) {
  auto collector = Make(HasObstacles, ScanCollector::Order::kOfCompletion);
  collector.Add(Part<obstacles_t>(1, 0, 2));
  collector.Add(Part<obstacles_t>(2, 0, 1));
  EXPECT_EQ(out_, "2:001");
  collector.Add(Part<obstacles_t>(1, 1, 2));
  EXPECT_EQ(out_, "2:001 1:002");
}

TEST_F(ScanCollectorTest, HoldsABoundedNumberAndHandsOnTheFirst) {
  auto collector = Make(HasObstacles, ScanCollector::Order::kOfCompletion, 3);
  for (int seq = 0; seq < 5; ++seq) collector.Add(Part<obstacles_t>(seq, 0, 2));
  EXPECT_EQ(out_, "0:001 1:001");
  collector.Finish();
  EXPECT_EQ(out_, "0:001 1:001 2:001 3:001 4:001");
}

TEST_F(ScanCollectorTest, TellsARestartedScanByItsTime) {
  auto collector = Make(IsSegmented, ScanCollector::Order::kOfArrival);
  auto restarted = Part<segments_t>(0, 0, 1);
  restarted.utime_us += 60'000'000;
  collector.Add(Part<lidar_scan_t>(0, 0, 1));
  collector.Add(restarted);
  collector.Finish();
  EXPECT_EQ(out_, "0:100 0:010");
}

TEST_F(ScanCollectorTest, BeginsAScanOnceMoreThatComesAgain) {
  auto collector = Make(IsSegmented, ScanCollector::Order::kOfArrival);
  for (int i = 0; i < 2; ++i) collector.Add(Part<lidar_scan_t>(0, 0, 2));
  collector.Add(Part<lidar_scan_t>(0, 1, 2));
  collector.Add(Part<segments_t>(0, 0, 1));
  EXPECT_EQ(out_, "0:210");
  collector.Finish();
  EXPECT_EQ(out_, "0:210 0:100");
}

TEST_F(ScanCollectorTest, CompletesBothOfTwoScansWhoseMessagesAlternate) {
  auto collector = Make(IsSegmented, ScanCollector::Order::kOfArrival);
  for (const int part : {0, 0, 1, 1}) collector.Add(Part<lidar_scan_t>(0, part, 2));
  for (int i = 0; i < 2; ++i) collector.Add(Part<segments_t>(0, 0, 1));
  EXPECT_EQ(out_, "0:210 0:210");
}

TEST_F(ScanCollectorTest, LosesNothingOfAScanWithTheSegmentsOfASecondSegmenter) {
  auto collector = Make(HasObstacles, ScanCollector::Order::kOfCompletion);
  collector.Add(Part<lidar_scan_t>(0, 0, 1));
  for (int i = 0; i < 2; ++i) collector.Add(Part<segments_t>(0, 0, 1));
  collector.Add(Part<obstacles_t>(0, 0, 1));
  EXPECT_EQ(out_, "0:111");
}

TEST_F(ScanCollectorTest, LeavesOutWhatIsNotWellFormed) {
  auto collector = Make(IsSegmented, ScanCollector::Order::kOfArrival);
  auto scan = Part<lidar_scan_t>(0, 0, 1);
  scan.num_cells = 3;
  EXPECT_FALSE(collector.Add(scan));
  EXPECT_FALSE(collector.Add(Part<segments_t>(0, 1, 1)));
  collector.Finish();
  EXPECT_EQ(out_, "");
}

TEST(IsWellFormed, AsksForCountsThatAgree) {
  lidar_scan_t scan = Part<lidar_scan_t>(0, 0, 1);
  EXPECT_TRUE(IsWellFormed(scan));  // an empty scan
  scan.num_columns = 2;
  scan.num_rings = 16;
  scan.num_returns = 1;
  scan.num_cells = 32;
  EXPECT_TRUE(IsWellFormed(scan));
  for (const int num_cells : {31, -32, 0}) {
    scan.num_cells = num_cells;
    EXPECT_FALSE(IsWellFormed(scan)) << num_cells;
  }
  auto segments = Part<segments_t>(0, 0, 1);
  segments.num_rings = segments.num_returns = segments.num_columns = std::numeric_limits<std::int32_t>::max();
  EXPECT_FALSE(IsWellFormed(segments));
}

TEST(IsWellFormed, AsksForAPlace) {
  EXPECT_TRUE(IsWellFormed(Part<obstacles_t>(1, 1, 2)));
  EXPECT_FALSE(IsWellFormed(Part<obstacles_t>(1, 2, 2)));
  EXPECT_FALSE(IsWellFormed(Part<obstacles_t>(1, -1, 2)));
  auto obstacles = Part<obstacles_t>(1, 0, 1);
  obstacles.utime_us = std::numeric_limits<std::int64_t>::max();
  EXPECT_FALSE(IsWellFormed(obstacles));
  obstacles = Part<obstacles_t>(1, 0, 1);
  obstacles.num_obstacles = 1;
  obstacles.obstacles.resize(1);
  obstacles.obstacles[0] = obstacle_t{};
  obstacles.obstacles[0].num_map = 3;
  EXPECT_FALSE(IsWellFormed(obstacles));
}

TEST(IsCut, LooksAtBothEnds) {
  EXPECT_FALSE(IsCut(lidar_scan_t::FLAG_HOLE));
  EXPECT_TRUE(IsCut(lidar_scan_t::FLAG_PARTIAL_START));
  EXPECT_TRUE(IsCut(lidar_scan_t::FLAG_PARTIAL_END));
}

// The same cases are read by the test of lookout-spy, which joins messages by code of its own.
TEST(ScanParts, CompleteTheScansOfTheSharedCases) {
  std::ifstream file(support::kSources / "tests/unit/messages/scan_parts.txt");
  int num_cases = 0;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    const auto arrow = line.find(" -> ");
    ASSERT_NE(arrow, std::string::npos) << line;
    std::string completed;
    ScanCollector collector(IsSegmented, ScanCollector::Order::kOfArrival, 4, [&](const ScanMessages& scan) {
      if (IsSegmented(scan)) completed += (completed.empty() ? "" : " ") + std::to_string(scan.seq);
    });
    std::istringstream parts(line.substr(0, arrow));
    for (std::string part; parts >> part;) {
      char kind = 0;
      char separator = 0;
      int seq = 0;
      int part_index = 0;
      int num_parts = 0;
      std::istringstream(part) >> kind >> seq >> separator >> part_index >> separator >> num_parts;
      if (kind == 'C') collector.Add(Part<lidar_scan_t>(seq, part_index, num_parts));
      if (kind == 'S') collector.Add(Part<segments_t>(seq, part_index, num_parts));
    }
    EXPECT_EQ(completed, line.substr(arrow + 4)) << line;
    ++num_cases;
  }
  EXPECT_GE(num_cases, 8);
}

}  // namespace
}  // namespace lookout::messages
