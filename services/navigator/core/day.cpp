#include "services/navigator/core/day.hpp"

#include <algorithm>
#include <charconv>

namespace lookout::navigator {

using std::chrono::sys_days;

std::optional<sys_days> ParseDay(std::string_view text) {
  constexpr std::string_view kForm = "dddd-dd-dd";
  const bool has_form = text.size() == kForm.size() && std::equal(text.begin(), text.end(), kForm.begin(), [](char letter, char form) {
                          return form == 'd' ? letter >= '0' && letter <= '9' : letter == form;
                        });
  if (!has_form) return std::nullopt;
  const auto number = [](std::string_view digits) {
    int value = 0;
    std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return value;
  };
  const auto year = number(text.substr(0, 4));
  const auto day = std::chrono::year(year) / std::chrono::month(static_cast<unsigned>(number(text.substr(5, 2)))) /
                   std::chrono::day(static_cast<unsigned>(number(text.substr(8, 2))));
  constexpr int kMinYear = 1970;
  constexpr int kMaxYear = 2199;
  if (!day.ok() || year < kMinYear || year > kMaxYear) return std::nullopt;
  return sys_days(day);
}

}  // namespace lookout::navigator
