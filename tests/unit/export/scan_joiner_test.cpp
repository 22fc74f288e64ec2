#include "tools/export/scan_joiner.hpp"

#include <gtest/gtest.h>
#include <string>
#include <utility>
#include <vector>

#include "tests/unit/export/export_logs.hpp"

namespace lookout::exporter {
namespace {

// What came out: seq and, behind it, the label of its first cell or '-'.
class ScanJoinerTest : public ::testing::Test {
 protected:
  std::string out_;
  ScanJoiner joiner_{[this](const LabelledScan& part) {
    out_ += (out_.empty() ? "" : " ") + std::to_string(part.scan.seq) + ":" + std::to_string(part.scan.first_column) + ":" +
            (part.segments ? std::to_string(part.segments->label.front()) : "-");
  }};
};

TEST_F(ScanJoinerTest, GivesEachScanItsLabels) {
  for (int seq = 0; seq < 3; ++seq) {
    joiner_.Add(MakeScan(seq));
    joiner_.Add(MakeSegments(MakeScan(seq), static_cast<std::int16_t>(seq + 10)));
  }
  EXPECT_EQ(out_, "0:0:10 1:0:11 2:0:12");
}

TEST_F(ScanJoinerTest, WaitsForLabelsThatComeBehindTheNextScan) {
  joiner_.Add(MakeScan(0));
  joiner_.Add(MakeScan(1));
  EXPECT_EQ(out_, "");
  joiner_.Add(MakeSegments(MakeScan(0), 4));
  joiner_.Add(MakeSegments(MakeScan(1), 5));
  EXPECT_EQ(out_, "0:0:4 1:0:5");
}

TEST_F(ScanJoinerTest, JoinsThePartsOfATurnByTheirColumns) {
  auto first = MakeScan(3, 2, 0);
  auto second = MakeScan(3, 2, 2);
  first.num_parts = second.num_parts = 2;
  second.part_index = 1;
  joiner_.Add(first);
  joiner_.Add(second);
  joiner_.Add(MakeSegments(first, 8));
  joiner_.Add(MakeSegments(second, 9));
  EXPECT_EQ(out_, "3:0:8 3:2:9");
}

TEST_F(ScanJoinerTest, LetsAScanGoWithoutLabelsWhenALaterOneHasGotThem) {
  joiner_.Add(MakeScan(0));
  joiner_.Add(MakeScan(1));
  joiner_.Add(MakeSegments(MakeScan(1), 5));
  EXPECT_EQ(out_, "0:0:- 1:0:5");
}

TEST_F(ScanJoinerTest, LosesNothingAtTheEnd) {
  joiner_.Add(MakeScan(0));
  joiner_.Add(MakeScan(1));
  joiner_.Flush();
  EXPECT_EQ(out_, "0:0:- 1:0:-");
}

TEST_F(ScanJoinerTest, HoldsABoundedNumberOfScansAndKeepsTheirOrder) {
  for (int seq = 0; seq < static_cast<int>(ScanJoiner::kMaxWaiting) + 2; ++seq) joiner_.Add(MakeScan(seq));
  EXPECT_EQ(out_, "0:0:- 1:0:-");
}

TEST_F(ScanJoinerTest, TellsARestartedTurnByItsTime) {
  auto restarted = MakeScan(0);
  restarted.utime_us += 60'000'000;
  joiner_.Add(MakeScan(0));
  joiner_.Add(restarted);
  joiner_.Add(MakeSegments(restarted, 6));
  EXPECT_EQ(out_, "0:0:- 0:0:6");
}

TEST_F(ScanJoinerTest, RefusesLabelsOfAnotherShapeAndCountsThem) {
  auto segments = MakeSegments(MakeScan(0));
  segments.num_rings = 1;
  segments.num_columns = 4;  // as many cells, other meaning
  joiner_.Add(MakeScan(0));
  joiner_.Add(segments);
  joiner_.Add(MakeSegments(MakeScan(7)));
  EXPECT_EQ(joiner_.num_orphans(), 2);
  EXPECT_EQ(out_, "");
}

TEST_F(ScanJoinerTest, DoesNotCountFurtherPartsOfSegmentsAsOrphans) {
  auto further = MakeSegments(MakeScan(0, 0));
  further.part_index = 1;
  further.num_parts = 2;
  joiner_.Add(further);
  EXPECT_EQ(joiner_.num_orphans(), 0);
}

TEST(IsConsistent, RefusesScansWhoseCountsContradict) {
  EXPECT_TRUE(IsConsistent(MakeScan(0)));
  EXPECT_TRUE(IsConsistent(MakeScan(0, 0)));  // an empty turn
  auto scan = MakeScan(0);
  scan.num_cells = 3;
  EXPECT_FALSE(IsConsistent(scan));
  scan = MakeScan(0);
  scan.part_index = 1;
  EXPECT_FALSE(IsConsistent(scan));
  scan = MakeScan(0);
  scan.utime_us = std::numeric_limits<std::int64_t>::max();
  EXPECT_FALSE(IsConsistent(scan));
  auto segments = MakeSegments(MakeScan(0));
  segments.num_rings = std::numeric_limits<std::int32_t>::max();
  segments.num_returns = std::numeric_limits<std::int32_t>::max();
  segments.num_columns = std::numeric_limits<std::int32_t>::max();
  EXPECT_FALSE(IsConsistent(segments));
}

}  // namespace
}  // namespace lookout::exporter
