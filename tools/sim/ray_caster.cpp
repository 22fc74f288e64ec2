#include "tools/sim/ray_caster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/core/angles.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;

constexpr int kNumBins = 720;
constexpr double kBinsPerRad = kNumBins / kTwoPi;

double DistanceFromOrigin(const Vector2d& a_m, const Vector2d& b_m) {
  const Vector2d edge_m = b_m - a_m;
  const double length2_m2 = edge_m.squaredNorm();
  const double share = length2_m2 > 0.0 ? std::clamp(-a_m.dot(edge_m) / length2_m2, 0.0, 1.0) : 0.0;
  return (a_m + share * edge_m).norm();
}

int WrapBin(int bin) { return ((bin % kNumBins) + kNumBins) % kNumBins; }

}  // namespace

RayCaster::RayCaster(const std::vector<Body>& bodies) : bodies_(bodies), places_(bodies.size()), bins_(kNumBins) {
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    for (const auto& part : *bodies_[body].parts) items_.push_back({&part, BoundsOf(part.solid), body, 0.0});
  }
  order_.resize(items_.size());
}

void RayCaster::MoveTo(double time_s, const Vector2d& eye_m) {
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    const Placement placement = bodies_[body].track.At(time_s);
    places_[body] = {placement.position_map_m, std::sin(placement.heading_rad), std::cos(placement.heading_rad)};
  }
  if (std::abs(time_s - sorted_at_s_) >= kSortPeriodS) {
    sorted_at_s_ = time_s;
    Sort(eye_m);
  }
}

RayCaster::Bins RayCaster::BinsOf(Item& item, const Vector2d& eye_m) const {
  const Place& place = places_[item.body];
  const double radius_m = item.bounds.radius_m + kMarginM;
  std::vector<Vector2d> points_m;  // from the eye
  for (const auto& p_m : item.bounds.points_m) {
    points_m.emplace_back(place.origin_m - eye_m +
                          Vector2d(place.sine * p_m.x() - place.cosine * p_m.y(), place.cosine * p_m.x() + place.sine * p_m.y()));
  }
  const double first_rad = std::atan2(points_m[0].y(), points_m[0].x());
  double from_rad = 0.0;
  double to_rad = 0.0;
  double nearest_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const double distance_m = points_m[i].norm();
    const double half_rad = distance_m > radius_m ? std::asin(radius_m / distance_m) : kPi;
    const double relative_rad = WrapToPi(std::atan2(points_m[i].y(), points_m[i].x()) - first_rad);
    from_rad = std::min(from_rad, relative_rad - half_rad);
    to_rad = std::max(to_rad, relative_rad + half_rad);
    nearest_m = std::min(nearest_m, DistanceFromOrigin(points_m[i], points_m[i + 1 < points_m.size() ? i + 1 : 0]) - radius_m);
  }
  // A hull that spans half a circle holds the eye.
  if (to_rad - from_rad >= kPi) {
    item.nearest_m = 0.0;
    return {0, kNumBins};
  }
  item.nearest_m = nearest_m;
  const int first = static_cast<int>(std::floor((first_rad + from_rad) * kBinsPerRad));
  const int last = static_cast<int>(std::floor((first_rad + to_rad) * kBinsPerRad));
  return {WrapBin(first), last - first + 1};
}

void RayCaster::Sort(const Vector2d& eye_m) {
  std::vector<Bins> bins_of_item(items_.size());
  for (std::size_t i = 0; i < items_.size(); ++i) bins_of_item[i] = BinsOf(items_[i], eye_m);
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::ranges::sort(order_, {}, [this](std::size_t i) { return std::pair(items_[i].nearest_m, i); });
  for (auto& bin : bins_) bin.clear();
  for (const std::size_t i : order_) {
    for (int k = 0; k < bins_of_item[i].count; ++k) bins_[static_cast<std::size_t>(WrapBin(bins_of_item[i].first + k))].push_back(&items_[i]);
  }
}

std::optional<Hit> RayCaster::IntersectItem(const Item& item, const Ray& ray) const {
  const Place& place = places_[item.body];
  const Vector2d from_m = ray.origin_m.head<2>() - place.origin_m;
  const auto turn = [&place](const Vector2d& v) {
    return Vector2d(place.sine * v.x() + place.cosine * v.y(), place.sine * v.y() - place.cosine * v.x());
  };
  Ray own;
  own.origin_m << turn(from_m), ray.origin_m.z();
  own.direction << turn(ray.direction.head<2>()), ray.direction.z();
  return Intersect(item.part->solid, own);
}

RayCaster::Echoes RayCaster::Cast(const Ray& ray, double max_range_m, bool wants_second) const {
  const double angle_rad = std::atan2(ray.direction.y(), ray.direction.x());
  const auto& bin = bins_[static_cast<std::size_t>(WrapBin(static_cast<int>(std::floor(angle_rad * kBinsPerRad))))];
  const auto nearest_but = [&](const Item* skipped) {
    const Item* best = nullptr;
    Hit best_hit{max_range_m};
    for (const Item* item : bin) {
      if (item->nearest_m > best_hit.range_m) break;
      if (item == skipped) continue;
      const auto hit = IntersectItem(*item, ray);
      if (hit && hit->range_m < best_hit.range_m) {
        best = item;
        best_hit = *hit;
      }
    }
    return std::pair(best, best_hit);
  };
  Echoes echoes;
  const auto [first, first_hit] = nearest_but(nullptr);
  if (first == nullptr) return echoes;
  echoes.echo[echoes.count++] = {first_hit, bodies_[first->body].object_id, first->part->material};
  if (wants_second && first->part->material.is_porous) {
    const auto [second, second_hit] = nearest_but(first);
    if (second != nullptr) echoes.echo[echoes.count++] = {second_hit, bodies_[second->body].object_id, second->part->material};
  }
  return echoes;
}

}  // namespace lookout::sim
