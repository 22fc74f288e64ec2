#include "lab/learned/views.hpp"

#include <algorithm>
#include <cstddef>
#include <stdexcept>

#include "common/core/angles.hpp"

namespace lookout::learned {

Views ProjectToViews(const segmenter::Scan& scan, std::span<const segmenter::Return> returns) {
  constexpr int kAllColumns = kNumViews * kViewColumns;
  constexpr double kHalfViewRad = kTwoPi / kNumViews / 2.0;
  Views views;
  views.num_rows = scan.head.num_rings();
  views.pixel_of_return.reserve(returns.size());
  views.return_of_pixel.assign(static_cast<std::size_t>(kNumViews) * static_cast<std::size_t>(views.PixelsOfView()), Views::kEmpty);
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const auto& one = returns[i];
    const double azimuth_rad = double{scan.columns.azimuth_rad[static_cast<std::size_t>(one.column)]} +
                               double{scan.head.rings[static_cast<std::size_t>(one.ring)].azimuth_offset_rad};
    const double share = WrapTo2Pi(azimuth_rad + kHalfViewRad) / kTwoPi;
    const int column = std::min(kAllColumns - 1, static_cast<int>(share * kAllColumns));
    const std::int32_t pixel = (column / kViewColumns * views.num_rows + one.ring) * kViewColumns + column % kViewColumns;
    views.pixel_of_return.push_back(pixel);
    auto& nearest = views.return_of_pixel[static_cast<std::size_t>(pixel)];
    if (nearest == Views::kEmpty || one.range_m < returns[static_cast<std::size_t>(nearest)].range_m) nearest = static_cast<std::int32_t>(i);
  }
  return views;
}

std::array<float, kNumChannels> ChannelsOf(const segmenter::Scan& scan, const segmenter::Return& one, int view) {
  constexpr float kMaxReflectivity = 255.0F;
  const auto& p = one.point;
  const float intensity = static_cast<float>(scan.columns.reflectivity[static_cast<std::size_t>(one.cell)]) / kMaxReflectivity;
  switch (view) {
    case 0:
      return {p.x_m, p.y_m, p.z_m, intensity, one.range_m};
    case 1:
      return {-p.y_m, p.x_m, p.z_m, intensity, one.range_m};
    case 2:
      return {-p.x_m, -p.y_m, p.z_m, intensity, one.range_m};
    case 3:
      return {p.y_m, -p.x_m, p.z_m, intensity, one.range_m};
    default:
      throw std::logic_error("there are four views");
  }
}

}  // namespace lookout::learned
