// Birds in flight: they cross low over the water, or circle.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "lab/sim/ray_caster.hpp"

namespace lookout::sim {

class Birds {
 public:
  /// @param mean_count  of 2.3 there are two or three
  Birds(double mean_count, std::uint64_t seed);

  /// They stay within kReachM of `eye_m`: who leaves on one side comes in on the other.
  void MoveTo(double time_s, const Eigen::Vector2d& eye_m);

  /// @return what the ray meets before `max_range_m`
  std::optional<Echo> FirstEcho(const Ray& ray, double max_range_m) const;

  static constexpr double kReachM = 50.0;

 private:
  struct Bird {
    Eigen::Vector2d start_m;  // start, or centre of the bird's circle
    double radius_m;          // 0 = straight on
    double heading_rad;       // counter-clockwise from east, at the start
    double speed_mps;
    double height_m;
    double half_length_m;
    double half_span_m;
    double beats_hz;
    double reflectance;
    // Now:
    Eigen::Vector3d p_map_m = Eigen::Vector3d::Zero();
    Eigen::Vector2d ahead = Eigen::Vector2d::UnitX();
    double wing_height_m = 0.0;  // of the tips over the body
  };
  std::vector<Bird> birds_;
};

}  // namespace lookout::sim
