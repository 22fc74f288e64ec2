#include "lab/learned/layers.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <stdexcept>

namespace lookout::learned {
namespace {

// Different everywhere, of both signs.
std::vector<float> Numbers(std::size_t count, float scale) {
  std::vector<float> numbers(count);
  for (std::size_t i = 0; i < count; ++i) numbers[i] = scale * static_cast<float>(static_cast<int>((i * 37 + 11) % 23) - 11);
  return numbers;
}

Image Filled(int channels, int rows, int columns) {
  Image image(channels, rows, columns);
  image.values = Numbers(image.values.size(), 0.25F);
  return image;
}

float At(const Image& image, int channel, int row, int column) {
  if (row < 0 || row >= image.num_rows || column < 0 || column >= image.num_columns) return 0.0F;
  return image.Row(channel, row)[column];
}

// By the definition, value by value.
float Convolved(const Image& image, const Convolution::Shape& shape, const std::vector<float>& weight, const std::vector<float>& bias, int output,
                int row, int column) {
  double sum = bias[static_cast<std::size_t>(output)];
  std::size_t tap = static_cast<std::size_t>(output) * shape.NumTaps();
  for (int input = 0; input < shape.num_inputs; ++input) {
    for (int r = 0; r < shape.kernel_rows; ++r) {
      for (int c = 0; c < shape.kernel_columns; ++c) {
        sum += double{weight[tap++]} * At(image, input, row + r - shape.kernel_rows / 2, column * shape.stride + c - shape.kernel_columns / 2);
      }
    }
  }
  return static_cast<float>(sum);
}

void ExpectTheDefinition(const Convolution::Shape& shape, int rows, int columns) {
  const auto image = Filled(shape.num_inputs, rows, columns);
  const auto weight = Numbers(static_cast<std::size_t>(shape.num_outputs) * shape.NumTaps(), 0.125F);
  const auto bias = Numbers(static_cast<std::size_t>(shape.num_outputs), 0.5F);
  const auto result = Convolution(shape, weight, bias, Activation::kNone).Apply(image);
  ASSERT_EQ(result.num_channels, shape.num_outputs);
  ASSERT_EQ(result.num_rows, rows);
  ASSERT_EQ(result.num_columns, columns / shape.stride);
  for (int output = 0; output < shape.num_outputs; ++output) {
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < result.num_columns; ++column) {
        ASSERT_EQ(At(result, output, row, column), Convolved(image, shape, weight, bias, output, row, column))
            << output << " " << row << " " << column;
      }
    }
  }
}

TEST(Convolution, OfOneByOneMixesChannels) { ExpectTheDefinition({6, 8, 1, 1, 1}, 2, 32); }

TEST(Convolution, OfThreeByThreeSeesZerosAroundTheImage) { ExpectTheDefinition({3, 4, 3, 3, 1}, 3, 16); }

TEST(Convolution, OfStrideTwoTakesEverySecondColumn) { ExpectTheDefinition({5, 4, 3, 3, 2}, 4, 64); }

TEST(Convolution, HasAnyNumberOfOutputs) { ExpectTheDefinition({4, 3, 3, 3, 1}, 2, 16); }

TEST(Convolution, RectifiesWhereAsked) {
  Image image(1, 1, 16);
  for (int column = 0; column < 16; ++column) image.Row(0, 0)[column] = static_cast<float>(column - 8);
  const auto result = Convolution({1, 1}, std::vector{2.0F}, std::vector{1.0F}, Activation::kRelu).Apply(image);
  EXPECT_EQ(At(result, 0, 0, 0), 0.0F);
  EXPECT_EQ(At(result, 0, 0, 7), 0.0F);
  EXPECT_EQ(At(result, 0, 0, 15), 15.0F);
}

TEST(Convolution, RefusesWeightsAndImagesOfAnotherShape) {
  EXPECT_THROW(Convolution({2, 4}, Numbers(7, 1.0F), Numbers(4, 1.0F), Activation::kNone), std::logic_error);
  const Convolution convolution({2, 4}, Numbers(8, 1.0F), Numbers(4, 1.0F), Activation::kNone);
  EXPECT_THROW(convolution.Apply(Image(3, 1, 16)), std::logic_error);
  EXPECT_THROW(convolution.Apply(Image(2, 1, 15)), std::logic_error);
  EXPECT_EQ(convolution.MultiplyAdds(16, 512), 2 * 4 * 16 * 512);
}

TEST(Deconvolution, SpreadsEachColumnOverFour) {
  // A single 1 at column 5 gives the four taps at columns 9 to 12.
  Image image(1, 1, 16);
  image.Row(0, 0)[5] = 1.0F;
  const auto result = Deconvolution(1, std::vector{1.0F, 2.0F, 3.0F, 4.0F}, std::vector{0.0F}).Apply(image);
  ASSERT_EQ(result.num_columns, 32);
  for (int column = 0; column < 32; ++column) {
    EXPECT_EQ(At(result, 0, 0, column), column >= 9 && column <= 12 ? static_cast<float>(column - 8) : 0.0F) << column;
  }
}

TEST(Deconvolution, TakesWeightsByInputAndThenOutput) {
  Image image(2, 1, 16);
  image.Row(0, 0)[3] = 1.0F;  // the first input alone
  const std::vector<float> weight{0.0F, 1.0F, 0.0F, 0.0F, 0.0F, 5.0F, 0.0F, 0.0F, 0.0F, 7.0F, 0.0F, 0.0F, 0.0F, 9.0F, 0.0F, 0.0F};
  const auto result = Deconvolution(2, weight, std::vector{0.0F, 0.5F}).Apply(image);
  EXPECT_EQ(At(result, 0, 0, 6), 1.0F);
  EXPECT_EQ(At(result, 1, 0, 6), 5.5F);
  EXPECT_EQ(At(result, 1, 0, 20), 0.5F) << "the bias is everywhere";
}

TEST(MaxPool, TakesTheGreatestOfThreeByThreeAtEverySecondColumn) {
  Image image(1, 3, 8);
  image.Row(0, 0)[1] = 3.0F;
  image.Row(0, 2)[7] = 2.0F;
  const auto result = MaxPool(image);
  ASSERT_EQ(result.num_columns, 4);
  EXPECT_EQ(At(result, 0, 0, 0), 3.0F);
  EXPECT_EQ(At(result, 0, 1, 0), 3.0F) << "the row above";
  EXPECT_EQ(At(result, 0, 1, 1), 3.0F) << "the column before";
  EXPECT_EQ(At(result, 0, 2, 0), 0.0F) << "two rows above";
  EXPECT_EQ(At(result, 0, 1, 2), 0.0F);
  EXPECT_EQ(At(result, 0, 2, 3), 2.0F);
}

TEST(Images, AreJoinedByChannelAndAdded) {
  auto one = Filled(2, 1, 16);
  const auto other = Filled(1, 1, 16);
  const auto joined = Joined(one, other);
  EXPECT_EQ(joined.num_channels, 3);
  EXPECT_EQ(At(joined, 2, 0, 4), At(other, 0, 0, 4));
  AddTo(one, one);
  EXPECT_EQ(At(one, 1, 0, 3), 2.0F * At(joined, 1, 0, 3));
}

}  // namespace
}  // namespace lookout::learned
