#include <algorithm>
#include <array>
#include <cmath>

#include "common/core/angles.hpp"
#include "lab/sim/fleet.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr Material kSoil{0.35};
constexpr Material kBark{0.25};
constexpr Material kFoliage{0.35, true};

constexpr double kStepM = 2.0;         // between vertices of the waterline
constexpr double kBankWidthM = 2.5;    // from the waterline to the top of the bank
constexpr double kSlopeWidthM = 30.0;  // of the ground behind the waterline
constexpr double kSlopeRise = 0.22;
constexpr double kMaxCrownRadiusM = 2.6;
constexpr int kMinIslandSteps = 12;

// Frame of the object: heading 0, so x is north and y is west.
Vector2d AtBearing(double bearing_rad, double radius_m) { return radius_m * Vector2d(std::cos(bearing_rad), -std::sin(bearing_rad)); }

Vector3d WithHeight(const Vector2d& p_m, double z_m) { return {p_m.x(), p_m.y(), z_m}; }

// Bays and headlands: waves around the circle with random phases.
Waterline MakeWaterline(const config::Scene::Land& land, Random& random) {
  constexpr std::array<int, 4> kWavesPerTurn{2, 5, 11, 29};
  constexpr std::array<double, 4> kShare{0.45, 0.3, 0.17, 0.08};
  std::array<double, 4> phases_rad{};
  for (auto& phase_rad : phases_rad) phase_rad = random.Uniform(0.0, kTwoPi);
  return [=, mean_radius_m = land.mean_radius_m(), roughness_m = land.roughness_m()](double bearing_rad) {
    double radius_m = mean_radius_m;
    for (std::size_t i = 0; i < kShare.size(); ++i) {
      radius_m += roughness_m * kShare[i] * std::sin(kWavesPerTurn[i] * bearing_rad + phases_rad[i]);
    }
    return radius_m;
  };
}

void AddTree(const Vector2d& foot_m, double ground_m, Random& random, std::vector<Part>& parts) {
  const double height_m = random.Uniform(5.0, 12.0);
  const double crown_radius_m = random.Uniform(1.2, kMaxCrownRadiusM);
  const double crown_bottom_m = ground_m + random.Uniform(1.0, 2.5);
  const double crown_half_height_m = (ground_m + height_m - crown_bottom_m) / 2.0;
  parts.push_back({Cylinder{foot_m, random.Uniform(0.1, 0.25), ground_m - 0.5, crown_bottom_m + crown_half_height_m}, kBark});
  parts.push_back(
      {Ellipsoid{WithHeight(foot_m, crown_bottom_m + crown_half_height_m), {crown_radius_m, crown_radius_m, crown_half_height_m}}, kFoliage});
}

// Across the land at one bearing.
struct Profile {
  Vector3d water_m;
  Vector3d bank_m;
};

void AddBank(const Profile& a, const Profile& b, std::vector<Part>& parts) {
  parts.push_back({Triangle{a.water_m, b.water_m, b.bank_m}, kSoil});
  parts.push_back({Triangle{a.water_m, b.bank_m, a.bank_m}, kSoil});
}

}  // namespace

Shore MakeShore(const config::Scene::Land& land, Random& random) {
  Shore shore{SceneObject{0, "", "shore", Track{}, {}, {}}, MakeWaterline(land, random)};
  const double from_rad = DegToRad(land.from_bearing_deg());
  const double width_rad = DegToRad(land.width_deg());
  auto& parts = shore.object.parts;
  auto& outline_m = shore.object.outline_m;

  const int num_steps = static_cast<int>(std::ceil(width_rad * land.mean_radius_m() / kStepM));
  std::vector<Profile> profiles;
  std::vector<Vector3d> slopes_m;  // the upper end of the ground behind each
  for (int step = 0; step <= num_steps; ++step) {
    const double bearing_rad = from_rad + width_rad * step / num_steps;
    const double radius_m = shore.waterline_m(bearing_rad);
    const double bank_height_m = random.Uniform(0.5, 1.3);
    profiles.push_back(
        {WithHeight(AtBearing(bearing_rad, radius_m), 0.0), WithHeight(AtBearing(bearing_rad, radius_m + kBankWidthM), bank_height_m)});
    slopes_m.push_back(WithHeight(AtBearing(bearing_rad, radius_m + kBankWidthM + kSlopeWidthM), bank_height_m + kSlopeRise * kSlopeWidthM));
    outline_m.emplace_back(profiles.back().water_m.head<2>());
  }
  for (std::size_t i = 0; i + 1 < profiles.size(); ++i) {
    AddBank(profiles[i], profiles[i + 1], parts);
    parts.push_back({Triangle{profiles[i].bank_m, profiles[i + 1].bank_m, slopes_m[i + 1]}, kSoil});
    parts.push_back({Triangle{profiles[i].bank_m, slopes_m[i + 1], slopes_m[i]}, kSoil});
  }
  for (int tree = 0; tree < land.num_trees(); ++tree) {
    // Crowns stay over the land and inside of the outline: at least their greatest radius from its ends.
    const double margin_rad = 3.0 / land.mean_radius_m();
    const double at_rad = from_rad + random.Uniform(margin_rad, width_rad - margin_rad);
    const double inland_m = random.Uniform(3.5, 18.0);
    const double ground_m = 0.9 + kSlopeRise * (inland_m > kBankWidthM ? inland_m - kBankWidthM : 0.0);
    AddTree(AtBearing(at_rad, shore.waterline_m(at_rad) + inland_m), ground_m, random, parts);
  }
  for (auto slope_m = slopes_m.rbegin(); slope_m != slopes_m.rend(); ++slope_m) outline_m.emplace_back(slope_m->head<2>());
  return shore;
}

SceneObject MakeIsland(const config::Scene::Land& land, Random& random) {
  SceneObject island{0, "", "island", Track{}, {}, {}};
  const Waterline waterline_m = MakeWaterline(land, random);
  // The bank is narrower on a small island, and the hill no steeper than elsewhere.
  const double bank_width_m = std::min(kBankWidthM, 0.25 * land.mean_radius_m());
  const int num_steps = std::max(kMinIslandSteps, static_cast<int>(std::ceil(kTwoPi * land.mean_radius_m() / kStepM)));
  std::vector<Profile> profiles;
  for (int step = 0; step < num_steps; ++step) {
    // Against the clock seen from above, as outlines run.
    const double bearing_rad = -kTwoPi * step / num_steps;
    const double radius_m = waterline_m(bearing_rad);
    profiles.push_back(
        {WithHeight(AtBearing(bearing_rad, radius_m), 0.0), WithHeight(AtBearing(bearing_rad, radius_m - bank_width_m), random.Uniform(0.5, 1.3))});
    island.outline_m.emplace_back(profiles.back().water_m.head<2>());
  }
  const double plateau_m = land.mean_radius_m() - bank_width_m;
  const Vector3d top_m(0.0, 0.0, 0.9 + kSlopeRise * plateau_m);
  for (std::size_t i = 0; i < profiles.size(); ++i) {
    const auto& a = profiles[i];
    const auto& b = profiles[(i + 1) % profiles.size()];
    AddBank(a, b, island.parts);
    island.parts.push_back({Triangle{a.bank_m, b.bank_m, top_m}, kSoil});
  }
  // Crowns stay inside of the outline, bays or not.
  const double wooded_m = land.mean_radius_m() - land.roughness_m() - kMaxCrownRadiusM;
  for (int tree = 0; tree < land.num_trees() && wooded_m > 0.0; ++tree) {
    const double bearing_rad = random.Uniform(0.0, kTwoPi);
    const double radius_m = wooded_m * std::sqrt(random.Uniform());
    AddTree(AtBearing(bearing_rad, radius_m), 0.9 + kSlopeRise * std::max(0.0, plateau_m - radius_m), random, island.parts);
  }
  return island;
}

}  // namespace lookout::sim
