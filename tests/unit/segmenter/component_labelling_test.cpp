#include "services/segmenter/core/paper/component_labelling.hpp"

#include <gtest/gtest.h>

#include "tests/unit/segmenter/scan_maker.hpp"

namespace lookout::segmenter {
namespace {

// Four columns to a pixel.
constexpr int kImageColumns = 360;

Scan FourToAPixel() { return test::EmptyScan({.num_columns = 1440, .num_rings = 1}); }

Groups Label(const Scan& scan, bool label_shadowed_returns) {
  const auto returns = ClassifyReturns(scan, {}).returns;
  return LabelComponents(scan, returns, {.image_columns = kImageColumns, .label_shadowed_returns = label_shadowed_returns, .search = {}});
}

TEST(LabelComponents, LeavesShadowedReturnsOutAsThePaperDoes) {
  auto scan = FourToAPixel();
  for (int column = 0; column < 8; ++column) test::SetReturn(scan, column, 0, 10.0 + 0.01 * column);
  EXPECT_EQ(Label(scan, false).of_return, (std::vector<std::int32_t>{0, -1, -1, -1, 0, -1, -1, -1}));
}

TEST(LabelComponents, GivesShadowedReturnsTheLabelOfTheirPixel) {
  auto scan = FourToAPixel();
  for (int column = 0; column < 8; ++column) test::SetReturn(scan, column, 0, 10.0 + 0.01 * column);
  EXPECT_EQ(Label(scan, true).of_return, std::vector<std::int32_t>(8, 0));
}

TEST(LabelComponents, DoesNotGiveAReturnFarBehindToTheObjectBeforeIt) {
  // A buoy on one column of pixel 1, a wall 20 m behind it on all the others.
  auto scan = FourToAPixel();
  for (int column = 0; column < 12; ++column) test::SetReturn(scan, column, 0, column == 5 ? 10.0 : 30.0);
  test::SetReturn(scan, 3, 0, 29.9);  // the one of its pixel that is in the image
  const auto components = Label(scan, true);
  // The wall left and right of the buoy is of two components in the image, and what is left of it in pixel 1 joins the nearer side.
  EXPECT_EQ(components.of_return, (std::vector<std::int32_t>{0, 0, 0, 0, 0, 1, 2, 2, 2, 2, 2, 2}));
}

TEST(LabelComponents, LooksAgainAtWhatIsHiddenAltogether) {
  // Two boats of which each pixel shows the nearer only.
  auto scan = FourToAPixel();
  for (int column = 0; column < 40; ++column) test::SetReturn(scan, column, 0, column % 4 == 0 ? 10.0 : 30.0);
  const auto components = Label(scan, true);
  EXPECT_EQ(components.count, 2);
  for (std::size_t i = 0; i < 40; ++i) EXPECT_EQ(components.of_return[i], i % 4 == 0 ? 0 : 1) << i;
}

TEST(LabelComponents, LabelsEveryReturnOfAHeadThatStandsStill) {
  // All columns in one pixel, at ranges that are all apart: more than any number of looks.
  auto scan = test::EmptyScan({.num_columns = 50, .num_rings = 1, .width_rad = 0.0});
  for (int column = 0; column < 50; ++column) test::SetReturn(scan, column, 0, 1.0 + 2.0 * column);
  const auto components = Label(scan, true);
  EXPECT_EQ(components.count, 50);
  for (const auto component : components.of_return) EXPECT_NE(component, Groups::kNone);
}

TEST(JoinShadowed, TakesTheNearestOfPixelAndNeighbours) {
  auto scan = FourToAPixel();
  test::SetReturn(scan, 2, 0, 12.3);  // pixel 0
  test::SetReturn(scan, 5, 0, 11.0);  // pixel 1, in the image
  test::SetReturn(scan, 6, 0, 11.8);  // pixel 1, shadowed; 0.8 m behind the one before it, 0.5 m before the one beside it
  const auto returns = ClassifyReturns(scan, {}).returns;
  const std::vector<std::int32_t> indices{0, 1, 2};
  const auto image = ProjectToAzimuths(scan, returns, indices, kImageColumns);
  const SearchParams params;
  const auto joined = JoinShadowed(image, returns, indices, SearchComponents(image, returns, params), params);
  EXPECT_TRUE(joined.remaining.empty());
  EXPECT_EQ(joined.components.of_return, (std::vector<std::int32_t>{0, 1, 0}));
}

}  // namespace
}  // namespace lookout::segmenter
