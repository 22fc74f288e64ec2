#include "lab/eval/methods/figures.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <numeric>
#include <stdexcept>

#include "common/io/output_file.hpp"
#include "common/runtime/version.hpp"
#include "lab/eval/methods/leave_out.hpp"
#include "lab/eval/methods/result_tables.hpp"

namespace lookout::eval {
namespace {

using Row = Table::Row;

constexpr std::string_view kBlockBegin = "<!-- figures: ";
constexpr std::string_view kBlockNameEnd = " -->";
constexpr std::string_view kBlockEnd = "<!-- end -->";
constexpr std::array<std::string_view, 40> kFigureNames{"main",
                                                        "times",
                                                        "miou",
                                                        "false",
                                                        "with-segment",
                                                        "kinds",
                                                        "peers",
                                                        "against-peers",
                                                        "table-2",
                                                        "ablation",
                                                        "sweeps",
                                                        "tests",
                                                        "tracks_identities",
                                                        "tracks_gospa",
                                                        "tracks_times",
                                                        "tracks_states",
                                                        "tracks_labels",
                                                        "autoferry",
                                                        "autoferry_targets",
                                                        "tracks_targets",
                                                        "tracks_approaches",
                                                        "tracks_ablation",
                                                        "tracks_left_out",
                                                        "alerts_targets",
                                                        "alerts_verdicts",
                                                        "alerts_levels",
                                                        "alerts_causes",
                                                        "alerts_dangers",
                                                        "alerts_standing",
                                                        "alerts_left_out",
                                                        "long_alerts_targets",
                                                        "long_alerts_verdicts",
                                                        "long_alerts_causes",
                                                        "long_alerts_dangers",
                                                        "learned",
                                                        "learned-lost",
                                                        "learned-families",
                                                        "learned-families-lost",
                                                        "sensors",
                                                        "sensors_families"};

// In headings of columns a world stands before its figure.
std::string HeadingOf(const Results& world, const std::string& text) { return world.world.empty() ? text : world.world + ": " + text; }

std::vector<const Results*> WorldsOf(const Results& results) {
  std::vector<const Results*> worlds{&results};
  for (const auto& world : results.other_worlds) worlds.push_back(&world);
  return worlds;
}

// Columns of other worlds right behind the column of ours that they are the counterpart of; those without one at the end.
std::vector<std::size_t> SideBySide(const Row& header, const Results& results) {
  const auto place_of = [&](std::size_t column) {
    for (const auto& world : results.other_worlds) {
      if (header[column] == world.world) return header.size();
      const auto prefix = HeadingOf(world, "");
      if (!header[column].starts_with(prefix)) continue;
      return static_cast<std::size_t>(std::ranges::find(header, header[column].substr(prefix.size())) - header.begin());
    }
    return column;
  };
  std::vector<std::size_t> order(header.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, place_of);
  return order;
}

bool IsAny(const std::string& /*text*/) { return true; }

bool IsLearned(const std::string& method) { return method.starts_with("SqueezeSeg"); }

bool IsOfInterest(const std::string& method) {
  return method.starts_with("ours") || method == "paper W=1800" || method.find("(tuned") != std::string::npos || IsLearned(method);
}

bool IsPeerName(const std::string& method) { return !method.starts_with("ours") && !method.starts_with("paper"); }

// "Own simulator: 40 scans of 2 scenes, ...; mIoU is the mean over the 1 with objects (open_water counts for false segments alone)."
std::string Scope(const Results& world) {
  if (!world.is_here) return fmt::format("The {}: not here.", world.world);
  std::int64_t num_scans = 0;
  int num_with_object = 0;
  std::vector<std::string> without_object;
  for (const auto& scene : world.scenes) {
    if (world.methods.empty() || !world.methods.front().by_scene.contains(scene)) continue;
    const auto& score = world.methods.front().by_scene.at(scene);
    num_scans += score.num_scans();
    if (score.iou.count > 0) {
      ++num_with_object;
    } else {
      without_object.push_back(scene);
    }
  }
  const bool is_own = world.world.empty();
  auto text = fmt::format("{}: {} scans of {} scenes", is_own ? "Own simulator" : "The " + world.world, num_scans, world.scenes.size());
  if (is_own && world.num_seeds > 0) {
    text += fmt::format(", {} seeds each from {} on, {:.1f} s a seed", world.num_seeds, world.first_seed, world.seconds);
  }
  text += fmt::format("; mIoU is the mean over the {} with objects", num_with_object);
  if (!without_object.empty()) text += fmt::format(" ({} counts for false segments alone)", fmt::join(without_object, ", "));
  return text + ".";
}

// Recall of one kind near the boat, over all scenes of a world that hold it in their name; "-" = there is none.
std::string NearRecallOf(const MethodResult& method, const std::string& scene, const std::string& kind) {
  const auto found = method.by_scene.find(scene);
  if (found == method.by_scene.end()) return "-";
  const auto recall = found->second.near_recall_by_kind.find(kind);
  return recall == found->second.near_recall_by_kind.end() ? "-" : Number(100.0 * recall->second.value(), 1);
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
      row.push_back(Number(100.0 * MeanOverScenes(*world, method, &Score::iou), 1));
      row.push_back(Number(MeanOverScenes(*world, method, &Score::false_segments), 2));
      row.push_back(Number(100.0 * MeanOverScenes(*world, method, &Score::with_segment), 1));
      if (world->world.empty()) row.push_back(NearRecallOf(method, "black_buoys", "buoy"));
    }
    table.Add(std::move(row));
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
    std::map<double, Mean> percents;
    for (const auto& line : curve.lines) {
      for (const auto& [value, percent] : line.points) percents[value].Add(percent);
    }
    std::string values;
    std::string means;
    for (const auto& [value, percent] : percents) {
      values += (values.empty() ? "" : " / ") + Number(value, 1);
      means += (means.empty() ? "" : " / ") + Number(percent.value(), 1);
    }
    table.Add({"`" + curve.x_label + "`", curve.value_of_boat, values, means});
  }
  return table;
}

std::string MeasuredOn(const std::string& date, const std::string& version) {
  return fmt::format("Measured {} by `./dev figures`, version {}.", date, version);
}

}  // namespace

std::vector<ReadmeFigure> FiguresOf(const Results& results, const std::string& date) {
  const auto measured = MeasuredOn(date, results.version);
  std::vector<std::string> scope{measured};
  for (const auto* world : WorldsOf(results)) scope.push_back(Scope(*world));
  std::vector<ReadmeFigure> figures;
  const auto add = [&figures](const std::string& name, std::string caption, std::vector<std::string> captions, Table table) {
    if (table.empty()) return;
    captions.insert(captions.begin(), std::move(caption));
    figures.push_back({name, std::move(captions), std::move(table)});
  };
  const auto tables = TablesOf(results);
  // Adds, of a table of the run, the methods and columns that are wanted.
  const auto add_table = [&](const std::string& name, const std::string& table_name, const std::string& caption,
                             bool (*is_wanted)(const std::string&), bool (*is_column_wanted)(const std::string&) = IsAny) {
    const auto found = std::ranges::find(tables, table_name, &NamedTable::name);
    if (found == tables.end()) return;
    auto columns = SideBySide(found->table.header(), results);
    std::erase_if(columns, [&](std::size_t column) { return !is_column_wanted(found->table.header()[column]); });
    add(name, caption, scope, found->table.Select(columns, is_wanted));
  };
  if (!results.methods.empty()) {
    add("main",
        fmt::format(
            "Each row counts one set of segments in all columns. False a scan: segments that hold no return of any object. Things with a segment: "
            "share of the objects with 5 returns or more that have one. Black buoys: recall at IoU 0.5 within {:.0f} m, scene black_buoys.",
            Score::kNearM),
        scope, MainTable(results));
    // On a computer that does other work the 99th percentile says more about that work than about the method: medians alone are shown.
    add_table("times", "overall", fmt::format("Of labelling one scan, on one core ({}).", results.computer), IsAny,
              [](const std::string& heading) { return heading == "method" || heading.ends_with("median_ms"); });
  }
  add_table("miou", "table_1", "mIoU, %.", IsAny);
  add_table("false", "false_segments", "Segments a scan that hold no return of any object.", IsAny);
  add_table("with-segment", "with_segment", "Things of 5 returns or more that have a segment, more than half of which is theirs, %.", IsOfInterest);
  add_table("kinds", "kinds", "Mean IoU by kind of object, %.", IsOfInterest);
  add_table("peers", "overall",
            "mIoU, and of it over objects in the water (water), and things with a segment: means over the scenes, %; segments and false segments a "
            "scan, too; over- and under-segmented, true positives: over all scans, %.",
            IsPeerName, [](const std::string& heading) { return !heading.ends_with("_ms"); });
  add_table("against-peers", "against_peers", "All segments count, of ours and of the peer. Error: 100 - mIoU.", IsAny);
  add_table("table-2", "table_2",
            "The paper's Table II; in print 90.2 / 89.8 / 91.7 % true positives, 1563 / 2726 / 4204 of 5580 points, distance -0.079 / -0.023 / "
            "-0.025 m, sd 0.757 / 0.693 / 0.595 m. First whole scan of each seed.",
            IsAny);
  add_table(
      "ablation", "ablation", "In print: 460 components and 72 ms with the search, 1604 and 297 ms without.",
      [](const std::string& method) { return method.starts_with("paper W=") && method.find("90 deg") == std::string::npos; },
      [](const std::string& heading) { return !heading.ends_with("p99_ms"); });
  if (std::ranges::any_of(results.methods, IsLearned, &MethodResult::method)) {
    const bool is_left_out = std::ranges::any_of(results.methods, [](const auto& method) { return method.method.starts_with(kLeftOut); });
    const std::string name = is_left_out ? "learned-families" : "learned";
    add_table(
        name, "overall",
        fmt::format("mIoU, of it over objects in the water (water), things with a segment: means over the scenes, %; false segments a scan; time "
                    "of a scan on one core ({}).",
                    results.computer),
        IsOfInterest, [](const std::string& heading) {
          return std::ranges::any_of(std::array{"method", "mIoU_%", "water_%", "false", "with_segment_%", "median_ms"},
                                     [&](std::string_view end) { return heading.ends_with(end); });
        });
    add_table(name + "-lost", "things_lost", "Things of 5 returns or more with an IoU below 0.5, by what became of them, % of all things.",
              IsOfInterest, [](const std::string& heading) {
                return !std::ranges::any_of(std::array{"near_land", "near_land_found_%", "land_segments", "segments_of_land_object"},
                                            [&](std::string_view end) { return heading.ends_with(end); });
              });
  }
  if (const auto sweep = std::ranges::find_if_not(results.curves, &std::string::empty, &Curve::value_of_boat); sweep != results.curves.end()) {
    add("sweeps",
        fmt::format("One field at a time, all else as it is. mIoU of all segments, mean over the {} scenes with objects, on seeds of tuning ({}).",
                    sweep->lines.size(), sweep->scans_from),
        {measured}, SweepTable(results));
  }
  add("tests", fmt::format("Tests 1 to 3 of the paper, on scenes of their own; {} seeds from {} on.", results.num_seeds, results.first_seed),
      {measured}, TestTable(results));
  return figures;
}

std::string FillBlocks(std::string_view text, const std::vector<ReadmeFigure>& figures, const std::string& file) {
  const auto refuse = [&file](std::int64_t line, const std::string& reason) {
    throw std::runtime_error(fmt::format("{}:{}: {}", file, line, reason));
  };
  std::string filled;
  std::int64_t number = 0;
  std::int64_t begin_line = 0;  // 0 = not in a block
  bool is_replaced = false;     // the block that the line is in
  while (!text.empty()) {
    const auto newline = text.find('\n');
    const auto line = text.substr(0, newline);
    const auto line_with_end = text.substr(0, newline == std::string_view::npos ? newline : newline + 1);
    text.remove_prefix(line_with_end.size());
    ++number;
    if (line.starts_with(kBlockBegin)) {
      if (begin_line > 0) refuse(begin_line, "this block of figures has no end");
      if (!line.ends_with(kBlockNameEnd)) refuse(number, "a block of figures must begin as <!-- figures: NAME -->");
      const std::string name(line.substr(kBlockBegin.size(), line.size() - kBlockBegin.size() - kBlockNameEnd.size()));
      if (std::ranges::find(kFigureNames, name) == kFigureNames.end()) refuse(number, "there are no figures of this name: " + name);
      begin_line = number;
      const auto figure = std::ranges::find(figures, name, &ReadmeFigure::name);
      is_replaced = figure != figures.end();
      filled += line_with_end;
      if (is_replaced) filled += fmt::format("{}\n{}\n", figure->table.ToMarkdown(), fmt::join(figure->captions, "\n"));
      continue;
    }
    if (line == kBlockEnd) {
      if (begin_line == 0) refuse(number, "the end of a block of figures that does not begin");
      begin_line = 0;
      is_replaced = false;
    }
    if (!is_replaced) filled += line_with_end;
  }
  if (begin_line > 0) refuse(begin_line, "this block of figures has no end");
  return filled;
}

std::vector<ReadmeFigure> FiguresOf(const std::vector<NamedTable>& tables, const std::string& scope) {
  std::vector<ReadmeFigure> figures;
  figures.reserve(tables.size());
  for (const auto& [name, title, table, is_printed] : tables) figures.push_back({name, {title + ".", MeasuredToday(), scope}, table});
  return figures;
}

std::string Today() { return fmt::format("{:%F}", fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now()))); }

std::string MeasuredToday() { return MeasuredOn(Today(), runtime::Version()); }

void FillBlocksOf(const std::vector<std::filesystem::path>& files, const std::vector<ReadmeFigure>& figures) {
  for (const auto& file : files) {
    std::ifstream in(file, std::ios::binary);
    const std::string text(std::istreambuf_iterator<char>(in), {});
    if (!in) throw std::runtime_error(file.string() + ": cannot be read");
    const auto filled = FillBlocks(text, figures, file.string());
    if (filled == text) continue;
    io::OutputFile out(file, {.force = true});
    out.Write(filled);
    out.Commit();
    std::cerr << file.string() << ": figures filled in\n";
  }
}

}  // namespace lookout::eval
