#include "lab/sim/scene.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/frames.hpp"

namespace lookout::sim {

Eigen::Isometry3d PoseAt(const SceneObject& object, const Sea& sea, double time_s) {
  const Placement placement = object.track.At(time_s);
  double height_m = 0.0;
  double pitch_rad = 0.0;
  double roll_rad = 0.0;
  if (object.is_afloat() && !sea.is_calm()) {
    // The water under its four ends: waves shorter than the hull move it little.
    const auto water_m = [&](double x_m, double y_m) { return sea.HeightM(placement.ToMap({x_m, y_m}), time_s); };
    const Eigen::Vector2d half_m = object.waterline_m / 2.0;
    const double bow_m = water_m(half_m.x(), 0.0);
    const double stern_m = water_m(-half_m.x(), 0.0);
    const double port_m = water_m(0.0, half_m.y());
    const double starboard_m = water_m(0.0, -half_m.y());
    height_m = (bow_m + stern_m + port_m + starboard_m) / 4.0;
    pitch_rad = std::atan2(bow_m - stern_m, object.waterline_m.x());
    roll_rad = std::atan2(port_m - starboard_m, object.waterline_m.y());
  }
  Eigen::Isometry3d T_map_object = Eigen::Isometry3d::Identity();
  T_map_object.linear() = RotationMapVessel(placement.heading_rad, pitch_rad, roll_rad);
  T_map_object.translation() << placement.position_map_m, height_m;
  return T_map_object;
}

SceneObject MakeOwnHull(const Eigen::AlignedBox3d& box_m, double lidar_height_m, const Eigen::Vector3d& p_vessel_antenna_m) {
  constexpr Material kPaintedDeck{0.4};
  constexpr double kMarginM = 0.2;  // as the boxes in config/ are larger than the hulls
  constexpr double kMotorBelowLidarM = 0.15;
  constexpr double kPostRadiusM = 0.03;
  const double stern_m = box_m.min().x() + kMarginM;
  const double top_m = std::min(lidar_height_m - kMotorBelowLidarM, box_m.max().z() - kMarginM);
  // In its own frame an object has the heading that turns x, y into east, north.
  SceneObject hull{kOwnVessel, "own_vessel", "own_vessel", Track{{Eigen::Vector2d::Zero(), kPi / 2.0}}, {}, {}};
  hull.parts = {
      {Prism{Rectangle(stern_m, box_m.max().x() - kMarginM, box_m.min().y() + kMarginM, box_m.max().y() - kMarginM), -0.3, 0.0}, kPaintedDeck},
      {Prism{Rectangle(stern_m, stern_m + 0.2, -0.25, 0.25), 0.0, top_m}, kPaintedDeck}};
  if (box_m.contains(p_vessel_antenna_m)) {
    hull.parts.push_back({Cylinder{p_vessel_antenna_m.head<2>(), kPostRadiusM, 0.0, p_vessel_antenna_m.z()}, kPaintedDeck});
  }
  return hull;
}

}  // namespace lookout::sim
