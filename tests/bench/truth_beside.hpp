// The truth of a simulated run beside what the suite says of it.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "common/config/boat.hpp"
#include "common/core/geodesy.hpp"
#include "common/core/utime.hpp"
#include "lab/sim/motion.hpp"
#include "lab/sim/scene.hpp"
#include "lookout/obstacles_t.hpp"

namespace lookout::bench {

/// Distance from a point to the area of a simple polygon; 0 inside.
inline double DistanceM(const Eigen::Vector2d& p_m, const std::vector<Eigen::Vector2d>& outline_m) {
  bool is_inside = false;
  double least_m2 = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0, j = outline_m.size() - 1; i < outline_m.size(); j = i++) {
    const auto& a = outline_m[j];
    const auto& b = outline_m[i];
    if ((a.y() > p_m.y()) != (b.y() > p_m.y()) && p_m.x() < (b.x() - a.x()) * (p_m.y() - a.y()) / (b.y() - a.y()) + a.x()) is_inside = !is_inside;
    const Eigen::Vector2d edge = b - a;
    const double share = edge.isZero() ? 0.0 : std::clamp((p_m - a).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    least_m2 = std::min(least_m2, (p_m - a - share * edge).squaredNorm());
  }
  return is_inside ? 0.0 : std::sqrt(least_m2);
}

class TruthBeside {
 public:
  TruthBeside(sim::Scene scene, const config::BoatFacts& boat, Utime start)
      : scene_(std::move(scene)),
        start_(start),
        reference_height_m_(boat.reference_point_above_water_m),
        frame_({sim::kLakeDatum.latitude_deg, sim::kLakeDatum.longitude_deg, sim::kLakeDatum.ellipsoid_height_m}) {
    for (const auto& object : scene_.objects) outlines_m_.push_back(OutlineOf(object, 0.0));
  }

  /// How far the corner of an obstacle's outline that is worst lies from whatever is there at its time. Precondition: STATUS_OK.
  double FarthestM(const obstacles_t& message, const obstacle_t& obstacle) const {
    const LocalFrame datum({message.datum_latitude_deg, message.datum_longitude_deg, message.datum_ellipsoid_height_m});
    const auto outlines_m = OutlinesAt(Utime(std::chrono::microseconds(obstacle.utime_us)));
    double farthest_m = 0.0;
    for (int i = 0; i < obstacle.num_map; ++i) {
      const auto place =
          datum.Reverse({obstacle.footprint_east_m[static_cast<std::size_t>(i)], obstacle.footprint_north_m[static_cast<std::size_t>(i)], 0.0});
      const Eigen::Vector2d p_map_m = frame_.Forward(place).head<2>();
      double least_m = std::numeric_limits<double>::infinity();
      for (const auto& outline_m : outlines_m) least_m = std::min(least_m, DistanceM(p_map_m, outline_m));
      farthest_m = std::max(farthest_m, least_m);
    }
    return farthest_m;
  }

  /// From the own boat's reference point to the nearest of all that is there.
  double NearestM(Utime time) const {
    const auto own = sim::StateAt(scene_.own_motion, reference_height_m_, ToSeconds(time - start_));
    const Eigen::Vector2d p_map_m = own.position_map_m.head<2>();
    double least_m = std::numeric_limits<double>::infinity();
    for (const auto& outline_m : OutlinesAt(time)) least_m = std::min(least_m, DistanceM(p_map_m, outline_m));
    return least_m;
  }

 private:
  std::vector<Eigen::Vector2d> OutlineOf(const sim::SceneObject& object, double time_s) const {
    const auto T_map_object = sim::PoseAt(object, scene_.sea, time_s);
    std::vector<Eigen::Vector2d> outline_m;
    for (const auto& p_m : object.outline_m) outline_m.emplace_back((T_map_object * Eigen::Vector3d(p_m.x(), p_m.y(), 0.0)).head<2>());
    return outline_m;
  }
  // Of a calm scene: what does not move stays.
  std::vector<std::vector<Eigen::Vector2d>> OutlinesAt(Utime time) const {
    auto outlines_m = outlines_m_;
    for (std::size_t i = 0; i < outlines_m.size(); ++i) {
      if (scene_.objects[i].track.is_moving()) outlines_m[i] = OutlineOf(scene_.objects[i], ToSeconds(time - start_));
    }
    return outlines_m;
  }

  sim::Scene scene_;
  Utime start_;
  double reference_height_m_;
  LocalFrame frame_;
  std::vector<std::vector<Eigen::Vector2d>> outlines_m_;
};

/// Greatest standard deviation of an obstacle's place in any direction.
inline double StatedSdM(const obstacle_t& obstacle) {
  const double mean = 0.5 * (obstacle.covariance_m2[0] + obstacle.covariance_m2[2]);
  const double half = 0.5 * (obstacle.covariance_m2[0] - obstacle.covariance_m2[2]);
  return std::sqrt(mean + std::hypot(half, obstacle.covariance_m2[1]));
}

}  // namespace lookout::bench
