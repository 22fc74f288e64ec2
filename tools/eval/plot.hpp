// Plots as inline SVG for an HTML page. They stand alone but for the colours: classes s0 to s6 (colour of a series), "axis", "grid" and the like,
// which the style of the page defines for light, dark and paper.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace lookout::eval {

/// Series beyond this many repeat a colour, with another marker: 35 look different from each other.
inline constexpr int kNumSeriesColours = 7;

struct LineChart {
  struct Line {
    std::string name;
    std::vector<std::pair<double, double>> points;  // in the order of x; one that is not a number breaks the line
    bool is_bold = false;
  };
  std::string title;  // read aloud, not drawn
  std::string x_label;
  std::string y_label;
  std::vector<Line> lines;
  bool has_percent_axis = false;  // y from 0 to 100; else from the points
};

/// Rows of bars that lie: one group after the other, in it one bar a series.
struct BarChart {
  struct Group {
    std::string name;
    std::vector<double> values;  // [series] >= 0; not a number = a dash and no bar
  };
  std::string title;
  std::string x_label;
  std::vector<std::string> series;
  std::vector<Group> groups;
  int num_decimals = 1;  // of the number at the end of each bar
};

/// A plan seen from above, bow up. Spots are (right, up) in metres; the sensor stands at (0, 0).
struct ScatterFromAbove {
  using Spot = std::pair<double, double>;
  struct Dots {
    std::string css_class;  // "s0" to "s6", "loose", "false"; once each keeps the page small
    std::vector<Spot> spots;
  };
  struct Outlines {
    std::string css_class;
    bool is_dashed = false;
    std::vector<std::vector<Spot>> rings;  // corners of each; one: a square around it; two: a line
  };
  struct Label {
    std::string text;
    Spot spot;
  };
  std::string title;
  std::vector<Dots> dots;  // the first lies below
  std::vector<Outlines> outlines;
  std::vector<Label> labels;
  Spot min_m{-10.0, -10.0};  // corners of what is seen
  Spot max_m{10.0, 10.0};
};

/// Each gives markup (<svg>...</svg>); the same input, the same bytes. Texts are escaped. A chart without a single number says so.
std::string DrawLines(const LineChart& chart);
std::string DrawBars(const BarChart& chart);
std::string DrawFromAbove(const ScatterFromAbove& plan);

/// A list that says which colour and marker is which series of DrawLines or DrawBars.
std::string LegendOfLines(const std::vector<LineChart::Line>& lines);
std::string LegendOfBars(const std::vector<std::string>& series);

}  // namespace lookout::eval
