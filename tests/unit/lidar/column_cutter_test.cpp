#include "services/lidar/core/driver/column_cutter.hpp"

#include <gtest/gtest.h>
#include <vector>

#include "tests/unit/lidar/column_maker.hpp"

namespace lookout::lidar {
namespace {

using namespace std::chrono_literals;
using test::ColumnSensor;

class ColumnCutterTest : public ::testing::Test {
 protected:
  void Add(const ColumnSensor& sensor, std::int64_t index, int num_lost = 0) {
    const auto packet = sensor.Make(index);
    cutter_.Add({.packet = &packet, .head = &sensor.head, .host_time = {}, .time = packet.stamp, .num_lost = num_lost, .is_restart = false}, {}, {});
  }

  std::vector<Scan> scans_;
  ColumnCutter cutter_{DegToRad(85.0), [this](const Scan& scan) { scans_.push_back(scan); }};
  ColumnSensor sensor_;
};

TEST_F(ColumnCutterTest, CutsWithinPacketsAtTheAzimuthOfTheConfig) {
  for (int i = 0; i < 100; ++i) Add(sensor_, i);
  ASSERT_EQ(scans_.size(), 3U);
  EXPECT_TRUE(scans_[0].is_partial_start);
  EXPECT_EQ(scans_[0].num_columns(), 85);
  for (const std::size_t scan : {1U, 2U}) {
    EXPECT_FALSE(scans_[scan].is_partial_start || scans_[scan].is_partial_end || scans_[scan].has_hole);
    EXPECT_EQ(scans_[scan].num_columns(), 360);
    EXPECT_NEAR(scans_[scan].azimuth_rad.front(), DegToRad(85.0), 1e-6);
    EXPECT_NEAR(scans_[scan].rate_radps, 10.0 * kTwoPi, 0.01);
    EXPECT_EQ(scans_[scan].range.size(), 3U * 360U);
  }
  EXPECT_EQ(scans_[2].time - scans_[1].time, 100'000us);
  cutter_.End({});
  EXPECT_TRUE(scans_.back().is_partial_end);
}

TEST_F(ColumnCutterTest, SharesALossAcrossTheCutAmongBothScans) {
  for (int i = 0; i < 80; ++i) {
    if (i < 42 || i > 46) Add(sensor_, i, i == 47 ? 5 : 0);  // 420 to 469 deg: the cut of 445 lies in it
  }
  ASSERT_EQ(scans_.size(), 2U);
  EXPECT_TRUE(scans_[1].has_hole);
  EXPECT_EQ(scans_[1].num_lost_packets, 3);
  EXPECT_FALSE(scans_[1].is_partial_end);
  cutter_.End({});
  EXPECT_TRUE(scans_[2].has_hole);
  EXPECT_EQ(scans_[2].num_lost_packets, 3);
}

TEST_F(ColumnCutterTest, TakesTheUnitInWhichTheFarthestReturnFits) {
  struct Case {
    std::uint32_t range_mm;
    double unit_m;
    std::uint16_t count;
  };
  for (const auto& one : {Case{65'500, 0.001, 65'500}, Case{65'535, 0.002, 32'768}, Case{131'000, 0.002, 65'500}, Case{200'001, 0.004, 50'000},
                          Case{500'000, 0.008, 62'500}}) {
    scans_.clear();
    sensor_.range_mm = one.range_mm;
    Add(sensor_, 0);
    cutter_.End({});
    ASSERT_EQ(scans_.size(), 1U);
    EXPECT_DOUBLE_EQ(scans_[0].range_unit_m, one.unit_m) << one.range_mm;
    EXPECT_EQ(scans_[0].range[0], one.count) << one.range_mm;
    EXPECT_NEAR(scans_[0].range[0] * one.unit_m, one.range_mm * 0.001, 0.5 * one.unit_m + 1e-9);
  }
  EXPECT_EQ(cutter_.num_too_far(), 0);
}

// An overflow that wraps would be an obstacle beside the boat.
TEST_F(ColumnCutterTest, LeavesOutAndCountsWhatDoesNotFitAnyUnit) {
  sensor_.range_mm = 524'279;  // rings at 524.279, .280, .281 m: the last is beyond 65 535 x 8 mm
  Add(sensor_, 0);
  cutter_.End({});
  ASSERT_EQ(scans_.size(), 1U);
  EXPECT_EQ(scans_[0].range[0], 65'535);
  EXPECT_EQ(scans_[0].range[2], 0);
  EXPECT_EQ(scans_[0].reflectivity[2], 0);
  EXPECT_EQ(cutter_.num_too_far(), 10);
}

TEST_F(ColumnCutterTest, EndsTheScanWhereTheHeadChanges) {
  ColumnSensor other;
  other.head.returns = {ReturnKind::kLast};
  for (int i = 10; i < 20; ++i) Add(i < 15 ? sensor_ : other, i);
  cutter_.End({});
  ASSERT_EQ(scans_.size(), 2U);
  EXPECT_EQ(scans_[0].head->returns, std::vector{ReturnKind::kStrongest});
  EXPECT_EQ(scans_[1].head->returns, std::vector{ReturnKind::kLast});
  EXPECT_TRUE(scans_[0].is_partial_end);
}

TEST_F(ColumnCutterTest, BoundsAScanOfAHeadThatStands) {
  for (int i = 0; i < 2000; ++i) {
    auto packet = sensor_.Make(i);
    for (auto& column : packet.columns) column.azimuth_rad = 1.0;
    cutter_.Add({.packet = &packet, .head = &sensor_.head, .host_time = {}, .time = packet.stamp, .num_lost = 0, .is_restart = false}, {}, {});
  }
  EXPECT_EQ(cutter_.num_capped(), 2);
}

}  // namespace
}  // namespace lookout::lidar
