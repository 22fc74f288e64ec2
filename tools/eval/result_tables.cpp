#include "tools/eval/result_tables.hpp"

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <set>
#include <stdexcept>

#include "tools/eval/against_peers.hpp"
#include "tools/eval/metrics.hpp"

namespace lookout::eval {
namespace {

std::string Percent(double share) { return Number(100.0 * share, 1); }

double Ratio(double part, std::int64_t whole) { return whole > 0 ? part / static_cast<double>(whole) : std::numeric_limits<double>::quiet_NaN(); }

Score Total(const MethodResult& method) {
  Score total;
  for (const auto& [scene, score] : method.by_scene) total.Add(score);
  return total;
}

Table ByScene(const Results& results, const Figure& figure, const std::function<std::string(double)>& text) {
  std::vector<std::string> header{"method", "mean"};
  header.insert(header.end(), results.scenes.begin(), results.scenes.end());
  Table table(header);
  for (const auto& method : results.methods) {
    std::vector<std::string> row{method.method, text(MeanOverScenes(results, method, figure))};
    for (const auto& scene : results.scenes) {
      const auto found = method.by_scene.find(scene);
      row.push_back(found == method.by_scene.end() ? "-" : text(figure(found->second)));
    }
    table.Add(row);
  }
  return table;
}

// Methods in rows, what `column_of` and `cell_of` say of their totals in columns.
template <typename Key, typename Sums>
Table ByKey(const Results& results, const Sums& sums_of, const std::function<std::string(const Key&)>& title) {
  std::set<Key> keys;
  std::vector<Score> totals;
  for (const auto& method : results.methods) {
    totals.push_back(Total(method));
    for (const auto& [key, sum] : sums_of(totals.back())) keys.insert(key);
  }
  std::vector<std::string> header{"method"};
  for (const auto& key : keys) header.push_back(title(key));
  Table table(header);
  for (std::size_t i = 0; i < totals.size(); ++i) {
    std::vector<std::string> row{results.methods[i].method};
    for (const auto& key : keys) {
      const auto& sums = sums_of(totals[i]);
      const auto found = sums.find(key);
      row.push_back(found == sums.end() ? "-" : Percent(Ratio(static_cast<double>(found->second.second), found->second.first)));
    }
    if (!keys.empty()) table.Add(row);
  }
  return table;
}

std::vector<std::string> TimeCells(const std::vector<double>& time_ms) {
  if (time_ms.empty()) return {"-", "-"};
  Summary summary;
  for (const double value : time_ms) summary.Add(value);
  return {Number(summary.Median(), 3), Number(summary.Percentile(99), 3)};
}

Table Overall(const Results& results) {
  Table table({"method", "mIoU_%", "water_%", "sure_%", "segments", "false", "sure_false", "over_%", "under_%", "TPR_%", "median_ms", "p99_ms"});
  for (const auto& method : results.methods) {
    const Score total = Total(method);
    std::vector<std::string> row{method.method,
                                 Percent(MeanOverScenes(results, method, MeanIou)),
                                 Percent(MeanOverScenes(results, method, MeanWaterIou)),
                                 Percent(MeanOverScenes(results, method, MeanSureIou)),
                                 Number(MeanOverScenes(results, method, SegmentsPerTurn), 2),
                                 Number(MeanOverScenes(results, method, FalseSegmentsPerTurn), 2),
                                 Number(MeanOverScenes(results, method, SureFalseSegmentsPerTurn), 2),
                                 Percent(OverSegmentedShare(total)),
                                 Percent(UnderSegmentedShare(total)),
                                 Percent(TruePositiveRatio(total))};
    const auto times = TimeCells(total.time_ms);
    row.insert(row.end(), times.begin(), times.end());
    table.Add(row);
  }
  return table;
}

// With and without a step of the segmenter: methods that have components before they cluster them.
Table Ablation(const Results& results) {
  Table table({"method", "mIoU_%", "components", "segments", "false", "median_ms", "p99_ms"});
  for (const auto& method : results.methods) {
    const Score total = Total(method);
    if (total.num_turns_with_components == 0) continue;
    const auto times = TimeCells(total.time_ms);
    table.Add({method.method, Percent(MeanOverScenes(results, method, MeanIou)), Number(MeanOverScenes(results, method, ComponentsPerTurn), 1),
               Number(MeanOverScenes(results, method, SegmentsPerTurn), 2), Number(MeanOverScenes(results, method, FalseSegmentsPerTurn), 2),
               times[0], times[1]});
  }
  return table;
}

Table AgainstPeers(const Results& results) {
  Table table(
      {"scene", "ours_%", "best_tuned_peer", "peer_%", "our_error_of_its_error_%", "best_peer_of_all", "best_%", "our_error_of_best_error_%"});
  const auto tuned = CompareWithPeers(results, true);
  const auto all = CompareWithPeers(results, false);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool has_tuned = i < tuned.size();
    table.Add({all[i].scene, Percent(all[i].our_iou), has_tuned ? tuned[i].peer : "-", has_tuned ? Percent(tuned[i].peer_iou) : "-",
               has_tuned ? Percent(tuned[i].error_share) : "-", all[i].peer, Percent(all[i].peer_iou), Percent(all[i].error_share)});
  }
  return table;
}

// A row for each method, scene and kind.
Table NearRecall(const Results& results) {
  Table table({"method", "scene", "kind", "object_turns", "recall_%", "sure_recall_%"});
  for (const auto& method : results.methods) {
    for (const auto& scene : results.scenes) {
      const auto found = method.by_scene.find(scene);
      if (found == method.by_scene.end()) continue;
      for (const auto& [kind, recall] : found->second.near_recall_by_kind) {
        table.Add({method.method, scene, kind, Number(recall.num_object_turns),
                   Percent(Ratio(static_cast<double>(recall.num_found), recall.num_object_turns)),
                   Percent(Ratio(static_cast<double>(recall.num_surely_found), recall.num_object_turns))});
      }
    }
  }
  return table;
}

Table Stages(const Results& results) {
  Table table({"method", "stage", "median_ms", "p99_ms"});
  for (const auto& method : results.methods) {
    for (const auto& [stage, time_ms] : method.stage_ms) {
      const auto times = TimeCells(time_ms);
      table.Add({method.method, stage, times[0], times[1]});
    }
  }
  return table;
}

Table Projections(const Results& results) {
  Table table({"columns", "TPR_%", "ground_points", "returns", "nearest_mean_m", "nearest_sd_m"});
  for (const auto& row : results.projections) {
    table.Add({Number(std::int64_t{row.image_columns}), Percent(row.true_positive_ratio), Number(row.num_ground_points, 0), Number(row.num_points, 0),
               Number(row.nearest_mean_m, 3), Number(row.nearest_sd_m, 3)});
  }
  return table;
}

Table CurveTable(const Curve& curve) {
  std::set<double> places;
  std::vector<std::string> header{curve.x_label};
  for (const auto& line : curve.lines) {
    header.push_back(line.name);
    for (const auto& [x, y] : line.points) places.insert(x);
  }
  Table table(header);
  for (const double place : places) {
    std::vector<std::string> row{Number(place, 2)};
    for (const auto& line : curve.lines) {
      std::string cell = "-";
      for (const auto& [x, y] : line.points) {
        if (x == place) cell = Number(y, 2);
      }
      row.push_back(cell);
    }
    table.Add(row);
  }
  return table;
}

}  // namespace

std::vector<NamedTable> TablesOf(const Results& results) {
  std::vector<NamedTable> tables;
  const auto add = [&tables](const std::string& name, const std::string& title, Table table) {
    if (!table.empty()) tables.push_back({name, title, std::move(table)});
  };
  const auto kind_title = [](const std::string& kind) { return kind; };
  const auto range_title = [](const int& bin) { return Number(bin * Score::kRangeBinM, 0) + "-" + Number((bin + 1) * Score::kRangeBinM, 0) + "_m"; };
  const auto add_to_files = [&](const std::string& name, Table table) {
    if (!table.empty()) tables.push_back({name, "", std::move(table), false});
  };
  add("table_1", "Table I: mIoU, %", ByScene(results, MeanIou, Percent));
  add("water", "mIoU over objects in the water alone, %", ByScene(results, MeanWaterIou, Percent));
  add_to_files("sure_water", ByScene(results, MeanSureWaterIou, Percent));
  add("sure", "mIoU with sure segments alone, %", ByScene(results, MeanSureIou, Percent));
  add("false_segments", "false segments a turn", ByScene(results, FalseSegmentsPerTurn, [](double value) { return Number(value, 2); }));
  add("sure_false_segments", "false segments a turn that the method is sure of",
      ByScene(results, SureFalseSegmentsPerTurn, [](double value) { return Number(value, 2); }));
  add("overall", "all scenes (mIoU, segments, false: mean over scenes; over, under, TPR, times: over all turns)", Overall(results));
  add("against_peers", "ours against the best peer: 100 - mIoU of ours as a share of the peer's, %", AgainstPeers(results));
  add("kinds", "mean IoU by kind, all scenes, %",
      ByKey<std::string>(
          results, [](const Score& score) -> const auto& { return score.iou_by_kind; }, kind_title));
  add_to_files("sure_kinds", ByKey<std::string>(
                                 results, [](const Score& score) -> const auto& { return score.sure_iou_by_kind; }, kind_title));
  add("recall_by_range", "recall at IoU 0.5 by range of the nearest return, all scenes, %",
      ByKey<int>(
          results, [](const Score& score) -> const auto& { return score.recall_by_range; }, range_title));
  add_to_files("sure_recall_by_range", ByKey<int>(
                                           results, [](const Score& score) -> const auto& { return score.sure_recall_by_range; }, range_title));
  add_to_files("near_recall", NearRecall(results));
  add("iou_by_range", "mean IoU by range of the nearest return, all scenes, %",
      ByKey<int>(
          results, [](const Score& score) -> const auto& { return score.iou_by_range; }, range_title));
  add("table_2", "Table II: what the paper's image keeps, a turn", Projections(results));
  add("table_3", "Table III: time by stage", Stages(results));
  add("ablation", "Ablation: components before they are clustered, segments, false segments (a turn, mean over scenes), time over all turns",
      Ablation(results));
  int number = 0;
  for (const auto& curve : results.curves) {
    add("curve_" + std::to_string(++number), curve.title + ": " + curve.y_label + (curve.note.empty() ? "" : "\n" + curve.note), CurveTable(curve));
  }
  return tables;
}

void PrintTables(const Results& results, std::ostream& out) {
  for (const auto& table : TablesOf(results)) {
    if (!table.is_printed) continue;
    out << table.title << '\n';
    table.table.Print(out);
    out << '\n';
  }
}

void WriteCsv(const Results& results, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  for (const auto& table : TablesOf(results)) {
    const auto file = folder / (table.name + ".csv");
    std::ofstream out(file, std::ios::binary | std::ios::trunc);
    table.table.PrintCsv(out);
    out.close();
    if (!out) throw std::runtime_error(file.string() + ": cannot be written");
  }
}

}  // namespace lookout::eval
