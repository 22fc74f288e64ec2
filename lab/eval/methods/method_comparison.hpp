// Scores of all methods over all scans: how good each is, and how fast.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "lab/eval/methods/method.hpp"
#include "lab/eval/methods/results.hpp"
#include "lab/eval/methods/run_plan.hpp"

namespace lookout::eval {

/// Sees a scan with the labels and the score of one row of the tables.
using ScoredScanHandler = std::function<void(const std::string& method, const ScanPlace& place, const LabelledScan& truth,
                                             const std::vector<std::int32_t>& label, const Score& score)>;

/// Lets each method label each scan, and keeps the scores: one result for each operating point of a method, so that no row of a table holds figures
/// of two. A method that knows doubt has two, in this order: all segments, and the sure ones alone.
/// Everything but the times depends on the scans alone.
class MethodComparison {
 public:
  /// @param methods    outlive this
  /// @param on_scored  called for each scan and row; empty = not
  explicit MethodComparison(const Methods& methods, ScoredScanHandler on_scored = {});

  void Add(const ScanPlace& place, const LabelledScan& truth);

  /// In the order of the methods, and of their operating points.
  const std::vector<MethodResult>& results() const { return results_; }

 private:
  void AddPoint(MethodResult& result, const ScanPlace& place, const LabelledScan& truth, const std::set<std::int32_t>& near_land, Labelling labelling,
                double time_ms);
  void KeepIfBad(MethodResult& result, const ScanPlace& place, double iou, const LabelledScan& truth, std::vector<std::int32_t> label) const;

  const Methods& methods_;
  ScoredScanHandler on_scored_;
  std::vector<MethodResult> results_;
};

/// Scans that are kept of each method, each of another scene: enough to see failures, few enough for one page.
inline constexpr std::size_t kMaxWorstScans = 3;

}  // namespace lookout::eval
