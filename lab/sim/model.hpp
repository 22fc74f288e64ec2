// Puts the model of an object together from parts whose sizes and materials a seed draws.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <initializer_list>
#include <utility>
#include <vector>

#include "lab/sim/random.hpp"
#include "lab/sim/scene.hpp"
#include "lab/sim/solid.hpp"

namespace lookout::sim {

/// Seen from above: widest between the middle and the stern, pointed or blunt at the bow; convex, counter-clockwise.
struct HullPlan {
  double length_m = 0.0;
  double width_m = 0.0;
  double bow_power = 2.0;      // 1.3 = a wedge, 4 = full until short of the bow
  double bow_share = 0.1;      // of the width that the stem has
  double transom_share = 0.8;  // of the width that the stern has; less than 0.3 = a double-ender
  double middle_share = 0.55;  // of the length that lies ahead of the widest place
};
std::vector<Eigen::Vector2d> OutlineOf(const HullPlan& plan);

/// Draws in two arguments of one call would depend on the compiler: at most one size and one material in each.
class Model {
 public:
  /// @param object  gets the parts; outlives this, as does `random`
  Model(SceneObject& object, Random& random) : object_(object), random_(random), materials_(random.Next(), kMaterialsStream) {}

  double Between(double low, double high) { return random_.Uniform(low, high); }
  bool Chance(double probability) { return random_.Uniform() < probability; }
  /// From `low` to `high`, both included.
  int Whole(int low, int high);
  /// The file's number, else a drawn number. Draws in both cases.
  double GivenOrDrawn(double given, double low, double high);

  /// Material of a hull or body: bright gelcoat and paint, dull colours, dark paint, near black; or the file's value.
  Material Paint(double given = 0.0);
  Material Cloth();
  Material Metal();
  Material Wood();
  /// Most of the light goes through.
  Material Glass();
  /// A retro-reflector: brighter than any diffuse surface.
  Material Retro();

  void Add(Solid solid, const Material& material) { object_.parts.push_back({std::move(solid), material}); }
  void Box(double min_x_m, double max_x_m, double min_y_m, double max_y_m, double bottom_m, double top_m, const Material& material);
  void Post(double x_m, double y_m, double radius_m, double bottom_m, double top_m, const Material& material);
  void Rod(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m, double radius_m, const Material& material);
  /// Rods from each point to the next.
  void Chain(std::initializer_list<Eigen::Vector3d> points_m, double radius_m, const Material& material);
  /// A thin cloth or board with four corners in order, seen from both sides. It may be twisted.
  void Sheet(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m, const Eigen::Vector3d& c_m, const Eigen::Vector3d& d_m,
             const Material& material);
  /// Posts of one height along a line, and rails between them.
  void Railing(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m, double height_m, double spacing_m, int num_rails, double radius_m,
               const Material& material);

  enum class Posture { kStanding, kSitting, kKneeling };
  static Posture PostureOf(bool stands) { return stands ? Posture::kStanding : Posture::kSitting; }
  /// @param feet_m   what it stands or sits on
  /// @param facing   unit vector seen from above
  void Person(const Eigen::Vector3d& feet_m, const Eigen::Vector2d& facing, Posture posture);

  /// The convex hull of all parts becomes the outline.
  void OutlineAllParts();

  /// It floats: how it rides the waves.
  void Float(double length_m, double width_m) { object_.waterline_m = {length_m, width_m}; }

  SceneObject& object() { return object_; }

 private:
  static constexpr std::uint64_t kMaterialsStream = 7;

  SceneObject& object_;
  Random& random_;
  // Materials have a random stream of their own: C++ leaves open in which order the arguments of a call are drawn, and many calls have a size and a
  // material.
  Random materials_;
};

}  // namespace lookout::sim
