// The points of a sensor_msgs/PointCloud2, by whatever names and types its driver gives their fields.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/import/ros_message.hpp"

namespace lookout::importer {

/// A point that is there, in the frame of the cloud: x forward, y left, z up.
struct RingPoint {
  double azimuth_rad = 0.0;  // clockwise from x, in [0, 2 pi)
  double level_m = 0.0;      // distance from the z axis
  double z_m = 0.0;
  std::int64_t time_ns = 0;  // since the stamp of the cloud; 0 where the cloud has no times
  bool has_time = true;      // whether time_ns is the point's own; else it is that of the last earlier point with a time
  std::int32_t ring = 0;     // as the driver counts; in a cloud without rings the row, or kNoRing
  std::int32_t row = 0;      // place in the cloud
  std::int32_t column = 0;
  std::uint8_t reflectivity = 0;
  std::uint32_t label = 0;  // class in the lower, instance in the upper 16 bits
};

struct RingCloud {
  static constexpr std::int32_t kNoRing = -1;

  std::vector<RingPoint> points;  // in the order of the cloud
  std::int32_t height = 0;
  std::int32_t width = 0;
  bool has_rings = false;  // by a field, or as rows
  bool has_times = false;
  bool has_reflectivity = false;
  bool has_labels = false;
  bool is_clock_other = false;        // stamps of points are more than a second off the cloud's: only their differences count
  std::int64_t num_empty = 0;         // no return: at the origin, or not finite
  bool are_times_refused = false;     // more than a few times do not fit into one revolution, so has_times is false
  std::int64_t num_out_of_range = 0;  // beyond kMaxImportRangeM, or of a ring above kMaxImportRings
  std::int64_t num_no_time = 0;       // in a cloud with times: not finite, or more than a second off the median
};

inline constexpr double kMaxImportRangeM = 600.0;
inline constexpr double kMinImportRangeM = 0.01;  // nearer is how some drivers say "no return"
inline constexpr std::int32_t kMaxImportRings = 128;
inline constexpr std::int64_t kMaxPointTimeOffNs = 1'000'000'000;  // difference of a point's time from the median of its cloud
inline constexpr std::int64_t kMaxNoTimeShare = 100;               // one point in this many may lack a time, and at least one point

/// Fields, by name: x y z; `ring`, `line` or `channel`; `time` (s since the stamp, Velodyne), `t` or `offset_time` (ns since the stamp, Ouster),
/// `timestamp` (s or ns since 1970: Hesai, RoboSense, Livox); `reflectivity` or `intensity`; `label`.
/// A cloud of at most kMaxImportRings rows of several columns without a field for rings has its rows as rings.
///
/// @param why  is told in words where there is no result
std::optional<RingCloud> ToRingCloud(const RosPointCloud& cloud, std::string& why);

}  // namespace lookout::importer
