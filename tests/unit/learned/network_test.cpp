#include "lab/learned/network.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <stdexcept>

#include "tests/unit/learned/weights_test.hpp"

namespace lookout::learned {
namespace {

using namespace test;

std::vector<ViewPixel> SomePixels(int num_rows) {
  std::vector<ViewPixel> pixels;
  for (int row = 0; row < num_rows; ++row) {
    for (int column = 200; column < 230; ++column) {
      const auto x_m = static_cast<float>(10 + row);
      const auto y_m = 0.1F * static_cast<float>(column - 256);
      pixels.push_back({row, column, {x_m, y_m, 0.2F * static_cast<float>(row), 0.1F, std::hypot(x_m, y_m)}});
    }
  }
  return pixels;
}

TEST(Network, HasAsManyWeightsAsThePublishedOne) {
  EXPECT_NO_THROW(Network{AnyWeights()});
  EXPECT_THROW(Network{AnyWeights(kNumWeights - 1)}, std::runtime_error);
  EXPECT_THROW(Network{AnyWeights(kNumWeights + 1)}, std::runtime_error);
}

// Layer by layer, by hand: conv 1 and its skip, fires 2 to 9, fires with deconvolution 10 to 13, conv 14.
TEST(Network, CountsItsMultiplyAdds) {
  const auto fire = [](std::int64_t in, std::int64_t squeezed, std::int64_t expanded, std::int64_t pixels, std::int64_t growth = 1) {
    const std::int64_t deconvolution = growth == 2 ? squeezed * squeezed * 4 * pixels : 0;
    return in * squeezed * pixels + deconvolution + squeezed * expanded * 10 * pixels * growth;
  };
  const std::int64_t p = 16 * 512;
  const std::int64_t expected = 5 * 64 * 9 * p / 2 + 5 * 64 * p + fire(64, 16, 64, p / 4) + fire(128, 16, 64, p / 4) + fire(128, 32, 128, p / 8) +
                                fire(256, 32, 128, p / 8) + fire(256, 48, 192, p / 16) + fire(384, 48, 192, p / 16) + fire(384, 64, 256, p / 16) +
                                fire(512, 64, 256, p / 16) + fire(512, 64, 128, p / 16, 2) + fire(256, 32, 64, p / 8, 2) +
                                fire(128, 16, 32, p / 4, 2) + fire(64, 16, 32, p / 2, 2) + 64 * 3 * 9 * p;
  EXPECT_EQ(Network(AnyWeights()).MultiplyAdds(16), expected);
}

TEST(Network, GivesEachPixelProbabilities) {
  const Network network(AnyWeights());
  for (const int num_rows : {1, 16, 40}) {
    const auto pixels = SomePixels(num_rows);
    const auto probability = network.Classify(pixels, num_rows);
    ASSERT_EQ(probability.size(), pixels.size());
    for (const auto& one : probability) EXPECT_NEAR(one[0] + one[1] + one[2], 1.0F, 1e-5F);
  }
  EXPECT_TRUE(network.Classify({}, 16).empty());
}

TEST(Network, SeesTheSurroundingsOfAPixel) {
  const Network network(AnyWeights());
  const auto pixels = SomePixels(16);
  auto others = pixels;
  for (std::size_t i = 0; i < others.size() / 2; ++i) others[i].channels[0] += 5.0F;
  const auto one = network.Classify(pixels, 16);
  EXPECT_EQ(one, network.Classify(pixels, 16)) << "the same pixels give the same bytes";
  EXPECT_NE(one.back(), network.Classify(others, 16).back()) << "half of the other pixels moved, and it did not notice";
}

}  // namespace
}  // namespace lookout::learned
