// A bird's-eye view of the surroundings of the boat, drawn as SVG. Knows nothing of messages.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/export/colour.hpp"

namespace lookout::exporter {

/// A place in the picture: metres to the right of and above its middle.
struct Spot {
  double right_m;
  double up_m;
};

struct Dots {
  Rgb colour{};
  std::vector<Spot> spots;
};

struct Outline {
  Rgb colour{};
  std::string name;           // stands beside it
  std::string facts;          // stands in the legend
  std::vector<Spot> corners;  // one or two are drawn as a point or a line
  double distance_m = 0.0;    // of its nearest point; the legend begins with the nearest
  bool is_tentative = false;  // drawn lightly, behind the others in the legend
  bool is_line = false;       // open, not filled
};

struct LegendLine {
  Rgb colour;
  std::string text;
};

/// Where the bow is, and how large the boat.
struct BoatShape {
  double bow_rad = 0.0;      // from the picture's upward direction, clockwise
  double min_right_m = 0.0;  // box around the boat, bow up, from the middle of the picture
  double max_right_m = 0.0;
  double min_up_m = 0.0;
  double max_up_m = 0.0;
  bool has_size = false;  // else a small mark stands for it
};

struct Picture {
  std::string title;
  std::vector<std::string> subtitles;  // at most two lines
  std::string outlines_title;          // stands over the outlines in the legend
  std::string up;                      // what is above: "N", "bow", "lidar x"
  std::optional<BoatShape> boat;       // nullopt: only the lidar is known
  std::vector<Dots> dots;              // in the order of drawing
  std::vector<Outline> outlines;
  std::vector<LegendLine> legend;  // of what is no outline
};

/// @return a whole SVG document of 1320 x 1000 pixels; the same text for the same picture
std::string DrawSvg(const Picture& picture);

}  // namespace lookout::exporter
