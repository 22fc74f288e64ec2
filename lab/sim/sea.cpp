#include "lab/sim/sea.hpp"

#include <array>
#include <cmath>

#include "common/core/angles.hpp"

namespace lookout::sim {
namespace {

constexpr double kGravityMps2 = 9.80665;  // standard gravity, ISO 80000-3

}  // namespace

Sea::Sea(const std::vector<WaveTrain>& trains) {
  for (const auto& train : trains) {
    const double wave_number_radpm = kTwoPi / train.wavelength_m;
    // Deep water: rate^2 = g x wave number (Lamb, "Hydrodynamics", article 229).
    terms_.push_back({train.amplitude_m, wave_number_radpm * Eigen::Vector2d(std::sin(train.to_rad), std::cos(train.to_rad)),
                      std::sqrt(kGravityMps2 * wave_number_radpm), train.phase_rad});
  }
}

Sea Sea::Draw(const config::Scene::SeaState& state, Random& random) {
  if (state.significant_height_m() <= 0.0) return Sea();
  // Wavelength and amplitude of each train as shares of the middle one: long and short waves about it, so that groups form.
  struct Share {
    double wavelength;
    double amplitude;
  };
  constexpr std::array<Share, 6> kShares{{{1.7, 0.4}, {1.25, 0.8}, {1.0, 1.0}, {0.8, 0.7}, {0.55, 0.4}, {0.35, 0.2}}};
  double sum_squares = 0.0;
  for (const auto& share : kShares) sum_squares += share.amplitude * share.amplitude;
  // A sine of amplitude a has the variance a^2 / 2.
  const double scale_m = state.significant_height_m() / 4.0 / std::sqrt(sum_squares / 2.0);
  std::vector<WaveTrain> trains;
  for (const auto& share : kShares) {
    const double to_rad = DegToRad(state.from_deg()) + kPi + DegToRad(state.spread_deg()) * random.Uniform(-1.0, 1.0);
    trains.push_back({scale_m * share.amplitude, state.wavelength_m() * share.wavelength, to_rad, random.Uniform(0.0, kTwoPi)});
  }
  return Sea(trains);
}

double Sea::HeightM(const Eigen::Vector2d& p_map_m, double time_s) const {
  double height_m = 0.0;
  for (const auto& term : terms_) {
    height_m += term.amplitude_m * std::sin(term.wave_number_radpm.dot(p_map_m) - term.rate_radps * time_s + term.phase_rad);
  }
  return height_m;
}

Eigen::Vector2d Sea::Slope(const Eigen::Vector2d& p_map_m, double time_s) const {
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  for (const auto& term : terms_) {
    slope += term.amplitude_m * std::cos(term.wave_number_radpm.dot(p_map_m) - term.rate_radps * time_s + term.phase_rad) * term.wave_number_radpm;
  }
  return slope;
}

Eigen::Vector2d Sea::Towards() const {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const auto& term : terms_) sum += std::abs(term.amplitude_m) * term.wave_number_radpm.normalized();
  return sum.isZero() ? sum : Eigen::Vector2d(sum.normalized());
}

}  // namespace lookout::sim
