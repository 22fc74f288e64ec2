// Probabilities that a method states for its segments: the effect of a threshold on them, and whether they are true.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "lab/eval/methods/method.hpp"
#include "lab/eval/metrics.hpp"

namespace lookout::eval {

/// Additive over scans. Probabilities are counted in thousandths, downwards.
struct Confidence {
  struct Stated {
    std::int64_t count = 0;
    std::int64_t num_things = 0;  // segments that are of an object
    double sum = 0.0;             // of the probabilities
    bool operator==(const Stated&) const = default;
  };
  std::map<int, Stated> segments;              // by thousandth
  std::map<int, std::int64_t> false_segments;  // by thousandth of probability: segments without a return of an object
  std::map<int, std::int64_t> things;          // by the greatest thousandth among the segments that are more than half theirs
  std::int64_t num_things = 0;                 // all things, also things that have no such segment
  std::int64_t num_scans = 0;                  // of methods that state probabilities

  void Add(const Confidence& other);
  bool operator==(const Confidence&) const = default;
};

/// Confidence of one scan; empty when the labelling states no probability.
///
/// @param min_num_returns  objects with fewer in the scan are no things
Confidence ConfidenceOf(const Confusion::Matches& matches, const Labelling& labelling, std::int64_t min_num_returns);

/// The scores when segments below a probability do not count.
struct OperatingPoint {
  double threshold = 0.0;
  double recall = 0.0;          // share of things with a segment (Score::with_segment); NaN when there is no thing
  double false_segments = 0.0;  // a scan
};

/// At thresholds from 0 to 0.999, closer near the ends; empty without scans.
std::vector<OperatingPoint> OperatingPointsOf(const Confidence& confidence);

/// Segments whose stated probability is in the same tenth.
struct ReliabilityBin {
  double stated = 0.0;    // mean
  double observed = 0.0;  // share of segments that are of an object
  std::int64_t count = 0;
};

/// @return ten bins, from 0 on; stated and observed are NaN where there is no segment. Empty without scans
std::vector<ReliabilityBin> ReliabilityOf(const Confidence& confidence);

}  // namespace lookout::eval
