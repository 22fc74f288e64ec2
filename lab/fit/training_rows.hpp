// From scans with their truth to rows: the questions of the lookout method between its steps, and their right answers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lab/data/labelled_scan.hpp"
#include "lab/fit/rows.hpp"
#include "services/segmenter/core/lookout/lookout_method.hpp"
#include "services/segmenter/core/segmenter.hpp"

namespace lookout::fit {

struct TrainingScan {
  std::string family;
  data::LabelledScan truth;
};

/// The features of a sum (by its number in segmenter::kEvidenceLayouts) with their signs (README). @throws std::logic_error for a sign of a feature
/// that the method does not have
std::vector<Feature> FeaturesOf(std::size_t sum);

/// The true object of a group: the one that most of its returns are of.
struct PieceTruth {
  std::int32_t object = data::kNoTrueObject;  // clutter and the own vessel: kNoTrueObject
  std::int32_t num_returns = 0;
  std::int32_t num_of_object = 0;  // returns of that object in the scan; for clutter, the group's own returns
};

/// How much a wrong answer costs, as the fall of IoU of the objects that it touches. Two pieces of one object: the lesser is lost to it, a share of
/// its returns. Pieces of two: the lesser is lost to its object, and what takes it in is diluted by it. Clutter has nothing to lose. So a small piece
/// of a quay counts little, and a boat all of whose returns it is counts whole.
float PairWeight(const PieceTruth& one, const PieceTruth& other);
/// An object counts as having at least this many returns: a single return is half of a thing.
inline constexpr int kLeastObject = 2;
/// Chosen by leaving families out, as the form of the weight (DECISIONS.md).
inline constexpr float kLeastWeight = 0.005F;

/// Rows of land and of things, from groups of returns.
class RowMaker {
 public:
  /// @param params  of the segmenter; its evidence of the steps before is used
  explicit RowMaker(const segmenter::Params& params)
      : params_(params), classifier_(params.filter), method_(params.lookout, params.filter.T_vessel_lidar.linear()) {}

  /// Adds the rows of a scan.
  ///
  /// Merging: a row for each pair of pieces, true where both are mostly of one object. Where both are clutter there is none.
  /// Land: a row for each group that is mostly of an object, true where that is land (eval::IsLand); none where it is of a dock, which may be either.
  /// Its weight is the square root of its returns: a shore counts more than its fragments, which look like anything.
  /// Thing: a row for each group, true where it is mostly of an object.
  void Add(std::size_t sum, const TrainingScan& scan, Rows& rows);

 private:
  std::vector<PieceTruth> TruthOfPieces(const data::LabelledScan& truth);
  void AddPairs(std::size_t merge, const TrainingScan& scan, std::int32_t scan_number, Rows& rows);
  void AddGroups(std::size_t sum, const TrainingScan& scan, std::int32_t scan_number, Rows& rows);

  segmenter::Params params_;
  segmenter::ReturnClassifier classifier_;
  segmenter::LookoutMethod method_;
};

}  // namespace lookout::fit
