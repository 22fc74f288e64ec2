#include "lab/learned/network.hpp"

#include <cstddef>
#include <stdexcept>
#include <string>

namespace lookout::learned {
namespace {

using Width = Fire::Width;

constexpr int kFirstChannels = 64;  // of conv 1, its skip and the last fire

// The next numbers of the file. @throws std::runtime_error when there are fewer
std::span<const float> Take(std::size_t count, std::span<const float>& rest) {
  if (rest.size() < count) throw std::runtime_error("SqueezeSeg: there are fewer weights than the network has");
  const auto taken = rest.first(count);
  rest = rest.subspan(count);
  return taken;
}

Convolution TakeConvolution(const Convolution::Shape& shape, Activation activation, std::span<const float>& rest) {
  const auto num_outputs = static_cast<std::size_t>(shape.num_outputs);
  const auto weight = Take(num_outputs * shape.NumTaps(), rest);
  const auto bias = Take(num_outputs, rest);
  return {shape, weight, bias, activation};
}

std::optional<Deconvolution> TakeDeconvolution(int num_channels, Width width, std::span<const float>& rest) {
  if (width == Width::kSame) return std::nullopt;
  const auto count = static_cast<std::size_t>(num_channels);
  const auto weight = Take(count * count * 4, rest);
  const auto bias = Take(count, rest);
  return Deconvolution(num_channels, weight, bias);
}

std::vector<Fire> TakeFires(std::span<const float>& rest) {
  constexpr Fire::Shape kFires[] = {{64, 16, 64, Width::kSame},     {128, 16, 64, Width::kSame},    {128, 32, 128, Width::kSame},
                                    {256, 32, 128, Width::kSame},   {256, 48, 192, Width::kSame},   {384, 48, 192, Width::kSame},
                                    {384, 64, 256, Width::kSame},   {512, 64, 256, Width::kSame},   {512, 64, 128, Width::kDoubled},
                                    {256, 32, 64, Width::kDoubled}, {128, 16, 32, Width::kDoubled}, {64, 16, 32, Width::kDoubled}};
  std::vector<Fire> fires;
  fires.reserve(std::size(kFires));
  for (const auto& shape : kFires) fires.emplace_back(shape, rest);
  return fires;
}

Compatibility TakeCompatibility(std::span<const float>& rest) {
  Compatibility compatibility{};
  for (auto& row : compatibility) {
    for (float& one : row) one = Take(1, rest).front();
  }
  return compatibility;
}

RecurrentCrf TakeCrf(std::span<const float>& rest) {
  const auto of_angle = TakeCompatibility(rest);
  const auto of_position = TakeCompatibility(rest);
  if (!rest.empty()) throw std::runtime_error("SqueezeSeg: there are " + std::to_string(rest.size()) + " weights more than the network has");
  return {of_angle, of_position};
}

}  // namespace

Fire::Fire(const Shape& shape, std::span<const float>& weights)
    : squeeze_(TakeConvolution({shape.num_inputs, shape.num_squeezed}, Activation::kRelu, weights)),
      deconvolution_(TakeDeconvolution(shape.num_squeezed, shape.width, weights)),
      expand_1_(TakeConvolution({shape.num_squeezed, shape.num_expanded}, Activation::kRelu, weights)),
      expand_3_(TakeConvolution({shape.num_squeezed, shape.num_expanded, 3, 3}, Activation::kRelu, weights)) {}

Image Fire::Apply(const Image& image) const {
  auto squeezed = squeeze_.Apply(image);
  if (deconvolution_) squeezed = deconvolution_->Apply(squeezed);
  return Joined(expand_1_.Apply(squeezed), expand_3_.Apply(squeezed));
}

std::int64_t Fire::MultiplyAdds(int num_rows, int num_input_columns) const {
  const int num_columns = deconvolution_ ? 2 * num_input_columns : num_input_columns;
  return squeeze_.MultiplyAdds(num_rows, num_input_columns) + (deconvolution_ ? deconvolution_->MultiplyAdds(num_rows, num_input_columns) : 0) +
         expand_1_.MultiplyAdds(num_rows, num_columns) + expand_3_.MultiplyAdds(num_rows, num_columns);
}

// Members take their weights in the order of their declaration, which is the order of the file.
Network::Network(const Weights& weights) : Network(weights, weights.values) {}

Network::Network(const Weights& weights, std::span<const float> rest)
    : mean_(weights.mean),
      deviation_(weights.deviation),
      conv_1_(TakeConvolution({kNumChannels, kFirstChannels, 3, 3, 2}, Activation::kRelu, rest)),
      conv_1_skip_(TakeConvolution({kNumChannels, kFirstChannels}, Activation::kRelu, rest)),
      fires_(TakeFires(rest)),
      conv_14_(TakeConvolution({kFirstChannels, kNumClasses, 3, 3}, Activation::kNone, rest)),
      crf_(TakeCrf(rest)) {}

Image Network::LogOdds(const Image& image) const {
  const auto fire = [this](int number, const Image& of) { return fires_[static_cast<std::size_t>(number - 2)].Apply(of); };
  const auto conv_1 = conv_1_.Apply(image);
  const auto fire_3 = fire(3, fire(2, MaxPool(conv_1)));
  const auto fire_5 = fire(5, fire(4, MaxPool(fire_3)));
  auto up = fire(10, fire(9, fire(8, fire(7, fire(6, MaxPool(fire_5))))));
  AddTo(up, fire_5);
  up = fire(11, up);
  AddTo(up, fire_3);
  up = fire(12, up);
  AddTo(up, conv_1);
  up = fire(13, up);
  AddTo(up, conv_1_skip_.Apply(image));
  return conv_14_.Apply(up);
}

std::vector<OfClasses> Network::Classify(std::span<const ViewPixel> pixels, int num_rows) const {
  Image image(kNumChannels, num_rows, kViewColumns);
  // Empty pixels are zeros before they are normalised, as in the authors' program.
  for (int channel = 0; channel < kNumChannels; ++channel) {
    const auto c = static_cast<std::size_t>(channel);
    std::fill_n(image.Row(channel, 0), image.PixelsOfChannel(), -mean_[c] / deviation_[c]);
  }
  std::vector<CrfPixel> seen;
  seen.reserve(pixels.size());
  for (const auto& pixel : pixels) {
    std::array<float, kNumChannels> normalised{};
    for (int channel = 0; channel < kNumChannels; ++channel) {
      const auto c = static_cast<std::size_t>(channel);
      normalised[c] = (pixel.channels[c] - mean_[c]) / deviation_[c];
      image.Row(channel, pixel.row)[pixel.column] = normalised[c];
    }
    seen.push_back({pixel.row, pixel.column, {normalised[0], normalised[1], normalised[2]}, {}});
  }
  const auto log_odds = LogOdds(image);
  for (auto& pixel : seen) {
    for (int c = 0; c < kNumClasses; ++c) pixel.log_odds[static_cast<std::size_t>(c)] = log_odds.Row(c, pixel.row)[pixel.column];
  }
  crf_.Refine(seen, num_rows, kViewColumns);
  std::vector<OfClasses> probability;
  probability.reserve(seen.size());
  for (const auto& pixel : seen) probability.push_back(Softmax(pixel.log_odds));
  return probability;
}

std::int64_t Network::MultiplyAdds(int num_rows) const {
  int num_columns = kViewColumns;
  std::int64_t sum =
      conv_1_.MultiplyAdds(num_rows, num_columns) + conv_1_skip_.MultiplyAdds(num_rows, num_columns) + conv_14_.MultiplyAdds(num_rows, num_columns);
  num_columns /= 4;  // conv 1 and a pooling
  for (std::size_t i = 0; i < fires_.size(); ++i) {
    constexpr std::size_t kFire4 = 2;
    constexpr std::size_t kFire6 = 4;
    constexpr std::size_t kFire11 = 9;
    if (i == kFire4 || i == kFire6) num_columns /= 2;
    if (i >= kFire11) num_columns *= 2;  // behind a deconvolution
    sum += fires_[i].MultiplyAdds(num_rows, num_columns);
  }
  return sum;
}

}  // namespace lookout::learned
