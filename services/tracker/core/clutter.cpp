#include "services/tracker/core/clutter.hpp"

#include <algorithm>
#include <bit>
#include <numeric>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"

namespace lookout::tracker {

namespace {

constexpr double kMemoryS = 5.0;
// Where nothing was ever seen: one false segment in 10 s and 10 000 m2.
constexpr double kLeastDensity = 1e-6;

}  // namespace

std::size_t ClutterMap::IndexOf(const Eigen::Vector2d& place_vessel_m) {
  const double angle_rad = WrapTo2Pi(Atan2(place_vessel_m.y(), place_vessel_m.x()));
  const auto sector = std::min(static_cast<std::size_t>(angle_rad / (kTwoPi / kSectors)), kSectors - 1);
  const auto ring = static_cast<std::size_t>(std::min(place_vessel_m.norm() / kRingM, kRings - 1.0));
  return ring * kSectors + sector;
}

std::size_t ClutterMap::ClassOf(int num_returns) {
  return std::min<std::size_t>(std::bit_width(static_cast<unsigned>(std::max(num_returns, 1))) - 1, kClasses - 1);
}

void ClutterMap::End(double dt_s) {
  const double gain = std::clamp(dt_s / kMemoryS, 0.0, 1.0);
  for (std::size_t k = 0; k < kClasses; ++k) {
    for (std::size_t i = 0; i < means_[k].size(); ++i) means_[k][i] += gain * (counts_[k][i] - means_[k][i]);
  }
}

double ClutterMap::DensityAt(const Eigen::Vector2d& place_vessel_m, int num_returns) const {
  const std::size_t index = IndexOf(place_vessel_m);
  const std::size_t ring_index = index / kSectors;
  const auto ring = static_cast<double>(ring_index);
  const double area_m2 = kPi * kRingM * kRingM * (2.0 * ring + 1.0) / kSectors;
  double num_false = 0.0;
  for (std::size_t k = std::max<std::size_t>(ClassOf(num_returns), 1) - 1; k < kClasses; ++k) num_false += means_[k][index];
  return kLeastDensity + num_false / area_m2;
}

double ClutterMap::total() const {
  double total = 0.0;
  for (const auto& means : means_) total += std::accumulate(means.begin(), means.end(), 0.0);
  return total;
}

}  // namespace lookout::tracker
