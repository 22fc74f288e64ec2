#include "lab/learned/views.hpp"

#include <gtest/gtest.h>

#include "tests/unit/segmenter/scan_maker.hpp"

namespace lookout::learned {
namespace {

using segmenter::test::EmptyScan;
using segmenter::test::SetReturn;

// 360 columns of one degree, column i at i + 0.5 degrees clockwise.
segmenter::Scan Turn() { return EmptyScan({.num_columns = 360, .num_rings = 4}); }

struct Place {
  int view;
  int row;
  int column;
};

Place PlaceOf(const Views& views, std::size_t index) {
  const int pixel = views.pixel_of_return[index];
  const int in_view = pixel % views.PixelsOfView();
  return {pixel / views.PixelsOfView(), in_view / kViewColumns, in_view % kViewColumns};
}

TEST(Views, AreCentredAheadToStarboardAsternAndToPort) {
  auto scan = Turn();
  const int columns[] = {0, 90, 180, 270};
  for (int view = 0; view < kNumViews; ++view) SetReturn(scan, columns[view], view, 10.0);
  const auto returns = segmenter::ClassifyReturns(scan, {}).returns;
  const auto views = ProjectToViews(scan, returns);
  EXPECT_EQ(views.num_rows, 4);
  ASSERT_EQ(returns.size(), 4U);
  for (int view = 0; view < kNumViews; ++view) {
    const auto place = PlaceOf(views, static_cast<std::size_t>(view));
    EXPECT_EQ(place.view, view);
    EXPECT_EQ(place.row, view) << "a row is a ring";
    EXPECT_EQ(place.column, 258) << "half a degree, 512 columns to 90 degrees, clockwise of the middle";
    EXPECT_EQ(views.return_of_pixel[static_cast<std::size_t>(views.pixel_of_return[static_cast<std::size_t>(view)])], view);
  }
}

TEST(Views, JoinAtFortyFiveDegrees) {
  auto scan = Turn();
  SetReturn(scan, 44, 0, 10.0);   // 44.5 degrees
  SetReturn(scan, 45, 0, 10.0);   // 45.5 degrees
  SetReturn(scan, 315, 0, 10.0);  // -44.5 degrees
  const auto returns = segmenter::ClassifyReturns(scan, {}).returns;
  const auto views = ProjectToViews(scan, returns);
  EXPECT_EQ(PlaceOf(views, 0).view, 0);
  EXPECT_EQ(PlaceOf(views, 0).column, 509);
  EXPECT_EQ(PlaceOf(views, 1).view, 1);
  EXPECT_EQ(PlaceOf(views, 1).column, 2);
  EXPECT_EQ(PlaceOf(views, 2).view, 0);
  EXPECT_EQ(PlaceOf(views, 2).column, 2);
}

TEST(Views, ShowTheNearestOfReturnsThatShareAPixel) {
  auto scan = EmptyScan({.num_columns = 4096, .num_rings = 1});
  SetReturn(scan, 0, 0, 20.0);
  SetReturn(scan, 1, 0, 10.0);
  const auto returns = segmenter::ClassifyReturns(scan, {}).returns;
  const auto views = ProjectToViews(scan, returns);
  ASSERT_EQ(views.pixel_of_return[0], views.pixel_of_return[1]);
  EXPECT_EQ(views.return_of_pixel[static_cast<std::size_t>(views.pixel_of_return[0])], 1);
}

TEST(Views, EachLooksLikeTheOneAhead) {
  auto scan = Turn();
  for (const int column : {20, 110, 200, 290}) SetReturn(scan, column, 1, 10.0, 0, 51);
  const auto returns = segmenter::ClassifyReturns(scan, {}).returns;
  const auto ahead = ChannelsOf(scan, returns[0], 0);
  EXPECT_LT(ahead[1], 0.0F) << "to the right is negative";
  EXPECT_FLOAT_EQ(ahead[3], 0.2F) << "51 of 255";
  EXPECT_NEAR(ahead[4], 10.0F, 1e-4F);
  for (int view = 1; view < kNumViews; ++view) {
    const auto channels = ChannelsOf(scan, returns[static_cast<std::size_t>(view)], view);
    for (std::size_t c = 0; c < channels.size(); ++c) EXPECT_NEAR(channels[c], ahead[c], 1e-4F) << "view " << view << ", channel " << c;
  }
}

}  // namespace
}  // namespace lookout::learned
