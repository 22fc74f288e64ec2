#include "tools/export/own_map.hpp"

#include <gtest/gtest.h>
#include <random>
#include <set>
#include <vector>

namespace lookout::exporter::own_map {
namespace {

TEST(OwnMapDays, AreTheNewestHundredEachOnce) {
  std::vector<std::int32_t> days;
  for (const int day : {5, 3, 5, 4}) AddDay(day, days);
  EXPECT_EQ(days, (std::vector<std::int32_t>{3, 4, 5}));
  for (int day = 100; day < 205; ++day) AddDay(day, days);
  EXPECT_EQ(days.size(), kMostMapDays);
  EXPECT_EQ(days.front(), 105);
  AddDay(1, days);  // older than all that are kept
  EXPECT_EQ(days.front(), 105);
}

TEST(OwnMapDays, AddUpTheScansOfADayWithoutOverflow) {
  std::vector<DayScans> days;
  AddScans({7, 2}, days);
  AddScans({6, 1}, days);
  AddScans({7, 3}, days);
  EXPECT_EQ(days, (std::vector<DayScans>{{6, 1}, {7, 5}}));
  AddScans({7, kMostDayScans}, days);
  AddScans({7, kMostDayScans}, days);
  EXPECT_EQ(days.back().num_scans, kMostDayScans);
}

TEST(EarthGrid, FindsEachCellByItsMiddle) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 20'000; ++i) {
    const double latitude_deg = std::uniform_real_distribution(-90.0, 90.0)(random);
    const double longitude_deg = std::uniform_real_distribution(-180.0, 180.0)(random);
    const auto cell = earth_grid::CellAt(latitude_deg, longitude_deg);
    const auto middle = earth_grid::MiddleOf(cell);
    EXPECT_EQ(earth_grid::CellAt(middle.latitude_deg, middle.longitude_deg), cell) << latitude_deg << " " << longitude_deg;
    if (std::abs(latitude_deg) > 85.0) continue;
    const auto off_m = LocalFrame(middle).Forward({latitude_deg, longitude_deg, 0.0});
    EXPECT_LE(off_m.head<2>().cwiseAbs().maxCoeff(), 0.2555) << "half a cell at most";
  }
}

TEST(EarthGrid, HasTheEndsOfTheEarth) {
  for (const double latitude_deg : {-90.0, 0.0, 90.0}) {
    for (const double longitude_deg : {-180.0, 0.0, 180.0}) {
      const auto cell = earth_grid::CellAt(latitude_deg, longitude_deg);
      EXPECT_EQ(earth_grid::CellAt(earth_grid::MiddleOf(cell).latitude_deg, earth_grid::MiddleOf(cell).longitude_deg), cell);
    }
  }
  EXPECT_EQ(earth_grid::CellAt(10.0, 180.0), earth_grid::CellAt(10.0, -180.0));
}

// Land of a day lies on a grid of its own, of 0.5 m.
TEST(EarthGrid, LeavesNoGapInCellsOfAnotherGrid) {
  for (const double latitude_deg : {0.3, 43.63, -60.1}) {
    const LocalFrame map({latitude_deg, 15.77, 100.0});
    std::set<earth_grid::Cell> cells;
    for (int north = 0; north < 100; ++north) {
      for (int east = 0; east < 100; ++east) {
        const auto place = map.Reverse({0.5 * (east + 0.5), 0.5 * (north + 0.5), 0.0});
        cells.insert(earth_grid::CellAt(place.latitude_deg, place.longitude_deg));
      }
    }
    // In the middle of the square each cell has its four neighbours.
    for (int i = 0; i < 200; ++i) {
      const auto place = map.Reverse({10.0 + 0.15 * i, 10.0 + 0.15 * ((i * 37) % 200), 0.0});
      EXPECT_TRUE(cells.contains(earth_grid::CellAt(place.latitude_deg, place.longitude_deg))) << latitude_deg << " " << i;
    }
    EXPECT_GE(cells.size(), 9'500U);
    EXPECT_LE(cells.size(), 10'000U);
  }
}

TEST(SamePlace, GrowsWithTheDeviationsAndEnds) {
  EXPECT_DOUBLE_EQ(SamePlaceM(0.0, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(SamePlaceM(0.3, 0.4), 2.0);
  EXPECT_DOUBLE_EQ(SamePlaceM(100.0, 0.0), 5.0);
  EXPECT_TRUE(AreOfOneThing(6.0, 3.0));
  EXPECT_FALSE(AreOfOneThing(0.4, 6.0));
  EXPECT_FALSE(AreOfOneThing(6.0, 0.4));
}

}  // namespace
}  // namespace lookout::exporter::own_map
