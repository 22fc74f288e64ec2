// DrawFromAbove of plot.hpp.
#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "tools/eval/html.hpp"
#include "tools/eval/plot.hpp"
#include "tools/eval/table.hpp"

namespace lookout::eval {
namespace {

// Whole numbers place a dot, a pixel and less on a usual screen: this keeps pages with many turns small.
constexpr double kWidth = 460.0;
// Dots are wider than this, so that those which touch still do.
constexpr int kDotStep = 2;

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
  // For a word.
  bool HasRoomAt(const Spot& spot) const {
    constexpr double kRoom = 16.0;
    const double margin_m = kRoom / scale_;
    return spot.first - min_m_.first >= margin_m && max_m_.first - spot.first >= margin_m && spot.second - min_m_.second >= margin_m &&
           max_m_.second - spot.second >= margin_m;
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
      if (!plan.HasRoomAt(spot)) continue;
      svg += Words("ring", plan.At(spot), Number(radius_m, 0) + " m");
      break;
    }
  }
  return svg;
}

std::string Boat(const Plan& plan) {
  const auto [x, y] = plan.At({0.0, 0.0});
  return "<path class=\"boat\" d=\"M" + Text({x, y - 7}) + "l5 12h-10z\"/>\n";
}

// Numbers of a path, as short as SVG allows: a minus sign parts them as well as a blank.
std::string Pair(int x, int y) { return std::to_string(x) + (y < 0 ? "" : " ") + std::to_string(y); }

// The next subpath of a path. The first "m" of a path is absolute whatever its case, and the others go on from where the one before ended.
class Pen {
 public:
  void MoveTo(const Place& place) {
    path_ += (path_.empty() ? "M" : "m") + Pair(place.first - at_.first, place.second - at_.second);
    at_ = place;
  }
  // Goes on from the last place, or from the first of the subpath where `is_closed`.
  void Draw(std::string_view way, const Place& end) {
    path_ += way;
    at_ = end;
  }
  const Place& at() const { return at_; }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  Place at_{0, 0};
};

// Neighbours in a column or a row become one stroke: round ends make it look as the dots do.
std::string PathOfDots(std::set<Place> places) {
  Pen pen;
  while (!places.empty()) {
    const Place begin = *places.begin();
    const auto reach = [&](const Place& step) {
      int count = 0;
      while (places.contains({begin.first + (count + 1) * step.first, begin.second + (count + 1) * step.second})) ++count;
      return count;
    };
    const int down = reach({0, kDotStep});
    const int aside = reach({kDotStep, 0});
    const Place step = down >= aside ? Place{0, kDotStep} : Place{kDotStep, 0};
    const int count = std::max(down, aside);
    for (int i = 0; i <= count; ++i) places.erase({begin.first + i * step.first, begin.second + i * step.second});
    pen.MoveTo(begin);
    pen.Draw((down >= aside && down > 0 ? "v" : "h") + std::to_string(count * kDotStep),
             {begin.first + count * step.first, begin.second + count * step.second});
  }
  return pen.path();
}

// One corner: a square around it.
void AddOutline(const Plan& plan, const std::vector<Spot>& corners, Pen& pen) {
  std::vector<Place> places;
  for (const auto& corner : corners) {
    const auto place = plan.At(corner);
    if (places.empty() || places.back() != place) places.push_back(place);
  }
  if (places.size() > 1 && places.front() == places.back()) places.pop_back();
  if (places.size() == 1) {
    constexpr int kHalf = 4;
    pen.MoveTo({places[0].first - kHalf, places[0].second - kHalf});
    pen.Draw("h8v8h-8z", pen.at());
    return;
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (i == 0) {
      pen.MoveTo(places[0]);
      continue;
    }
    pen.Draw((i == 1                                  ? "l"
              : places[i].first < places[i - 1].first ? ""
                                                      : " ") +
                 Pair(places[i].first - places[i - 1].first, places[i].second - places[i - 1].second),
             places[i]);
  }
  pen.Draw("z", places[0]);
}

}  // namespace

std::string DrawFromAbove(const ScatterFromAbove& plan) {
  const Plan view(plan.min_m, plan.max_m);
  std::string svg = "<svg class=\"plan\" viewBox=\"0 0 " + Number(kWidth, 0) + " " + Number(view.height(), 0) + "\" role=\"img\">\n<title>" +
                    Escape(plan.title) + "</title>\n" + Rings(view, plan.min_m, plan.max_m);
  for (const auto& dots : plan.dots) {
    std::set<Place> places;
    for (const auto& spot : dots.spots) {
      if (!view.Contains(spot)) continue;
      const auto [x, y] = view.At(spot);
      places.emplace(x - x % kDotStep, y - y % kDotStep);
    }
    if (!places.empty()) svg += "<path class=\"dots " + dots.css_class + "\" d=\"" + PathOfDots(std::move(places)) + "\"/>\n";
  }
  for (const auto& group : plan.outlines) {
    Pen pen;
    for (const auto& corners : group.rings) {
      if (!corners.empty()) AddOutline(view, corners, pen);
    }
    if (pen.path().empty()) continue;
    svg += "<path class=\"outline " + group.css_class + (group.is_dashed ? " dashed" : "") + "\" d=\"" + pen.path() + "\"/>\n";
  }
  svg += Boat(view);
  constexpr int kAbove = 6;  // of the spot that it names
  for (const auto& label : plan.labels) {
    if (!view.Contains(label.spot)) continue;
    const auto [x, y] = view.At(label.spot);
    svg += Words("label", {x, y - kAbove}, label.text);
  }
  return svg + "</svg>\n";
}

}  // namespace lookout::eval
