#include <gtest/gtest.h>

#include "lab/eval/truth.hpp"

namespace lookout::eval {
namespace {

const Polygon kSquare{{0.0, 0.0}, {2.0, 0.0}, {2.0, 2.0}, {0.0, 2.0}};

TEST(OutlineDistance, InsideIsNotOutsideButHasAnEdge) {
  const auto distance = DistanceToOutline({0.5, 1.0}, kSquare);
  EXPECT_DOUBLE_EQ(distance.edge_m, 0.5);
  EXPECT_DOUBLE_EQ(distance.outside_m, 0.0);
}

TEST(OutlineDistance, OutsideIsTheDistanceToSideOrCorner) {
  EXPECT_DOUBLE_EQ(DistanceToOutline({3.0, 1.0}, kSquare).outside_m, 1.0);
  EXPECT_DOUBLE_EQ(DistanceToOutline({5.0, 6.0}, kSquare).outside_m, 5.0);
  EXPECT_DOUBLE_EQ(DistanceToOutline({-1.0, 2.0}, kSquare).outside_m, 1.0) << "level with a vertex";
}

TEST(OutlineDistance, DirectionOfTheOutlineDoesNotMatter) {
  const Polygon reversed(kSquare.rbegin(), kSquare.rend());
  EXPECT_DOUBLE_EQ(DistanceToOutline({0.5, 1.0}, reversed).outside_m, 0.0);
  EXPECT_DOUBLE_EQ(DistanceToOutline({3.0, 1.0}, reversed).outside_m, 1.0);
}

TEST(OutlineDistance, BayOfAConcaveOutlineIsOutside) {
  const Polygon bay{{0.0, 0.0}, {4.0, 0.0}, {4.0, 4.0}, {3.0, 4.0}, {3.0, 1.0}, {1.0, 1.0}, {1.0, 4.0}, {0.0, 4.0}};
  EXPECT_DOUBLE_EQ(DistanceToOutline({2.0, 3.0}, bay).outside_m, 1.0);
  EXPECT_DOUBLE_EQ(DistanceToOutline({0.5, 3.0}, bay).outside_m, 0.0);
}

TEST(OutlineDistance, OnePointIsAnOutline) { EXPECT_DOUBLE_EQ(DistanceToOutline({3.0, 4.0}, {{0.0, 0.0}}).outside_m, 5.0); }

}  // namespace
}  // namespace lookout::eval
