// The surface of the water: a few long-crested waves, each with its own direction.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "config/schema/scene.pb.h"
#include "lab/sim/random.hpp"

namespace lookout::sim {

/// One train of waves of small steepness on deep water.
struct WaveTrain {
  double amplitude_m;
  double wavelength_m;
  double to_rad;  // direction to which the wave runs, clockwise from north
  double phase_rad;
};

class Sea {
 public:
  Sea() = default;  // calm
  explicit Sea(const std::vector<WaveTrain>& trains);

  /// Trains whose standard deviation together is a quarter of the significant height; calm when that is 0.
  static Sea Draw(const config::Scene::SeaState& state, Random& random);

  /// @param p_map_m  east, north
  /// @return up from the calm water
  double HeightM(const Eigen::Vector2d& p_map_m, double time_s) const;

  /// @return derivative of HeightM to the east and to the north
  Eigen::Vector2d Slope(const Eigen::Vector2d& p_map_m, double time_s) const;

  /// @return unit vector to where the waves run, by their heights; zero when calm
  Eigen::Vector2d Towards() const;

  bool is_calm() const { return terms_.empty(); }

  /// No crest is higher, no trough deeper.
  double max_height_m() const {
    double sum_m = 0.0;
    for (const auto& term : terms_) sum_m += std::abs(term.amplitude_m);
    return sum_m;
  }

 private:
  // amplitude x sin(wave_number . p - rate t + phase)
  struct Term {
    double amplitude_m;
    Eigen::Vector2d wave_number_radpm;
    double rate_radps;
    double phase_rad;
  };
  std::vector<Term> terms_;
};

}  // namespace lookout::sim
