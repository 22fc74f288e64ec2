// Scans for tests and benchmarks: beams of a VLP-16 cast on upright walls, in the lidar frame.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "common/core/angles.hpp"
#include "services/segmenter/core/scan.hpp"

namespace lookout::segmenter::test {

inline constexpr double kRangeUnitM = 0.002;
inline constexpr Utime kScanTime{std::chrono::microseconds(1'700'000'000'000'000)};

struct Shape {
  int num_columns = 1808;
  int num_rings = 16;
  int num_returns = 1;
  double first_azimuth_rad = 0.0;
  double width_rad = kTwoPi;
};

/// A scan without returns: columns evenly spread over the width, rings 2 degrees apart around the horizon, 55.296 us from column to column.
inline Scan EmptyScan(const Shape& shape) {
  Scan scan;
  scan.head.time = kScanTime;
  scan.head.range_unit_m = kRangeUnitM;
  scan.head.num_returns = shape.num_returns;
  scan.head.num_turn_columns = shape.num_columns;
  for (int ring = 0; ring < shape.num_rings; ++ring) {
    scan.head.rings.push_back({static_cast<float>(DegToRad(2.0 * ring - (shape.num_rings - 1))), 0.0F, ring * 2304, 0.0F});
  }
  for (int column = 0; column < shape.num_columns; ++column) {
    const double azimuth_rad = WrapTo2Pi(shape.first_azimuth_rad + shape.width_rad * (column + 0.5) / shape.num_columns);
    scan.columns.azimuth_rad.push_back(static_cast<float>(azimuth_rad));
    scan.columns.time_ns.push_back(column * 55296);
  }
  const auto num_cells = static_cast<std::size_t>(shape.num_columns * shape.num_rings * shape.num_returns);
  scan.columns.range.assign(num_cells, 0);
  scan.columns.reflectivity.assign(num_cells, 0);
  scan.parts.push_back({0, shape.num_columns});
  scan.head.end_time = kScanTime + std::chrono::microseconds(static_cast<std::int64_t>(shape.num_columns) * 55296 / 1000 + 35);
  return scan;
}

inline std::size_t CellOf(const Scan& scan, int column, int ring, int index = 0) {
  return static_cast<std::size_t>((column * scan.head.num_rings() + ring) * scan.head.num_returns + index);
}

inline void SetReturn(Scan& scan, int column, int ring, double range_m, int index = 0, int reflectivity = 40) {
  const auto cell = CellOf(scan, column, ring, index);
  scan.columns.range[cell] = static_cast<std::uint16_t>(std::lround(range_m / scan.head.range_unit_m));
  scan.columns.reflectivity[cell] = static_cast<std::uint8_t>(reflectivity);
}

/// The column whose azimuth is nearest to a direction, in degrees clockwise from x.
inline int ColumnAt(const Scan& scan, double azimuth_deg) {
  int best = 0;
  for (int column = 0; column < scan.columns.size(); ++column) {
    const auto distance = [&](int one) {
      return std::abs(WrapToPi(scan.columns.azimuth_rad[static_cast<std::size_t>(one)] - DegToRad(azimuth_deg)));
    };
    if (distance(column) < distance(best)) best = column;
  }
  return best;
}

/// An upright wall between two places, seen from above.
struct Wall {
  double x0_m, y0_m, x1_m, y1_m;
  double min_z_m, max_z_m;
};

inline void AddBoat(std::vector<Wall>& walls, double x_m, double y_m, double heading_rad, double length_m, double width_m, double min_z_m,
                    double max_z_m) {
  const double cos_heading = std::cos(heading_rad);
  const double sin_heading = std::sin(heading_rad);
  const double corners[4][2]{{length_m / 2, width_m / 2}, {-length_m / 2, width_m / 2}, {-length_m / 2, -width_m / 2}, {length_m / 2, -width_m / 2}};
  double place[4][2];
  for (int i = 0; i < 4; ++i) {
    place[i][0] = x_m + corners[i][0] * cos_heading - corners[i][1] * sin_heading;
    place[i][1] = y_m + corners[i][0] * sin_heading + corners[i][1] * cos_heading;
  }
  for (int i = 0; i < 4; ++i) walls.push_back({place[i][0], place[i][1], place[(i + 1) % 4][0], place[(i + 1) % 4][1], min_z_m, max_z_m});
}

/// Range at which a beam meets the nearest wall.
inline std::optional<double> Cast(std::span<const Wall> walls, double azimuth_rad, double elevation_rad) {
  const double x = std::cos(azimuth_rad);
  const double y = -std::sin(azimuth_rad);
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const auto& wall : walls) {
    const double wall_x_m = wall.x1_m - wall.x0_m;
    const double wall_y_m = wall.y1_m - wall.y0_m;
    const double determinant = x * wall_y_m - y * wall_x_m;
    if (std::abs(determinant) < 1e-12) continue;
    const double along = (wall.x0_m * wall_y_m - wall.y0_m * wall_x_m) / determinant;
    const double part = (wall.x0_m * y - wall.y0_m * x) / determinant;
    if (along <= 0.0 || part < 0.0 || part > 1.0 || along >= nearest_m) continue;
    const double z_m = along * std::tan(elevation_rad);
    if (z_m >= wall.min_z_m && z_m <= wall.max_z_m) nearest_m = along;
  }
  if (!std::isfinite(nearest_m)) return std::nullopt;
  return nearest_m / std::cos(elevation_rad);
}

/// Gives every beam that meets a wall a return, with noise of the sensor.
inline void Look(Scan& scan, std::span<const Wall> walls, double noise_m = 0.0, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  for (int column = 0; column < scan.columns.size(); ++column) {
    for (int ring = 0; ring < scan.head.num_rings(); ++ring) {
      const auto& beam = scan.head.rings[static_cast<std::size_t>(ring)];
      const auto range_m = Cast(walls, scan.columns.azimuth_rad[static_cast<std::size_t>(column)] + beam.azimuth_offset_rad, beam.elevation_rad);
      if (!range_m || *range_m > 120.0) continue;
      for (int index = 0; index < scan.head.num_returns; ++index) SetReturn(scan, column, ring, *range_m + noise_m * noise(random), index);
    }
  }
}

/// A lake: a winding shore with trees over more than a quarter of the circle, boats and buoys. About 5000 returns of 28 800.
inline std::vector<Wall> Lake(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&random](double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); };
  std::vector<Wall> walls;
  double distance_m = 45.0;
  for (double azimuth_deg = 20.0; azimuth_deg < 125.0; azimuth_deg += 1.5) {
    const double next_m = std::clamp(distance_m + uniform(-2.0, 2.0), 30.0, 70.0);
    const auto x = [](double range_m, double at_deg) { return range_m * std::cos(DegToRad(at_deg)); };
    const auto y = [](double range_m, double at_deg) { return -range_m * std::sin(DegToRad(at_deg)); };
    walls.push_back({x(distance_m, azimuth_deg), y(distance_m, azimuth_deg), x(next_m, azimuth_deg + 1.5), y(next_m, azimuth_deg + 1.5), -1.0,
                     uniform(1.5, 5.0)});
    distance_m = next_m;
  }
  for (int boat = 0; boat < 10; ++boat) {
    const double azimuth_rad = uniform(0.0, kTwoPi);
    const double range_m = uniform(8.0, 28.0);
    AddBoat(walls, range_m * std::cos(azimuth_rad), range_m * std::sin(azimuth_rad), uniform(0.0, kPi), uniform(3.0, 9.0), uniform(1.0, 3.0), -1.0,
            uniform(-0.2, 2.0));
  }
  for (int buoy = 0; buoy < 12; ++buoy) {
    const double azimuth_rad = uniform(0.0, kTwoPi);
    const double range_m = uniform(5.0, 40.0);
    AddBoat(walls, range_m * std::cos(azimuth_rad), range_m * std::sin(azimuth_rad), 0.3, 0.5, 0.5, -1.0, 0.3);
  }
  return walls;
}

/// Drops on so many beams that have no return or look farther, nearest most likely: rain and spray.
inline void AddRain(Scan& scan, int num_drops, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&random](double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); };
  for (int drop = 0; drop < num_drops;) {
    const int column = static_cast<int>(random() % static_cast<std::uint64_t>(scan.columns.size()));
    const int ring = static_cast<int>(random() % static_cast<std::uint64_t>(scan.head.num_rings()));
    const double range_m = 1.0 + 24.0 * uniform(0.0, 1.0) * uniform(0.0, 1.0);
    const double seen_m = scan.columns.range[CellOf(scan, column, ring)] * scan.head.range_unit_m;
    if (seen_m > 0.0 && seen_m <= range_m) continue;
    SetReturn(scan, column, ring, range_m, 0, 3);
    ++drop;
  }
}

inline int NumReturns(const Scan& scan) {
  int count = 0;
  for (const auto range : scan.columns.range) count += range != 0 ? 1 : 0;
  return count;
}

}  // namespace lookout::segmenter::test
