// Weights without meaning, for tests.
#pragma once

#include <cstddef>
#include <random>
#include <string>

#include "common/bus/schema.hpp"
#include "lab/learned/weights.hpp"

namespace lookout::learned::test {

/// Of the published network with three classes (squeezeseg.py prints as many).
inline constexpr std::size_t kNumWeights = 905'749;

/// Numbers from -0.15 to 0.15 without a pattern, the same each time.
inline Weights AnyWeights(std::size_t count = kNumWeights) {
  Weights weights;
  weights.values.reserve(count);
  std::minstd_rand random;
  for (std::size_t i = 0; i < count; ++i) weights.values.push_back(0.3F * (static_cast<float>(random()) / static_cast<float>(random.max()) - 0.5F));
  weights.mean = {20.0F, 0.0F, 1.0F, 0.1F, 25.0F};
  weights.deviation = {16.0F, 13.0F, 3.0F, 0.1F, 18.0F};
  return weights;
}

inline std::string AboutOf(const std::string& payload, const std::string& deviation = "[16, 13, 3, 0.1, 18]") {
  bus::Sha256 sha256;
  sha256.Add(payload.data(), payload.size());
  return R"({"mean": [20, 0, 1, 0.1, 25], "deviation": )" + deviation + R"(, "trained_on": ["beach", "rough"], "weights_sha256": ")" +
         sha256.Finish() + "\"}";
}

}  // namespace lookout::learned::test
