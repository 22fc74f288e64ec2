#include "services/tracker/core/watched_water.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"

namespace lookout::tracker {

namespace {

constexpr double kBesidePlaceM = 1.0;    // of the place: a return nearer than this may be the thing
constexpr double kOverWaterM = 0.1;      // lower beams may meet the water
constexpr double kLostPacketRad = 0.01;  // to the next column
constexpr double kCentimetres = 100.0;
constexpr double kMostCm = 65535.0;

// Things come up too, if rarely: one in 150.
constexpr double kMostCameUp = 5.0;

}  // namespace

double CameUpLogOdds(const Watched& watched, double seen_share) { return std::min(kMostCameUp, -watched.num_empty * Log(1.0 - seen_share)); }

void WatchedWater::Add(const Sight& sight, Utime time) {
  while (!scans_.empty() && ToSeconds(time - scans_.front().time) > kKeptS) scans_.pop_front();
  if (scans_.size() >= kMostScans) scans_.pop_front();
  const auto* sweep = sight.sweep();
  if (sweep == nullptr) return;
  Scan scan{.time = time, .start = sight.start(), .end = sight.end(), .max_range_m = sight.max_range_m(), .ring = sight.ring(), .unwrapped_rad = {}};
  scan.unwrapped_rad.assign(sight.unwrapped_rad().begin(), sight.unwrapped_rad().end());
  scan.range_cm.resize(sweep->range_m.size());
  std::ranges::transform(sweep->range_m, scan.range_cm.begin(),
                         [](float range_m) { return static_cast<std::uint16_t>(std::clamp(kCentimetres * range_m + 0.5, 0.0, kMostCm)); });
  scans_.push_back(std::move(scan));
}

WatchedWater::Look WatchedWater::LookAt(const Scan& scan, const Eigen::Vector2d& place_m, double top_m) {
  const int num_columns = static_cast<int>(scan.unwrapped_rad.size());
  const auto column_at = [&scan](double azimuth_rad) {
    const double first_rad = scan.unwrapped_rad.front();
    const auto found = std::ranges::lower_bound(scan.unwrapped_rad, static_cast<float>(first_rad + WrapTo2Pi(azimuth_rad - first_rad)));
    return static_cast<int>(found - scan.unwrapped_rad.begin());
  };
  const auto pose_at = [&](int column) {
    const double share = static_cast<double>(column) / std::max(1, num_columns - 1);
    Eigen::Isometry3d pose;
    pose.matrix() = scan.start.matrix() + share * (scan.end.matrix() - scan.start.matrix());
    return pose;
  };
  const auto azimuth_of = [&place_m](const Eigen::Isometry3d& pose) {
    const Eigen::Vector3d offset(place_m.x() - pose.translation().x(), place_m.y() - pose.translation().y(), -pose.translation().z());
    const Eigen::Vector3d place = pose.linear().transpose() * offset;
    return Atan2(-place.y(), place.x());
  };
  // The boat turns while the head goes round: first by the pose of the middle, then by that of the column which it gives.
  int column = std::min(column_at(azimuth_of(pose_at(num_columns / 2))), num_columns - 1);
  const Eigen::Isometry3d pose = pose_at(column);
  const double azimuth_rad = azimuth_of(pose);
  column = std::min(column_at(azimuth_rad), num_columns - 1);
  if (std::fabs(WrapToPi(azimuth_rad - scan.unwrapped_rad[static_cast<std::size_t>(column)])) > kLostPacketRad) return Look::kNone;
  const double distance_m = (place_m - pose.translation().head<2>()).norm();
  if (distance_m > scan.max_range_m || distance_m <= kBesidePlaceM) return Look::kNone;

  const auto [sine, cosine] = SinCosOf(azimuth_rad);
  const std::size_t num_rings = scan.ring.size();
  const auto column_ranges = [&](int of_column) {
    return std::span(scan.range_cm).subspan(static_cast<std::size_t>(of_column) * num_rings, num_rings);
  };
  bool is_looked = false;
  std::vector<std::uint16_t> from_cm(num_rings);
  std::vector<std::uint16_t> width_cm(num_rings);
  for (std::size_t ring = 0; ring < num_rings; ++ring) {
    const auto& elevation = scan.ring[ring];
    const Eigen::Vector3d direction = pose.linear() * Eigen::Vector3d(elevation.x() * cosine, -elevation.x() * sine, elevation.y());
    const double flat = Hypot(direction.x(), direction.y());
    const double z = pose.translation().z() + distance_m * direction.z() / flat;
    const double range_m = flat / kCentimetres * column_ranges(column)[ring];
    if (z > kOverWaterM && z < top_m && (range_m == 0.0 || range_m >= distance_m - kBesidePlaceM)) is_looked = true;
    from_cm[ring] = static_cast<std::uint16_t>(std::clamp(kCentimetres * (distance_m - kBesidePlaceM) / flat, 1.0, kMostCm));
    width_cm[ring] = static_cast<std::uint16_t>(std::min(kCentimetres * (distance_m + kBesidePlaceM) / flat, kMostCm) - from_cm[ring]);
  }
  const int beside = static_cast<int>(kBesidePlaceM / distance_m / kTwoPi * num_columns);
  for (int i = -beside; i <= beside; ++i) {
    const auto ranges_cm = column_ranges((column + i + num_columns) % num_columns);
    bool is_met = false;
    for (std::size_t ring = 0; ring < num_rings; ++ring) is_met |= static_cast<std::uint16_t>(ranges_cm[ring] - from_cm[ring]) <= width_cm[ring];
    if (is_met) return Look::kMet;
  }
  return is_looked ? Look::kEmpty : Look::kNone;
}

Watched WatchedWater::At(const Eigen::Vector2d& place_m, double top_m, Utime before) const {
  Watched watched;
  for (const auto& scan : scans_) {
    const double before_s = ToSeconds(before - scan.time);
    if (before_s <= 0.0 || before_s > kWatchedS) continue;
    const auto look = LookAt(scan, place_m, top_m);
    if (look != Look::kNone) ++watched.num_looks;
    if (look == Look::kEmpty) ++watched.num_empty;
  }
  return watched;
}

}  // namespace lookout::tracker
