// What is thin: few returns far away, and posts that are seen from a boat that heels.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "services/segmenter/core/lookout/thin_pieces.hpp"
#include "tests/unit/segmenter/lookout_stages.hpp"

namespace lookout::segmenter {
namespace {

using test::EmptyScan;
using test::SetReturn;
using test::Stages;

// Returns in a row at a range, the first of them so far aside of column 400.
void SetRow(Scan& scan, double range_m, double aside_m, int num, int ring = 8) {
  const int first = 400 + static_cast<int>(std::lround(aside_m / (range_m * kTwoPi / 1808)));
  for (int i = 0; i < num; ++i) SetReturn(scan, first + i, ring, range_m);
}

// Single things round about, each more than 2 m from all others and less than 8 m from what is at 40 m, 0 to 1.5 m aside of column 400.
void AddAround(Scan& scan, int num) {
  const double places[][2]{{43.5, -4.0}, {43.5, -1.3}, {43.5, 1.4}, {43.5, 4.1}, {40.0, -4.0}, {40.0, 5.5}, {36.0, -2.5}, {36.0, 0.2}, {36.0, 2.9}};
  for (int i = 0; i < num; ++i) SetRow(scan, places[i][0], places[i][1], 1);
}

TEST(FarReach, IsNoneNearGrowsSteadilyAndEnds) {
  EXPECT_EQ(FarReachM(5.0), 0.0);
  for (double range_m = 5.0; range_m < 130.0; range_m += 0.5) {
    const double growth_m = FarReachM(range_m + 0.5) - FarReachM(range_m);
    EXPECT_GE(growth_m, 0.0) << range_m;
    EXPECT_LE(growth_m, 0.1) << "no jump at " << range_m;
  }
  EXPECT_GT(FarReachM(60.0), 1.0);
  EXPECT_EQ(FarReachM(100.0), FarReachM(130.0));
}

struct Apart {
  double range_m;
  double apart_m;
  bool is_one;
};
constexpr Apart kApart[]{{12.0, 0.5, false}, {12.0, 1.5, false}, {25.0, 0.9, true}, {25.0, 1.1, false},
                         {40.0, 1.5, true},  {40.0, 1.9, true},  {40.0, 2.1, false}};

TEST(FewReturns, AreOfOneFarAway) {
  for (const auto& [range_m, apart_m, is_one] : kApart) {
    auto scan = EmptyScan({});
    SetRow(scan, range_m, 0.0, 1);
    SetRow(scan, range_m, apart_m, 1);
    EXPECT_EQ(SegmentScan(scan, {}).segments.size(), is_one ? 1U : 2U) << apart_m << " m apart at " << range_m << " m";
  }
}

TEST(FewReturns, AreOfABoatBesideThemFarAway) {
  for (const auto& [range_m, apart_m, is_one] : kApart) {
    for (const int side : {-1, 1}) {
      // Four returns are a thin thing, thirty are not.
      for (const int num_returns : {4, 30}) {
        auto scan = EmptyScan({});
        SetRow(scan, range_m, 0.0, num_returns);
        SetRow(scan, range_m, side < 0 ? -apart_m : apart_m + (num_returns - 1) * range_m * kTwoPi / 1808, 1);
        EXPECT_EQ(SegmentScan(scan, {}).segments.size(), is_one ? 1U : 2U)
            << num_returns << " returns, one " << apart_m << " m off on side " << side << " at " << range_m << " m";
      }
    }
  }
}

// Two thin things that are joined when alone are not when many others are near, and then not again.
TEST(FewReturns, InRainJoinNothing) {
  std::vector<bool> are_two;
  for (int num_around = 0; num_around <= 9; ++num_around) {
    auto scan = EmptyScan({});
    SetRow(scan, 40.0, 0.0, 1);
    SetRow(scan, 40.0, 1.5, 1);
    AddAround(scan, num_around);
    const auto num_segments = SegmentScan(scan, {}).segments.size() - static_cast<std::size_t>(num_around);
    ASSERT_TRUE(num_segments == 1 || num_segments == 2) << num_around << " around, " << num_segments;
    are_two.push_back(num_segments == 2);
  }
  EXPECT_FALSE(are_two.front());
  EXPECT_TRUE(are_two.back());
  EXPECT_TRUE(std::ranges::is_sorted(are_two)) << testing::PrintToString(are_two);
}

TEST(FewReturns, InRainAreNotOfABoat) {
  std::vector<bool> are_two;
  for (int num_around = 0; num_around <= 9; ++num_around) {
    auto scan = EmptyScan({});
    for (const int ring : {7, 8}) SetRow(scan, 40.0, -1.2, 10, ring);  // up to 0.05 m aside: 1.25 m long, no thin thing
    SetRow(scan, 40.0, 1.5, 1);
    AddAround(scan, num_around);
    const auto num_segments = SegmentScan(scan, {}).segments.size() - static_cast<std::size_t>(num_around);
    ASSERT_TRUE(num_segments == 1 || num_segments == 2) << num_around << " around, " << num_segments;
    are_two.push_back(num_segments == 2);
  }
  EXPECT_FALSE(are_two.front());
  EXPECT_TRUE(are_two.back());
  EXPECT_TRUE(std::ranges::is_sorted(are_two)) << testing::PrintToString(are_two);
}

// Posts at the corners of 5.5 m by 3.2 m, so many rings high: from ring 5, 5 degrees below the horizon, on.
Scan Dock(double range_m, int last_ring) {
  auto scan = EmptyScan({});
  for (const double behind_m : {0.0, 5.5}) {
    // The hind ones a little wider apart in columns than the front ones hide.
    for (const double aside_m : {-1.6, 1.6}) {
      for (int ring = 5; ring <= last_ring; ++ring) {
        const double elevation_rad = DegToRad(2.0 * ring - 15.0);
        const double level_m = std::hypot(range_m + behind_m, aside_m);
        const int first = 400 + static_cast<int>(std::lround(std::atan2(aside_m, range_m + behind_m) / kTwoPi * 1808));
        for (int i = 0; i < 2; ++i) SetReturn(scan, first + i, ring, level_m / std::cos(elevation_rad));
      }
    }
  }
  return scan;
}

bool IsDock(const Scan& scan) {
  Stages stages(scan);
  EXPECT_EQ(stages.pieces.size(), 4);
  ThinPieces(LookoutParams{}).Join(stages.grid, stages.pieces);
  stages.pieces.Settle(stages.grid);
  return stages.pieces.roots().size() == 1 && stages.pieces.FactsOf(stages.pieces.roots()[0]).is_dock;
}

// 3.5 m over the water and 0.05 m for each metre of range: 5.5 m at 40 m.
TEST(Docks, PostsAreStillPostsOnABoatThatHeels) {
  EXPECT_TRUE(IsDock(Dock(40.0, 9))) << "3.1 m and 3.4 m high";
  auto heeled = Dock(40.0, 9);
  for (auto& beam : heeled.head.rings) beam.elevation_rad += static_cast<float>(1.5 / 40.0);
  EXPECT_TRUE(IsDock(heeled)) << "seen 1.5 m and 1.7 m too high: 4.6 m and 5.1 m";
  EXPECT_FALSE(IsDock(Dock(40.0, 11))) << "masts of 5.9 m and 6.6 m";
}

// The hind ones are the higher. Ring 11 looks 7 degrees up: as high as the limit at 34.3 m.
TEST(Docks, PostsAreLowerThanMasts) {
  EXPECT_TRUE(IsDock(Dock(28.0, 11)));
  EXPECT_FALSE(IsDock(Dock(30.5, 11))) << "the hind ones at 36 m are masts";
}

}  // namespace
}  // namespace lookout::segmenter
