// HOTA: how well things are found and kept apart over a run, in one figure of equal parts.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "lab/eval/tracks/track_matching.hpp"
#include "lab/eval/tracks/track_scan.hpp"

namespace lookout::eval {

/// 1 where hulls touch or overlap, 0 from the gate on, straight in between. A pair at every threshold above 0 is one for MOTA, too. An overlap is 1
/// however well two hulls agree: HOTA here says how well things are found and told apart; GOSPA says how far off places are.
double SimilarityOf(double gap_m);

/// Higher Order Tracking Accuracy of one run or several (Add).
///
/// Source: J. Luiten et al., "HOTA: A higher order metric for evaluating multi-object tracking", IJCV 129 (2021), equations 8 to 16, with one
/// assignment a scan for all thresholds, which prefers pairs that are together for long. Several runs add up in counts, as sequences do there.
struct Hota {
  static constexpr std::size_t kNumThresholds = 19;  // 0.05, 0.1 ... 0.95
  static constexpr double ThresholdOf(std::size_t i) { return 0.05 * static_cast<double>(i + 1); }

  std::int64_t num_true = 0;     // things that must be tracked, over all scans
  std::int64_t num_tracked = 0;  // reported tracks that count, over all scans
  struct AtThreshold {
    std::int64_t num_pairs = 0;
    double association = 0.0;  // sum over the pairs of their association accuracy: scans together over scans in which one of the two is there
  };
  std::array<AtThreshold, kNumThresholds> at{};

  /// Mean over the thresholds, 0 to 1; NaN where there was neither a thing nor a track.
  double Value() const;
  double Detection() const;    // DetA
  double Association() const;  // AssA
  void Add(const Hota& other);
};

/// @param run  [scans] of truth. Things that must be tracked take part, and tracks that are not excused: the same ones as in MOTA
/// Deterministic. Cost: as CheapestAssignment of each scan.
Hota HotaOf(std::span<const TrueScan> truth, std::span<const Matched> run);

}  // namespace lookout::eval
