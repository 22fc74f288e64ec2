// Units, sidecars and tables of tests.
#pragma once

#include <string>

#include "tests/support/files.hpp"
#include "tools/archive/file_stamp.hpp"
#include "tools/archive/sidecar.hpp"
#include "tools/archive/unit.hpp"

namespace lookout::archive_test {

inline archive::Recipe AnyRecipe() {
  archive::Recipe recipe;
  recipe.run_digest = "aa";
  recipe.run_kind = "lcm-log";
  recipe.config_digest = "bb";
  recipe.programs_digest = "cc";
  recipe.program_version = "0.1.0";
  recipe.tables = {"tracks", "pose"};
  return recipe;
}

/// A done result with one file. @return its key
inline std::string WriteResult(const archive::ArchiveFolder& folder, const archive::Recipe& recipe, const std::string& text) {
  const auto key = archive::KeyOf(recipe);
  std::filesystem::create_directories(folder.Result(key));
  support::WriteFile(folder.Result(key) / "tracks.csv", text);
  archive::Sidecar sidecar;
  sidecar.recipe = recipe;
  sidecar.is_done = true;
  sidecar.files["tracks.csv"] = {static_cast<std::int64_t>(text.size()), archive::DigestOfText(text)};
  support::WriteFile(folder.Sidecar(key), archive::SidecarText(sidecar));
  return key;
}

}  // namespace lookout::archive_test
