// Why returns are one segment or two: the rounds of merging of the lookout method, done once more on a scan of a log.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "services/segmenter/core/segmenter.hpp"
#include "tools/export/scans.hpp"

namespace lookout::exporter {

/// A piece as it goes into a round.
struct MergingPiece {
  std::int32_t num_returns = 0;
  Eigen::Vector2d mean_m = Eigen::Vector2d::Zero();  // mean of its returns, x and y in the lidar frame
  std::int32_t becomes = 0;                          // the piece's number in the next round; after the last round, the number of its group
  std::int32_t segment_id = 0;                       // in SEGMENTS; 0 = in none
};

struct MergingPair {
  std::int32_t one = 0;  // indices of pieces
  std::int32_t other = 0;
  std::array<float, segmenter::kNumPairFeatures> features{};
  float log_odds = 0.0F;  // log odds that the two pieces are one
};

struct MergeRound {
  double threshold = 0.0;  // groups are merged while the mean log odds of the pairs between them exceed the threshold
  std::vector<MergingPiece> pieces;
  std::vector<std::int32_t> piece_of_return;
  std::vector<MergingPair> pairs;  // that were judged

  const MergingPiece& operator[](std::int32_t piece) const { return pieces[static_cast<std::size_t>(piece)]; }
  bool IsMerged(const MergingPair& pair) const { return (*this)[pair.one].becomes == (*this)[pair.other].becomes; }
};

struct MergedScan {
  std::vector<Eigen::Vector3d> returns_m;  // returns that the segmenter used, lidar frame
  std::array<MergeRound, segmenter::kNumMerges> rounds;
  std::map<std::int32_t, segments_t> segments;  // SEGMENTS, by part_index
  std::map<std::int32_t, segmenter::PieceFeatures> features_of_segment;
};

/// Segments scans as lookout-segmenter does, and keeps the evidence of its decisions.
class MergeRecorder {
 public:
  /// Precondition: the method is LOOKOUT.
  explicit MergeRecorder(const segmenter::Params& params);

  /// @return nullopt where a part of LIDAR_SCAN is missing, or the segmenter would refuse it
  std::optional<MergedScan> Merge(const ScanMessages& messages);
  /// Merge of a scan that the user asked for. @throws std::runtime_error where there is nothing to return
  MergedScan MergeChosen(const ScanMessages& messages);

  /// The evidence of a round, segmenter::kLandSum or kThingSum.
  const segmenter::Evidence& evidence(std::size_t sum) const { return params_.lookout.evidence[sum]; }

 private:
  MergeRound MergeOnce(std::size_t round, const std::vector<segmenter::Return>& returns, const std::vector<std::int16_t>& label);

  segmenter::Params params_;
  segmenter::ReturnClassifier classifier_;
  segmenter::LookoutMethod method_;
  segmenter::Segmenter segmenter_;
};

/// A pair of the last round, to be drawn: a line from piece to piece where they come closest, lidar frame.
struct MergeLink {
  std::array<Eigen::Vector3d, 2> ends_m;
  bool is_merged = false;
  float log_odds = 0.0F;
  std::string why;
};

/// Why pieces are one or two, and segments land or a thing, in words, with the features that add most for and against.
struct MergeReasons {
  std::vector<MergeLink> links;
  std::map<std::int32_t, std::string> why_of_segment;
};
MergeReasons ReasonsOf(const MergedScan& scan, const MergeRecorder& recorder);

}  // namespace lookout::exporter
