#include "services/georeferencer/core/guard_zone.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "common/core/elementary.hpp"

namespace lookout::georeferencer {

namespace {

// Vessel frame: x forward, y port; bearings go clockwise.
double BearingOf(const Eigen::Vector2d& p_vessel_m) { return WrapTo2Pi(Atan2(-p_vessel_m.y(), p_vessel_m.x())); }
Eigen::Vector2d DirectionOf(double bearing_rad) {
  const auto [sine, cosine] = SinCosOf(bearing_rad);
  return {cosine, -sine};
}

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// Keeps the nearest of the points that it is shown.
class NearestSoFar {
 public:
  explicit NearestSoFar(const Sector& bearing) : bearing_(bearing) {}

  void Show(const Eigen::Vector2d& p_vessel_m) {
    const double bearing_rad = BearingOf(p_vessel_m);
    if (bearing_.Contains(bearing_rad)) Take({p_vessel_m.norm(), bearing_rad});
  }

  void ShowEdge(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) {
    const Eigen::Vector2d along = to_m - from_m;
    if (along.squaredNorm() > 0.0) Show(from_m + std::clamp(-from_m.dot(along) / along.squaredNorm(), 0.0, 1.0) * along);
    // Where the sector's sides cut the edge: the nearest point of what lies within may be there.
    for (const double side_rad : {bearing_.start_rad, bearing_.start_rad + bearing_.width_rad}) {
      const Eigen::Vector2d side = DirectionOf(side_rad);
      const double turned = Cross(side, along);
      if (turned == 0.0) continue;
      const double range_m = Cross(from_m, along) / turned;
      const double share = Cross(from_m, side) / turned;
      if (range_m >= 0.0 && share >= 0.0 && share <= 1.0) Take({range_m, WrapTo2Pi(side_rad)});
    }
  }

  const std::optional<NearestPoint>& nearest() const { return nearest_; }

 private:
  void Take(const NearestPoint& point) {
    if (!nearest_ || point.range_m < nearest_->range_m) nearest_ = point;
  }

  Sector bearing_;
  std::optional<NearestPoint> nearest_;
};

}  // namespace

std::optional<NearestPoint> NearestWithin(const Sector& bearing, const Obstacle& obstacle) {
  NearestSoFar nearest(bearing);
  const bool has_waterline = !obstacle.waterline_vessel_m.empty();
  const auto& outline = has_waterline ? obstacle.waterline_vessel_m : obstacle.footprint_vessel_m;
  nearest.Show(obstacle.nearest_vessel_m.head<2>());
  for (const auto& corner : outline) nearest.Show(corner);
  for (std::size_t i = 0; i + 1 < outline.size(); ++i) nearest.ShowEdge(outline[i], outline[i + 1]);
  if (!has_waterline && outline.size() > 2) nearest.ShowEdge(outline.back(), outline.front());
  return nearest.nearest();
}

void GuardZone::Add(const ObstaclePart& part) {
  if (params_.range_m <= 0.0) return;
  if (turn_ != part.head.time) {
    before_ = latest_;
    latest_.reset();
    turn_ = part.head.time;
  }
  const bool was_clear = !before_ && !latest_;
  for (const auto& obstacle : part.obstacles) {
    if (obstacle.judgement.confidence == Confidence::kTentative && !params_.takes_tentative) continue;
    const auto nearest = NearestWithin(params_.bearing, obstacle);
    if (!nearest || nearest->range_m > params_.range_m) continue;
    if (!latest_ || nearest->range_m < latest_->range_m) latest_ = nearest;
  }
  if (was_clear && latest_) ++num_alarms_;
}

std::optional<NearestPoint> GuardZone::nearest() const {
  if (latest_ && before_) return latest_->range_m <= before_->range_m ? latest_ : before_;
  return latest_ ? latest_ : before_;
}

}  // namespace lookout::georeferencer
