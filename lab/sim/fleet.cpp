#include "lab/sim/fleet.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "lab/sim/things.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Diffuse reflectance of surfaces near 905 nm, rounded from common tables (gelcoat and paint bright, wet skin and rubber dark).
constexpr double kGelcoat = 0.6;
constexpr double kPaint = 0.5;
constexpr double kConcrete = 0.4;
constexpr double kBrightest = 0.9;
constexpr Material kAluminium{0.5};
constexpr Material kGlassFrame{0.2};
constexpr Material kCloth{0.5};
constexpr Material kWetHair{0.15};
constexpr Material kWood{0.3};

constexpr int kCircleVertices = 24;  // the polygon lies within 1 % of the radius

// Hull seen from above: pointed bow, flat transom, symmetric, convex.
std::vector<Vector2d> HullOutline(double length_m, double width_m) {
  const double x = length_m / 2.0;
  const double y = width_m / 2.0;
  return {{-x, -0.85 * y},     {-0.2 * x, -y},     {0.4 * x, -0.8 * y}, {0.8 * x, -0.35 * y}, {x, 0.0},
          {0.8 * x, 0.35 * y}, {0.4 * x, 0.8 * y}, {-0.2 * x, y},       {-x, 0.85 * y}};
}

// Decks, cabins and gear were measured on boats of the usual size: plans stretch with the hull, heights do not, for people do not either.
struct HullScale {
  double x;
  double y;

  Prism Box(double min_x_m, double max_x_m, double min_y_m, double max_y_m, double bottom_m, double top_m) const {
    return {Rectangle(min_x_m * x, max_x_m * x, min_y_m * y, max_y_m * y), bottom_m, top_m};
  }
  Cylinder Post(double x_m, double y_m, double radius_m, double bottom_m, double top_m) const {
    return {{x_m * x, y_m * y}, radius_m, bottom_m, top_m};
  }
};

void MakeMotorBoat(const Size& size, SceneObject& boat) {
  const HullScale stretch{size.length_m / 6.0, size.width_m / 2.2};
  boat.outline_m = HullOutline(size.length_m, size.width_m);
  boat.parts = {{Prism{boat.outline_m, -0.3, 0.8}, Material{size.reflectance}},
                {stretch.Box(-0.8, 0.6, -0.6, 0.6, 0.8, 1.5), Material{kGelcoat}},  // console
                {stretch.Box(0.5, 0.6, -0.6, 0.6, 1.5, 1.9), kGlassFrame},          // windscreen
                {stretch.Post(-0.9, 0.0, 0.2, 0.8, 1.8), kCloth},                   // helmsman
                {stretch.Box(-3.0, -2.6, -0.25, 0.25, 0.8, 1.2), kGlassFrame}};     // outboard
}

void MakeCabinBoat(const Size& size, SceneObject& boat) {
  const HullScale stretch{size.length_m / 9.0, size.width_m / 3.0};
  boat.outline_m = HullOutline(size.length_m, size.width_m);
  boat.parts = {{Prism{boat.outline_m, -0.5, 1.2}, Material{size.reflectance}},
                {stretch.Box(-2.0, 2.0, -1.1, 1.1, 1.2, 2.1), Material{kGelcoat}},  // cabin
                {stretch.Box(-0.8, 0.9, -0.9, 0.9, 2.1, 3.0), kGlassFrame},         // wheelhouse, windows all round
                {stretch.Box(-0.9, 1.0, -1.0, 1.0, 3.0, 3.1), Material{kGelcoat}},  // its roof
                {stretch.Post(-0.2, 0.0, 0.05, 3.1, 5.0), kAluminium}};             // mast of lights and radar
}

void MakeSailingBoat(const Size& size, SceneObject& boat) {
  const HullScale stretch{size.length_m / 7.0, size.width_m / 2.4};
  boat.outline_m = HullOutline(size.length_m, size.width_m);
  boat.parts = {{Prism{boat.outline_m, -0.3, 0.9}, Material{size.reflectance}},
                {stretch.Box(-0.6, 1.4, -0.7, 0.7, 0.9, 1.35), Material{kGelcoat}},  // cabin
                {stretch.Post(0.9, 0.0, 0.08, 0.9, 10.0), kAluminium},               // mast
                {stretch.Box(-2.4, 0.8, -0.15, 0.15, 1.7, 2.0), kCloth},             // boom with its sail down
                {stretch.Post(-2.2, 0.5, 0.2, 0.9, 1.8), kCloth}};                   // helmsman
}

void MakeKayak(const Size& size, SceneObject& boat) {
  const double x = size.length_m / 2.0;
  const double y = size.width_m / 2.0;
  const double shoulder_x = 1.2 * (size.length_m / 4.5);
  const double shoulder_y = 0.22 * (size.width_m / 0.6);
  boat.outline_m = {{-x, 0.0}, {-shoulder_x, -shoulder_y}, {0.0, -y}, {shoulder_x, -shoulder_y},
                    {x, 0.0},  {shoulder_x, shoulder_y},   {0.0, y},  {-shoulder_x, shoulder_y}};
  boat.parts = {{Prism{boat.outline_m, -0.1, 0.3}, Material{size.reflectance}}, {Ellipsoid{{-0.1, 0.0, 0.65}, {0.17, 0.25, 0.45}}, kCloth}};
}

void MakeSwimmer(const Size& size, SceneObject& swimmer) {
  const double radius_m = size.width_m / 2.0;
  swimmer.outline_m = Circle(Vector2d::Zero(), radius_m, kCircleVertices);
  swimmer.parts = {{Ellipsoid{{0.0, 0.0, 0.12}, Vector3d(radius_m, radius_m, 0.15)}, kWetHair}};
}

void MakeBuoy(const Size& size, SceneObject& buoy) {
  buoy.outline_m = Circle(Vector2d::Zero(), size.width_m / 2.0, kCircleVertices);
  buoy.parts = {{Cylinder{Vector2d::Zero(), size.width_m / 2.0, -0.2, size.height_m}, Material{size.reflectance}}};
}

// A pile; its board, as wide as the object, is the upper quarter of it.
void MakeMarker(const Size& size, SceneObject& marker) {
  constexpr double kPileRadiusM = 0.1;
  constexpr double kHalfBoardThicknessM = 0.12;  // boards on two sides of the pile
  const double half_m = size.width_m / 2.0;
  marker.outline_m = Rectangle(-kHalfBoardThicknessM, kHalfBoardThicknessM, -half_m, half_m);
  marker.parts = {{Cylinder{Vector2d::Zero(), kPileRadiusM, -0.5, 0.75 * size.height_m}, kWood},
                  {Prism{marker.outline_m, 0.75 * size.height_m, size.height_m}, Material{size.reflectance}}};
}

// Planks on piles. The origin is the middle of its landward end, x runs out along it.
void MakeDock(const Size& size, SceneObject& dock) {
  constexpr double kPileRadiusM = 0.12;
  constexpr double kPileDistanceM = 4.0;
  dock.outline_m = Rectangle(0.0, size.length_m, -size.width_m / 2.0, size.width_m / 2.0);
  dock.parts.push_back({Prism{dock.outline_m, 0.5, 0.75}, kWood});
  for (double x_m = size.length_m - kPileRadiusM; x_m > 0.0; x_m -= kPileDistanceM) {
    for (const double side : {-1.0, 1.0}) {
      dock.parts.push_back({Cylinder{{x_m, side * (size.width_m / 2.0 - kPileRadiusM)}, kPileRadiusM, -0.5, 1.6}, kWood});
    }
  }
}

// Massive, down to the ground, with bollards. The origin as of a dock.
void MakePier(const Size& size, SceneObject& pier) {
  constexpr double kBollardRadiusM = 0.15;
  constexpr double kBollardDistanceM = 6.0;
  pier.outline_m = Rectangle(0.0, size.length_m, -size.width_m / 2.0, size.width_m / 2.0);
  pier.parts.push_back({Prism{pier.outline_m, -1.0, size.height_m}, Material{size.reflectance}});
  for (double x_m = size.length_m - 1.0; x_m > 0.0; x_m -= kBollardDistanceM) {
    for (const double side : {-1.0, 1.0}) {
      pier.parts.push_back(
          {Cylinder{{x_m, side * (size.width_m / 2.0 - 2.0 * kBollardRadiusM)}, kBollardRadiusM, size.height_m, size.height_m + 0.5}, kAluminium});
    }
  }
}

// The origin is its middle.
void MakeWall(const Size& size, SceneObject& wall) {
  wall.outline_m = Rectangle(-size.length_m / 2.0, size.length_m / 2.0, -size.width_m / 2.0, size.width_m / 2.0);
  wall.parts = {{Prism{wall.outline_m, -1.0, size.height_m}, Material{size.reflectance}}};
}

constexpr std::array<std::string_view, 20> kAnyCraft{
    "open_boat", "open_boat", "open_boat", "cruiser",      "cruiser",    "sailing_dinghy", "sailing_dinghy", "yacht",        "yacht",   "twin_hull",
    "twin_hull", "canoe",     "canoe",     "paddle_board", "pedal_boat", "raft",           "workboat",       "rowing_shell", "jet_ski", "robot_boat"};
constexpr std::array<std::string_view, 6> kAnyBuoy{"navigation_buoy", "navigation_buoy", "float", "float", "race_mark", "stake"};
constexpr std::array<std::string_view, 3> kAnyDock{"jetty", "pontoon", "dock_bays"};

constexpr std::array<KindOfObject, 40> kKinds{{
    {"motor_boat", {6.0, 2.2, 0.0, kGelcoat}, true, true, MakeMotorBoat},
    {"cabin_boat", {9.0, 3.0, 0.0, kGelcoat}, true, true, MakeCabinBoat},
    {"sailing_boat", {7.0, 2.4, 0.0, kGelcoat}, true, true, MakeSailingBoat},
    {"kayak", {4.5, 0.6, 0.0, kGelcoat}, true, true, MakeKayak},
    {"swimmer", {0.0, 0.2, 0.0, 0.0}, true, true, MakeSwimmer},
    {"buoy", {0.0, 0.6, 1.0, kPaint}, true, true, MakeBuoy},
    {"marker", {0.0, 0.6, 2.4, kPaint}, true, false, MakeMarker},
    {"dock", {9.0, 2.0, 0.0, 0.0}, false, false, MakeDock},
    {"pier", {30.0, 3.0, 1.2, kConcrete}, false, false, MakePier},
    {"wall", {50.0, 0.5, 1.5, kConcrete}, false, false, MakeWall},
    {"open_boat", {6.5, 2.3, 0.0, kBrightest}, true, true, nullptr, MakeOpenBoat},
    {"cruiser", {16.0, 5.5, 0.0, kBrightest}, true, true, nullptr, MakeCruiser},
    {"sailing_dinghy", {6.0, 2.3, 0.0, kBrightest}, true, true, nullptr, MakeSailingDinghy},
    {"yacht", {16.0, 5.2, 0.0, kBrightest}, true, true, nullptr, MakeYacht},
    {"twin_hull", {15.0, 9.0, 0.0, kBrightest}, true, true, nullptr, MakeTwinHull},
    {"raft", {6.0, 5.7, 0.0, kBrightest}, true, true, nullptr, MakeRaft},
    {"canoe", {6.5, 1.0, 0.0, kBrightest}, true, true, nullptr, MakeCanoe},
    {"paddle_board", {4.2, 0.9, 0.0, kBrightest}, true, true, nullptr, MakePaddleBoard},
    {"pedal_boat", {4.2, 2.0, 0.0, kBrightest}, true, true, nullptr, MakePedalBoat},
    {"barge", {40.0, 5.8, 0.0, kBrightest}, true, true, nullptr, MakeBarge},
    {"workboat", {20.0, 6.7, 0.0, kBrightest}, true, true, nullptr, MakeWorkboat},
    {"jetty", {35.0, 3.5, 0.0, 0.0}, false, false, nullptr, MakeJetty},
    {"pontoon", {35.0, 3.5, 0.0, 0.0}, false, false, nullptr, MakePontoon},
    {"dock_bays", {9.0, 27.0, 0.0, 0.0}, false, false, nullptr, MakeDockBays},
    {"navigation_buoy", {0.0, 3.0, 5.0, kBrightest}, true, true, nullptr, MakeNavigationBuoy},
    {"float", {0.0, 0.8, 0.72, kBrightest}, true, true, nullptr, MakeFloat},
    {"race_mark", {0.0, 1.6, 2.2, kBrightest}, true, true, nullptr, MakeRaceMark},
    {"stake", {0.0, 0.4, 4.5, kBrightest}, true, false, nullptr, MakeStake},
    {"fish_farm", {0.0, 16.0, 0.0, kBrightest}, true, true, nullptr, MakeFishFarm},
    {"bather", {0.0, 0.26, 0.0, kBrightest}, true, true, nullptr, MakeBather},
    {"log", {8.0, 0.6, 0.0, kBrightest}, true, true, nullptr, MakeLog},
    {"water_bird", {1.3, 0.0, 0.0, kBrightest}, true, true, nullptr, MakeWaterBird},
    {"rowing_shell", {18.5, 0.65, 0.0, kBrightest}, true, true, nullptr, MakeRowingShell},
    {"houseboat", {18.0, 4.8, 0.0, kBrightest}, true, true, nullptr, MakeHouseboat},
    {"jet_ski", {3.6, 1.25, 0.0, kBrightest}, true, true, nullptr, MakeJetSki},
    {"windsurfer", {3.6, 1.0, 0.0, kBrightest}, true, true, nullptr, MakeWindsurfer},
    {"robot_boat", {4.0, 2.4, 0.0, kBrightest}, true, true, nullptr, MakeRobotBoat},
    {"any_craft", {}, true, true, nullptr, nullptr, kAnyCraft},
    {"any_buoy", {}, true, true, nullptr, nullptr, kAnyBuoy},
    {"any_dock", {}, false, false, nullptr, nullptr, kAnyDock},
}};

}  // namespace

std::span<const KindOfObject> Kinds() { return kKinds; }

SceneObject MakeObject(const KindOfObject& kind, const Size& size, Random& random) {
  if (!kind.one_of.empty()) {
    const auto chosen = static_cast<std::size_t>(random.Uniform() * static_cast<double>(kind.one_of.size()));
    return MakeObject(*std::ranges::find(Kinds(), kind.one_of[chosen], &KindOfObject::name), {}, random);
  }
  SceneObject object{0, "", std::string(kind.name), Track{}, {}, {}};
  object.is_in_water = kind.is_in_water;
  if (kind.draw != nullptr) {
    Model model(object, random);
    kind.draw(size, model);
    if (object.outline_m.empty()) model.OutlineAllParts();
    return object;
  }
  kind.make(size, object);
  // An object without a length is round.
  if (kind.is_afloat) object.waterline_m = {size.length_m > 0.0 ? size.length_m : size.width_m, size.width_m};
  return object;
}

}  // namespace lookout::sim
