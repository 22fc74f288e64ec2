#include "tools/export/scans.hpp"

#include <gtest/gtest.h>
#include <string>

#include "tests/unit/export/export_logs.hpp"

namespace lookout::exporter {
namespace {

// The parts of scans that were handed on: seq, first column, and the label of the first cell or '-'.
class LabelsTest : public ::testing::Test {
 protected:
  std::string out_;
  std::int64_t num_orphans_ = 0;
  messages::ScanCollector collector_ = MakeCollector(IsLabelled, [this](const ScanMessages& scan) {
    for (const auto& [part_index, part] : scan.scans) {
      const auto* labels = LabelsOf(scan, part);
      out_ += (out_.empty() ? "" : " ") + std::to_string(part.seq) + ":" + std::to_string(part.first_column) + ":" +
              (labels != nullptr ? std::to_string(labels->label.front()) : "-");
    }
    num_orphans_ += NumOrphans(scan);
  });
};

TEST_F(LabelsTest, StandBesideThePartOfTheScanThatTheyBelongTo) {
  auto first = MakeScan(3, 2, 0);
  auto second = MakeScan(3, 2, 2);
  first.num_parts = second.num_parts = 2;
  second.part_index = 1;
  collector_.Add(first);
  collector_.Add(second);
  collector_.Add(MakeSegments(first, 8));
  collector_.Add(MakeSegments(second, 9));
  EXPECT_EQ(out_, "3:0:8 3:2:9");
}

TEST_F(LabelsTest, MayComeBehindTheNextScanAndLeaveOneOut) {
  for (const int seq : {0, 1, 2}) collector_.Add(MakeScan(seq));
  EXPECT_EQ(out_, "");
  collector_.Add(MakeSegments(MakeScan(1), 5));
  EXPECT_EQ(out_, "0:0:- 1:0:5");
  collector_.Finish();
  EXPECT_EQ(out_, "0:0:- 1:0:5 2:0:-");
}

TEST_F(LabelsTest, AreLeftOutAndCountedWhereTheyAreOfAnotherShapeOrOfNoScan) {
  auto segments = MakeSegments(MakeScan(0));
  segments.num_rings = 1;
  segments.num_columns = 4;  // as many cells, other meaning
  collector_.Add(MakeScan(0));
  collector_.Add(segments);
  collector_.Add(MakeSegments(MakeScan(7)));
  collector_.Finish();
  EXPECT_EQ(num_orphans_, 2);
  EXPECT_EQ(out_, "0:0:-");
}

TEST_F(LabelsTest, AreNoOrphansInFurtherPartsOfSegments) {
  auto further = MakeSegments(MakeScan(0, 0));
  further.part_index = 1;
  further.num_parts = 2;
  collector_.Add(further);
  collector_.Finish();
  EXPECT_EQ(num_orphans_, 0);
}

class ChosenScanTest : public ::testing::Test {
 protected:
  static obstacles_t Part(std::int64_t utime_us, std::int64_t seq, int part_index = 0, int num_parts = 1, std::int32_t flags = 0) {
    obstacles_t message{};
    message.utime_us = utime_us;
    message.seq = seq;
    message.part_index = part_index;
    message.num_parts = num_parts;
    message.scan_flags = flags;
    return message;
  }
  static std::string Choose(std::optional<std::int64_t> seq, const std::vector<obstacles_t>& messages) {
    ChosenScan scan(ChosenScan::Of::kObstacles, seq);
    for (const auto& message : messages) EXPECT_EQ(scan.Take(bus::kObstacles.name, bus::Encode(message)), Taken::kOk);
    scan.Finish();
    if (!scan.chosen()) return "none";
    return std::to_string(scan.chosen()->utime_us) + ":" + std::to_string(scan.chosen()->obstacles.size());
  }
};

TEST_F(ChosenScanTest, IsTheLastWholeOne) {
  const auto cut = Part(300, 2, 0, 1, lidar_scan_t::FLAG_PARTIAL_END);
  EXPECT_EQ(Choose(std::nullopt, {Part(100, 0), Part(200, 1), cut}), "200:1");
  EXPECT_EQ(Choose(std::nullopt, {cut}), "300:1") << "where none is whole";
  EXPECT_EQ(Choose(std::nullopt, {Part(100, 0, 0, 2), Part(100, 0, 1, 2), Part(200, 1, 1, 2)}), "100:2") << "the last lacks a part";
  EXPECT_EQ(Choose(std::nullopt, {Part(100, 0, 0, 2), Part(100, 0, 1, 2), Part(100, 0)}), "100:1") << "a scan that comes again is another one";
}

TEST_F(ChosenScanTest, IsTheFirstOfTheWantedNumber) {
  EXPECT_EQ(Choose(1, {Part(100, 0), Part(200, 1), Part(300, 2), Part(900, 1)}), "200:1") << "not that of a later run";
  EXPECT_EQ(Choose(5, {Part(100, 0)}), "none");
  ChosenScan scan(ChosenScan::Of::kObstacles, 1);
  scan.Take(bus::kObstacles.name, bus::Encode(Part(200, 1, 0, 2)));
  EXPECT_FALSE(scan.IsDone()) << "a part may come";
  scan.Take(bus::kObstacles.name, bus::Encode(Part(200, 1, 1, 2)));
  EXPECT_TRUE(scan.IsDone());
}

}  // namespace
}  // namespace lookout::exporter
