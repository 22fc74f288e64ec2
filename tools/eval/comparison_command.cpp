#include "tools/eval/comparison_command.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <iterator>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/io/output_file.hpp"
#include "common/io/stop_signal.hpp"
#include "common/messages/checks.hpp"
#include "common/runtime/options.hpp"
#include "services/segmenter/wire.hpp"
#include "tools/eval/captures.hpp"
#include "tools/eval/figures.hpp"
#include "tools/eval/method_comparison.hpp"
#include "tools/eval/methods.hpp"
#include "tools/eval/paper_tests.hpp"
#include "tools/eval/projection.hpp"
#include "tools/eval/report_html.hpp"
#include "tools/eval/result_tables.hpp"
#include "tools/eval/seeds.hpp"
#include "tools/eval/sweep.hpp"
#include "tools/import/kitti.hpp"
#include "tools/import/organise.hpp"
#include "tools/import/pcd.hpp"
#include "tools/import/scan_message.hpp"
#include "tools/sim/scene_file.hpp"

namespace lookout::eval {
namespace {

// Of the processor, as Linux names it.
std::string Computer() {
  std::ifstream cpuinfo("/proc/cpuinfo");
  std::string model = "unknown processor";
  for (std::string line; std::getline(cpuinfo, line);) {
    if (!line.starts_with("model name")) continue;
    model = line.substr(std::min(line.size(), line.find(':') + 2));
    break;
  }
  return model + ", " + std::to_string(std::thread::hardware_concurrency()) + " cores, one used";
}

RunPlan PlanOf(const ComparisonOptions& options, SeedUse use) {
  RunPlan plan{{}, options.first_seed.value_or(DefaultFirstSeed(use)), options.num_seeds, options.seconds};
  for (const auto& scene : options.scenes) {
    if (scene != "all") {
      plan.scenes.push_back(scene);
      continue;
    }
    for (const auto& known : sim::ListScenes(options.config_folder)) plan.scenes.push_back(known.name);
  }
  return plan;
}

// As tables call the captures.
constexpr const char* kSecondWorld = "second world";

// The column of the tables in which recordings stand.
const std::string kPointsLabel = "points";

importer::PointCloud ReadPoints(const std::filesystem::path& file) {
  if (file.extension() == ".pcd") return importer::ReadPcd(file);
  if (file.extension() != ".bin") throw std::invalid_argument("--points " + file.string() + ": must end in .pcd or .bin");
  auto label_file = file;
  label_file.replace_extension(".label");
  return std::filesystem::exists(label_file) ? importer::ReadKitti(file, label_file) : importer::ReadKitti(file, std::nullopt);
}

// As it would come over the bus, in LIDAR_SCAN: a scan that the segmenter would refuse is not scored.
segmenter::Scan ThroughMessages(const segmenter::Scan& scan, const std::string& file) {
  const auto parts = importer::ToScanMessages(scan, "recording", bus::kMaxMessageBytes);
  for (const auto& part : parts) {
    if (messages::FaultOf(part, bus::kMaxMessageBytes)) throw std::runtime_error(file + ": the segmenter refuses this scan");
  }
  auto whole = segmenter::ToScan(parts);
  if (!whole || whole->num_cells() != scan.num_cells()) throw std::runtime_error(file + ": the scan is not whole");
  return std::move(*whole);
}

void AddPoints(const std::vector<std::string>& files, Progress& progress, MethodComparison& comparison) {
  int index = 0;
  for (const auto& file : files) {
    const auto cloud = ReadPoints(file);
    auto organised = importer::Organise(cloud, {});
    organised.labelled.scan = ThroughMessages(organised.labelled.scan, file);
    comparison.Add({kPointsLabel, 0, index++}, organised.labelled);
    std::cerr << file << ": " << cloud.points.size() << " points, " << organised.labelled.scan.head.num_rings() << " rings"
              << (organised.are_rings_found ? "" : " (bands of equal height)") << ", " << organised.num_moved << " moved, " << organised.num_hidden
              << " hidden, " << organised.num_out_of_range << " out of range"
              << (!cloud.has_labels ? "; no labels: every segment counts as false" : "")
              << (cloud.are_classes_objects ? "; no label has an instance: each class is an object" : "") << '\n';
    progress.Step(file);
  }
}

void RunMethods(const RunPlan& plan, const std::vector<std::string>& points, const Boat& boat, const Methods& methods, Results& results) {
  MethodComparison comparison(methods);
  ProjectionTable projections(boat.segmenter);
  Progress progress(&std::cerr, static_cast<std::int64_t>(plan.scenes.size()) * plan.num_seeds + static_cast<std::int64_t>(points.size()));
  ForEachScan(plan, boat, progress, [&](const ScanPlace& place, const LabelledScan& truth) {
    comparison.Add(place, truth);
    // A turn of each seed is enough: the others of the seed look much like it.
    if (place.index == 0) projections.Add(truth);
  });
  AddPoints(points, progress, comparison);
  results.methods = comparison.results();
  results.projections = projections.Rows();
}

void Describe(const ComparisonOptions& options, Results& results) {
  results.command = options.command;
  results.version = runtime::Version();
  results.computer = Computer();
}

std::string NoteOn(const CaptureWithTruth& files, const CaptureReport& report) {
  return files.scene + ", seed " + std::to_string(files.seed) + ": " + std::to_string(report.num_scans) + " scans, " +
         std::to_string(report.num_returns) + " returns, of these " + std::to_string(report.num_own_vessel) + " of the own vessel (left out), " +
         std::to_string(report.num_clutter) + " clutter, " + std::to_string(report.num_unmatched) + " without truth (taken for clutter)";
}

Results RunCaptures(const ComparisonOptions& options) {
  Results results;
  results.world = kSecondWorld;
  Describe(options, results);
  if (!std::filesystem::exists(options.captures)) {
    results.is_here = false;
    std::cerr << kSecondWorld << ": " << options.captures.string() << " is not here\n";
    return results;
  }
  const auto captures = ListCaptures(options.captures);
  if (captures.empty()) throw std::runtime_error(options.captures.string() + ": holds no capture (NAME-SEED.pcap.xz)");
  const auto boat = LoadBoatOfCaptures(options.captures, options.config_folder);
  const auto methods = MakeMethods(boat.segmenter, options.methods);
  MethodComparison comparison(methods);
  ProjectionTable projections(boat.segmenter);
  Progress progress(&std::cerr, static_cast<std::int64_t>(captures.size()));
  for (const auto& files : captures) {
    if (results.scenes.empty() || results.scenes.back() != files.scene) results.scenes.push_back(files.scene);
    ScanPlace place{files.scene, files.seed, 0};
    const auto report = ReadCapture(files, boat, [&](const LabelledScan& truth) {
      comparison.Add(place, truth);
      if (place.index == 0) projections.Add(truth);
      ++place.index;
    });
    results.notes.push_back(NoteOn(files, report));
    progress.Step(std::string(kSecondWorld) + ": " + files.scene + ", seed " + std::to_string(files.seed));
  }
  results.methods = comparison.results();
  results.projections = projections.Rows();
  return results;
}

// Of UTC.
std::string Today() {
  const std::chrono::year_month_day today(std::chrono::floor<std::chrono::days>(std::chrono::system_clock::now()));
  std::ostringstream text;
  text << static_cast<int>(today.year()) << '-' << std::setfill('0') << std::setw(2) << static_cast<unsigned>(today.month()) << '-' << std::setw(2)
       << static_cast<unsigned>(today.day());
  return text.str();
}

// Said before a run of minutes, not after it.
void RefuseIfThere(const std::filesystem::path& folder, bool is_forced) {
  if (is_forced || folder.empty() || !std::filesystem::exists(folder)) return;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".csv") throw std::runtime_error(entry.path().string() + ": is there already; --force replaces it");
  }
}

}  // namespace

int CompareMethods(const ComparisonOptions& options) {
  const auto boat = LoadBoat(options.config_folder);
  const auto use = options.is_tuning ? SeedUse::kTuning : SeedUse::kTables;
  const auto plan = PlanOf(options, use);
  const auto sweep_plan = PlanOf(options, SeedUse::kTuning);
  const bool has_scenes = !options.methods.empty() && !options.scenes.empty();
  if (has_scenes || !options.tests.empty()) CheckSeeds(use, plan.first_seed, plan.num_seeds);
  if (!options.sweeps.empty()) CheckSeeds(SeedUse::kTuning, sweep_plan.first_seed, sweep_plan.num_seeds);
  if (options.is_tuning && !(options.csv_folder.empty() && options.html_file.empty() && options.figures_folder.empty())) {
    throw std::invalid_argument("--tuning: no table is written of seeds of tuning: leave out --csv, --html and --figures");
  }
  std::vector<Sweep> sweeps;
  for (const auto& text : options.sweeps) {
    sweeps.push_back(ParseSweep(text));
    // A value that is out of range stops the run before it begins.
    for (const double value : sweeps.back().values) ParamsWith(boat, sweeps.back().field, value);
  }
  const auto methods = MakeMethods(boat.segmenter, options.methods);

  io::CatchStopSignals();
  RefuseIfThere(options.csv_folder, options.is_forced);
  RefuseIfThere(options.figures_folder, options.is_forced);
  std::optional<io::OutputFile> page;
  if (!options.html_file.empty()) page.emplace(options.html_file, io::OutputOptions{.force = options.is_forced});

  Results results;
  Describe(options, results);
  const bool is_sweep_alone = !has_scenes && options.tests.empty() && !options.sweeps.empty();
  results.first_seed = is_sweep_alone ? sweep_plan.first_seed : plan.first_seed;
  results.num_seeds = plan.num_seeds;
  results.seconds = plan.seconds;
  for (const auto& scene : plan.scenes) results.scenes.push_back(SceneLabel(scene));
  if (!options.points.empty()) results.scenes.push_back(kPointsLabel);
  if (!methods.empty()) RunMethods(plan, options.points, boat, methods, results);
  if (!options.captures.empty()) {
    auto captures = RunCaptures(options);
    if (results.scenes.empty() && !captures.is_here) throw std::runtime_error(options.captures.string() + ": is not here");
    // Alone, they are the tables.
    if (results.scenes.empty() && options.tests.empty()) {
      results = std::move(captures);
    } else {
      results.other_worlds.push_back(std::move(captures));
    }
  }
  for (const int test : options.tests) results.curves.push_back(RunPaperTest(test, plan, boat, &std::cerr));
  for (const auto& sweep : sweeps) results.curves.push_back(RunSweep(sweep, sweep_plan, boat, &std::cerr));

  PrintTables(results, std::cout);
  if (!options.csv_folder.empty()) WriteCsv(results, options.csv_folder, options.is_forced);
  if (page) {
    WriteHtml(results, page->stream());
    page->Commit();
  }
  if (!options.figures_folder.empty()) WriteFigures(FiguresOf(results, Today()), options.figures_folder, options.is_forced);
  return FillBlocksOfFiles(options);
}

int FillBlocksOfFiles(const ComparisonOptions& options) {
  for (const auto& file : options.block_files) {
    std::ifstream in(file, std::ios::binary);
    const std::string text(std::istreambuf_iterator<char>(in), {});
    if (!in) throw std::runtime_error(file.string() + ": cannot be read");
    const auto filled = FillBlocks(text, options.figures_folder, file.string());
    if (filled == text) continue;
    io::OutputFile out(file, {.force = true});
    out.Write(filled);
    out.Commit();
    std::cerr << file.string() << ": figures filled in\n";
  }
  return EXIT_SUCCESS;
}

}  // namespace lookout::eval
