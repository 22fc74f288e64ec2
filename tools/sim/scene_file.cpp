#include "tools/sim/scene_file.hpp"

#include <algorithm>
#include <map>
#include <sstream>

#include "common/config/text_config.hpp"
#include "config/schema/scene.pb.h"
#include "tools/sim/scene_maker.hpp"

namespace lookout::sim {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kExtension = ".txtpb";

fs::path SourceFolder() { return fs::path(LOOKOUT_SCENE_FOLDER); }
fs::path InstalledFolder() { return fs::path(LOOKOUT_INSTALLED_SCENE_FOLDER); }

// By name; what lies beside the boat hides a scene of the source tree, and that one of the package.
std::map<std::string, fs::path> SceneFiles(const fs::path& config_folder) {
  std::map<std::string, fs::path> files;
  // "config/demo/" has an empty last part.
  const fs::path boat = (config_folder / "").lexically_normal().parent_path();
  for (const auto& folder : {boat.parent_path() / "scenes", SourceFolder(), InstalledFolder()}) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      if (entry.path().extension() == kExtension) files.emplace(entry.path().stem().string(), entry.path());
    }
  }
  return files;
}

}  // namespace

fs::path FindScene(const std::string& name_or_path, const fs::path& config_folder) {
  if (name_or_path.ends_with(kExtension)) return name_or_path;
  const auto files = SceneFiles(config_folder);
  const auto found = files.find(name_or_path);
  if (found != files.end()) return found->second;
  std::string names;
  for (const auto& [name, file] : files) names += (names.empty() ? "" : ", ") + name;
  throw config::ConfigError({"--scene: no such scene: " + name_or_path + " (there are: " + names + ")"});
}

std::vector<SceneSummary> ListScenes(const fs::path& config_folder) {
  std::vector<SceneSummary> summaries;
  for (const auto& [name, file] : SceneFiles(config_folder)) {
    config::Scene scene;
    config::LoadText(file, scene);
    summaries.push_back({name, scene.description()});
  }
  return summaries;
}

Scene LoadScene(const fs::path& file, std::uint64_t seed) { return ParseScene(config::ReadConfigFile(file), file.string(), seed); }

Scene ParseScene(const std::string& text, const std::string& name, std::uint64_t seed) {
  config::Scene scene;
  config::ParseText(text, name, scene);
  SceneFaults faults(text, name);
  CheckScene(scene, faults);
  faults.ThrowIfAny();
  return DrawScene(scene, seed, faults);
}

std::vector<std::string> SceneNames() {
  std::vector<std::string> names;
  for (const auto& [name, file] : SceneFiles(SourceFolder())) names.push_back(name);
  return names;
}

std::optional<Scene> MakeScene(std::string_view name, std::uint64_t seed) {
  const fs::path file = SourceFolder() / (std::string(name) + std::string(kExtension));
  if (!fs::exists(file)) return std::nullopt;
  return LoadScene(file, seed);
}

}  // namespace lookout::sim
