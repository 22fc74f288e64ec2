#include "services/segmenter/core/returns.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "common/core/elementary.hpp"
#include "common/core/own_vessel.hpp"

namespace lookout::segmenter {

namespace {

// In range units. 0.1 m is 50 units of 2 mm, whichever way the division rounds.
int MaxRepeatGap(double max_repeat_gap_m, double range_unit_m) {
  constexpr double kRounding = 1e-6;
  constexpr double kMaxGap = std::numeric_limits<std::uint16_t>::max();
  return static_cast<int>(std::min(kMaxGap, max_repeat_gap_m / range_unit_m + kRounding));
}

}  // namespace

const ClassifiedReturns& ReturnClassifier::Classify(const Scan& scan) {
  rings_.clear();
  for (const auto& ring : scan.head.rings) {
    const auto [sin_elevation, cos_elevation] = SinCosOf(double{ring.elevation_rad});
    const auto [sin_offset, cos_offset] = SinCosOf(double{ring.azimuth_offset_rad});
    rings_.push_back({cos_elevation * cos_offset, cos_elevation * sin_offset, sin_elevation, ring.azimuth_offset_rad, ring.origin_height_m});
  }
  const auto num_returns = static_cast<std::size_t>(scan.head.num_returns);
  const std::size_t cells_per_column = rings_.size() * num_returns;
  const bool sees_all_round = filter_.field_of_view.width_rad >= kTwoPi;
  const OwnVessel own_vessel(filter_.own_vessel_box_m, filter_.T_vessel_lidar);

  occupied_.resize(cells_per_column + 1);
  result_.label.assign(scan.num_cells(), 0);
  result_.repeats.clear();
  const auto is_return = [](std::uint16_t range) { return range != 0; };
  // As many as there may be; in the end those that are looked at. Only memory that earlier scans did not need is allocated.
  result_.returns.resize(static_cast<std::size_t>(std::ranges::count_if(scan.columns.range, is_return)));
  Return* next_return = result_.returns.data();
  const double range_unit_m = scan.head.range_unit_m;
  for (std::size_t column = 0; column < scan.columns.azimuth_rad.size(); ++column) {
    const std::size_t first_cell = column * cells_per_column;
    const std::uint16_t* range = scan.columns.range.data() + first_cell;
    // Which cells hold a return is noise to a processor that guesses branches: first they are listed without one.
    std::size_t num_occupied = 0;
    for (std::size_t offset = 0; offset < cells_per_column; ++offset) {
      occupied_[num_occupied] = static_cast<std::uint32_t>(offset);
      num_occupied += is_return(range[offset]) ? 1 : 0;
    }
    if (num_occupied == 0) continue;
    const double azimuth_rad = scan.columns.azimuth_rad[column];
    const auto [sin_azimuth, cos_azimuth] = SinCosOf(azimuth_rad);
    for (std::size_t i = 0; i < num_occupied; ++i) {
      const std::size_t offset = occupied_[i];
      const std::size_t ring = num_returns == 1 ? offset : offset / num_returns;
      const RingGeometry& geometry = rings_[ring];
      const std::size_t cell = first_cell + offset;
      const double range_m = range[offset] * range_unit_m;
      if (range_m < filter_.min_range_m || range_m > filter_.max_range_m) {
        result_.label[cell] = ToLabel(Reason::kRange);
        continue;
      }
      if (!sees_all_round && !filter_.field_of_view.Contains(azimuth_rad + geometry.azimuth_offset_rad)) {
        result_.label[cell] = ToLabel(Reason::kFieldOfView);
        continue;
      }
      const double cos_elevation_cos = geometry.cos_elevation_cos_offset * cos_azimuth - geometry.cos_elevation_sin_offset * sin_azimuth;
      const double cos_elevation_sin = geometry.cos_elevation_cos_offset * sin_azimuth + geometry.cos_elevation_sin_offset * cos_azimuth;
      const Point point{static_cast<float>(range_m * cos_elevation_cos), static_cast<float>(-range_m * cos_elevation_sin),
                        static_cast<float>(range_m * geometry.sin_elevation + geometry.origin_height_m)};
      if (own_vessel.Contains(Eigen::Vector3d(point.x_m, point.y_m, point.z_m))) {
        result_.label[cell] = ToLabel(Reason::kOwnVessel);
        continue;
      }
      *next_return++ = {point, static_cast<float>(range_m), static_cast<std::int32_t>(cell), static_cast<std::int32_t>(column),
                        static_cast<std::int32_t>(ring)};
    }
  }
  result_.returns.resize(static_cast<std::size_t>(next_return - result_.returns.data()));
  if (num_returns >= 2) SetRepeatsApart(scan);
  return result_;
}

void ReturnClassifier::SetRepeatsApart(const Scan& scan) {
  const int max_gap = MaxRepeatGap(filter_.max_repeat_gap_m, scan.head.range_unit_m);
  auto& returns = result_.returns;
  const auto range_of = [&scan](const Return& one) { return int{scan.columns.range[static_cast<std::size_t>(one.cell)]}; };
  const auto shot_of = [&scan](const Return& one) { return one.cell / scan.head.num_returns; };
  std::size_t num_kept = 0;
  for (const Return& one : returns) {
    std::size_t twin = num_kept;  // behind it
    while (twin > 0 && shot_of(returns[twin - 1]) == shot_of(one) && std::abs(range_of(returns[twin - 1]) - range_of(one)) > max_gap) --twin;
    if (twin > 0 && shot_of(returns[twin - 1]) == shot_of(one)) {
      result_.repeats.push_back({one.cell, static_cast<std::int32_t>(twin - 1)});
    } else {
      returns[num_kept++] = one;
    }
  }
  returns.resize(num_kept);
}

ClassifiedReturns ClassifyReturns(const Scan& scan, const ReturnFilter& filter) { return ReturnClassifier(filter).Classify(scan); }

}  // namespace lookout::segmenter
