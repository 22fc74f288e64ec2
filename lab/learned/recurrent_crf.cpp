#include "lab/learned/recurrent_crf.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace lookout::learned {
namespace {

struct Neighbour {
  std::size_t index;
  float angle;     // weights of the message from this neighbour
  float position;  // and by angle
};

// The neighbours of each pixel, row by row.
std::vector<std::vector<Neighbour>> NeighboursOf(std::span<const CrfPixel> pixels, int num_rows, int num_columns) {
  constexpr std::int32_t kEmpty = -1;
  std::vector<std::int32_t> index_at(static_cast<std::size_t>(num_rows) * static_cast<std::size_t>(num_columns), kEmpty);
  const auto place = [num_columns](int row, int column) { return static_cast<std::size_t>(std::int64_t{row} * num_columns + column); };
  for (std::size_t i = 0; i < pixels.size(); ++i) index_at[place(pixels[i].row, pixels[i].column)] = static_cast<std::int32_t>(i);
  std::vector<std::vector<Neighbour>> neighbours(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const auto& pixel = pixels[i];
    for (int row = std::max(0, pixel.row - RecurrentCrf::kRowsAround); row <= std::min(num_rows - 1, pixel.row + RecurrentCrf::kRowsAround); ++row) {
      const int last_column = std::min(num_columns - 1, pixel.column + RecurrentCrf::kColumnsAround);
      for (int column = std::max(0, pixel.column - RecurrentCrf::kColumnsAround); column <= last_column; ++column) {
        const auto index = index_at[place(row, column)];
        if (index == kEmpty || static_cast<std::size_t>(index) == i) continue;
        const auto& other = pixels[static_cast<std::size_t>(index)];
        const auto rows_apart = static_cast<float>(row - pixel.row);
        const auto columns_apart = static_cast<float>(column - pixel.column);
        float distance2 = 0.0F;
        for (std::size_t axis = 0; axis < 3; ++axis) distance2 += std::pow(other.position[axis] - pixel.position[axis], 2.0F);
        const float angle =
            std::exp(-(rows_apart * rows_apart + columns_apart * columns_apart) / (2.0F * std::pow(RecurrentCrf::kDeviationOfAngle, 2.0F)));
        neighbours[i].push_back(
            {static_cast<std::size_t>(index), angle, angle * std::exp(-distance2 / (2.0F * std::pow(RecurrentCrf::kDeviationOfPosition, 2.0F)))});
      }
    }
  }
  return neighbours;
}

}  // namespace

OfClasses Softmax(const OfClasses& log_odds) {
  const float greatest = *std::ranges::max_element(log_odds);
  OfClasses probability{};
  float sum = 0.0F;
  for (std::size_t c = 0; c < kNumClasses; ++c) sum += probability[c] = std::exp(log_odds[c] - greatest);
  for (float& one : probability) one /= sum;
  return probability;
}

void RecurrentCrf::Refine(std::span<CrfPixel> pixels, int num_rows, int num_columns) const {
  const auto neighbours = NeighboursOf(pixels, num_rows, num_columns);
  std::vector<OfClasses> probability(pixels.size());
  for (int step = 0; step < kSteps; ++step) {
    std::ranges::transform(pixels, probability.begin(), Softmax, &CrfPixel::log_odds);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      OfClasses by_angle{};
      OfClasses by_position{};
      for (const auto& neighbour : neighbours[i]) {
        for (std::size_t c = 0; c < kNumClasses; ++c) {
          by_angle[c] += neighbour.angle * probability[neighbour.index][c];
          by_position[c] += neighbour.position * probability[neighbour.index][c];
        }
      }
      for (std::size_t c = 0; c < kNumClasses; ++c) {
        float pairwise = 0.0F;
        for (std::size_t other = 0; other < kNumClasses; ++other) {
          pairwise += of_angle_[c][other] * by_angle[other] + of_position_[c][other] * by_position[other];
        }
        pixels[i].log_odds[c] = probability[i][c] + pairwise;
      }
    }
  }
}

}  // namespace lookout::learned
