// DrawFromAbove of plot.hpp.
#include <algorithm>
#include <cmath>
#include <vector>

#include "tools/eval/html.hpp"
#include "tools/eval/plot.hpp"
#include "tools/eval/table.hpp"

namespace lookout::eval {
namespace {

// Wide enough that a whole number places a dot, half a pixel on a usual screen: this keeps pages with many turns small.
constexpr double kWidth = 920.0;
constexpr double kRingOfOneDot = 9.0;

using Spot = ScatterFromAbove::Spot;
using Place = std::pair<int, int>;

class Plan {
 public:
  Plan(const Spot& min_m, const Spot& max_m)
      : min_m_(min_m), max_m_(max_m), scale_(kWidth / (max_m.first - min_m.first)), height_((max_m.second - min_m.second) * scale_) {}

  double scale() const { return scale_; }
  double height() const { return height_; }
  bool Contains(const Spot& spot) const {
    return spot.first >= min_m_.first && spot.first <= max_m_.first && spot.second >= min_m_.second && spot.second <= max_m_.second;
  }
  Place At(const Spot& spot) const { return {Round((spot.first - min_m_.first) * scale_), Round((max_m_.second - spot.second) * scale_)}; }

 private:
  static int Round(double value) { return static_cast<int>(std::lround(value)); }

  Spot min_m_;
  Spot max_m_;
  double scale_;
  double height_;
};

std::string Text(const Place& place) { return std::to_string(place.first) + " " + std::to_string(place.second); }

std::string Circle(std::string_view css_class, const Place& centre, double radius) {
  return "<circle class=\"" + std::string(css_class) + "\" cx=\"" + std::to_string(centre.first) + "\" cy=\"" + std::to_string(centre.second) +
         "\" r=\"" + Number(radius, 1) + "\"/>\n";
}

std::string Words(std::string_view css_class, const Place& place, std::string_view text) {
  return "<text class=\"" + std::string(css_class) + "\" x=\"" + std::to_string(place.first) + "\" y=\"" + std::to_string(place.second) + "\">" +
         Escape(text) + "</text>\n";
}

// Rings of range around the sensor, each with its metres where the plan shows a place for it.
std::string Rings(const Plan& plan, const Spot& min_m, const Spot& max_m) {
  const double reach_m = std::hypot(std::max(std::abs(min_m.first), std::abs(max_m.first)), std::max(std::abs(min_m.second), std::abs(max_m.second)));
  const double step_m = reach_m > 80.0 ? 20.0 : reach_m > 30.0 ? 10.0 : 5.0;
  std::string svg;
  for (double radius_m = step_m; radius_m < reach_m; radius_m += step_m) {
    svg += Circle("grid", plan.At({0.0, 0.0}), radius_m * plan.scale());
    for (const Spot& spot : {Spot{0.0, radius_m}, Spot{0.0, -radius_m}, Spot{radius_m, 0.0}, Spot{-radius_m, 0.0}}) {
      if (!plan.Contains(spot)) continue;
      svg += Words("ring", plan.At(spot), Number(radius_m, 0) + " m");
      break;
    }
  }
  return svg;
}

std::string Boat(const Plan& plan) {
  const auto [x, y] = plan.At({0.0, 0.0});
  return "<path class=\"boat\" d=\"M" + Text({x, y - 14}) + "l9 24h-18z\"/>\n";
}

std::string DrawOutline(const Plan& plan, const ScatterFromAbove::Outline& outline) {
  const std::string css_class = "outline " + outline.css_class + (outline.is_dashed ? " dashed" : "");
  if (outline.corners.empty()) return "";
  if (outline.corners.size() == 1) return Circle(css_class, plan.At(outline.corners.front()), kRingOfOneDot);
  std::string path;
  for (const auto& corner : outline.corners) path += (path.empty() ? "M" : "L") + Text(plan.At(corner));
  return "<path class=\"" + css_class + "\" d=\"" + path + "z\"/>\n";
}

}  // namespace

std::string DrawFromAbove(const ScatterFromAbove& plan) {
  const Plan view(plan.min_m, plan.max_m);
  std::string svg = "<svg class=\"plan\" viewBox=\"0 0 " + Number(kWidth, 0) + " " + Number(view.height(), 0) + "\" role=\"img\">\n<title>" +
                    Escape(plan.title) + "</title>\n" + Rings(view, plan.min_m, plan.max_m);
  for (const auto& dots : plan.dots) {
    std::vector<Place> places;
    for (const auto& spot : dots.spots) {
      if (view.Contains(spot)) places.push_back(view.At(spot));
    }
    std::ranges::sort(places);
    places.erase(std::unique(places.begin(), places.end()), places.end());
    if (places.empty()) continue;
    svg += "<path class=\"dots " + dots.css_class + "\" d=\"";
    for (const auto& place : places) svg += "M" + Text(place) + "h0";
    svg += "\"/>\n";
  }
  for (const auto& outline : plan.outlines) svg += DrawOutline(view, outline);
  svg += Boat(view);
  constexpr int kAbove = 12;  // of the spot that it names
  for (const auto& label : plan.labels) {
    if (!view.Contains(label.spot)) continue;
    const auto [x, y] = view.At(label.spot);
    svg += Words("label", {x, y - kAbove}, label.text);
  }
  return svg + "</svg>\n";
}

}  // namespace lookout::eval
