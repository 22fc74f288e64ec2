// The paper's breadth-first search: neighbouring pixels that show the same surface become one component.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "services/segmenter/core/groups.hpp"
#include "services/segmenter/core/paper/range_image.hpp"
#include "services/segmenter/core/returns.hpp"

namespace lookout::segmenter {

struct SearchParams {
  double angle_rad = DegToRad(10.0);
  double distance_m = 1.0;
};

/// Whether two returns of neighbouring beams are of one surface: beta > angle or distance < distance_m (the paper, section on breadth-first search).
class JoinRule {
 public:
  explicit JoinRule(const SearchParams& params)
      : sin_angle_(Sin(params.angle_rad)), cos_angle_(Cos(params.angle_rad)), squared_distance_m2_(params.distance_m * params.distance_m) {}

  /// beta = atan2(d2 sin a, d1 - d2 cos a), d1 >= d2, a the angle between the beams. beta > angle is sin(beta - angle) > 0, since beta is in
  /// [0, pi) and the angle in [0, pi/2].
  bool Joins(const Return& one, const Return& other, const BeamStep& step) const {
    const bool is_one_farther = one.range_m >= other.range_m;
    const double far_m = is_one_farther ? one.range_m : other.range_m;
    const double near_m = is_one_farther ? other.range_m : one.range_m;
    if (near_m * step.sin_angle * cos_angle_ > (far_m - near_m * step.cos_angle) * sin_angle_) return true;
    return IsClose(SquaredDistance(one.point, other.point));
  }

  bool IsClose(double squared_distance_m2) const { return squared_distance_m2 < squared_distance_m2_; }

 private:
  double sin_angle_;
  double cos_angle_;
  double squared_distance_m2_;
};

/// Connected components of the image: each pixel has four neighbours, and all layers of a neighbour and of the pixel itself count.
///
/// @return groups of the returns in the image; those that were shadowed or not projected are in none. Cost: proportional to the returns.
Groups SearchComponents(const RangeImage& image, std::span<const Return> returns, const SearchParams& params);

}  // namespace lookout::segmenter
