#include "tools/sim/fleet.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Diffuse reflectance of surfaces near 905 nm, rounded from common tables (gelcoat and paint bright, wet skin and rubber dark).
constexpr Material kGelcoat{0.6};
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

}  // namespace

SceneObject MakeMotorBoat(const std::string& name, const Track& track) {
  SceneObject boat{0, name, "motor_boat", track, {}, HullOutline(6.0, 2.2)};
  boat.parts = {{Prism{boat.outline_m, -0.3, 0.8}, kGelcoat},
                {Prism{Rectangle(-0.8, 0.6, -0.6, 0.6), 0.8, 1.5}, kGelcoat},         // console
                {Prism{Rectangle(0.5, 0.6, -0.6, 0.6), 1.5, 1.9}, kGlassFrame},       // windscreen
                {Cylinder{{-0.9, 0.0}, 0.2, 0.8, 1.8}, kCloth},                       // helmsman
                {Prism{Rectangle(-3.0, -2.6, -0.25, 0.25), 0.8, 1.2}, kGlassFrame}};  // outboard
  return boat;
}

SceneObject MakeSailingBoat(const std::string& name, const Track& track) {
  SceneObject boat{0, name, "sailing_boat", track, {}, HullOutline(7.0, 2.4)};
  boat.parts = {{Prism{boat.outline_m, -0.3, 0.9}, kGelcoat},
                {Prism{Rectangle(-0.6, 1.4, -0.7, 0.7), 0.9, 1.35}, kGelcoat},  // cabin
                {Cylinder{{0.9, 0.0}, 0.08, 0.9, 10.0}, kAluminium},            // mast
                {Prism{Rectangle(-2.4, 0.8, -0.15, 0.15), 1.7, 2.0}, kCloth},   // boom
                {Cylinder{{-2.2, 0.5}, 0.2, 0.9, 1.8}, kCloth}};                // helmsman
  return boat;
}

SceneObject MakeKayak(const std::string& name, const Track& track) {
  SceneObject boat{0,     name, "kayak",
                   track, {},   {{-2.25, 0.0}, {-1.2, -0.22}, {0.0, -0.3}, {1.2, -0.22}, {2.25, 0.0}, {1.2, 0.22}, {0.0, 0.3}, {-1.2, 0.22}}};
  boat.parts = {{Prism{boat.outline_m, -0.1, 0.3}, kGelcoat}, {Ellipsoid{{-0.1, 0.0, 0.65}, {0.17, 0.25, 0.45}}, kCloth}};
  return boat;
}

SceneObject MakeSwimmer(const std::string& name, const Track& track) {
  constexpr double kHeadRadiusM = 0.1;
  SceneObject swimmer{0, name, "swimmer", track, {}, Circle(Vector2d::Zero(), kHeadRadiusM, kCircleVertices)};
  swimmer.parts = {{Ellipsoid{{0.0, 0.0, 0.12}, Vector3d(kHeadRadiusM, kHeadRadiusM, 0.15)}, kWetHair}};
  return swimmer;
}

SceneObject MakeBuoy(const std::string& name, const Vector2d& position_map_m, double radius_m, double height_m, double reflectance) {
  SceneObject buoy{0, name, "buoy", Track{{position_map_m, 0.0}}, {}, Circle(Vector2d::Zero(), radius_m, kCircleVertices)};
  buoy.parts = {{Cylinder{Vector2d::Zero(), radius_m, -0.2, height_m}, Material{reflectance}}};
  return buoy;
}

SceneObject MakeDock(const std::string& name, const Placement& placement, double length_m, double width_m) {
  SceneObject dock{0, name, "dock", Track{placement}, {}, Rectangle(0.0, length_m, -width_m / 2.0, width_m / 2.0)};
  dock.parts.push_back({Prism{dock.outline_m, 0.5, 0.75}, kWood});
  constexpr double kPileRadiusM = 0.12;
  constexpr double kPileDistanceM = 4.0;
  for (double x_m = length_m - kPileRadiusM; x_m > 0.0; x_m -= kPileDistanceM) {
    for (const double side : {-1.0, 1.0}) {
      dock.parts.push_back({Cylinder{{x_m, side * (width_m / 2.0 - kPileRadiusM)}, kPileRadiusM, -0.5, 1.6}, kWood});
    }
  }
  return dock;
}

}  // namespace lookout::sim
