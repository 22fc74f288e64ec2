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

// @param numbers  of these, where more are known than the chart can show
std::string FigureOfLines(const LineChart& chart, const std::string& note, const LineChart& numbers) {
  return "<figure><figcaption>" + Escape(chart.title) + "</figcaption>\n" + DrawLines(chart) + LegendOfLines(chart.lines) +
         (note.empty() ? "" : "<p>" + Escape(note) + "</p>\n") + Numbers(numbers) + "</figure>\n";
}

// Those with the highest mean mIoU, best first; no more than `max_count`, and none that looks at a part of the turn alone.
std::vector<const MethodResult*> BestMethods(const Results& results, std::size_t max_count) {
  std::vector<const MethodResult*> best;
  for (const auto& method : results.methods) {
    if (!HasPartialView(method) && std::isfinite(MeanOverScenes(results, method, IouPercent))) best.push_back(&method);
  }
  std::ranges::stable_sort(best, std::ranges::greater(), [&](const MethodResult* method) { return MeanOverScenes(results, *method, IouPercent); });
  best.resize(std::min(max_count, best.size()));
  return best;
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

// A figure by range: a chart that can be read, and the numbers of all.
template <typename Value>
std::string FigureByRange(const Results& results, std::map<int, std::pair<std::int64_t, Value>> Score::*bins, const std::string& title,
                          const std::string& y_label) {
  LineChart all{title, "range of the object's nearest return, m (middle of the bin)", y_label, {}, true};
  LineChart chart = all;
  // One colour each.
  const auto best = BestMethods(results, kNumSeriesColours - 1);
  for (const auto& method : results.methods) {
    LineChart::Line line{method.method, {}, IsOurs(method)};
    LineChart::Line often = line;
    const auto total = Total(method, bins);
    std::int64_t num_object_scans = 0;
    for (const auto& [bin, entry] : total) num_object_scans += entry.first;
    for (const auto& [bin, entry] : total) {
      if (entry.first == 0) continue;
      const std::pair point((bin + 0.5) * Score::kRangeBinM, 100.0 * static_cast<double>(entry.second) / static_cast<double>(entry.first));
      line.points.push_back(point);
      // One object that happens to be far off would draw a peak.
      constexpr std::int64_t kLeastPartsOfAll = 100;
      if (kLeastPartsOfAll * entry.first >= num_object_scans) often.points.push_back(point);
    }
    if (line.points.empty()) continue;
    if (IsOurs(method) || std::ranges::find(best, &method) != best.end()) chart.lines.push_back(std::move(often));
    all.lines.push_back(std::move(line));
  }
  if (all.lines.empty()) return "";
  const bool is_less = chart.lines.size() < all.lines.size();
  return FigureOfLines(chart,
                       std::string(is_less ? "Drawn are ours and the methods of the highest mean mIoU; the numbers below are of all. " : "") +
                           "Bins with less than a hundredth of the object-turns are not drawn.",
                       all);
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
  HtmlTable table(
      "With and without a step, over all scenes",
      {{"method"}, {"mIoU, %"}, {"components a turn"}, {"segments a turn"}, {"false segments a turn"}, {"median, ms"}, {"99th percentile, ms"}});
  BarChart chart{"Time of a turn with and without a step", "median, ms", {"median"}, {}, 2};
  BarChart components{"Components of a turn before they are clustered", "components a turn", {"components"}, {}, 0};
  for (const auto& method : results.methods) {
    if (!bases.contains(method.method) && BaseOf(method.method).empty()) continue;
    const auto times = TimesOf(method);
    table.Add({{method.method},
               {Number(MeanOverScenes(results, method, IouPercent), 1)},
               {Number(MeanOverScenes(results, method, ComponentsPerScan), 1)},
               {Number(MeanOverScenes(results, method, SegmentsPerScan), 1)},
               {Number(MeanOverScenes(results, method, FalseSegmentsPerScan), 2)},
               {Number(times.median_ms, 2)},
               {Number(times.p99_ms, 2)}});
    chart.groups.push_back({method.method, {times.median_ms}});
    components.groups.push_back({method.method, {MeanOverScenes(results, method, ComponentsPerScan)}});
  }
  return table.Markup() + FigureOfBars(chart) + FigureOfBars(components) +
         "<p class=\"note\">In print: with breadth-first search 72 ms and 460 components, without 297 ms and 1604.</p>\n";
}

std::string Curves(const Results& results) {
  std::string markup;
  for (const auto& curve : results.curves) {
    LineChart chart{curve.title, curve.x_label, curve.y_label, {}, false};
    for (const auto& line : curve.lines) chart.lines.push_back({line.name, line.points, false});
    markup += FigureOfLines(chart, curve.scans_from.empty() ? curve.note : "On " + curve.scans_from + ". " + curve.note, chart);
  }
  return markup;
}

std::string ByRange(const Results& results) {
  return FigureByRange(results, &Score::iou_by_range, "IoU by range, all scenes", "mean IoU, %") +
         FigureByRange(results, &Score::recall_by_range, "Recall at IoU 0.5 by range, all scenes", "recall, %");
}

std::string Bars(const Results& results) {
  if (results.methods.empty()) return "";
  BarChart overall{"mIoU, mean over the scenes", "mIoU, %", {"all objects", "objects in the water"}, {}, 1};
  for (const auto& method : results.methods) {
    overall.groups.push_back({method.method, {MeanOverScenes(results, method, IouPercent), MeanOverScenes(results, method, WaterIouPercent)}});
  }

  // More bars a scene would not be read.
  constexpr std::size_t kMaxBestMethods = 4;
  const auto best = BestMethods(results, kMaxBestMethods);
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
         "is drawn round a segment whose object has a better one: it is a piece (of more than a hundred, round the larger ones). Segments that hold "
         "no object at all are outlined and dotted in the "
         "colour "
         "of this text. Grey: returns of no object on the left, in no segment on the right, and on both sides what the method does not look "
         "at.</p>\n" +
         markup;
}

}  // namespace lookout::eval::page
