// All methods over all turns: who is how good, and how fast.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/eval/method.hpp"
#include "tools/eval/progress.hpp"
#include "tools/eval/render.hpp"
#include "tools/eval/results.hpp"

namespace lookout::eval {

/// Which scan is scored.
struct ScanPlace {
  std::string scene;
  std::uint64_t seed = 0;
  int index = 0;  // of the scene and seed, from 0
};

/// Lets each method label each turn, and keeps the scores: one result for each operating point of a method, so that no row of a table holds figures
/// of two. A method that knows doubt has two, in this order: all segments, and the sure ones alone.
/// Everything but the times depends on the turns alone.
class MethodComparison {
 public:
  /// @param methods  outlive this
  explicit MethodComparison(const Methods& methods);

  void Add(const ScanPlace& place, const LabelledScan& truth);

  /// In the order of the methods, and of their operating points.
  const std::vector<MethodResult>& results() const { return results_; }

 private:
  void AddPoint(MethodResult& result, const ScanPlace& place, const LabelledScan& truth, Labelling labelling, double time_ms);
  void KeepIfBad(MethodResult& result, const ScanPlace& place, double iou, const LabelledScan& truth, std::vector<std::int32_t> label) const;

  const Methods& methods_;
  std::vector<MethodResult> results_;
};

/// Turns that are kept of each method, each of another scene: enough to see what goes wrong, few enough for one page.
inline constexpr std::size_t kMaxWorstScans = 3;

/// What is rendered.
struct RunPlan {
  std::vector<std::string> scenes;  // names or files (sim::FindScene)
  std::uint64_t first_seed = 1;
  int num_seeds = 1;
  double seconds = 2.0;  // of each scene and seed
};

/// As it stands in tables: the name itself, or that of the file without folder and ending.
std::string SceneLabel(const std::string& name_or_path);

/// Renders scene after scene, seed after seed, and calls with each turn.
///
/// @param progress  a step for each scene and seed
/// @throws config::ConfigError for a scene that is wrong; all are loaded with their first seed before the first is rendered
void ForEachScan(const RunPlan& plan, const Boat& boat, Progress& progress,
                 const std::function<void(const ScanPlace&, const LabelledScan&)>& on_turn);

}  // namespace lookout::eval
