#include "services/plotter/core/sectors.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <vector>

#include "services/plotter/core/lidar_sight.hpp"

namespace lookout::plotter {
namespace {

using Eigen::Vector2d;

constexpr double kNothing = std::numeric_limits<double>::infinity();

Vector2d At(double bearing_deg, double range_m) { return {range_m * std::cos(DegToRad(bearing_deg)), -range_m * std::sin(DegToRad(bearing_deg))}; }

std::vector<std::size_t> Hit(const Sectors& sectors) {
  std::vector<std::size_t> hit;
  for (std::size_t i = 0; i < kNumSectors; ++i) {
    if (sectors.distance_m(i) < kNothing) hit.push_back(i);
  }
  return hit;
}

TEST(Sectors, AreCentredOnTheBowAndRunClockwise) {
  EXPECT_EQ(Sectors::IndexOf(At(0.0, 1.0)), 0U);
  EXPECT_EQ(Sectors::IndexOf(At(2.4, 1.0)), 0U);
  EXPECT_EQ(Sectors::IndexOf(At(-2.4, 1.0)), 0U);
  EXPECT_EQ(Sectors::IndexOf(At(2.6, 1.0)), 1U);
  EXPECT_EQ(Sectors::IndexOf(At(-2.6, 1.0)), 71U);
  EXPECT_EQ(Sectors::IndexOf(At(90.0, 1.0)), 18U);
  EXPECT_EQ(Sectors::IndexOf(At(180.0, 1.0)), 36U);
  EXPECT_EQ(Sectors::IndexOf(At(270.0, 1.0)), 54U);
}

TEST(Sectors, HoldAnEdgeAcrossTheBowInEachSectorThatItCrosses) {
  for (const bool is_turned : {false, true}) {
    Sectors sectors;
    const Vector2d port(10.0, 1.0);
    const Vector2d starboard(10.0, -1.0);
    is_turned ? sectors.AddEdge(starboard, port) : sectors.AddEdge(port, starboard);
    EXPECT_EQ(Hit(sectors), (std::vector<std::size_t>{0, 1, 71}));
    EXPECT_DOUBLE_EQ(sectors.distance_m(0), 10.0);
    EXPECT_NEAR(sectors.distance_m(1), 10.0 / std::cos(DegToRad(2.5)), 1e-9);
    EXPECT_NEAR(sectors.distance_m(71), sectors.distance_m(1), 1e-9);
    EXPECT_DOUBLE_EQ(sectors.nearest_m(0).x(), 10.0);
    EXPECT_NEAR(sectors.nearest_m(0).y(), 0.0, 1e-12);
  }
}

TEST(Sectors, GoTheShortWayRound) {
  Sectors sectors;
  sectors.AddEdge(At(100.0, 5.0), At(260.0, 5.0));  // astern
  for (const auto sector : Hit(sectors)) {
    EXPECT_GE(sector, 20U);
    EXPECT_LE(sector, 52U);
  }
  EXPECT_EQ(Hit(sectors).size(), 33U);
}

TEST(Sectors, AreAllHitByAnOutlineAroundTheBoat) {
  Sectors sectors;
  sectors.AddOutline(std::vector<Vector2d>{{5.0, 3.0}, {-7.0, 3.0}, {-7.0, -4.0}, {5.0, -4.0}});
  EXPECT_EQ(Hit(sectors).size(), kNumSectors);
  EXPECT_DOUBLE_EQ(sectors.distance_m(0), 5.0);
  EXPECT_DOUBLE_EQ(sectors.distance_m(18), 4.0);
  EXPECT_DOUBLE_EQ(sectors.distance_m(36), 7.0);
  EXPECT_DOUBLE_EQ(sectors.distance_m(54), 3.0);
}

// Against the edge in small steps, at any place and length.
TEST(Sectors, HoldTheNearestPlaceOfAnyEdge) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-30.0, 30.0);
  for (int run = 0; run < 100; ++run) {
    const Vector2d from(place(random), place(random));
    const Vector2d to(place(random), place(random));
    Sectors sectors;
    sectors.AddEdge(from, to);
    std::vector<double> truth(kNumSectors, kNothing);
    constexpr int kSteps = 5'000;
    for (int i = 0; i <= kSteps; ++i) {
      const Vector2d p = from + (to - from) * i / kSteps;
      auto& least = truth[Sectors::IndexOf(p)];
      least = std::min(least, p.norm());
    }
    for (std::size_t i = 0; i < kNumSectors; ++i) {
      // A sector that the edge touches by less than a step may have none of the steps.
      if (truth[i] == kNothing) continue;
      EXPECT_NEAR(sectors.distance_m(i), truth[i], 0.02) << "run " << run << " sector " << i;
      EXPECT_NEAR(sectors.nearest_m(i).norm(), sectors.distance_m(i), 1e-12);
    }
  }
}

class Sight : public ::testing::Test {
 protected:
  // Rings of 2 deg from -7 to 7.
  std::vector<float> elevation_rad_;
  std::vector<float> offset_rad_ = std::vector<float>(8, 0.0F);
  LidarSightParams params_{.above_water_m = 1.5, .min_range_m = 0.5, .reach_m = 40.0};

  Sight() {
    for (int i = 0; i < 8; ++i) elevation_rad_.push_back(static_cast<float>(DegToRad(2.0 * i - 7.0)));
    params_.own_vessel_box_m = Eigen::AlignedBox3d(Eigen::Vector3d(-2.0, -1.0, -1.0), Eigen::Vector3d(2.0, 1.0, 3.0));
    params_.T_vessel_lidar.translation() = Eigen::Vector3d(0.5, 0.0, 1.0);
  }
  // One scan of columns every 0.4 deg, of which `use` says whether they come, with the range of each ring.
  template <typename Use>
  std::array<bool, kNumSectors> Looked(Use use, double turned_rad = 0.0) {
    LidarSight sight(params_, elevation_rad_);
    for (int i = 0; i < 900; ++i) {
      std::vector<float> range_m(8, 0.0F);
      if (!use(i * 0.4, range_m)) continue;
      sight.Add({DegToRad(i * 0.4), DegToRad(0.4), turned_rad, offset_rad_, range_m});
    }
    const SectorSight sectors(std::vector{sight.place_m()}, params_.own_vessel_box_m, params_.reach_m);
    const std::array<const LidarSight*, 1> sights{&sight};
    return sectors.Looked(sights);
  }
  static int Count(const std::array<bool, kNumSectors>& looked) { return static_cast<int>(std::count(looked.begin(), looked.end(), true)); }
};

TEST_F(Sight, IsAllRoundOverWaterThatGivesNoReturns) {
  EXPECT_EQ(Count(Looked([](double, auto&) { return true; })), 72);
}

TEST_F(Sight, EndsWhereTheLidarSendsNothing) {
  // As set on the lidar's own page: 180 deg to starboard are left out.
  const auto looked = Looked([](double azimuth_deg, auto&) { return azimuth_deg < 0.2 || azimuth_deg > 180.0; });
  for (std::size_t i = 1; i < 36; ++i) EXPECT_FALSE(looked[i]) << i;
  for (std::size_t i = 40; i < 69; ++i) EXPECT_TRUE(looked[i]) << i;
}

TEST_F(Sight, EndsWhereTheSegmenterTakesNothing) {
  params_.field_of_view = {DegToRad(270.0), DegToRad(180.0)};
  const auto looked = Looked([](double, auto&) { return true; });
  EXPECT_TRUE(looked[0]);
  EXPECT_TRUE(looked[12]);
  EXPECT_FALSE(looked[15]);  // beside the boat it begins abaft of the lidar
  EXPECT_FALSE(looked[20]);
  EXPECT_FALSE(looked[36]);
  EXPECT_FALSE(looked[52]);
}

TEST_F(Sight, EndsAtTheOwnBoat) {
  // A wheelhouse abaft of the lidar, from 160 to 200 deg; returns of things beyond own_vessel hide nothing.
  const auto looked = Looked([](double azimuth_deg, std::vector<float>& range_m) {
    if (azimuth_deg > 160.0 && azimuth_deg < 200.0) range_m.assign(8, 1.0F);
    if (azimuth_deg < 90.0) range_m.assign(8, 12.0F);
    return true;
  });
  for (std::size_t i = 33; i < 40; ++i) EXPECT_FALSE(looked[i]) << i;
  EXPECT_TRUE(looked[0]);
  EXPECT_TRUE(looked[17]);
  EXPECT_TRUE(looked[28]);
  EXPECT_TRUE(looked[44]);
}

TEST_F(Sight, IsNoneWhereEachBeamPassesAboveOrMeetsTheWaterBefore) {
  for (auto& elevation_rad : elevation_rad_) elevation_rad = std::abs(elevation_rad) < 0.06F ? 0.2F : elevation_rad;
  EXPECT_EQ(Count(Looked([](double, auto&) { return true; })), 0);
}

TEST_F(Sight, IsHeldByOneColumnADegreeAndLessOfACoarseLidar) {
  LidarSight sight(params_, elevation_rad_);
  const std::vector<float> range_m(8, 0.0F);
  for (int i = 0; i < 240; ++i) sight.Add({DegToRad(1.5 * i), DegToRad(1.5), 0.0, offset_rad_, range_m});
  const SectorSight sectors(std::vector{sight.place_m()}, params_.own_vessel_box_m, params_.reach_m);
  const std::array<const LidarSight*, 1> sights{&sight};
  EXPECT_EQ(Count(sectors.Looked(sights)), 72);
}

TEST_F(Sight, TurnsWithTheBoat) {
  const auto blind_ahead = [](double azimuth_deg, auto&) { return azimuth_deg > 10.0 && azimuth_deg < 350.0; };
  EXPECT_FALSE(Looked(blind_ahead)[0]);
  // The bow has turned 30 deg to starboard since: what was ahead is at 330 deg.
  const auto looked = Looked(blind_ahead, DegToRad(30.0));
  EXPECT_FALSE(looked[66]);
  EXPECT_TRUE(looked[2]);
}

TEST_F(Sight, OfTwoLidarsEachCoversForTheOther) {
  LidarSight ahead(params_, elevation_rad_);
  LidarSight astern(params_, elevation_rad_);
  const std::vector<float> range_m(8, 0.0F);
  for (int i = 0; i < 900; ++i) {
    const double azimuth_deg = i * 0.4;
    const bool is_ahead = azimuth_deg < 100.0 || azimuth_deg > 260.0;
    (is_ahead ? ahead : astern).Add({DegToRad(azimuth_deg), DegToRad(0.4), 0.0, offset_rad_, range_m});
  }
  const SectorSight sectors(std::vector{ahead.place_m(), astern.place_m()}, params_.own_vessel_box_m, params_.reach_m);
  EXPECT_EQ(Count(sectors.Looked(std::array<const LidarSight*, 2>{&ahead, &astern})), 72);
  EXPECT_LT(Count(sectors.Looked(std::array<const LidarSight*, 2>{&ahead, nullptr})), 42);
}

}  // namespace
}  // namespace lookout::plotter
