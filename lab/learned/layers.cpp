#include "lab/learned/layers.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace lookout::learned {
namespace {

constexpr int kOutputsAtOnce = 4;
constexpr int kColumnsAtOnce = 16;
// Sixteen columns, in as many registers as the processor needs for them.
using Sixteen = float __attribute__((vector_size(kColumnsAtOnce * sizeof(float))));

// An image with zeros around it. With a stride of 2 even and odd columns lie apart, so that a kernel reads neighbours.
struct Padded {
  int num_rows = 0;
  int phase_columns = 0;
  int stride = 1;
  std::vector<float> values;  // [channel x row x phase x column of the phase]

  std::size_t Place(int channel, int row, int column) const {
    const std::int64_t line = (std::int64_t{channel} * num_rows + row) * stride + column % stride;
    return static_cast<std::size_t>(line * phase_columns + column / stride);
  }
};

Padded Pad(const Image& image, const Convolution::Shape& shape) {
  const int rows_around = shape.kernel_rows / 2;
  const int columns_around = shape.kernel_columns / 2;
  Padded padded{image.num_rows + 2 * rows_around, (image.num_columns + 2 * columns_around + shape.stride - 1) / shape.stride, shape.stride, {}};
  padded.values.resize(static_cast<std::size_t>(std::int64_t{image.num_channels} * padded.num_rows * padded.stride * padded.phase_columns));
  for (int channel = 0; channel < image.num_channels; ++channel) {
    for (int row = 0; row < image.num_rows; ++row) {
      const float* from = image.Row(channel, row);
      for (int column = 0; column < image.num_columns; ++column) {
        padded.values[padded.Place(channel, row + rows_around, column + columns_around)] = from[column];
      }
    }
  }
  return padded;
}

// Where each product of a sum finds its value, from the value of the first: over inputs, kernel rows and kernel columns, in this order.
std::vector<std::size_t> TapsOf(const Padded& padded, const Convolution::Shape& shape) {
  std::vector<std::size_t> taps;
  taps.reserve(shape.NumTaps());
  for (int input = 0; input < shape.num_inputs; ++input) {
    for (int row = 0; row < shape.kernel_rows; ++row) {
      for (int column = 0; column < shape.kernel_columns; ++column) taps.push_back(padded.Place(input, row, column));
    }
  }
  return taps;
}

struct Kernel {
  std::span<const std::size_t> taps;
  const float* weight;  // of four outputs
  const float* bias;
};

// Four channels of sixteen columns of one row, each in registers of its own.
struct Sums {
  Sixteen first;
  Sixteen second;
  Sixteen third;
  Sixteen fourth;
};

[[gnu::always_inline]] inline void ConvolveBlock(const float* first, const Kernel& kernel, Sums& sums) {
  Sixteen sum_0 = Sixteen{} + kernel.bias[0];
  Sixteen sum_1 = Sixteen{} + kernel.bias[1];
  Sixteen sum_2 = Sixteen{} + kernel.bias[2];
  Sixteen sum_3 = Sixteen{} + kernel.bias[3];
  const float* weight = kernel.weight;
  for (const auto tap : kernel.taps) {
    Sixteen values;
    std::memcpy(&values, first + tap, sizeof(values));
    sum_0 += values * weight[0];
    sum_1 += values * weight[1];
    sum_2 += values * weight[2];
    sum_3 += values * weight[3];
    weight += kOutputsAtOnce;
  }
  sums = {sum_0, sum_1, sum_2, sum_3};
}

[[gnu::always_inline]] inline void ConvolveFour(const Padded& padded, const Kernel& kernel, Activation activation, int first_output, Image& result) {
  const int num_outputs = std::min(kOutputsAtOnce, result.num_channels - first_output);
  Sums sums{};
  for (int row = 0; row < result.num_rows; ++row) {
    for (int column = 0; column < result.num_columns; column += kColumnsAtOnce) {
      ConvolveBlock(padded.values.data() + padded.Place(0, row, column * padded.stride), kernel, sums);
      const Sixteen* const of_output[kOutputsAtOnce] = {&sums.first, &sums.second, &sums.third, &sums.fourth};
      for (int output = 0; output < num_outputs; ++output) {
        const Sixteen sum = *of_output[output];
        const Sixteen active = activation == Activation::kRelu ? (sum > 0.0F ? sum : Sixteen{}) : sum;
        std::memcpy(result.Row(first_output + output, row) + column, &active, sizeof(active));
      }
    }
  }
}

using Convolve = void (*)(const Padded&, const Kernel&, Activation, int, Image&);

void ConvolvePlainly(const Padded& padded, const Kernel& kernel, Activation activation, int first_output, Image& result) {
  ConvolveFour(padded, kernel, activation, first_output, result);
}

// Wider registers give the same bytes: they hold more columns, and no product is summed up in another order or without rounding.
#if defined(__x86_64__)
__attribute__((target("avx2"))) void ConvolveWithAvx2(const Padded& padded, const Kernel& kernel, Activation activation, int first_output,
                                                      Image& result) {
  ConvolveFour(padded, kernel, activation, first_output, result);
}
__attribute__((target("avx512f"))) void ConvolveWithAvx512(const Padded& padded, const Kernel& kernel, Activation activation, int first_output,
                                                           Image& result) {
  ConvolveFour(padded, kernel, activation, first_output, result);
}

Convolve Fastest() {
  if (__builtin_cpu_supports("avx512f") != 0) return ConvolveWithAvx512;
  if (__builtin_cpu_supports("avx2") != 0) return ConvolveWithAvx2;
  return ConvolvePlainly;
}
#else
Convolve Fastest() { return ConvolvePlainly; }
#endif

// Kernels of 1 x 3 over columns i - 1, i, i + 1 that give the even and the odd columns of a transposed convolution of 1 x 4 with stride 2: out of
// taps 3 and 1, and 2 and 0.
std::vector<float> HalfOf(std::span<const float> weight, int num_channels, bool is_odd) {
  const auto count = static_cast<std::size_t>(num_channels);
  std::vector<float> half(count * count * 3, 0.0F);
  for (std::size_t output = 0; output < count; ++output) {
    for (std::size_t input = 0; input < count; ++input) {
      const float* taps = weight.data() + (input * count + output) * 4;
      float* kernel = half.data() + (output * count + input) * 3;
      kernel[0] = is_odd ? 0.0F : taps[3];
      kernel[1] = is_odd ? taps[2] : taps[1];
      kernel[2] = is_odd ? taps[0] : 0.0F;
    }
  }
  return half;
}

}  // namespace

Convolution::Convolution(const Shape& shape, std::span<const float> weight, std::span<const float> bias, Activation activation)
    : shape_(shape), activation_(activation) {
  const auto num_outputs = static_cast<std::size_t>(shape.num_outputs);
  const std::size_t num_taps = shape.NumTaps();
  if (weight.size() != num_outputs * num_taps || bias.size() != num_outputs) throw std::logic_error("weights of another layer");
  const std::size_t num_blocks = (num_outputs + kOutputsAtOnce - 1) / kOutputsAtOnce;
  weight_.resize(num_blocks * num_taps * kOutputsAtOnce);
  bias_.resize(num_blocks * kOutputsAtOnce);
  std::ranges::copy(bias, bias_.begin());
  for (std::size_t output = 0; output < num_outputs; ++output) {
    float* block = weight_.data() + output / kOutputsAtOnce * num_taps * kOutputsAtOnce;
    for (std::size_t tap = 0; tap < num_taps; ++tap) block[tap * kOutputsAtOnce + output % kOutputsAtOnce] = weight[output * num_taps + tap];
  }
}

Image Convolution::Apply(const Image& image) const {
  if (image.num_channels != shape_.num_inputs || image.num_columns % (kColumnsAtOnce * shape_.stride) != 0) {
    throw std::logic_error("an image of another shape");
  }
  static const Convolve convolve = Fastest();
  const auto padded = Pad(image, shape_);
  const auto taps = TapsOf(padded, shape_);
  Image result(shape_.num_outputs, image.num_rows, image.num_columns / shape_.stride);
  const std::size_t block_size = weight_.size() / bias_.size() * kOutputsAtOnce;
  for (int output = 0; output < shape_.num_outputs; output += kOutputsAtOnce) {
    const auto block = static_cast<std::size_t>(output / kOutputsAtOnce);
    convolve(padded, {taps, weight_.data() + block * block_size, bias_.data() + output}, activation_, output, result);
  }
  return result;
}

std::int64_t Convolution::MultiplyAdds(int num_rows, int num_input_columns) const {
  return std::int64_t{shape_.num_outputs} * shape_.num_inputs * shape_.kernel_rows * shape_.kernel_columns * num_rows *
         (num_input_columns / shape_.stride);
}

Deconvolution::Deconvolution(int num_channels, std::span<const float> weight, std::span<const float> bias)
    : even_({num_channels, num_channels, 1, 3, 1}, HalfOf(weight, num_channels, false), bias, Activation::kRelu),
      odd_({num_channels, num_channels, 1, 3, 1}, HalfOf(weight, num_channels, true), bias, Activation::kRelu) {}

Image Deconvolution::Apply(const Image& image) const {
  const auto even = even_.Apply(image);
  const auto odd = odd_.Apply(image);
  Image result(image.num_channels, image.num_rows, 2 * image.num_columns);
  for (std::size_t i = 0; i < even.values.size(); ++i) {
    result.values[2 * i] = even.values[i];
    result.values[2 * i + 1] = odd.values[i];
  }
  return result;
}

std::int64_t Deconvolution::MultiplyAdds(int num_rows, int num_input_columns) const {
  constexpr int kTaps = 4;  // of two columns; the zeros of the two kernels are none
  return std::int64_t{even_.shape().num_inputs} * even_.shape().num_outputs * kTaps * num_rows * num_input_columns;
}

Image MaxPool(const Image& image) {
  Image result(image.num_channels, image.num_rows, image.num_columns / 2);
  for (int channel = 0; channel < image.num_channels; ++channel) {
    for (int row = 0; row < image.num_rows; ++row) {
      float* to = result.Row(channel, row);
      for (int from_row = std::max(0, row - 1); from_row <= std::min(image.num_rows - 1, row + 1); ++from_row) {
        const float* from = image.Row(channel, from_row);
        for (int column = 0; column < result.num_columns; ++column) {
          to[column] =
              std::max({to[column], from[std::max(0, 2 * column - 1)], from[2 * column], from[std::min(image.num_columns - 1, 2 * column + 1)]});
        }
      }
    }
  }
  return result;
}

Image Joined(Image one, const Image& other) {
  one.num_channels += other.num_channels;
  one.values.insert(one.values.end(), other.values.begin(), other.values.end());
  return one;
}

void AddTo(Image& sum, const Image& other) {
  for (std::size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += other.values[i];
}

}  // namespace lookout::learned
