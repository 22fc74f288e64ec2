// Returns of things that may stand: neither the own boat, nor water, nor drops.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "common/core/utime.hpp"

namespace lookout::odometer {

/// One laser. Rings are counted from the lowest beam up.
struct Ring {
  double elevation_rad = 0.0;
  double azimuth_offset_rad = 0.0;  // to be added to the azimuth of the column
  std::int64_t time_offset_ns = 0;  // to be added to the time of the column
  double origin_height_m = 0.0;     // z at which the beam starts
};

/// A scan: columns x rings, the nearest return of each shot. wire.cpp lets only valid ones in.
struct Scan {
  Utime time;      // first firing
  Utime end_time;  // last shot
  std::int64_t seq = 0;
  std::int64_t raw_seq = 0;
  double range_unit_m = 0.0;
  std::vector<Ring> rings;
  std::vector<double> azimuth_rad;    // [columns] clockwise seen from above
  std::vector<std::int64_t> time_ns;  // [columns] since `time`
  std::vector<std::uint16_t> range;   // [columns x rings], ring fastest; range units, 0 = no return
};

struct StandingParams {
  double min_range_m = 1.0;
  double max_range_m = 100.0;
  double min_height_m = 0.4;  // above calm water
  double reference_point_above_water_m = 0.0;
  Eigen::Isometry3d T_vessel_lidar = Eigen::Isometry3d::Identity();
  Eigen::AlignedBox3d own_vessel_box_m;  // vessel frame; empty = none
};

/// How the surroundings of a return look in its scan.
enum class Shape {
  kSurface,  // even: tells the distance across the surface
  kPost,     // narrower than 0.6 m, with free sight on both sides: tells both directions on the water
  kRough     // foliage and the like
};

/// A return in the vessel frame at the time of its shot; for a post, the centre of the post.
struct TimedPoint {
  Eigen::Vector3d p_vessel_m;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // vessel frame; of a surface: across it, of either sign
  Shape shape = Shape::kRough;
  double normal_sd_rad = 0.0;  // of a surface: deviation of the normal about the vertical, by the noise of ranges
  double before_end_s = 0.0;   // time from its shot to the last shot of the scan
};

/// One return of each cube of `sample_m`, the first by column, then ring. A return counts where a neighbouring shot met the same surface: drops stand
/// alone.
std::vector<TimedPoint> StandingPoints(const Scan& scan, double sample_m, const StandingParams& params);

}  // namespace lookout::odometer
