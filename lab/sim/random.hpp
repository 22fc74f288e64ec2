// Random numbers and errors that are the same on every computer. Each standard library has distributions of its own.
#pragma once

#include <cmath>
#include <cstdint>

namespace lookout::sim {

/// One stream of numbers. Streams of one seed are independent, so that one part of the simulation does not shift the numbers of another.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t stream) : state_(Mix(seed) ^ Mix(stream + kIncrement)) {}

  /// 64 random bits. Source: Steele, Lea, Flood, "Fast splittable pseudorandom number generators" (SplitMix64), OOPSLA 2014.
  std::uint64_t Next() {
    state_ += kIncrement;
    return Mix(state_);
  }

  /// In [0, 1).
  double Uniform() { return static_cast<double>(Next() >> 11) * 0x1.0p-53; }

  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }

  /// Mean 0, standard deviation 1: the sum of four uniform numbers of 16 bits, scaled. It ends at 3.46 standard deviations and needs no
  /// function of libm.
  double Normal() {
    const std::uint64_t bits = Next();
    const auto sum = static_cast<double>((bits & 0xFFFF) + (bits >> 16 & 0xFFFF) + (bits >> 32 & 0xFFFF) + (bits >> 48));
    constexpr double kMean = 4 * 65535 / 2.0;
    constexpr double kScale = 1.7320508075688772 / 65536.0;  // four uniform numbers of width 65536 have the variance 65536^2 / 3
    return (sum - kMean) * kScale;
  }

 private:
  static constexpr std::uint64_t kIncrement = 0x9E3779B97F4A7C15;

  static constexpr std::uint64_t Mix(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EB;
    return z ^ (z >> 31);
  }

  std::uint64_t state_;
};

/// The error of a measurement: white, or one that changes slowly.
///
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
