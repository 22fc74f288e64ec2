#include "lab/fit/fit_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <optional>
#include <set>
#include <stdexcept>

#include "common/io/output_file.hpp"
#include "common/io/stop_signal.hpp"
#include "common/runtime/version.hpp"
#include "lab/eval/methods/run_plan.hpp"
#include "lab/fit/fit_evidence.hpp"

namespace lookout::fit {
namespace {

eval::RunPlan PlanOf(const Options& options) {
  const eval::RunPlan plan{eval::NamesOfScenes(options.scenes, options.config_folder), options.first_seed, options.num_seeds, options.seconds,
                           options.lidars};
  eval::CheckLidars(options.lidars);
  plan.CheckSeeds(eval::SeedUse::kTuning);
  return plan;
}

// A wrong name must not make a fit on a family that it should leave out.
void CheckFamilies(const std::string& option, const std::vector<std::string>& names, const eval::RunPlan& plan) {
  for (const auto& name : names) {
    const bool is_there = std::ranges::any_of(plan.scenes, [&](const auto& scene) { return eval::SceneLabel(scene) == name; });
    if (!is_there) throw std::invalid_argument(fmt::format("{} {}: none of --scenes is so called", option, name));
  }
}

void CheckFeatures(const std::vector<std::string>& names) {
  for (const auto& name : names) {
    const bool is_there = std::ranges::any_of(segmenter::kEvidenceLayouts,
                                              [&](const auto& layout) { return std::ranges::find(layout.features, name) != layout.features.end(); });
    if (!is_there) throw std::invalid_argument(fmt::format("--drop-feature {}: no sum has such a feature", name));
  }
}

std::vector<TrainingScan> Render(const eval::RunPlan& plan, const eval::Boat& boat) {
  std::vector<TrainingScan> scans;
  eval::ForEachScan(
      plan, boat, stderr,
      [&](const eval::ScanPlace& place, const eval::LabelledScan& truth) {
        scans.push_back({place.scene, truth});
      },
      "lookout-fit");
  return scans;
}

std::vector<std::string> Comments(const Options& options, const eval::RunPlan& plan) {
  std::vector<std::string> families;
  for (const auto& scene : plan.scenes) {
    const auto label = eval::SceneLabel(scene);
    if (std::ranges::find(options.without, label) == options.without.end()) families.push_back(label);
  }
  return {"Written by " + options.command + ", version " + runtime::Version() + ".",
          fmt::format("Fitted on seeds {} to {}, {} s each, of {}.", plan.first_seed,
                      plan.first_seed + static_cast<std::uint64_t>(plan.num_seeds) - 1, plan.seconds, fmt::join(families, ", "))};
}

}  // namespace

int FitScenes(const Options& options) {
  const auto plan = PlanOf(options);
  CheckFamilies("--without", options.without, plan);
  CheckFamilies("--hold-out", options.hold_out, plan);
  CheckFeatures(options.dropped);
  const auto boat = eval::LoadBoat(options.config_folder);
  io::CatchStopSignals();
  std::optional<io::OutputFile> out;
  if (!options.out.empty()) out.emplace(options.out, io::OutputOptions{.force = options.is_forced});

  const auto scans = Render(plan, boat);
  BoostingParams boosting;
  boosting.num_trees = options.num_trees;
  boosting.held_out = options.hold_out;
  boosting.dropped = options.dropped;
  const auto evidence =
      FitEvidence(scans, boat.segmenter, boosting, std::set(options.without.begin(), options.without.end()), [](const std::string& line) {
        io::ThrowIfStopAsked();
        std::cerr << line << '\n';
      });
  std::cout << TablesOf(evidence);
  if (out) {
    out->Write(TextOf(evidence, Comments(options, plan)));
    out->Commit();
  }
  return EXIT_SUCCESS;
}

}  // namespace lookout::fit
