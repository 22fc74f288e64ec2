#include "lab/sim/model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/core/angles.hpp"
#include "common/core/outlines.hpp"

namespace lookout::sim {

using Eigen::Vector2d;
using Eigen::Vector3d;

std::vector<Vector2d> OutlineOf(const HullPlan& plan) {
  const double from_widest_m = plan.length_m * plan.middle_share;
  const double x_widest_m = plan.length_m / 2.0 - from_widest_m;
  const double half_m = plan.width_m / 2.0;
  std::vector<Vector2d> starboard_m;  // from the stern to the bow
  for (const double share : {1.0, 0.7, 0.35}) {
    const double width = 1.0 - (1.0 - plan.transom_share) * share * share;
    starboard_m.emplace_back(x_widest_m - share * (plan.length_m - from_widest_m), -half_m * width);
  }
  for (const double share : {0.0, 0.35, 0.6, 0.8, 0.93, 1.0}) {
    const double width = 1.0 - (1.0 - plan.bow_share) * std::pow(share, plan.bow_power);
    starboard_m.emplace_back(x_widest_m + share * from_widest_m, -half_m * width);
  }
  std::vector<Vector2d> outline_m = starboard_m;
  for (auto p_m = starboard_m.rbegin(); p_m != starboard_m.rend(); ++p_m) {
    if (p_m->y() < -1e-3) outline_m.emplace_back(p_m->x(), -p_m->y());
  }
  return outline_m;
}

int Model::Whole(int low, int high) { return low + std::min(static_cast<int>(random_.Uniform() * (high - low + 1)), high - low); }

double Model::GivenOrDrawn(double given, double low, double high) {
  const double drawn = Between(low, high);
  return given > 0.0 ? given : drawn;
}

// Shares of bright, dull, dark and black surfaces are drawn to be wide, after no count of boats.
Material Model::Paint(double given) {
  const double share = materials_.Uniform();
  double drawn = materials_.Uniform(0.01, 0.05);
  if (share < 0.5) {
    drawn = materials_.Uniform(0.4, 0.9);
  } else if (share < 0.75) {
    drawn = materials_.Uniform(0.15, 0.4);
  } else if (share < 0.9) {
    drawn = materials_.Uniform(0.05, 0.15);
  }
  return {given > 0.0 ? given : drawn};
}

Material Model::Cloth() { return {materials_.Uniform(0.08, 0.8)}; }
Material Model::Metal() { return {materials_.Uniform(0.25, 0.6)}; }
Material Model::Wood() { return {materials_.Uniform(0.15, 0.5)}; }
Material Model::Glass() { return {materials_.Uniform(0.01, 0.08)}; }
Material Model::Retro() { return {materials_.Uniform(1.1, 2.5)}; }

void Model::Box(double min_x_m, double max_x_m, double min_y_m, double max_y_m, double bottom_m, double top_m, const Material& material) {
  Add(Prism{Rectangle(min_x_m, max_x_m, min_y_m, max_y_m), bottom_m, top_m}, material);
}

void Model::Post(double x_m, double y_m, double radius_m, double bottom_m, double top_m, const Material& material) {
  Add(Cylinder{{x_m, y_m}, radius_m, bottom_m, top_m}, material);
}

void Model::Rod(const Vector3d& from_m, const Vector3d& to_m, double radius_m, const Material& material) {
  Add(sim::Rod{from_m, to_m, radius_m}, material);
}

void Model::Chain(std::initializer_list<Vector3d> points_m, double radius_m, const Material& material) {
  for (const auto* p_m = points_m.begin(); p_m + 1 != points_m.end(); ++p_m) Rod(*p_m, *(p_m + 1), radius_m, material);
}

void Model::Sheet(const Vector3d& a_m, const Vector3d& b_m, const Vector3d& c_m, const Vector3d& d_m, const Material& material) {
  Add(Triangle{a_m, b_m, c_m}, material);
  if (!(d_m - a_m).isZero()) Add(Triangle{a_m, c_m, d_m}, material);
}

void Model::Railing(const Vector3d& from_m, const Vector3d& to_m, double height_m, double spacing_m, int num_rails, double radius_m,
                    const Material& material) {
  const int num_gaps = std::max(1, static_cast<int>(std::round((to_m - from_m).norm() / spacing_m)));
  for (int i = 0; i <= num_gaps; ++i) {
    const Vector3d foot_m = from_m + (to_m - from_m) * (static_cast<double>(i) / num_gaps);
    Post(foot_m.x(), foot_m.y(), radius_m, foot_m.z(), foot_m.z() + height_m, material);
  }
  for (int rail = 1; rail <= num_rails; ++rail) {
    const Vector3d up_m(0.0, 0.0, height_m * rail / num_rails);
    Rod(from_m + up_m, to_m + up_m, radius_m, material);
  }
}

// Children to tall men: 1.2 to 1.95 m; parts as shares of the height.
void Model::Person(const Vector3d& feet_m, const Vector2d& facing, Posture posture) {
  const double height_m = Chance(0.15) ? Between(1.2, 1.5) : Between(1.55, 1.95);
  const double half_shoulders_m = Between(0.2, 0.27) * height_m / 1.75;
  const double half_depth_m = Between(0.12, 0.2) * height_m / 1.75;
  const Material cloth = Cloth();
  const Material skin{materials_.Uniform(0.2, 0.6)};
  const Vector3d ahead(facing.x(), facing.y(), 0.0);
  const Vector3d left(-facing.y(), facing.x(), 0.0);
  double hip_m = 0.06 * height_m;  // sitting: thick as a thigh
  if (posture == Posture::kStanding) hip_m = 0.48 * height_m;
  if (posture == Posture::kKneeling) hip_m = 0.28 * height_m;
  const double trunk_m = 0.36 * height_m;
  const double lean = posture == Posture::kStanding ? Between(-0.05, 0.15) : Between(-0.15, 0.35);
  const Vector3d hip_at_m = feet_m + Vector3d(0.0, 0.0, hip_m);
  const Vector3d neck_at_m = hip_at_m + trunk_m * Vector3d(lean * ahead.x(), lean * ahead.y(), 1.0);
  // Shoulders are wider than a rod of the trunk's depth: two of them, side by side.
  const double aside_m = std::max(half_shoulders_m - half_depth_m, 0.02);
  for (const double side : {-1.0, 1.0}) Rod(hip_at_m + side * aside_m * left, neck_at_m + side * aside_m * left, half_depth_m, cloth);
  Add(Ellipsoid{neck_at_m + Vector3d(0.0, 0.0, 0.1 * height_m) + 0.04 * ahead, Vector3d(0.1, 0.1, 0.13) * height_m / 1.75}, skin);
  if (posture == Posture::kStanding) {
    for (const double side : {-1.0, 1.0}) Rod(feet_m + side * 0.12 * left, hip_at_m + side * 0.08 * left, 0.075, cloth);
  } else if (posture == Posture::kSitting) {
    const Vector3d knee_m = hip_at_m + 0.28 * height_m * ahead + Vector3d(0.0, 0.0, Between(-0.05, 0.15));
    for (const double side : {-1.0, 1.0}) Rod(hip_at_m + side * 0.1 * left, knee_m + side * 0.12 * left, 0.07, cloth);
  } else {
    Rod(feet_m, hip_at_m, 0.14, cloth);
  }
  if (Chance(0.5)) {
    const Vector3d shoulder_m = neck_at_m + (Chance(0.5) ? 1.0 : -1.0) * half_shoulders_m * left;
    const double reach_m = Between(0.2, 0.5);
    Rod(shoulder_m, shoulder_m + reach_m * ahead + Vector3d(0.0, 0.0, Between(-0.4, 0.4)), 0.045, cloth);
  }
}

void Model::OutlineAllParts() {
  std::vector<Vector2d> points_m;
  for (const auto& part : object_.parts) {
    const Bounds bounds = BoundsOf(part.solid);
    for (const auto& p_m : bounds.points_m) {
      if (bounds.radius_m == 0.0) {
        points_m.push_back(p_m);
        continue;
      }
      // An octagon around the circle.
      for (const auto& around_m : Circle(p_m, bounds.radius_m / std::cos(kPi / 8.0), 8)) points_m.push_back(around_m);
    }
  }
  constexpr double kFlatM2 = 1e-4;  // corners that stand out by less than millimetres are left out
  object_.outline_m = ConvexHull(std::move(points_m), kFlatM2);
}

}  // namespace lookout::sim
