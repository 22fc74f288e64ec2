#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "lab/sim/parts.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A paddle across the body, one end high.
void AddPaddle(const Vector3d& hands_m, double length_m, Model& model) {
  const double angle_rad = DegToRad(model.Between(-60.0, 60.0));
  const double yaw_rad = DegToRad(model.Between(-40.0, 40.0));
  const Vector3d half_m =
      length_m / 2.0 * Vector3d(std::cos(angle_rad) * std::sin(yaw_rad), std::cos(angle_rad) * std::cos(yaw_rad), std::sin(angle_rad));
  model.Rod(hands_m - half_m, hands_m + half_m, 0.018, model.Wood());
  model.Add(Ellipsoid{hands_m + half_m, {0.1, 0.1, 0.22}}, model.Paint());
}

}  // namespace

// Kayaks, closed around their paddlers, and canoes, open and with higher ends: one to three people, rarely none.
void MakeCanoe(const Size& size, Model& model) {
  const double length_m = model.GivenOrDrawn(size.length_m, 2.6, 6.5);
  const bool is_open = model.Chance(0.4);
  const double width_m = model.GivenOrDrawn(size.width_m, is_open ? 0.7 : 0.48, is_open ? 1.0 : 0.85);
  model.Float(length_m, width_m);
  HullPlan plan{length_m, width_m};
  plan.bow_power = model.Between(1.3, 2.2);
  plan.bow_share = model.Between(0.0, 0.1);
  plan.transom_share = plan.bow_share + 0.02;
  plan.middle_share = 0.5;
  const double rail_m = is_open ? model.Between(0.25, 0.4) : model.Between(0.12, 0.3);
  LeaningWalls hull = HullWalls(plan, std::min(0.25, 0.2 * width_m / (rail_m + 0.2)), -0.1, rail_m);
  if (is_open) {
    hull.wall_m = 0.03;
    hull.hollow_bottom_m = 0.02;
  }
  const Material paint = model.Paint(size.reflectance);
  model.Add(ToConvex(hull), paint);
  if (is_open || model.Chance(0.4)) {  // ends that rise
    for (const double end : {-1.0, 1.0}) {
      const double rise_m = model.Between(0.05, 0.25);
      model.Rod({end * 0.38 * length_m, 0.0, rail_m - 0.04}, {end * 0.48 * length_m, 0.0, rail_m + rise_m - 0.04}, 0.05, paint);
    }
  }
  const int most = length_m > 5.0 ? 3 : 2;
  const int count = model.Chance(0.06) ? 0 : model.Whole(1, length_m < 3.5 ? 1 : most);
  const double seat_m = is_open ? 0.15 : model.Between(-0.02, 0.12);
  for (int i = 0; i < count; ++i) {
    const double x_m = count == 1 ? model.Between(-0.4, 0.1) : length_m * 0.5 * (static_cast<double>(i) / (count - 1) - 0.5);
    model.Person({x_m, 0.0, seat_m}, {1.0, 0.0}, is_open && model.Chance(0.3) ? Model::Posture::kKneeling : Model::Posture::kSitting);
    if (model.Chance(0.85)) AddPaddle({x_m + 0.4, 0.0, seat_m + model.Between(0.35, 0.55)}, is_open ? 1.5 : 2.2, model);
  }
  if (model.Chance(0.2)) model.Add(Ellipsoid{{-0.3 * length_m, 0.0, rail_m}, {0.3, 0.2, 0.2}}, model.Paint());  // a bag
}

// A board a hand's breadth over the water and who stands, kneels or sits on it.
void MakePaddleBoard(const Size& size, Model& model) {
  HullPlan plan = DrawPlan(size, {2.6, 4.2}, {0.6}, {0.9}, model);
  plan.bow_power = 2.5;
  plan.transom_share = 0.5;
  const double top_m = model.Between(0.05, 0.14);
  model.Add(Prism{OutlineOf(plan), -0.05, top_m}, model.Paint(size.reflectance));
  const double share = model.Between(0.0, 1.0);
  const Model::Posture posture = share < 0.65 ? Model::Posture::kStanding : share < 0.85 ? Model::Posture::kKneeling : Model::Posture::kSitting;
  model.Person({model.Between(-0.3, 0.1), 0.0, top_m}, {1.0, 0.0}, posture);
  if (posture == Model::Posture::kStanding) {
    const double side = model.Chance(0.5) ? 1.0 : -1.0;
    model.Rod({0.35, side * 0.1, top_m + 1.5}, {model.Between(-0.2, 0.6), side * 0.5, -0.1}, 0.018, model.Wood());
  } else {
    AddPaddle({0.4, 0.0, top_m + 0.6}, 1.9, model);
  }
  if (model.Chance(0.15)) model.Person({0.7, 0.0, top_m}, {1.0, 0.0}, Model::Posture::kSitting);
}

// Two floats, seats on a deck between them, some with a slide or the shape of an animal.
void MakePedalBoat(const Size& size, Model& model) {
  const double length_m = model.GivenOrDrawn(size.length_m, 2.2, 4.2);
  const double width_m = model.GivenOrDrawn(size.width_m, 1.4, 2.0);
  model.Float(length_m, width_m);
  const Material paint = model.Paint(size.reflectance);
  const double float_m = model.Between(0.3, 0.45);
  const double y_m = 0.5 * width_m - 0.22;
  for (const double side : {-1.0, 1.0}) {
    HullPlan plan{length_m, 0.44};
    plan.bow_power = 2.5;
    auto footprint_m = OutlineOf(plan);
    for (auto& p_m : footprint_m) p_m.y() += side * y_m;
    model.Add(Prism{footprint_m, -0.15, float_m}, paint);
  }
  model.Box(-0.4 * length_m, 0.3 * length_m, -y_m, y_m, float_m - 0.15, float_m, paint);
  const int num_rows = length_m > 3.0 && model.Chance(0.5) ? 2 : 1;
  for (int row = 0; row < num_rows; ++row) {
    const double x_m = row == 0 ? -0.15 * length_m : 0.12 * length_m;
    for (const double side : {-1.0, 1.0}) {
      model.Box(x_m - 0.3, x_m - 0.2, side * 0.35 - 0.22, side * 0.35 + 0.22, float_m, float_m + model.Between(0.5, 0.7), paint);  // backrest
      if (model.Chance(0.65)) model.Person({x_m, side * 0.35, float_m + 0.1}, {1.0, 0.0}, Model::Posture::kSitting);
    }
  }
  if (model.Chance(0.2)) {  // a slide behind, with a ladder
    const double top_m = model.Between(1.4, 1.9);
    model.Sheet({-0.1 * length_m, -0.25, top_m}, {-0.1 * length_m, 0.25, top_m}, {-0.55 * length_m, 0.25, 0.4}, {-0.55 * length_m, -0.25, 0.4},
                paint);
    model.Rod({-0.1 * length_m, 0.25, float_m}, {-0.1 * length_m, 0.25, top_m}, 0.03, model.Metal());
    model.Rod({-0.1 * length_m, -0.25, float_m}, {-0.1 * length_m, -0.25, top_m}, 0.03, model.Metal());
  } else if (model.Chance(0.25)) {  // neck and head of a swan
    const double head_m = model.Between(1.5, 2.1);
    model.Chain(
        {{0.3 * length_m, 0.0, float_m}, {0.42 * length_m, 0.0, 0.7 * head_m}, {0.36 * length_m, 0.0, head_m}, {0.48 * length_m, 0.0, head_m}}, 0.13,
        paint);
  }
}

// Logs or barrels under a deck, bathing islands with a ladder, inflatable ones; people, a tent, a flag.
void MakeRaft(const Size& size, Model& model) {
  const double length_m = model.GivenOrDrawn(size.length_m, 1.8, 6.0);
  const double width_m = model.GivenOrDrawn(size.width_m, 0.5 * length_m, 0.95 * length_m);
  model.Float(length_m, width_m);
  const double deck_m = model.Between(0.12, 0.5);
  const int form = model.Whole(0, 2);
  if (form == 0) {
    const double radius_m = model.Between(0.1, 0.2);
    const Material wood = model.Paint(size.reflectance);
    for (double y_m = -width_m / 2.0 + radius_m; y_m < width_m / 2.0; y_m += 2.2 * radius_m) {
      const double in_m = model.Between(0.0, 0.3) + radius_m;
      model.Rod({-length_m / 2.0 + in_m, y_m, 0.3 * radius_m}, {length_m / 2.0 - in_m, y_m, 0.3 * radius_m}, radius_m, wood);
    }
  } else if (form == 1) {
    for (const double side : {-1.0, 1.0}) {
      const double radius_m = 0.7 * deck_m;
      model.Rod({-0.4 * length_m, side * 0.4 * width_m, 0.0}, {0.4 * length_m, side * 0.4 * width_m, 0.0}, radius_m, model.Paint());
    }
    model.Box(-length_m / 2.0, length_m / 2.0, -width_m / 2.0, width_m / 2.0, deck_m - 0.1, deck_m, model.Paint(size.reflectance));
    if (model.Chance(0.6)) {
      const Material metal = model.Metal();
      for (const double y_m : {-0.22, 0.22}) {
        model.Chain({{length_m / 2.0 + 0.05, y_m, -0.3}, {length_m / 2.0 + 0.05, y_m, deck_m + 0.8}, {length_m / 2.0 - 0.3, y_m, deck_m + 0.8}},
                    0.025, metal);
      }
    }
  } else {
    const double radius_m = std::min(0.12 * width_m, 0.35);
    const Material rubber = model.Paint(size.reflectance);
    const double x_m = length_m / 2.0 - radius_m;
    const double y_m = width_m / 2.0 - radius_m;
    model.Chain({{-x_m, -y_m, radius_m}, {x_m, -y_m, radius_m}, {x_m, y_m, radius_m}, {-x_m, y_m, radius_m}, {-x_m, -y_m, radius_m}}, radius_m,
                rubber);
    model.Box(-x_m, x_m, -y_m, y_m, 0.02, 0.1, rubber);
    if (model.Chance(0.4)) {  // a life raft's tent
      const double lean = 0.45 * width_m / 1.5;
      const double top_m = 2.0 * radius_m + model.Between(0.7, 1.1);
      AddCabin({-x_m, x_m, y_m}, {lean, lean, lean, lean}, 2.0 * radius_m, top_m, model.Chance(0.3) ? model.Retro() : model.Cloth(), model);
    }
  }
  const int count = model.Whole(0, 3);
  for (int i = 0; i < count; ++i) {
    const bool stands = model.Chance(0.35);
    model.Person({model.Between(-0.35, 0.35) * length_m, model.Between(-0.3, 0.3) * width_m, deck_m}, {0.0, 1.0}, Model::PostureOf(stands));
  }
  if (model.Chance(0.2)) model.Post(-0.4 * length_m, 0.0, 0.025, deck_m, deck_m + model.Between(1.0, 2.5), model.Wood());
}

// A head, shoulders or arms, a swim buoy in tow; wet skin is dark.
void MakeBather(const Size& size, Model& model) {
  const double head_m = model.GivenOrDrawn(size.width_m, 0.17, 0.26) / 2.0;
  const Material skin{model.Between(0.05, 0.4)};
  const Material cap = model.Chance(0.4) ? model.Paint() : skin;
  model.Float(0.4, 0.4);
  const double out_m = model.Between(0.05, 0.25);
  model.Add(Ellipsoid{{0.0, 0.0, out_m}, {head_m, head_m, 1.25 * head_m}}, cap);
  if (model.Chance(0.5)) {
    model.Add(Ellipsoid{{-0.15, 0.0, out_m - 0.2}, {0.15, 0.24, 0.15}}, skin);  // shoulders
    if (model.Chance(0.4)) {
      const double side = model.Chance(0.5) ? 1.0 : -1.0;
      model.Chain({{-0.1, side * 0.25, 0.05}, {0.1, side * 0.35, 0.35}, {0.4, side * 0.25, 0.1}}, 0.045, skin);  // an arm in the stroke
    }
  }
  if (model.Chance(0.3)) {
    const double behind_m = model.Between(0.9, 1.6);
    model.Rod({-behind_m - 0.35, 0.0, 0.06}, {-behind_m, 0.0, 0.06}, model.Between(0.1, 0.16), model.Paint(size.reflectance));
  }
}

}  // namespace lookout::sim
