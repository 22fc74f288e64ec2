#include "lab/eval/baselines/depth_clustering.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "services/segmenter/core/paper/range_image.hpp"

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

// A search over the range image. Besides returns, filled gaps can be stepped on: they have a range and no return.
class Search {
 public:
  Search(const segmenter::Scan& scan, std::span<const segmenter::Return> returns, const DepthClusteringParams& params)
      : params_(params), returns_(returns), image_(segmenter::ProjectToOwnColumns(scan, returns)) {
    depth_.num_columns = image_.num_columns;
    for (const auto& ring : scan.head.rings) depth_.elevation_rad.push_back(ring.elevation_rad);
    for (const auto& step : image_.to_next_column) depth_.joins_next.push_back(step.is_neighbour);
    for (const auto& step : image_.to_next_column) column_angle_rad_.push_back(std::atan2(step.sin_angle, step.cos_angle));
    for (const auto& step : image_.to_higher_ring) ring_angle_rad_.push_back(std::atan2(step.sin_angle, step.cos_angle));
    const auto num_layers = static_cast<std::size_t>(image_.num_layers);
    range_m_.assign(image_.return_at.size(), 0.0F);
    depth_.range_m.assign(range_m_.size() / num_layers, 0.0F);
    for (const auto& one : returns) {
      const auto cell = static_cast<std::size_t>(one.cell);
      range_m_[cell] = one.range_m;
      auto& nearest_m = depth_.range_m[cell / num_layers];
      if (nearest_m <= 0.0F || one.range_m < nearest_m) nearest_m = one.range_m;
    }
  }

  void DropGround(const DepthGroundParams& ground) {
    const auto measured_m = depth_.range_m;
    FillGaps(depth_, ground);
    const auto is_ground = FindGround(depth_, ground);
    const auto num_layers = static_cast<std::size_t>(image_.num_layers);
    for (std::size_t pixel = 0; pixel < is_ground.size(); ++pixel) {
      if (measured_m[pixel] <= 0.0F) range_m_[pixel * num_layers] = depth_.range_m[pixel];
      if (!is_ground[pixel]) continue;
      for (std::size_t layer = 0; layer < num_layers; ++layer) {
        auto& range_m = range_m_[pixel * num_layers + layer];
        if (range_m == depth_.range_m[pixel]) range_m = 0.0F;
      }
    }
  }

  segmenter::Groups Components() {
    segmenter::Groups groups;
    groups.of_return.assign(returns_.size(), segmenter::Groups::kNone);
    is_seen_.assign(range_m_.size(), false);
    for (const auto& seed : returns_) {
      const auto cell = static_cast<std::size_t>(seed.cell);
      if (is_seen_[cell] || range_m_[cell] <= 0.0F) continue;
      queue_.clear();
      Take(cell);
      for (std::size_t next = 0; next < queue_.size(); ++next) {
        const auto at = queue_[next];
        if (const auto index = image_.return_at[at]; index != segmenter::RangeImage::kNone) {
          groups.of_return[static_cast<std::size_t>(index)] = groups.count;
        }
        LookAround(at);
      }
      ++groups.count;
    }
    return groups;
  }

 private:
  void Take(std::size_t cell) {
    is_seen_[cell] = true;
    queue_.push_back(cell);
  }

  void LookAround(std::size_t cell) {
    const std::size_t pixel = cell / static_cast<std::size_t>(image_.num_layers);
    const int column = static_cast<int>(pixel / depth_.elevation_rad.size());
    const int ring = static_cast<int>(pixel % depth_.elevation_rad.size());
    for (const bool is_forward : {true, false}) {
      double angle_rad = 0.0;
      int next = column;
      for (int step = 0; step < params_.reach_columns; ++step) {
        const auto earlier = static_cast<std::size_t>(is_forward ? next : depth_.PreviousColumn(next));
        if (!depth_.joins_next[earlier]) break;
        next = is_forward ? depth_.NextColumn(next) : static_cast<int>(earlier);
        angle_rad += column_angle_rad_[earlier];
        if (Meets(cell, next, ring, angle_rad)) break;
      }
    }
    for (const bool is_upward : {true, false}) {
      double angle_rad = 0.0;
      for (int step = 1; step <= params_.reach_rings; ++step) {
        const int other = is_upward ? ring + step : ring - step;
        if (other < 0 || other >= depth_.num_rings()) break;
        angle_rad += ring_angle_rad_[static_cast<std::size_t>(is_upward ? other - 1 : other)];
        if (Meets(cell, column, other, angle_rad)) break;
      }
    }
  }

  // Takes cells that are one with this cell. @return whether there is anything at that place
  bool Meets(std::size_t cell, int column, int ring, double angle_rad) {
    const auto first = image_.Pixel(column, ring);
    bool is_anything = false;
    for (std::size_t other = first; other < first + static_cast<std::size_t>(image_.num_layers); ++other) {
      if (range_m_[other] <= 0.0F) continue;
      is_anything = true;
      if (!is_seen_[other] && IsOne(range_m_[cell], range_m_[other], angle_rad)) Take(other);
    }
    return is_anything;
  }

  bool IsOne(double one_m, double other_m, double angle_rad) const {
    const double far_m = std::max(one_m, other_m);
    const double near_m = std::min(one_m, other_m);
    return std::atan2(near_m * std::sin(angle_rad), far_m - near_m * std::cos(angle_rad)) > params_.angle_rad;
  }

  const DepthClusteringParams& params_;
  std::span<const segmenter::Return> returns_;
  segmenter::RangeImage image_;
  DepthImage depth_;            // the nearest return of each pixel
  std::vector<float> range_m_;  // [cells] 0 = empty, or ground
  std::vector<double> column_angle_rad_;
  std::vector<double> ring_angle_rad_;
  std::vector<bool> is_seen_;  // [cells]
  std::vector<std::size_t> queue_;
};

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

Grouping DepthGrouping(const DepthClusteringParams& params) {
  return [params](const segmenter::Scan& scan, std::span<const segmenter::Return> returns, StageClock& clock) {
    Search search(scan, returns, params);
    clock.End("image");
    if (params.ground) {
      search.DropGround(*params.ground);
      clock.End("ground");
    }
    auto groups = search.Components();
    clock.End("clusters");
    return groups;
  };
}

}  // namespace lookout::eval
