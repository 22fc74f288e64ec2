#include "services/navigator/core/day.hpp"

#include <regex>
#include <string>

namespace lookout::navigator {

std::optional<std::chrono::sys_days> ParseDay(std::string_view text) {
  static const std::regex kForm("(19[7-9][0-9]|2[01][0-9]{2})-([0-9]{2})-([0-9]{2})");
  std::cmatch match;
  if (!std::regex_match(text.begin(), text.end(), match, kForm)) return std::nullopt;
  const auto number = [&match](std::size_t group) { return std::stoi(match[group].str()); };
  const auto day = std::chrono::year(number(1)) / number(2) / number(3);
  if (!day.ok()) return std::nullopt;
  return std::chrono::sys_days(day);
}

}  // namespace lookout::navigator
