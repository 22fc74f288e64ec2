// Numbers in words, for people.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

namespace lookout::doctor {

/// "1.50"; never "-0.00".
inline std::string Text(double value, int num_decimals) {
  const double step = std::pow(10.0, num_decimals);
  const double rounded = std::round(value * step) / step + 0.0;  // + 0.0 makes a zero of minus zero
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", num_decimals, rounded);
  return text.data();
}

inline std::string Count(std::int64_t count, const std::string& noun) { return std::to_string(count) + " " + noun + (count == 1 ? "" : "s"); }

/// "a, b, c".
template <typename Range, typename ToText>
std::string Joined(const Range& range, const ToText& to_text) {
  std::string text;
  for (const auto& item : range) text += (text.empty() ? "" : ", ") + to_text(item);
  return text;
}

}  // namespace lookout::doctor
