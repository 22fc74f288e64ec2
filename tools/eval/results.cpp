#include "tools/eval/results.hpp"

#include <limits>

namespace lookout::eval {
namespace {

double Ratio(double sum, std::int64_t count) { return count > 0 ? sum / static_cast<double>(count) : std::numeric_limits<double>::quiet_NaN(); }

template <typename Key, typename Sum>
void AddTo(std::map<Key, std::pair<std::int64_t, Sum>>& sums, const std::map<Key, std::pair<std::int64_t, Sum>>& more) {
  for (const auto& [key, sum] : more) {
    auto& total = sums[key];
    total.first += sum.first;
    total.second += sum.second;
  }
}

}  // namespace

void Score::Add(const Score& other) {
  num_turns += other.num_turns;
  num_turns_with_object += other.num_turns_with_object;
  sum_iou += other.sum_iou;
  num_turns_with_water_object += other.num_turns_with_water_object;
  sum_water_iou += other.sum_water_iou;
  sum_sure_iou += other.sum_sure_iou;
  AddTo(iou_by_kind, other.iou_by_kind);
  AddTo(recall_by_range, other.recall_by_range);
  AddTo(iou_by_range, other.iou_by_range);
  num_segments += other.num_segments;
  num_false_segments += other.num_false_segments;
  num_sure_false_segments += other.num_sure_false_segments;
  num_object_turns += other.num_object_turns;
  num_over_segmented += other.num_over_segmented;
  num_under_segmented += other.num_under_segmented;
  num_returns += other.num_returns;
  num_labelled_returns += other.num_labelled_returns;
  time_ms.insert(time_ms.end(), other.time_ms.begin(), other.time_ms.end());
}

double MeanIou(const Score& score) { return Ratio(score.sum_iou, score.num_turns_with_object); }

double MeanWaterIou(const Score& score) { return Ratio(score.sum_water_iou, score.num_turns_with_water_object); }

double MeanSureIou(const Score& score) { return Ratio(score.sum_sure_iou, score.num_turns_with_object); }

double FalseSegmentsPerTurn(const Score& score) { return Ratio(static_cast<double>(score.num_false_segments), score.num_turns); }

double SureFalseSegmentsPerTurn(const Score& score) { return Ratio(static_cast<double>(score.num_sure_false_segments), score.num_turns); }

double SegmentsPerTurn(const Score& score) { return Ratio(static_cast<double>(score.num_segments), score.num_turns); }

double OverSegmentedShare(const Score& score) { return Ratio(static_cast<double>(score.num_over_segmented), score.num_object_turns); }

double UnderSegmentedShare(const Score& score) { return Ratio(static_cast<double>(score.num_under_segmented), score.num_segments); }

double TruePositiveRatio(const Score& score) { return Ratio(static_cast<double>(score.num_labelled_returns), score.num_returns); }

}  // namespace lookout::eval
