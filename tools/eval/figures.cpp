#include "tools/eval/figures.hpp"

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

#include "common/io/output_file.hpp"
#include "tools/eval/result_tables.hpp"

namespace lookout::eval {
namespace {

namespace fs = std::filesystem;

using Row = std::vector<std::string>;

constexpr std::string_view kBlockBegin = "<!-- figures: ";
constexpr std::string_view kBlockNameEnd = " -->";
constexpr std::string_view kBlockEnd = "<!-- end -->";

// In headings of columns a world stands before what it is a world of.
std::string HeadingOf(const Results& world, const std::string& text) { return world.world.empty() ? text : world.world + ": " + text; }

std::vector<const Results*> WorldsOf(const Results& results) {
  std::vector<const Results*> worlds{&results};
  for (const auto& world : results.other_worlds) worlds.push_back(&world);
  return worlds;
}

// Columns of other worlds right behind the column of ours that they are the counterpart of; those without one at the end.
Table SideBySide(const Table& table, const Results& results) {
  const auto& header = table.rows().front();
  const auto world_of = [&](const std::string& heading) -> const Results* {
    for (const auto& world : results.other_worlds) {
      if (heading == world.world || heading.starts_with(world.world + ": ")) return &world;
    }
    return nullptr;
  };
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < header.size(); ++i) {
    if (world_of(header[i]) != nullptr) continue;
    order.push_back(i);
    for (std::size_t k = 0; k < header.size(); ++k) {
      const auto* world = world_of(header[k]);
      if (world != nullptr && header[k] == HeadingOf(*world, header[i])) order.push_back(k);
    }
  }
  for (std::size_t i = 0; i < header.size(); ++i) {
    if (std::ranges::find(order, i) == order.end()) order.push_back(i);
  }
  const auto in_order = [&order](const Row& row) {
    Row result;
    for (const auto i : order) result.push_back(row[i]);
    return result;
  };
  Table result(in_order(header));
  for (std::size_t i = 1; i < table.rows().size(); ++i) result.Add(in_order(table.rows()[i]));
  return result;
}

// Without the columns whose headings end so.
Table WithoutColumns(const Table& table, std::string_view ending) {
  const auto& header = table.rows().front();
  const auto kept = [&header, ending](const Row& row) {
    Row result;
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (!header[i].ends_with(ending)) result.push_back(row[i]);
    }
    return result;
  };
  Table result(kept(header));
  for (std::size_t i = 1; i < table.rows().size(); ++i) result.Add(kept(table.rows()[i]));
  return result;
}

template <typename Predicate>
Table RowsWhere(const Table& table, Predicate is_wanted) {
  Table result(table.rows().front());
  for (std::size_t i = 1; i < table.rows().size(); ++i) {
    if (is_wanted(table.rows()[i].front())) result.Add(table.rows()[i]);
  }
  return result;
}

bool IsOfInterest(const std::string& method) {
  return method.starts_with("ours") || method == "paper W=1800" || method.find("(tuned") != std::string::npos;
}

bool IsPeerName(const std::string& method) { return !method.starts_with("ours") && !method.starts_with("paper"); }

// On a computer that does other work the 99th percentile says more about that work than about the method: blocks show medians alone.
constexpr std::string_view kSlowestTimes = "p99_ms";

// "mIoU: mean over 16 of the 17 scenes, those that hold an object; ..."
std::string Scope(const Results& world) {
  if (!world.is_here) return "The " + world.world + ": not here.";
  std::int64_t num_scans = 0;
  std::string without_object;
  int num_with_object = 0;
  if (!world.methods.empty()) {
    for (const auto& scene : world.scenes) {
      const auto found = world.methods.front().by_scene.find(scene);
      if (found == world.methods.front().by_scene.end()) continue;
      num_scans += found->second.num_scans;
      if (found->second.num_scans_with_object > 0) {
        ++num_with_object;
      } else {
        without_object += (without_object.empty() ? "" : ", ") + scene;
      }
    }
  }
  std::string text = world.world.empty() ? "Own simulator" : "The " + world.world;
  text += ": " + std::to_string(num_scans) + " scans of " + std::to_string(world.scenes.size()) + " scenes";
  if (world.world.empty() && world.num_seeds > 0) {
    text += ", " + std::to_string(world.num_seeds) + " seeds each from " + std::to_string(world.first_seed) + " on, " + Number(world.seconds, 1) +
            " s a seed";
  }
  text += "; mIoU is the mean over the " + std::to_string(num_with_object) + " with objects";
  if (!without_object.empty()) text += " (" + without_object + " counts for false segments alone)";
  return text + ".";
}

const NamedTable* Find(const std::vector<NamedTable>& tables, const std::string& name) {
  const auto found = std::ranges::find(tables, name, &NamedTable::name);
  return found == tables.end() ? nullptr : &*found;
}

// Recall of one kind near the boat, over all scenes of a world that hold it in their name; "-" = there is none.
std::string NearRecallOf(const MethodResult& method, const std::string& scene, const std::string& kind) {
  const auto found = method.by_scene.find(scene);
  if (found == method.by_scene.end()) return "-";
  const auto recall = found->second.near_recall_by_kind.find(kind);
  if (recall == found->second.near_recall_by_kind.end() || recall->second.num_object_scans == 0) return "-";
  return Number(100.0 * static_cast<double>(recall->second.num_found) / static_cast<double>(recall->second.num_object_scans), 1);
}

Table MainTable(const Results& results) {
  const auto worlds = WorldsOf(results);
  Row header{"method"};
  for (const auto* world : worlds) {
    if (!world->is_here) {
      header.push_back(world->world);
      continue;
    }
    for (const auto* figure : {"mIoU, %", "false a scan", "things with a segment, %"}) header.push_back(HeadingOf(*world, figure));
    if (world->world.empty()) header.emplace_back("black buoys, %");
  }
  Table table(header);
  for (std::size_t i = 0; i < results.methods.size(); ++i) {
    if (!IsOfInterest(results.methods[i].method)) continue;
    Row row{results.methods[i].method};
    for (const auto* world : worlds) {
      if (!world->is_here) {
        row.emplace_back("not here");
        continue;
      }
      const auto& method = world->methods.at(i);
      row.push_back(Number(100.0 * MeanOverScenes(*world, method, MeanIou), 1));
      row.push_back(Number(MeanOverScenes(*world, method, FalseSegmentsPerScan), 2));
      row.push_back(Number(100.0 * MeanOverScenes(*world, method, ThingsWithSegment), 1));
      if (world->world.empty()) row.push_back(NearRecallOf(method, "black_buoys", "buoy"));
    }
    table.Add(std::move(row));
  }
  return table;
}

Table TimeTable(const Results& results) {
  const auto worlds = WorldsOf(results);
  Row header{"method"};
  for (const auto* world : worlds) {
    if (!world->is_here) continue;
    header.push_back(HeadingOf(*world, "median, ms"));
  }
  Table table(header);
  const auto overall = Find(TablesOf(results), "overall")->table.rows();
  Row row;
  for (std::size_t i = 1; i < overall.size(); ++i) {
    row = {overall[i].front()};
    for (std::size_t k = 1; k < overall[i].size(); ++k) {
      if (overall.front()[k].ends_with("median_ms")) row.push_back(overall[i][k]);
    }
    table.Add(row);
  }
  return table;
}

Table TestTable(const Results& results) {
  Table table({"test", "found"});
  for (const auto& curve : results.curves) {
    if (curve.title.starts_with("Test")) table.Add({curve.title, curve.note});
  }
  return table;
}

// A field in a row: its values, and the mean over the scenes of the mIoU at each.
Table SweepTable(const Results& results) {
  Table table({"field", "its value", "tried", "mIoU, %"});
  for (const auto& curve : results.curves) {
    if (curve.value_of_boat.empty()) continue;
    std::map<double, std::pair<double, int>> sums;
    for (const auto& line : curve.lines) {
      for (const auto& [value, percent] : line.points) {
        sums[value].first += percent;
        ++sums[value].second;
      }
    }
    std::string values;
    std::string means;
    for (const auto& [value, sum] : sums) {
      values += (values.empty() ? "" : " / ") + Number(value, 1);
      means += (means.empty() ? "" : " / ") + Number(sum.first / sum.second, 1);
    }
    table.Add({"`" + curve.x_label + "`", curve.value_of_boat, values, means});
  }
  return table;
}

// A row of our CSV: cells with commas or quotes are quoted.
Row SplitCsv(std::string_view line, const std::string& where) {
  Row row(1);
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"' && row.back().empty()) {
      for (++i;; ++i) {
        if (i >= line.size()) throw std::runtime_error(where + ": a quote is not closed");
        if (line[i] == '"' && i + 1 < line.size() && line[i + 1] == '"') {
          row.back() += line[++i];
        } else if (line[i] == '"') {
          break;
        } else {
          row.back() += line[i];
        }
      }
    } else if (line[i] == ',') {
      row.emplace_back();
    } else {
      row.back() += line[i];
    }
  }
  return row;
}

std::string MarkdownRow(const Row& row) {
  std::string text = "|";
  for (const auto& cell : row) {
    text += ' ';
    for (const char letter : cell) text += letter == '|' ? std::string("\\|") : std::string(1, letter);
    text += " |";
  }
  return text + "\n";
}

std::string ReadText(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw std::runtime_error(file.string() + ": cannot be read");
  return text.str();
}

// Calls with each line, without its end, and its number.
template <typename Handler>
void ForEachLine(std::string_view text, Handler handle) {
  std::int64_t number = 0;
  while (!text.empty()) {
    const auto newline = text.find('\n');
    handle(text.substr(0, newline), ++number);
    text.remove_prefix(newline == std::string_view::npos ? text.size() : newline + 1);
  }
}

}  // namespace

std::vector<ReadmeFigure> FiguresOf(const Results& results, const std::string& date) {
  std::vector<ReadmeFigure> figures;
  const auto tables = TablesOf(results);
  std::vector<std::string> scope{"Measured " + date + " by `./dev figures`, version " + results.version + "."};
  for (const auto* world : WorldsOf(results)) scope.push_back(Scope(*world));
  const auto add = [&](const std::string& name, const std::string& caption, Table table) {
    if (table.empty()) return;
    auto captions = scope;
    captions.insert(captions.begin(), caption);
    figures.push_back({name, std::move(captions), std::move(table)});
  };
  const auto add_table = [&](const std::string& name, const std::string& table_name, const std::string& caption, auto is_wanted) {
    if (const auto* found = Find(tables, table_name)) add(name, caption, SideBySide(RowsWhere(found->table, is_wanted), results));
  };
  const auto all = [](const std::string&) { return true; };
  if (!results.methods.empty()) {
    add("main",
        "Each row is one operating point: mIoU, the segments a scan that hold no return of any object, and the things of 5 returns or more that have "
        "a "
        "segment are of the same segments. Black buoys: recall at IoU 0.5 within " +
            Number(Score::kNearM, 0) + " m, scene black_buoys.",
        MainTable(results));
    add("times", "Of labelling one scan, on one core (" + results.computer + ").", TimeTable(results));
  }
  add_table("miou", "table_1", "mIoU, %.", all);
  add_table("false", "false_segments", "Segments a scan that hold no return of any object.", all);
  add_table("with-segment", "with_segment", "Things of 5 returns or more that have a segment, more than half of which is theirs, %.", IsOfInterest);
  add_table("kinds", "kinds", "Mean IoU by kind of object, %.", IsOfInterest);
  if (const auto* overall = Find(tables, "overall")) {
    add("peers",
        "mIoU, and of it over objects in the water (water), and things with a segment: means over the scenes, %; segments and false segments a scan, "
        "too; over- and under-segmented, true positives: over all scans, %.",
        WithoutColumns(SideBySide(RowsWhere(overall->table, IsPeerName), results), "_ms"));
  }
  add_table("against-peers", "against_peers", "All segments count, of ours and of the peer. Error: 100 - mIoU.", all);
  add_table("table-2", "table_2",
            "The paper's Table II; in print 90.2 / 89.8 / 91.7 % true positives, 1563 / 2726 / 4204 of 5580 points, distance -0.079 / -0.023 / "
            "-0.025 m, sd "
            "0.757 / 0.693 / 0.595 m. First whole scan of each seed.",
            all);
  if (const auto* ablation = Find(tables, "ablation")) {
    const auto is_whole = [](const std::string& method) { return method.starts_with("paper W=") && method.find("90 deg") == std::string::npos; };
    add("ablation", "In print: 460 components and 72 ms with the search, 1604 and 297 ms without.",
        WithoutColumns(SideBySide(RowsWhere(ablation->table, is_whole), results), kSlowestTimes));
  }
  if (const auto sweeps = SweepTable(results); !sweeps.empty()) {
    const auto& sweep = *std::ranges::find_if_not(results.curves, [](const Curve& curve) { return curve.value_of_boat.empty(); });
    figures.push_back({"sweeps",
                       {"One field at a time, all else as it is. mIoU of all segments, mean over the " + std::to_string(sweep.lines.size()) +
                            " scenes with objects, on seeds of tuning (" + sweep.scans_from + ").",
                        scope.front()},
                       sweeps});
  }
  if (const auto tests = TestTable(results); !tests.empty()) {
    figures.push_back({"tests",
                       {"Tests 1 to 3 of the paper, on scenes of their own; " + std::to_string(results.num_seeds) + " seeds from " +
                            std::to_string(results.first_seed) + " on.",
                        scope.front()},
                       tests});
  }
  return figures;
}

void WriteFigures(const std::vector<ReadmeFigure>& figures, const fs::path& folder, bool force) {
  fs::create_directories(folder);
  for (const auto& figure : figures) {
    io::OutputFile file(folder / (figure.name + ".csv"), {.force = force});
    for (const auto& caption : figure.captions) file.stream() << "# " << caption << '\n';
    figure.table.PrintCsv(file.stream());
    file.Commit();
  }
}

std::string ToMarkdown(std::string_view csv, const std::string& file) {
  std::string captions;
  std::string table;
  std::size_t num_columns = 0;
  ForEachLine(csv, [&](std::string_view line, std::int64_t number) {
    const auto where = file + ":" + std::to_string(number);
    if (line.starts_with("# ")) {
      if (num_columns > 0) throw std::runtime_error(where + ": a caption below the table");
      captions += std::string(line.substr(2)) + "\n";
      return;
    }
    const auto row = SplitCsv(line, where);
    const bool is_header = num_columns == 0;
    if (is_header) num_columns = row.size();
    if (row.size() != num_columns) throw std::runtime_error(where + ": not as many cells as the header has");
    table += MarkdownRow(row);
    if (!is_header) return;
    table += '|';
    for (std::size_t i = 0; i < num_columns; ++i) table += "---|";
    table += '\n';
  });
  if (num_columns == 0) throw std::runtime_error(file + ": holds no table");
  return table + "\n" + captions;
}

std::string FillBlocks(std::string_view text, const fs::path& figures_folder, const std::string& file) {
  std::string filled;
  std::int64_t begin_line = 0;  // 0 = not in a block
  ForEachLine(text, [&](std::string_view line, std::int64_t number) {
    const auto refuse = [&](std::int64_t at, const std::string& reason) {
      throw std::runtime_error(file + ":" + std::to_string(at) + ": " + reason);
    };
    if (line.starts_with(kBlockBegin)) {
      if (begin_line > 0) refuse(begin_line, "this block of figures has no end");
      if (!line.ends_with(kBlockNameEnd)) refuse(number, "a block of figures must begin as <!-- figures: NAME -->");
      const std::string name(line.substr(kBlockBegin.size(), line.size() - kBlockBegin.size() - kBlockNameEnd.size()));
      const auto csv = figures_folder / (name + ".csv");
      if (name.find('/') != std::string::npos || !fs::exists(csv)) refuse(number, "there are no figures of this name: " + name);
      begin_line = number;
      filled += std::string(line) + "\n" + ToMarkdown(ReadText(csv), csv.string());
      return;
    }
    if (line == kBlockEnd) {
      if (begin_line == 0) refuse(number, "the end of a block of figures that does not begin");
      begin_line = 0;
    }
    if (begin_line == 0) filled += std::string(line) + "\n";
  });
  if (begin_line > 0) throw std::runtime_error(file + ":" + std::to_string(begin_line) + ": this block of figures has no end");
  // A last line without an end stays without.
  if (!text.empty() && text.back() != '\n' && !filled.empty()) filled.pop_back();
  return filled;
}

}  // namespace lookout::eval
