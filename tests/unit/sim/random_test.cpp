#include "lab/sim/random.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace lookout::sim {
namespace {

TEST(Random, StreamsAndSeedsDifferAndRepeat) {
  EXPECT_NE(Random(1, 1).Next(), Random(1, 2).Next());
  EXPECT_NE(Random(1, 1).Next(), Random(2, 1).Next());
  EXPECT_EQ(Random(7, 3).Next(), Random(7, 3).Next());
}

TEST(Random, UniformStaysInsideItsHalfOpenRange) {
  Random random(1, 0);
  double sum = 0.0;
  constexpr int kCount = 100000;
  for (int i = 0; i < kCount; ++i) {
    const double value = random.Uniform(-2.0, 3.0);
    ASSERT_GE(value, -2.0);
    ASSERT_LT(value, 3.0);
    sum += value;
  }
  EXPECT_NEAR(sum / kCount, 0.5, 0.02);
}

TEST(Random, NormalHasMeanZeroAndDeviationOne) {
  Random random(2, 0);
  constexpr int kCount = 100000;
  double sum = 0.0;
  double squares = 0.0;
  int num_within_one = 0;
  for (int i = 0; i < kCount; ++i) {
    const double value = random.Normal();
    ASSERT_LT(std::abs(value), 3.47);
    sum += value;
    squares += value * value;
    num_within_one += std::abs(value) < 1.0 ? 1 : 0;
  }
  EXPECT_NEAR(sum / kCount, 0.0, 0.01);
  EXPECT_NEAR(squares / kCount, 1.0, 0.02);
  EXPECT_NEAR(static_cast<double>(num_within_one) / kCount, 0.68, 0.02);
}

}  // namespace
}  // namespace lookout::sim
