#include "tools/eval/html_worst_turn.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "tools/eval/html.hpp"
#include "tools/eval/method.hpp"
#include "tools/eval/plot.hpp"
#include "tools/eval/table.hpp"

namespace lookout::eval {
namespace {

using Spot = ScatterFromAbove::Spot;

struct Return {
  Spot spot;
  std::int32_t object;
  std::int32_t label;
};

bool IsConsistent(const WorstScan& turn) {
  const auto& scan = turn.truth.scan;
  const std::size_t cells_per_column = scan.head.rings.size() * static_cast<std::size_t>(scan.head.num_returns);
  const std::size_t num_cells = scan.columns.azimuth_rad.size() * cells_per_column;
  return scan.num_cells() == num_cells && turn.truth.object.size() == num_cells && turn.label.size() == num_cells;
}

std::vector<Return> ReturnsOf(const WorstScan& turn) {
  const auto& scan = turn.truth.scan;
  std::vector<Return> returns;
  std::size_t cell = 0;
  for (const float column_azimuth_rad : scan.columns.azimuth_rad) {
    for (const auto& ring : scan.head.rings) {
      const double azimuth_rad = double{column_azimuth_rad} + double{ring.azimuth_offset_rad};
      for (int i = 0; i < scan.head.num_returns; ++i, ++cell) {
        if (scan.columns.range[cell] == 0) continue;
        const double distance_m = scan.columns.range[cell] * scan.head.range_unit_m * std::cos(double{ring.elevation_rad});
        const Spot spot{distance_m * std::sin(azimuth_rad), distance_m * std::cos(azimuth_rad)};
        // What the method was told not to look at belongs to nobody here.
        const bool is_scored = turn.label[cell] != kNotScored;
        returns.push_back({spot, is_scored ? turn.truth.object[cell] : kNoTrueObject, std::max(0, turn.label[cell])});
      }
    }
  }
  return returns;
}

struct TrueObject {
  std::int32_t id = 0;
  int number = 0;  // in the plans, from 1
  std::int64_t num_returns = 0;
  double bearing_rad = 0.0;
  double iou = 0.0;
  std::int32_t best_label = 0;  // 0 = none
  std::int64_t num_pieces = 0;  // segments that hold some of it

  std::string css_class() const { return "s" + std::to_string((number - 1) % kNumSeriesColours); }
};

struct Segment {
  std::int64_t num_returns = 0;
  std::int32_t object = 0;  // that it shares most returns with; 0 = none
  std::int64_t num_shared = 0;
};

// The turn as it is drawn.
struct Match {
  std::vector<Return> returns;
  std::vector<TrueObject> objects;  // by number
  std::map<std::int32_t, Segment> segments;

  const TrueObject* Find(std::int32_t id) const {
    const auto found = std::ranges::find(objects, id, &TrueObject::id);
    return found == objects.end() ? nullptr : &*found;
  }
};

Match MatchTurn(const WorstScan& turn) {
  Match match;
  match.returns = ReturnsOf(turn);
  std::map<std::int32_t, std::map<std::int32_t, std::int64_t>> shared;  // object, label
  std::map<std::int32_t, Spot> sums;
  for (const auto& one : match.returns) {
    if (one.label > 0) ++match.segments[one.label].num_returns;
    if (one.object <= 0) continue;
    ++shared[one.object][one.label];
    sums[one.object].first += one.spot.first;
    sums[one.object].second += one.spot.second;
  }
  for (const auto& [id, by_label] : shared) {
    TrueObject object;
    object.id = id;
    object.bearing_rad = std::atan2(sums[id].first, sums[id].second);
    for (const auto& [label, count] : by_label) object.num_returns += count;
    for (const auto& [label, count] : by_label) {
      if (label == 0) continue;
      ++object.num_pieces;
      auto& segment = match.segments[label];
      const double iou = static_cast<double>(count) / static_cast<double>(object.num_returns + segment.num_returns - count);
      if (iou > object.iou) {
        object.iou = iou;
        object.best_label = label;
      }
      if (count > segment.num_shared) {
        segment.num_shared = count;
        segment.object = id;
      }
    }
    match.objects.push_back(object);
  }
  std::ranges::stable_sort(match.objects, {}, &TrueObject::bearing_rad);
  for (std::size_t i = 0; i < match.objects.size(); ++i) match.objects[i].number = static_cast<int>(i) + 1;
  return match;
}

// Andrew's monotone chain: counter-clockwise from the leftmost.
std::vector<Spot> ConvexHull(std::vector<Spot> spots) {
  std::ranges::sort(spots);
  spots.erase(std::unique(spots.begin(), spots.end()), spots.end());
  if (spots.size() < 3) return spots;
  const auto turns_left = [](const Spot& a, const Spot& b, const Spot& c) {
    return (b.first - a.first) * (c.second - a.second) - (b.second - a.second) * (c.first - a.first) > 0.0;
  };
  std::vector<Spot> hull;
  const auto grow = [&](const Spot& spot, std::size_t fixed) {
    while (hull.size() >= fixed + 2 && !turns_left(hull[hull.size() - 2], hull.back(), spot)) hull.pop_back();
    hull.push_back(spot);
  };
  for (const auto& spot : spots) grow(spot, 0);
  const std::size_t lower = hull.size() - 1;
  for (auto spot = spots.rbegin() + 1; spot != spots.rend(); ++spot) grow(*spot, lower);
  hull.pop_back();
  return hull;
}

ScatterFromAbove::Label LabelOver(std::string text, const std::vector<Spot>& spots) {
  return {std::move(text), *std::ranges::max_element(spots, {}, [](const Spot& spot) { return std::pair(spot.second, -spot.first); })};
}

// All of one colour together.
class Painter {
 public:
  void AddDots(const std::string& css_class, const std::vector<Spot>& spots) {
    auto& all = dots_[css_class];
    all.insert(all.end(), spots.begin(), spots.end());
  }
  void AddOutline(const std::string& css_class, bool is_dashed, std::vector<Spot> corners) {
    outlines_[{css_class, is_dashed}].push_back(std::move(corners));
  }

  void PaintOn(ScatterFromAbove& plan) const {
    // By name, loose dots come before those of the objects, but those of false segments too: these must lie above.
    for (const bool is_false : {false, true}) {
      for (const auto& [css_class, spots] : dots_) {
        if ((css_class == kFalse) == is_false) plan.dots.push_back({css_class, spots});
      }
    }
    for (const auto& [key, rings] : outlines_) plan.outlines.push_back({key.first, key.second, rings});
  }

  static constexpr std::string_view kFalse = "false";
  static constexpr std::string_view kLoose = "loose";

 private:
  std::map<std::string, std::vector<Spot>> dots_;
  std::map<std::pair<std::string, bool>, std::vector<std::vector<Spot>>> outlines_;
};

ScatterFromAbove PlanOfTruth(const Match& match) {
  std::map<std::int32_t, std::vector<Spot>> spots;
  for (const auto& one : match.returns) spots[std::max(0, one.object)].push_back(one.spot);
  ScatterFromAbove plan;
  plan.title = "Truth from above";
  Painter painter;
  painter.AddDots(std::string(Painter::kLoose), spots[0]);
  for (const auto& object : match.objects) {
    painter.AddDots(object.css_class(), spots[object.id]);
    plan.labels.push_back(LabelOver(std::to_string(object.number), spots[object.id]));
  }
  painter.PaintOn(plan);
  return plan;
}

// Where an object is cut into hundreds of pieces, outlines of the large ones say enough.
std::int64_t LeastReturnsOfOutline(const Match& match, const std::map<std::int32_t, std::string>& numbers) {
  constexpr std::size_t kMaxOutlines = 100;
  std::vector<std::int64_t> num_returns;
  for (const auto& [label, segment] : match.segments) {
    if (segment.object != 0 && !numbers.contains(label)) num_returns.push_back(segment.num_returns);
  }
  std::ranges::sort(num_returns, std::ranges::greater());
  return num_returns.size() > kMaxOutlines ? num_returns[kMaxOutlines] + 1 : 1;
}

ScatterFromAbove PlanOfPrediction(const Match& match) {
  std::map<std::int32_t, std::vector<Spot>> spots;
  for (const auto& one : match.returns) spots[one.label].push_back(one.spot);
  std::map<std::int32_t, std::string> numbers;  // of the objects whose best segment it is
  for (const auto& object : match.objects) {
    if (object.best_label == 0) continue;
    auto& text = numbers[object.best_label];
    text += (text.empty() ? "" : "+") + std::to_string(object.number);
  }
  ScatterFromAbove plan;
  plan.title = "Prediction from above";
  Painter painter;
  painter.AddDots(std::string(Painter::kLoose), spots[0]);
  const std::int64_t least_returns = LeastReturnsOfOutline(match, numbers);
  for (const auto& [label, segment] : match.segments) {
    const auto* object = match.Find(segment.object);
    const auto css_class = object == nullptr ? std::string(Painter::kFalse) : object->css_class();
    painter.AddDots(css_class, spots[label]);
    const auto number = numbers.find(label);
    if (number != numbers.end()) {
      plan.labels.push_back(LabelOver(number->second, spots[label]));
    } else if (object == nullptr || segment.num_returns >= least_returns) {
      painter.AddOutline(css_class, object != nullptr, ConvexHull(spots[label]));
    }
  }
  painter.PaintOn(plan);
  return plan;
}

// What both plans show: the boat, all objects and all segments, with some water around; neither a strip nor a tower.
std::pair<Spot, Spot> ExtentOf(const Match& match) {
  Spot min_m{0.0, 0.0};
  Spot max_m{0.0, 0.0};
  for (const auto& one : match.returns) {
    if (one.object <= 0 && one.label == 0) continue;
    min_m = {std::min(min_m.first, one.spot.first), std::min(min_m.second, one.spot.second)};
    max_m = {std::max(max_m.first, one.spot.first), std::max(max_m.second, one.spot.second)};
  }
  constexpr double kMargin = 0.06;
  constexpr double kMinMarginM = 3.0;
  constexpr double kLeastHeightOfWidth = 0.6;
  const double width_m = max_m.first - min_m.first;
  const double height_m = max_m.second - min_m.second;
  const double margin_m = std::max(kMinMarginM, kMargin * std::max(width_m, height_m));
  const double more_width_m = std::max(0.0, height_m - width_m) / 2.0 + margin_m;
  const double more_height_m = std::max(0.0, kLeastHeightOfWidth * width_m - height_m) / 2.0 + margin_m;
  return {{min_m.first - more_width_m, min_m.second - more_height_m}, {max_m.first + more_width_m, max_m.second + more_height_m}};
}

std::string TableOfObjects(const Match& match, const std::map<std::int32_t, ScanObject>& known) {
  constexpr std::size_t kMaxRows = 6;
  auto objects = match.objects;
  std::ranges::stable_sort(objects, {}, &TrueObject::iou);
  const std::size_t num_rows = std::min(kMaxRows, objects.size());
  HtmlTable table(num_rows < objects.size()
                      ? "The " + std::to_string(num_rows) + " of " + std::to_string(objects.size()) + " objects that came off worst"
                      : "All objects, worst first",
                  {{"No."}, {"object"}, {"kind"}, {"returns"}, {"segments that hold some"}, {"IoU %"}});
  for (std::size_t i = 0; i < num_rows; ++i) {
    const auto found = known.find(objects[i].id);
    const bool is_known = found != known.end();
    table.Add({{std::to_string(objects[i].number)},
               {is_known ? found->second.name : "?"},
               {is_known ? found->second.kind : "?"},
               {Number(objects[i].num_returns)},
               {Number(objects[i].num_pieces)},
               {Number(objects[i].iou * 100.0, 1)}});
  }
  return table.empty() ? "" : table.Markup();
}

}  // namespace

std::string FigureOfWorstTurn(const WorstScan& turn, const std::string& method) {
  std::string caption = method + ": " + turn.scene + ", seed " + std::to_string(turn.seed) + ", turn " + std::to_string(turn.index) + ", mIoU " +
                        Number(turn.iou * 100.0, 1) + " %";
  if (!IsConsistent(turn)) {
    return "<figure><figcaption>" + Escape(caption) +
           "</figcaption>\n<p>Not drawn: the turn, its truth and its labels differ in size.</p></figure>\n";
  }
  const Match match = MatchTurn(turn);
  const auto num_false = std::ranges::count_if(match.segments, [](const auto& entry) { return entry.second.object == 0; });
  caption += "; " + std::to_string(match.objects.size()) + " objects, " + std::to_string(match.segments.size()) + " segments, of these " +
             std::to_string(num_false) + " false";

  auto truth = PlanOfTruth(match);
  auto prediction = PlanOfPrediction(match);
  const auto [min_m, max_m] = ExtentOf(match);
  truth.min_m = prediction.min_m = min_m;
  truth.max_m = prediction.max_m = max_m;
  return "<figure class=\"pair\"><figcaption>" + Escape(caption) + "</figcaption>\n<div class=\"side\"><p>Truth</p>\n" + DrawFromAbove(truth) +
         "</div>\n<div class=\"side\"><p>Prediction</p>\n" + DrawFromAbove(prediction) + "</div>\n" + TableOfObjects(match, turn.truth.objects) +
         "</figure>\n";
}

}  // namespace lookout::eval
