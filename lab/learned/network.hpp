// SqueezeSeg: which class each pixel of a view is of.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lab/learned/layers.hpp"
#include "lab/learned/recurrent_crf.hpp"
#include "lab/learned/weights.hpp"

namespace lookout::learned {

/// A pixel of a view that holds a return.
struct ViewPixel {
  int row = 0;
  int column = 0;
  std::array<float, kNumChannels> channels{};  // ChannelsOf
};

/// A squeeze by 1 x 1, on request a deconvolution, and two expansions, 1 x 1 and 3 x 3, side by side.
class Fire {
 public:
  enum class Width { kSame, kDoubled };
  struct Shape {
    int num_inputs = 0;
    int num_squeezed = 0;
    int num_expanded = 0;  // of each of the two
    Width width = Width::kSame;
  };

  /// Takes its weights off the front.
  Fire(const Shape& shape, std::span<const float>& weights);

  Image Apply(const Image& image) const;
  std::int64_t MultiplyAdds(int num_rows, int num_input_columns) const;

 private:
  Convolution squeeze_;
  std::optional<Deconvolution> deconvolution_;
  Convolution expand_1_;
  Convolution expand_3_;
};

/// The network of squeezeseg.py, layer by layer; only the columns are halved, so views of any number of rows go through.
class Network {
 public:
  /// @throws std::runtime_error when there are more or fewer weights than the network has
  explicit Network(const Weights& weights);

  /// The probabilities of the classes of each pixel. Equal pixels give equal bytes with one C library (exponential functions).
  std::vector<OfClasses> Classify(std::span<const ViewPixel> pixels, int num_rows) const;

  /// Multiplications with additions for a view, without the random field.
  std::int64_t MultiplyAdds(int num_rows) const;

 private:
  Network(const Weights& weights, std::span<const float> rest);
  Image LogOdds(const Image& image) const;

  std::array<float, kNumChannels> mean_;
  std::array<float, kNumChannels> deviation_;
  Convolution conv_1_;
  Convolution conv_1_skip_;
  std::vector<Fire> fires_;  // 2 to 13
  Convolution conv_14_;
  RecurrentCrf crf_;
};

}  // namespace lookout::learned
