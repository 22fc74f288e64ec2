#include "tools/sim/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/core/angles.hpp"
#include "tools/sim/fleet.hpp"
#include "tools/sim/random.hpp"
#include "tools/sim/shore.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;

constexpr std::uint64_t kSceneStream = 1;

constexpr double kBlackRubber = 0.03;
constexpr double kPaint = 0.5;

Vector2d AtBearing(double bearing_rad, double radius_m) { return radius_m * Vector2d(std::sin(bearing_rad), std::cos(bearing_rad)); }

/// Round a circle, starting at a bearing from its centre.
Track CircleTrack(const Vector2d& center_m, double radius_m, double bearing_deg, double speed_mps, bool is_clockwise) {
  const double bearing_rad = DegToRad(bearing_deg);
  const double side = is_clockwise ? 1.0 : -1.0;
  return {{center_m + AtBearing(bearing_rad, radius_m), WrapTo2Pi(bearing_rad + side * kPi / 2.0)}, speed_mps, side * speed_mps / radius_m};
}

// Two waves each of roll, pitch and heave, as a light boat of some 2.5 m has them in a small chop: periods of 2 to 6 s.
void AddWaves(OwnMotion& motion, Random& random) {
  const auto wave = [&random](double amplitude, double low_s, double high_s) {
    const double period_s = random.Uniform(low_s, high_s);
    return Wave{amplitude, period_s, random.Uniform(0.0, kTwoPi)};
  };
  motion.roll_rad = {wave(DegToRad(2.0), 2.5, 3.5), wave(DegToRad(0.8), 1.8, 2.4)};
  motion.pitch_rad = {wave(DegToRad(1.2), 2.8, 4.0), wave(DegToRad(0.5), 2.0, 2.6)};
  motion.heave_m = {wave(0.04, 2.5, 4.0), wave(0.02, 1.8, 2.4)};
  motion.leeway_rad = {wave(DegToRad(3.0), 7.0, 12.0)};
}

Scene MakeLake(Random& random) {
  Scene scene;
  // Perimeter 184 m in 74 s: 2.0 to 2.9 m/s.
  scene.own_motion = {.semi_axes_m = {34.0, 24.0}, .period_s = 74.0, .start_rad = DegToRad(-30.0)};
  AddWaves(scene.own_motion, random);
  // Open to the south, from bearing 120 to 260 deg.
  const Shore shore = MakeShore("shore", {DegToRad(260.0), DegToRad(220.0), 82.0, 9.0, 260}, random);
  const double dock_bearing_rad = DegToRad(40.0);
  const Placement dock_end{AtBearing(dock_bearing_rad, shore.waterline_m(dock_bearing_rad) + 1.0), dock_bearing_rad + kPi};
  scene.objects = {shore.object,
                   MakeDock("dock", dock_end, 9.0, 2.0),
                   MakeMotorBoat("motor_boat", CircleTrack({0.0, 0.0}, 50.0, 95.0, 4.0, true)),
                   MakeSailingBoat("sailing_boat", CircleTrack({-4.0, 0.0}, 8.0, 200.0, 1.2, true)),
                   MakeKayak("kayak", CircleTrack({0.0, 0.0}, 57.0, 60.0, 1.3, false)),
                   MakeSwimmer("swimmer", CircleTrack({26.0, -24.0}, 2.0, 0.0, 0.4, true)),
                   MakeBuoy("buoy_red", {22.0, 34.0}, 0.4, 1.3, kPaint),
                   MakeBuoy("buoy_yellow", {3.0, 34.0}, 0.3, 1.0, kPaint),
                   MakeBuoy("buoy_small", {41.0, -12.0}, 0.15, 0.5, kPaint),
                   MakeBuoy("buoy_black", {44.0, 4.0}, 0.25, 0.6, kBlackRubber),
                   MakeBuoy("buoy_spar", {43.0, 14.0}, 0.08, 0.9, kBlackRubber)};
  return scene;
}

Scene MakeMarina(Random& random) {
  Scene scene;
  // 0.7 to 2.0 m/s.
  scene.own_motion = {.semi_axes_m = {22.0, 8.0}, .period_s = 70.0, .start_rad = DegToRad(-60.0)};
  AddWaves(scene.own_motion, random);
  // Two piers, boats moored bow to them, a metre apart.
  constexpr int kBoatsPerPier = 12;
  constexpr double kPierDistanceM = 28.0;
  constexpr double kBerthWidthM = 3.4;
  for (const double side : {1.0, -1.0}) {
    const std::string pier = side > 0.0 ? "north" : "south";
    const double heading_rad = side > 0.0 ? 0.0 : kPi;
    scene.objects.push_back(MakeDock("pier_" + pier, {{-22.0, side * kPierDistanceM}, kPi / 2.0}, 44.0, 2.0));
    for (int berth = 0; berth < kBoatsPerPier; ++berth) {
      const double east_m = (berth - (kBoatsPerPier - 1) / 2.0) * kBerthWidthM;
      const std::string name = pier + "_" + std::to_string(berth + 1);
      const bool is_sailing = berth % 3 == 1;
      // From the middle of the boat to the near edge of the pier: half its length and half a metre of line.
      const double north_m = side * (kPierDistanceM - 1.0 - (is_sailing ? 3.5 : 3.0) - 0.5);
      const Track track{{{east_m, north_m}, heading_rad}};
      scene.objects.push_back(is_sailing ? MakeSailingBoat(name, track) : MakeMotorBoat(name, track));
    }
  }
  scene.objects.push_back(MakeKayak("kayak", CircleTrack({34.0, 0.0}, 6.0, 0.0, 1.0, true)));
  scene.objects.push_back(MakeBuoy("buoy_entrance", {40.0, 14.0}, 0.3, 1.0, kPaint));
  return scene;
}

Scene MakeOpenWater(Random& random) {
  Scene scene;
  // 1.6 to 2.4 m/s.
  scene.own_motion = {.semi_axes_m = {24.0, 16.0}, .period_s = 63.0};
  AddWaves(scene.own_motion, random);
  scene.objects = {MakeBuoy("buoy_north", {0.0, 40.0}, 0.5, 1.8, kPaint), MakeBuoy("buoy_east", {50.0, -10.0}, 0.5, 1.8, kPaint),
                   MakeBuoy("buoy_south_west", {-35.0, -32.0}, 0.5, 1.8, kPaint)};
  return scene;
}

using Maker = Scene (*)(Random&);
constexpr std::array<std::pair<std::string_view, Maker>, 3> kMakers{{{"lake", MakeLake}, {"marina", MakeMarina}, {"open_water", MakeOpenWater}}};

}  // namespace

std::vector<std::string_view> SceneNames() {
  std::vector<std::string_view> names;
  names.reserve(kMakers.size());
  for (const auto& [name, maker] : kMakers) names.push_back(name);
  return names;
}

std::optional<Scene> MakeScene(std::string_view name, std::uint64_t seed) {
  const auto found = std::ranges::find(kMakers, name, &std::pair<std::string_view, Maker>::first);
  if (found == kMakers.end()) return std::nullopt;
  Random random(seed, kSceneStream);
  Scene scene = found->second(random);
  int id = 0;
  for (auto& object : scene.objects) object.id = ++id;
  return scene;
}

std::vector<Part> MakeOwnHull(const Eigen::AlignedBox3d& box_m, double lidar_height_m, const Eigen::Vector3d& p_vessel_antenna_m) {
  constexpr Material kPaintedDeck{0.4};
  constexpr double kMarginM = 0.2;  // as the boxes in config/ are larger than the hulls
  constexpr double kMotorBelowLidarM = 0.15;
  constexpr double kPostRadiusM = 0.03;
  const double stern_m = box_m.min().x() + kMarginM;
  const double top_m = std::min(lidar_height_m - kMotorBelowLidarM, box_m.max().z() - kMarginM);
  std::vector<Part> parts{
      {Prism{Rectangle(stern_m, box_m.max().x() - kMarginM, box_m.min().y() + kMarginM, box_m.max().y() - kMarginM), -0.3, 0.0}, kPaintedDeck},
      {Prism{Rectangle(stern_m, stern_m + 0.2, -0.25, 0.25), 0.0, top_m}, kPaintedDeck}};
  if (box_m.contains(p_vessel_antenna_m)) {
    parts.push_back({Cylinder{p_vessel_antenna_m.head<2>(), kPostRadiusM, 0.0, p_vessel_antenna_m.z()}, kPaintedDeck});
  }
  return parts;
}

}  // namespace lookout::sim
