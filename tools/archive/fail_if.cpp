#include "tools/archive/fail_if.hpp"

#include <array>
#include <regex>
#include <stdexcept>
#include <utility>

#include "common/core/printable.hpp"
#include "tools/archive/csv_reader.hpp"

namespace lookout::archive {

Condition ParseCondition(const std::string& text) {
  using Relation = Condition::Relation;
  static const std::regex kForm(R"(\s*([a-z0-9_.]+)\s*(>=|<=|==|!=|>|<)\s*([-+.0-9eE]+)\s*)");
  static const std::map<std::string, Relation> kRelations{{">", Relation::kGreater}, {">=", Relation::kAtLeast}, {"<", Relation::kLess},
                                                          {"<=", Relation::kAtMost}, {"==", Relation::kEqual},   {"!=", Relation::kNotEqual}};
  std::smatch match;
  if (text.size() > 200 || !std::regex_match(text, match, kForm)) {
    throw std::invalid_argument("--fail-if '" + Printable(text) + "': is not of the form \"miou_drop > 0.5\"");
  }
  std::string number = match[3];
  if (number.front() == '+') number.erase(0, 1);
  const auto value = NumberOf(number);
  if (!value) throw std::invalid_argument("--fail-if '" + Printable(text) + "': " + number + " is no number");
  return {match[1], kRelations.at(match[2]), *value};
}

bool Holds(const Condition& condition, const Figures& figures) {
  const auto place = figures.find(condition.figure);
  if (place == figures.end()) {
    std::string names;
    for (const auto& [name, value] : figures) names += " " + name;
    throw std::invalid_argument("--fail-if: no figure is called " + condition.figure + ". There are:" + names);
  }
  if (!place->second) throw std::invalid_argument("--fail-if: " + condition.figure + " is not known: no run has it under both versions");
  const auto value = *place->second;
  switch (condition.relation) {
    case Condition::Relation::kGreater:
      return value > condition.value;
    case Condition::Relation::kAtLeast:
      return value >= condition.value;
    case Condition::Relation::kLess:
      return value < condition.value;
    case Condition::Relation::kAtMost:
      return value <= condition.value;
    case Condition::Relation::kEqual:
      return value == condition.value;
    case Condition::Relation::kNotEqual:
      return value != condition.value;
  }
  return false;
}

}  // namespace lookout::archive
