#include "tools/export/selection.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <system_error>

#include "common/core/utime.hpp"
#include "tools/export/map_text.hpp"

namespace lookout::exporter {

namespace {

// The whole text is one number.
template <typename Number>
std::optional<Number> ParseNumber(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

std::optional<Circle> ParseCircle(std::string_view text) {
  std::array<double, 3> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto comma = text.find(',');
    if ((comma == std::string_view::npos) != (i + 1 == numbers.size())) return std::nullopt;
    const auto number = ParseNumber<double>(text.substr(0, comma));
    if (!number || !std::isfinite(*number)) return std::nullopt;
    numbers[i] = *number;
    if (comma != std::string_view::npos) text.remove_prefix(comma + 1);
  }
  const auto [latitude_deg, longitude_deg, radius_m] = numbers;
  if (std::abs(latitude_deg) > 90.0 || std::abs(longitude_deg) > 180.0 || radius_m <= 0.0) return std::nullopt;
  return Circle{{latitude_deg, longitude_deg, 0.0}, radius_m};
}

std::optional<std::int64_t> UtimeUsOf(Bytes message) {
  if (message.size() < kTimeEndBytes) return std::nullopt;
  std::uint64_t bits = 0;
  for (const auto byte : message.subspan(kTimeEndBytes - sizeof(bits), sizeof(bits))) bits = bits << 8U | static_cast<std::uint8_t>(byte);
  return static_cast<std::int64_t>(bits);
}

bool Span::Holds(Bytes message) const {
  const auto utime_us = IsAll() ? std::nullopt : UtimeUsOf(message);
  return !utime_us || ((!from_us || *utime_us >= *from_us) && (!to_us || *utime_us < *to_us));
}

std::string TextOf(const Span& span) {
  if (span.from_us && span.to_us) return fmt::format("between {} and {}", IsoTime(*span.from_us), IsoTime(*span.to_us));
  return span.from_us ? "from " + IsoTime(*span.from_us) + " on" : span.to_us ? "before " + IsoTime(*span.to_us) : "";
}

std::string TextOf(const Circle& circle) {
  return fmt::format("within {:g} m of {}, {}", circle.radius_m, circle.place.latitude_deg, circle.place.longitude_deg);
}

}  // namespace lookout::exporter
