// Conditions on figures: compare --fail-if "miou_drop > 0.5".
#pragma once

#include <map>
#include <optional>
#include <string>

namespace lookout::archive {

/// Figures of a comparison by name; nullopt: not known.
using Figures = std::map<std::string, std::optional<double>>;

struct Condition {
  enum class Relation { kGreater, kAtLeast, kLess, kAtMost, kEqual, kNotEqual };
  std::string figure;
  Relation relation = Relation::kGreater;
  double value = 0;
};

/// @throws std::invalid_argument for a text that is not "FIGURE > NUMBER" (or >=, <, <=, ==, !=)
Condition ParseCondition(const std::string& text);

/// @throws std::invalid_argument for a figure that there is none of, naming those that there are, and for one that is not known
bool Holds(const Condition& condition, const Figures& figures);

}  // namespace lookout::archive
