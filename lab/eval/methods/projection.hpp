// Table II of the paper: the returns that its image of a scan keeps, and how far it moves them.
#pragma once

#include "lab/eval/methods/method.hpp"
#include "lab/eval/methods/results.hpp"
#include "services/segmenter/core/segmenter.hpp"

namespace lookout::eval {

/// Sums over scans, for each width of the paper's image (README.md, Definitions). The kept returns are "ground points" in the paper's words, for its
/// scans are mostly shore; out of the returns that the boat's filter lets through.
class ProjectionTable {
 public:
  /// @param boat  params of the boat's segmenter
  explicit ProjectionTable(const segmenter::Params& boat);

  void Add(const LabelledScan& truth);

  /// By width; empty without scans.
  std::vector<Results::Projection> Rows() const;

 private:
  struct Sums {
    Mean points;          // a scan
    Mean kept;            // a scan
    Mean true_positives;  // of the returns of objects that are kept
    Mean distance_m;      // distance of a return that is kept
    double squared_distance_m2 = 0.0;
  };

  void AddTo(Sums& sums, int image_columns, const LabelledScan& truth) const;

  segmenter::Params boat_;
  std::vector<Sums> sums_;  // by width
};

}  // namespace lookout::eval
