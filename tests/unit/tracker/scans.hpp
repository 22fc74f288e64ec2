// Scans of a boat that heads north, for the tests of the tracker's core.
#pragma once

#include <chrono>

#include "services/tracker/core/scan.hpp"

namespace lookout::tracker::test {

inline constexpr double kScanS = 0.1;

/// A scan in which nothing was seen yet, from a boat of which everything is known.
///
/// @param number   from 0: scans follow each other without a gap
/// @param own_m    on the map, at its begin and at its end
inline ScanInput MakeScan(int number, const Eigen::Vector2d& own_m, const Eigen::Vector2d& own_mps = Eigen::Vector2d::Zero()) {
  constexpr Utime kBegin{std::chrono::seconds(1'700'000'000)};
  constexpr std::chrono::milliseconds kScan(100);
  ScanInput input;
  input.seq = number;
  input.time = kBegin + number * kScan;
  input.end_time = input.time + kScan;
  input.datum = {60.0, 20.0, 0.0};
  Pose pose;
  pose.is_placed = true;
  pose.time = input.end_time;
  pose.datum = input.datum;
  pose.position_map_m << own_m, 0.0;
  pose.velocity_map_mps = own_mps;
  input.own = input.own_at_start = pose;
  return input;
}

}  // namespace lookout::tracker::test
