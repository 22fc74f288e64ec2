#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "lab/sim/parts.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Balls, cones, a can, a cross or a retro-reflecting band at the top of a rod.
void AddTopMark(const Vector3d& at_m, double size_m, Model& model) {
  const Material paint = model.Paint();
  const int form = model.Whole(0, 4);
  const Vector2d plan_m = at_m.head<2>();
  if (form == 0) {
    model.Add(Ellipsoid{at_m, Vector3d::Constant(size_m)}, paint);
  } else if (form == 1) {
    model.Add(Cone{plan_m, size_m, 0.0, at_m.z(), at_m.z() + 1.8 * size_m}, paint);
    if (model.Chance(0.5)) model.Add(Cone{plan_m, 0.0, size_m, at_m.z() + 2.2 * size_m, at_m.z() + 4.0 * size_m}, paint);
  } else if (form == 2) {
    model.Add(Cylinder{plan_m, 0.8 * size_m, at_m.z(), at_m.z() + 1.6 * size_m}, paint);
  } else if (form == 3) {
    const Vector3d up_m(0.0, size_m, size_m);
    const Vector3d down_m(0.0, size_m, -size_m);
    model.Rod(at_m - up_m, at_m + up_m, 0.2 * size_m, paint);
    model.Rod(at_m - down_m, at_m + down_m, 0.2 * size_m, paint);
  } else {
    model.Add(Cylinder{plan_m, 0.5 * size_m, at_m.z(), at_m.z() + size_m}, model.Retro());
  }
}

// Four legs that meet a ring, with braces: a light buoy's open frame.
void AddFrame(double bottom_m, double top_m, double foot_m, double head_m, Model& model) {
  const Material metal = model.Paint();
  const double radius_m = model.Between(0.02, 0.05);
  const int num_legs = model.Whole(3, 4);
  const auto corner = [&](int leg, double share) {
    return OnCircle(leg, num_legs, foot_m + share * (head_m - foot_m), bottom_m + share * (top_m - bottom_m));
  };
  for (int leg = 0; leg < num_legs; ++leg) {
    model.Rod(corner(leg, 0.0), corner(leg, 1.0), radius_m, metal);
    for (const double share : {0.35, 0.7}) model.Rod(corner(leg, share), corner(leg + 1, share), 0.7 * radius_m, metal);
  }
}

}  // namespace

// Cans, cones, balls, spars, and light buoys with a frame or a pillar on a broad float; 0.4 to 5 m high.
void MakeNavigationBuoy(const Size& size, Model& model) {
  const int form = model.Whole(0, 4);
  const Material paint = model.Paint(size.reflectance);
  const Vector2d middle_m = Vector2d::Zero();
  double width_m = 0.0;
  double top_m = 0.0;
  Vector3d head_m = Vector3d::Zero();
  if (form == 0) {  // can, with or without a broader float
    width_m = model.GivenOrDrawn(size.width_m, 0.4, 2.0);
    top_m = model.GivenOrDrawn(size.height_m, 0.7 * width_m, 1.7 * width_m);
    model.Add(Cylinder{middle_m, width_m / 2.0, -0.2, top_m}, paint);
    if (model.Chance(0.4)) model.Add(Cylinder{middle_m, 0.75 * width_m, -0.2, 0.25 * top_m}, paint);
  } else if (form == 1) {  // cone on a drum
    width_m = model.GivenOrDrawn(size.width_m, 0.4, 2.0);
    top_m = model.GivenOrDrawn(size.height_m, 0.8 * width_m, 1.8 * width_m);
    const double drum_m = top_m * model.Between(0.1, 0.4);
    model.Add(Cylinder{middle_m, width_m / 2.0, -0.2, drum_m}, paint);
    model.Add(Cone{middle_m, width_m / 2.0, model.Between(0.0, 0.15) * width_m, drum_m, top_m}, paint);
  } else if (form == 2) {  // ball
    width_m = model.GivenOrDrawn(size.width_m, 0.4, 2.2);
    top_m = model.GivenOrDrawn(size.height_m, 0.6 * width_m, 0.85 * width_m);
    model.Add(Ellipsoid{{0.0, 0.0, top_m - width_m / 2.0}, Vector3d::Constant(width_m / 2.0)}, paint);
  } else if (form == 3) {  // spar, leaning
    width_m = model.GivenOrDrawn(size.width_m, 0.08, 0.4);
    top_m = model.GivenOrDrawn(size.height_m, 1.0, 4.0);
    const double lean_rad = DegToRad(model.Between(0.0, 15.0));
    head_m.x() = top_m * std::tan(lean_rad);
    model.Rod({0.0, 0.0, -0.5}, {head_m.x(), 0.0, top_m}, width_m / 2.0, paint);
    if (model.Chance(0.5)) model.Add(Ellipsoid{{0.0, 0.0, 0.1}, {1.8 * width_m, 1.8 * width_m, 0.25}}, model.Paint());
  } else {  // light buoy
    width_m = model.GivenOrDrawn(size.width_m, 1.2, 3.0);
    top_m = model.GivenOrDrawn(size.height_m, 2.0, 5.0);
    const double float_m = model.Between(0.2, 0.6);
    model.Add(Cylinder{middle_m, width_m / 2.0, -0.3, float_m}, paint);
    if (model.Chance(0.7)) {
      AddFrame(float_m, top_m, 0.35 * width_m, model.Between(0.08, 0.2) * width_m, model);
      if (model.Chance(0.6)) model.Box(-0.02, 0.02, -0.2 * width_m, 0.2 * width_m, 0.5 * top_m, 0.75 * top_m, paint);  // radar reflector, day mark
    } else {
      model.Add(Cone{middle_m, 0.25 * width_m, 0.1 * width_m, float_m, top_m}, paint);
    }
    model.Add(Cylinder{middle_m, 0.12, top_m, top_m + 0.3}, model.Chance(0.5) ? model.Retro() : model.Glass());
  }
  head_m.z() = top_m;
  if (form != 4 && model.Chance(0.35)) {
    const Vector3d mark_m = head_m + Vector3d(0.0, 0.0, model.Between(0.2, 0.8));
    model.Rod(head_m, mark_m, 0.025, model.Metal());
    AddTopMark(mark_m, std::clamp(0.2 * width_m, 0.1, 0.35), model);
  }
  if (form != 3 && model.Chance(0.3)) model.Add(Cylinder{middle_m, 0.3 * width_m, 0.85 * top_m, 0.95 * top_m}, model.Retro());
  const double waterline_m = std::max(width_m, 0.3);
  model.Float(waterline_m, waterline_m);
}

// Net floats, pots' floats, mooring balls, bottles and fenders at a line: 0.15 to 0.8 m, barely out of the water; some with a flag on a stick.
void MakeFloat(const Size& size, Model& model) {
  const double width_m = model.GivenOrDrawn(size.width_m, 0.15, 0.8);
  const double top_m = model.GivenOrDrawn(size.height_m, 0.5 * width_m, 0.9 * width_m);
  const Material paint = model.Paint(size.reflectance);
  const double share = model.Between(0.0, 1.0);
  if (share < 0.6) {
    model.Add(Ellipsoid{{0.0, 0.0, top_m - width_m / 2.0}, Vector3d::Constant(width_m / 2.0)}, paint);
  } else {
    const double half_m = model.Between(0.1, 0.8) * width_m;
    model.Rod({-half_m, 0.0, top_m - width_m / 2.0}, {half_m, 0.0, top_m - width_m / 2.0}, width_m / 2.0, paint);
  }
  if (model.Chance(0.2)) {
    const double stick_m = model.Between(0.8, 2.2);
    const double lean_m = model.Between(-0.2, 0.2) * stick_m;
    model.Rod({0.0, 0.0, 0.0}, {lean_m, 0.0, stick_m}, 0.015, model.Wood());
    if (model.Chance(0.7)) {
      model.Sheet({lean_m, 0.0, stick_m}, {lean_m, 0.0, stick_m - 0.3}, {lean_m, 0.4, stick_m - 0.3}, {lean_m, 0.4, stick_m}, model.Cloth());
    }
  }
  model.Float(width_m, width_m);
}

// Inflated marks of a course: cylinders, cones, tetrahedra, balls; 0.8 to 2.2 m.
void MakeRaceMark(const Size& size, Model& model) {
  const double width_m = model.GivenOrDrawn(size.width_m, 0.6, 1.6);
  const double top_m = model.GivenOrDrawn(size.height_m, 0.8, 2.2);
  const Material cloth = model.Paint(size.reflectance);
  const Vector2d middle_m = Vector2d::Zero();
  const int form = model.Whole(0, 3);
  if (form == 0) {
    const double lean_m = model.Between(0.0, 0.15) * top_m;
    model.Rod({0.0, 0.0, 0.2}, {lean_m, 0.0, std::max(top_m - width_m / 2.0, 0.3)}, width_m / 2.0, cloth);
  } else if (form == 1) {
    model.Add(Cone{middle_m, width_m / 2.0, 0.15 * width_m, -0.1, top_m}, cloth);
  } else if (form == 2) {  // tetrahedron on one of its faces
    LeaningWalls walls;
    walls.footprint_m = Circle(middle_m, width_m / std::sqrt(3.0), 3);
    walls.lean = {0.95 * width_m / (2.0 * std::sqrt(3.0)) / (top_m + 0.1)};
    walls.bottom_m = -0.1;
    walls.top_m = top_m;
    model.Add(ToConvex(walls), cloth);
  } else {
    model.Add(Ellipsoid{{0.0, 0.0, top_m / 2.0}, {width_m / 2.0, width_m / 2.0, top_m / 2.0}}, cloth);
  }
  model.Float(width_m, width_m);
}

// Stakes, perches with twigs, piles in groups, boards on a pile; they stand on the ground and some lean.
void MakeStake(const Size& size, Model& model) {
  const double top_m = model.GivenOrDrawn(size.height_m, 0.5, 4.5);
  const double radius_m = model.GivenOrDrawn(size.width_m, 0.05, 0.4) / 2.0;
  const Material wood = model.Paint(size.reflectance);
  const double lean = model.Chance(0.6) ? model.Between(0.0, 0.2) : 0.0;
  const int num_piles = model.Chance(0.2) ? 3 : 1;
  for (int i = 0; i < num_piles; ++i) {
    const Vector3d foot_m = OnCircle(i, num_piles, num_piles == 1 ? 0.0 : 2.2 * radius_m, -0.5);
    const double share = num_piles == 1 ? 1.0 : 0.5;
    model.Rod(foot_m, {share * foot_m.x() + lean * top_m, share * foot_m.y(), top_m}, radius_m, wood);
  }
  const Vector3d head_m(lean * top_m, 0.0, top_m);
  const double share = model.Between(0.0, 1.0);
  if (share < 0.25) {
    AddTopMark(head_m, model.Between(0.15, 0.35), model);
  } else if (share < 0.5) {
    const double half_m = model.Between(0.2, 0.7);
    const double height_m = model.Between(0.3, 1.0);
    model.Box(head_m.x() - radius_m - 0.03, head_m.x() - radius_m, -half_m, half_m, top_m - height_m, top_m,
              model.Chance(0.3) ? model.Retro() : model.Paint());
  } else if (share < 0.65) {  // twigs
    for (int i = 0; i < 6; ++i) {
      const Vector2d out_m{model.Between(-0.4, 0.4), model.Between(-0.4, 0.4)};
      model.Rod(head_m, head_m + Vector3d(out_m.x(), out_m.y(), model.Between(0.2, 0.8)), 0.012, wood);
    }
  }
}

// A ring of tubes with a handrail on posts and a net over it; some in a group of smaller floats. 4 to 16 m.
void MakeFishFarm(const Size& size, Model& model) {
  const double width_m = model.GivenOrDrawn(size.width_m, 4.0, 16.0);
  const double radius_m = width_m / 2.0;
  const double tube_m = model.Between(0.08, 0.2);
  const double rail_m = model.Chance(0.75) ? model.Between(0.6, 1.1) : 0.0;
  const Material plastic = model.Paint(size.reflectance > 0.0 ? size.reflectance : 0.04);
  const Material rope = model.Cloth();
  const int num_sides = model.Whole(12, 20);
  const auto corner = [&](int i, double out_m, double z_m) { return OnCircle(i, num_sides, out_m, z_m); };
  const double outer_m = radius_m - tube_m;
  const double inner_m = outer_m - 3.0 * tube_m;
  const bool is_double = model.Chance(0.6);
  for (int i = 0; i < num_sides; ++i) {
    model.Rod(corner(i, outer_m, 0.3 * tube_m), corner(i + 1, outer_m, 0.3 * tube_m), tube_m, plastic);
    if (is_double) model.Rod(corner(i, inner_m, 0.3 * tube_m), corner(i + 1, inner_m, 0.3 * tube_m), tube_m, plastic);
    if (rail_m == 0.0) continue;
    model.Rod(corner(i, outer_m, 0.0), corner(i, inner_m, rail_m), 0.04, plastic);
    model.Rod(corner(i, inner_m, rail_m), corner(i + 1, inner_m, rail_m), 0.03, rope);
  }
  if (model.Chance(0.4)) model.Post(0.0, 0.0, 0.06, -0.2, model.Between(1.0, 3.0), plastic);
  model.Float(width_m, width_m);
}

// Trunks and planks adrift, with a branch or two; most of them under water.
void MakeLog(const Size& size, Model& model) {
  const double length_m = model.GivenOrDrawn(size.length_m, 0.8, 8.0);
  const double width_m = model.GivenOrDrawn(size.width_m, 0.12, 0.6);
  const Material bark{model.Paint(size.reflectance > 0.0 ? size.reflectance : 0.12)};
  const double radius_m = width_m / 2.0;
  const double out_m = width_m * model.Between(0.15, 0.6);  // above the water
  const double pitch_m = model.Between(-0.1, 0.1);
  const double half_m = std::max(length_m / 2.0 - radius_m, 0.05);
  model.Rod({-half_m, 0.0, out_m - radius_m - pitch_m}, {half_m, 0.0, out_m - radius_m + pitch_m}, radius_m, bark);
  const int num_branches = model.Whole(0, 3);
  for (int i = 0; i < num_branches; ++i) {
    const double x_m = model.Between(-0.8, 0.8) * half_m;
    const double y_m = model.Between(-1.0, 1.0);
    model.Rod({x_m, 0.0, 0.0}, {x_m + model.Between(0.1, 0.6), y_m, model.Between(0.1, 1.2)}, 0.03, bark);
  }
  model.Float(length_m, width_m);
}

// Ducks to swans: a body, and a head on a neck.
void MakeWaterBird(const Size& size, Model& model) {
  const double length_m = model.GivenOrDrawn(size.length_m, 0.3, 1.3);
  const Material feathers = model.Paint(size.reflectance);
  model.Add(Ellipsoid{{0.0, 0.0, 0.14 * length_m}, {0.5 * length_m, 0.24 * length_m, 0.2 * length_m}}, feathers);
  const double neck_m = length_m * model.Between(0.35, 0.7);
  model.Chain({{0.4 * length_m, 0.0, 0.2 * length_m}, {0.45 * length_m, 0.0, neck_m}, {0.58 * length_m, 0.0, neck_m}}, 0.06 * length_m, feathers);
  model.Float(length_m, 0.5 * length_m);
}

}  // namespace lookout::sim
