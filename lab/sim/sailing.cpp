#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "lab/sim/parts.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

struct Rig {
  Vector2d mast_m;
  double foot_m;  // height of the mast's foot
  double top_m;
  double boom_m;    // length
  double tack_x_m;  // where the foresail is fastened
};

// A cloth between a straight edge that stands and a free corner: bellied to leeward, in strips from the foot to the head.
//
// @param tack_m, head_m  ends of the standing edge
// @param clew_m          free corner at the foot
// @param head_share      width at the head as a share of the foot
void AddSail(const Vector3d& tack_m, const Vector3d& head_m, const Vector3d& clew_m, double head_share, double belly, const Material& cloth,
             Model& model) {
  constexpr int kNumStrips = 3;
  const Vector3d foot_m = clew_m - tack_m;
  const Vector3d lee = Vector3d(-foot_m.y(), foot_m.x(), 0.0).normalized();
  const auto corner = [&](double height, double out) {
    const double width = 1.0 - (1.0 - head_share) * height;
    const double twist = 0.12 * height * out;
    return Vector3d(tack_m + height * (head_m - tack_m) + out * width * foot_m +
                    (4.0 * belly * out * (1.0 - out) + twist) * foot_m.norm() * width * lee);
  };
  for (int i = 0; i < kNumStrips; ++i) {
    const double low = static_cast<double>(i) / kNumStrips;
    const double high = static_cast<double>(i + 1) / kNumStrips;
    for (const auto& [from, to] : {std::pair(0.0, 0.5), std::pair(0.5, 1.0)}) {
      model.Sheet(corner(low, from), corner(low, to), corner(high, to), corner(high, from), cloth);
    }
  }
}

// Mast, stays, boom; sails up at an angle, or down on the boom, or none. Sails that are not bent on leave the boom bare.
void AddRig(const Rig& rig, double up_probability, Model& model) {
  const Material metal = model.Metal();
  const double radius_m = std::clamp(0.008 * rig.top_m, 0.03, 0.1);
  const Vector3d foot_m(rig.mast_m.x(), rig.mast_m.y(), rig.foot_m);
  const Vector3d top_m(rig.mast_m.x() - model.Between(0.0, 0.05) * rig.top_m, rig.mast_m.y(), rig.top_m);
  model.Rod(foot_m, top_m, radius_m, metal);
  const bool is_up = model.Chance(up_probability);
  const double side = model.Chance(0.5) ? 1.0 : -1.0;
  // Close-hauled to running; at a mooring amidships.
  const double sheet_rad = side * DegToRad(is_up ? model.Between(4.0, 80.0) : model.Between(0.0, 12.0));
  const Vector3d aft(-std::cos(sheet_rad), std::sin(sheet_rad), 0.0);
  const double gooseneck_m = rig.foot_m + model.Between(0.5, 1.0);
  const Vector3d tack_m = Vector3d(foot_m.x(), foot_m.y(), gooseneck_m);
  const Vector3d clew_m = tack_m + rig.boom_m * aft + Vector3d(0.0, 0.0, model.Between(0.0, 0.25));
  const Material cloth = model.Cloth();
  const bool has_boom = model.Chance(0.93);
  if (has_boom) model.Rod(tack_m, clew_m, 0.6 * radius_m + 0.01, metal);
  if (is_up) {
    const double head_m = rig.top_m - model.Between(0.1, 0.15 * rig.top_m);
    const double head_share = model.Between(0.05, 0.35);
    AddSail(tack_m, Vector3d(top_m.x(), top_m.y(), head_m), clew_m, head_share, model.Between(0.03, 0.12), cloth, model);
  } else if (has_boom && model.Chance(0.8)) {
    model.Rod(tack_m + Vector3d(0.0, 0.0, 0.15), clew_m + Vector3d(0.0, 0.0, 0.12), model.Between(0.08, 0.2), cloth);
  }
  if (rig.tack_x_m > rig.mast_m.x() + 0.3) {
    const Vector3d bow_m(rig.tack_x_m, rig.mast_m.y(), rig.foot_m);
    const Vector3d hounds_m = foot_m + model.Between(0.75, 0.97) * (top_m - foot_m);
    const bool has_jib = is_up && model.Chance(0.75);
    if (has_jib) {
      const double foot_length_m = (rig.tack_x_m - rig.mast_m.x()) * model.Between(0.7, 1.2);
      const double jib_rad = 0.6 * sheet_rad + side * 0.1;
      const Vector3d jib_clew_m = bow_m + Vector3d(-foot_length_m * std::cos(jib_rad), foot_length_m * std::sin(jib_rad), model.Between(0.2, 0.7));
      AddSail(bow_m, bow_m + 0.93 * (hounds_m - bow_m), jib_clew_m, 0.03, model.Between(0.05, 0.14), cloth, model);
    }
    // A stay, thin as a wire or thick as a furled sail.
    model.Rod(bow_m, hounds_m, !has_jib && model.Chance(0.6) ? model.Between(0.04, 0.09) : 0.004, has_jib ? metal : cloth);
  }
}

// A slim hull beside the middle line, pointed at both ends or with a small transom.
void AddSlimHull(double y_m, double length_m, double width_m, double top_m, const Material& paint, Model& model) {
  HullPlan plan{length_m, width_m};
  plan.bow_power = 1.7;
  plan.bow_share = 0.05;
  plan.transom_share = 0.5;
  LeaningWalls hull = HullWalls(plan, std::min(0.2, 0.2 * width_m / (top_m + 0.2 + 0.03 * length_m)), -0.15 - 0.02 * length_m, top_m, 0.02);
  for (auto& p_m : hull.footprint_m) p_m.y() += y_m;
  model.Add(ToConvex(hull), paint);
}

// Two inflated tubes with turned-up ends, a small deck high between them on arching legs: most of it is air.
void MakeWaveAdaptive(double length_m, double beam_m, double reflectance, Model& model) {
  const Material rubber = model.Paint(reflectance);
  const Material metal = model.Metal();
  const double radius_m = length_m * model.Between(0.045, 0.06);
  const double y_m = beam_m / 2.0 - radius_m;
  const double x_m = length_m / 2.0 - radius_m;
  const double rise_m = model.Between(0.1, 0.35);
  const double deck_m = model.Between(0.6, 1.3);
  const double deck_half_x_m = length_m * model.Between(0.14, 0.25);
  const double deck_half_y_m = beam_m * model.Between(0.15, 0.3);
  for (const double side : {-1.0, 1.0}) {
    model.Chain({{-x_m, side * y_m, 0.6 * radius_m}, {0.6 * x_m, side * y_m, 0.6 * radius_m}, {x_m, side * y_m, 0.6 * radius_m + rise_m}}, radius_m,
                rubber);
    for (const double end : {-1.0, 1.0}) {
      model.Rod({end * 0.55 * x_m, side * y_m, 1.4 * radius_m}, {end * deck_half_x_m, side * deck_half_y_m, deck_m}, model.Between(0.025, 0.06),
                metal);
    }
    if (model.Chance(0.7)) model.Box(-x_m - 0.45, -x_m - 0.15, side * y_m - 0.12, side * y_m + 0.12, -0.2, 2.0 * radius_m + 0.2, model.Paint());
  }
  model.Box(-deck_half_x_m, deck_half_x_m, -deck_half_y_m, deck_half_y_m, deck_m, deck_m + model.Between(0.06, 0.2), model.Paint());
  if (model.Chance(0.7)) {
    const double box_m = model.Between(0.15, 0.35);
    model.Box(-box_m, box_m, -box_m, box_m, deck_m, deck_m + model.Between(0.3, 0.6), model.Paint());
  }
  const int num_masts = model.Whole(1, 3);
  for (int i = 0; i < num_masts; ++i) {
    const double mast_m = model.Between(0.5, 1.5);
    const double at_m = model.Between(-0.9, 0.9) * deck_half_x_m;
    model.Post(at_m, 0.0, 0.03, deck_m, deck_m + mast_m, metal);
    if (model.Chance(0.5)) model.Post(at_m, 0.0, model.Between(0.08, 0.2), deck_m + mast_m, deck_m + mast_m + 0.15, model.Paint());
  }
}

// Two tubes under a flat deck with a fence and a roof.
void MakePontoonBoat(double length_m, double beam_m, double reflectance, Model& model) {
  const Material metal = model.Metal();
  const double radius_m = model.Between(0.28, 0.36);
  const double y_m = beam_m / 2.0 - radius_m;
  const double x_m = length_m / 2.0 - radius_m;
  for (const double side : {-1.0, 1.0}) model.Rod({-x_m, side * y_m, 0.05}, {x_m, side * y_m, 0.05}, radius_m, metal);
  const double deck_m = model.Between(0.45, 0.65);
  const double end_m = length_m / 2.0 - 0.2;
  model.Box(-end_m, end_m, -beam_m / 2.0, beam_m / 2.0, deck_m, deck_m + 0.08, model.Wood());
  const Material panel = model.Paint(reflectance);
  const double fence_m = deck_m + model.Between(0.6, 0.9);
  const double half_y_m = beam_m / 2.0 - 0.05;
  model.Box(-end_m, 0.9 * end_m, -half_y_m, -half_y_m + 0.04, deck_m + 0.1, fence_m, panel);
  model.Box(-end_m, 0.9 * end_m, half_y_m - 0.04, half_y_m, deck_m + 0.1, fence_m, panel);
  model.Box(0.88 * end_m, 0.9 * end_m, -half_y_m, half_y_m, deck_m + 0.1, fence_m, panel);
  if (model.Chance(0.7)) {
    const double roof_m = deck_m + model.Between(1.9, 2.2);
    const double from_m = -0.9 * end_m;
    const double to_m = model.Between(-0.1, 0.4) * end_m;
    model.Box(from_m, to_m, -half_y_m, half_y_m, roof_m, roof_m + 0.08, model.Cloth());
    for (const double at_m : {from_m + 0.1, to_m - 0.1}) {
      for (const double side : {-1.0, 1.0}) model.Post(at_m, side * half_y_m * 0.97, 0.02, deck_m, roof_m, metal);
    }
  }
  const int count = model.Whole(0, 5);
  for (int i = 0; i < count; ++i) {
    const bool stands = model.Chance(0.3);
    const double facing = model.Chance(0.5) ? 1.0 : -1.0;
    model.Person({model.Between(-0.8, 0.8) * end_m, model.Between(-0.35, 0.35) * beam_m, deck_m + (stands ? 0.1 : 0.45)}, {0.0, facing},
                 Model::PostureOf(stands));
  }
}

// A beach catamaran: a net between two beams, a tall rig, people on the net or out on a wire.
void MakeBeachCatamaran(double length_m, double beam_m, double reflectance, Model& model) {
  const double hull_m = model.Between(0.3, 0.5);
  const double width_m = model.Between(0.3, 0.5);
  const double y_m = (beam_m - width_m) / 2.0;
  const Material paint = model.Paint(reflectance);
  for (const double side : {-1.0, 1.0}) AddSlimHull(side * y_m, length_m, width_m, hull_m, paint, model);
  const double aft_m = -0.38 * length_m;
  const double front_m = model.Between(0.05, 0.15) * length_m;
  const Material metal = model.Metal();
  for (const double x_m : {aft_m, front_m}) model.Rod({x_m, -y_m, hull_m + 0.08}, {x_m, y_m, hull_m + 0.08}, 0.05, metal);
  if (model.Chance(0.85)) model.Box(aft_m, front_m, -y_m, y_m, hull_m + 0.08, hull_m + 0.1, model.Cloth());
  AddRig({{front_m, 0.0}, hull_m + 0.1, length_m * model.Between(1.3, 1.7), front_m - aft_m, 0.42 * length_m}, 0.55, model);
  const int count = model.Whole(0, 2);
  for (int i = 0; i < count; ++i) {
    model.Person({model.Between(aft_m + 0.3, front_m - 0.3), model.Between(-0.9, 0.9) * y_m, hull_m + 0.1}, {1.0, 0.0}, Model::Posture::kSitting);
  }
}

// A cruising catamaran: high slim hulls, a house on the bridge deck, water between the hulls.
void MakeCruisingCatamaran(double length_m, double beam_m, double reflectance, Model& model) {
  const double hull_m = 0.5 + length_m * model.Between(0.06, 0.09);
  const double width_m = beam_m * model.Between(0.22, 0.3);
  const double y_m = (beam_m - width_m) / 2.0;
  const Material paint = model.Paint(reflectance);
  for (const double side : {-1.0, 1.0}) AddSlimHull(side * y_m, length_m, width_m, hull_m, paint, model);
  const double aft_m = -0.42 * length_m;
  const double front_m = model.Between(0.1, 0.2) * length_m;
  const double clear_m = model.Between(0.4, 0.7) * hull_m;  // free height under the deck
  model.Box(aft_m, front_m, -y_m, y_m, clear_m, hull_m, paint);
  const double rake = model.Between(0.4, 1.2);
  const double roof_m = hull_m + model.Between(0.8, 1.3);
  AddCabin({aft_m + 0.2 * length_m, front_m, 0.8 * y_m}, {0.2, rake, 0.2, 0.0}, hull_m, roof_m, model.Chance(0.5) ? model.Glass() : paint, model);
  if (model.Chance(0.8)) model.Rod({0.45 * length_m, -y_m, hull_m}, {0.45 * length_m, y_m, hull_m}, 0.08, model.Metal());
  for (const double side : {-1.0, 1.0}) {
    model.Railing({aft_m, side * (y_m + 0.3 * width_m), hull_m}, {0.4 * length_m, side * (y_m + 0.3 * width_m), hull_m}, 0.65, 2.0, 2, 0.012,
                  model.Metal());
  }
  AddRig({{front_m - 0.3, 0.0}, roof_m, length_m * model.Between(1.2, 1.5), 0.4 * length_m, 0.45 * length_m}, 0.3, model);
}

}  // namespace

// From a child's boat to a skiff; open, one or two people, who often sit out at the side.
void MakeSailingDinghy(const Size& size, Model& model) {
  HullPlan plan = DrawPlan(size, {2.3, 6.0}, {0.7, 0.15}, {0.9, 0.22}, model);
  const double length_m = plan.length_m;
  const double width_m = plan.width_m;
  plan.bow_power = model.Between(1.4, 2.4);
  plan.bow_share = model.Chance(0.2) ? 0.5 : model.Between(0.0, 0.1);
  plan.transom_share = model.Between(0.6, 0.95);
  const double rail_m = model.Between(0.3, 0.55);
  const double lean = std::min(model.Between(0.2, 0.8), 0.3 * width_m / (rail_m + 0.3));
  LeaningWalls hull = HullWalls(plan, lean, -0.1, rail_m, model.Between(0.0, 0.06));
  hull.wall_m = model.Between(0.05, 0.3) * width_m;  // side decks
  hull.hollow_bottom_m = 0.1;
  model.Add(ToConvex(hull), model.Paint(size.reflectance));
  const double mast_x_m = length_m * model.Between(0.12, 0.35);
  AddRig({{mast_x_m, 0.0}, rail_m, length_m * model.Between(1.2, 1.7), length_m * model.Between(0.45, 0.62), 0.48 * length_m}, 0.65, model);
  const int count = model.Whole(0, length_m > 3.2 ? 3 : 1);
  const double side = model.Chance(0.5) ? 1.0 : -1.0;
  for (int i = 0; i < count; ++i) {
    const double y_m = side * model.Between(0.1, 0.5) * width_m;
    model.Person({length_m * (-0.3 + 0.18 * i), y_m, rail_m}, {0.0, -side}, Model::Posture::kSitting);
  }
  if (model.Chance(0.8)) model.Box(-length_m / 2.0 - 0.08, -length_m / 2.0, -0.15, 0.15, -0.2, rail_m, model.Wood());  // rudder
}

// With cabin, keel, stays and rails; sails down in most, as at moorings.
void MakeYacht(const Size& size, Model& model) {
  HullPlan plan = DrawPlan(size, {5.5, 16.0}, {1.0, 0.18}, {1.3, 0.24}, model);
  const double length_m = plan.length_m;
  const double width_m = plan.width_m;
  plan.bow_power = model.Between(1.4, 2.2);
  plan.bow_share = model.Between(0.0, 0.08);
  plan.transom_share = model.Chance(0.15) ? 0.05 : model.Between(0.4, 0.9);
  const double rail_m = 0.45 + length_m * model.Between(0.04, 0.07);
  const double lean = model.Between(0.05, 0.35);
  const Material paint = model.Paint(size.reflectance);
  model.Add(ToConvex(HullWalls(plan, lean, -0.2 - 0.03 * length_m, rail_m, model.Between(0.01, 0.05))), paint);
  const double mast_x_m = length_m * model.Between(0.02, 0.16);
  const double cabin_m = model.Between(0.25, 0.6);
  const double cabin_aft_m = length_m * model.Between(-0.2, -0.08);
  const double cabin_front_m = length_m * model.Between(0.18, 0.3);
  const double rake = model.Between(0.5, 2.0);
  AddCabin({cabin_aft_m, cabin_front_m, 0.28 * width_m}, {0.3, rake, 0.3, 0.1}, rail_m, rail_m + cabin_m, model.Chance(0.3) ? model.Paint() : paint,
           model);
  if (model.Chance(0.5)) {  // spray hood
    AddCabin({cabin_aft_m - 0.7, cabin_aft_m + 0.7, 0.26 * width_m}, {0.2, 1.0, 0.2, 0.0}, rail_m + 0.5 * cabin_m,
             rail_m + cabin_m + model.Between(0.35, 0.55), model.Cloth(), model);
  }
  if (model.Chance(0.8)) {  // rails on both sides, pulpit and pushpit
    const Material metal = model.Metal();
    const double height_m = model.Between(0.5, 0.65);
    for (const double side : {-1.0, 1.0}) {
      const Vector3d stern_m(-0.46 * length_m, side * 0.45 * plan.transom_share * width_m, rail_m);
      const Vector3d middle_m(0.0, side * 0.47 * width_m, rail_m);
      const Vector3d bow_m(0.42 * length_m, side * 0.1 * width_m, rail_m + 0.02 * length_m);
      model.Railing(stern_m, middle_m, height_m, 2.0, 2, 0.012, metal);
      model.Railing(middle_m, bow_m, height_m, 2.0, 2, 0.012, metal);
    }
  }
  AddRig({{mast_x_m, 0.0}, rail_m + cabin_m, length_m * model.Between(1.15, 1.5), mast_x_m + length_m * model.Between(0.25, 0.4), 0.47 * length_m},
         0.35, model);
  if (model.Chance(0.3)) model.Post(-0.47 * length_m, 0.2 * width_m, 0.02, rail_m, rail_m + model.Between(1.0, 2.5), model.Metal());  // flag, aerial
  const int count = model.Whole(0, 3);
  for (int i = 0; i < count; ++i) {
    const double side = model.Chance(0.5) ? 1.0 : -1.0;
    model.Person({length_m * model.Between(-0.4, -0.22), side * 0.25 * width_m, rail_m + 0.1}, {0.0, -side}, Model::Posture::kSitting);
  }
}

void MakeTwinHull(const Size& size, Model& model) {
  const int form = model.Whole(0, 3);
  double length_m = 0.0;
  double beam_m = 0.0;
  const auto draw = [&](double shortest_m, double longest_m, double least_share, double greatest_share) {
    length_m = model.GivenOrDrawn(size.length_m, shortest_m, longest_m);
    beam_m = model.GivenOrDrawn(size.width_m, least_share * length_m, greatest_share * length_m);
    model.Float(length_m, beam_m);
  };
  if (form == 0) {
    draw(2.5, 6.0, 0.45, 0.65);
    MakeWaveAdaptive(length_m, beam_m, size.reflectance, model);
  } else if (form == 1) {
    draw(3.9, 6.5, 0.42, 0.55);
    MakeBeachCatamaran(length_m, beam_m, size.reflectance, model);
  } else if (form == 2) {
    draw(5.0, 9.0, 0.3, 0.4);
    MakePontoonBoat(length_m, beam_m, size.reflectance, model);
  } else {
    draw(8.0, 15.0, 0.45, 0.6);
    MakeCruisingCatamaran(length_m, beam_m, size.reflectance, model);
  }
}

}  // namespace lookout::sim
