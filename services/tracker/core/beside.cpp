#include "services/tracker/core/beside.hpp"

#include <algorithm>

#include "services/tracker/core/outline.hpp"

namespace lookout::tracker {

namespace {

double ReachOf(const Track& track) { return 0.5 * Eigen::Vector2d(track.rectangle.length_m, track.rectangle.width_m).norm(); }

}  // namespace

bool IsWithin(const Track& one, const Track& other, double gap_m) {
  const double reach_m = ReachOf(one) + ReachOf(other) + gap_m;
  if ((one.rectangle.center_m - other.rectangle.center_m).squaredNorm() > reach_m * reach_m) return false;
  return GapOf(one.outline_m, other.outline_m).distance_m <= gap_m;
}

bool IsWithinAny(const Track& track, std::span<const Eigen::Vector2d> places_m, double gap_m) {
  const double reach_m = ReachOf(track) + gap_m;
  return std::ranges::any_of(places_m, [&](const Eigen::Vector2d& place_m) {
    return (place_m - track.rectangle.center_m).squaredNorm() <= reach_m * reach_m && GapOf(track.outline_m, {&place_m, 1}).distance_m <= gap_m;
  });
}

}  // namespace lookout::tracker
