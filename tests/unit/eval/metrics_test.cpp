#include "lab/eval/metrics.hpp"

#include <gtest/gtest.h>

namespace lookout::eval {
namespace {

void AddMany(Confusion& confusion, int object_id, int label, int count) {
  for (int i = 0; i < count; ++i) confusion.Add(object_id, label);
}

TEST(Confusion, PerfectSegmentationHasAnIouOfOne) {
  Confusion confusion;
  AddMany(confusion, 1, 2, 10);
  AddMany(confusion, 2, 1, 5);
  for (const auto& [id, object] : confusion.Match().objects) {
    EXPECT_DOUBLE_EQ(object.iou, 1.0);
    EXPECT_TRUE(object.has_own_segment);
  }
}

TEST(Confusion, IouIsThatOfTheBestSegment) {
  // Object 1 has 10 returns: 6 in segment 1, 3 in segment 2, 1 in none. Segment 1 also holds 2 strays and an own-vessel return.
  Confusion confusion;
  AddMany(confusion, 1, 1, 6);
  AddMany(confusion, 1, 2, 3);
  AddMany(confusion, 1, -1, 1);
  AddMany(confusion, 0, 1, 2);
  AddMany(confusion, -1, 1, 1);
  const auto objects = confusion.Match().objects;
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_EQ(objects.at(1).num_returns, 10);
  EXPECT_DOUBLE_EQ(objects.at(1).iou, 6.0 / (10.0 + 9.0 - 6.0));
}

TEST(Confusion, SwallowedObjectHasNoSegmentOfItsOwn) {
  Confusion confusion;
  AddMany(confusion, 1, 1, 90);
  AddMany(confusion, 2, 1, 10);
  const auto matches = confusion.Match();
  EXPECT_TRUE(matches.objects.at(1).has_own_segment);
  EXPECT_FALSE(matches.objects.at(2).has_own_segment);
  EXPECT_DOUBLE_EQ(matches.objects.at(2).iou, 0.1);
  EXPECT_EQ(matches.segments.at(1).majority_object, 1);
}

TEST(Confusion, HalfOfASegmentIsNotItsMajority) {
  Confusion confusion;
  AddMany(confusion, 1, 1, 5);
  AddMany(confusion, 2, 1, 5);
  const auto matches = confusion.Match();
  EXPECT_FALSE(matches.objects.at(1).has_own_segment);
  EXPECT_FALSE(matches.objects.at(2).has_own_segment);
  EXPECT_EQ(matches.segments.at(1).majority_object, 1) << "the least id of equals";
}

TEST(Confusion, ObjectOutsideOfAllSegmentsScoresZero) {
  Confusion confusion;
  AddMany(confusion, 3, 0, 4);
  EXPECT_DOUBLE_EQ(confusion.Match().objects.at(3).iou, 0.0);
  EXPECT_TRUE(confusion.Match().segments.empty());
}

TEST(Confusion, SegmentsSayWhatIsInThem) {
  Confusion confusion;
  AddMany(confusion, 0, 1, 2);
  AddMany(confusion, 0, 2, 2);
  AddMany(confusion, 1, 2, 1);
  AddMany(confusion, -1, 3, 1);
  AddMany(confusion, 0, 3, 1);
  AddMany(confusion, 0, 0, 5);
  const auto segments = confusion.Match().segments;
  ASSERT_EQ(segments.size(), 3U);
  EXPECT_FALSE(segments.at(1).has_object || segments.at(1).has_own_vessel);
  EXPECT_TRUE(segments.at(2).has_object);
  EXPECT_FALSE(segments.at(2).has_own_vessel);
  EXPECT_EQ(segments.at(2).majority_object, 0);
  EXPECT_FALSE(segments.at(3).has_object);
  EXPECT_TRUE(segments.at(3).has_own_vessel);
  EXPECT_EQ(segments.at(3).num_returns, 2);
  AddMany(confusion, -1, 3, 1);
  EXPECT_EQ(confusion.Match().segments.at(3).majority_object, -1);
}

TEST(Summary, PercentilesAreOfTheNearestRank) {
  Summary summary;
  for (int i = 100; i >= 1; --i) summary.Add(i);
  EXPECT_DOUBLE_EQ(summary.Median(), 50.0);
  EXPECT_DOUBLE_EQ(summary.Percentile(95), 95.0);
  EXPECT_DOUBLE_EQ(summary.Max(), 100.0);
  EXPECT_DOUBLE_EQ(summary.Mean(), 50.5);
}

TEST(Summary, OneValueIsAllOfThem) {
  Summary summary;
  summary.Add(7.0);
  EXPECT_DOUBLE_EQ(summary.Median(), 7.0);
  EXPECT_DOUBLE_EQ(summary.Percentile(95), 7.0);
  EXPECT_DOUBLE_EQ(summary.Max(), 7.0);
}

}  // namespace
}  // namespace lookout::eval
