// Points of a recording of others, with their objects.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "lab/data/labelled_scan.hpp"

namespace lookout::data {

/// In the frame of the sensor: x forward, y left, z up, the sensor at the origin.
struct CloudPoint {
  float x_m = 0.0F;
  float y_m = 0.0F;
  float z_m = 0.0F;
  std::uint8_t reflectivity = 0;
  std::int32_t object = kNoTrueObject;
};

struct PointCloud {
  std::vector<CloudPoint> points;              // in the order of the file; all finite
  std::map<std::int32_t, ScanObject> objects;  // numbered from 1 in the order of their labels; empty when the file has none
  bool has_labels = false;
  bool are_classes_objects = false;  // KITTI's labels without a single instance: ParseKitti
  std::int64_t num_not_finite = 0;   // points left out: a place that is not a number is how a file says "no return"
};

/// As many cells as a scan of LIDAR_SCAN may have (segmenter/wire.hpp), so more points than that are no scan of a lidar.
inline constexpr std::int64_t kMaxCloudPoints = std::int64_t{1} << 21;

}  // namespace lookout::data
