// All evidence of the lookout method, fitted on scans with their truth.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "lab/fit/boosting.hpp"
#include "lab/fit/training_rows.hpp"
#include "services/segmenter/core/segmenter.hpp"

namespace lookout::fit {

/// A sum, and how well it tells the rows that it was fitted on.
struct SumReport {
  std::size_t sum = 0;  // of segmenter::kEvidenceLayouts
  FittedSum fitted;
  std::vector<std::string> families;
  std::vector<Score> of_family;  // [families]
  Score of_all;
  std::string digest;  // of the rows
};

struct FittedEvidence {
  std::vector<SumReport> sums;  // in the order of segmenter::kEvidenceLayouts
  /// Mean IoU of the objects of a family as the evidence groups their returns; also of families that were left out.
  std::map<std::string, double> miou;
  std::set<std::string> without;

  /// Parameters with this evidence in place of theirs.
  segmenter::Params In(segmenter::Params params) const;
};

/// Fits the sums one after the other, each on the rows that the method makes of the scans with the sums fitted before.
///
/// @param params   of the segmenter; its evidence is not used
/// @param without  families whose scans are left out of the fit
/// @param tell     progress, for people
/// Equal scans give equal evidence. Cost: that of six runs of the method and of five fits.
FittedEvidence FitEvidence(std::span<const TrainingScan> scans, const segmenter::Params& params, const BoostingParams& boosting,
                           const std::set<std::string>& without, const std::function<void(const std::string&)>& tell);

/// Mean IoU of the objects of a scan, mean over the scans of each family.
std::map<std::string, double> MeanIou(std::span<const TrainingScan> scans, const segmenter::Params& params);

/// The text of a file of evidence (config/schema/evidence.proto).
///
/// @param comments  lines at its head: what made it
std::string TextOf(const FittedEvidence& evidence, const std::vector<std::string>& comments);

/// Tables for people: scores by family, gain by feature.
std::string TablesOf(const FittedEvidence& evidence);

}  // namespace lookout::fit
