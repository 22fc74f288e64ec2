#include "tools/eval/result_tables.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>

#include "common/io/output_file.hpp"
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
  Table table({"method", "mIoU_%", "water_%", "false", "with_segment_%", "segments", "over_%", "under_%", "TPR_%", "median_ms", "p99_ms"});
  for (const auto& method : results.methods) {
    const Score total = Total(method);
    std::vector<std::string> row{method.method,
                                 Percent(MeanOverScenes(results, method, MeanIou)),
                                 Percent(MeanOverScenes(results, method, MeanWaterIou)),
                                 Number(MeanOverScenes(results, method, FalseSegmentsPerScan), 2),
                                 Percent(MeanOverScenes(results, method, ThingsWithSegment)),
                                 Number(MeanOverScenes(results, method, SegmentsPerScan), 2),
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
    if (total.num_scans_with_components == 0) continue;
    const auto times = TimeCells(total.time_ms);
    table.Add({method.method, Percent(MeanOverScenes(results, method, MeanIou)), Number(MeanOverScenes(results, method, ComponentsPerScan), 1),
               Number(MeanOverScenes(results, method, SegmentsPerScan), 2), Number(MeanOverScenes(results, method, FalseSegmentsPerScan), 2),
               times[0], times[1]});
  }
  return table;
}

Table AgainstPeers(const Results& results) {
  Table table({"scene", "ours_%", "ours_false", "best_tuned_peer", "peer_%", "peer_false", "our_error_of_its_error_%", "best_peer_of_all", "best_%",
               "best_false", "our_error_of_best_error_%"});
  const auto tuned = CompareWithPeers(results, true);
  const auto all = CompareWithPeers(results, false);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool has_tuned = i < tuned.size();
    table.Add({all[i].scene, Percent(all[i].our_iou), Number(all[i].our_false, 2), has_tuned ? tuned[i].peer : "-",
               has_tuned ? Percent(tuned[i].peer_iou) : "-", has_tuned ? Number(tuned[i].peer_false, 2) : "-",
               has_tuned ? Percent(tuned[i].error_share) : "-", all[i].peer, Percent(all[i].peer_iou), Number(all[i].peer_false, 2),
               Percent(all[i].error_share)});
  }
  return table;
}

// A row for each method, scene and kind.
Table NearRecall(const Results& results) {
  Table table({"method", "scene", "kind", "object_turns", "recall_%"});
  for (const auto& method : results.methods) {
    for (const auto& scene : results.scenes) {
      const auto found = method.by_scene.find(scene);
      if (found == method.by_scene.end()) continue;
      for (const auto& [kind, recall] : found->second.near_recall_by_kind) {
        table.Add({method.method, scene, kind, Number(recall.num_object_scans),
                   Percent(Ratio(static_cast<double>(recall.num_found), recall.num_object_scans))});
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

std::vector<NamedTable> TablesOfWorld(const Results& results) {
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
  add("false_segments", "false segments a turn", ByScene(results, FalseSegmentsPerScan, [](double value) { return Number(value, 2); }));
  add("with_segment", "things of 5 returns or more that have a segment: more than half of some segment is theirs, %",
      ByScene(results, ThingsWithSegment, Percent));
  add("overall", "all scenes (mIoU, water, false, things with a segment, segments: mean over scenes; over, under, TPR, times: over all turns)",
      Overall(results));
  add("against_peers", "ours against the best peer: 100 - mIoU of ours as a share of the peer's, %", AgainstPeers(results));
  add("kinds", "mean IoU by kind, all scenes, %",
      ByKey<std::string>(
          results, [](const Score& score) -> const auto& { return score.iou_by_kind; }, kind_title));
  add("recall_by_range", "recall at IoU 0.5 by range of the nearest return, all scenes, %",
      ByKey<int>(
          results, [](const Score& score) -> const auto& { return score.recall_by_range; }, range_title));
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

// Columns that name a row; a table that is not here has rows that name scenes, and other worlds go below it.
const std::map<std::string, std::size_t>& NumKeyColumns() {
  static const std::map<std::string, std::size_t> kNumKeyColumns{{"near_recall", 0}, {"against_peers", 0}, {"table_3", 2}};
  return kNumKeyColumns;
}

// The table of another world beside ours, row by row.
Table Beside(const Table& own, const Table& other, std::size_t num_keys, const std::string& world) {
  auto header = own.rows().front();
  for (std::size_t i = num_keys; i < other.rows().front().size(); ++i) header.push_back(world + ": " + other.rows().front()[i]);
  const std::size_t num_columns = header.size();
  Table table(std::move(header));
  const auto is_same = [num_keys](const std::vector<std::string>& one, const std::vector<std::string>& two) {
    return std::equal(one.begin(), one.begin() + static_cast<std::ptrdiff_t>(num_keys), two.begin());
  };
  for (std::size_t i = 1; i < own.rows().size(); ++i) {
    auto row = own.rows()[i];
    for (std::size_t k = 1; k < other.rows().size(); ++k) {
      const auto& beside = other.rows()[k];
      if (is_same(row, beside)) row.insert(row.end(), beside.begin() + static_cast<std::ptrdiff_t>(num_keys), beside.end());
    }
    row.resize(num_columns, "-");
    table.Add(std::move(row));
  }
  return table;
}

// Its rows below ours, the world before the name of the scene.
Table Below(const Table& own, const Table& other, const std::string& world) {
  const auto& header = own.rows().front();
  const auto scene = static_cast<std::size_t>(std::ranges::find(header, "scene") - header.begin());
  Table table = own;
  for (std::size_t i = 1; i < other.rows().size(); ++i) {
    auto row = other.rows()[i];
    row.at(scene) = world + ": " + row.at(scene);
    table.Add(std::move(row));
  }
  return table;
}

Table WithColumn(const Table& own, const std::string& title, const std::string& cell) {
  auto header = own.rows().front();
  header.push_back(title);
  Table table(std::move(header));
  for (std::size_t i = 1; i < own.rows().size(); ++i) {
    auto row = own.rows()[i];
    row.push_back(cell);
    table.Add(std::move(row));
  }
  return table;
}

}  // namespace

std::vector<NamedTable> TablesOf(const Results& results) {
  auto tables = TablesOfWorld(results);
  for (const auto& world : results.other_worlds) {
    const auto others = TablesOfWorld(world);
    for (auto& table : tables) {
      if (table.name.starts_with("curve_")) continue;  // of scenes of their own
      const auto known = NumKeyColumns().find(table.name);
      const std::size_t num_keys = known == NumKeyColumns().end() ? 1 : known->second;
      const auto other = std::ranges::find(others, table.name, &NamedTable::name);
      if (!world.is_here) {
        table.table = WithColumn(table.table, world.world, "not here");
      } else if (other != others.end()) {
        table.table = num_keys == 0 ? Below(table.table, other->table, world.world) : Beside(table.table, other->table, num_keys, world.world);
      }
    }
  }
  return tables;
}

void PrintTables(const Results& results, std::ostream& out) {
  if (!results.world.empty()) out << results.world << "\n\n";
  for (const auto& note : results.notes) out << note << '\n';
  for (const auto& world : results.other_worlds) {
    for (const auto& note : world.notes) out << note << '\n';
    if (!world.is_here) out << world.world << ": not here\n";
  }
  for (const auto& table : TablesOf(results)) {
    if (!table.is_printed) continue;
    out << table.title << '\n';
    table.table.Print(out);
    out << '\n';
  }
}

void WriteCsv(const Results& results, const std::filesystem::path& folder, bool force) {
  std::filesystem::create_directories(folder);
  for (const auto& table : TablesOf(results)) {
    io::OutputFile file(folder / (table.name + ".csv"), {.force = force});
    table.table.PrintCsv(file.stream());
    file.Commit();
  }
}

}  // namespace lookout::eval
