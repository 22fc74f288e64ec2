#include "lab/eval/methods/result_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <utility>

#include "lab/eval/methods/against_peers.hpp"
#include "lab/eval/metrics.hpp"

namespace lookout::eval {
namespace {

// A figure of the tables, as it is printed.
struct Column {
  const char* heading = "";
  Mean Score::*figure = nullptr;
  int decimals = 0;        // kPercent: a share, in per cent
  bool is_of_all = false;  // over all scans; else the mean over the scenes

  static constexpr int kPercent = -1;
  std::string Text(double value) const { return decimals == kPercent ? Percent(value) : Number(value, decimals); }
};

Table ByScene(const Results& results, Mean Score::*figure, int decimals = Column::kPercent) {
  const Column column{"mean", figure, decimals};
  Table::Row header{"method", column.heading};
  header.insert(header.end(), results.scenes.begin(), results.scenes.end());
  Table table(header);
  for (const auto& method : results.methods) {
    Table::Row row{method.method, column.Text(MeanOverScenes(results, method, figure))};
    for (const auto& scene : results.scenes) {
      const auto found = method.by_scene.find(scene);
      row.push_back(found == method.by_scene.end() ? "-" : column.Text((found->second.*figure).value()));
    }
    table.Add(row);
  }
  return table;
}

// Methods in rows, the keys of a figure of their totals in columns, in per cent.
template <typename Key>
Table ByKey(const Results& results, std::map<Key, Mean> Score::*means, const std::function<std::string(const Key&)>& title) {
  std::set<Key> keys;
  std::vector<Score> totals;
  for (const auto& method : results.methods) {
    totals.push_back(Total(method));
    for (const auto& [key, mean] : totals.back().*means) keys.insert(key);
  }
  Table::Row header{"method"};
  for (const auto& key : keys) header.push_back(title(key));
  Table table(header);
  for (std::size_t i = 0; i < totals.size() && !keys.empty(); ++i) {
    Table::Row row{results.methods[i].method};
    for (const auto& key : keys) row.push_back(Percent((totals[i].*means)[key].value()));
    table.Add(row);
  }
  return table;
}

Table::Row TimeCells(const std::vector<double>& time_ms) {
  if (time_ms.empty()) return {"-", "-"};
  Summary summary;
  for (const double value : time_ms) summary.Add(value);
  return {Number(summary.Median(), 3), Number(summary.Percentile(99), 3)};
}

// A row for each method: these figures, then its times where they are wanted.
Table OfMethods(const Results& results, std::span<const Column> columns, bool (*is_wanted)(const Score& total), bool has_times = true) {
  Table::Row header{"method"};
  for (const auto& column : columns) header.emplace_back(column.heading);
  if (has_times) header.insert(header.end(), {"median_ms", "p99_ms"});
  Table table(header);
  for (const auto& method : results.methods) {
    const Score total = Total(method);
    if (!is_wanted(total)) continue;
    Table::Row row{method.method};
    for (const auto& column : columns) {
      row.push_back(column.Text(column.is_of_all ? (total.*column.figure).value() : MeanOverScenes(results, method, column.figure)));
    }
    const auto times = has_times ? TimeCells(total.time_ms) : Table::Row{};
    row.insert(row.end(), times.begin(), times.end());
    table.Add(row);
  }
  return table;
}

constexpr std::array kOverall{Column{"mIoU_%", &Score::iou, Column::kPercent},
                              Column{"water_%", &Score::water_iou, Column::kPercent},
                              Column{"false", &Score::false_segments, 2},
                              Column{"with_segment_%", &Score::with_segment, Column::kPercent},
                              Column{"segments", &Score::segments, 2},
                              Column{"over_%", &Score::over_segmented, Column::kPercent, true},
                              Column{"under_%", &Score::under_segmented, Column::kPercent, true},
                              Column{"TPR_%", &Score::true_positives, Column::kPercent, true}};
constexpr std::array kLabelQuality{
    Column{"PQ_%", &Score::panoptic_quality, Column::kPercent}, Column{"SQ_%", &Score::segmentation_quality, Column::kPercent},
    Column{"RQ_%", &Score::recognition_quality, Column::kPercent}, Column{"OSE", &Score::over_entropy, 2}, Column{"USE", &Score::under_entropy, 2}};
// With and without a step of the segmenter.
constexpr std::array kAblation{Column{"mIoU_%", &Score::iou, Column::kPercent}, Column{"components", &Score::components, 1},
                               Column{"segments", &Score::segments, 2}, Column{"false", &Score::false_segments, 2}};

Table AgainstPeers(const Results& results) {
  Table table({"scene", "ours_%", "ours_false", "best_tuned_peer", "peer_%", "peer_false", "our_error_of_its_error_%", "best_peer_of_all", "best_%",
               "best_false", "our_error_of_best_error_%"});
  for (const auto& row : CompareWithPeers(results)) {
    Table::Row cells{row.scene, Percent(row.our_iou), Number(row.our_false, 2)};
    for (const auto& peer : {row.tuned, std::optional(row.of_all)}) {
      const auto of_peer = peer ? Table::Row{peer->name, Percent(peer->iou), Number(peer->false_segments, 2), Percent(peer->error_share)}
                                : Table::Row{"-", "-", "-", "-"};
      cells.insert(cells.end(), of_peer.begin(), of_peer.end());
    }
    table.Add(std::move(cells));
  }
  return table;
}

// A row for each method, scene and kind.
Table NearRecall(const Results& results) {
  Table table({"method", "scene", "kind", "object_scans", "recall_%"});
  ForEachScore(results, [&](const std::string& method, const std::string& scene, const Score& score) {
    for (const auto& [kind, recall] : score.near_recall_by_kind) {
      table.Add({method, scene, kind, Number(recall.count), Percent(recall.value())});
    }
  });
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
  Table::Row header{curve.x_label};
  std::map<double, Table::Row> rows;
  for (const auto& line : curve.lines) {
    for (const auto& [x, y] : line.points) {
      auto& row = rows[x];
      row.resize(header.size(), "-");
      row[0] = Number(x, 2);
      row.push_back(Number(y, 2));
    }
    header.push_back(line.name);
  }
  Table table(header);
  for (auto& [x, row] : rows) {
    row.resize(header.size(), "-");
    table.Add(std::move(row));
  }
  return table;
}

std::vector<NamedTable> TablesOfWorld(const Results& results) {
  std::vector<NamedTable> tables;
  const auto add = [&tables](const std::string& name, const std::string& title, Table table, bool is_printed = true) {
    if (!table.empty()) tables.push_back({name, title, std::move(table), is_printed});
  };
  const std::function kind_title = [](const std::string& kind) { return kind; };
  const std::function range_title = [](const int& bin) {
    return fmt::format("{:.0f}-{:.0f}_m", bin * Score::kRangeBinM, (bin + 1) * Score::kRangeBinM);
  };
  for (auto& table : LeaveOutTablesOf(results)) add(table.name, table.title, std::move(table.table));
  add("table_1", "Table I: mIoU, %", ByScene(results, &Score::iou));
  add("water", "mIoU over objects in the water alone, %", ByScene(results, &Score::water_iou));
  add("false_segments", "false segments a scan", ByScene(results, &Score::false_segments, 2));
  add("with_segment", "things of 5 returns or more that have a segment: more than half of some segment is theirs, %",
      ByScene(results, &Score::with_segment));
  add("overall", "all scenes (mIoU, water, false, things with a segment, segments: mean over scenes; over, under, TPR, times: over all scans)",
      OfMethods(results, kOverall, [](const Score&) { return true; }));
  add("label_quality", "panoptic quality, entropies of over- and under-segmentation a scan (mean over scenes)",
      OfMethods(
          results, kLabelQuality, [](const Score& total) { return total.iou.count > 0; }, false));
  add("against_peers", "ours against the best peer: 100 - mIoU of ours as a share of the peer's, %", AgainstPeers(results));
  add("kinds", "mean IoU by kind, all scenes, %", ByKey(results, &Score::iou_by_kind, kind_title));
  add("recall_by_range", "recall at IoU 0.5 by range of the nearest return, all scenes, %", ByKey(results, &Score::recall_by_range, range_title));
  add("near_recall", "", NearRecall(results), false);
  add("iou_by_range", "mean IoU by range of the nearest return, all scenes, %", ByKey(results, &Score::iou_by_range, range_title));
  add("table_2", "Table II: what the paper's image keeps, a scan", Projections(results));
  add("table_3", "Table III: time by stage", Stages(results));
  add("ablation", "Ablation: components before they are clustered, segments, false segments (a scan, mean over scenes), time over all scans",
      OfMethods(results, kAblation, [](const Score& total) { return total.components.count > 0; }));
  for (auto& table : FailureTablesOf(results)) add(table.name, table.title, std::move(table.table), table.is_printed);
  int number = 0;
  for (const auto& curve : results.curves) {
    add("curve_" + std::to_string(++number), curve.title + ": " + curve.y_label + (curve.note.empty() ? "" : "\n" + curve.note), CurveTable(curve));
  }
  return tables;
}

// Columns that name a row; of tables whose rows name scenes, other worlds stand below (0).
std::size_t NumKeyColumns(const NamedTable& table) {
  if (std::ranges::find(table.table.header(), "scene") != table.table.header().end()) return 0;
  return table.name == "table_3" ? 2 : 1;
}

// The table of another world beside ours: the cells of the row with the same keys.
Table Beside(const Table& own, const Table& other, std::size_t num_keys, const std::string& world) {
  const auto first = static_cast<std::ptrdiff_t>(num_keys);
  auto header = own.header();
  for (std::size_t i = num_keys; i < other.header().size(); ++i) header.push_back(world + ": " + other.header()[i]);
  Table table(header);
  for (std::size_t i = 1; i < own.rows().size(); ++i) {
    auto row = own.rows()[i];
    const auto is_same = [&](const Table::Row& beside) { return std::equal(row.begin(), row.begin() + first, beside.begin()); };
    const auto beside = std::find_if(other.rows().begin() + 1, other.rows().end(), is_same);
    if (beside != other.rows().end()) row.insert(row.end(), beside->begin() + first, beside->end());
    row.resize(header.size(), "-");
    table.Add(std::move(row));
  }
  return table;
}

// Its rows below ours, the world before the name of the scene.
Table Below(Table table, const Table& other, const std::string& world) {
  const auto scene = static_cast<std::size_t>(std::ranges::find(table.header(), "scene") - table.header().begin());
  for (std::size_t i = 1; i < other.rows().size(); ++i) {
    auto row = other.rows()[i];
    row.at(scene) = world + ": " + row.at(scene);
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
      const auto num_keys = NumKeyColumns(table);
      const auto other = std::ranges::find(others, table.name, &NamedTable::name);
      if (!world.is_here) {
        table.table.AddColumn(world.world, "not here");
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
  PrintTables(TablesOf(results), out);
}

}  // namespace lookout::eval
