// The trained parameters of SqueezeSeg, as squeezeseg.py writes them.
#pragma once

#include <array>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "lab/learned/views.hpp"

namespace lookout::learned {

struct Weights {
  std::vector<float> values;  // of all layers, in the order of squeezeseg.py
  std::array<float, kNumChannels> mean{};
  std::array<float, kNumChannels> deviation{};
  std::set<std::string> trained_on;  // names of families
};

/// Reads NAME.json and NAME.f16 beside it (16-bit floats).
///
/// @throws std::runtime_error "file: reason": a file cannot be read, a member is missing or of another type, a number is not finite or a deviation
/// not
///         positive, the digest is that of other weights
Weights ReadWeights(const std::filesystem::path& json_file);

}  // namespace lookout::learned
