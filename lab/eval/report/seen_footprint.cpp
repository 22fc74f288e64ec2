#include "lab/eval/report/seen_footprint.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "common/core/angles.hpp"
#include "common/core/frames.hpp"
#include "common/core/outlines.hpp"

namespace lookout::eval {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;

// Truth has a pose each 20 ms: five of them.
constexpr std::int64_t kMaxBracketUs = 100'000;
// Scans of one object are neighbours up to here: at 300 rpm one takes 0.2 s.
constexpr std::int64_t kMaxScanUs = 250'000;
// So many objects tell a shift of all from the noise of one.
constexpr std::size_t kMinObjects = 3;
// A kayak on a wave shows five returns, the paddler's head, and in the next scan sixty, with the hull below: their centres are of different outlines.
constexpr int kMostTimesReturns = 2;

bool IsSeenAlike(const SeenObstacle& before, const SeenObstacle& after) {
  return std::max(before.num_points, after.num_points) <= kMostTimesReturns * std::min(before.num_points, after.num_points);
}

}  // namespace

TruePoses::TruePoses(const Truth& truth, const GeographicLib::LocalCartesian& map) {
  for (const auto& [utime_us, pose] : truth.poses()) {
    Eigen::Vector3d p_map_m;
    map.Forward(pose.latitude_deg, pose.longitude_deg, map.HeightOrigin(), p_map_m.x(), p_map_m.y(), p_map_m.z());
    samples_.push_back({utime_us, p_map_m.head<2>(), DegToRad(pose.heading_deg), DegToRad(pose.roll_deg), DegToRad(pose.pitch_deg)});
  }
}

std::optional<Isometry3d> TruePoses::At(std::int64_t utime_us) const {
  const auto after = std::ranges::lower_bound(samples_, utime_us, {}, &Sample::utime_us);
  if (after == samples_.end() || (after == samples_.begin() && after->utime_us != utime_us)) return std::nullopt;
  const auto before = after->utime_us == utime_us ? after : std::prev(after);
  if (after->utime_us - before->utime_us > kMaxBracketUs) return std::nullopt;
  const double share =
      before == after ? 0.0 : static_cast<double>(utime_us - before->utime_us) / static_cast<double>(after->utime_us - before->utime_us);
  const auto between = [share](double from, double to) { return from + share * (to - from); };
  Isometry3d T_map_vessel = Isometry3d::Identity();
  T_map_vessel.linear() = RotationMapVessel(before->heading_rad + share * WrapToPi(after->heading_rad - before->heading_rad),
                                            between(before->pitch_rad, after->pitch_rad), between(before->roll_rad, after->roll_rad));
  T_map_vessel.translation().head<2>() = before->position_m + share * (after->position_m - before->position_m);
  return T_map_vessel;
}

std::optional<Vector2d> TrueCenter(std::span<const SeenReturn> returns, const Isometry3d& T_vessel_lidar, const TruePoses& poses) {
  if (returns.empty()) return std::nullopt;
  std::vector<Vector2d> points;
  points.reserve(returns.size());
  for (const auto& seen : returns) {
    const auto T_map_vessel = poses.At(seen.utime_us);
    if (!T_map_vessel) return std::nullopt;
    const Eigen::Vector3d p_map_m = *T_map_vessel * T_vessel_lidar * seen.p_lidar_m;
    points.emplace_back(p_map_m.head<2>());
  }
  return AreaCenter(ConvexHull(std::move(points)));
}

SeenSummary Summarise(std::span<const SeenObstacle> obstacles, const std::function<bool(const SeenObstacle&)>& is_meant) {
  SeenSummary summary;
  std::map<std::int64_t, std::map<int, const SeenObstacle*>> scans;  // by object, that with most returns
  for (const auto& obstacle : obstacles) {
    if (!is_meant(obstacle)) continue;
    summary.distance_m.Add(obstacle.error_m.norm());
    summary.stated_sd_m.Add(obstacle.sd_m());
    summary.nees.Add(obstacle.nees());
    summary.in_ellipse.Add(obstacle.IsInEllipse() ? 1.0 : 0.0);
    auto& largest = scans[obstacle.scan_utime_us][obstacle.object_id];
    if (largest == nullptr || obstacle.num_points > largest->num_points) largest = &obstacle;
  }
  for (auto scan = scans.begin(); scan != scans.end() && std::next(scan) != scans.end(); ++scan) {
    const auto& [next_utime_us, next] = *std::next(scan);
    if (next_utime_us - scan->first > kMaxScanUs) continue;
    Summary east_m;
    Summary north_m;
    Summary sd_m;
    for (const auto& [object_id, before] : scan->second) {
      const auto after = next.find(object_id);
      if (after == next.end() || !IsSeenAlike(*before, *after->second)) continue;
      east_m.Add(after->second->error_m.x() - before->error_m.x());
      north_m.Add(after->second->error_m.y() - before->error_m.y());
      sd_m.Add(before->sd_m());
    }
    if (east_m.count() < kMinObjects) continue;
    const double jump_m = std::hypot(east_m.Median(), north_m.Median());
    summary.jump_m.Add(jump_m);
    summary.jump_sds.Add(jump_m / sd_m.Median());
  }
  return summary;
}

}  // namespace lookout::eval
