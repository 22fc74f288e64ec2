#include "tools/eval/baselines/depth_clustering.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "services/segmenter/core/paper/range_image.hpp"

namespace lookout::eval {

namespace {

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

  // Takes what is one with the cell. @return whether there is anything at that place
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
