// Sections of the report page that are mostly plots, or small tables with one.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "tools/eval/html.hpp"
#include "tools/eval/html_worst_turn.hpp"
#include "tools/eval/plot.hpp"
#include "tools/eval/report_html_sections.hpp"
#include "tools/eval/table.hpp"

namespace lookout::eval::page {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// The numbers of a line chart, folded away.
std::string Numbers(const LineChart& chart) {
  std::set<double> places;
  for (const auto& line : chart.lines) {
    for (const auto& [x, y] : line.points) {
      if (std::isfinite(x)) places.insert(x);
    }
  }
  std::vector<HtmlTable::Heading> headings{{chart.x_label}};
  for (const auto& line : chart.lines) headings.push_back({line.name, chart.lines.size() > 4});
  HtmlTable table(chart.y_label, std::move(headings));
  for (const double place : places) {
    std::vector<HtmlCell> row{{Number(place, 2)}};
    for (const auto& line : chart.lines) {
      const auto found = std::ranges::find(line.points, place, &std::pair<double, double>::first);
      row.push_back({found == line.points.end() ? "-" : Number(found->second, 2)});
    }
    table.Add(std::move(row));
  }
  return "<details><summary>Numbers</summary>\n" + table.Markup() + "</details>\n";
}

std::string FigureOfLines(const LineChart& chart, const std::string& note) {
  return "<figure><figcaption>" + Escape(chart.title) + "</figcaption>\n" + DrawLines(chart) + LegendOfLines(chart.lines) +
         (note.empty() ? "" : "<p>" + Escape(note) + "</p>\n") + Numbers(chart) + "</figure>\n";
}

std::string FigureOfBars(const BarChart& chart) {
  return "<figure><figcaption>" + Escape(chart.title) + "</figcaption>\n" + DrawBars(chart) +
         (chart.series.size() > 1 ? LegendOfBars(chart.series) : "") + "</figure>\n";
}

// Sums of all scenes by bin of range.
template <typename Value>
std::map<int, std::pair<std::int64_t, Value>> Total(const MethodResult& method, std::map<int, std::pair<std::int64_t, Value>> Score::*bins) {
  std::map<int, std::pair<std::int64_t, Value>> total;
  for (const auto& [scene, score] : method.by_scene) {
    for (const auto& [bin, entry] : score.*bins) {
      total[bin].first += entry.first;
      total[bin].second += entry.second;
    }
  }
  return total;
}

template <typename Value>
LineChart ChartByRange(const Results& results, std::map<int, std::pair<std::int64_t, Value>> Score::*bins, const std::string& title,
                       const std::string& y_label) {
  LineChart chart{title, "range of the object's nearest return, m (middle of the bin)", y_label, {}, true};
  for (const auto& method : results.methods) {
    LineChart::Line line{method.method, {}, IsOurs(method)};
    for (const auto& [bin, entry] : Total(method, bins)) {
      if (entry.first == 0) continue;
      line.points.emplace_back((bin + 0.5) * Score::kRangeBinM, 100.0 * static_cast<double>(entry.second) / static_cast<double>(entry.first));
    }
    if (!line.points.empty()) chart.lines.push_back(std::move(line));
  }
  return chart;
}

// Those of the segmenter in the order of its work, then others by name.
std::vector<std::string> StagesOf(const MethodResult& method) {
  std::vector<std::string> stages;
  for (const auto* stage : {"project", "search", "cluster", "measure"}) {
    if (method.stage_ms.contains(stage)) stages.emplace_back(stage);
  }
  for (const auto& [stage, time_ms] : method.stage_ms) {
    if (std::ranges::find(stages, stage) == stages.end()) stages.push_back(stage);
  }
  return stages;
}

// "paper W=512" of "paper W=512 without BFS"; empty for any other.
std::string BaseOf(const std::string& method) {
  const auto at = method.find(kWithout);
  return at == std::string::npos ? "" : method.substr(0, at);
}

}  // namespace

std::string TableThree(const Results& results) {
  HtmlTable table("Table III: time of a turn by stage, over all scenes, ms",
                  {{"method"}, {"stage"}, {"median"}, {"99th percentile"}, {"mean"}, {"sd"}});
  const auto add = [&table](const std::string& method, const std::string& stage, const Times& times, const std::string& css_class) {
    table.Add({{method, css_class},
               {stage, css_class},
               {Number(times.median_ms, 3), css_class},
               {Number(times.p99_ms, 3), css_class},
               {Number(times.mean_ms, 3), css_class},
               {Number(times.sd_ms, 3), css_class}});
  };
  for (const auto& method : results.methods) {
    if (method.stage_ms.empty()) continue;
    for (const auto& stage : StagesOf(method)) add(method.method, stage, TimesOf(method.stage_ms.at(stage)), "");
    add(method.method, "whole turn", TimesOf(method), "total");
  }
  if (table.empty()) return "";
  return table.Markup() +
         "<p class=\"note\">In print: 35 ms (sd 8 to 15) a scan on a laptop, 37 ms on the boat, 21 ms with a field of view of 90 degrees.</p>\n";
}

std::string Ablation(const Results& results) {
  std::set<std::string> bases;
  for (const auto& method : results.methods) {
    if (const auto base = BaseOf(method.method); !base.empty()) bases.insert(base);
  }
  if (bases.empty()) return "";
  HtmlTable table("With and without a step, over all scenes",
                  {{"method"}, {"mIoU, %"}, {"segments a turn"}, {"false segments a turn"}, {"median, ms"}, {"99th percentile, ms"}});
  BarChart chart{"Time of a turn with and without a step", "median, ms", {"median"}, {}, 2};
  for (const auto& method : results.methods) {
    if (!bases.contains(method.method) && BaseOf(method.method).empty()) continue;
    const auto times = TimesOf(method);
    table.Add({{method.method},
               {Number(MeanOverScenes(results, method, IouPercent), 1)},
               {Number(MeanOverScenes(results, method, SegmentsPerTurn), 1)},
               {Number(MeanOverScenes(results, method, FalseSegmentsPerTurn), 2)},
               {Number(times.median_ms, 2)},
               {Number(times.p99_ms, 2)}});
    chart.groups.push_back({method.method, {times.median_ms}});
  }
  return table.Markup() + FigureOfBars(chart) +
         "<p class=\"note\">In print: with breadth-first search 72 ms and 460 components, without 297 ms and 1604.</p>\n";
}

std::string Curves(const Results& results) {
  std::string markup;
  for (const auto& curve : results.curves) {
    LineChart chart{curve.title, curve.x_label, curve.y_label, {}, false};
    for (const auto& line : curve.lines) chart.lines.push_back({line.name, line.points, false});
    markup += FigureOfLines(chart, curve.note);
  }
  return markup;
}

std::string ByRange(const Results& results) {
  std::string markup;
  const auto iou = ChartByRange(results, &Score::iou_by_range, "IoU by range, all scenes", "mean IoU, %");
  if (!iou.lines.empty()) markup += FigureOfLines(iou, "");
  const auto recall = ChartByRange(results, &Score::recall_by_range, "Recall at IoU 0.5 by range, all scenes", "recall, %");
  if (!recall.lines.empty()) markup += FigureOfLines(recall, "");
  return markup;
}

std::string Bars(const Results& results) {
  if (results.methods.empty()) return "";
  BarChart overall{"mIoU, mean over the scenes", "mIoU, %", {"all objects", "objects in the water"}, {}, 1};
  for (const auto& method : results.methods) {
    overall.groups.push_back({method.method, {MeanOverScenes(results, method, IouPercent), MeanOverScenes(results, method, WaterIouPercent)}});
  }

  // More bars a scene would not be read.
  constexpr std::size_t kMaxBestMethods = 4;
  std::vector<const MethodResult*> best;
  for (const auto& method : results.methods) {
    if (std::isfinite(MeanOverScenes(results, method, IouPercent))) best.push_back(&method);
  }
  std::ranges::stable_sort(best, std::ranges::greater(), [&](const MethodResult* method) { return MeanOverScenes(results, *method, IouPercent); });
  best.resize(std::min(kMaxBestMethods, best.size()));
  BarChart by_scene{"mIoU by scene, the methods of the highest mean", "mIoU, %", {}, {}, 1};
  for (const auto* method : best) by_scene.series.push_back(method->method);
  for (const auto& scene : results.scenes) {
    BarChart::Group group{scene, {}};
    for (const auto* method : best) {
      const auto found = method->by_scene.find(scene);
      group.values.push_back(found == method->by_scene.end() ? kNone : IouPercent(found->second));
    }
    by_scene.groups.push_back(std::move(group));
  }
  return FigureOfBars(overall) + (best.empty() || results.scenes.empty() ? "" : FigureOfBars(by_scene));
}

std::string WorstTurns(const Results& results) {
  std::string markup;
  for (const auto& method : results.methods) {
    for (const auto& turn : method.worst) markup += FigureOfWorstTurn(turn, method.method);
  }
  if (markup.empty()) return "";
  return "<p>Seen from above, bow up; the triangle is the boat, rings give the range. A number is an object of the truth, and in the prediction "
         "stands at the "
         "segment that fits it best; 3+4 is one segment that fits two. A segment has the colour of the object that it shares most returns with. A "
         "dashed line "
         "is drawn round a segment whose object has a better one: it is a piece. Segments that hold no object at all are outlined and dotted in the "
         "colour "
         "of this text. Grey: returns of no object on the left, in no segment on the right, and on both sides what the method does not look "
         "at.</p>\n" +
         markup;
}

}  // namespace lookout::eval::page
