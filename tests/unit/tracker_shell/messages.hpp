// Messages of a boat on a lake, for the tests of the tracker: scans of 0.1 s, ten columns of two rings.
#pragma once

#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "common/core/angles.hpp"
#include "lookout/alert_ack_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/segments_t.hpp"
#include "services/tracker/params.hpp"
#include "tests/support/messages.hpp"

namespace lookout::tracker::test {

inline constexpr std::int64_t kStartUs = 1'800'000'000'000'000;  // a multiple of 20 ms
inline constexpr std::int64_t kScanUs = 100'000;
inline constexpr std::int64_t kLastShotUs = 99'000;  // of a scan
inline constexpr std::int32_t kNumColumns = 10;
inline constexpr std::int32_t kNumRings = 2;
inline constexpr GeodeticPlace kLake{43.7, -72.3, 100.0};

/// A boat of 2 m x 1 m that wants 5 m of room.
inline Params MakeParams() {
  Params params;
  params.tracker.max_range_m = 120.0;
  params.tracker.own_hull_m = {{-1.0, -0.5}, {1.0, -0.5}, {1.0, 0.5}, {-1.0, 0.5}};
  params.tracker.encounter = {.limit_m = 5.0, .look_ahead_s = 30.0};
  params.look_out.limits.cpa_limit_m = 5.0;
  return params;
}

/// @param position_m  on the map: east, north
inline obstacle_t MakeObstacle(std::int32_t id, std::int64_t utime_us, std::pair<double, double> position_m) {
  obstacle_t obstacle{};
  obstacle.id = id;
  obstacle.utime_us = utime_us;
  obstacle.confidence = obstacle_t::CONFIDENCE_SURE;
  obstacle.thing_probability = 0.95F;
  obstacle.latitude_deg = 43.7;
  obstacle.longitude_deg = -72.3;
  obstacle.position_map_m[0] = position_m.first;
  obstacle.position_map_m[1] = position_m.second;
  obstacle.covariance_m2[0] = obstacle.covariance_m2[2] = 1.0;
  obstacle.covariance_relative_m2[0] = obstacle.covariance_relative_m2[2] = 0.01;
  obstacle.range_m = 10.0F;
  obstacle.num_points = 5;
  const auto east_m = static_cast<float>(position_m.first);
  const auto north_m = static_cast<float>(position_m.second);
  obstacle.nearest_vessel_m[0] = east_m;
  obstacle.nearest_vessel_m[1] = north_m;
  obstacle.num_footprint = obstacle.num_map = 3;
  obstacle.footprint_east_m = obstacle.footprint_vessel_x_m = {east_m, east_m + 0.5F, east_m};
  obstacle.footprint_north_m = obstacle.footprint_vessel_y_m = {north_m, north_m, north_m + 0.5F};
  return obstacle;
}

inline obstacles_t MakeObstacles(std::int64_t offset_us, std::int64_t seq, std::vector<obstacle_t> obstacles) {
  auto message = support::OfScan<obstacles_t>(kStartUs + offset_us, seq, kLastShotUs);
  support::SetDatum(message, kLake);
  support::Fill(message, std::move(obstacles));
  return message;
}

inline lidar_scan_t MakeScan(std::int64_t offset_us, std::int64_t seq) {
  auto message = support::OfScan<lidar_scan_t>(kStartUs + offset_us, seq, kLastShotUs);
  std::vector<float> azimuth_rad;
  std::vector<std::int32_t> time_ns;
  for (int column = 0; column < kNumColumns; ++column) {
    azimuth_rad.push_back(0.6F * static_cast<float>(column));
    time_ns.push_back(9'900'000 * column);
  }
  support::FillColumns(message, azimuth_rad, time_ns, 0);
  for (int cell = 0; cell < message.num_cells; ++cell) {
    message.range[static_cast<std::size_t>(cell)] = static_cast<std::int16_t>(1000 * (cell / kNumRings + 1) + cell % kNumRings);
  }
  return message;
}

/// Over empty water, a column each half degree from one azimuth clockwise to another: what a lidar sends whose field of view is set so.
inline lidar_scan_t MakeSweep(std::int64_t offset_us, std::int64_t seq, double from_deg = 0.0, double to_deg = 360.0) {
  auto message = support::OfScan<lidar_scan_t>(kStartUs + offset_us, seq, kLastShotUs);
  std::vector<float> azimuth_rad;
  std::vector<std::int32_t> time_ns;
  for (double azimuth_deg = from_deg; azimuth_deg < to_deg; azimuth_deg += 0.5) {
    azimuth_rad.push_back(static_cast<float>(DegToRad(azimuth_deg)));
    time_ns.push_back(static_cast<std::int32_t>(2.75e5 * azimuth_deg));
  }
  support::FillColumns(message, azimuth_rad, time_ns, 0);
  return message;
}

/// Of a scan in which nothing came back.
inline segments_t MakeNoSegments(const lidar_scan_t& scan) { return support::LabelsOf(scan, 0); }

inline segments_t MakeSegments(std::int64_t offset_us, std::int64_t seq) {
  auto message = support::LabelsOf(MakeScan(offset_us, seq), 0);
  std::iota(message.label.begin(), message.label.end(), std::int16_t{0});
  return message;
}

/// @param offset_us  a multiple of 20 ms
inline pose_t MakePose(std::int64_t offset_us, std::int64_t seq) {
  pose_t message{};
  message.utime_us = kStartUs + offset_us;
  message.seq = seq;
  support::SetDatum(message, kLake);
  message.latitude_deg = kLake.latitude_deg;
  message.longitude_deg = kLake.longitude_deg;
  message.ellipsoid_height_m = kLake.ellipsoid_height_m;
  for (int i = 0; i < 9; ++i) message.covariance[i][i] = 0.01;
  return message;
}

}  // namespace lookout::tracker::test
