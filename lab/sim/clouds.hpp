// Drops that hang together: what hulls and screws of moving boats throw up, plumes over the own bow, banks of fog.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/config/boat.hpp"
#include "lab/sim/random.hpp"
#include "lab/sim/ray_caster.hpp"
#include "lab/sim/scene.hpp"

namespace lookout::sim {

class Clouds {
 public:
  /// @param scene  outlives this
  Clouds(const Scene& scene, const config::BoatFacts& boat, std::uint64_t seed);

  void MoveTo(double time_s);

  /// The echo of the first drop on the way of a ray, which is given in the map and in the vessel frame. Drops are seen at any incidence.
  std::optional<Echo> FirstEcho(const Ray& ray_map, const Ray& ray_vessel, double max_range_m);

 private:
  struct Cloud {  // an ellipsoid
    Eigen::Vector3d center_m;
    Eigen::Vector3d radii_m;  // along `ahead`, across `ahead`, up
    Eigen::Vector2d ahead;    // unit vector
    double density_per_m;     // chance of a drop's return per metre of beam
    ReturnReason reason;
  };
  struct Mover {
    Placement placement;
    double speed_mps = 0.0;
    double stern_m = 0.0;  // along x of its frame
    double bow_m = 0.0;
    double half_width_m = 0.0;
    bool is_own = false;
    double phase_rad = 0.0;
  };
  void AddChurn(const Mover& boat);
  void AddPlumes();
  std::optional<double> RangeInto(const Cloud& cloud, const Ray& ray, double max_range_m);
  std::optional<double> FogRange(const Ray& ray_map, double max_range_m);

  const Scene& scene_;
  const Effects& effects_;
  Eigen::AlignedBox3d own_box_m_;
  double reference_point_above_water_m_;
  std::uint64_t seed_;
  Random random_;
  std::vector<Cloud> on_map_;
  std::vector<Cloud> on_vessel_;  // frame of the own boat
  double time_s_ = 0.0;
  bool is_off_;
};

}  // namespace lookout::sim
