// The layers of SqueezeSeg: images in, images out, in single precision. Equal bytes on any processor: each value sums up its products in a fixed
// order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lookout::learned {

/// Values [channel x row x column], column fastest.
struct Image {
  int num_channels = 0;
  int num_rows = 0;
  int num_columns = 0;
  std::vector<float> values;

  Image() = default;
  Image(int channels, int rows, int columns)
      : num_channels(channels), num_rows(rows), num_columns(columns), values(static_cast<std::size_t>(channels) * PixelsOfChannel()) {}
  std::size_t PixelsOfChannel() const { return static_cast<std::size_t>(num_rows) * static_cast<std::size_t>(num_columns); }
  const float* Row(int channel, int row) const { return values.data() + Offset(channel, row); }
  float* Row(int channel, int row) { return values.data() + Offset(channel, row); }

 private:
  std::size_t Offset(int channel, int row) const {
    return (static_cast<std::size_t>(channel) * static_cast<std::size_t>(num_rows) + static_cast<std::size_t>(row)) *
           static_cast<std::size_t>(num_columns);
  }
};

enum class Activation { kNone, kRelu };

/// A convolution with zeros around the image, so that rows stay and columns become columns / stride.
class Convolution {
 public:
  struct Shape {
    int num_inputs = 1;   // channels
    int num_outputs = 1;  // channels
    int kernel_rows = 1;  // 1 or 3
    int kernel_columns = 1;
    int stride = 1;  // of columns

    /// Products of which a value is the sum.
    std::size_t NumTaps() const { return static_cast<std::size_t>(std::int64_t{num_inputs} * kernel_rows * kernel_columns); }
  };

  /// @param weight  [output x input x kernel row x kernel column]
  /// @param bias    [output]
  /// @throws std::logic_error for weights of another number
  Convolution(const Shape& shape, std::span<const float> weight, std::span<const float> bias, Activation activation);

  /// Precondition: an image of num_inputs channels, whose columns are a multiple of 16 strides.
  /// Cost: MultiplyAdds
  Image Apply(const Image& image) const;

  const Shape& shape() const { return shape_; }
  std::int64_t MultiplyAdds(int num_rows, int num_input_columns) const;

 private:
  Shape shape_;
  Activation activation_;
  std::vector<float> weight_;  // [output / 4 x input x kernel row x kernel column x 4]: 0 where outputs are no multiple of 4
  std::vector<float> bias_;    // [outputs, rounded up to 4]
};

/// A transposed convolution of 1 x 4 with stride 2, which doubles the columns, and a rectifier.
class Deconvolution {
 public:
  /// @param weight  [input x output x 4], as many outputs as inputs
  /// @param bias    [output]
  Deconvolution(int num_channels, std::span<const float> weight, std::span<const float> bias);

  Image Apply(const Image& image) const;
  std::int64_t MultiplyAdds(int num_rows, int num_input_columns) const;

 private:
  Convolution even_;  // columns of the result
  Convolution odd_;
};

/// The greatest of 3 x 3 pixels, at every second column. Precondition: no value is below 0
Image MaxPool(const Image& image);

/// Channels of `one`, then channels of `other`. Precondition: equal rows and columns
Image Joined(Image one, const Image& other);

/// Precondition: the same shape
void AddTo(Image& sum, const Image& other);

}  // namespace lookout::learned
