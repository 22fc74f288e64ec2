// How near objects come to each other in the first minute of a scene.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/core/outlines.hpp"
#include "lab/sim/scene.hpp"

namespace lookout::sim {

/// A simple polygon seen from above.
using Outline = std::vector<Eigen::Vector2d>;

/// Between two objects in the first part of a scene, sampled every 0.2 s.
struct Approach {
  double distance_m;
  std::string name;      // of the other object
  double limit_m = 0.0;  // least distance to keep; 0 = both are in one place
};

class Traffic {
 public:
  /// @param checked_s  how long from the start
  explicit Traffic(double checked_s);

  /// From now on it is in the way of others. It is taken as the hull of 2.4 m x 1.4 m of the paper's boat.
  void SetOwnBoat(const OwnMotion& own_motion);

  /// From now on it is in the way of others.
  ///
  /// @param is_passed_under  the own boat keeps clear only of parts that reach lower than 2.5 m above the water
  void Add(const SceneObject& object, bool is_passed_under = false);

  /// @return how near the object comes to the own boat, when nearer than `limit_m`
  std::optional<Approach> ToOwnBoat(const SceneObject& object, double limit_m) const;

  /// @param num_first  only the first so many that were added
  /// @param skipped    but for this one, by the order in which they were added
  /// @return the first of them to which it comes nearer than `limit_m`
  std::optional<Approach> ToOthers(const SceneObject& object, double limit_m, std::size_t num_first,
                                   std::optional<std::size_t> skipped = std::nullopt) const;

  /// @return how near it comes to the one that was added as `other` when that is less than `limit_m`
  std::optional<Approach> ToOne(const SceneObject& object, double limit_m, std::size_t other) const;

  /// @return the first of all to which an own boat that moved so would come nearer than `limit_m`
  std::optional<Approach> OfOwnBoat(const OwnMotion& own_motion, double limit_m) const;

  /// @return the first of the others whose outline it crosses, both in the water; what lies on land, at docks or walls may
  std::optional<Approach> Overlapping(const SceneObject& object) const;

  std::size_t num_objects() const { return others_.size(); }

 private:
  struct Shape {
    Outline outline_m;  // map
    Eigen::Vector2d center_m;
    double radius_m;
  };
  struct Mover {
    std::string name;
    std::vector<Shape> shapes;  // by sample; a single one for a standing thing
    double speed_mps;           // from one sample to the next no point of the object is faster
    bool is_in_water = true;
  };
  Mover ToMover(const SceneObject& object) const;
  Mover ToMover(const OwnMotion& own_motion) const;
  static Mover Sampled(const std::string& name, const Outline& outline_m, int num_samples, const std::function<Placement(double)>& at);
  double NearestM(const Mover& a, const Mover& b, double limit_m) const;

  int num_samples_;
  std::optional<Mover> own_boat_;
  std::vector<Mover> others_;
  std::vector<Mover> obstacles_;  // of the own boat: the others, or the ground that they stand on
};

}  // namespace lookout::sim
