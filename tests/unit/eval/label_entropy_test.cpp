#include "lab/eval/methods/label_entropy.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace lookout::eval {
namespace {

void AddReturnsOf(Confusion& confusion, int object_id, int label, int count) {
  for (int i = 0; i < count; ++i) confusion.Add(object_id, label);
}

double EntropyPart(double share) { return -share * std::log(share); }

TEST(LabelEntropy, IsNothingWhereEachObjectHasALabelOfItsOwn) {
  Confusion confusion;
  AddReturnsOf(confusion, 1, 4, 10);
  AddReturnsOf(confusion, 2, 5, 3);
  AddReturnsOf(confusion, 0, 6, 7);  // clutter by itself: no label of an object
  const auto entropy = EntropyOf(confusion.Match());
  EXPECT_DOUBLE_EQ(entropy.over.value(), 0.0);
  EXPECT_DOUBLE_EQ(entropy.under.value(), 0.0);
  EXPECT_EQ(entropy.over.count, 1);
  EXPECT_EQ(entropy.under.count, 1);
}

TEST(LabelEntropy, OfACutObjectIsThatOfItsParts) {
  // 6 + 2 in two labels, 2 in none.
  Confusion confusion;
  AddReturnsOf(confusion, 1, 1, 6);
  AddReturnsOf(confusion, 1, 2, 2);
  AddReturnsOf(confusion, 1, 0, 2);
  const auto entropy = EntropyOf(confusion.Match());
  EXPECT_DOUBLE_EQ(entropy.over.value(), EntropyPart(0.6) + 2.0 * EntropyPart(0.2));
  EXPECT_DOUBLE_EQ(entropy.under.value(), 0.0);
}

TEST(LabelEntropy, OfALabelIsThatOfTheObjectsInIt) {
  // Two objects and what is of none: 5, 3, and a stray and a return of the own vessel together.
  Confusion confusion;
  AddReturnsOf(confusion, 1, 1, 5);
  AddReturnsOf(confusion, 2, 1, 3);
  AddReturnsOf(confusion, 0, 1, 1);
  AddReturnsOf(confusion, -1, 1, 1);
  AddReturnsOf(confusion, 3, 2, 4);
  const auto entropy = EntropyOf(confusion.Match());
  EXPECT_DOUBLE_EQ(entropy.over.value(), 0.0);
  EXPECT_DOUBLE_EQ(entropy.under.value(), EntropyPart(0.5) + EntropyPart(0.3) + EntropyPart(0.2));
}

TEST(LabelEntropy, IsASumOverTheScanAndAMeanOverScans) {
  Confusion confusion;
  for (const int object : {1, 2}) {
    AddReturnsOf(confusion, object, 2 * object, 3);
    AddReturnsOf(confusion, object, 2 * object + 1, 3);
  }
  auto entropy = EntropyOf(confusion.Match());
  EXPECT_DOUBLE_EQ(entropy.over.value(), 2.0 * std::log(2.0));
  Confusion whole;
  AddReturnsOf(whole, 1, 1, 3);
  entropy.over.Add(EntropyOf(whole.Match()).over);
  EXPECT_DOUBLE_EQ(entropy.over.value(), std::log(2.0));
}

TEST(LabelEntropy, OfAnObjectWithoutLabelIsNothing) {
  Confusion confusion;
  AddReturnsOf(confusion, 1, 0, 5);
  const auto entropy = EntropyOf(confusion.Match());
  EXPECT_DOUBLE_EQ(entropy.over.value(), 0.0);
  EXPECT_DOUBLE_EQ(entropy.under.value(), 0.0);
}

TEST(LabelEntropy, OfAScanWithoutObjectsIsNone) {
  Confusion confusion;
  AddReturnsOf(confusion, 0, 1, 5);
  EXPECT_TRUE(std::isnan(EntropyOf(confusion.Match()).over.value()));
}

TEST(PanopticQuality, IsTheProductOfItsParts) {
  // Object 1: IoU 8 / 10. Object 2 in two halves, of which none is above a half: it and both labels are alone. Object 3 has none. Clutter is left
  // out.
  Confusion confusion;
  AddReturnsOf(confusion, 1, 1, 8);
  AddReturnsOf(confusion, 1, 0, 2);
  AddReturnsOf(confusion, 2, 2, 5);
  AddReturnsOf(confusion, 2, 3, 5);
  AddReturnsOf(confusion, 3, 0, 4);
  AddReturnsOf(confusion, 0, 4, 9);
  const auto quality = PanopticQualityOf(confusion.Match());
  EXPECT_DOUBLE_EQ(quality.segmentation.value(), 0.8);
  EXPECT_DOUBLE_EQ(quality.recognition.value(), 1.0 / (1.0 + (2.0 + 2.0) / 2.0));
  EXPECT_DOUBLE_EQ(quality.quality.value(), quality.segmentation.value() * quality.recognition.value());
}

TEST(PanopticQuality, ALabelHalfOfNoObjectIsVoid) {
  Confusion confusion;
  AddReturnsOf(confusion, 1, 1, 5);
  AddReturnsOf(confusion, 1, 2, 3);
  AddReturnsOf(confusion, 0, 2, 3);
  const auto quality = PanopticQualityOf(confusion.Match());
  EXPECT_DOUBLE_EQ(quality.segmentation.value(), 5.0 / 8.0);
  EXPECT_DOUBLE_EQ(quality.recognition.value(), 1.0);
}

TEST(PanopticQuality, OfNothingIsNone) {
  Confusion confusion;
  AddReturnsOf(confusion, 0, 1, 5);
  EXPECT_TRUE(std::isnan(PanopticQualityOf(confusion.Match()).quality.value()));
}

TEST(PanopticQuality, ScansAddUp) {
  Confusion found;
  AddReturnsOf(found, 1, 1, 4);
  Confusion missed;
  AddReturnsOf(missed, 1, 0, 4);
  auto sum = PanopticQualityOf(found.Match()).quality;
  sum.Add(PanopticQualityOf(missed.Match()).quality);
  EXPECT_DOUBLE_EQ(sum.value(), 1.0 / 1.5);
}

}  // namespace
}  // namespace lookout::eval
