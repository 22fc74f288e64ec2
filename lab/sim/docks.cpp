#include <algorithm>
#include <cmath>

#include "lab/sim/things.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

struct Deck {
  double min_x_m;
  double max_x_m;
  double min_y_m;
  double max_y_m;

  bool runs_along_x() const { return max_x_m - min_x_m >= max_y_m - min_y_m; }
  Vector3d At(double x_share, double y_share, double z_m) const {
    return {min_x_m + x_share * (max_x_m - min_x_m), min_y_m + y_share * (max_y_m - min_y_m), z_m};
  }
};

// How the decks of one dock are built.
struct Build {
  double top_m;
  double thickness_m;
  bool is_floating;
  double pile_spacing_m;
  double pile_radius_m;
  double pile_over_deck_m;  // how far piles stand out of the deck; negative = they end under it
  double rail_probability;
  Material deck;
  Material pile;
};

Build DrawBuild(bool is_floating, Model& model) {
  Build build{};
  build.is_floating = is_floating;
  build.top_m = is_floating ? model.Between(0.1, 0.6) : model.Between(0.4, 1.5);
  build.thickness_m = is_floating ? build.top_m + 0.2 : std::min(model.Between(0.1, 0.4), build.top_m - 0.15);
  build.pile_spacing_m = is_floating ? model.Between(5.0, 15.0) : model.Between(1.5, 6.0);
  build.pile_radius_m = model.Between(0.06, 0.2);
  const double tall_probability = is_floating ? 1.0 : 0.5;
  const double stands_out_m = model.Between(0.2, is_floating ? 2.0 : 1.2);
  build.pile_over_deck_m = model.Chance(tall_probability) ? stands_out_m : -0.05;
  build.rail_probability = model.Chance(0.4) ? 0.7 : 0.0;
  build.deck = model.Wood();
  build.pile = model.Paint();
  return build;
}

void AddDeck(const Deck& deck, const Build& build, Model& model) {
  model.Box(deck.min_x_m, deck.max_x_m, deck.min_y_m, deck.max_y_m, build.top_m - build.thickness_m, build.top_m, build.deck);
  const bool along_x = deck.runs_along_x();
  const double length_m = along_x ? deck.max_x_m - deck.min_x_m : deck.max_y_m - deck.min_y_m;
  const double width_m = along_x ? deck.max_y_m - deck.min_y_m : deck.max_x_m - deck.min_x_m;
  // Piles stand in pairs; floating docks have piles on one side, where these hold the dock.
  const int num_gaps = std::max(1, static_cast<int>(std::floor((length_m - 0.5) / build.pile_spacing_m)));
  const double in_share = std::min(build.pile_radius_m / width_m, 0.45);
  for (int i = 0; i <= num_gaps; ++i) {
    const double at = 0.03 + 0.94 * i / num_gaps;
    for (const double side : {in_share, 1.0 - in_share}) {
      if (build.is_floating && side > 0.5) continue;
      const Vector3d foot_m = along_x ? deck.At(at, side, 0.0) : deck.At(side, at, 0.0);
      model.Post(foot_m.x(), foot_m.y(), build.pile_radius_m, -0.5, build.top_m + build.pile_over_deck_m, build.pile);
    }
  }
  for (const double side : {0.03, 0.97}) {
    if (!model.Chance(build.rail_probability)) continue;
    const Vector3d from_m = along_x ? deck.At(0.02, side, build.top_m) : deck.At(side, 0.02, build.top_m);
    const Vector3d to_m = along_x ? deck.At(0.98, side, build.top_m) : deck.At(side, 0.98, build.top_m);
    model.Railing(from_m, to_m, model.Between(0.8, 1.1), 2.0, 2, 0.025, build.pile);
  }
}

// Lamp posts, boxes, people, bollards, a ladder, tyres: what stands on a deck and hangs from it.
void AddFurniture(const Deck& deck, const Build& build, double share, Model& model) {
  const double area_m2 = (deck.max_x_m - deck.min_x_m) * (deck.max_y_m - deck.min_y_m);
  const auto anywhere = [&] {
    const double x = model.Between(0.08, 0.95);
    return deck.At(x, model.Between(0.2, 0.8), build.top_m);
  };
  const int most = std::clamp(static_cast<int>(area_m2 / 8.0), 1, 5);
  const int num_boxes = model.Chance(share) ? model.Whole(0, most) : 0;
  for (int i = 0; i < num_boxes; ++i) {
    const Vector3d at_m = anywhere();
    const double half_m = model.Between(0.15, 0.35);
    model.Box(at_m.x() - half_m, at_m.x() + half_m, at_m.y() - half_m, at_m.y() + half_m, build.top_m, build.top_m + model.Between(0.3, 1.2),
              model.Paint());
  }
  const int num_people = model.Chance(share) ? model.Whole(0, most) : 0;
  for (int i = 0; i < num_people; ++i) {
    const Vector3d at_m = anywhere();
    const double facing = model.Chance(0.5) ? 1.0 : -1.0;
    model.Person(at_m, {0.0, facing}, model.Chance(0.75) ? Model::Posture::kStanding : Model::Posture::kSitting);
  }
  if (model.Chance(0.3 * share)) {
    const Vector3d at_m = anywhere();
    const double lamp_m = build.top_m + model.Between(2.5, 5.0);
    const Material metal = model.Metal();
    model.Post(at_m.x(), at_m.y(), 0.05, build.top_m, lamp_m, metal);
    model.Add(Ellipsoid{{at_m.x(), at_m.y(), lamp_m}, {0.2, 0.2, 0.15}}, metal);
  }
  if (model.Chance(0.3 * share)) {  // a ladder over the edge
    const Vector3d at_m = deck.At(model.Between(0.3, 0.95), 0.0, build.top_m);
    const Material metal = model.Metal();
    for (const double x_m : {at_m.x(), at_m.x() + 0.45})
      model.Rod({x_m, at_m.y() - 0.05, -0.3}, {x_m, at_m.y() - 0.05, build.top_m + 0.7}, 0.025, metal);
  }
  if (model.Chance(0.3 * share)) {  // fenders
    const int num_fenders = model.Whole(2, 6);
    const Material rubber{model.Paint(0.03)};
    for (int i = 0; i < num_fenders; ++i) {
      const Vector3d at_m = deck.At((i + 0.5) / num_fenders, 1.0, 0.0);
      model.Rod({at_m.x(), at_m.y() + 0.08, 0.1}, {at_m.x(), at_m.y() + 0.08, std::max(build.top_m, 0.3)}, 0.12, rubber);
    }
  }
}

void OutlineOfDeck(const Deck& deck, SceneObject& dock) { dock.outline_m = Rectangle(deck.min_x_m, deck.max_x_m, deck.min_y_m, deck.max_y_m); }

// A main deck from the shore and a head or fingers on it. The outline goes round all of them.
//
// @param teeth  decks that touch the main one at the side y > 0 (first) or y < 0, in order of x, not overlapping
void OutlineOfComb(const Deck& main, const std::vector<Deck>& port_teeth, const std::vector<Deck>& starboard_teeth, SceneObject& dock) {
  auto& outline_m = dock.outline_m;
  outline_m.emplace_back(main.min_x_m, main.min_y_m);
  for (const Deck& tooth : starboard_teeth) {
    outline_m.emplace_back(tooth.min_x_m, main.min_y_m);
    outline_m.emplace_back(tooth.min_x_m, tooth.min_y_m);
    outline_m.emplace_back(tooth.max_x_m, tooth.min_y_m);
    outline_m.emplace_back(tooth.max_x_m, main.min_y_m);
  }
  outline_m.emplace_back(main.max_x_m, main.min_y_m);
  outline_m.emplace_back(main.max_x_m, main.max_y_m);
  for (auto tooth = port_teeth.rbegin(); tooth != port_teeth.rend(); ++tooth) {
    outline_m.emplace_back(tooth->max_x_m, main.max_y_m);
    outline_m.emplace_back(tooth->max_x_m, tooth->max_y_m);
    outline_m.emplace_back(tooth->min_x_m, tooth->max_y_m);
    outline_m.emplace_back(tooth->min_x_m, main.max_y_m);
  }
  outline_m.emplace_back(main.min_x_m, main.max_y_m);
}

// Straight, as a T, as an L, or with fingers on one or both sides.
void MakeRun(const Size& size, bool is_floating, Model& model) {
  SceneObject& dock = model.object();
  const double length_m = model.GivenOrDrawn(size.length_m, 4.0, 35.0);
  const double width_m = model.GivenOrDrawn(size.width_m, 0.9, 3.5);
  const Build build = DrawBuild(is_floating, model);
  const double half_m = width_m / 2.0;
  const Deck main{0.0, length_m, -half_m, half_m};
  const double furniture = model.Chance(0.6) ? 1.0 : 0.0;
  AddDeck(main, build, model);
  AddFurniture(main, build, furniture, model);
  const double share = model.Between(0.0, 1.0);
  if (share < 0.4 || length_m < 5.0) return OutlineOfDeck(main, dock);
  if (share < 0.6) {  // T or L
    const double head_m = model.Between(1.5, 4.0);
    const double reach_m = model.Between(1.5, 8.0);
    const Deck port{length_m - head_m, length_m, half_m, half_m + reach_m};
    AddDeck(port, build, model);
    AddFurniture(port, build, furniture, model);
    if (model.Chance(0.5)) return OutlineOfComb(main, {port}, {}, dock);
    const Deck starboard{port.min_x_m, port.max_x_m, -half_m - reach_m, -half_m};
    AddDeck(starboard, build, model);
    return OutlineOfComb(main, {port}, {starboard}, dock);
  }
  // Fingers: slimmer, at equal distances.
  Build slim = build;
  slim.rail_probability = 0.0;
  slim.pile_spacing_m = std::max(build.pile_spacing_m, 3.0);
  const double finger_m = model.Between(2.5, 9.0);
  const double finger_width_m = model.Between(0.4, 1.2);
  const double spacing_m = model.Between(3.0, 7.0);
  const bool on_both_sides = model.Chance(0.5);
  std::vector<Deck> port;
  std::vector<Deck> starboard;
  for (double x_m = length_m - finger_width_m; x_m > 2.0; x_m -= spacing_m) {
    port.insert(port.begin(), {x_m, x_m + finger_width_m, half_m, half_m + finger_m});
    AddDeck(port.front(), slim, model);
    if (!on_both_sides) continue;
    starboard.insert(starboard.begin(), {x_m, x_m + finger_width_m, -half_m - finger_m, -half_m});
    AddDeck(starboard.front(), slim, model);
  }
  OutlineOfComb(main, port, starboard, dock);
}

// A board with a mark, on one or two legs; seen face on from the water.
void AddPlacard(double x_m, double y_m, double foot_m, Model& model) {
  const double half_m = model.Between(0.25, 0.75);
  const double height_m = model.Between(0.4, 1.4);
  const double bottom_m = foot_m + model.Between(0.0, 1.2);
  const Material metal = model.Metal();
  if (bottom_m > foot_m + 0.05) {
    for (const double side : {-0.8, 0.8}) model.Post(x_m, y_m + side * half_m, 0.03, foot_m, bottom_m, metal);
  }
  model.Box(x_m - 0.02, x_m + 0.02, y_m - half_m, y_m + half_m, bottom_m, bottom_m + height_m, model.Chance(0.15) ? model.Retro() : model.Paint());
}

}  // namespace

void MakeJetty(const Size& size, Model& model) { MakeRun(size, false, model); }

void MakePontoon(const Size& size, Model& model) { MakeRun(size, true, model); }

// Two or three bays side by side, open to the sea: a back along y at the landward side, walls from it outward, a placard at the back of each bay.
void MakeDockBays(const Size& size, Model& model) {
  const bool is_floating = model.Chance(0.7);
  Build build = DrawBuild(is_floating, model);
  build.rail_probability = model.Chance(0.2) ? 0.4 : 0.0;
  if (model.Chance(0.5)) build.pile_over_deck_m = -0.05;
  const int num_bays = model.Whole(2, 3);
  const double bay_m = model.Between(3.0, 7.0);
  const double wall_m = model.Between(0.5, 1.5);
  const double depth_m = model.GivenOrDrawn(size.length_m, 4.0, 9.0);
  const double back_m = model.Between(0.6, 2.5);
  constexpr double kLeastBayM = 0.5;
  const double width_m =
      size.width_m > 0.0 ? std::max(size.width_m, num_bays * kLeastBayM + (num_bays + 1) * wall_m) : num_bays * bay_m + (num_bays + 1) * wall_m;
  const double step_m = (width_m - wall_m) / num_bays;
  const Deck back{0.0, back_m, -width_m / 2.0, width_m / 2.0};
  AddDeck(back, build, model);
  AddFurniture(back, build, model.Chance(0.4) ? 1.0 : 0.0, model);
  auto& outline_m = model.object().outline_m;
  outline_m.emplace_back(0.0, width_m / 2.0);
  outline_m.emplace_back(0.0, -width_m / 2.0);
  for (int i = 0; i <= num_bays; ++i) {
    const double y_m = -width_m / 2.0 + i * step_m;
    const Deck wall{back_m, back_m + depth_m, y_m, y_m + wall_m};
    AddDeck(wall, build, model);
    if (model.Chance(0.2)) AddFurniture(wall, build, 0.6, model);
    if (i > 0) outline_m.emplace_back(back_m, y_m);
    outline_m.emplace_back(wall.max_x_m, y_m);
    outline_m.emplace_back(wall.max_x_m, y_m + wall_m);
    if (i < num_bays) outline_m.emplace_back(back_m, y_m + wall_m);
    if (i < num_bays && model.Chance(0.85)) AddPlacard(back_m - 0.1, y_m + (wall_m + step_m) / 2.0, build.top_m, model);
  }
}

}  // namespace lookout::sim
