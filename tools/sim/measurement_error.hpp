// The error of a measurement: white, or one that changes slowly.
#pragma once

#include <cmath>

#include "tools/sim/random.hpp"

namespace lookout::sim {

/// Gauss-Markov process of the first order: its standard deviation is the same at any time, and two errors are correlated by
/// exp(-time between them / time constant). A time constant of 0 makes it white.
/// Source: Brown, Hwang, "Introduction to Random Signals and Applied Kalman Filtering", Wiley, chapter on Markov processes.
class MeasurementError {
 public:
  MeasurementError() = default;  // none
  MeasurementError(double sd, double time_constant_s) : sd_(sd), time_constant_s_(time_constant_s) {}

  /// @param step_s  since the last call, more than 0; the first call takes none of it into account
  double Next(double step_s, Random& random) {
    const double kept = is_first_ ? 0.0 : std::exp(-step_s / time_constant_s_);
    is_first_ = false;
    value_ = kept * value_ + std::sqrt(1.0 - kept * kept) * sd_ * random.Normal();
    return value_;
  }

  double value() const { return value_; }

 private:
  double sd_ = 0.0;
  double time_constant_s_ = 0.0;
  double value_ = 0.0;
  bool is_first_ = true;
};

}  // namespace lookout::sim
