// Parts that craft and buoys share.
#pragma once

#include <Eigen/Core>
#include <array>

#include "lab/sim/model.hpp"
#include "lab/sim/things.hpp"

namespace lookout::sim {

struct Range {
  double low_m = 0.0;
  double high_m = 0.0;
};

/// A size that grows with the length of a hull.
struct ByLength {
  double base_m = 0.0;
  double share = 0.0;  // of the length

  double Of(double length_m) const { return base_m + share * length_m; }
};

/// A hull of a given or drawn length, then width; it floats on both.
HullPlan DrawPlan(const Size& size, const Range& length, const ByLength& least_width, const ByLength& greatest_width, Model& model);

/// Walls of a hull that come in by `lean` per metre downwards.
LeaningWalls HullWalls(const HullPlan& plan, double lean, double bottom_m, double top_m, double top_slope = 0.0);

/// Seen from above a rectangle about the middle line.
struct Block {
  double aft_m = 0.0;
  double front_m = 0.0;
  double half_width_m = 0.0;
};

/// A cabin, a screen or a hood.
///
/// @param lean  of the starboard, front, port and aft wall: how far it comes in per metre upwards
void AddCabin(const Block& block, const std::array<double, 4>& lean, double bottom_m, double top_m, const Material& material, Model& model);

/// The corner `index` of a regular polygon with `count` corners, the first ahead.
Eigen::Vector3d OnCircle(int index, int count, double radius_m, double z_m);

}  // namespace lookout::sim
