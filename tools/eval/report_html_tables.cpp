// Sections of the report page that are mostly tables.
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "tools/eval/against_peers.hpp"
#include "tools/eval/html.hpp"
#include "tools/eval/metrics.hpp"
#include "tools/eval/plot.hpp"
#include "tools/eval/report_html_sections.hpp"
#include "tools/eval/table.hpp"

namespace lookout::eval::page {
namespace {

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

double Ratio(double part, double whole) { return whole > 0.0 ? part / whole : kNoValue; }

const Score* Find(const MethodResult& method, const std::string& scene) {
  const auto found = method.by_scene.find(scene);
  return found == method.by_scene.end() ? nullptr : &found->second;
}

double FigureOf(const MethodResult& method, const std::string& scene, const Figure& figure) {
  const auto* score = Find(method, scene);
  return score == nullptr ? kNoValue : figure(*score);
}

// The darker, the better; for shares of 100 only.
std::string ShadeOf(double percent) { return std::isfinite(percent) ? "h" + std::to_string(std::clamp(static_cast<int>(percent / 10.0), 0, 9)) : ""; }

// Of the methods that look all round.
double BestOf(const Results& results, const std::function<double(const MethodResult&)>& figure) {
  double best = kNoValue;
  for (const auto& method : results.methods) {
    if (HasPartialView(method)) continue;
    const double value = figure(method);
    if (std::isfinite(value) && !(value <= best)) best = value;
  }
  return best;
}

// Methods whose figure is printed the same stand on one rank.
struct Ranked {
  double value = 0.0;
  std::vector<std::string> names;

  std::string Names() const {
    std::string text;
    for (const auto& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
  }
};

// Greatest first; methods without the figure are left out.
std::vector<Ranked> Rank(const Results& results, const std::function<double(const MethodResult&)>& figure, int num_decimals) {
  std::vector<std::pair<double, std::string>> entries;
  for (const auto& method : results.methods) {
    const double value = figure(method);
    if (std::isfinite(value)) entries.emplace_back(value, method.method);
  }
  std::ranges::stable_sort(entries, std::ranges::greater(), &std::pair<double, std::string>::first);
  std::vector<Ranked> ranks;
  for (const auto& [value, name] : entries) {
    if (ranks.empty() || Number(ranks.back().value, num_decimals) != Number(value, num_decimals)) ranks.push_back({value, {}});
    ranks.back().names.push_back(name);
  }
  return ranks;
}

// Ours, and those beside it.
std::vector<const Results*> WorldsOf(const Results& results) {
  std::vector<const Results*> worlds{&results};
  for (const auto& world : results.other_worlds) worlds.push_back(&world);
  return worlds;
}

// Methods in rows; the mean over scenes and each scene in columns, one world beside the other; the greatest of a column in bold.
HtmlTable SceneTable(const Results& results, const std::string& caption, const Figure& figure, int num_decimals, bool is_percent) {
  std::vector<HtmlTable::Heading> headings{{"method"}};
  const auto worlds = WorldsOf(results);
  for (const auto* world : worlds) {
    const auto title = [world](const std::string& scene) { return world->world.empty() ? scene : world->world + ": " + scene; };
    headings.push_back({world->is_here ? title("mean") : title("not here"), true});
    for (const auto& scene : world->scenes) headings.push_back({title(scene), true});
  }
  HtmlTable table(caption, std::move(headings));
  const auto cell = [&](double value, double best, bool takes_part) -> HtmlCell {
    if (!is_percent) return {Number(value, num_decimals)};
    const bool is_best = std::isfinite(value) && takes_part && Number(value, num_decimals) == Number(best, num_decimals);
    return {Number(value, num_decimals), ShadeOf(value) + (is_best ? " best" : "")};
  };
  for (std::size_t i = 0; i < results.methods.size(); ++i) {
    std::vector<HtmlCell> row{{results.methods[i].method, IsOurs(results.methods[i]) ? "ours" : ""}};
    for (const auto* world : worlds) {
      if (!world->is_here) {
        row.push_back({"-"});
        continue;
      }
      const auto& method = world->methods.at(i);
      const bool takes_part = !HasPartialView(method);
      row.push_back(cell(MeanOverScenes(*world, method, figure),
                         BestOf(*world, [&](const MethodResult& other) { return MeanOverScenes(*world, other, figure); }), takes_part));
      for (const auto& scene : world->scenes) {
        row.push_back(cell(FigureOf(method, scene, figure), BestOf(*world, [&](const MethodResult& other) { return FigureOf(other, scene, figure); }),
                           takes_part));
      }
    }
    table.Add(std::move(row));
  }
  return table;
}

std::string OfWorld(const Results& results) { return results.world.empty() ? "" : results.world + ": "; }

std::string KindTable(const Results& results) {
  std::set<std::string> kinds;
  for (const auto& method : results.methods) {
    for (const auto& [scene, score] : method.by_scene) {
      for (const auto& [kind, sum] : score.iou_by_kind) kinds.insert(kind);
    }
  }
  if (kinds.empty()) return "";
  std::vector<HtmlTable::Heading> headings{{"method"}};
  for (const auto& kind : kinds) headings.push_back({kind, true});
  HtmlTable table(OfWorld(results) + "Mean IoU by kind of object, over all scenes, %", std::move(headings));
  for (const auto& method : results.methods) {
    std::vector<HtmlCell> row{{method.method, IsOurs(method) ? "ours" : ""}};
    for (const auto& kind : kinds) {
      double sum = 0.0;
      std::int64_t count = 0;
      for (const auto& [scene, score] : method.by_scene) {
        const auto found = score.iou_by_kind.find(kind);
        if (found == score.iou_by_kind.end()) continue;
        count += found->second.first;
        sum += found->second.second;
      }
      const double percent = 100.0 * Ratio(sum, static_cast<double>(count));
      row.push_back({Number(percent, 1), ShadeOf(percent)});
    }
    table.Add(std::move(row));
  }
  return table.Markup();
}

std::string CutTable(const Results& results) {
  if (results.methods.empty()) return "";
  HtmlTable table(OfWorld(results) + "Cut and merged objects, over all scenes",
                  {{"method"}, {"segments a turn"}, {"over-segmented objects, %"}, {"under-segmenting segments, %"}, {"true positives, %"}});
  for (const auto& method : results.methods) {
    Score total;
    for (const auto& [scene, score] : method.by_scene) total.Add(score);
    table.Add({{method.method, IsOurs(method) ? "ours" : ""},
               {Number(SegmentsPerScan(total), 1)},
               {Number(100.0 * OverSegmentedShare(total), 1)},
               {Number(100.0 * UnderSegmentedShare(total), 1)},
               {Number(100.0 * TruePositiveRatio(total), 1)}});
  }
  return table.Markup();
}

// In two lines, so that all scenes fit beside each other.
HtmlCell MedianAndP99(const Times& times) {
  if (times.num_scans == 0) return {"-"};
  return {Number(times.median_ms, 2) + "\n" + Number(times.p99_ms, 2), "two"};
}

}  // namespace

double IouPercent(const Score& score) { return 100.0 * MeanIou(score); }
double WaterIouPercent(const Score& score) { return 100.0 * MeanWaterIou(score); }

Times TimesOf(const std::vector<double>& time_ms) {
  eval::Summary summary;
  double squares = 0.0;
  for (const double value : time_ms) {
    if (std::isfinite(value)) summary.Add(value);
  }
  if (summary.count() == 0) return {0, kNoValue, kNoValue, kNoValue, kNoValue};
  const double mean_ms = summary.Mean();
  for (const double value : time_ms) {
    if (std::isfinite(value)) squares += (value - mean_ms) * (value - mean_ms);
  }
  return {summary.count(), summary.Median(), summary.Percentile(99), mean_ms, std::sqrt(squares / static_cast<double>(summary.count()))};
}

Times TimesOf(const MethodResult& method) {
  std::vector<double> time_ms;
  for (const auto& [scene, score] : method.by_scene) time_ms.insert(time_ms.end(), score.time_ms.begin(), score.time_ms.end());
  return TimesOf(time_ms);
}

bool IsOurs(const MethodResult& method) { return method.method.rfind("ours", 0) == 0 && method.method.find(kWithout) == std::string::npos; }

std::string Summary(const Results& results) {
  // Methods that look ahead only have an easier task, and do not take part.
  const auto mean_iou = [&](const MethodResult& method) { return HasPartialView(method) ? kNoValue : MeanOverScenes(results, method, IouPercent); };
  const auto overall = Rank(results, mean_iou, 1);
  if (overall.empty()) return "<p>No method was judged on a scene with objects.</p>\n";

  std::string text = "Highest mean mIoU over the scenes: " + overall[0].Names() + " with " + Number(overall[0].value, 1) + " %";
  if (overall.size() > 1) text += ", before " + overall[1].Names() + " with " + Number(overall[1].value, 1) + " %";
  text += ".";
  // Who finds nothing has no false segments and is fast.
  const auto is_of_use = [&](const MethodResult& method) { return mean_iou(method) >= overall[0].value / 2.0; };
  const auto false_segments = Rank(
      results, [&](const MethodResult& method) { return is_of_use(method) ? MeanOverScenes(results, method, FalseSegmentsPerScan) : kNoValue; }, 2);
  const auto times = Rank(
      results, [&](const MethodResult& method) { return is_of_use(method) ? TimesOf(method).median_ms : kNoValue; }, 2);
  if (!false_segments.empty() || !times.empty()) text += " Of the methods with half of that or more:";
  if (!false_segments.empty()) {
    text += " fewest false segments " + false_segments.back().Names() + ", " + Number(false_segments.back().value, 2) + " a turn;";
  }
  if (!times.empty()) text += " fastest " + times.back().Names() + ", " + Number(times.back().value, 2) + " ms a turn (median)";
  if (text.back() == ';') text.pop_back();
  if (text.back() != '.') text += ".";

  HtmlTable table("The best method of each scene by mIoU, %, of those that look all round",
                  {{"scene"}, {"best"}, {"mIoU"}, {"next"}, {"mIoU"}, {"ahead by"}});
  std::vector<std::pair<std::string, int>> wins;
  for (const auto& scene : results.scenes) {
    const auto ranks = Rank(
        results, [&](const MethodResult& method) { return HasPartialView(method) ? kNoValue : FigureOf(method, scene, IouPercent); }, 1);
    std::vector<HtmlCell> row{{scene}, {"-"}, {"-"}, {"-"}, {"-"}, {"-"}};
    if (!ranks.empty()) {
      row[1] = {ranks[0].Names()};
      row[2] = {Number(ranks[0].value, 1)};
      for (const auto& name : ranks[0].names) {
        const auto found = std::ranges::find(wins, name, &std::pair<std::string, int>::first);
        if (found == wins.end()) {
          wins.emplace_back(name, 1);
        } else {
          ++found->second;
        }
      }
    }
    if (ranks.size() > 1) {
      row[3] = {ranks[1].Names()};
      row[4] = {Number(ranks[1].value, 1)};
      row[5] = {Number(ranks[0].value - ranks[1].value, 1)};
    }
    table.Add(std::move(row));
  }
  std::ranges::stable_sort(wins, std::ranges::greater(), &std::pair<std::string, int>::second);
  std::string won;
  for (const auto& [name, count] : wins) won += (won.empty() ? "Scenes won: " : ", ") + name + " " + std::to_string(count);
  return Element("p", text) + Element("p", won + ".") + table.Markup();
}

std::string AgainstPeers(const Results& results) {
  const auto tuned = CompareWithPeers(results, true);
  const auto all = CompareWithPeers(results, false);
  if (all.empty()) return "";
  HtmlTable table("Ours against the best peer of each scene: our error (100 - mIoU) as a share of its error, %; below 100 ours is better",
                  {{"scene"},
                   {"ours, mIoU %"},
                   {"false a turn"},
                   {"best tuned peer"},
                   {"its mIoU %"},
                   {"its false a turn"},
                   {"our error of its error, %"},
                   {"best of all peers"},
                   {"its mIoU %"},
                   {"its false a turn"},
                   {"our error of its error, %"}});
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string css_class = all[i].scene == "mean" ? "total" : "";
    std::vector<HtmlCell> row{{all[i].scene, css_class}, {Number(100.0 * all[i].our_iou, 1), css_class}, {Number(all[i].our_false, 2), css_class}};
    const auto add = [&](const AgainstPeer* peer) {
      row.push_back({peer != nullptr ? peer->peer : "-", css_class});
      row.push_back({peer != nullptr ? Number(100.0 * peer->peer_iou, 1) : "-", css_class});
      row.push_back({peer != nullptr ? Number(peer->peer_false, 2) : "-", css_class});
      row.push_back({peer != nullptr ? Number(100.0 * peer->error_share, 1) : "-", css_class});
    };
    add(i < tuned.size() ? &tuned[i] : nullptr);
    add(&all[i]);
    table.Add(std::move(row));
  }
  return table.Markup();
}

std::string NearRecall(const Results& results) {
  std::set<std::pair<std::string, std::string>> seen;  // scene, kind
  for (const auto& method : results.methods) {
    for (const auto& [scene, score] : method.by_scene) {
      for (const auto& [kind, recall] : score.near_recall_by_kind) seen.emplace(scene, kind);
    }
  }
  if (seen.empty()) return "";
  std::vector<HtmlTable::Heading> headings{{"scene: kind"}};
  for (const auto& method : results.methods) headings.push_back({method.method, true});
  HtmlTable table("Recall at IoU 0.5 of objects nearer than " + Number(Score::kNearM, 0) + " m, %", std::move(headings));
  for (const auto& scene : results.scenes) {
    for (auto at = seen.lower_bound({scene, ""}); at != seen.end() && at->first == scene; ++at) {
      std::vector<HtmlCell> row{{scene + ": " + at->second}};
      for (const auto& method : results.methods) {
        const auto* score = Find(method, scene);
        const auto found = score == nullptr ? decltype(score->near_recall_by_kind.end()){} : score->near_recall_by_kind.find(at->second);
        if (score == nullptr || found == score->near_recall_by_kind.end()) {
          row.push_back({"-"});
          continue;
        }
        const auto& recall = found->second;
        const double percent = 100.0 * Ratio(static_cast<double>(recall.num_found), static_cast<double>(recall.num_object_scans));
        row.push_back({Number(percent, 0), ShadeOf(percent)});
      }
      table.Add(std::move(row));
    }
  }
  return table.Markup();
}

std::string TableOne(const Results& results) {
  if (results.methods.empty()) return "";
  std::string markup =
      SceneTable(results, "Table I: mIoU, %. The best of each column in bold, of those that look all round", IouPercent, 1, true).Markup();

  std::vector<HtmlTable::Heading> headings{{"method"}, {"all scenes", true}};
  for (const auto& scene : results.scenes) headings.push_back({scene, true});
  HtmlTable table("Table I: time of a turn, ms: the median, and below it the 99th percentile", std::move(headings));
  for (const auto& method : results.methods) {
    std::vector<HtmlCell> row{{method.method, IsOurs(method) ? "ours" : ""}, MedianAndP99(TimesOf(method))};
    for (const auto& scene : results.scenes) {
      const auto* score = Find(method, scene);
      row.push_back(MedianAndP99(score == nullptr ? Times{} : TimesOf(score->time_ms)));
    }
    table.Add(std::move(row));
  }
  return markup + table.Markup() +
         "<p class=\"note\">In print (Jeong and Quattrini Li, IROS 2021, Table I: own lake, own laptop): Euclidean clustering 26.3 % in 140 ms, F3D "
         "23.1 % "
         "in 21 ms, depth clustering 18.9 % in 16 ms, the paper's method 33.6 % in 30 ms at W = 512, 55.2 % in 57 ms at 1024, 84.5 % in 86 ms at "
         "1800.</p>\n";
}

std::string WaterAndKinds(const Results& results) {
  if (results.methods.empty()) return "";
  const Figure with_segment = [](const Score& score) { return 100.0 * ThingsWithSegment(score); };
  std::string markup = SceneTable(results, "mIoU over objects in the water alone, %", WaterIouPercent, 1, true).Markup() +
                       SceneTable(results, "Things of 5 returns or more that have a segment, %", with_segment, 1, true).Markup();
  for (const auto* world : WorldsOf(results)) markup += KindTable(*world);
  return markup;
}

std::string SegmentCounts(const Results& results) {
  if (results.methods.empty()) return "";
  std::string markup = SceneTable(results, "False segments a turn", FalseSegmentsPerScan, 2, false).Markup();
  for (const auto* world : WorldsOf(results)) markup += CutTable(*world);
  return markup;
}

std::string TableTwo(const Results& results) {
  if (results.projections.empty()) return "";
  HtmlTable table(
      "Table II: what the range image keeps",
      {{"columns"}, {"true positives, %"}, {"points kept a turn"}, {"returns a turn"}, {"distance to the nearest return, mean, m"}, {"sd, m"}});
  for (const auto& one : results.projections) {
    table.Add({{std::to_string(one.image_columns)},
               {Number(one.true_positive_ratio * 100.0, 1)},
               {Number(one.num_ground_points, 0)},
               {Number(one.num_points, 0)},
               {Number(one.nearest_mean_m, 3)},
               {Number(one.nearest_sd_m, 3)}});
  }
  return table.Markup() +
         "<p class=\"note\">In print, at 512 / 1024 / 1800 columns: true positives 90.2 / 89.8 / 91.7 %; 1563 / 2726 / 4204 points of 5580; distance "
         "-0.079 "
         "/ -0.023 / -0.025 m, sd 0.757 / 0.693 / 0.595 m. How a distance can be negative is not said there; here it is without sign.</p>\n";
}

}  // namespace lookout::eval::page
