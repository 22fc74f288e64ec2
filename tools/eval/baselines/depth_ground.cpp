#include "tools/eval/baselines/depth_ground.hpp"

#include <array>
#include <cmath>
#include <utility>

namespace lookout::eval {

namespace {

// Weights of the Savitzky-Golay filter of second order, window 2 m + 1: A. Savitzky and M. J. E. Golay, Anal. Chem. 36 (1964), in closed form.
std::vector<double> SmoothingWeights(int window) {
  const int half_window = window / 2;
  const double m = half_window;
  std::vector<double> weights;
  for (int i = -half_window; i <= half_window; ++i) {
    weights.push_back(3.0 * (3.0 * m * m + 3.0 * m - 1.0 - 5.0 * i * i) / ((2.0 * m + 3.0) * (2.0 * m + 1.0) * (2.0 * m - 1.0)));
  }
  return weights;
}

// Indices beyond the ends are mirrored at the outermost ring.
int Mirrored(int ring, int num_rings) {
  if (num_rings == 1) return 0;
  const int period = 2 * (num_rings - 1);
  const int place = (ring % period + period) % period;
  return place < num_rings ? place : period - place;
}

}  // namespace

void FillGaps(DepthImage& image, const DepthGroundParams& params) {
  const int num_rings = image.num_rings();
  for (int column = 0; column < image.num_columns; ++column) {
    // From the top down, as the authors do; a filled pixel helps to fill those below it.
    for (int ring = num_rings - 1; ring >= 0; --ring) {
      auto& range_m = image.range_m[image.Pixel(column, ring)];
      if (range_m > 0.0F) continue;
      double sum_m = 0.0;
      int count = 0;
      for (int up = 1; up <= params.max_gap_rings && ring + up < num_rings; ++up) {
        for (int down = 1; down <= params.max_gap_rings && ring - down >= 0; ++down) {
          const double above_m = image.range_m[image.Pixel(column, ring + up)];
          const double below_m = image.range_m[image.Pixel(column, ring - down)];
          if (above_m <= 0.0 || below_m <= 0.0 || std::abs(above_m - below_m) >= params.max_gap_step_m) continue;
          sum_m += above_m + below_m;
          count += 2;
        }
      }
      if (count > 0) range_m = static_cast<float>(sum_m / count);
    }
  }
}

std::vector<double> SlopesOf(const DepthImage& image, const DepthGroundParams& params) {
  const int num_rings = image.num_rings();
  const auto weights = SmoothingWeights(params.smoothing_rings);
  const int half_window = params.smoothing_rings / 2;
  const auto weight = [&](int offset) { return weights[static_cast<std::size_t>(offset) + static_cast<std::size_t>(half_window)]; };
  std::vector<double> smoothed(image.range_m.size(), 0.0);
  std::vector<double> slope(static_cast<std::size_t>(num_rings));
  for (int column = 0; column < image.num_columns; ++column) {
    for (int ring = 0; ring < num_rings; ++ring) {
      auto& at = slope[static_cast<std::size_t>(ring)];
      at = 0.0;
      if (ring + 1 == num_rings) continue;
      const double lower_m = image.range_m[image.Pixel(column, ring)];
      const double higher_m = image.range_m[image.Pixel(column, ring + 1)];
      if (lower_m <= 0.0 || higher_m <= 0.0) continue;
      const double lower_rad = image.elevation_rad[static_cast<std::size_t>(ring)];
      const double higher_rad = image.elevation_rad[static_cast<std::size_t>(ring) + 1];
      at = std::atan2(std::abs(higher_m * std::sin(higher_rad) - lower_m * std::sin(lower_rad)),
                      std::abs(higher_m * std::cos(higher_rad) - lower_m * std::cos(lower_rad)));
    }
    for (int ring = 0; ring < num_rings; ++ring) {
      double sum = 0.0;
      for (int offset = -half_window; offset <= half_window; ++offset) {
        sum += weight(offset) * slope[static_cast<std::size_t>(Mirrored(ring + offset, num_rings))];
      }
      smoothed[image.Pixel(column, ring)] = sum;
    }
  }
  return smoothed;
}

std::vector<bool> FindGround(const DepthImage& image, const DepthGroundParams& params) {
  const auto slope_rad = SlopesOf(image, params);
  std::vector<bool> is_ground(image.range_m.size(), false);
  struct Place {
    int column, ring;
  };
  std::vector<Place> queue;
  for (int column = 0; column < image.num_columns; ++column) {
    int lowest = 0;
    while (lowest < image.num_rings() && image.range_m[image.Pixel(column, lowest)] <= 0.0F) ++lowest;
    if (lowest == image.num_rings()) continue;
    const auto start = image.Pixel(column, lowest);
    if (is_ground[start] || slope_rad[start] > params.max_start_angle_rad) continue;
    is_ground[start] = true;
    queue.assign(1, {column, lowest});
    for (std::size_t next = 0; next < queue.size(); ++next) {
      const auto [at_column, at_ring] = queue[next];
      const double at_rad = slope_rad[image.Pixel(at_column, at_ring)];
      const int previous = image.PreviousColumn(at_column);
      const int following = image.NextColumn(at_column);
      const std::array<std::pair<Place, bool>, 4> neighbours{{{{at_column, at_ring - 1}, at_ring > 0},
                                                              {{at_column, at_ring + 1}, at_ring + 1 < image.num_rings()},
                                                              {{previous, at_ring}, image.joins_next[static_cast<std::size_t>(previous)]},
                                                              {{following, at_ring}, image.joins_next[static_cast<std::size_t>(at_column)]}}};
      for (const auto& [place, is_there] : neighbours) {
        if (!is_there) continue;
        const auto pixel = image.Pixel(place.column, place.ring);
        if (is_ground[pixel] || image.range_m[pixel] <= 0.0F || std::abs(slope_rad[pixel] - at_rad) >= params.max_step_angle_rad) continue;
        is_ground[pixel] = true;
        queue.push_back(place);
      }
    }
  }
  return is_ground;
}

}  // namespace lookout::eval
