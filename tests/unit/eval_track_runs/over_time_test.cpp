#include "lab/eval/tracks/over_time.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <stdexcept>
#include <vector>

#include "lab/eval/methods/run_plan.hpp"
#include "lab/eval/methods/scoring.hpp"
#include "services/segmenter/core/segmenter.hpp"
#include "tests/support/files.hpp"

namespace lookout::eval {
namespace {

constexpr double kSecondsOverTime = 2.0;

struct PlacedScan {
  ScanPlace place;
  LabelledScan truth;
};

std::vector<PlacedScan> ScansOf(const std::string& scene, const Boat& boat) {
  std::vector<PlacedScan> scans;
  ForEachScan({{scene}, 1, 1, kSecondsOverTime}, boat, nullptr, [&scans](const ScanPlace& place, const LabelledScan& truth) {
    scans.push_back({place, truth});
  });
  return scans;
}

std::int64_t NumObjectsFound(const LabelledScan& truth, const std::vector<std::int32_t>& label) {
  return std::ranges::count_if(MatchScan(truth, label).objects, [](const auto& entry) { return entry.second.iou >= kFoundIou; });
}

TEST(OverTime, LabelsTheScansThatTheOtherMethodsSee) {
  const auto boat = LoadBoat(support::kCatabotConfig);
  const std::vector<std::string> scenes{"marina"};
  OverTimeMethod method(support::kCatabotConfig, FeedOfScenes(support::kCatabotConfig, scenes, kSecondsOverTime));
  segmenter::Segmenter single(boat.segmenter);
  const auto scans = ScansOf("marina", boat);
  ASSERT_GE(scans.size(), 18U);
  Mean iou;
  Mean iou_of_single;
  bool is_ever_other = false;
  for (const auto& [place, truth] : scans) {
    ASSERT_TRUE(method.BeginScan(place));
    const auto labelling = method.Segment(truth.scan);
    EXPECT_FALSE(labelling.is_timed);
    const auto& segments = single.Segment(truth.scan);
    std::vector<std::int32_t> label(segments.label.size());
    std::ranges::transform(segments.label, label.begin(), [](std::int16_t one) { return std::max<std::int32_t>(one, 0); });
    // Tracks give other names, and to the same returns.
    ASSERT_EQ(labelling.label.size(), label.size());
    for (std::size_t cell = 0; cell < label.size(); ++cell) ASSERT_EQ(labelling.label[cell] > 0, label[cell] > 0);
    iou.Add(ScoreScan(truth, labelling).iou);
    iou_of_single.Add(ScoreScan(truth, {label, {}}).iou);
    is_ever_other = is_ever_other || MatchScan(truth, labelling.label).segments.size() != MatchScan(truth, label).segments.size();
    EXPECT_GE(NumObjectsFound(truth, labelling.label) + 2, NumObjectsFound(truth, label));
  }
  EXPECT_TRUE(is_ever_other);
  EXPECT_GT(iou.value(), iou_of_single.value() - 0.02);
}

TEST(OverTime, IsTheSameEachTime) {
  const auto boat = LoadBoat(support::kCatabotConfig);
  const std::vector<std::string> scenes{"sparse"};
  OverTimeMethod one(support::kCatabotConfig, FeedOfScenes(support::kCatabotConfig, scenes, kSecondsOverTime));
  OverTimeMethod other(support::kCatabotConfig, FeedOfScenes(support::kCatabotConfig, scenes, kSecondsOverTime));
  for (const auto& [place, truth] : ScansOf("sparse", boat)) {
    ASSERT_TRUE(one.BeginScan(place) && other.BeginScan(place));
    ASSERT_EQ(one.Segment(truth.scan).label, other.Segment(truth.scan).label);
  }
}

TEST(OverTime, HasNoLabelsForScansOfNoRun) {
  OverTimeMethod method(support::kCatabotConfig, [](const ScanPlace&, const DatagramHandler&, const ScanMessageHandler&) { return false; });
  EXPECT_FALSE(method.BeginScan({"points", 0, 0}));
  EXPECT_FALSE(method.BeginScan({"points", 0, 1}));
}

TEST(OverTime, AScanOfAnotherRunIsRefused) {
  const auto boat = LoadBoat(support::kCatabotConfig);
  const std::vector<std::string> scenes{"sparse"};
  OverTimeMethod method(support::kCatabotConfig, FeedOfScenes(support::kCatabotConfig, scenes, kSecondsOverTime));
  const auto scans = ScansOf("sparse", boat);
  ASSERT_TRUE(method.BeginScan({"sparse", 2, 0}));
  EXPECT_THROW(method.Segment(scans.front().truth.scan), std::runtime_error);
}

}  // namespace
}  // namespace lookout::eval
