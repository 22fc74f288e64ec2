// The file of weights of SqueezeSeg: the first line of the input is NAME.json, the rest NAME.f16. What it takes must be what a network can compute
// with.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "lab/learned/network.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto end = text.find('\n');
  const auto payload = end == std::string::npos ? std::string() : text.substr(end + 1);
  try {
    const auto weights = lookout::learned::ParseWeights(text.substr(0, end), payload);
    if (weights.values.size() != payload.size() / 2) std::abort();
    for (const float deviation : weights.deviation) {
      if (!std::isfinite(deviation) || deviation <= 0.0F) std::abort();
    }
    const lookout::learned::Network network(weights);
  } catch (const std::runtime_error&) {
  }
  return 0;
}
