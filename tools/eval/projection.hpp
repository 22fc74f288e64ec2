// Table II of the paper: what its image of a scan keeps, and how far it moves it.
#pragma once

#include "services/segmenter/core/segmenter.hpp"
#include "tools/eval/method.hpp"
#include "tools/eval/results.hpp"

namespace lookout::eval {

/// Sums over scans, for each width of the paper's image.
///
/// Ground points are the returns that keep their pixel, out of those that the boat's filter lets through; in the paper's words, for its scans are
/// mostly shore. The point of a pixel lies at the range and ring of its return, in the middle of its column; its distance to the nearest return
/// of the scan is without sign. True positives: of the returns of objects that keep their pixel, those that the paper's method puts into
/// a segment that belongs to their object (scoring.hpp).
class ProjectionTable {
 public:
  /// @param boat  params of the boat's segmenter
  explicit ProjectionTable(const segmenter::Params& boat);

  void Add(const LabelledScan& truth);

  /// By width; empty without scans.
  std::vector<Results::Projection> Rows() const;

 private:
  struct Sums {
    std::int64_t num_scans = 0;
    std::int64_t num_points = 0;
    std::int64_t num_kept = 0;
    Mean true_positives;  // of the returns of objects that are kept
    double distance_m = 0.0;
    double squared_distance_m2 = 0.0;
  };

  void AddTo(Sums& sums, int image_columns, const LabelledScan& truth) const;

  segmenter::Params boat_;
  std::vector<Sums> sums_;  // by width
};

}  // namespace lookout::eval
