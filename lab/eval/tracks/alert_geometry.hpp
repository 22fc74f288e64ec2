// How near true hulls come to each other while course and speed, or a turn, are kept.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <vector>

#include "lab/eval/truth.hpp"

namespace lookout::eval {

/// The outline of a true thing, prepared so that a long shore costs little.
class HullOutline {
 public:
  /// Precondition: the outline has a corner.
  explicit HullOutline(Polygon corners_m);

  const Polygon& corners_m() const { return corners_m_; }
  const Eigen::AlignedBox2d& box_m() const { return box_m_; }

  /// Least distance of both hulls; 0 where they overlap. Shape: `hull_m` has a few corners, in any direction.
  /// @param enough_m  where the result is more than that, it is only more than that
  double Gap(const Polygon& hull_m, double enough_m = std::numeric_limits<double>::infinity()) const;
  /// 0 inside.
  double Distance(const Eigen::Vector2d& p_m, double enough_m = std::numeric_limits<double>::infinity()) const { return Gap({p_m}, enough_m); }
  /// The point of the line of the outline that is nearest to another.
  Eigen::Vector2d NearestPoint(const Eigen::Vector2d& p_m) const;

 private:
  Polygon corners_m_;
  Eigen::AlignedBox2d box_m_;
  std::vector<Eigen::AlignedBox2d> block_box_m_;  // around so many edges each
};

/// A hull that moves. Its velocity turns with `turn_radps`, and the hull with it.
struct MovingHull {
  Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();
  double turn_radps = 0.0;  // counter-clockwise seen from above; 0 where the thing goes straight
};

struct ApproachQuestion {
  double limit_m = 5.0;
  double ahead_s = 30.0;
  double lenient_s = 33.0;  // at least ahead_s
};

/// A closest approach within the time ahead. Where one of both turns nobody knows when the turn ends, so three ends of it count: at once, after 60
/// degrees, and not within the time ahead.
struct TrueApproach {
  /// The least over all ends, within lenient_s. Infinite: both stand. A distance beyond limit_m + kApproachCapM is only known to be more than that.
  double least_m = std::numeric_limits<double>::infinity();
  /// The greatest over the ends of the least distance within ahead_s, in the same way.
  double greatest_m = std::numeric_limits<double>::infinity();
  /// Where no turn is kept: within ahead_s.
  double straight_m = std::numeric_limits<double>::infinity();
  /// From now until it is nearer than limit_m, the earliest over the ends; infinite: not within lenient_s.
  double until_limit_s = std::numeric_limits<double>::infinity();
};
inline constexpr double kApproachCapM = 5.0;
/// A slower thing stands: a boat that rolls in its berth moves by some centimetres a second.
inline constexpr double kStandsBelowMps = 0.1;

/// Error: below 0.05 s of the relative motion. Cost: one gap for each 0.1 s in which both are nearer than limit_m + kApproachCapM, and few others.
TrueApproach ApproachWithin(const ApproachQuestion& question, const Polygon& own_m, const MovingHull& own, const HullOutline& thing_m,
                            const MovingHull& thing);

}  // namespace lookout::eval
