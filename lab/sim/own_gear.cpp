#include <algorithm>
#include <cmath>

#include "lab/sim/model.hpp"
#include "lab/sim/scene.hpp"

namespace lookout::sim {
namespace {

constexpr std::uint64_t kGearStream = 25;

}  // namespace

void AddCrewAndGear(const Effects& effects, const Eigen::AlignedBox3d& box_m, std::uint64_t seed, SceneObject& hull) {
  Random random(seed, kGearStream);
  Model model(hull, random);
  const int num_crew = static_cast<int>(effects.own_crew() + random.Uniform());
  const int num_gear = static_cast<int>(effects.own_gear() + random.Uniform());
  for (int i = 0; i < num_crew; ++i) {
    // At the stern, some half outside of the box.
    const double x_m = box_m.min().x() + model.Between(-0.3, 0.4);
    const double y_m = model.Between(0.8 * box_m.min().y(), 0.8 * box_m.max().y());
    model.Person({x_m, y_m, 0.0}, {1.0, 0.0}, model.Chance(0.5) ? Model::Posture::kStanding : Model::Posture::kSitting);
  }
  for (int i = 0; i < num_gear; ++i) {
    // Aerials, flag staffs, rods and fenders at the edge of the deck.
    const bool is_aft = model.Chance(0.6);
    const double x_m = is_aft ? box_m.min().x() + model.Between(-0.4, 0.3) : model.Between(box_m.min().x(), box_m.max().x());
    const double side = model.Chance(0.5) ? 1.0 : -1.0;
    const double y_m = is_aft ? model.Between(box_m.min().y(), box_m.max().y()) : side * (box_m.max().y() + model.Between(-0.2, 0.2));
    const double top_m = model.Between(0.3, 2.5);
    const double lean_m = model.Between(-0.4, 0.1) * top_m;
    model.Rod({x_m, y_m, -0.1}, {x_m + lean_m, y_m, top_m}, model.Between(0.008, 0.06), model.Paint());
  }
}

}  // namespace lookout::sim
