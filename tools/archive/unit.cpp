#include "tools/archive/unit.hpp"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/core/printable.hpp"
#include "tools/archive/file_stamp.hpp"
#include "tools/archive/index.hpp"
#include "tools/archive/path_text.hpp"
#include "tools/archive/recipe_json.hpp"

namespace lookout::archive {

namespace {

nlohmann::json ToJson(const std::optional<std::int64_t>& time) { return time ? nlohmann::json(*time) : nlohmann::json(nullptr); }

std::optional<std::int64_t> TimeOf(const nlohmann::json& json) {
  if (json.is_null()) return std::nullopt;
  return json.get<std::int64_t>();
}

std::filesystem::path PathOf(const nlohmann::json& json) {
  const auto path = PathOfText(json.get<std::string>());
  if (!path) throw std::runtime_error("a path that is none");
  return *path;
}

}  // namespace

nlohmann::json RecipeJson(const Recipe& recipe) {
  return {{"format", kFormat},
          {"run_digest", recipe.run_digest},
          {"run_kind", recipe.run_kind},
          {"from_us", ToJson(recipe.from_us)},
          {"to_us", ToJson(recipe.to_us)},
          {"truth_digest", recipe.truth_digest},
          {"config_digest", recipe.config_digest},
          {"programs_digest", recipe.programs_digest},
          {"program_version", recipe.program_version},
          {"tables", recipe.tables}};
}

Recipe RecipeOfJson(const nlohmann::json& json) {
  if (json.at("format").get<int>() != kFormat) throw std::runtime_error("of another format");
  Recipe recipe;
  recipe.run_digest = json.at("run_digest").get<std::string>();
  recipe.run_kind = json.at("run_kind").get<std::string>();
  recipe.from_us = TimeOf(json.at("from_us"));
  recipe.to_us = TimeOf(json.at("to_us"));
  recipe.truth_digest = json.at("truth_digest").get<std::string>();
  recipe.config_digest = json.at("config_digest").get<std::string>();
  recipe.programs_digest = json.at("programs_digest").get<std::string>();
  recipe.program_version = json.at("program_version").get<std::string>();
  recipe.tables = json.at("tables").get<std::vector<std::string>>();
  return recipe;
}

std::string RecipeText(const Recipe& recipe) { return RecipeJson(recipe).dump(); }

std::string KeyOf(const Recipe& recipe) { return DigestOfText(RecipeText(recipe)); }

std::string UnitLine(const Unit& unit) {
  nlohmann::json inputs = nlohmann::json::array();
  for (const auto& input : unit.inputs) inputs.push_back({PathText(input.path), input.size_bytes, input.modified_ns});
  const nlohmann::json json{{"key", unit.key},  {"recipe", RecipeJson(unit.recipe)}, {"run", unit.run},
                            {"inputs", inputs}, {"truth", PathText(unit.truth)},     {"programs", PathText(unit.programs)}};
  return json.dump();
}

Unit UnitOfLine(const std::string& line) {
  try {
    const auto json = nlohmann::json::parse(line);
    Unit unit;
    unit.key = json.at("key").get<std::string>();
    unit.recipe = RecipeOfJson(json.at("recipe"));
    unit.run = json.at("run").get<std::string>();
    for (const auto& input : json.at("inputs")) {
      unit.inputs.push_back({PathOf(input.at(0)), input.at(1).get<std::int64_t>(), input.at(2).get<std::int64_t>()});
    }
    unit.truth = PathOf(json.at("truth"));
    unit.programs = PathOf(json.at("programs"));
    if (unit.key != KeyOf(unit.recipe)) throw std::runtime_error("a key that is not that of its recipe");
    return unit;
  } catch (const std::exception& error) {
    throw std::runtime_error("a line of the list of units cannot be used: " + Printable(error.what()));
  }
}

}  // namespace lookout::archive
