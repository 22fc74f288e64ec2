// lookout-eval --config: methods against the truth of simulated scenes, of captures of a second world, or of recordings of others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "lab/eval/methods/method.hpp"
#include "lab/eval/methods/render.hpp"
#include "lab/eval/methods/run_plan.hpp"

namespace lookout::eval {

struct ComparisonOptions {
  std::string command;  // for the report
  std::filesystem::path config_folder;
  std::vector<std::string> scenes;  // "all", "families", names or files
  /// Families, or "families": scored with evidence that was fitted without them, out of a folder (LeaveOutEvidence).
  std::vector<std::string> left_out;
  std::filesystem::path weights_folder;
  std::filesystem::path network_folder;  // weights of SqueezeSeg (LearnedWeights); empty: NetworkFolderOf the sources
  std::vector<std::string> points;       // scans out of files: .pcd, or .bin with a .label beside it or without
  /// A folder of captures with truth (ListCaptures); where it does not exist, the tables say so. Empty = none.
  std::filesystem::path captures;
  std::optional<std::uint64_t> first_seed;  // nullopt: the first of the range (run_plan.hpp)
  int num_seeds = 20;
  bool is_tuning = false;  // methods are shown on seeds of tuning, and no file is written
  double seconds = 2.0;
  std::vector<std::string> lidars;   // heads in place of the scenes'; empty = theirs
  std::vector<std::string> methods;  // MakeMethods
  std::vector<std::string> sweeps;   // ParseSweep
  std::vector<int> tests;            // RunPaperTest
  std::filesystem::path csv_folder;  // empty = none, and so below
  std::filesystem::path html_file;
  std::filesystem::path lost_file;                 // LostList
  std::filesystem::path pictures_folder;           // WorstPictures
  std::size_t num_worst = 30;                      // pictures of each scene and row
  std::vector<std::filesystem::path> block_files;  // in whose marked blocks the figures are written (FillBlocks)
  bool is_forced = false;                          // files that are there are replaced
};

/// Scenes, seeds and length that are asked for; "all" and "families" are spelt out, and where no first seed is asked for, it is the first of the
/// range.
RunPlan PlanOf(const ComparisonOptions& options, SeedUse use);

/// The processor, as Linux names it.
std::string Computer();

/// Folder of SqueezeSeg's weights: the folder that was asked for, or the folder in the sources.
std::filesystem::path NetworkFolderOf(const ComparisonOptions& options);

/// Methods by name and group; the boat over time stands behind ours, SqueezeSeg at the end. Where its weights are not there, it is left out, which
/// a line to stderr says. @throws std::invalid_argument when it was asked for by name
Methods MethodsOf(const ComparisonOptions& options, const Boat& boat, const std::function<std::unique_ptr<Method>()>& make_over_time);

/// Names of the families that are left out. @throws std::invalid_argument for one that is not known
std::set<std::string> LeftOutOf(const ComparisonOptions& options);

/// Prints tables to stdout and progress to stderr, and writes the files that are asked for. @return exit code
/// Methods and tests of the paper take seeds of tables, sweeps those of tuning; the other range is refused (run_plan.hpp).
///
/// @throws config::ConfigError, std::invalid_argument for a wrong line; std::runtime_error when a file cannot be read or written
int CompareMethods(const ComparisonOptions& options);

}  // namespace lookout::eval
