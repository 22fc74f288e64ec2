#include "services/segmenter/core/paper/range_image.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"

namespace lookout::segmenter {

namespace {

BeamStep StepOf(double angle_rad) {
  const auto [sine, cosine] = SinCosOf(angle_rad);
  return {sine, cosine, true};
}

// Angles between rings that look at the same column, where their azimuths differ by `azimuth_rad`.
BeamStep StepBetween(const Ring& lower, const Ring& higher, double azimuth_rad) {
  // Haversines: exact for small angles.
  const double sin_half_elevation = Sin((double{higher.elevation_rad} - lower.elevation_rad) / 2.0);
  const double sin_half_azimuth = Sin(azimuth_rad / 2.0);
  const double haversine = sin_half_elevation * sin_half_elevation +
                           Cos(double{higher.elevation_rad}) * Cos(double{lower.elevation_rad}) * sin_half_azimuth * sin_half_azimuth;
  return StepOf(2.0 * Asin(std::sqrt(std::min(1.0, haversine))));
}

std::vector<BeamStep> RingSteps(const std::vector<Ring>& rings, bool offsets_count) {
  std::vector<BeamStep> steps(rings.size());
  for (std::size_t ring = 0; ring + 1 < rings.size(); ++ring) {
    const double azimuth_rad = offsets_count ? double{rings[ring + 1].azimuth_offset_rad} - rings[ring].azimuth_offset_rad : 0.0;
    steps[ring] = StepBetween(rings[ring], rings[ring + 1], azimuth_rad);
  }
  return steps;
}

// The usual step is the median over the whole circle, so that it does not depend on where the scan was cut.
std::vector<BeamStep> ColumnSteps(const std::vector<float>& azimuth_rad) {
  std::vector<BeamStep> steps(azimuth_rad.size());
  if (azimuth_rad.size() < 2) return steps;
  std::vector<double> angle_rad(azimuth_rad.size());
  for (std::size_t column = 0; column < azimuth_rad.size(); ++column) {
    const std::size_t next = column + 1 < azimuth_rad.size() ? column + 1 : 0;
    angle_rad[column] = std::abs(WrapToPi(double{azimuth_rad[next]} - azimuth_rad[column]));
  }
  auto sorted_rad = angle_rad;
  const auto middle = sorted_rad.begin() + static_cast<std::ptrdiff_t>(sorted_rad.size() / 2);
  std::nth_element(sorted_rad.begin(), middle, sorted_rad.end());
  const double max_step_rad = kMaxNeighbourStep * *middle;
  for (std::size_t column = 0; column < azimuth_rad.size(); ++column) {
    if (angle_rad[column] <= max_step_rad) steps[column] = StepOf(angle_rad[column]);
  }
  return steps;
}

}  // namespace

RangeImage ProjectToOwnColumns(const Scan& scan, std::span<const Return> returns) {
  RangeImage image;
  image.num_columns = scan.columns.size();
  image.num_rings = scan.head.num_rings();
  image.num_layers = scan.head.num_returns;
  image.return_at.assign(scan.num_cells(), RangeImage::kNone);
  image.place_of.resize(returns.size());
  for (std::size_t i = 0; i < returns.size(); ++i) {
    image.return_at[static_cast<std::size_t>(returns[i].cell)] = static_cast<std::int32_t>(i);
    image.place_of[i] = {returns[i].cell, returns[i].column};
  }
  image.to_next_column = ColumnSteps(scan.columns.azimuth_rad);
  image.to_higher_ring = RingSteps(scan.head.rings, true);
  return image;
}

RangeImage ProjectToAzimuths(const Scan& scan, std::span<const Return> returns, std::span<const std::int32_t> indices, int num_columns) {
  RangeImage image;
  image.num_columns = num_columns;
  image.num_rings = scan.head.num_rings();
  image.return_at.assign(image.Pixel(num_columns, 0), RangeImage::kNone);
  image.place_of.resize(returns.size());
  image.to_next_column.assign(static_cast<std::size_t>(num_columns), StepOf(kTwoPi / num_columns));
  image.to_higher_ring = RingSteps(scan.head.rings, false);
  const double columns_per_rad = num_columns / kTwoPi;
  std::vector<double> azimuth_rad(returns.size());
  for (const std::int32_t index : indices) {
    const auto i = static_cast<std::size_t>(index);
    const Return& one = returns[i];
    azimuth_rad[i] = WrapTo2Pi(double{scan.columns.azimuth_rad[static_cast<std::size_t>(one.column)]} +
                               scan.head.rings[static_cast<std::size_t>(one.ring)].azimuth_offset_rad);
    const int column = std::min(num_columns - 1, static_cast<int>(azimuth_rad[i] * columns_per_rad));
    const std::size_t pixel = image.Pixel(column, one.ring);
    image.place_of[i] = {static_cast<std::int32_t>(pixel), column};
    std::int32_t& at = image.return_at[pixel];
    const auto other = static_cast<std::size_t>(at);
    if (at == RangeImage::kNone || one.range_m < returns[other].range_m ||
        (one.range_m == returns[other].range_m && azimuth_rad[i] < azimuth_rad[other])) {
      at = index;
    }
  }
  return image;
}

}  // namespace lookout::segmenter
