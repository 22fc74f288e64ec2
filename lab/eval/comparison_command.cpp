#include "lab/eval/comparison_command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/io/output_file.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/progress.hpp"
#include "common/runtime/version.hpp"
#include "lab/data/kitti.hpp"
#include "lab/data/organise.hpp"
#include "lab/data/pcd.hpp"
#include "lab/data/scan_message.hpp"
#include "lab/eval/baselines/squeezeseg.hpp"
#include "lab/eval/methods/captures.hpp"
#include "lab/eval/methods/figures.hpp"
#include "lab/eval/methods/leave_out.hpp"
#include "lab/eval/methods/lost_list.hpp"
#include "lab/eval/methods/method_comparison.hpp"
#include "lab/eval/methods/methods.hpp"
#include "lab/eval/methods/paper_tests.hpp"
#include "lab/eval/methods/projection.hpp"
#include "lab/eval/methods/result_tables.hpp"
#include "lab/eval/methods/sweep.hpp"
#include "lab/eval/methods/worst_pictures.hpp"
#include "lab/eval/report/report_page.hpp"
#include "lab/eval/tracks/over_time.hpp"
#include "lab/eval/tracks/track_sources.hpp"
#include "lab/sim/scene_file.hpp"
#include "tools/replay/chain.hpp"

namespace lookout::eval {
namespace {

constexpr const char* kFamilies = "families";

}  // namespace

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

std::set<std::string> LeftOutOf(const ComparisonOptions& options) {
  std::set<std::string> families;
  for (const auto& known : sim::ListFamilies(options.config_folder)) families.insert(known.name);
  std::set<std::string> left_out;
  for (const auto& name : options.left_out) {
    if (name == kFamilies) return families;
    if (!families.contains(name))
      throw std::invalid_argument(fmt::format("--leave-out: no such family: {} (there are: {})", name, fmt::join(families, ", ")));
    left_out.insert(name);
  }
  return left_out;
}

namespace {

// As tables call the captures.
constexpr const char* kSecondWorld = "second world";

// Nothing is fitted on them, also where a scene of ours is called the same.
std::unique_ptr<Method> LeftOutOfCaptures(const ComparisonOptions& options, const Boat& boat) {
  const auto evidence = LeaveOutEvidence(options.weights_folder, {}).FileOf(kSecondWorld);
  return std::make_unique<SegmenterMethod>(std::string(kLeftOut), WithEvidence(boat, evidence));
}

// The column of the tables in which recordings stand.
const std::string kPointsLabel = "points";

data::PointCloud ReadPoints(const std::filesystem::path& file) {
  if (file.extension() == ".pcd") return data::ReadPcd(file);
  if (file.extension() != ".bin") throw std::invalid_argument("--points " + file.string() + ": must end in .pcd or .bin");
  auto label_file = file;
  label_file.replace_extension(".label");
  return std::filesystem::exists(label_file) ? data::ReadKitti(file, label_file) : data::ReadKitti(file, std::nullopt);
}

void AddPoints(const std::vector<std::string>& files, MethodComparison& comparison) {
  int index = 0;
  for (const auto& file : files) {
    const auto cloud = ReadPoints(file);
    auto organised = data::Organise(cloud);
    auto& scan = organised.labelled.scan;
    // Takes the scan as it would come over the bus: a scan that the segmenter would refuse is not scored.
    auto received = ScanOfMessages(data::ToScanMessages(scan, "recording", bus::kMaxMessageBytes));
    if (!received || received->num_cells() != scan.num_cells()) throw std::runtime_error(file + ": the segmenter refuses this scan");
    scan = std::move(*received);
    comparison.Add({kPointsLabel, 0, index++}, organised.labelled);
    std::cerr << fmt::format("{}: {} points, {} rings{}, {} moved, {} hidden, {} out of range{}{}\n", file, cloud.points.size(),
                             organised.labelled.scan.head.num_rings(), organised.are_rings_found ? "" : " (bands of equal height)",
                             organised.num_moved, organised.num_hidden, organised.num_out_of_range,
                             cloud.has_labels ? "" : "; no labels: every segment counts as false",
                             cloud.are_classes_objects ? "; no label has an instance: each class is an object" : "");
  }
}

// Lists and pictures of failures, of all worlds.
class Failures {
 public:
  explicit Failures(const ComparisonOptions& options) : options_(options), pictures_(options.num_worst) {
    if (options.lost_file.empty()) return;
    file_.emplace(options.lost_file, io::OutputOptions{.force = options.is_forced});
    list_.emplace(file_->stream());
  }

  /// @param world  stands before the names of scenes; empty = ours
  ScoredScanHandler HandlerOf(const std::string& world) {
    if (!list_ && options_.pictures_folder.empty()) return {};
    return [this, prefix = world.empty() ? "" : world + ": "](const std::string& method, ScanPlace place, const LabelledScan& truth,
                                                              const std::vector<std::int32_t>& label, const Score& score) {
      place.scene = prefix + place.scene;
      if (list_) list_->Add(method, place, truth, label);
      if (!options_.pictures_folder.empty()) pictures_.Add(method, place, truth, label, score);
    };
  }

  void Write() {
    if (file_) file_->Commit();
    if (!options_.pictures_folder.empty()) pictures_.Write(options_.pictures_folder, options_.is_forced);
  }

 private:
  const ComparisonOptions& options_;
  std::optional<io::OutputFile> file_;
  std::optional<LostList> list_;
  WorstPictures pictures_;
};

// The results of the scans of one world: scores, and for a scan of each seed (the others look much like it) the returns that the paper's image keeps.
class World {
 public:
  World(const segmenter::Params& boat, const Methods& methods, ScoredScanHandler on_scored)
      : comparison(methods, std::move(on_scored)), projections(boat) {}

  void Add(const ScanPlace& place, const LabelledScan& truth) {
    comparison.Add(place, truth);
    if (place.index == 0) projections.Add(truth);
  }
  void Finish(Results& results) const {
    results.methods = comparison.results();
    results.projections = projections.Rows();
  }

  MethodComparison comparison;
  ProjectionTable projections;
};

void Describe(const ComparisonOptions& options, Results& results) {
  results.command = options.command;
  results.version = runtime::Version();
  results.computer = Computer();
}

Results RunCaptures(const ComparisonOptions& options, Failures& failures) {
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
  const ConfigOfCaptures config(options.captures, options.config_folder);
  auto methods = MethodsOf(options, boat, [&] { return std::make_unique<OverTimeMethod>(config.path(), FeedOfCaptures(captures)); });
  if (!options.left_out.empty()) methods.insert(methods.begin(), LeftOutOfCaptures(options, boat));
  World world(boat.segmenter, methods, failures.HandlerOf(kSecondWorld));
  runtime::Progress progress("lookout-eval", stderr);
  for (const auto& files : captures) {
    if (results.scenes.empty() || results.scenes.back() != files.scene) results.scenes.push_back(files.scene);
    ScanPlace place{files.scene, files.seed, 0};
    const auto name = fmt::format("{}, seed {}", files.scene, files.seed);
    const auto report = ReadCapture(files, boat, [&](const LabelledScan& truth) {
      world.Add(place, truth);
      ++place.index;
      progress.Update(static_cast<double>(results.notes.size()) / static_cast<double>(captures.size()),
                      [&] { return fmt::format("{}: {}", kSecondWorld, name); });
    });
    results.notes.push_back(
        fmt::format("{}: {} scans, {} returns, of these {} of the own vessel (left out), {} clutter, {} without truth (taken for clutter)", name,
                    report.num_scans, report.num_returns, report.num_own_vessel, report.num_clutter, report.num_unmatched));
  }
  world.Finish(results);
  return results;
}

// Said before a run of minutes, not after it. Only where the run writes: files lie in subfolders so deep.
void RefuseIfThere(const std::filesystem::path& folder, const char* ending, int depth) {
  if (folder.empty() || !std::filesystem::exists(folder)) return;
  const std::filesystem::recursive_directory_iterator end;
  for (std::filesystem::recursive_directory_iterator entry(folder); entry != end; ++entry) {
    if (entry.depth() >= depth) entry.disable_recursion_pending();
    if (entry.depth() != depth || entry->path().extension() != ending) continue;
    throw std::runtime_error(entry->path().string() + ": is there already; --force replaces it");
  }
}

bool IsSqueezeSeg(const std::string& name) { return name == kSqueezeSeg || name == "squeezeseg"; }

void AddSqueezeSeg(const ComparisonOptions& options, const Boat& boat, Methods& methods) {
  const auto folder = NetworkFolderOf(options);
  if (!std::filesystem::exists(folder)) {
    const auto reason = fmt::format("{}: {} is not here, which holds its weights", kSqueezeSeg, folder.string());
    if (std::ranges::any_of(options.methods, IsSqueezeSeg) || !options.network_folder.empty()) throw std::invalid_argument("--methods: " + reason);
    std::cerr << reason << ": it is left out\n";
    return;
  }
  const auto& filter = boat.segmenter.filter;
  const LearnedWeights weights(folder);
  if (!options.left_out.empty()) methods.push_back(std::make_unique<SqueezeSegLeftOut>(weights, filter, LeftOutOf(options)));
  methods.push_back(
      std::make_unique<Peer>(std::string(kSqueezeSeg), filter, SizeLimits{}, SqueezeSegGrouping(weights.OfAll(), kSqueezeSegInstances)));
}

}  // namespace

std::filesystem::path NetworkFolderOf(const ComparisonOptions& options) {
  return options.network_folder.empty() ? std::filesystem::path(LOOKOUT_NETWORK_FOLDER) : options.network_folder;
}

Methods MethodsOf(const ComparisonOptions& options, const Boat& boat, const std::function<std::unique_ptr<Method>()>& make_over_time) {
  auto names = options.methods;
  const bool is_over_time = std::ranges::any_of(names, [](const auto& name) { return name == "all" || name == "ours" || name == kOverTime; });
  const bool is_squeezeseg = std::ranges::any_of(names, [](const auto& name) { return name == "all" || name == "peers" || IsSqueezeSeg(name); });
  std::erase(names, kOverTime);
  std::erase_if(names, IsSqueezeSeg);
  auto methods = MakeMethods(boat.segmenter, names);
  if (is_squeezeseg) AddSqueezeSeg(options, boat, methods);
  if (!is_over_time) return methods;
  const auto behind_ours = std::ranges::find_if_not(methods, [](const auto& method) { return method->name().starts_with("ours"); });
  methods.insert(behind_ours, make_over_time());
  return methods;
}

RunPlan PlanOf(const ComparisonOptions& options, SeedUse use) {
  const auto first_seed = use == SeedUse::kTuning ? kFirstTuningSeed : kFirstTableSeed;
  return {NamesOfScenes(options.scenes, options.config_folder), options.first_seed.value_or(first_seed), options.num_seeds, options.seconds,
          options.lidars};
}

int CompareMethods(const ComparisonOptions& options) {
  const auto boat = LoadBoat(options.config_folder);
  const auto use = options.is_tuning ? SeedUse::kTuning : SeedUse::kTables;
  const auto plan = PlanOf(options, use);
  const auto sweep_plan = PlanOf(options, SeedUse::kTuning);
  const bool has_scenes = !options.methods.empty() && !options.scenes.empty();
  if (has_scenes || !options.tests.empty()) plan.CheckSeeds(use);
  if (!options.sweeps.empty()) sweep_plan.CheckSeeds(SeedUse::kTuning);
  if (options.is_tuning && !(options.csv_folder.empty() && options.html_file.empty() && options.block_files.empty())) {
    throw std::invalid_argument("--tuning: no table is written of seeds of tuning: leave out --csv, --html and --blocks");
  }
  std::vector<Sweep> sweeps;
  for (const auto& text : options.sweeps) {
    sweeps.push_back(ParseSweep(text));
    // A value that is out of range stops the run before it begins.
    for (const double value : sweeps.back().values) ParamsWith(boat, sweeps.back().field, value);
  }
  std::vector<std::string> scenes;
  for (const auto& scene : plan.scenes) scenes.push_back(SceneLabel(scene));
  if (!options.points.empty()) scenes.push_back(kPointsLabel);
  auto methods = MethodsOf(options, boat, [&] {
    replay::CheckConfig(options.config_folder);
    return std::make_unique<OverTimeMethod>(options.config_folder, FeedOfScenes(options.config_folder, plan.scenes, plan.seconds));
  });
  if (!options.left_out.empty()) {
    methods.insert(methods.begin(), std::make_unique<LeaveOutMethod>(boat, LeaveOutEvidence(options.weights_folder, LeftOutOf(options)), scenes));
    if (!options.captures.empty()) LeftOutOfCaptures(options, boat);  // a missing file stops the run before it begins
  }

  io::CatchStopSignals();
  if (!options.is_forced) {
    RefuseIfThere(options.csv_folder, ".csv", 0);
    RefuseIfThere(options.pictures_folder, ".svg", 2);  // METHOD/SCENE
  }
  FillBlocksOf(options.block_files, {});  // a block that is wrong stops the run before it begins
  std::optional<io::OutputFile> page;
  if (!options.html_file.empty()) page.emplace(options.html_file, io::OutputOptions{.force = options.is_forced});
  Failures failures(options);

  Results results;
  Describe(options, results);
  const bool is_sweep_alone = !has_scenes && options.tests.empty() && !options.sweeps.empty();
  results.first_seed = is_sweep_alone ? sweep_plan.first_seed : plan.first_seed;
  results.num_seeds = plan.num_seeds;
  results.seconds = plan.seconds;
  results.scenes = scenes;
  if (!methods.empty()) {
    World world(boat.segmenter, methods, failures.HandlerOf(""));
    ForEachScan(plan, boat, stderr, [&world](const ScanPlace& place, const LabelledScan& truth) { world.Add(place, truth); });
    AddPoints(options.points, world.comparison);
    world.Finish(results);
  }
  if (!options.captures.empty()) {
    auto captures = RunCaptures(options, failures);
    if (results.scenes.empty() && !captures.is_here) throw std::runtime_error(options.captures.string() + ": is not here");
    // Alone, they are the tables.
    if (results.scenes.empty() && options.tests.empty()) {
      results = std::move(captures);
    } else {
      results.other_worlds.push_back(std::move(captures));
    }
  }
  for (const int test : options.tests) results.curves.push_back(RunPaperTest(test, plan, boat, stderr));
  for (const auto& sweep : sweeps) results.curves.push_back(RunSweep(sweep, sweep_plan, boat, stderr));

  PrintTables(results, std::cout);
  failures.Write();
  const auto tables = TablesOf(results);
  TableFiles(options.csv_folder, tables, options.is_forced).Commit(tables);
  if (page) {
    WriteHtml(results, page->stream());
    page->Commit();
  }
  if (!options.block_files.empty()) FillBlocksOf(options.block_files, FiguresOf(results, Today()));
  return EXIT_SUCCESS;
}

}  // namespace lookout::eval
