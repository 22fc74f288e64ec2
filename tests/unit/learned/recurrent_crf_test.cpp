#include "lab/learned/recurrent_crf.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace lookout::learned {
namespace {

constexpr Compatibility kNothing{};

Compatibility Diagonal(float value) {
  Compatibility compatibility{};
  for (std::size_t c = 0; c < kNumClasses; ++c) compatibility[c][c] = value;
  return compatibility;
}

// exp(-d^2 / (2 * 0.9^2)) of a pixel so far away.
float Angle(float squared_pixels) { return std::exp(-squared_pixels / 1.62F); }

TEST(Softmax, GivesProbabilities) {
  const auto probability = Softmax({0.0F, std::log(2.0F), std::log(5.0F)});
  EXPECT_NEAR(probability[0], 0.125F, 1e-6F);
  EXPECT_NEAR(probability[1], 0.25F, 1e-6F);
  EXPECT_NEAR(probability[2], 0.625F, 1e-6F);
  EXPECT_NEAR(Softmax({1000.0F, 0.0F, 0.0F})[0], 1.0F, 1e-6F) << "great log odds do not overflow";
}

TEST(RecurrentCrf, WithoutNeighboursHandsOnItsOwnProbabilitiesThreeTimes) {
  std::vector<CrfPixel> pixels{{4, 7, {}, {2.0F, 0.0F, -1.0F}}};
  const auto expected = Softmax(Softmax(Softmax(pixels[0].log_odds)));
  RecurrentCrf(Diagonal(1.0F), Diagonal(1.0F)).Refine(pixels, 16, 512);
  for (std::size_t c = 0; c < kNumClasses; ++c) EXPECT_NEAR(pixels[0].log_odds[c], expected[c], 1e-6F);
}

// By hand, the first step alone: its neighbour tells what it is, weighted by the Gaussian of one pixel and the compatibility 0.5; the next steps
// begin with that.
TEST(RecurrentCrf, StepsAsWrittenByHand) {
  std::vector<CrfPixel> pixels{{0, 0, {}, {0.0F, 3.0F, 0.0F}}, {0, 1, {}, {0.0F, 0.0F, 0.0F}}};
  std::vector<OfClasses> log_odds{pixels[0].log_odds, pixels[1].log_odds};
  for (int step = 0; step < 3; ++step) {
    const std::vector<OfClasses> probability{Softmax(log_odds[0]), Softmax(log_odds[1])};
    for (std::size_t i = 0; i < 2; ++i) {
      for (std::size_t c = 0; c < kNumClasses; ++c) log_odds[i][c] = probability[i][c] + 0.5F * Angle(1.0F) * probability[1 - i][c];
    }
  }
  RecurrentCrf(Diagonal(0.5F), kNothing).Refine(pixels, 1, 512);
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t c = 0; c < kNumClasses; ++c) EXPECT_NEAR(pixels[i].log_odds[c], log_odds[i][c], 1e-6F) << i << " " << c;
  }
  EXPECT_GT(pixels[1].log_odds[1], pixels[1].log_odds[0]) << "it believes its neighbour";
}

TEST(RecurrentCrf, ListensOverThreeRowsAndFiveColumnsOfTheImage) {
  const auto is_heard = [](int row, int column, int num_rows, int num_columns) {
    std::vector<CrfPixel> pixels{{5, 100, {}, {}}, {row, column, {}, {0.0F, 9.0F, 0.0F}}};
    RecurrentCrf(Diagonal(1.0F), kNothing).Refine(pixels, num_rows, num_columns);
    return pixels[0].log_odds[1] > pixels[0].log_odds[0] + 1e-3F;
  };
  EXPECT_TRUE(is_heard(6, 102, 16, 512));
  EXPECT_TRUE(is_heard(4, 98, 16, 512));
  EXPECT_FALSE(is_heard(7, 100, 16, 512));
  EXPECT_FALSE(is_heard(5, 103, 16, 512));
  EXPECT_TRUE(is_heard(4, 99, 6, 101)) << "at the edge of the image";
}

TEST(RecurrentCrf, ByPositionBelievesOnlyWhatIsNear) {
  const auto heard = [](float apart) {
    std::vector<CrfPixel> pixels{{5, 100, {0.0F, 0.0F, 0.0F}, {}}, {5, 101, {0.0F, apart, 0.0F}, {0.0F, 9.0F, 0.0F}}};
    RecurrentCrf(kNothing, Diagonal(1.0F)).Refine(pixels, 16, 512);
    return pixels[0].log_odds[1] - pixels[0].log_odds[0];
  };
  EXPECT_GT(heard(0.0F), 0.1F);
  EXPECT_LT(heard(0.015F), heard(0.0F));
  EXPECT_NEAR(heard(0.15F), 0.0F, 1e-6F) << "ten deviations away";
}

TEST(RecurrentCrf, CompatibilitySaysWhichClassSpeaksForWhich) {
  Compatibility compatibility{};
  compatibility[2][1] = 1.0F;  // a neighbour of class 1 speaks for class 2
  std::vector<CrfPixel> pixels{{5, 100, {}, {}}, {5, 101, {}, {0.0F, 9.0F, 0.0F}}};
  RecurrentCrf(compatibility, kNothing).Refine(pixels, 16, 512);
  EXPECT_GT(pixels[0].log_odds[2], pixels[0].log_odds[1]);
  EXPECT_FLOAT_EQ(pixels[0].log_odds[1], pixels[0].log_odds[0]);
}

}  // namespace
}  // namespace lookout::learned
