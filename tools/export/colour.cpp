#include "tools/export/colour.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace lookout::exporter {

namespace {

// Hue in turns, saturation and lightness 0 to 1 (CSS Color 4, "hslToRgb").
Rgb FromHsl(double hue, double saturation, double lightness) {
  const double amplitude = saturation * std::min(lightness, 1.0 - lightness);
  const auto channel = [&](double n) {
    const double k = std::fmod(n + hue * 12.0, 12.0);
    const double value = lightness - amplitude * std::clamp(std::min(k - 3.0, 9.0 - k), -1.0, 1.0);
    return static_cast<std::uint8_t>(std::lround(value * 255.0));
  };
  return {channel(0.0), channel(8.0), channel(4.0)};
}

}  // namespace

Rgb ColourOfSegment(int label) {
  // Steps of the golden ratio never come close to a hue of late; lightness tells the next round apart. All are readable on white.
  constexpr double kGoldenRatio = 0.61803398874989485;
  constexpr std::array kLightness{0.42, 0.52, 0.34};
  const double turns = 0.58 + label * kGoldenRatio;
  const auto colour = FromHsl(turns - std::floor(turns), 0.78, kLightness[static_cast<std::size_t>(label) % kLightness.size()]);
  // Yellow and green look brighter than blue of the same lightness (weights: ITU-R BT.601).
  constexpr double kMaxLuma = 140.0;
  const double luma = 0.299 * colour.red + 0.587 * colour.green + 0.114 * colour.blue;
  const double scale = std::min(1.0, kMaxLuma / luma);
  const auto dimmed = [scale](std::uint8_t value) { return static_cast<std::uint8_t>(std::lround(value * scale)); };
  return {dimmed(colour.red), dimmed(colour.green), dimmed(colour.blue)};
}

Rgb ColourOfReason(std::string_view reason) {
  if (reason == "own_vessel") return {200, 148, 96};
  if (reason == "too_small") return {148, 156, 168};
  if (reason == "shadowed") return {170, 182, 196};
  return {198, 204, 212};
}

}  // namespace lookout::exporter
