// The scenes of the source tree.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lab/sim/scene_file.hpp"
#include "tests/support/files.hpp"

namespace lookout::sim {

/// Sorted.
inline std::vector<std::string> SceneNames() {
  std::vector<std::string> names;
  for (const auto& scene : ListScenes(support::kSources / "config/demo")) names.push_back(scene.name);
  return names;
}

/// @throws config::ConfigError
inline Scene MakeScene(const std::string& name, std::uint64_t seed) {
  return LoadScene(support::kSources / "config/scenes" / (name + ".txtpb"), seed);
}

}  // namespace lookout::sim
