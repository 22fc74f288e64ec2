// Random numbers that are the same on every computer. The distributions of the standard library are not: each library has its own.
#pragma once

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

}  // namespace lookout::sim
