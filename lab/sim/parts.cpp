#include "lab/sim/parts.hpp"

#include <cmath>

#include "common/core/angles.hpp"

namespace lookout::sim {

HullPlan DrawPlan(const Size& size, const Range& length, const ByLength& least_width, const ByLength& greatest_width, Model& model) {
  HullPlan plan;
  plan.length_m = model.GivenOrDrawn(size.length_m, length.low_m, length.high_m);
  plan.width_m = model.GivenOrDrawn(size.width_m, least_width.Of(plan.length_m), greatest_width.Of(plan.length_m));
  model.Float(plan.length_m, plan.width_m);
  return plan;
}

LeaningWalls HullWalls(const HullPlan& plan, double lean, double bottom_m, double top_m, double top_slope) {
  LeaningWalls walls;
  walls.footprint_m = OutlineOf(plan);
  walls.lean = {lean};
  walls.is_widest_on_top = true;
  walls.bottom_m = bottom_m;
  walls.top_m = top_m;
  walls.top_slope = top_slope;
  return walls;
}

void AddCabin(const Block& block, const std::array<double, 4>& lean, double bottom_m, double top_m, const Material& material, Model& model) {
  LeaningWalls walls;
  walls.footprint_m = Rectangle(block.aft_m, block.front_m, -block.half_width_m, block.half_width_m);
  walls.lean.assign(lean.begin(), lean.end());
  walls.bottom_m = bottom_m;
  walls.top_m = top_m;
  model.Add(ToConvex(walls), material);
}

Eigen::Vector3d OnCircle(int index, int count, double radius_m, double z_m) {
  const double angle_rad = kTwoPi * index / count;
  return {radius_m * std::cos(angle_rad), radius_m * std::sin(angle_rad), z_m};
}

}  // namespace lookout::sim
