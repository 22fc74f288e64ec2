#include "services/segmenter/core/lookout/turn_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/core/angles.hpp"

namespace lookout::segmenter {

void TurnGrid::Fill(const Scan& scan, std::span<const Return> returns, const Eigen::Matrix3d& R_vessel_lidar) {
  num_columns_ = scan.columns.size();
  num_layers_ = scan.head.num_returns;
  num_lines_ = scan.head.num_rings() * num_layers_;
  MeasureColumnStep(scan.columns.azimuth_rad);
  returns_ = returns;
  return_at_.assign(static_cast<std::size_t>(num_lines_) * static_cast<std::size_t>(num_columns_), kNone);
  range_at_.assign(return_at_.size(), std::numeric_limits<float>::infinity());
  points_.resize(returns.size());
  const Eigen::Matrix3f R = R_vessel_lidar.cast<float>();
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const Return& one = returns[i];
    const Eigen::Vector3f p = R * Eigen::Vector3f(one.point.x_m, one.point.y_m, one.point.z_m);
    points_[i] = {p.x(), p.y(), p.z(), std::sqrt(p.x() * p.x() + p.y() * p.y())};
    const int line = one.ring * num_layers_ + one.cell % num_layers_;
    const std::size_t cell = static_cast<std::size_t>(line) * static_cast<std::size_t>(num_columns_) + static_cast<std::size_t>(one.column);
    return_at_[cell] = static_cast<std::int32_t>(i);
    range_at_[cell] = points_[i].range_m;
  }
}

void TurnGrid::MeasureColumnStep(std::span<const float> azimuth_rad) {
  steps_rad_.clear();
  for (std::size_t column = 0; column < azimuth_rad.size(); ++column) {
    const std::size_t next = column + 1 < azimuth_rad.size() ? column + 1 : 0;
    steps_rad_.push_back(std::abs(static_cast<float>(WrapToPi(double{azimuth_rad[next]} - azimuth_rad[column]))));
  }
  column_step_rad_ = 0.0;
  if (steps_rad_.empty()) return;
  const auto middle = steps_rad_.begin() + static_cast<std::ptrdiff_t>(steps_rad_.size() / 2);
  std::nth_element(steps_rad_.begin(), middle, steps_rad_.end());
  column_step_rad_ = *middle;
}

bool TurnGrid::IsAnyNear(int line, int column, int window, float range_m, float reach_m) const {
  bool is_any_near = false;
  if (column < window || column + window >= num_columns_) {
    const int count = std::min(2 * window + 1, num_columns_);
    for (int step = 0; step < count; ++step)
      is_any_near = is_any_near || std::abs(RangeAt(line, Wrap(Wrap(column - window + step))) - range_m) <= reach_m;
    return is_any_near;
  }
  const float* range =
      range_at_.data() + static_cast<std::size_t>(line) * static_cast<std::size_t>(num_columns_) + static_cast<std::size_t>(column - window);
  for (int step = 0; step <= 2 * window; ++step) is_any_near |= std::abs(range[step] - range_m) <= reach_m;
  return is_any_near;
}

int TurnGrid::ColumnsOf(double length_m, double range_m) const {
  const int half = num_columns_ / 2;
  if (range_m <= length_m || column_step_rad_ <= 0.0) return half;
  return std::min(half, static_cast<int>(std::ceil(std::asin(length_m / range_m) / column_step_rad_)));
}

}  // namespace lookout::segmenter
