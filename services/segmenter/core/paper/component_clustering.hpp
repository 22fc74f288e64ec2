// The paper's clustering ("Algorithm 1"): components that belong to one obstacle by direction and distance of their centroids.
//
// This is a reconstruction. The listing of Algorithm 1 is known from its text only; of three readings that were tried on synthetic scenes, the
// connected components of the compatibility graph come nearest to the paper's results (lab/eval/README.md, "Measured"). Growing from a seed with a
// moving centroid, and best pair first, cut a long shoreline into pieces.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "common/core/angles.hpp"
#include "services/segmenter/core/paper/breadth_first_search.hpp"
#include "services/segmenter/core/returns.hpp"

namespace lookout::segmenter {

struct ClusteringParams {
  double e1_cosine = 0.95;
  double e2_angle_rad = DegToRad(50.0);
  double e3_distance_m = 3.5;
  double e2_max_distance_m = 0.0;  // 0 = at any distance (the paper)
};

/// The properties of a component that Algorithm 1 uses.
struct ComponentCentroid {
  explicit ComponentCentroid(const Eigen::Vector3d& p_lidar_m)
      : p_m(p_lidar_m),
        distance_m(p_lidar_m.norm()),
        direction(distance_m > 0.0 ? Eigen::Vector3d(p_lidar_m / distance_m) : Eigen::Vector3d::Zero()) {}

  Eigen::Vector3d p_m;
  double distance_m;          // from the sensor
  Eigen::Vector3d direction;  // unit vector; zero for a centroid at the sensor itself, which then has no direction in common with any
};

/// Whether two components are compatible: (a) and ((b) or (c)), with t the angle between the directions of their centroids:
/// (a) cos t >= e1, (b) atan2(d_short sin t, d_long - d_short cos t) >= e2, (c) distance of the centroids <= e3.
/// The paper prints (a) with an absolute value, which would join what is ahead with what is astern; t is taken in [0, pi].
class CompatibilityRule {
 public:
  explicit CompatibilityRule(const ClusteringParams& params);

  bool AreCompatible(const ComponentCentroid& one, const ComponentCentroid& other) const {
    const double cos_between = one.direction.dot(other.direction);
    if (cos_between < e1_cosine_) return false;
    const double squared_distance_m2 = (one.p_m - other.p_m).squaredNorm();
    if (squared_distance_m2 <= squared_e3_m2_) return true;
    if (squared_distance_m2 > squared_e2_max_m2_) return false;
    const double sin_between = one.direction.cross(other.direction).norm();
    const double short_m = std::min(one.distance_m, other.distance_m);
    const double long_m = std::max(one.distance_m, other.distance_m);
    // (b) as sin(beta - e2) >= 0: beta is in [0, pi), e2 in [0, pi/2].
    return short_m * sin_between * cos_e2_ >= (long_m - short_m * cos_between) * sin_e2_;
  }

 private:
  double e1_cosine_;
  double sin_e2_;
  double cos_e2_;
  double squared_e3_m2_;
  double squared_e2_max_m2_;
};

/// Mean of the returns of each group.
std::vector<ComponentCentroid> Centroids(std::span<const Return> returns, const Groups& components);

/// Connected components of the compatibility graph.
///
/// @return for each component the number of its cluster, from 0 in the order of their first component
/// Exactly what all pairs give (reference test). Cost: components are sorted into cells of azimuth and distance, only cells within reach of each
/// other are compared, and cells that are of one cluster already are compared no more; so rain, in which nearly all is compatible, stays cheap.
std::vector<std::int32_t> ClusterComponents(std::span<const ComponentCentroid> components, const ClusteringParams& params);

}  // namespace lookout::segmenter
