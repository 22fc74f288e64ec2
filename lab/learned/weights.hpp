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

/// @param about    the text of NAME.json
/// @param payload  the bytes of NAME.f16: floats of 16 bits
/// @throws std::runtime_error with the reason: a member is missing or of another type, a number is not finite or a deviation not positive, the digest
///         belongs to other weights
Weights ParseWeights(const std::string& about, const std::string& payload);

/// Reads NAME.json and NAME.f16 beside it. @throws std::runtime_error "file: reason" as ParseWeights, or where a file cannot be read
Weights ReadWeights(const std::filesystem::path& json_file);

}  // namespace lookout::learned
