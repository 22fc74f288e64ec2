#include "services/odometer/core/standing.hpp"

#include <cmath>
#include <cstddef>

#include "common/core/elementary.hpp"

namespace lookout::odometer {

namespace {

// Neighbours on one surface differ by less: 0.15 m, and 2 % of the range, which is a wall seen at 10 deg by columns 0.2 deg apart.
constexpr double kSurfaceStepM = 0.15;
constexpr double kSurfaceStepPerRange = 0.02;

// The ranges of a scan as a ring of columns.
class RangeImage {
 public:
  explicit RangeImage(const Scan& scan) : scan_(scan), num_columns_(scan.azimuth_rad.size()), num_rings_(scan.rings.size()) {}

  // Whether one of the shots beside it met something as far away.
  bool HasNeighbour(std::size_t column, std::size_t ring, double range_m) const {
    const double step_m = kSurfaceStepM + kSurfaceStepPerRange * range_m;
    const auto is_near = [&](std::size_t other_column, std::size_t other_ring) {
      const auto range = scan_.range[other_column * num_rings_ + other_ring];
      return range != 0 && std::abs(range * scan_.range_unit_m - range_m) < step_m;
    };
    const std::size_t next = column + 1 == num_columns_ ? 0 : column + 1;
    const std::size_t before = column == 0 ? num_columns_ - 1 : column - 1;
    if (is_near(next, ring) || is_near(before, ring)) return true;
    return (ring + 1 < num_rings_ && is_near(column, ring + 1)) || (ring > 0 && is_near(column, ring - 1));
  }

 private:
  const Scan& scan_;
  std::size_t num_columns_;
  std::size_t num_rings_;
};

}  // namespace

std::vector<TimedPoint> StandingPoints(const Scan& scan, const StandingParams& params) {
  std::vector<TimedPoint> points;
  points.reserve(scan.range.size() / 4);
  const RangeImage image(scan);
  std::vector<SinCos> elevations;
  elevations.reserve(scan.rings.size());
  for (const auto& ring : scan.rings) elevations.push_back(SinCosOf(ring.elevation_rad));
  const std::int64_t end_ns = (scan.end_time - scan.time).count() * 1000;
  const std::size_t num_rings = scan.rings.size();
  for (std::size_t column = 0; column < scan.azimuth_rad.size(); ++column) {
    for (std::size_t ring = 0; ring < num_rings; ++ring) {
      const auto range = scan.range[column * num_rings + ring];
      if (range == 0) continue;
      const double range_m = range * scan.range_unit_m;
      if (range_m < params.min_range_m || range_m > params.max_range_m || !image.HasNeighbour(column, ring, range_m)) continue;
      const auto azimuth = SinCosOf(scan.azimuth_rad[column] + scan.rings[ring].azimuth_offset_rad);
      const double level_m = range_m * elevations[ring].cos;
      const Eigen::Vector3d p_lidar_m(level_m * azimuth.cos, -level_m * azimuth.sin,
                                      range_m * elevations[ring].sin + scan.rings[ring].origin_height_m);
      const Eigen::Vector3d p_vessel_m = params.T_vessel_lidar * p_lidar_m;
      if (p_vessel_m.z() + params.reference_point_above_water_m < params.min_height_m) continue;
      if (!params.own_vessel_box_m.isEmpty() && params.own_vessel_box_m.contains(p_vessel_m)) continue;
      points.push_back({p_vessel_m, static_cast<double>(end_ns - scan.time_ns[column] - scan.rings[ring].time_offset_ns) * 1e-9});
    }
  }
  return points;
}

}  // namespace lookout::odometer
