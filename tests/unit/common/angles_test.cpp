#include "common/core/angles.hpp"

#include <gtest/gtest.h>

namespace lookout {
namespace {

TEST(WrapTo2Pi, StaysBelowTwoPiForTinyNegativeAngles) {
  EXPECT_EQ(WrapTo2Pi(-1e-20), 0.0);
  EXPECT_LT(WrapTo2Pi(-1e-15), kTwoPi);
}

TEST(WrapTo2Pi, TakesOutWholeTurns) {
  EXPECT_EQ(WrapTo2Pi(0.0), 0.0);
  EXPECT_EQ(WrapTo2Pi(kTwoPi), 0.0);
  EXPECT_NEAR(WrapTo2Pi(-kPi / 2.0), 1.5 * kPi, 1e-15);
  EXPECT_NEAR(WrapTo2Pi(7.0 * kTwoPi + 1.0), 1.0, 1e-14);
}

TEST(WrapToPi, GivesTheShortWayRound) {
  EXPECT_NEAR(WrapToPi(DegToRad(350.0)), DegToRad(-10.0), 1e-15);
  EXPECT_NEAR(WrapToPi(DegToRad(-350.0)), DegToRad(10.0), 1e-14);
  EXPECT_EQ(WrapToPi(kPi), -kPi);
}

TEST(Sector, ContainsZeroWhenItCrossesNorth) {
  const Sector sector{DegToRad(350.0), DegToRad(20.0)};
  EXPECT_TRUE(sector.Contains(0.0));
  EXPECT_TRUE(sector.Contains(DegToRad(355.0)));
  EXPECT_TRUE(sector.Contains(DegToRad(9.9)));
  EXPECT_FALSE(sector.Contains(DegToRad(180.0)));
}

TEST(Sector, IsHalfOpen) {
  const Sector sector{1.0, 1.0};
  EXPECT_TRUE(sector.Contains(1.0));
  EXPECT_FALSE(sector.Contains(2.0));
}

TEST(Sector, OfAWholeTurnContainsEverything) {
  const Sector sector{3.0, kTwoPi};
  EXPECT_TRUE(sector.Contains(2.9999999));
  EXPECT_TRUE(sector.Contains(3.0));
}

}  // namespace
}  // namespace lookout
