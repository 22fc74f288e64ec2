// Scans of walls and posts that stand or move, as a lidar of 16 rings on a boat that goes on an arc would see them.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "services/odometer/core/odometer.hpp"

namespace lookout::odometer {

/// An upright wall on the water, from one place to another (map: x, y), with a speed.
struct Wall {
  Eigen::Vector2d from_m;
  Eigen::Vector2d to_m;
  double height_m = 3.0;
  Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();
};

/// Four walls around a middle.
inline void AddBox(const Eigen::Vector2d& middle_m, double length_m, double width_m, const Eigen::Vector2d& velocity_mps, std::vector<Wall>& walls) {
  const Eigen::Vector2d a(length_m / 2, width_m / 2);
  const Eigen::Vector2d b(-length_m / 2, width_m / 2);
  for (const auto& [from, to] : {std::pair{a, b}, {b, Eigen::Vector2d(-a)}, {Eigen::Vector2d(-a), Eigen::Vector2d(-b)}, {Eigen::Vector2d(-b), a}}) {
    walls.push_back({middle_m + from, middle_m + to, 3.0, velocity_mps});
  }
}

/// The boat goes on an arc: speed forward and turn, clockwise from above; at time 0 it is at the origin with its bow along x.
struct Arc {
  double speed_mps = 0.0;
  double turn_radps = 0.0;

  double BearingRad(double time_s) const { return -turn_radps * time_s; }  // counter-clockwise from x
  Eigen::Vector2d PlaceM(double time_s) const {
    if (std::abs(turn_radps) < 1e-9) return {speed_mps * time_s, 0.0};
    const double radius_m = speed_mps / -turn_radps;
    const double bearing_rad = BearingRad(time_s);
    return {radius_m * std::sin(bearing_rad), radius_m * (1.0 - std::cos(bearing_rad))};
  }
};

constexpr double kLidarHeightM = 1.5;
constexpr double kScanS = 0.1;
constexpr int kNumColumns = 900;

/// Scan `number` (from 0), each shot at its own time.
///
/// @param arc  an Arc, or another way with BearingRad and PlaceM
template <typename Way = Arc>
Scan MakeScan(int number, const std::vector<Wall>& walls, const Way& arc) {
  Scan scan;
  const double begin_s = number * kScanS;
  scan.time = Utime(std::chrono::microseconds(1'700'000'000'000'000 + static_cast<std::int64_t>(number) * 100'000));
  scan.end_time = scan.time + std::chrono::microseconds(99'889);
  scan.seq = number;
  scan.range_unit_m = 0.002;
  for (int ring = 0; ring < 16; ++ring) scan.rings.push_back({(-15.0 + 2.0 * ring) * std::numbers::pi / 180.0, 0.0, 0, 0.0});
  for (int column = 0; column < kNumColumns; ++column) {
    const double azimuth_rad = 2.0 * std::numbers::pi * column / kNumColumns;
    scan.azimuth_rad.push_back(azimuth_rad);
    scan.time_ns.push_back(static_cast<std::int64_t>(99'889'000.0 * column / (kNumColumns - 1)));
    const double time_s = begin_s + static_cast<double>(scan.time_ns.back()) * 1e-9;
    const Eigen::Vector2d place_m = arc.PlaceM(time_s);
    const double bearing_rad = arc.BearingRad(time_s) - azimuth_rad;
    const Eigen::Vector2d beam(std::cos(bearing_rad), std::sin(bearing_rad));
    std::vector<std::uint16_t> ranges(16, 0);
    std::vector<double> nearest_m(16, 100.0);
    for (const auto& wall : walls) {
      const Eigen::Vector2d from_m = wall.from_m + wall.velocity_mps * time_s - place_m;
      const Eigen::Vector2d along_m = wall.to_m - wall.from_m;
      const double cross = beam.x() * along_m.y() - beam.y() * along_m.x();
      if (std::abs(cross) < 1e-9) continue;
      const double distance_m = (from_m.x() * along_m.y() - from_m.y() * along_m.x()) / cross;
      const double share = (from_m.x() * beam.y() - from_m.y() * beam.x()) / cross;
      if (distance_m <= 0.0 || share < 0.0 || share > 1.0) continue;
      for (std::size_t ring = 0; ring < 16; ++ring) {
        const double elevation_rad = scan.rings[ring].elevation_rad;
        const double height_m = kLidarHeightM + distance_m * std::tan(elevation_rad);
        if (height_m < 0.0 || height_m > wall.height_m || distance_m >= nearest_m[ring]) continue;
        nearest_m[ring] = distance_m;
        ranges[ring] = static_cast<std::uint16_t>(std::lround(distance_m / std::cos(elevation_rad) / scan.range_unit_m));
      }
    }
    scan.range.insert(scan.range.end(), ranges.begin(), ranges.end());
  }
  return scan;
}

inline OdometerParams MadeParams() {
  OdometerParams params;
  params.standing.T_vessel_lidar.translation().z() = kLidarHeightM;  // the reference point lies on the water
  params.standing.own_vessel_box_m.setEmpty();
  return params;
}

/// A basin of 60 m by 40 m around the origin, with two boxes in it.
inline std::vector<Wall> Basin() {
  std::vector<Wall> walls;
  AddBox({5.0, 0.0}, 60.0, 40.0, Eigen::Vector2d::Zero(), walls);
  AddBox({12.0, 10.0}, 6.0, 2.0, Eigen::Vector2d::Zero(), walls);
  AddBox({-8.0, -9.0}, 3.0, 3.0, Eigen::Vector2d::Zero(), walls);
  return walls;
}

}  // namespace lookout::odometer
