// Returns that no object makes: of the water's surface, foam, drops. Sources of the models: README.md, "What is simulated".
#pragma once

#include <optional>
#include <vector>

#include "common/config/boat.hpp"
#include "lab/sim/birds.hpp"
#include "lab/sim/breakers.hpp"
#include "lab/sim/clouds.hpp"
#include "lab/sim/random.hpp"
#include "lab/sim/ray_caster.hpp"
#include "lab/sim/scene.hpp"

namespace lookout::sim {

/// Where a ray first meets the sea. The ray goes down from above all crests.
///
/// @return range between `from_m` and `to_m`, better than 1 cm; nullopt when it does not meet the sea there
std::optional<double> RangeToSea(const Sea& sea, const Ray& ray, double time_s, double from_m, double to_m);

/// Part of the light that calm water mirrors, mean of both polarisations.
///
/// @param sine  of the angle between ray and surface
double FresnelReflectance(double sine);

class Clutter {
 public:
  /// @param scene  outlives this
  Clutter(const Scene& scene, const config::BoatFacts& boat, std::uint64_t seed);

  /// Wakes and spray are where they are at `time_s`, to kPeriodS.
  void MoveTo(double time_s);

  /// The echo of drops on the way along a ray to `max_range_m`. Drops are seen at any incidence.
  std::optional<Echo> FromDrops(const Ray& ray_vessel, double max_range_m);

  /// The echo of the water for a ray that goes down and meets nothing else before `max_range_m`.
  std::optional<Echo> FromWater(const Ray& ray, double max_range_m);

  /// Breaking waves and birds: a ray does not meet the things that they hide.
  std::optional<Echo> FromBreakersAndBirds(const Ray& ray, double max_range_m);

  /// Churned water, plumes and fog, as FromDrops.
  std::optional<Echo> FromClouds(const Ray& ray, const Ray& ray_vessel, double max_range_m) {
    return clouds_.FirstEcho(ray, ray_vessel, max_range_m);
  }

  static constexpr double kPeriodS = 0.01;

 private:
  struct Source {  // of a wake
    Track track;
    bool is_own = false;
    double stern_m = 0.0;  // along x of its frame
    double half_width_m = 0.0;
  };
  struct Wake {
    Eigen::Vector2d stern_map_m;
    Eigen::Vector2d ahead;  // unit vector of the course
    double speed_mps;
    double half_width_m;
  };
  Wake WakeOf(const Source& source, double time_s) const;
  double FoamAt(const Eigen::Vector2d& p_map_m) const;
  std::optional<double> SprayRange(const Ray& ray_vessel, double max_range_m);
  std::optional<double> RainRange(double max_range_m);

  const Scene& scene_;
  const Effects& effects_;
  double reference_point_above_water_m_;
  Eigen::AlignedBox3d own_box_m_;
  bool has_water_;
  Random random_;
  Breakers breakers_;
  Birds birds_;
  Clouds clouds_;
  std::vector<Source> sources_;
  std::vector<Wake> wakes_;
  double spray_ = 0.0;  // 0 to 1
  double time_s_ = 0.0;
  double moved_at_s_ = -1e9;
};

}  // namespace lookout::sim
