// Where a dock that touches the shore ends, and what is no dock.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "services/segmenter/core/lookout/jetties.hpp"
#include "tests/unit/segmenter/lookout_stages.hpp"

namespace lookout::segmenter {
namespace {

using test::AddBoat;
using test::See;
using test::Wall;

constexpr double kJettyWaterM = -1.0;  // of the lidar 1 m over it

std::vector<Wall> Turned(std::vector<Wall> walls, double by_rad) {
  for (auto& wall : walls) {
    for (const auto& [x_m, y_m] : {std::pair(&wall.x0_m, &wall.y0_m), std::pair(&wall.x1_m, &wall.y1_m)}) {
      const double x = *x_m;
      *x_m = x * std::cos(by_rad) - *y_m * std::sin(by_rad);
      *y_m = x * std::sin(by_rad) + *y_m * std::cos(by_rad);
    }
  }
  return walls;
}

// A winding bank along y = 24 m.
std::vector<Wall> Bank() {
  const auto bank_m = [](double x_m) { return 24.0 + 0.8 * std::sin(x_m / 3.0) + 0.3 * std::sin(x_m * 1.7); };
  std::vector<Wall> walls;
  for (double x_m = -25.0; x_m < 25.0; x_m += 0.5) walls.push_back({x_m, bank_m(x_m), x_m + 0.5, bank_m(x_m + 0.5), kJettyWaterM, 0.4});
  return walls;
}

// 2 m wide; 8 m of it stand out from the bank, `lean_rad` off the straight way to the lidar's side.
std::vector<Wall> BankWithDock(double x_m, double lean_rad) {
  auto walls = Bank();
  const double along = kPi / 2 + lean_rad;
  AddBoat(walls, x_m - 3.0 * std::cos(along), 24.0 - 3.0 * std::sin(along), along, 10.0, 2.0, kJettyWaterM, 0.0);
  return walls;
}

int NumJettyReturns(const Scan& scan) {
  const auto returns = ClassifyReturns(scan, {}).returns;
  ScanGrid grid;
  RunTable runs;
  grid.Fill(scan, returns, Eigen::Matrix3d::Identity());
  runs.Find(grid, LookoutParams{}.link);
  runs.CutJetties(grid);
  int num_returns = 0;
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(returns.size()); ++i) num_returns += runs[runs.OfReturn(i)].is_jetty ? 1 : 0;
  return num_returns;
}

TEST(Jetties, ADockThatTouchesTheBankIsAThingByItself) {
  // Turned so that it lies on the seam of the circle, too.
  for (const double turned_rad : {0.0, 1.0, -1.2, -1.3, -1.36, -1.8}) {
    for (const double side : {-1.0, 1.0}) {
      const auto scan = See(Turned(BankWithDock(side * 5.0, side * 0.25), turned_rad));
      const auto segments = SegmentScan(scan, {});
      const auto at = [turned_rad](double x_m, double y_m) {
        return std::pair(x_m * std::cos(turned_rad) - y_m * std::sin(turned_rad), x_m * std::sin(turned_rad) + y_m * std::cos(turned_rad));
      };
      const double out_m = 5.0;  // from the bank along it
      const auto [x_m, y_m] = at(side * 5.0 + side * out_m * std::sin(0.25), 24.0 - out_m * std::cos(0.25));
      const auto dock = test::SegmentsNear(scan, segments, x_m, y_m, 1.5);
      ASSERT_EQ(dock.size(), 1U) << "turned by " << turned_rad << ", side " << side;
      EXPECT_EQ(test::SegmentOf(segments, *dock.begin()).kind, SegmentKind::kObstacle) << "turned by " << turned_rad << ", side " << side;
      const auto [bank_x_m, bank_y_m] = at(side * -8.0, 24.0);
      const auto bank = test::SegmentsNear(scan, segments, bank_x_m, bank_y_m, 1.5);
      ASSERT_EQ(bank.size(), 1U);
      EXPECT_EQ(test::SegmentOf(segments, *bank.begin()).kind, SegmentKind::kLand);
    }
  }
}

TEST(Jetties, TheBendsOfABankAreNone) {
  for (const double turned_rad : {0.0, 1.0, 2.5}) EXPECT_EQ(NumJettyReturns(See(Turned(Bank(), turned_rad))), 0) << turned_rad;
}

TEST(Jetties, TheSidesOfABoatAreNone) {
  for (const double heading_rad : {0.3, 0.8, 1.2, 2.0, 2.7}) {
    std::vector<Wall> walls;
    AddBoat(walls, 14.0, 3.0, heading_rad, 9.0, 3.0, kJettyWaterM, 1.0);
    EXPECT_EQ(NumJettyReturns(See(walls)), 0) << heading_rad;
  }
}

// Longer than it may be, and a stub that does not stand out far enough.
TEST(Jetties, APierAndAStubAreNone) {
  auto pier = Bank();
  AddBoat(pier, 5.0, 15.0, kPi / 2 + 0.2, 22.0, 2.0, kJettyWaterM, 0.0);
  EXPECT_EQ(NumJettyReturns(See(pier)), 0);
  auto stub = Bank();
  AddBoat(stub, 6.0, 24.4, kPi / 2 + 0.2, 3.0, 2.0, kJettyWaterM, 0.0);
  EXPECT_EQ(NumJettyReturns(See(stub)), 0);
}

// Runs stay in the order of their columns when the one over the seam is cut.
TEST(Jetties, CutRunsStayInOrder) {
  int num_over_seam = 0;
  for (double turned_rad = -1.5; turned_rad < -1.0; turned_rad += 0.02) {  // the dock stands 67 to 78 degrees from the seam
    const auto scan = See(Turned(BankWithDock(5.0, 0.25), turned_rad));
    const auto returns = ClassifyReturns(scan, {}).returns;
    ScanGrid grid;
    RunTable runs;
    grid.Fill(scan, returns, Eigen::Matrix3d::Identity());
    runs.Find(grid, LookoutParams{}.link);
    const RunTable uncut = runs;
    runs.CutJetties(grid);
    for (int line = 0; line < grid.num_lines(); ++line) {
      const auto of_line = runs.OfLine(line);
      EXPECT_TRUE(std::ranges::is_sorted(of_line, {}, &Run::first)) << "ring " << line << ", turned by " << turned_rad;
      if (of_line.empty()) continue;
      const segmenter::Run& last = uncut.OfLine(line).back();
      const bool is_over_seam = last.first + last.length > grid.num_columns();
      num_over_seam += is_over_seam && of_line.size() > uncut.OfLine(line).size() ? 1 : 0;
      for (std::int32_t run = runs.FirstOfLine(line); run < runs.FirstOfLine(line + 1); ++run) {
        for (int place = 0; place < runs[run].length; ++place) ASSERT_EQ(runs.OfReturn(ReturnOf(grid, runs[run], place)), run);
      }
    }
  }
  EXPECT_GT(num_over_seam, 0);
}

}  // namespace
}  // namespace lookout::segmenter
