// Water with one effect at a time, and what a lidar sees of it.
#pragma once

#include <chrono>
#include <map>
#include <vector>

#include "lab/sim/lidar.hpp"
#include "tests/unit/sim/sim_fixture.hpp"

namespace lookout::sim {

inline const Utime kEffectsStart{std::chrono::seconds(1'781'532'600)};
inline constexpr int kPacketsPerTurn = 76;
inline constexpr int kShotsPerPacket = 384;

inline Effects QuietEffects() {
  Effects effects;
  effects.set_stray_probability(0.0);
  effects.set_range_sd_m(0.0);
  return effects;
}

// Out of sight, so that the scene is open water.
inline Scene OpenWater(const Effects& effects) {
  auto scene = StillScene(0.0, {{Cylinder{{500.0, 0.0}, 0.1, 0.0, 0.1}, {0.5}}});
  scene.effects = effects;
  return scene;
}

inline Sea ChoppySea() { return Sea({{0.25, 9.0, 0.4, 0.3}, {0.12, 5.0, 0.9, 1.0}}); }

inline std::vector<TrueReturn> Look(const Scene& scene, int num_packets, std::uint64_t seed = 1) {
  Lidar lidar(scene, SmallBoat(), LidarParams{}, kEffectsStart, seed);
  std::vector<TrueReturn> returns;
  for (int i = 0; i < num_packets; ++i) {
    const auto packet = lidar.Next();
    returns.insert(returns.end(), packet.returns.begin(), packet.returns.end());
  }
  return returns;
}

inline std::map<ReturnReason, int> CountReasons(const Scene& scene, int num_packets, std::uint64_t seed = 1) {
  std::map<ReturnReason, int> counts;
  for (const auto& made : Look(scene, num_packets, seed)) ++counts[made.reason];
  return counts;
}

}  // namespace lookout::sim
