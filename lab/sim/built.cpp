#include "lab/sim/built.hpp"

#include <algorithm>

namespace lookout::sim {
namespace {

constexpr Material kPlank{0.3};
constexpr Material kPierConcrete{0.4};
constexpr double kPileFootM = -1.0;  // below the water

void AddRailing(double length_m, double y_m, double deck_m, Random& random, std::vector<Part>& parts) {
  const double height_m = deck_m + random.Uniform(0.9, 1.2);
  const double spacing_m = random.Uniform(1.5, 3.0);
  for (double x_m = 0.1; x_m < length_m; x_m += spacing_m) parts.push_back({Cylinder{{x_m, y_m}, 0.04, deck_m, height_m}, kPlank});
  for (const double rail_m : {0.5, 1.0}) {
    const double top_m = deck_m + rail_m * (height_m - deck_m);
    parts.push_back({Prism{Rectangle(0.0, length_m, y_m - 0.03, y_m + 0.03), top_m - 0.08, top_m}, kPlank});
  }
}

}  // namespace

SceneObject MakePilePier(const Size& size, Random& random) {
  SceneObject pier{0, "", "pier", Track{}, {}, {}};
  const double deck_m = size.height_m > 0.0 ? size.height_m : random.Uniform(1.0, 4.0);
  const Material material{size.reflectance > 0.0 ? size.reflectance : random.Uniform(0.15, 0.4)};
  const double half_m = size.width_m / 2.0;
  pier.outline_m = Rectangle(0.0, size.length_m, -half_m, half_m);
  const double thickness_m = random.Uniform(0.15, 0.6);
  pier.parts.push_back({Prism{pier.outline_m, deck_m - thickness_m, deck_m}, material});
  const double bent_spacing_m = random.Uniform(3.0, 8.0);
  const double pile_radius_m = random.Uniform(0.1, 0.3);
  const int num_piles = std::max(2, static_cast<int>(size.width_m / random.Uniform(2.0, 4.0)) + 1);
  const bool has_beams = random.Uniform() < 0.5;
  const bool has_braces = random.Uniform() < 0.3;
  const double pile_top_m = random.Uniform() < 0.3 ? deck_m + random.Uniform(0.3, 1.2) : deck_m - thickness_m;
  for (double x_m = size.length_m - pile_radius_m; x_m > 0.0; x_m -= bent_spacing_m) {
    for (int pile = 0; pile < num_piles; ++pile) {
      const double y_m = (half_m - pile_radius_m) * (2.0 * pile / (num_piles - 1) - 1.0);
      pier.parts.push_back({Cylinder{{x_m, y_m}, pile_radius_m, kPileFootM, pile_top_m}, material});
    }
    const auto beam = Rectangle(std::max(0.0, x_m - 0.15), x_m + pile_radius_m, -half_m, half_m);
    if (has_beams) pier.parts.push_back({Prism{beam, deck_m - thickness_m - 0.3, deck_m - thickness_m}, material});
    if (has_braces) pier.parts.push_back({Prism{beam, 0.3, 0.5}, material});
  }
  if (random.Uniform() < 0.5) {
    for (const double side : {-1.0, 1.0}) AddRailing(size.length_m, side * (half_m - 0.05), deck_m, random, pier.parts);
  }
  const int num_people = static_cast<int>(random.Uniform(0.0, 4.0));
  for (int person = 0; person < num_people; ++person) {
    const double x_m = random.Uniform(0.0, size.length_m);
    pier.parts.push_back({Cylinder{{x_m, random.Uniform(-0.6, 0.6) * half_m}, 0.22, deck_m, deck_m + random.Uniform(1.2, 1.9)}, Material{0.4}});
  }
  return pier;
}

SceneObject MakeBridge(const Size& size, Random& random) {
  SceneObject bridge{0, "", "bridge", Track{}, {}, {}};
  const double deck_m = size.height_m > 0.0 ? size.height_m : random.Uniform(3.0, 7.0);
  const double half_m = size.width_m / 2.0;
  bridge.outline_m = Rectangle(0.0, size.length_m, -half_m, half_m);
  const Material material{size.reflectance > 0.0 ? size.reflectance : 0.4};
  bridge.parts.push_back({Prism{bridge.outline_m, deck_m - random.Uniform(0.4, 1.0), deck_m}, material});
  for (const double side : {-1.0, 1.0}) {
    const double y_m = side * (half_m - 0.1);
    bridge.parts.push_back({Prism{Rectangle(0.0, size.length_m, y_m - 0.1, y_m + 0.1), deck_m, deck_m + 1.0}, kPierConcrete});
  }
  const double span_m = random.Uniform(8.0, 25.0);
  const double pier_m = random.Uniform(0.3, 0.8);
  for (double x_m = random.Uniform(0.3, 1.0) * span_m; x_m < size.length_m; x_m += span_m) {
    bridge.parts.push_back({Prism{Rectangle(x_m - pier_m, x_m + pier_m, -0.8 * half_m, 0.8 * half_m), kPileFootM, deck_m}, kPierConcrete});
  }
  return bridge;
}

void ProlongToLand(double by_m, SceneObject& dock) {
  Part root = dock.parts.front();
  for (auto& p_m : std::get<Prism>(root.solid).footprint_m) p_m.x() = p_m.x() > 0.0 ? 0.0 : -by_m;
  dock.parts.push_back(std::move(root));
  for (auto& p_m : dock.outline_m) {
    if (p_m.x() <= 0.0) p_m.x() = -by_m;
  }
}

}  // namespace lookout::sim
