// Where the beams of a boat that leans go.
#include "services/tracker/core/sight.hpp"

#include <array>
#include <gtest/gtest.h>
#include <vector>

#include "common/core/angles.hpp"
#include "tests/unit/tracker/scans.hpp"

namespace lookout::tracker {
namespace {

constexpr double kAboveWaterM = 1.2;
constexpr double kTopM = 1.0;

// Beams three degrees above the horizon of the lidar, all round, none of which met anything. The bow points north.
ScanInput RaisedBeams() {
  auto scan = test::MakeScan(0, Eigen::Vector2d::Zero());
  Sweep sweep;
  sweep.elevation_rad = {static_cast<float>(DegToRad(3.0))};
  sweep.azimuth_offset_rad = {0.0F};
  for (int column = 0; column < 1800; ++column) {
    sweep.azimuth_rad.push_back(static_cast<float>(kTwoPi * column / 1800));
    sweep.time.push_back(scan.time);
    sweep.range_m.push_back(0.0F);
    sweep.label.push_back(0);
  }
  scan.sweep = sweep;
  return scan;
}

// Beams that would have met a post 15 m off. From the lidar on it is 1.2 m down to the water, and 0.7 m up to where a level boat's beams pass it.
double NumOpen(ScanInput scan, double roll_deg, double pitch_deg, const Eigen::Vector2d& place_m) {
  for (auto* pose : {&*scan.own, &*scan.own_at_start}) {
    pose->roll_rad = DegToRad(roll_deg);
    pose->pitch_rad = DegToRad(pitch_deg);
  }
  Sight sight(Eigen::Isometry3d::Identity(), kAboveWaterM, 100.0);
  if (!sight.Begin(scan)) return -1.0;
  std::vector<Eigen::Vector2d> outline_m;
  for (const auto& [east, north] : std::array<std::array<double, 2>, 4>{{{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}}) {
    outline_m.emplace_back(place_m + Eigen::Vector2d(east, north));
  }
  return sight.At(outline_m, kTopM).num_open;
}

constexpr std::array<const char*, 4> kNames{"ahead", "to starboard", "astern", "to port"};

TEST(Sight, OfABoatThatLeansIsLowerOnTheSideThatIsDown) {
  const std::vector<Eigen::Vector2d> places_m{{0.0, 15.0}, {15.0, 0.0}, {0.0, -15.0}, {-15.0, 0.0}};
  struct Case {
    double roll_deg;
    double pitch_deg;
    std::size_t seen;  // the one place on which the beams come down
  };
  // Roll is positive with the starboard side down, pitch with the bow up.
  for (const auto& [roll_deg, pitch_deg, seen] : {Case{5.0, 0.0, 1}, Case{-5.0, 0.0, 3}, Case{0.0, -5.0, 0}, Case{0.0, 5.0, 2}}) {
    for (std::size_t i = 0; i < places_m.size(); ++i) {
      const double num_open = NumOpen(RaisedBeams(), roll_deg, pitch_deg, places_m[i]);
      EXPECT_EQ(num_open > 0.0, i == seen) << "roll " << roll_deg << ", pitch " << pitch_deg << ", " << kNames.at(i) << ": " << num_open;
    }
  }
}

}  // namespace
}  // namespace lookout::tracker
