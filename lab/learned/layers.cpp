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

  const float* At(int channel, int row, int kernel_column) const {
    const auto line = static_cast<std::size_t>((channel * num_rows + row) * stride + kernel_column % stride);
    return values.data() + line * static_cast<std::size_t>(phase_columns) + kernel_column / stride;
  }
};

Padded Pad(const Image& image, const Convolution::Shape& shape) {
  const int rows_around = shape.kernel_rows / 2;
  const int columns_around = shape.kernel_columns / 2;
  Padded padded{image.num_rows + 2 * rows_around, (image.num_columns + 2 * columns_around + shape.stride - 1) / shape.stride, shape.stride, {}};
  padded.values.resize(static_cast<std::size_t>(image.num_channels * padded.num_rows * padded.stride) *
                       static_cast<std::size_t>(padded.phase_columns));
  for (int channel = 0; channel < image.num_channels; ++channel) {
    for (int row = 0; row < image.num_rows; ++row) {
      const float* from = image.Row(channel, row);
      const auto line = static_cast<std::size_t>((channel * padded.num_rows + row + rows_around) * padded.stride);
      float* to = padded.values.data() + line * static_cast<std::size_t>(padded.phase_columns);
      for (int column = 0; column < image.num_columns; ++column) {
        const int place = column + columns_around;
        to[place % padded.stride * padded.phase_columns + place / padded.stride] = from[column];
      }
    }
  }
  return padded;
}

struct Kernel {
  const Convolution::Shape& shape;
  const float* weight;  // of four outputs
  const float* bias;
};

// Four channels of sixteen columns of one row: for each value the sum over inputs, kernel rows and kernel columns, in this order.
[[gnu::always_inline]] inline void ConvolveBlock(const Padded& padded, const Kernel& kernel, int row, int column, Sixteen (&sum)[kOutputsAtOnce]) {
  for (int output = 0; output < kOutputsAtOnce; ++output) sum[output] = Sixteen{} + kernel.bias[output];
  const float* weight = kernel.weight;
  for (int input = 0; input < kernel.shape.num_inputs; ++input) {
    for (int kernel_row = 0; kernel_row < kernel.shape.kernel_rows; ++kernel_row) {
      for (int kernel_column = 0; kernel_column < kernel.shape.kernel_columns; ++kernel_column) {
        Sixteen values;
        std::memcpy(&values, padded.At(input, row + kernel_row, kernel_column) + column, sizeof(values));
        for (int output = 0; output < kOutputsAtOnce; ++output) sum[output] += values * weight[output];
        weight += kOutputsAtOnce;
      }
    }
  }
}

[[gnu::always_inline]] inline void ConvolveFour(const Padded& padded, const Kernel& kernel, Activation activation, int first_output, Image& result) {
  const int num_outputs = std::min(kOutputsAtOnce, result.num_channels - first_output);
  for (int row = 0; row < result.num_rows; ++row) {
    for (int column = 0; column < result.num_columns; column += kColumnsAtOnce) {
      Sixteen sum[kOutputsAtOnce];
      ConvolveBlock(padded, kernel, row, column, sum);
      for (int output = 0; output < num_outputs; ++output) {
        if (activation == Activation::kRelu) sum[output] = sum[output] > 0.0F ? sum[output] : Sixteen{};
        std::memcpy(result.Row(first_output + output, row) + column, &sum[output], sizeof(Sixteen));
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
  const auto num_taps = static_cast<std::size_t>(shape.num_inputs * shape.kernel_rows * shape.kernel_columns);
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
  Image result(shape_.num_outputs, image.num_rows, image.num_columns / shape_.stride);
  const std::size_t block_size = weight_.size() / bias_.size() * kOutputsAtOnce;
  for (int output = 0; output < shape_.num_outputs; output += kOutputsAtOnce) {
    const auto block = static_cast<std::size_t>(output / kOutputsAtOnce);
    convolve(padded, {shape_, weight_.data() + block * block_size, bias_.data() + output}, activation_, output, result);
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
