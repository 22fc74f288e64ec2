// Colours of segments, and of returns in no segment: one id has one colour in every picture.
#pragma once

#include <cstdint>
#include <string_view>

namespace lookout::exporter {

struct Rgb {
  std::uint8_t red;
  std::uint8_t green;
  std::uint8_t blue;
};

/// @param label  1.. ; neighbours in number are far apart in hue
Rgb ColourOfSegment(int label);

/// @param reason  word of the reason; empty = not labelled
Rgb ColourOfReason(std::string_view reason);

}  // namespace lookout::exporter
