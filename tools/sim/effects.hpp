// What the lidar's beams meet besides clean surfaces, and how strongly. The scene file says it; the defaults are a thin beam over calm water in
// clear air, with a few strays. What each effect is made of, with sources: README.md, "What is simulated".
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace lookout::sim {

enum class ReturnMode { kStrongest, kLast, kDual };

/// Why there is a return. The values are on the wire (sim_truth_t): one may be added at the end, none changes its meaning.
enum class ReturnReason {
  kObject = 0,     // the surface of an object
  kOwnVessel = 1,  // the own boat
  kStray = 2,      // noise of the receiver
  kGlint = 3,      // water near the boat
  kCrest = 4,      // foam on a wave
  kWake = 5,       // foam behind a moving boat
  kSpray = 6,      // drops at the own bow
  kRain = 7,
  kMixedEdge = 8,  // a beam on two surfaces; it belongs to the nearer object
  kMirror = 9,     // an object seen by way of the water's surface, below which it seems to lie
};
inline constexpr std::array<std::string_view, 10> kReasonNames{"object", "own_vessel", "stray", "glint",      "crest",
                                                               "wake",   "spray",      "rain",  "mixed_edge", "mirror"};
constexpr std::string_view NameOf(ReturnReason reason) { return kReasonNames[static_cast<std::size_t>(reason)]; }

/// Strengths. Those that add returns are off at 0.
struct Effects {
  ReturnMode return_mode = ReturnMode::kStrongest;

  // VLP-16 User Manual 63-9243 Rev E: accuracy +/- 3 cm.
  double range_sd_m = 0.025;

  /// Range at which a square diffuse surface of reflectance 0.4 is seen half of the time; darker and flatter ones scale with it. More than 0.
  double half_seen_range_m = 100.0;

  /// Full angles of the beam; a VLP-16 has about 3.0 and 1.5. 0 and 0 = a thin ray that never meets two surfaces.
  double horizontal_divergence_mrad = 0.0;
  double vertical_divergence_mrad = 0.0;

  /// Of a return out of nothing, per shot that meets nothing: 1e-4 gives 2 to 3 a turn over open water.
  double stray_probability = 1e-4;

  /// Of a return from water met at 15 deg to its surface, as the lowest beam meets calm water; steeper beams get more, by the square of the sine.
  /// Few are seen beyond 20 m.
  double glint_probability = 0.0;

  /// Share of the mirrored light that a surface without waves would give (0 to 1): 1 = as still as glass.
  double mirror_strength = 0.0;

  /// Of a return from the upper half of a wave met at a right angle; less by the cosine of the incidence. Needs waves.
  double crest_probability = 0.0;

  /// Of a return from fresh foam in the wake of a boat that moves.
  double wake_probability = 0.0;

  /// Of a return from the cloud at the own bow while it falls with 0.5 m/s or more. Needs a boat that pitches or heaves.
  double spray_probability = 0.0;

  /// Chance of a return from a drop, per metre of beam close to the sensor; it falls to a half at 5 m, to a fifth at 10 m. 0.004 gives a return
  /// in 3 of 100 shots.
  double rain_probability_per_m = 0.0;
};

}  // namespace lookout::sim
