// Shots of a lidar into a scene: what comes back of each, with the truth. All heads fire them; what the sensor makes of them is theirs.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/config/boat.hpp"
#include "lab/sim/clutter.hpp"
#include "lab/sim/motion.hpp"
#include "lab/sim/random.hpp"
#include "lab/sim/ray_caster.hpp"
#include "lab/sim/scene.hpp"

namespace lookout::sim {

/// How a sensor measures ranges. Noise and reach are factors to the scene's effects, which hold for a VLP-16.
struct RangeFacts {
  double unit_m = 0.002;
  // VLP-16 data sheet 63-9229: range up to 100 m; nothing is given nearer than about 0.4 m.
  double min_m = 0.4;
  double max_m = 110.0;
  double noise = 1.0;  // times Effects::range_sd_m
  double reach = 1.0;  // times Effects::half_seen_range_m
};

struct Measurement {
  std::uint16_t range = 0;  // in units; 0 = no return
  std::uint8_t reflectivity = 0;
  int object_id = kNoObject;
  ReturnReason reason = ReturnReason::kStray;
  double true_range_m = 0.0;
  double power = 0.0;  // relative to the power from a white surface at 1 m
};

struct Shot {
  Measurement strongest;
  Measurement last;
};

class Shots {
 public:
  /// @param scene  outlives this
  Shots(const Scene& scene, const config::BoatFacts& boat, const RangeFacts& facts, std::uint64_t seed);

  Shots(const Shots&) = delete;
  Shots& operator=(const Shots&) = delete;

  /// Boat and scene as they are then. One pose serves for some tens of microseconds.
  void MoveTo(double time_s);

  /// @param origin_m   lidar frame, where the beam starts
  /// @param direction  unit vector, lidar frame
  Shot Fire(const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction);

 private:
  // Echoes of one shot that were seen.
  struct Seen {
    static constexpr int kMaxCount = 8;
    int count = 0;
    std::array<Measurement, kMaxCount> measurement;

    void Add(const Measurement& seen) {
      if (seen.range != 0) measurement[static_cast<std::size_t>(count++)] = seen;
    }
  };

  struct RayPair {  // one ray in two frames
    Ray vessel;
    Ray map;
  };
  Echoes Trace(const RayPair& ray, double max_range_m);
  void TraceWater(const Ray& ray, double max_range_m, Seen& seen);
  Shot Choose(const Seen& seen) const;
  Measurement Measure(const Echo& echo);
  Measurement ToMeasurement(double range_m, double brightness, int object_id, ReturnReason reason);
  Measurement Stray(double max_range_m);

  RangeFacts facts_;
  const Effects& effects_;
  const Sea& sea_;
  OwnMotion own_motion_;
  double reference_point_above_water_m_;
  Eigen::Isometry3d T_vessel_lidar_;
  std::vector<SceneObject> own_hull_;
  RayCaster own_caster_;  // vessel frame
  BeamWidth beam_width_;
  RayCaster caster_;  // map frame
  Clutter clutter_;
  Random random_;
  double time_s_ = 0.0;
  Eigen::Isometry3d T_map_vessel_ = Eigen::Isometry3d::Identity();
};

}  // namespace lookout::sim
