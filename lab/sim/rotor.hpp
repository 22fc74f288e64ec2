// The turning of a lidar's head.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "common/core/angles.hpp"
#include "lab/sim/motion.hpp"
#include "lab/sim/random.hpp"

namespace lookout::sim {

class Rotor {
 public:
  Rotor(double rotation_rpm, std::uint64_t seed) {
    constexpr std::uint64_t kRotorStream = 2;
    Random random(seed, kRotorStream);
    phase_rad_ = random.Uniform(0.0, kTwoPi);
    // Captures of real sensors show 601 to 607 rpm where 600 were asked for, and some hundredths of a degree of wander within a revolution.
    rate_radps_ = rotation_rpm / 60.0 * kTwoPi * (1.0 + 0.001 * random.Normal());
    for (const double amplitude_deg : {0.10, 0.04, 0.02}) {
      const double period_s = random.Uniform(0.3, 1.0) * amplitude_deg * 10.0;
      wander_rad_.push_back({DegToRad(amplitude_deg), period_s, random.Uniform(0.0, kTwoPi)});
    }
  }

  /// Clockwise, not wrapped. It turns at the mean rate with slow variations about it, so errors do not add up.
  double AzimuthAt(double time_s) const {
    double azimuth_rad = phase_rad_ + rate_radps_ * time_s;
    for (const auto& wave : wander_rad_) azimuth_rad += wave.amplitude * std::sin(kTwoPi * time_s / wave.period_s + wave.phase_rad);
    return azimuth_rad;
  }

  double mean_rate_radps() const { return rate_radps_; }

 private:
  std::vector<Wave> wander_rad_;
  double phase_rad_ = 0.0;
  double rate_radps_ = 0.0;
};

}  // namespace lookout::sim
