// Scores: laws, and an obvious computation, over random labels.
#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>
#include <set>

#include "lab/sim/random.hpp"
#include "tests/unit/eval/scoring_case.hpp"

namespace lookout::eval {
namespace {

Case RandomCase(std::uint64_t seed) {
  sim::Random random(seed, 0);
  const auto below = [&random](int count) { return static_cast<std::int32_t>(random.Uniform() * count); };
  std::vector<Cell> cells;
  const int num_cells = 1 + below(200);
  const int num_objects = 1 + below(6);
  const int num_labels = 1 + below(12);
  for (int i = 0; i < num_cells; ++i) {
    cells.push_back({below(num_objects + 2) - 1, below(num_labels + 2) - 1, random.Uniform(0.5, 100.0)});
    if (below(10) == 0) cells.back().range_m = 0.0;
  }
  auto one = MakeCase(cells);
  for (int i = 0; i < num_labels; ++i) one.labelling.is_sure.push_back(below(3) > 0);
  return one;
}

// The definitions as they stand in scoring.hpp, counted cell by cell for each pair of object and segment.
struct Obvious {
  double iou = 0.0;
  double sure_iou = 0.0;
  double water_iou = 0.0;
  int num_objects = 0;
  int num_found = 0;
  int num_things = 0;
  int num_things_with_segment = 0;
  int num_near = 0;
  int num_near_found = 0;
  int num_near_surely_found = 0;
  int num_segments = 0;
  int num_false = 0;
  int num_over = 0;
  int num_under = 0;
  int num_true_positives = 0;
};

double NearestM(const Case& one, int object) {
  double nearest_m = 1e9;
  for (std::size_t cell = 0; cell < one.truth.object.size(); ++cell) {
    if (one.truth.object[cell] != object || one.labelling.label[cell] == kNotScored || one.truth.scan.columns.range[cell] == 0) continue;
    nearest_m = std::min(nearest_m, one.truth.scan.columns.range[cell] * kRangeUnitM);
  }
  return nearest_m;
}

Obvious Compute(const Case& one) {
  const auto& label = one.labelling.label;
  const auto& object = one.truth.object;
  const auto count = [&](auto of) {
    int number = 0;
    for (std::size_t cell = 0; cell < label.size(); ++cell) {
      if (one.truth.scan.columns.range[cell] != 0 && label[cell] != kNotScored && of(object[cell], label[cell])) ++number;
    }
    return number;
  };
  const auto both = [&](int i, int j) { return count([=](int o, int l) { return o == i && l == j; }); };
  const auto of_object = [&](int i) { return count([=](int o, int) { return o == i; }); };
  const auto of_segment = [&](int j) { return count([=](int, int l) { return l == j; }); };
  std::set<int> objects;
  std::set<int> segments;
  for (int i = 1; i <= 6; ++i) {
    if (of_object(i) > 0) objects.insert(i);
  }
  for (int j = 1; j <= 12; ++j) {
    if (of_segment(j) > 0) segments.insert(j);
  }
  Obvious result;
  int num_water = 0;
  for (const int i : objects) {
    double best = 0.0;
    double best_sure = 0.0;
    int num_parts = 0;
    bool has_segment = false;
    for (const int j : segments) {
      has_segment = has_segment || 2 * both(i, j) > of_segment(j);
      const double iou = static_cast<double>(both(i, j)) / (of_object(i) + of_segment(j) - both(i, j));
      best = std::max(best, iou);
      if (one.labelling.is_sure[static_cast<std::size_t>(j - 1)]) best_sure = std::max(best_sure, iou);
      if (both(i, j) > 0 && 10 * both(i, j) >= of_object(i)) ++num_parts;
    }
    result.iou += best / static_cast<double>(objects.size());
    result.sure_iou += best_sure / static_cast<double>(objects.size());
    if (i % 2 == 1) {
      result.water_iou += best;
      ++num_water;
    }
    if (of_object(i) >= 5) {
      ++result.num_things;
      result.num_things_with_segment += has_segment ? 1 : 0;
    }
    if (best >= 0.5) ++result.num_found;
    if (NearestM(one, i) < 25.0) {
      ++result.num_near;
      if (best >= 0.5) ++result.num_near_found;
      if (best_sure >= 0.5) ++result.num_near_surely_found;
    }
    if (num_parts >= 2) ++result.num_over;
  }
  if (num_water > 0) result.water_iou /= num_water;
  result.num_objects = static_cast<int>(objects.size());
  for (const int j : segments) {
    int most = 0;
    int num_parts = 0;
    for (const int i : objects) {
      most = std::max(most, both(i, j));
      if (both(i, j) > 0 && 10 * both(i, j) >= of_object(i)) ++num_parts;
    }
    if (most == 0) ++result.num_false;
    if (num_parts >= 2) ++result.num_under;
    if (most >= both(kOwnVesselObject, j) && most >= both(kNoTrueObject, j)) result.num_true_positives += most;
  }
  result.num_segments = static_cast<int>(segments.size());
  return result;
}

TEST(Scoring, AgreesWithAnObviousComputationOnRandomLabels) {
  constexpr std::uint64_t kNumCases = 600;
  for (std::uint64_t seed = 1; seed <= kNumCases; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const auto one = RandomCase(seed);
    const auto score = ScoreScan(one.truth, one.labelling);
    const auto expected = Compute(one);
    EXPECT_EQ(score.over_segmented.count, expected.num_objects);
    EXPECT_NEAR(score.iou.sum, expected.iou, 1e-12);
    const auto sure = ScoreScan(one.truth, SureOnly(one.labelling));
    EXPECT_NEAR(sure.iou.sum, expected.sure_iou, 1e-12);
    EXPECT_EQ(score.with_segment.count, expected.num_things);
    EXPECT_EQ(score.with_segment.sum, expected.num_things_with_segment);
    EXPECT_NEAR(score.water_iou.sum, expected.water_iou, 1e-12);
    EXPECT_EQ(score.segments.sum, expected.num_segments);
    EXPECT_EQ(score.false_segments.sum, expected.num_false);
    EXPECT_EQ(score.over_segmented.sum, expected.num_over);
    EXPECT_EQ(score.under_segmented.sum, expected.num_under);
    EXPECT_EQ(score.true_positives.sum, expected.num_true_positives);
    double num_found = 0.0;
    for (const auto& [bin, recall] : score.recall_by_range) num_found += recall.sum;
    EXPECT_EQ(num_found, expected.num_found);
    Mean near;
    for (const auto& [kind, recall] : score.near_recall_by_kind) near.Add(recall);
    double num_near_surely_found = 0.0;
    for (const auto& [kind, recall] : sure.near_recall_by_kind) num_near_surely_found += recall.sum;
    EXPECT_EQ(near.count, expected.num_near);
    EXPECT_EQ(near.sum, expected.num_near_found);
    EXPECT_EQ(num_near_surely_found, expected.num_near_surely_found);
    if (HasFailure()) break;
  }
}

std::vector<double> AsProbabilities(const std::vector<bool>& is_sure) { return {is_sure.begin(), is_sure.end()}; }

TEST(Scoring, ShuffledIdsChangeNothing) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    auto one = RandomCase(seed);
    one.truth.objects[4].kind = "shore";
    one.labelling.probability = AsProbabilities(one.labelling.is_sure);
    const auto before = ScoreScan(one.truth, one.labelling);
    const auto before_sure = ScoreScan(one.truth, SureOnly(one.labelling));
    // Ids are dealt anew, with gaps between them.
    const std::size_t num_labels = one.labelling.is_sure.size();
    std::vector<std::int32_t> new_id(num_labels);
    std::iota(new_id.begin(), new_id.end(), 0);
    sim::Random random(seed, 1);
    for (std::size_t i = num_labels; i > 1; --i)
      std::swap(new_id[i - 1], new_id[static_cast<std::size_t>(random.Uniform() * static_cast<double>(i))]);
    std::vector<bool> is_sure(3 * num_labels, false);
    for (auto& id : new_id) id = 3 * id + 2;
    for (std::size_t i = 0; i < num_labels; ++i) is_sure[static_cast<std::size_t>(new_id[i] - 1)] = one.labelling.is_sure[i];
    for (auto& label : one.labelling.label) {
      if (label > 0) label = new_id[static_cast<std::size_t>(label - 1)];
    }
    one.labelling.is_sure = is_sure;
    one.labelling.probability = AsProbabilities(is_sure);
    const auto after = ScoreScan(one.truth, one.labelling);
    EXPECT_DOUBLE_EQ(after.iou.sum, before.iou.sum);
    EXPECT_DOUBLE_EQ(ScoreScan(one.truth, SureOnly(one.labelling)).iou.sum, before_sure.iou.sum);
    EXPECT_DOUBLE_EQ(after.water_iou.sum, before.water_iou.sum);
    EXPECT_EQ(after.segments.sum, before.segments.sum);
    EXPECT_EQ(after.false_segments.sum, before.false_segments.sum);
    EXPECT_EQ(ScoreScan(one.truth, SureOnly(one.labelling)).false_segments.sum, before_sure.false_segments.sum);
    EXPECT_EQ(after.with_segment.sum, before.with_segment.sum);
    EXPECT_EQ(after.over_segmented.sum, before.over_segmented.sum);
    EXPECT_EQ(after.under_segmented.sum, before.under_segmented.sum);
    EXPECT_EQ(after.true_positives.sum, before.true_positives.sum);
    EXPECT_EQ(after.recall_by_range, before.recall_by_range);
    EXPECT_EQ(after.outcomes_by_kind, before.outcomes_by_kind);
    EXPECT_EQ(after.land_segments, before.land_segments);
    EXPECT_EQ(after.confidence, before.confidence);
  }
}

}  // namespace
}  // namespace lookout::eval
