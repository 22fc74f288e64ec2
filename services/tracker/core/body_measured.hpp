// A scan's measurement of a body: for the files of Body alone.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>

#include "services/tracker/core/body.hpp"

namespace lookout::tracker {

struct Body::Measured {
  enum class Kind { kNone, kEdge, kAtLeast };
  std::array<double, kDirections> reach_m{};  // from the origin of the map
  std::array<double, kDirections> variance_m2{};
  std::array<Kind, kDirections> kind{};
  Eigen::Vector2d sight = Eigen::Vector2d::Zero();
  // A smaller part is seen than is known, from end to end, by so much; 0: all of it is.
  double short_m = 0.0;
};

// What a measurement says of how far the thing is from its position, direction by direction.
struct Body::Displacements {
  struct One {
    Eigen::Vector2d direction = Eigen::Vector2d::Zero();
    double off_m = 0.0;  // along it
    double variance_m2 = 0.0;
  };
  std::array<One, kDirections> ones{};
  std::size_t num = 0;

  void Add(const One& one) { ones[num++] = one; }
  std::span<const One> all() const { return std::span(ones).first(num); }
};

// An outline that is seen for the first time.
struct Body::First {
  Eigen::Vector2d middle_m;
  Reaches sides;  // from there
};

/// Uncertainty of a place from scan to scan.
/// @param covariance_m2  of its position relative to the own boat
Eigen::Matrix2d NoiseOf(const Eigen::Matrix2d& covariance_m2, double range_m);

}  // namespace lookout::tracker
