#include "services/segmenter/core/lookout/scan_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"

namespace lookout::segmenter {

namespace {

// The step from the last column to the first of a whole scan: as from column to column, but for the unevenness of a turning head.
constexpr double kMaxSeamSteps = 1.5;
// Empty columns at least where it is not.
constexpr int kLeastMissing = 8;
// Columns, with those that stand for the rest of the circle: as many as a scan can have. A narrow part with fine columns would be millions of empty
// ones.
constexpr int kMostCells = 1 << 21;

}  // namespace

void ScanGrid::Fill(const Scan& scan, std::span<const Return> returns, const Eigen::Matrix3d& R_vessel_lidar) {
  num_layers_ = scan.head.num_returns;
  num_lines_ = scan.head.num_rings() * num_layers_;
  MeasureColumns(scan);
  MeasureRings(scan);
  return_at_.assign(static_cast<std::size_t>(num_lines_) * static_cast<std::size_t>(num_columns_), kNone);
  range_at_.assign(return_at_.size(), std::numeric_limits<float>::infinity());
  words_per_line_ = static_cast<std::size_t>((num_columns_ + kWordBits - 1) / kWordBits);
  occupied_.assign(static_cast<std::size_t>(num_lines_) * words_per_line_, 0);
  points_.resize(returns.size());
  column_of_.resize(returns.size());
  line_of_.resize(returns.size());
  const Eigen::Matrix3f R = R_vessel_lidar.cast<float>();
  // Known to be no part of what is written.
  const auto num_columns = static_cast<std::size_t>(num_columns_);
  const std::size_t words_per_line = words_per_line_;
  const int num_layers = num_layers_;
  const bool is_shifted = is_shifted_;
  std::int32_t* const return_at = return_at_.data();
  float* const range_at = range_at_.data();
  std::uint64_t* const occupied = occupied_.data();
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const Return& one = returns[i];
    const Eigen::Vector3f p = R * Eigen::Vector3f(one.point.x_m, one.point.y_m, one.point.z_m);
    const float range_m = std::sqrt(p.x() * p.x() + p.y() * p.y());
    const int column = is_shifted ? Wrap(one.column + shift_of_[static_cast<std::size_t>(one.ring)]) : one.column;
    const int line = num_layers == 1 ? one.ring : one.ring * num_layers + one.cell % num_layers;
    points_[i] = {p.x(), p.y(), p.z(), range_m};
    column_of_[i] = column;
    line_of_[i] = line;
    const auto at_line = static_cast<std::size_t>(line);
    const auto at_column = static_cast<std::size_t>(column);
    const std::size_t cell = at_line * num_columns + at_column;
    return_at[cell] = static_cast<std::int32_t>(i);
    range_at[cell] = range_m;
    occupied[at_line * words_per_line + at_column / kWordBits] |= std::uint64_t{1} << (at_column % kWordBits);
  }
  SortByColumn();
}

void ScanGrid::MeasureColumns(const Scan& scan) {
  const auto& azimuth_rad = scan.columns.azimuth_rad;
  const int num_scanned = scan.columns.size();
  steps_rad_.clear();
  for (std::size_t column = 0; column < azimuth_rad.size(); ++column) {
    const std::size_t next = column + 1 < azimuth_rad.size() ? column + 1 : 0;
    steps_rad_.push_back(std::abs(static_cast<float>(WrapToPi(double{azimuth_rad[next]} - azimuth_rad[column]))));
  }
  const float seam_rad = steps_rad_.empty() ? 0.0F : steps_rad_.back();
  column_step_rad_ = 0.0;
  if (!steps_rad_.empty()) {
    const auto middle = steps_rad_.begin() + static_cast<std::ptrdiff_t>(steps_rad_.size() / 2);
    std::nth_element(steps_rad_.begin(), middle, steps_rad_.end());
    column_step_rad_ = *middle;
  }
  constexpr double kMostStepRad = kTwoPi / kMinColumns;
  constexpr double kLeastStepRad = kTwoPi / 65536.0;  // columns that a scan may have
  const double step_rad = std::clamp(column_step_rad_, kLeastStepRad, kMostStepRad);
  const bool is_whole = num_scanned >= kMinColumns && seam_rad <= kMaxSeamSteps * column_step_rad_;
  // The missing part counts as columns too; between two of them there is at least one when the scan is not whole.
  const int round_the_circle = std::min(static_cast<int>(std::lround(kTwoPi / step_rad)), kMostCells / std::max(1, num_lines_));
  num_columns_ = is_whole ? num_scanned : std::max({kMinColumns, num_scanned + kLeastMissing, round_the_circle});

  is_shifted_ = false;
  shift_of_.clear();
  for (const auto& ring : scan.head.rings) {
    const auto shift = static_cast<std::int32_t>(std::lround(WrapToPi(double{ring.azimuth_offset_rad}) / step_rad));
    is_shifted_ = is_shifted_ || std::abs(double{ring.azimuth_offset_rad}) > step_rad;
    shift_of_.push_back(std::clamp(shift, -num_columns_ + 1, num_columns_ - 1));
  }
}

void ScanGrid::MeasureRings(const Scan& scan) {
  const auto& rings = scan.head.rings;
  const std::size_t num = rings.size();
  elevation_rad_.resize(num);
  ring_step_rad_.resize(num);
  weight_of_ring_.resize(num);
  for (std::size_t ring = 0; ring < num; ++ring) elevation_rad_[ring] = double{rings[ring].elevation_rad};
  for (std::size_t ring = 0; ring < num; ++ring) {
    const std::size_t below = ring == 0 ? ring : ring - 1;
    const std::size_t above = ring + 1 == num ? ring : ring + 1;
    const double step_rad =
        below == above ? kLoneRingStepRad : std::abs(elevation_rad_[above] - elevation_rad_[below]) / static_cast<double>(above - below);
    ring_step_rad_[ring] = step_rad;
    weight_of_ring_[ring] = static_cast<std::int32_t>(std::lround(step_rad * 1e6));
  }
}

double ScanGrid::RingStepAt(double elevation_rad) const {
  const auto above = std::ranges::lower_bound(elevation_rad_, elevation_rad);
  auto ring = static_cast<std::size_t>(above - elevation_rad_.begin());
  if (ring == elevation_rad_.size() || (ring > 0 && elevation_rad - elevation_rad_[ring - 1] < elevation_rad_[ring] - elevation_rad)) --ring;
  return ring_step_rad_[ring];
}

void ScanGrid::SortByColumn() {
  by_column_.resize(column_of_.size());
  if (!is_shifted_) {
    std::iota(by_column_.begin(), by_column_.end(), 0);
    return;
  }
  next_in_column_.assign(static_cast<std::size_t>(num_columns_) + 1, 0);
  for (const std::int32_t column : column_of_) ++next_in_column_[static_cast<std::size_t>(column) + 1];
  for (std::size_t column = 1; column < next_in_column_.size(); ++column) next_in_column_[column] += next_in_column_[column - 1];
  for (std::size_t i = 0; i < column_of_.size(); ++i) {
    by_column_[static_cast<std::size_t>(next_in_column_[static_cast<std::size_t>(column_of_[i])]++)] = static_cast<std::int32_t>(i);
  }
}

int ScanGrid::ColumnsOf(double length_m, double range_m) const {
  const int half = num_columns_ / 2;
  if (range_m <= length_m || column_step_rad_ <= 0.0) return half;
  // Columns of a strange lidar may be so fine that their number is none of an int.
  return static_cast<int>(std::min(static_cast<double>(half), std::ceil(Asin(length_m / range_m) / column_step_rad_)));
}

}  // namespace lookout::segmenter
