#include "services/plotter/core/lidar_sight.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/cover_watch.hpp"
#include "common/core/elementary.hpp"
#include "common/core/frames.hpp"

namespace lookout::plotter {

namespace {

// Whole degrees from the bow clockwise; y is to port.
std::uint16_t BearingDegOf(const Eigen::Vector2d& direction, double turned_rad = 0.0) {
  const auto bearing_deg = static_cast<std::size_t>(RadToDeg(WrapTo2Pi(Atan2(-direction.y(), direction.x()) - turned_rad)));
  return static_cast<std::uint16_t>(bearing_deg % LidarSight::kNumBearings);
}

}  // namespace

LidarSight::LidarSight(const LidarSightParams& params, std::span<const float> elevation_rad)
    : params_(params), elevation_rad_(elevation_rad.begin(), elevation_rad.end()) {
  for (std::size_t degree = 0; degree < kNumBearings; ++degree) {
    for (std::size_t ring = 0; ring < elevation_rad_.size(); ++ring) {
      if (GetsFar(DirectionOf(DegToRad(static_cast<double>(degree) + 0.5), ring))) rings_[degree].push_back(static_cast<std::uint16_t>(ring));
    }
  }
}

bool LidarSight::IsFor(std::span<const float> elevation_rad) const { return std::ranges::equal(elevation_rad_, elevation_rad); }

Eigen::Vector3d LidarSight::DirectionOf(double azimuth_rad, std::size_t ring) const {
  return params_.T_vessel_lidar.linear() * BeamDirection(azimuth_rad, static_cast<double>(elevation_rad_[ring]));
}

bool LidarSight::GetsFar(const Eigen::Vector3d& direction_vessel) const {
  const double run = Hypot(direction_vessel.x(), direction_vessel.y());
  if (run <= 0.0) return false;
  const double slope = direction_vessel.z() / run;
  return params_.above_water_m + slope * params_.reach_m <= kTopM && params_.above_water_m + slope * params_.reach_m >= 0.0;
}

void LidarSight::Add(const Column& column) {
  if (column.range_m.size() != elevation_rad_.size() || column.azimuth_offset_rad.size() != elevation_rad_.size()) return;
  const auto degree = static_cast<std::size_t>(RadToDeg(WrapTo2Pi(column.azimuth_rad))) % kNumBearings;
  bool is_there = false;
  bool is_looking = false;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  for (const auto ring : rings_[degree]) {
    const double azimuth_rad = WrapTo2Pi(column.azimuth_rad + static_cast<double>(column.azimuth_offset_rad[ring]));
    if (!params_.field_of_view.Contains(azimuth_rad)) continue;
    direction = DirectionOf(azimuth_rad, ring);
    is_there = true;
    const auto range_m = static_cast<double>(column.range_m[ring]);
    const bool is_own =
        range_m > 0.0 &&
        (range_m < params_.min_range_m || range_m <= CoverWatch::kAtLidarM ||
         (!params_.own_vessel_box_m.isEmpty() && params_.own_vessel_box_m.contains(params_.T_vessel_lidar.translation() + range_m * direction)));
    if (is_own) continue;
    is_looking = true;
    break;
  }
  if (!is_there) return;
  // A coarse scan has fewer columns than degrees: each stands for half of the way to its neighbours.
  const std::array bearings{BearingDegOf(direction.head<2>(), column.turned_rad - column.step_rad / 2.0),
                            BearingDegOf(direction.head<2>(), column.turned_rad),
                            BearingDegOf(direction.head<2>(), column.turned_rad + column.step_rad / 2.0)};
  for (std::size_t i = 0; i < bearings.size(); ++i) {
    if (i > 0 && bearings[i] == bearings[i - 1]) continue;
    ++num_columns_[bearings[i]];
    if (is_looking) ++num_looking_[bearings[i]];
  }
}

SectorSight::SectorSight(std::span<const Eigen::Vector2d> lidar_place_m, const Eigen::AlignedBox3d& own_vessel_box_m, double reach_m) {
  constexpr int kNumRanges = 40;
  constexpr std::array kWithinDeg{-2.5, -2.0, -1.0, 0.0, 1.0, 2.0, 2.49};
  const Eigen::AlignedBox2d own_box_m(Eigen::Vector2d(own_vessel_box_m.min().head<2>()), Eigen::Vector2d(own_vessel_box_m.max().head<2>()));
  for (std::size_t sector = 0; sector < kNumSectors; ++sector) {
    auto& places = places_[sector];
    for (const double within_deg : kWithinDeg) {
      const auto bearing = SinCosOfDegrees(static_cast<double>(sector) * kSectorDeg + within_deg);
      for (int i = 1; i <= kNumRanges; ++i) {
        // Closer near the boat, where the bearing from the lidar is another.
        const double share = static_cast<double>(i) / kNumRanges;
        const Eigen::Vector2d place_m = reach_m * share * share * Eigen::Vector2d(bearing.cos, -bearing.sin);
        if (!own_vessel_box_m.isEmpty() && own_box_m.contains(place_m)) continue;
        Bearings bearings{};
        for (std::size_t k = 0; k < std::min(lidar_place_m.size(), kMostLidars); ++k) bearings[k] = BearingDegOf(place_m - lidar_place_m[k]);
        if (std::ranges::find(places, bearings) == places.end()) places.push_back(bearings);
      }
    }
  }
}

std::array<bool, kNumSectors> SectorSight::Looked(std::span<const LidarSight* const> lidars) const {
  std::array<bool, kNumSectors> looked{};
  const auto num_lidars = std::min(lidars.size(), kMostLidars);
  for (std::size_t sector = 0; sector < kNumSectors; ++sector) {
    looked[sector] = !places_[sector].empty() && std::ranges::all_of(places_[sector], [&](const Bearings& bearings) {
      for (std::size_t k = 0; k < num_lidars; ++k) {
        if (lidars[k] != nullptr && lidars[k]->Looks(bearings[k])) return true;
      }
      return false;
    });
  }
  return looked;
}

}  // namespace lookout::plotter
