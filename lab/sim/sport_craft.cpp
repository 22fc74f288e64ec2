#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "lab/sim/parts.hpp"

namespace lookout::sim {

using Eigen::Vector3d;

// Long and slim, one to nine people one behind the other, oars out to both sides or in turn.
void MakeRowingShell(const Size& size, Model& model) {
  int num_rowers = model.Whole(1, 4);
  if (model.Chance(0.3)) num_rowers *= 2;
  HullPlan plan = DrawPlan(size, {5.0 + 1.4 * num_rowers, 6.5 + 1.5 * num_rowers}, {0.3}, {0.65}, model);
  const double length_m = plan.length_m;
  num_rowers = std::min(num_rowers, std::max(1, static_cast<int>((length_m - 2.0) / 1.4)));  // of a given length
  plan.bow_power = 1.6;
  plan.bow_share = 0.03;
  plan.transom_share = 0.05;
  plan.middle_share = 0.5;
  const double rail_m = model.Between(0.12, 0.25);
  model.Add(Prism{OutlineOf(plan), -0.1, rail_m}, model.Paint(size.reflectance));
  const bool is_sculled = model.Chance(0.5);  // two oars for each rower, else one, in turn to port and starboard
  const double sweep = model.Between(-0.6, 0.6);
  const double blade_m = model.Chance(0.5) ? 0.05 : model.Between(0.1, 0.5);
  const double reach_m = is_sculled ? 2.0 : 2.6;
  const Material oar = model.Paint();
  for (int i = 0; i < num_rowers; ++i) {
    const double x_m = 1.4 * (i - 0.5 * (num_rowers - 1));
    model.Person({x_m, 0.0, rail_m - 0.05}, {-1.0, 0.0}, Model::Posture::kSitting);
    for (const double side : {-1.0, 1.0}) {
      if (!is_sculled && side != (i % 2 == 0 ? 1.0 : -1.0)) continue;
      const Vector3d hands_m(x_m - 0.4, 0.1 * side, rail_m + 0.35);
      model.Rod(hands_m, {x_m - 0.4 + sweep, side * reach_m, blade_m}, 0.025, oar);
      model.Add(Ellipsoid{{x_m - 0.4 + sweep, side * reach_m, blade_m}, {0.1, 0.25, 0.08}}, oar);
    }
  }
  if (num_rowers > 3 && model.Chance(0.6)) model.Person({-0.42 * length_m, 0.0, rail_m - 0.1}, {1.0, 0.0}, Model::Posture::kSitting);
}

// A house on a flat hull: a porch at one end, a roof that stands out, some with a rail and things on it.
void MakeHouseboat(const Size& size, Model& model) {
  HullPlan plan = DrawPlan(size, {6.0, 18.0}, {2.2}, {4.8}, model);
  const double length_m = plan.length_m;
  const double width_m = plan.width_m;
  plan.bow_power = model.Between(3.0, 8.0);
  plan.bow_share = model.Between(0.3, 0.95);
  plan.transom_share = 0.95;
  const double deck_m = model.Between(0.35, 1.0);
  model.Add(Prism{OutlineOf(plan), -0.6, deck_m}, model.Paint(size.reflectance));
  const double aft_m = length_m * model.Between(-0.48, -0.3);
  const double front_m = length_m * model.Between(0.25, 0.4);
  const double half_m = width_m * model.Between(0.36, 0.48);
  const double roof_m = deck_m + model.Between(1.3, 2.6);
  const Material wall = model.Paint();
  const double sill_m = deck_m + 0.4 * (roof_m - deck_m);
  model.Box(aft_m, front_m, -half_m, half_m, deck_m, sill_m, wall);
  // Windows between pillars.
  const int num_windows = model.Whole(2, 6);
  const double window_m = (front_m - aft_m) / num_windows;
  for (int i = 0; i < num_windows; ++i) {
    const double from_m = aft_m + i * window_m;
    model.Box(from_m, from_m + 0.35 * window_m, -half_m, half_m, sill_m, roof_m, wall);
    model.Box(from_m + 0.35 * window_m, from_m + window_m, -half_m + 0.05, half_m - 0.05, sill_m, roof_m, model.Glass());
  }
  const double eaves_m = model.Between(0.0, 0.5);
  model.Box(aft_m - eaves_m, front_m + 2.0 * eaves_m, -half_m - 0.3 * eaves_m, half_m + 0.3 * eaves_m, roof_m, roof_m + 0.12, model.Paint());
  if (model.Chance(0.4)) {
    const Material metal = model.Metal();
    for (const double side : {-1.0, 1.0}) {
      model.Railing({aft_m, side * half_m, roof_m + 0.1}, {front_m, side * half_m, roof_m + 0.1}, 0.9, 1.5, 2, 0.02, metal);
    }
  }
  const int num_things = model.Whole(0, 5);  // boxes, chimneys, plants on roof and porch
  for (int i = 0; i < num_things; ++i) {
    const bool is_on_roof = model.Chance(0.6);
    const double x_m = is_on_roof ? model.Between(aft_m, front_m) : model.Between(front_m, 0.44 * length_m);
    const double foot_m = is_on_roof ? roof_m + 0.1 : deck_m;
    const double y_m = model.Between(-0.6, 0.6) * half_m;
    model.Post(x_m, y_m, model.Between(0.08, 0.35), foot_m, foot_m + 0.7, model.Paint());
  }
  if (model.Chance(0.4)) model.Person({0.42 * length_m, 0.0, deck_m}, {1.0, 0.0}, Model::Posture::kStanding);
}

// Short, decked, ridden astride.
void MakeJetSki(const Size& size, Model& model) {
  HullPlan plan = DrawPlan(size, {2.2, 3.6}, {0.75}, {1.25}, model);
  const double length_m = plan.length_m;
  plan.bow_power = 1.8;
  const Material paint = model.Paint(size.reflectance);
  const double rail_m = model.Between(0.3, 0.45);
  model.Add(ToConvex(HullWalls(plan, 0.2, -0.2, rail_m, 0.06)), paint);
  const double seat_m = rail_m + model.Between(0.25, 0.4);
  model.Box(-0.4 * length_m, 0.1 * length_m, -0.17, 0.17, rail_m, seat_m, model.Paint());
  AddCabin({0.05 * length_m, 0.35 * length_m, 0.28}, {0.3, 0.8, 0.3, 0.0}, rail_m, rail_m + 0.5, paint, model);
  model.Rod({0.08 * length_m, -0.35, rail_m + 0.6}, {0.08 * length_m, 0.35, rail_m + 0.6}, 0.025, model.Metal());
  const int num_riders = model.Whole(0, 2);
  for (int i = 0; i < num_riders; ++i) {
    const bool stands = model.Chance(0.2);
    model.Person({(-0.08 - 0.2 * i) * length_m, 0.0, stands ? rail_m : seat_m - 0.1}, {1.0, 0.0}, Model::PostureOf(stands));
  }
}

// A board, a sail that stands up from its middle, and who holds it; or sail and rider in the water.
void MakeWindsurfer(const Size& size, Model& model) {
  HullPlan plan = DrawPlan(size, {2.2, 3.6}, {0.55}, {1.0}, model);
  const double length_m = plan.length_m;
  plan.bow_power = 2.2;
  plan.transom_share = 0.6;
  model.Add(Prism{OutlineOf(plan), -0.05, model.Between(0.05, 0.12)}, model.Paint(size.reflectance));
  const double side = model.Chance(0.5) ? 1.0 : -1.0;
  const double mast_m = model.Between(3.8, 5.0);
  const bool is_down = model.Chance(0.15);
  const double lean_rad = side * DegToRad(is_down ? 85.0 : model.Between(-5.0, 35.0));
  const double rake_rad = DegToRad(model.Between(0.0, 25.0));
  const Vector3d up = Vector3d(-std::sin(rake_rad), std::sin(lean_rad), std::cos(lean_rad)).normalized();
  const double sheet_rad = side * DegToRad(model.Between(5.0, 60.0));
  const Vector3d aft(-std::cos(sheet_rad), std::sin(sheet_rad), 0.05);
  const Vector3d foot_m(0.1 * length_m, 0.0, 0.1);
  const Vector3d top_m = foot_m + mast_m * up;
  const Vector3d clew_m = foot_m + 0.3 * mast_m * up + model.Between(1.6, 2.2) * aft;
  model.Rod(foot_m, top_m, 0.025, model.Wood());
  model.Rod(foot_m + 0.3 * mast_m * up, clew_m, 0.02, model.Metal());
  const Material cloth = model.Cloth();
  model.Sheet(foot_m + 0.05 * mast_m * up, clew_m, foot_m + 0.65 * mast_m * up + 0.9 * aft, foot_m + 0.35 * mast_m * up, cloth);
  model.Sheet(foot_m + 0.35 * mast_m * up, foot_m + 0.65 * mast_m * up + 0.9 * aft, top_m + 0.15 * aft, top_m, cloth);
  if (is_down) {
    model.Add(Ellipsoid{{-0.2, -side * 0.6, 0.1}, {0.12, 0.12, 0.16}}, model.Cloth());
  } else {
    model.Person({-0.1 * length_m, -side * 0.2, 0.1}, {1.0, 0.0}, Model::Posture::kStanding);
  }
}

// Boats without crew, as universities build them: a short hull, one or with outriggers, a box, a mast with sensors.
void MakeRobotBoat(const Size& size, Model& model) {
  const double length_m = model.GivenOrDrawn(size.length_m, 0.9, 4.0);
  const double width_m = model.GivenOrDrawn(size.width_m, 0.3 * length_m, 0.6 * length_m);
  const bool has_outriggers = model.Chance(0.3);
  model.Float(length_m, width_m);
  const double hull_width_m = has_outriggers ? 0.45 * width_m : width_m;
  HullPlan plan{length_m, hull_width_m};
  plan.bow_power = model.Between(1.5, 3.0);
  plan.bow_share = model.Between(0.0, 0.4);
  const double deck_m = model.Between(0.08, 0.14) * length_m;
  const Material paint = model.Paint(size.reflectance);
  model.Add(ToConvex(HullWalls(plan, 0.1, -0.15, deck_m)), paint);
  if (has_outriggers) {
    for (const double side : {-1.0, 1.0}) {
      const double y_m = side * (0.5 * width_m - 0.05 * length_m);
      model.Rod({-0.3 * length_m, y_m, 0.02}, {0.25 * length_m, y_m, 0.02}, 0.05 * length_m, paint);
      model.Rod({0.0, 0.0, deck_m}, {0.0, y_m, deck_m}, 0.02, model.Metal());
    }
  }
  const double box_m = length_m * model.Between(0.1, 0.2);
  const double box_top_m = deck_m + length_m * model.Between(0.05, 0.2);
  model.Box(-2.0 * box_m, box_m, -0.35 * hull_width_m, 0.35 * hull_width_m, deck_m, box_top_m, model.Paint());
  const int num_masts = model.Whole(1, 3);
  for (int i = 0; i < num_masts; ++i) {
    const double x_m = model.Between(-0.4, 0.25) * length_m;
    const double top_m = deck_m + model.Between(0.3, 1.4);
    model.Post(x_m, 0.0, 0.02, deck_m, top_m, model.Metal());
    if (model.Chance(0.6)) model.Post(x_m, 0.0, model.Between(0.05, 0.12), top_m, top_m + 0.12, model.Paint());
  }
}

}  // namespace lookout::sim
