// A scan's measurement of a body: for the files of Body alone.
#pragma once

#include <Eigen/Core>
#include <array>

#include "services/tracker/core/body.hpp"

namespace lookout::tracker {

struct Body::Measured {
  enum class Kind { kNone, kEdge, kAtLeast };
  std::array<double, kDirections> reach_m{};  // from the origin of the map
  std::array<double, kDirections> variance_m2{};
  std::array<Kind, kDirections> kind{};
  Eigen::Vector2d sight = Eigen::Vector2d::Zero();
  // By how much the seen part is shorter than the known outline, from end to end; 0: all of it is seen.
  double short_m = 0.0;

  // Whether the measurement says where side i lies. A part that lies in the outline says so only where it reaches beyond it.
  bool Tells(std::size_t i, double beyond_m) const { return short_m > 0.0 ? beyond_m > 0.0 : kind[i] == Kind::kEdge; }
};

// An outline that is seen for the first time.
struct Body::First {
  Eigen::Vector2d middle_m;
  Reaches sides;  // from there
};

/// Uncertainty of a place from scan to scan.
/// @param covariance_m2  of the place relative to the own boat
Eigen::Matrix2d NoiseOf(const Eigen::Matrix2d& covariance_m2, double range_m);

}  // namespace lookout::tracker
