// Recipes as JSON: in sidecars and in lists of units.
#pragma once

#include <nlohmann/json.hpp>

#include "tools/archive/unit.hpp"

namespace lookout::archive {

nlohmann::json RecipeJson(const Recipe& recipe);

/// @throws nlohmann::json::exception, std::runtime_error for JSON that is no recipe of this format
Recipe RecipeOfJson(const nlohmann::json& json);

}  // namespace lookout::archive
