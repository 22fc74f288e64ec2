#include "tools/export/csv.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <iterator>

#include "common/core/angles.hpp"
#include "common/core/printable.hpp"

namespace lookout::exporter {

namespace {

constexpr std::array<double, 10> kPowerOf10{1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9};

// Above it a double holds no fraction.
constexpr double kLargestExactInteger = 9007199254740992.0;

void AppendShortest(double value, std::string& text) {
  std::array<char, 400> digits{};  // the longest double without exponent has 1 + 309 digits, or 2 + 324 + 17
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed).ptr;
  text.append(digits.data(), end);
}

// value / 10^decimals
void AppendScaled(std::int64_t value, int decimals, std::string& text) {
  const auto unit = static_cast<std::int64_t>(kPowerOf10[static_cast<std::size_t>(decimals)]);
  const auto magnitude = std::abs(value);
  fmt::format_to(std::back_inserter(text), "{}{}", value < 0 ? "-" : "", magnitude / unit);
  if (decimals > 0) fmt::format_to(std::back_inserter(text), ".{:0{}}", magnitude % unit, decimals);
}

}  // namespace

void AppendCell(std::int64_t value, std::string& text) { fmt::format_to(std::back_inserter(text), "{}", value); }

void AppendCell(const Fixed& number, std::string& text) {
  if (!std::isfinite(number.value)) return;
  const double scaled = std::round(number.value * kPowerOf10[static_cast<std::size_t>(number.decimals)]);
  if (std::abs(scaled) < kLargestExactInteger) {
    AppendScaled(static_cast<std::int64_t>(scaled), number.decimals, text);
  } else {
    AppendShortest(number.value, text);
  }
}

void AppendCell(const Shortest& number, std::string& text) {
  if (std::isfinite(number.value)) AppendShortest(number.value == 0.0 ? 0.0 : number.value, text);  // no "-0"
}

void AppendCell(const Direction& direction, std::string& text) {
  if (!std::isfinite(direction.angle_rad)) return;
  // Rounding may reach the full circle, which is 0 again.
  const auto scaled = static_cast<std::int64_t>(std::round(RadToDeg(WrapTo2Pi(direction.angle_rad)) * 1e4));
  AppendScaled(scaled % 3'600'000, 4, text);
}

void AppendCell(std::string_view value, std::string& text) { text += CsvText(value); }

}  // namespace lookout::exporter
