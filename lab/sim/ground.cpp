#include "lab/sim/ground.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Diffuse reflectances near 905 nm, rounded from common tables.
constexpr Material kTrunk{0.25};
constexpr Material kLeaves{0.35, true};
constexpr Material kReed{0.35, true};
constexpr Material kStone{0.3};
constexpr Material kPlaster{0.5};
constexpr Material kRoof{0.25};
constexpr Material kTimber{0.3};
constexpr Material kRubber{0.06};
constexpr Material kIron{0.3};
constexpr Material kCarPaint{0.4};
constexpr Material kClothes{0.4};

// Sizes in this file are drawn from common sizes ashore. Numbers of parts are bounded, as the time for a scene grows with them.
constexpr int kMaxReeds = 220;
constexpr int kMaxTrees = 90;
constexpr int kMaxFolds = 120;
constexpr double kBuriedM = 0.5;  // objects on a slope begin below the ground

// Places things on one stretch.
class Gardener {
 public:
  Gardener(const Stretch& stretch, const Ground& ground, Random& random, std::vector<Part>& parts)
      : stretch_(stretch), ground_(ground), random_(random), parts_(parts) {}

  // So many, one to each `spacing_m` of the stretch on average.
  int Count(double spacing_m, int most = 1000) {
    return std::min(most, static_cast<int>(std::floor(stretch_.length_m / spacing_m + random_.Uniform())));
  }

  // A vertex number within the stretch, anywhere or at a share of it.
  double Anywhere() { return At(random_.Uniform()); }
  double At(double share) const { return std::lerp(static_cast<double>(stretch_.first), static_cast<double>(stretch_.last), share); }

  // Behind the edge, as deep as the land allows.
  double Inland(double from_m, double to_m, double vertex) {
    const double depth_m = ground_.MaxDepthM(vertex) * 0.95;
    return std::min(stretch_.run_m + random_.Uniform(from_m, to_m), depth_m);
  }

  void Post(double vertex, double inland_m, double radius_m, double height_m, const Material& material) {
    const Vector3d foot_m = ground_.At(vertex, inland_m);
    parts_.push_back({Cylinder{foot_m.head<2>(), radius_m, foot_m.z() - kBuriedM, foot_m.z() + height_m}, material});
  }

  void Ball(double vertex, double inland_m, const Vector3d& radii_m, double height_m, const Material& material) {
    const Vector3d foot_m = ground_.At(vertex, inland_m);
    parts_.push_back({Ellipsoid{foot_m + Vector3d(0.0, 0.0, height_m), radii_m}, material});
  }

  // An upright box, its long side along the waterline but for `askew_rad`.
  std::vector<Vector2d> Box(double vertex, double inland_m, double length_m, double width_m, double from_m, double to_m, const Material& material,
                            double askew_rad = 0.0) {
    const Vector3d foot_m = ground_.At(vertex, inland_m);
    const Vector2d along = Turned(ground_.DirectionAt(vertex), askew_rad);
    const Vector2d across(-along.y(), along.x());
    std::vector<Vector2d> corners_m;
    for (const auto& p : Rectangle(-length_m / 2.0, length_m / 2.0, -width_m / 2.0, width_m / 2.0)) {
      corners_m.emplace_back(foot_m.head<2>() + p.x() * along + p.y() * across);
    }
    parts_.push_back({Prism{corners_m, foot_m.z() + from_m, foot_m.z() + to_m}, material});
    return corners_m;
  }

  void Tree(double vertex, double inland_m, double crown_from_m, double crown_to_m, double max_crown_radius_m) {
    const double crown_bottom_m = random_.Uniform(crown_from_m, crown_to_m);
    const double half_m = random_.Uniform(1.2, 5.0);
    const double radius_m = random_.Uniform(0.3, 1.0) * max_crown_radius_m;
    Post(vertex, inland_m, random_.Uniform(0.07, 0.3), crown_bottom_m + half_m, kTrunk);
    Ball(vertex, inland_m, {radius_m, radius_m, half_m}, crown_bottom_m + half_m, kLeaves);
  }

  void Bush(double vertex, double inland_m) {
    const double radius_m = random_.Uniform(0.3, 1.4);
    Ball(vertex, inland_m, {radius_m, radius_m, random_.Uniform(0.3, 1.2)}, 0.3, kLeaves);
  }

  void Person(double vertex, double inland_m) {
    const double height_m = random_.Uniform(1.1, 1.9);
    Post(vertex, inland_m, random_.Uniform(0.15, 0.28), height_m, kClothes);
  }

  void House(double vertex, double inland_m) {
    const double length_m = random_.Uniform(5.0, 14.0);
    const double width_m = random_.Uniform(4.0, 9.0);
    const double eaves_m = random_.Uniform(2.4, 6.5);
    const Material walls{random_.Uniform(0.2, 0.7)};
    const auto corners_m = Box(vertex, inland_m + width_m / 2.0, length_m, width_m, -1.5, eaves_m, walls, random_.Uniform(-0.5, 0.5));
    const double eaves_map_m = ground_.At(vertex, inland_m + width_m / 2.0).z() + eaves_m;
    const auto at = [](const Vector2d& p_m, double z_m) { return Vector3d(p_m.x(), p_m.y(), z_m); };
    const Vector3d ridge_a_m = at((corners_m[0] + corners_m[3]) / 2.0, eaves_map_m + width_m * 0.4);
    const Vector3d ridge_b_m = at((corners_m[1] + corners_m[2]) / 2.0, eaves_map_m + width_m * 0.4);
    const std::vector<Vector3d> eave{at(corners_m[0], eaves_map_m), at(corners_m[1], eaves_map_m), at(corners_m[2], eaves_map_m),
                                     at(corners_m[3], eaves_map_m)};
    parts_.push_back({Triangle{eave[0], eave[1], ridge_b_m}, kRoof});
    parts_.push_back({Triangle{eave[0], ridge_b_m, ridge_a_m}, kRoof});
    parts_.push_back({Triangle{eave[2], eave[3], ridge_a_m}, kRoof});
    parts_.push_back({Triangle{eave[2], ridge_a_m, ridge_b_m}, kRoof});
    parts_.push_back({Triangle{eave[1], eave[2], ridge_b_m}, kPlaster});
    parts_.push_back({Triangle{eave[3], eave[0], ridge_a_m}, kPlaster});
  }

  void Car(double vertex, double inland_m) {
    const double askew_rad = random_.Uniform() < 0.5 ? 0.0 : kPi / 2.0;
    Box(vertex, inland_m, random_.Uniform(3.6, 4.9), 1.8, 0.2, 0.85, kCarPaint, askew_rad);
    Box(vertex, inland_m, 2.2, 1.6, 0.85, random_.Uniform(1.35, 1.9), kCarPaint, askew_rad);
  }

  // Posts with a rail, or closed boards, along the whole stretch.
  void Fence(double inland_m, double height_m) {
    const bool is_closed = random_.Uniform() < 0.3;
    for (std::size_t i = stretch_.first; i < stretch_.last; ++i) {
      const auto vertex = static_cast<double>(i);
      const Vector3d a_m = ground_.At(vertex, inland_m);
      const Vector3d b_m = ground_.At(vertex + 1.0, inland_m);
      const double length_m = (b_m - a_m).head<2>().norm();
      const int num_posts = std::max(1, static_cast<int>(length_m / 2.0));
      for (int post = 0; post < num_posts; ++post) Post(vertex + static_cast<double>(post) / num_posts, inland_m, 0.05, height_m, kTimber);
      if (std::abs(a_m.z() - b_m.z()) > 0.5) continue;
      Box(vertex + 0.5, inland_m, length_m, 0.06, is_closed ? 0.1 : height_m - 0.1, height_m, kTimber);
    }
  }

 private:
  static Vector2d Turned(const Vector2d& v, double by_rad) {
    return {std::cos(by_rad) * v.x() - std::sin(by_rad) * v.y(), std::sin(by_rad) * v.x() + std::cos(by_rad) * v.y()};
  }

  const Stretch& stretch_;
  const Ground& ground_;
  Random& random_;
  std::vector<Part>& parts_;
};

// Stalks that stand close in clumps: each cylinder stands for a few of them.
void AddReeds(const Stretch& stretch, Gardener& gardener, Random& random) {
  const double height_m = random.Uniform(1.0, 2.6);
  const int count = gardener.Count(1.0 / (random.Uniform(1.5, 5.0) * stretch.reach_m), kMaxReeds);
  for (int i = 0; i < count; ++i) {
    const double vertex = gardener.Anywhere();
    const double offset_m = random.Uniform(-stretch.reach_m + 0.1, 0.3);
    const double radius_m = random.Uniform(0.012, 0.05);
    gardener.Post(vertex, offset_m, radius_m, height_m * random.Uniform(0.6, 1.1), kReed);
  }
}

// @param out_m  by how much what they hang on stands out of the waterline
void AddFenders(const Stretch& stretch, const Ground& ground, double out_m, Gardener& gardener, Random& random, std::vector<Part>& parts) {
  const auto at_wall = [&](double vertex, double before_m) -> Vector2d { return ground.At(vertex, -before_m - out_m).head<2>(); };
  const double fender_radius_m = random.Uniform(0.08, 0.17);
  const double fender_bottom_m = random.Uniform(0.1, 0.5) * stretch.top_m;
  const int num_fenders = gardener.Count(random.Uniform(2.0, 12.0), 60);
  for (int i = 0; i < num_fenders; ++i) {
    const Vector2d place_m = at_wall(gardener.At((i + 0.5) / num_fenders), fender_radius_m);
    parts.push_back({Cylinder{place_m, fender_radius_m, fender_bottom_m, stretch.top_m * 0.98}, kRubber});
  }
  const int num_ladders = gardener.Count(random.Uniform(12.0, 40.0));
  for (int i = 0; i < num_ladders; ++i) {
    const double vertex = gardener.Anywhere();
    const Vector2d along = ground.DirectionAt(vertex);
    for (const double side : {-0.22, 0.22}) {
      parts.push_back({Cylinder{at_wall(vertex, 0.12) + side * along, 0.03, -0.5, stretch.top_m + 0.3}, kIron});
    }
  }
  const int num_bollards = gardener.Count(random.Uniform(6.0, 20.0));
  for (int i = 0; i < num_bollards; ++i) {
    const double radius_m = random.Uniform(0.1, 0.22);
    gardener.Post(gardener.At((i + 0.5) / num_bollards), 0.5, radius_m, random.Uniform(0.3, 0.6), kIron);
  }
}

// Folds that stand out and hollows between them, to below the top. Pairs of Z and U profiles are 1 to 1.5 m wide and 0.2 to 0.5 m deep.
//
// @return by how much they stand out
double AddSheetPiles(const Stretch& stretch, const Ground& ground, Gardener& gardener, Random& random) {
  const double deep_m = random.Uniform(0.15, 0.35);
  const double out_share = random.Uniform(0.35, 0.6);
  const int num_folds = gardener.Count(random.Uniform(1.0, 1.5), kMaxFolds);
  const double fold_m = out_share * stretch.length_m / std::max(num_folds, 1);
  const double beam_m = random.Uniform(0.0, 0.4);  // height of the beam above the piles
  for (int i = 0; i < num_folds; ++i) {
    const double vertex = gardener.At((i + 0.5) / num_folds);
    const double foot_m = ground.At(vertex, -deep_m / 2.0).z();
    gardener.Box(vertex, -deep_m / 2.0, fold_m, deep_m, 0.0, stretch.top_m - beam_m - foot_m, kIron);
  }
  return deep_m;
}

void AddBoulders(Gardener& gardener, double spacing_m, double from_m, double to_m, double least_m, double most_m, Random& random) {
  const int count = gardener.Count(spacing_m, 200);
  for (int i = 0; i < count; ++i) {
    const double vertex = gardener.Anywhere();
    const double inland_m = random.Uniform(from_m, to_m);
    const double radius_m = random.Uniform(least_m, most_m);
    const Vector3d radii_m{radius_m, radius_m * random.Uniform(0.6, 1.0), radius_m * random.Uniform(0.5, 0.9)};
    gardener.Ball(vertex, inland_m, radii_m, 0.1, kStone);
  }
}

}  // namespace

void AddEdge(const Stretch& stretch, const Ground& ground, Random& random, std::vector<Part>& parts) {
  using config::Scene;
  Gardener gardener(stretch, ground, random, parts);
  if (stretch.edge == Scene::REEDS) AddReeds(stretch, gardener, random);
  if (stretch.edge == Scene::FENDERED) AddFenders(stretch, ground, 0.0, gardener, random, parts);
  if (stretch.edge == Scene::SHEET_PILES) {
    const double deep_m = AddSheetPiles(stretch, ground, gardener, random);
    AddFenders(stretch, ground, deep_m, gardener, random, parts);
  }
  if (stretch.edge == Scene::RIPRAP) AddBoulders(gardener, random.Uniform(0.6, 1.2), -0.2, stretch.run_m, 0.25, 0.8, random);
}

void AddCover(const Stretch& stretch, const Ground& ground, Random& random, std::vector<Part>& parts) {
  using config::Scene;
  Gardener gardener(stretch, ground, random, parts);
  const auto chance = [&random](double probability) { return random.Uniform() < probability; };
  // So many at a spacing, each at a vertex and so far behind the edge.
  const auto each = [&](double spacing_m, double from_m, double to_m, const auto& add) {
    const int count = gardener.Count(spacing_m, kMaxTrees);
    for (int i = 0; i < count; ++i) {
      const double vertex = gardener.Anywhere();
      add(vertex, gardener.Inland(from_m, to_m, vertex));
    }
  };
  const auto tall_tree = [&](double vertex, double inland_m) { gardener.Tree(vertex, inland_m, 2.0, 5.0, 4.0); };
  const auto low_tree = [&](double vertex, double inland_m) { gardener.Tree(vertex, inland_m, 0.3, 2.0, 3.0); };
  const auto bush = [&](double vertex, double inland_m) { gardener.Bush(vertex, inland_m); };
  const auto person = [&](double vertex, double inland_m) { gardener.Person(vertex, inland_m); };
  const auto car = [&](double vertex, double inland_m) { gardener.Car(vertex, inland_m); };
  switch (stretch.cover) {
    case Scene::BARE:
      break;
    case Scene::LAWN:
      each(random.Uniform(3.0, 14.0), 0.3, 25.0, tall_tree);
      if (chance(0.3)) each(20.0, 0.3, 10.0, bush);
      if (chance(0.4)) each(15.0, 0.0, 15.0, person);
      break;
    case Scene::WOODS: {
      // Up to the water, or with a strip before it.
      const double from_m = chance(0.5) ? 0.0 : 2.0;
      const double to_m = random.Uniform(5.0, 20.0);
      each(random.Uniform(1.2, 3.0), from_m, to_m, low_tree);
      each(random.Uniform(3.0, 12.0), 0.0, 3.0, bush);
      break;
    }
    case Scene::HOUSES: {
      const int count = gardener.Count(random.Uniform(14.0, 35.0));
      for (int i = 0; i < count; ++i) {
        const double vertex = gardener.At((i + random.Uniform(0.2, 0.8)) / count);
        gardener.House(vertex, gardener.Inland(2.0, 14.0, vertex));
      }
      const bool has_tall_trees = chance(0.5);
      const double spacing_m = random.Uniform(8.0, 20.0);
      each(spacing_m, 0.5, 14.0,
           [&](double vertex, double inland_m) { return has_tall_trees ? tall_tree(vertex, inland_m) : low_tree(vertex, inland_m); });
      if (chance(0.5)) {
        const double fence_m = stretch.run_m + random.Uniform(0.3, 2.0);
        gardener.Fence(fence_m, random.Uniform(0.8, 1.8));
      }
      break;
    }
    case Scene::PROMENADE:
      if (chance(0.5)) {
        const double railing_m = stretch.run_m + random.Uniform(0.2, 0.8);
        gardener.Fence(railing_m, random.Uniform(0.9, 1.2));
      }
      each(random.Uniform(12.0, 30.0), 1.0, 3.0, [&](double vertex, double inland_m) { gardener.Post(vertex, inland_m, 0.07, 5.0, kIron); });
      each(random.Uniform(5.0, 25.0), 0.5, 6.0, person);
      if (chance(0.5)) each(random.Uniform(5.0, 12.0), 3.0, 7.0, car);
      if (chance(0.5)) each(random.Uniform(6.0, 15.0), 4.0, 9.0, tall_tree);
      if (chance(0.5)) each(40.0, 10.0, 16.0, [&](double vertex, double inland_m) { gardener.House(vertex, inland_m); });
      break;
    case Scene::SHEDS:
      each(random.Uniform(20.0, 40.0), 6.0, 18.0, [&](double vertex, double inland_m) {
        const double length_m = random.Uniform(8.0, 25.0);
        const double width_m = random.Uniform(6.0, 12.0);
        gardener.Box(vertex, inland_m, length_m, width_m, -1.0, random.Uniform(3.5, 9.0), kPlaster);
      });
      each(random.Uniform(10.0, 30.0), 2.0, 8.0, [&](double vertex, double inland_m) {
        const double length_m = random.Uniform(1.5, 6.0);
        const double width_m = random.Uniform(1.0, 2.5);
        const double height_m = random.Uniform(0.8, 2.6);
        gardener.Box(vertex, inland_m, length_m, width_m, -0.5, height_m, kIron, random.Uniform(-0.3, 0.3));
      });
      if (chance(0.5)) each(random.Uniform(8.0, 25.0), 2.0, 7.0, car);
      each(25.0, 0.5, 6.0, person);
      break;
    case Scene::ROCKS:
      AddBoulders(gardener, random.Uniform(1.0, 4.0), -0.5, stretch.run_m + 4.0, 0.2, 1.2, random);
      break;
  }
}

}  // namespace lookout::sim
