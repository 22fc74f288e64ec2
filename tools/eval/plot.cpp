#include "tools/eval/plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "tools/eval/html.hpp"
#include "tools/eval/table.hpp"

namespace lookout::eval {
namespace {

constexpr double kWidthPx = 760.0;
constexpr double kLetterPx = 6.6;  // of the 12 px letters of the page's style, on average and a little more

// Beyond this no axis can be labelled.
bool IsDrawable(double value) { return std::isfinite(value) && std::abs(value) < 1e12; }

std::string Px(double value) { return Number(std::round(value * 10.0) / 10.0 + 0.0, 1); }

std::string SeriesClass(std::size_t index) { return "s" + std::to_string(index % kNumSeriesColours); }

// Steps of 1, 2 or 5 times a power of ten, and ends that are whole steps.
struct Axis {
  double min = 0.0;
  double step = 1.0;
  int num_steps = 1;
  int num_decimals = 0;

  double max() const { return At(num_steps); }
  double At(int index) const { return min + step * index; }
  std::string Label(int index) const { return Number(At(index) + 0.0, num_decimals); }
};

Axis MakeAxis(double min, double max) {
  constexpr double kWishedSteps = 6.0;
  if (max - min <= 1e-9 * std::max(std::abs(min), std::abs(max)) || max <= min) {
    const double margin = std::max(0.5, 0.05 * std::abs(max));
    min -= margin;
    max += margin;
  }
  const double rough = (max - min) / kWishedSteps;
  int exponent = static_cast<int>(std::floor(std::log10(rough)));
  const double unit = std::pow(10.0, exponent);
  double step = unit;
  for (const double factor : {1.0, 2.0, 5.0, 10.0}) {
    step = factor * unit;
    if (step >= rough * (1.0 - 1e-9)) {
      if (factor == 10.0) ++exponent;
      break;
    }
  }
  const double first = std::floor(min / step + 1e-9);
  const double last = std::ceil(max / step - 1e-9);
  return {first * step, step, static_cast<int>(last - first), std::max(0, -exponent)};
}

std::string Text(double x, double y, std::string_view anchor, std::string_view text, std::string_view more = "") {
  return "<text x=\"" + Px(x) + "\" y=\"" + Px(y) + "\" text-anchor=\"" + std::string(anchor) + "\"" + std::string(more) + ">" + Escape(text) +
         "</text>\n";
}

std::string Rule(std::string_view css_class, double x1, double y1, double x2, double y2) {
  return "<path class=\"" + std::string(css_class) + "\" d=\"M" + Px(x1) + " " + Px(y1) + "L" + Px(x2) + " " + Px(y2) + "\"/>\n";
}

std::string Open(double width, double height, std::string_view css_class, std::string_view title) {
  return "<svg class=\"" + std::string(css_class) + "\" viewBox=\"0 0 " + Px(width) + " " + Px(height) + "\" role=\"img\">\n<title>" + Escape(title) +
         "</title>\n";
}

std::string NothingToDraw(const std::string& title) {
  constexpr double kHeightPx = 40.0;
  return Open(kWidthPx, kHeightPx, "chart", title) + Text(kWidthPx / 2.0, kHeightPx / 2.0, "middle", "no numbers") + "</svg>\n";
}

// Five shapes; with seven colours no pair comes twice among 35 series.
std::string Marker(std::size_t index, double x, double y) {
  const std::string open = "<path class=\"marker " + SeriesClass(index) + "\" d=\"M";
  switch (index % 5) {
    case 0:
      return "<circle class=\"marker " + SeriesClass(index) + "\" cx=\"" + Px(x) + "\" cy=\"" + Px(y) + "\" r=\"3\"/>";
    case 1:
      return open + Px(x - 3.0) + " " + Px(y - 3.0) + "h6v6h-6z\"/>";
    case 2:
      return open + Px(x) + " " + Px(y - 4.0) + "l4 7h-8z\"/>";
    case 3:
      return open + Px(x) + " " + Px(y - 4.5) + "l4.5 4.5l-4.5 4.5l-4.5 -4.5z\"/>";
    default:
      return open + Px(x - 3.0) + " " + Px(y - 3.0) + "l6 6m0 -6l-6 6\"/>";
  }
}

std::string LineClass(std::size_t index, bool is_bold) { return "line " + SeriesClass(index) + (is_bold ? " bold" : ""); }

struct Limits {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();

  void Add(double value) {
    min = std::min(min, value);
    max = std::max(max, value);
  }
  bool empty() const { return min > max; }
};

// From zero, but where that would press the lines together at the top.
double BottomOf(double min, double max) { return min > 0.0 && min < 0.5 * max ? 0.0 : min; }

bool IsDrawable(const std::pair<double, double>& point) { return IsDrawable(point.first) && IsDrawable(point.second); }

}  // namespace

std::string DrawLines(const LineChart& chart) {
  Limits x_limits;
  Limits y_limits;
  for (const auto& line : chart.lines) {
    for (const auto& point : line.points) {
      if (!IsDrawable(point)) continue;
      x_limits.Add(point.first);
      y_limits.Add(point.second);
    }
  }
  if (x_limits.empty()) return NothingToDraw(chart.title);

  constexpr double kHeightPx = 330.0;
  constexpr double kTopPx = 12.0;
  constexpr double kBottomPx = kHeightPx - 46.0;
  constexpr double kRightPx = kWidthPx - 16.0;
  const Axis x_axis = MakeAxis(x_limits.min, x_limits.max);
  const Axis y_axis = chart.has_percent_axis ? Axis{0.0, 20.0, 5, 0} : MakeAxis(BottomOf(y_limits.min, y_limits.max), y_limits.max);
  std::size_t label_length = 0;
  for (int i = 0; i <= y_axis.num_steps; ++i) label_length = std::max(label_length, y_axis.Label(i).size());
  const double left_px = 34.0 + kLetterPx * static_cast<double>(label_length);
  const auto to_x = [&](double x) { return left_px + (x - x_axis.min) / (x_axis.max() - x_axis.min) * (kRightPx - left_px); };
  const auto to_y = [&](double y) { return kBottomPx - (y - y_axis.min) / (y_axis.max() - y_axis.min) * (kBottomPx - kTopPx); };

  std::string svg = Open(kWidthPx, kHeightPx, "chart", chart.title);
  for (int i = 0; i <= y_axis.num_steps; ++i) {
    const double y = to_y(y_axis.At(i));
    svg += Rule("grid", left_px, y, kRightPx, y) + Text(left_px - 6.0, y + 4.0, "end", y_axis.Label(i));
  }
  for (int i = 0; i <= x_axis.num_steps; ++i) {
    const double x = to_x(x_axis.At(i));
    svg += Rule("axis", x, kBottomPx, x, kBottomPx + 5.0) + Text(x, kBottomPx + 18.0, "middle", x_axis.Label(i));
  }
  svg += Rule("axis", left_px, kBottomPx, kRightPx, kBottomPx);
  svg += Text((left_px + kRightPx) / 2.0, kHeightPx - 8.0, "middle", chart.x_label);
  const double middle_px = (kTopPx + kBottomPx) / 2.0;
  svg += Text(14.0, middle_px, "middle", chart.y_label, " transform=\"rotate(-90 14 " + Px(middle_px) + ")\"");

  for (std::size_t i = 0; i < chart.lines.size(); ++i) {
    const auto& line = chart.lines[i];
    std::string path;
    std::string markers;
    bool is_pen_down = false;
    for (const auto& point : line.points) {
      if (!IsDrawable(point)) {
        is_pen_down = false;
        continue;
      }
      const double x = to_x(point.first);
      const double y = to_y(point.second);
      path += (is_pen_down ? "L" : "M") + Px(x) + " " + Px(y);
      markers += Marker(i, x, y) + "\n";
      is_pen_down = true;
    }
    if (path.empty()) continue;
    svg += "<path class=\"" + LineClass(i, line.is_bold) + "\" d=\"" + path + "\"/>\n";
    svg += markers;
  }
  return svg + "</svg>\n";
}

std::string DrawBars(const BarChart& chart) {
  constexpr double kBarPx = 12.0;
  constexpr double kGroupGapPx = 8.0;
  constexpr double kTopPx = 8.0;
  constexpr double kAxisPx = 42.0;
  constexpr double kValuePx = 52.0;  // right of the longest bar
  constexpr std::size_t kMaxNameLetters = 44;

  Limits limits;
  std::size_t name_length = 0;
  for (const auto& group : chart.groups) {
    name_length = std::max(name_length, std::min(kMaxNameLetters, group.name.size()));
    for (const double value : group.values) {
      if (IsDrawable(value)) limits.Add(std::max(0.0, value));
    }
  }
  if (limits.empty()) return NothingToDraw(chart.title);

  const double group_px = kBarPx * static_cast<double>(chart.series.size());
  const double bottom_px = kTopPx + (group_px + kGroupGapPx) * static_cast<double>(chart.groups.size());
  // Wider than elsewhere: names are of mixed case and stand at the edge.
  constexpr double kNameLetterPx = 7.4;
  const double left_px = 14.0 + kNameLetterPx * static_cast<double>(name_length);
  const double right_px = kWidthPx - kValuePx;
  const Axis axis = MakeAxis(0.0, limits.max > 0.0 ? limits.max : 1.0);
  const auto to_x = [&](double value) { return left_px + value / axis.max() * (right_px - left_px); };

  std::string svg = Open(kWidthPx, bottom_px + kAxisPx, "chart", chart.title);
  for (int i = 0; i <= axis.num_steps; ++i) {
    const double x = to_x(axis.At(i));
    svg += Rule(i == 0 ? "axis" : "grid", x, kTopPx, x, bottom_px) + Text(x, bottom_px + 15.0, "middle", axis.Label(i));
  }
  svg += Text((left_px + right_px) / 2.0, bottom_px + kAxisPx - 8.0, "middle", chart.x_label);

  double y = kTopPx + kGroupGapPx / 2.0;
  for (const auto& group : chart.groups) {
    std::string name = group.name.substr(0, kMaxNameLetters);
    if (name.size() < group.name.size()) name += "...";
    svg += Text(left_px - 8.0, y + group_px / 2.0 + 4.0, "end", name);
    for (std::size_t i = 0; i < group.values.size(); ++i, y += kBarPx) {
      const bool has_bar = IsDrawable(group.values[i]);
      const double end_px = has_bar ? to_x(std::max(0.0, group.values[i])) : left_px;
      if (has_bar) {
        svg += "<rect class=\"bar " + SeriesClass(i) + "\" x=\"" + Px(left_px) + "\" y=\"" + Px(y + 1.0) + "\" width=\"" + Px(end_px - left_px) +
               "\" height=\"" + Px(kBarPx - 2.0) + "\"/>\n";
      }
      svg += Text(end_px + 5.0, y + kBarPx - 2.0, "start", Number(group.values[i], chart.num_decimals), " class=\"small\"");
    }
    y += kGroupGapPx;
  }
  return svg + "</svg>\n";
}

std::string LegendOfLines(const std::vector<LineChart::Line>& lines) {
  std::string markup = "<ul class=\"legend\">\n";
  for (std::size_t i = 0; i < lines.size(); ++i) {
    markup += "<li><svg class=\"key\" viewBox=\"0 0 30 12\" aria-hidden=\"true\"><path class=\"" + LineClass(i, lines[i].is_bold) +
              "\" d=\"M1 6h28\"/>" + Marker(i, 15.0, 6.0) + "</svg> " + Escape(lines[i].name) + "</li>\n";
  }
  return markup + "</ul>\n";
}

std::string LegendOfBars(const std::vector<std::string>& series) {
  std::string markup = "<ul class=\"legend\">\n";
  for (std::size_t i = 0; i < series.size(); ++i) {
    markup += "<li><svg class=\"key\" viewBox=\"0 0 30 12\" aria-hidden=\"true\"><rect class=\"bar " + SeriesClass(i) +
              "\" x=\"2\" y=\"1\" width=\"26\" height=\"10\"/></svg> " + Escape(series[i]) + "</li>\n";
  }
  return markup + "</ul>\n";
}

}  // namespace lookout::eval
