// What the lookout method goes by. Lengths in metres, "per range" in metres per metre of distance.
#pragma once

#include "common/core/angles.hpp"

namespace lookout::segmenter {

/// A length that grows with the distance r from the lidar: at_lidar_m + per_range r, as the spacing of its returns does.
struct Reach {
  double at_lidar_m = 0.0;
  double per_range = 0.0;

  double At(double range_m) const { return at_lidar_m + per_range * range_m; }
};

/// Defaults are those of config/schema/segmenter.proto, which says where they come from.
struct LookoutParams {
  // Pieces: returns that lie so close that nothing passes between them.
  Reach link{0.3, 0.01};
  // Land.
  double land_length_m = 15.0;
  Reach shore_gap{1.5, 0.03};     // along the water's edge
  Reach behind_land{12.0, 0.15};  // from land to what stands behind it
  Reach beside_land{6.0, 0.08};   // from land to what is tall beside it, and, half of it at the lidar, from land to land
  double tall_m = 3.5;
  // Objects.
  Reach join{0.3, 0.03};         // side by side
  Reach attach{1.2, 0.03};       // from a small part to the thing that it is of
  double attach_length_m = 1.4;  // of a small part
  double over_m = 3.0;           // one seen over the other
  double post_spacing_m = 6.0;
  // Sure or tentative.
  int sure_returns = 4;
  double sure_fill = 0.6;
  double sure_height_m = 0.25;
  double surface_range_m = 10.0;
  /// Of the lidar over the water when the boat floats at rest.
  double lidar_above_water_m = 1.0;
};

}  // namespace lookout::segmenter
