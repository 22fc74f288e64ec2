// Evidence of the lookout method from its text: config/schema/evidence.proto.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "services/segmenter/core/lookout/evidence.hpp"

namespace lookout::segmenter {

/// @param layouts  the method's sums; the file must hold each of them, of the same features in any order, and no other
/// @return [layouts]
/// @throws config::ConfigError with every fault
std::vector<Evidence> LoadEvidence(const std::filesystem::path& file, std::span<const EvidenceLayout> layouts);

}  // namespace lookout::segmenter
