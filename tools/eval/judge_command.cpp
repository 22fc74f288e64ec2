#include "tools/eval/judge_command.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <thread>
#include <utility>
#include <variant>

#include "common/bus/channels.hpp"
#include "common/runtime/options.hpp"
#include "services/segmenter/core/turn_gatherer.hpp"
#include "services/segmenter/wire.hpp"
#include "tools/eval/judge.hpp"
#include "tools/eval/methods.hpp"
#include "tools/eval/paper_tests.hpp"
#include "tools/eval/projection.hpp"
#include "tools/eval/readers/kitti.hpp"
#include "tools/eval/readers/organise.hpp"
#include "tools/eval/readers/pcd.hpp"
#include "tools/eval/readers/scan_message.hpp"
#include "tools/eval/report_html.hpp"
#include "tools/eval/result_tables.hpp"
#include "tools/eval/sweep.hpp"
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

RunPlan PlanOf(const JudgeOptions& options) {
  RunPlan plan{{}, options.first_seed, options.num_seeds, options.seconds};
  for (const auto& scene : options.scenes) {
    if (scene != "all") {
      plan.scenes.push_back(scene);
      continue;
    }
    for (const auto& known : sim::ListScenes(options.config_folder)) plan.scenes.push_back(known.name);
  }
  return plan;
}

// The column of the tables in which recordings stand.
const std::string kPointsLabel = "points";

PointCloud ReadPoints(const std::filesystem::path& file) {
  if (file.extension() == ".pcd") return ReadPcd(file);
  if (file.extension() != ".bin") throw std::invalid_argument("--points " + file.string() + ": must end in .pcd or .bin");
  auto label_file = file;
  label_file.replace_extension(".label");
  return std::filesystem::exists(label_file) ? ReadKitti(file, label_file) : ReadKitti(file, std::nullopt);
}

// As it would come over the bus, in LIDAR_SCAN: a turn that the segmenter would refuse is not judged.
segmenter::Scan ThroughMessages(const segmenter::Scan& scan, const std::string& file) {
  segmenter::TurnGatherer gatherer;
  for (const auto& message : ToScanMessages(scan, "recording", bus::kMaxMessageBytes)) {
    auto part = segmenter::ToScanPart(message, bus::kMaxMessageBytes);
    if (!std::holds_alternative<segmenter::ScanPart>(part)) throw std::runtime_error(file + ": the segmenter refuses this turn");
    auto whole = gatherer.Add(std::get<segmenter::ScanPart>(std::move(part)));
    if (whole && whole->num_cells() == scan.num_cells()) return std::move(*whole);
  }
  throw std::runtime_error(file + ": the turn is not whole");
}

void AddPoints(const std::vector<std::string>& files, Progress& progress, Judge& judge) {
  int turn = 0;
  for (const auto& file : files) {
    const auto cloud = ReadPoints(file);
    auto organised = Organise(cloud, {});
    organised.turn.scan = ThroughMessages(organised.turn.scan, file);
    judge.Add({kPointsLabel, 0, turn++}, organised.turn);
    std::cerr << file << ": " << cloud.points.size() << " points, " << organised.turn.scan.head.num_rings() << " rings"
              << (organised.are_rings_found ? "" : " (bands of equal height)") << ", " << organised.num_moved << " moved, " << organised.num_hidden
              << " hidden, " << organised.num_out_of_range << " out of range"
              << (!cloud.has_labels ? "; no labels: every segment counts as false" : "")
              << (cloud.are_classes_objects ? "; no label has an instance: each class is an object" : "") << '\n';
    progress.Step(file);
  }
}

void RunMethods(const RunPlan& plan, const std::vector<std::string>& points, const Boat& boat, const Methods& methods, Results& results) {
  Judge judge(methods);
  ProjectionTable projections(boat.segmenter);
  Progress progress(&std::cerr, static_cast<std::int64_t>(plan.scenes.size()) * plan.num_seeds + static_cast<std::int64_t>(points.size()));
  ForEachTurn(plan, boat, progress, [&](const TurnPlace& place, const LabelledScan& truth) {
    judge.Add(place, truth);
    // A turn of each seed is enough: the others of the seed look much like it.
    if (place.turn == 0) projections.Add(truth);
  });
  AddPoints(points, progress, judge);
  results.methods = judge.results();
  results.projections = projections.Rows();
}

}  // namespace

int JudgeScenes(const JudgeOptions& options) {
  const auto boat = LoadBoat(options.config_folder);
  const auto plan = PlanOf(options);
  std::vector<Sweep> sweeps;
  for (const auto& text : options.sweeps) {
    sweeps.push_back(ParseSweep(text));
    // A value that is out of range stops the run before it begins.
    for (const double value : sweeps.back().values) ParamsWith(boat, sweeps.back().field, value);
  }
  const auto methods = MakeMethods(boat.segmenter, options.methods);

  Results results;
  results.command = options.command;
  results.version = runtime::Version();
  results.computer = Computer();
  results.first_seed = plan.first_seed;
  results.num_seeds = plan.num_seeds;
  results.seconds = plan.seconds;
  for (const auto& scene : plan.scenes) results.scenes.push_back(SceneLabel(scene));
  if (!options.points.empty()) results.scenes.push_back(kPointsLabel);
  if (!methods.empty()) RunMethods(plan, options.points, boat, methods, results);
  for (const int test : options.tests) results.curves.push_back(RunPaperTest(test, plan, boat, &std::cerr));
  for (const auto& sweep : sweeps) results.curves.push_back(RunSweep(sweep, plan, boat, &std::cerr));

  PrintTables(results, std::cout);
  if (!options.csv_folder.empty()) WriteCsv(results, options.csv_folder);
  if (!options.html_file.empty()) {
    std::ofstream out(options.html_file, std::ios::binary | std::ios::trunc);
    WriteHtml(results, out);
    out.close();
    if (!out) throw std::runtime_error(options.html_file.string() + ": cannot be written");
  }
  return EXIT_SUCCESS;
}

}  // namespace lookout::eval
