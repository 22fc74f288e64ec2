#include "lab/eval/methods/label_figures.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace lookout::eval {
namespace {

struct Part {
  int object;
  int label;
  int count;
};

LabelFigures FiguresOfParts(const std::vector<Part>& parts, const std::set<int>& land) {
  Confusion confusion;
  for (const auto& part : parts) {
    for (int i = 0; i < part.count; ++i) confusion.Add(part.object, part.label);
  }
  return LabelFiguresOf(confusion.Match(), land);
}

// A shore (1) in three labels of 6, 3 and 1, a boat (2) whole, a buoy (3) of 5 returns within the shore's second label, one (4) of 2 returns in none.
TEST(LabelFigures, ByHand) {
  const auto figures = FiguresOfParts({{1, 1, 6}, {1, 2, 3}, {1, 3, 1}, {2, 4, 9}, {3, 2, 5}, {4, 0, 2}}, {1});
  EXPECT_DOUBLE_EQ(figures.land_iou.value(), 0.6);
  EXPECT_DOUBLE_EQ(figures.iou.value(), (0.6 + 1.0 + 5.0 / 8.0 + 0.0) / 4.0);
  EXPECT_DOUBLE_EQ(figures.land_too_many.value(), 1.0) << "labels 1 and 3 are mostly of land";
  EXPECT_DOUBLE_EQ(figures.lost.value(), 0.0) << "of the boat and the larger buoy";
  EXPECT_EQ(figures.lost.count, 2);
}

TEST(LabelFigures, AThingBelowHalfIsLost) {
  const auto figures = FiguresOfParts({{1, 1, 20}, {2, 1, 6}, {3, 3, 7}}, {1});
  EXPECT_DOUBLE_EQ(figures.lost.value(), 0.5);
}

TEST(LabelFigures, LandThatIsMergedIsNotTooFew) {
  EXPECT_DOUBLE_EQ(FiguresOfParts({{1, 1, 6}, {2, 1, 6}}, {1, 2}).land_too_many.value(), 0.0);
  EXPECT_EQ(FiguresOfParts({{3, 1, 6}}, {1, 2}).land_too_many.count, 0) << "no land is seen";
}

TEST(LabelFigures, ScansAddUpAndScenesCountTheSame) {
  auto scene = FiguresOfParts({{2, 1, 9}}, {1});
  scene.Add(FiguresOfParts({{2, 1, 9}}, {1}));
  scene.Add(FiguresOfParts({{2, 0, 9}}, {1}));
  EXPECT_DOUBLE_EQ(scene.iou.value(), 2.0 / 3.0);
  LabelFigures all;
  all.AddValues(scene);
  all.AddValues(FiguresOfParts({{2, 1, 9}}, {1}));
  all.AddValues(FiguresOfParts({}, {1}));
  EXPECT_DOUBLE_EQ(all.iou.value(), 5.0 / 6.0);
  EXPECT_EQ(all.iou.count, 2);
  EXPECT_EQ(all.land_iou.count, 0);
}

}  // namespace
}  // namespace lookout::eval
