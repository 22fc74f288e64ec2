#include "lab/eval/report/report_page.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "common/core/printable.hpp"
#include "lab/eval/methods/against_peers.hpp"
#include "lab/eval/methods/scoring.hpp"
#include "lab/eval/methods/spots.hpp"
#include "lab/eval/metrics.hpp"
#include "lab/eval/report/page_template.hpp"

namespace lookout::eval {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();  // null in JSON

struct PageFigure {
  const char* name;
  Mean Score::*mean;
  double unit;  // 100: in per cent
};
constexpr std::array kFigures{PageFigure{"iou_percent", &Score::iou, 100.0},
                              PageFigure{"water_iou_percent", &Score::water_iou, 100.0},
                              PageFigure{"with_segment_percent", &Score::with_segment, 100.0},
                              PageFigure{"false_segments", &Score::false_segments, 1.0},
                              PageFigure{"segments", &Score::segments, 1.0},
                              PageFigure{"components", &Score::components, 1.0},
                              PageFigure{"over_segmented_percent", &Score::over_segmented, 100.0},
                              PageFigure{"under_segmented_percent", &Score::under_segmented, 100.0},
                              PageFigure{"true_positive_percent", &Score::true_positives, 100.0}};

Json TimesOf(const std::vector<double>& time_ms) {
  Summary summary;
  for (const double value : time_ms) {
    if (std::isfinite(value)) summary.Add(value);
  }
  if (summary.count() == 0) return nullptr;
  const double mean_ms = summary.Mean();
  Summary deviations;
  for (const double value : time_ms) {
    if (std::isfinite(value)) deviations.Add(value - mean_ms);
  }
  return {{"median", summary.Median()}, {"p99", summary.Percentile(99)}, {"mean", mean_ms}, {"sd", deviations.Rms()}};
}

Json ReliabilityJsonOf(const Confidence& confidence) {
  Json json = Json::array();
  const auto bins = ReliabilityOf(confidence);
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const auto num_bins = static_cast<double>(bins.size());
    json.push_back({{"from", static_cast<double>(i) / num_bins},
                    {"to", static_cast<double>(i + 1) / num_bins},
                    {"num_segments", bins[i].count},
                    {"stated", bins[i].stated},
                    {"observed", bins[i].observed}});
  }
  return json;
}

Json FiguresOf(const Score& score) {
  Json json{{"num_scans", score.num_scans()}, {"time_ms", TimesOf(score.time_ms)}, {"reliability", ReliabilityJsonOf(score.confidence)}};
  for (const auto& figure : kFigures) json[figure.name] = figure.unit * (score.*figure.mean).value();
  return json;
}

Json ByRange(const std::map<int, Mean>& bins) {
  Json json = Json::array();
  for (const auto& [bin, mean] : bins) {
    if (mean.count == 0) continue;
    json.push_back({{"middle_m", (bin + 0.5) * Score::kRangeBinM}, {"num_object_scans", mean.count}, {"percent", 100.0 * mean.value()}});
  }
  return json;
}

// The scores of the objects, by bearing, and the returns of each object in each segment: on a grid that fits a plan, neighbours forward of each other
// as one run, so that a page with many scans stays small.
Json WorstScanOf(const WorstScan& worst) {
  Json json{{"scene", PrintableLines(worst.scene)}, {"seed", std::to_string(worst.seed)}, {"scan", worst.index},
            {"iou_percent", 100.0 * worst.iou},     {"objects", Json::array()},           {"returns", nullptr}};
  const auto& scan = worst.truth.scan;
  const std::size_t num_cells = scan.columns.azimuth_rad.size() * scan.head.rings.size() * static_cast<std::size_t>(scan.head.num_returns);
  if (scan.num_cells() != num_cells || worst.truth.object.size() != num_cells || worst.label.size() != num_cells) return json;

  const auto spots = SpotsOf(worst.truth, worst.label);
  std::map<std::int32_t, std::pair<double, double>> sums;  // of (right, forward), by object
  std::pair min_m{0.0, 0.0};
  std::pair max_m{0.0, 0.0};
  for (const auto& spot : spots) {
    sums[spot.object].first += spot.right_m;
    sums[spot.object].second += spot.forward_m;
    if (spot.object <= 0 && spot.segment == 0) continue;
    min_m = {std::min(min_m.first, spot.right_m), std::min(min_m.second, spot.forward_m)};
    max_m = {std::max(max_m.first, spot.right_m), std::max(max_m.second, spot.forward_m)};
  }
  const auto matches = MatchScan(worst.truth, worst.label);
  std::vector<std::pair<int, Confusion::Object>> objects(matches.objects.begin(), matches.objects.end());
  std::ranges::stable_sort(objects, {}, [&sums](const auto& object) { return std::atan2(sums[object.first].first, sums[object.first].second); });
  for (const auto& [id, object] : objects) {
    const auto found = worst.truth.objects.find(id);
    const bool is_known = found != worst.truth.objects.end();
    json["objects"].push_back({{"id", id},
                               {"name", is_known ? PrintableLines(found->second.name) : "?"},
                               {"kind", is_known ? PrintableLines(found->second.kind) : "?"},
                               {"num_returns", object.num_returns},
                               {"iou_percent", 100.0 * object.iou}});
  }
  constexpr double kSteps = 210.0;  // a plan is 460 wide and its dots 3: those that touch still do
  const double unit_m = std::max({1.0, max_m.first - min_m.first, max_m.second - min_m.second}) / kSteps;
  std::map<std::pair<std::int32_t, std::int32_t>, std::pair<std::int64_t, std::set<std::pair<long, long>>>> groups;
  for (const auto& spot : spots) {
    auto& [num_returns, places] = groups[{spot.object, spot.segment}];
    ++num_returns;
    places.emplace(std::lround(spot.right_m / unit_m), std::lround(spot.forward_m / unit_m));
  }
  json["unit_m"] = unit_m;
  json["returns"] = Json::array();
  for (const auto& [key, group] : groups) {
    std::vector<long> runs;  // right, forward, length
    for (const auto& [right, forward] : group.second) {
      if (!runs.empty() && runs[runs.size() - 3] == right && runs[runs.size() - 2] + runs.back() == forward) {
        ++runs.back();
      } else {
        runs.insert(runs.end(), {right, forward, 1});
      }
    }
    json["returns"].push_back({{"object", key.first}, {"segment", key.second}, {"num_returns", group.first}, {"runs", runs}});
  }
  return json;
}

Json OutcomesOf(const std::map<std::string, Outcomes>& outcomes_by_kind) {
  Json rows = Json::array();
  for (const auto& [kind, outcomes] : outcomes_by_kind) {
    Json row{{"kind", PrintableLines(kind)}};
    for (std::size_t i = 0; i < kOutcomeNames.size(); ++i) row[std::string(kOutcomeNames[i])] = outcomes.count[i];
    rows.push_back(row);
  }
  return rows;
}

// Columns are the scenes and kinds of the world.
Json MethodOf(const Results& world, const MethodResult& method, const std::set<std::string>& kinds) {
  Score total = Total(method);
  Json json{{"name", PrintableLines(method.method)}, {"is_partial", HasPartialView(method)}, {"mean", Json::object()}, {"total", FiguresOf(total)}};
  for (const auto& figure : kFigures) json["mean"][figure.name] = figure.unit * MeanOverScenes(world, method, figure.mean);
  json["scenes"] = Json::array();
  for (const auto& scene : world.scenes) {
    const auto found = method.by_scene.find(scene);
    json["scenes"].push_back(found == method.by_scene.end() ? Json(nullptr) : FiguresOf(found->second));
  }
  json["kinds_iou_percent"] = Json::array();
  for (const auto& kind : kinds) json["kinds_iou_percent"].push_back(100.0 * total.iou_by_kind[kind].value());
  json["iou_by_range"] = ByRange(total.iou_by_range);
  json["recall_by_range"] = ByRange(total.recall_by_range);
  json["outcomes"] = OutcomesOf(total.outcomes_by_kind);
  json["stages"] = Json::array();
  for (const auto& [stage, time_ms] : method.stage_ms) json["stages"].push_back({{"name", stage}, {"time_ms", TimesOf(time_ms)}});
  json["worst"] = Json::array();
  for (const auto& worst : method.worst) json["worst"].push_back(WorstScanOf(worst));
  return json;
}

// Recall of near objects: a row for each scene and kind, in it a column for each method.
Json NearRecallOf(const Results& world) {
  Json rows = Json::array();
  for (const auto& scene : world.scenes) {
    std::map<std::string, std::vector<double>> percents;  // by kind
    for (std::size_t i = 0; i < world.methods.size(); ++i) {
      const auto found = world.methods[i].by_scene.find(scene);
      if (found == world.methods[i].by_scene.end()) continue;
      for (const auto& [kind, recall] : found->second.near_recall_by_kind) {
        auto& row = percents[kind];
        row.resize(world.methods.size(), kNone);
        row[i] = 100.0 * recall.value();
      }
    }
    for (const auto& [kind, row] : percents) rows.push_back({{"scene", PrintableLines(scene)}, {"kind", PrintableLines(kind)}, {"percent", row}});
  }
  return rows;
}

Json PeerOf(const BestPeer& peer) {
  return {{"name", PrintableLines(peer.name)},
          {"iou_percent", 100.0 * peer.iou},
          {"false_segments", peer.false_segments},
          {"error_percent", 100.0 * peer.error_share}};
}

Json AgainstPeersOf(const Results& world) {
  Json rows = Json::array();
  for (const auto& row : CompareWithPeers(world)) {
    rows.push_back({{"scene", PrintableLines(row.scene)},
                    {"iou_percent", 100.0 * row.our_iou},
                    {"false_segments", row.our_false},
                    {"tuned", row.tuned ? PeerOf(*row.tuned) : Json(nullptr)},
                    {"all", PeerOf(row.of_all)}});
  }
  return rows;
}

Json TextsOf(const auto& texts) {
  Json json = Json::array();
  for (const auto& text : texts) json.push_back(PrintableLines(text));
  return json;
}

Json WorldOf(const Results& world) {
  std::set<std::string> kinds;
  for (const auto& method : world.methods) {
    for (const auto& [scene, score] : method.by_scene) {
      for (const auto& [kind, sum] : score.iou_by_kind) kinds.insert(kind);
    }
  }
  Json json{{"name", PrintableLines(world.world)},
            {"is_here", world.is_here},
            {"notes", TextsOf(world.notes)},
            {"scenes", TextsOf(world.scenes)},
            {"kinds", TextsOf(kinds)},
            {"methods", Json::array()},
            {"against_peers", AgainstPeersOf(world)},
            {"near_recall", NearRecallOf(world)},
            {"near_m", Score::kNearM},
            {"projections", Json::array()}};
  for (const auto& method : world.methods) json["methods"].push_back(MethodOf(world, method, kinds));
  for (const auto& one : world.projections) {
    json["projections"].push_back({{"columns", one.image_columns},
                                   {"true_positive_percent", 100.0 * one.true_positive_ratio},
                                   {"points_kept", one.num_ground_points},
                                   {"returns", one.num_points},
                                   {"nearest_mean_m", one.nearest_mean_m},
                                   {"nearest_sd_m", one.nearest_sd_m}});
  }
  return json;
}

Json CurveOf(const Curve& curve) {
  Json json{{"title", PrintableLines(curve.title)}, {"x_label", PrintableLines(curve.x_label)},       {"y_label", PrintableLines(curve.y_label)},
            {"note", PrintableLines(curve.note)},   {"scans_from", PrintableLines(curve.scans_from)}, {"lines", Json::array()}};
  for (const auto& line : curve.lines) json["lines"].push_back({{"name", PrintableLines(line.name)}, {"points", line.points}});
  return json;
}

}  // namespace

std::string JsonOf(const Results& results) {
  Json json{{"command", PrintableLines(results.command)},
            {"version", PrintableLines(results.version)},
            {"computer", PrintableLines(results.computer)},
            {"first_seed", std::to_string(results.first_seed)},
            {"last_seed", std::to_string(results.first_seed + static_cast<std::uint64_t>(std::max(1, results.num_seeds)) - 1)},
            {"num_seeds", results.num_seeds},
            {"seconds", results.seconds},
            {"worlds", Json::array({WorldOf(results)})},
            {"curves", Json::array()}};
  for (const auto& world : results.other_worlds) json["worlds"].push_back(WorldOf(world));
  for (const auto& curve : results.curves) json["curves"].push_back(CurveOf(curve));
  std::string text;
  for (const char letter : json.dump()) {
    if (letter == '<') {
      text += "\\u003c";
    } else {
      text += letter;
    }
  }
  return text;
}

void WriteHtml(const Results& results, std::ostream& out) {
  constexpr std::string_view kPlace = "{{results}}";
  const auto at = kPageTemplate.find(kPlace);
  out << kPageTemplate.substr(0, at) << JsonOf(results) << kPageTemplate.substr(at + kPlace.size());
}

}  // namespace lookout::eval
