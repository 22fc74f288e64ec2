// Lengths that grow with the distance from the lidar.
#pragma once

namespace lookout::segmenter {

/// at_lidar_m + per_range r, as the spacing of returns does.
struct Reach {
  double at_lidar_m = 0.0;
  double per_range = 0.0;

  double At(double range_m) const { return at_lidar_m + per_range * range_m; }
};

}  // namespace lookout::segmenter
