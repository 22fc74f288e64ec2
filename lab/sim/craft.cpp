#include <algorithm>
#include <cmath>

#include "lab/sim/parts.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A motor at the transom, down or tilted up.
void AddOutboard(double stern_m, double y_m, double rail_m, Model& model) {
  const Material cowl = model.Paint();
  const double size_m = model.Between(0.12, 0.28);
  if (model.Chance(0.25)) {
    model.Rod({stern_m - 0.1, y_m, rail_m}, {stern_m - 0.9, y_m, rail_m + model.Between(-0.1, 0.5)}, 0.08, cowl);
  }
  model.Add(Ellipsoid{{stern_m - 0.5 * size_m, y_m, rail_m + size_m}, {size_m, 0.7 * size_m, 1.4 * size_m}}, cowl);
  model.Post(stern_m - 0.5 * size_m, y_m, 0.09, -0.3, rail_m, cowl);
}

// A cloth roof on four posts.
void AddBimini(double min_x_m, double max_x_m, double half_y_m, double deck_m, Model& model) {
  const double roof_m = deck_m + model.Between(1.7, 2.1);
  const Material cloth = model.Cloth();
  const Material metal = model.Metal();
  model.Box(min_x_m, max_x_m, -half_y_m, half_y_m, roof_m, roof_m + 0.06, cloth);
  for (const double y_m : {-half_y_m, half_y_m}) {
    const double foot_x_m = (min_x_m + max_x_m) / 2.0;
    model.Rod({foot_x_m, y_m, deck_m}, {min_x_m, y_m, roof_m}, 0.015, metal);
    model.Rod({foot_x_m, y_m, deck_m}, {max_x_m, y_m, roof_m}, 0.015, metal);
  }
}

// People somewhere within, `max_count` of them at most; none in half of the boats that lie still.
void AddCrew(double min_x_m, double max_x_m, double half_y_m, double floor_m, int max_count, Model& model) {
  const int count = model.Whole(0, max_count);
  for (int i = 0; i < count; ++i) {
    const Vector2d facing = model.Chance(0.7) ? Vector2d(1.0, 0.0) : Vector2d(0.0, model.Chance(0.5) ? 1.0 : -1.0);
    const bool stands = model.Chance(0.3);
    model.Person({model.Between(min_x_m, max_x_m), model.Between(-half_y_m, half_y_m), floor_m + (stands ? 0.0 : 0.35)}, facing,
                 Model::PostureOf(stands));
  }
}

// Cylinders that hang at the sides.
void AddFenders(double length_m, double half_width_m, double rail_m, Model& model) {
  const int count = model.Whole(1, 3);
  const double radius_m = model.Between(0.08, 0.18);
  const Material rubber = model.Paint();
  for (int i = 0; i < count; ++i) {
    const double x_m = length_m * (-0.35 + 0.55 * (i + 0.5) / count);
    for (const double side : {-1.0, 1.0}) {
      const double y_m = side * (half_width_m + 0.6 * radius_m);
      model.Rod({x_m, y_m, std::max(rail_m - 0.7, 0.1)}, {x_m, y_m, std::max(rail_m - 0.2, 0.3)}, radius_m, rubber);
    }
  }
}

// A cabin or wheelhouse whose walls lean in, with a dark window band: lower part, windows, roof.
void AddHouse(double aft_m, double front_m, double half_y_m, double bottom_m, double height_m, double rake, Model& model) {
  const Material paint = model.Paint();
  const double band_from_m = bottom_m + height_m * model.Between(0.35, 0.6);
  const double band_to_m = bottom_m + height_m * model.Between(0.8, 0.92);
  const double side_lean = std::min(model.Between(0.0, 0.2), 0.3 * half_y_m / height_m);
  const auto layer = [&](double from_m, double to_m, const Material& material) {
    const double in_m = side_lean * (from_m - bottom_m);
    AddCabin({aft_m, front_m - rake * (from_m - bottom_m), half_y_m - in_m}, {side_lean, rake, side_lean, 0.0}, from_m, to_m, material, model);
  };
  layer(bottom_m, band_from_m, paint);
  layer(band_from_m, band_to_m, model.Glass());
  layer(band_to_m, bottom_m + height_m, paint);
}

struct Hull {
  HullPlan plan;
  double rail_m = 0.0;  // height of the side amidships
  double floor_m = 0.0;
};

// Flared, higher at the bow; open on top or decked.
Hull AddHull(const HullPlan& plan, double rail_m, bool is_open, const Material& paint, Model& model) {
  // Walls that lean in must not meet in the middle above the bottom. Long hulls bridge troughs.
  const double lean = std::min(model.Between(0.05, 0.5), 0.3 * plan.width_m / (rail_m + 0.15 + 0.08 * plan.length_m));
  LeaningWalls hull = HullWalls(plan, lean, -0.15 - 0.03 * plan.length_m, rail_m, model.Between(0.0, 0.09));
  const double floor_m = is_open ? std::min(model.Between(0.05, 0.25), rail_m - 0.1) : rail_m;
  if (is_open) {
    hull.wall_m = std::min(model.Between(0.04, 0.12), 0.15 * plan.width_m);
    hull.hollow_bottom_m = floor_m;
  }
  model.Add(ToConvex(hull), paint);
  return {plan, rail_m, floor_m};
}

// Inflated tubes around a flat floor.
void MakeInflatable(double length_m, double width_m, double reflectance, Model& model) {
  const double radius_m = std::clamp(width_m * model.Between(0.1, 0.14), 0.15, 0.3);
  const double x_m = length_m / 2.0 - radius_m;
  const double y_m = width_m / 2.0 - radius_m;
  const double shoulder_m = x_m - model.Between(0.6, 1.0) * y_m * 1.2;
  const double z_m = radius_m + model.Between(-0.05, 0.1);
  const double bow_z_m = z_m + model.Between(0.05, 0.3);
  const double tip_m = model.Between(0.1, 0.5) * y_m;
  const Material rubber = model.Paint(reflectance);
  model.Chain({{-x_m, -y_m, z_m}, {shoulder_m, -y_m, z_m}, {x_m, -tip_m, bow_z_m}, {x_m, tip_m, bow_z_m}, {shoulder_m, y_m, z_m}, {-x_m, y_m, z_m}},
              radius_m, rubber);
  model.Box(-0.9 * x_m, shoulder_m, -y_m, y_m, -0.1, model.Between(0.02, 0.15), model.Paint());
  model.Box(-0.9 * x_m, -0.9 * x_m + 0.06, -y_m, y_m, -0.1, z_m + 0.15, model.Paint());
  if (length_m > 4.0) {
    const double console_m = model.Between(-0.25, 0.1) * length_m;
    const double height_m = model.Between(0.7, 1.1);
    model.Box(console_m, console_m + 0.5, -0.35, 0.35, 0.1, height_m, model.Paint());
    if (model.Chance(0.7)) model.Box(console_m + 0.4, console_m + 0.46, -0.35, 0.35, height_m, height_m + 0.4, model.Glass());
    if (model.Chance(0.5)) {
      const Material metal = model.Metal();  // a frame of tubes over the stern
      const double top_m = model.Between(1.4, 2.0);
      model.Chain({{-0.8 * x_m, -0.8 * y_m, 0.3}, {-0.75 * x_m, -0.6 * y_m, top_m}, {-0.75 * x_m, 0.6 * y_m, top_m}, {-0.8 * x_m, 0.8 * y_m, 0.3}},
                  0.03, metal);
    }
  }
  if (model.Chance(0.7)) AddOutboard(-x_m - 0.1, 0.0, z_m + 0.1, model);
  AddCrew(-0.6 * x_m, 0.3 * x_m, 0.6 * y_m, 0.1, length_m > 4.0 ? 5 : 3, model);
}

// Stanchions and rails along the deck's edge from a share of the length to the bow and round it.
void AddPulpit(const HullPlan& plan, double deck_m, double bow_rise_m, Model& model) {
  const Material metal = model.Metal();
  const auto outline_m = OutlineOf(plan);
  const double height_m = model.Between(0.4, 0.75);
  const auto first = static_cast<std::size_t>(model.Whole(3, 6));
  const std::size_t last = 8;  // the bow's starboard corner, as OutlineOf orders them
  for (const double side : {1.0, -1.0}) {
    for (std::size_t i = first; i < last; ++i) {
      const auto on_deck = [&](std::size_t at) {
        const Vector2d p_m = 0.94 * outline_m[at];
        return Vector3d(p_m.x(), side * p_m.y(), deck_m + bow_rise_m * std::max(0.0, p_m.x() / plan.length_m * 2.0));
      };
      model.Railing(on_deck(i), on_deck(i + 1), height_m, 1.4, model.Chance(0.5) ? 2 : 1, 0.015, metal);
    }
  }
}

}  // namespace

// Rowing boats, flat-bottomed boats with a square bow, tenders, inflatables, runabouts with a console.
void MakeOpenBoat(const Size& size, Model& model) {
  HullPlan plan = DrawPlan(size, {2.2, 6.5}, {0.9, 0.12}, {1.2, 0.17}, model);
  const double length_m = plan.length_m;
  const double width_m = plan.width_m;
  if (model.Chance(0.3)) {
    MakeInflatable(length_m, width_m, size.reflectance, model);
    return;
  }
  const bool has_square_bow = model.Chance(0.2);
  plan.bow_power = model.Between(1.5, 3.0);
  plan.bow_share = has_square_bow ? model.Between(0.5, 0.85) : model.Between(0.02, 0.2);
  plan.transom_share = model.Chance(0.1) ? 0.1 : model.Between(0.55, 1.0);
  plan.middle_share = model.Between(0.45, 0.65);
  const Hull hull = AddHull(plan, model.Between(0.3, 0.45) + 0.05 * length_m, true, model.Paint(size.reflectance), model);
  const double half_y_m = 0.4 * width_m;
  // Thwarts across.
  const Material wood = model.Wood();
  const int num_thwarts = model.Whole(1, 3);
  for (int i = 0; i < num_thwarts; ++i) {
    const double x_m = length_m * (-0.35 + 0.6 * i / num_thwarts);
    model.Box(x_m, x_m + 0.25, -half_y_m, half_y_m, hull.rail_m - 0.2, hull.rail_m - 0.15, wood);
  }
  if (length_m > 4.0 && model.Chance(0.5)) {
    const double console_m = model.Between(-0.15, 0.1) * length_m;
    const double half_m = model.Chance(0.5) ? 0.35 : half_y_m;  // in the middle, or a windscreen right across
    const double top_m = hull.rail_m + model.Between(0.1, 0.6);
    const double rake = std::min(model.Between(0.2, 0.9), 0.3 / 0.45);
    model.Box(console_m, console_m + 0.4, -half_m, half_m, hull.floor_m, top_m, model.Paint());
    AddCabin({console_m, console_m + 0.4, half_m}, {0.1, rake, 0.1, 0.0}, top_m, top_m + model.Between(0.25, 0.45), model.Glass(), model);
    if (model.Chance(0.3)) AddBimini(console_m - 1.2, console_m + 0.6, half_y_m, hull.rail_m, model);
  } else if (model.Chance(0.3)) {
    for (const double side : {-1.0, 1.0}) {  // oars, out to the sides or laid in
      const double reach_m = model.Chance(0.5) ? model.Between(0.8, 1.6) : 0.0;
      model.Rod({0.0, side * 0.45 * width_m, hull.rail_m + 0.1}, {-1.0, side * (0.4 * width_m + reach_m), reach_m > 0.0 ? 0.05 : hull.rail_m + 0.05},
                0.03, wood);
    }
  }
  if (model.Chance(0.55)) AddOutboard(-length_m / 2.0, 0.0, hull.rail_m, model);
  if (model.Chance(0.15)) AddFenders(length_m, width_m / 2.0, hull.rail_m, model);
  AddCrew(-0.35 * length_m, 0.2 * length_m, 0.25 * width_m, hull.floor_m, length_m > 3.0 ? 4 : 2, model);
}

// From a day boat with a small cabin to a motor yacht with a flybridge.
void MakeCruiser(const Size& size, Model& model) {
  HullPlan plan = DrawPlan(size, {5.5, 16.0}, {1.3, 0.2}, {1.5, 0.25}, model);
  const double length_m = plan.length_m;
  const double width_m = plan.width_m;
  plan.bow_power = model.Between(1.5, 2.8);
  plan.bow_share = model.Between(0.0, 0.15);
  plan.transom_share = model.Between(0.75, 1.0);
  const double rail_m = 0.5 + length_m * model.Between(0.045, 0.09);
  const Material paint = model.Paint(size.reflectance);
  AddHull(plan, rail_m, false, paint, model);
  // A cockpit aft between coamings, a house, a foredeck that is a little raised.
  const double house_aft_m = length_m * model.Between(-0.25, -0.02);
  const double house_front_m = length_m * model.Between(0.12, 0.3);
  const double half_y_m = width_m * model.Between(0.32, 0.44);
  const double house_m = std::min(model.Between(0.9, 1.3) + 0.05 * length_m, 2.2);
  const double rake = std::min(model.Between(0.2, 1.6), 0.5 * (house_front_m - house_aft_m) / house_m);
  AddHouse(house_aft_m, house_front_m, half_y_m, rail_m, house_m, rake, model);
  const double roof_m = rail_m + house_m;
  if (model.Chance(0.7)) {
    for (const double side : {-1.0, 1.0}) {
      const double y_m = side * 0.42 * width_m;
      model.Box(-0.48 * length_m, house_aft_m, y_m - 0.06, y_m + 0.06, rail_m, rail_m + model.Between(0.15, 0.5), paint);
    }
  }
  if (model.Chance(0.6)) {
    AddCabin({house_front_m - 0.2, 0.38 * length_m, 0.6 * half_y_m}, {0.3, 1.0, 0.3, 0.0}, rail_m, rail_m + model.Between(0.15, 0.4), paint, model);
  }
  if (length_m > 9.0 && model.Chance(0.45)) {  // flybridge
    const double front_m = house_front_m - rake * house_m - 0.2;
    const double half_m = 0.8 * half_y_m;
    model.Railing({house_aft_m, -half_m, roof_m}, {front_m, -half_m, roof_m}, 0.8, 1.5, 2, 0.02, model.Metal());
    model.Railing({house_aft_m, half_m, roof_m}, {front_m, half_m, roof_m}, 0.8, 1.5, 2, 0.02, model.Metal());
    model.Box(front_m - 0.5, front_m, -half_m, half_m, roof_m, roof_m + 0.7, paint);
    if (model.Chance(0.5)) AddBimini(house_aft_m + 0.2, front_m, half_m, roof_m, model);
    if (model.Chance(0.4)) model.Person({front_m - 1.2, 0.0, roof_m + 0.3}, {1.0, 0.0}, Model::Posture::kSitting);
  } else if (model.Chance(0.4)) {
    AddBimini(-0.45 * length_m, house_aft_m, 0.38 * width_m, rail_m, model);
  }
  if (model.Chance(0.7)) {  // mast with lights, radar
    const double x_m = house_aft_m + model.Between(0.1, 0.5);
    const double mast_m = model.Between(0.6, 2.5);
    model.Rod({x_m, 0.0, roof_m}, {x_m - model.Between(0.0, 0.5), 0.0, roof_m + mast_m}, 0.04, model.Metal());
    if (model.Chance(0.4)) model.Add(Ellipsoid{{x_m - 0.1, 0.0, roof_m + 0.5 * mast_m}, {0.3, 0.3, 0.13}}, model.Paint());
  }
  if (model.Chance(0.75)) AddPulpit(plan, rail_m, 0.04 * length_m, model);
  if (model.Chance(0.3)) AddOutboard(-length_m / 2.0, 0.0, rail_m * 0.8, model);
  if (model.Chance(0.5)) {  // bathing platform
    const double out_m = model.Between(0.3, 0.9);
    model.Box(-length_m / 2.0 - out_m, -length_m / 2.0, -0.4 * width_m, 0.4 * width_m, 0.15, 0.25, model.Wood());
  }
  if (model.Chance(0.4)) AddFenders(length_m, width_m / 2.0, rail_m, model);
  AddCrew(-0.42 * length_m, house_aft_m - 0.3, 0.25 * width_m, rail_m - 0.2, 3, model);
}

// Fishing boats and launches with a wheelhouse, high bow and gear; flat landing boats.
void MakeWorkboat(const Size& size, Model& model) {
  HullPlan plan = DrawPlan(size, {6.0, 20.0}, {1.5, 0.19}, {1.9, 0.24}, model);
  const double length_m = plan.length_m;
  const double width_m = plan.width_m;
  plan.bow_power = model.Between(2.0, 4.0);
  plan.bow_share = model.Chance(0.25) ? model.Between(0.6, 0.95) : model.Between(0.05, 0.25);
  plan.transom_share = model.Between(0.6, 1.0);
  const double rail_m = model.Between(0.6, 1.0) + 0.04 * length_m;
  const Material paint = model.Paint(size.reflectance);
  AddHull(plan, rail_m, true, paint, model);
  const double house_aft_m = length_m * (model.Chance(0.5) ? model.Between(-0.4, -0.25) : model.Between(0.0, 0.12));
  const double house_front_m = house_aft_m + std::clamp(length_m * model.Between(0.15, 0.3), 1.2, 5.0);
  const double deck_m = rail_m * 0.4;
  double house_m = model.Between(2.0, 2.6);
  if (length_m > 14.0) house_m += model.Between(0.0, 2.0);
  const double house_half_m = width_m * model.Between(0.2, 0.36);
  AddHouse(house_aft_m, house_front_m, house_half_m, deck_m, house_m, model.Between(0.0, 0.3), model);
  const double roof_m = deck_m + house_m;
  const Material metal = model.Metal();
  const double mast_m = model.Between(1.0, 4.0);
  model.Post(house_aft_m + 0.4, 0.0, 0.06, roof_m, roof_m + mast_m, metal);
  if (model.Chance(0.5)) model.Rod({house_aft_m + 0.4, 0.0, roof_m + 0.3}, {-0.45 * length_m, 0.0, roof_m + model.Between(0.0, 1.5)}, 0.06, metal);
  if (model.Chance(0.5)) {  // a frame over the stern
    const double y_m = 0.35 * width_m;
    const double top_m = deck_m + model.Between(1.8, 3.0);
    model.Chain({{-0.45 * length_m, -y_m, deck_m}, {-0.47 * length_m, -y_m, top_m}, {-0.47 * length_m, y_m, top_m}, {-0.45 * length_m, y_m, deck_m}},
                0.07, metal);
  }
  const int num_boxes = model.Whole(0, 5);  // gear on deck
  for (int i = 0; i < num_boxes; ++i) {
    const double x_m = model.Between(-0.4, 0.3) * length_m;
    const double y_m = model.Between(-0.2, 0.2) * width_m;
    const double half_m = model.Between(0.25, 0.6);
    model.Box(x_m - half_m, x_m + half_m, y_m - half_m, y_m + half_m, deck_m, deck_m + model.Between(0.3, 1.3), model.Paint());
  }
  if (model.Chance(0.6)) AddFenders(length_m, width_m / 2.0, rail_m, model);
  AddCrew(-0.35 * length_m, 0.3 * length_m, 0.25 * width_m, deck_m, 3, model);
}

// A long low hull with blunt ends, deckhouse aft, hatches or cargo.
void MakeBarge(const Size& size, Model& model) {
  HullPlan plan = DrawPlan(size, {12.0, 40.0}, {2.1, 0.04}, {3.0, 0.07}, model);
  const double length_m = plan.length_m;
  const double width_m = plan.width_m;
  plan.bow_power = model.Between(4.0, 9.0);
  plan.bow_share = model.Between(0.3, 0.95);
  plan.transom_share = model.Between(0.8, 1.0);
  plan.middle_share = model.Between(0.6, 0.9);
  const double rail_m = model.Between(0.4, 1.8);
  model.Add(ToConvex(HullWalls(plan, model.Between(0.0, 0.15), -0.8, rail_m)), model.Paint(size.reflectance));
  const double house_m = std::clamp(length_m * model.Between(0.1, 0.3), 2.0, 9.0);
  const double house_aft_m = length_m * model.Between(-0.48, -0.4);
  const double rake = model.Between(0.0, 0.2);
  if (model.Chance(0.9)) AddHouse(house_aft_m, house_aft_m + house_m, 0.4 * width_m, rail_m, model.Between(1.2, 3.0), rake, model);
  const double hold_from_m = house_aft_m + house_m + 1.0;
  const double hold_to_m = 0.42 * length_m;
  if (model.Chance(0.6)) {  // coaming of the hold, or a long cabin
    model.Box(hold_from_m, hold_to_m, -0.36 * width_m, 0.36 * width_m, rail_m, rail_m + model.Between(0.2, 1.3), model.Paint());
  } else {
    const int num_heaps = model.Whole(0, 4);
    for (int i = 0; i < num_heaps; ++i) {
      const double x_m = model.Between(hold_from_m, hold_to_m);
      model.Add(Ellipsoid{{x_m, 0.0, rail_m}, {model.Between(0.8, 2.5), 0.35 * width_m, model.Between(0.4, 1.6)}}, model.Wood());
    }
  }
  if (model.Chance(0.5)) model.Railing({hold_from_m, 0.46 * width_m, rail_m}, {hold_to_m, 0.46 * width_m, rail_m}, 0.9, 3.0, 1, 0.02, model.Metal());
  if (model.Chance(0.5)) model.Post(0.44 * length_m, 0.0, 0.06, rail_m, rail_m + model.Between(1.0, 5.0), model.Metal());
  if (model.Chance(0.5)) AddFenders(0.9 * length_m, width_m / 2.0, rail_m, model);
  AddCrew(hold_from_m, hold_to_m, 0.3 * width_m, rail_m, 2, model);
}

}  // namespace lookout::sim
