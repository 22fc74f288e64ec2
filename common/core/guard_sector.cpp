#include "common/core/guard_sector.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "common/core/elementary.hpp"
#include "common/core/outlines.hpp"

namespace lookout {

namespace {

// Vessel frame: x forward, y port; bearings go clockwise.
double BearingOf(const Eigen::Vector2d& p_vessel_m) { return WrapTo2Pi(Atan2(-p_vessel_m.y(), p_vessel_m.x())); }
Eigen::Vector2d DirectionOf(double bearing_rad) {
  const auto [sine, cosine] = SinCosOf(bearing_rad);
  return {cosine, -sine};
}

// The nearest of some points and edges within a sector.
class NearestFinder {
 public:
  explicit NearestFinder(const Sector& bearing) : bearing_(bearing) {}

  void Add(const Eigen::Vector2d& p_vessel_m) {
    const double bearing_rad = BearingOf(p_vessel_m);
    if (bearing_.Contains(bearing_rad)) KeepNearer(nearest_, NearestPoint{p_vessel_m.norm(), bearing_rad});
  }

  void AddEdge(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) {
    const Eigen::Vector2d along = to_m - from_m;
    if (along.squaredNorm() > 0.0) Add(from_m + std::clamp(-from_m.dot(along) / along.squaredNorm(), 0.0, 1.0) * along);
    // Where the sector's sides cut the edge: the nearest point of the part inside may be there.
    for (const double side_rad : {bearing_.start_rad, bearing_.start_rad + bearing_.width_rad}) {
      const Eigen::Vector2d side = DirectionOf(side_rad);
      const double sine = Cross(side, along);
      if (sine == 0.0) continue;
      const double range_m = Cross(from_m, along) / sine;
      const double share = Cross(from_m, side) / sine;
      if (range_m >= 0.0 && share >= 0.0 && share <= 1.0) KeepNearer(nearest_, NearestPoint{range_m, WrapTo2Pi(side_rad)});
    }
  }

  const std::optional<NearestPoint>& nearest() const { return nearest_; }

 private:
  Sector bearing_;
  std::optional<NearestPoint> nearest_;
};

}  // namespace

bool IsInsideBox(const GuardZoneParams& params, const Eigen::AlignedBox3d& box_m) {
  const Eigen::AlignedBox2d flat_m(Eigen::Vector2d(box_m.min().head<2>()), Eigen::Vector2d(box_m.max().head<2>()));
  const auto is_inside = [&](double bearing_rad) {
    constexpr double kRoundingM = 1e-9;
    return flat_m.exteriorDistance(Eigen::Vector2d(params.range_m * DirectionOf(bearing_rad))) <= kRoundingM;
  };
  // How far a sector reaches to each side of a box shows at its apex, the ends of its arc, and the four directions that lie within.
  if (!flat_m.contains(Eigen::Vector2d(0.0, 0.0))) return false;
  if (!is_inside(params.bearing.start_rad) || !is_inside(params.bearing.start_rad + params.bearing.width_rad)) return false;
  return std::ranges::all_of(std::array{0.0, 0.5 * kPi, kPi, 1.5 * kPi},
                             [&](double bearing_rad) { return !params.bearing.Contains(bearing_rad) || is_inside(bearing_rad); });
}

std::optional<NearestPoint> NearestWithin(const Sector& bearing, std::span<const Eigen::Vector2d> corners_vessel_m, bool is_closed) {
  NearestFinder nearest(bearing);
  for (const auto& corner : corners_vessel_m) nearest.Add(corner);
  for (std::size_t i = 0; i + 1 < corners_vessel_m.size(); ++i) nearest.AddEdge(corners_vessel_m[i], corners_vessel_m[i + 1]);
  if (is_closed && corners_vessel_m.size() > 2) nearest.AddEdge(corners_vessel_m.back(), corners_vessel_m.front());
  return nearest.nearest();
}

}  // namespace lookout
