// Waves that break: arcs of foam that stand up from the water and run, and the patches that they leave behind.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "lab/sim/random.hpp"
#include "lab/sim/ray_caster.hpp"
#include "lab/sim/sea.hpp"

namespace lookout::sim {

class Breakers {
 public:
  /// @param per_hectare  mean number at an instant
  /// @param sea          they stand on it and run with it; outlives this. On calm water the seed draws where to
  Breakers(double per_hectare, const Sea& sea, std::uint64_t seed);

  /// They are where they are at `time_s`, those within kReachM of `eye_m`. Place and time alone decide, whoever looks.
  void MoveTo(double time_s, const Eigen::Vector2d& eye_m);

  /// The first breaker on the way of a ray before `max_range_m`; nullopt also where its foam lets the beam through.
  std::optional<Echo> FirstEcho(const Ray& ray, double max_range_m);

  /// @return share of foam on the water at a place, 0 to 1
  double FoamAt(const Eigen::Vector2d& p_map_m) const;

  bool is_off() const { return per_hectare_ <= 0.0; }

  static constexpr double kReachM = 45.0;

 private:
  struct Breaker {
    Eigen::Vector2d middle_m;  // map
    Eigen::Vector2d towards;   // unit vector
    double half_length_m;
    double bend_m;       // how far the breaker's middle runs ahead of its ends
    double height_m;     // present height; 0 = only foam is left
    double thickness_m;  // along the way
    double strength;     // chance of a return from a shot that meets the breaker
    double speed_mps;
    double way_m;       // way of the breaker while it broke
    double foam_age_s;  // age of the foam since the breaker ceased
  };
  void AddBornIn(std::int64_t column, std::int64_t row, std::int64_t slot, double time_s);

  double per_hectare_;
  const Sea& sea_;
  std::uint64_t seed_;
  Random random_;  // of the shots
  Eigen::Vector2d towards_;
  std::vector<Breaker> breakers_;
  double time_s_ = 0.0;
};

}  // namespace lookout::sim
