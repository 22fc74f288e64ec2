// Scenes from files: NAME.txtpb in the schema config/schema/scene.proto.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lab/sim/scene.hpp"

namespace lookout::sim {

/// Where scenes are looked for by name, in this order: the folder `scenes` in the boat's config folder and beside it; `scenes` and `config/scenes` in
/// each folder above; `config/scenes` and `share/lookout/config/scenes` in each folder above the program; the source tree and the package of the
/// build.
///
/// @param program  path of the program that runs; may be empty
std::vector<std::filesystem::path> SceneFolders(const std::filesystem::path& config_folder, const std::filesystem::path& program);

/// A scene by name, in the first of SceneFolders that holds it.
///
/// @param name_or_path  a name, or the path of a file that ends in .txtpb
/// @throws config::ConfigError when there is none; it names those that there are, and where it looked
std::filesystem::path FindScene(const std::string& name_or_path, const std::filesystem::path& config_folder);

struct SceneSummary {
  std::string name;
  std::string description;  // one line: its purpose
};

/// Scenes that FindScene finds by name, sorted, without families.
///
/// @throws config::ConfigError for a file that is wrong
std::vector<SceneSummary> ListScenes(const std::filesystem::path& config_folder);

/// Families, sorted: scenes whose things are all drawn, in the folder `families` of the scenes' folders.
std::vector<SceneSummary> ListFamilies(const std::filesystem::path& config_folder);

/// @param seed  draws waves, shores, trees and whatever the file gives as a range
/// @throws config::ConfigError with file, line and reason; also when a drawn object finds no place, or when the own boat comes closer than 1.5 m to
///         an object within 60 s
Scene LoadScene(const std::filesystem::path& file, std::uint64_t seed);

/// Scene from text; `name` stands in for the path in faults.
Scene ParseScene(const std::string& text, const std::string& name, std::uint64_t seed);

}  // namespace lookout::sim
