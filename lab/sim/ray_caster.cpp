#include "lab/sim/ray_caster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "common/core/angles.hpp"
#include "common/core/outlines.hpp"

namespace lookout::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kNumBins = 720;
constexpr double kBinsPerRad = kNumBins / kTwoPi;

// Period in which floating objects get a new height and list: at 1 m/s of heave they move by 0.5 mm in between.
constexpr double kTiltPeriodS = 0.0005;

// Slack of the tests that skip parts without a close look: far more than rounding, far less than a part.
constexpr double kRoundingM = 1e-6;
constexpr double kRoundingCosine = 1e-12;

// Steps in range within which neighbouring surfaces count as one: three standard deviations of the range.
constexpr double kSameSurfaceM = 0.08;

// Rays of a beam, of equal shares, as shares of its half angles. The first five tell whether there is an edge; only then come the others.
struct Offset {
  double horizontal;
  double vertical;
};
constexpr std::array kBeamRays{Offset{0.0, 0.0},    Offset{-0.8, 0.0},   Offset{0.8, 0.0},  Offset{0.0, -0.8}, Offset{0.0, 0.8},
                               Offset{-0.4, 0.0},   Offset{0.4, 0.0},    Offset{0.0, -0.4}, Offset{0.0, 0.4},  Offset{-0.55, -0.55},
                               Offset{-0.55, 0.55}, Offset{0.55, -0.55}, Offset{0.55, 0.55}};
constexpr std::size_t kNumProbeRays = 5;

int WrapBin(int bin) { return ((bin % kNumBins) + kNumBins) % kNumBins; }

}  // namespace

RayCaster::RayCaster(const std::vector<SceneObject>& objects, const BeamWidth& width, const Sea* sea)
    : objects_(objects), width_(width), sea_(sea), places_(objects.size()), bins_(kNumBins) {
  for (std::size_t object = 0; object < objects_.size(); ++object) {
    Move(object, 0.0);
    places_[object].is_tilted = sea_ != nullptr && !sea_->is_calm() && objects_[object].is_afloat();
    for (const auto& part : objects_[object].parts) {
      Item item;
      item.part = &part;
      item.bounds = BoundsOf(part.solid);
      item.object = object;
      items_.push_back(std::move(item));
    }
  }
  order_.resize(items_.size());
}

void RayCaster::Move(std::size_t object, double time_s) {
  const Placement placement = objects_[object].track.At(time_s);
  places_[object].origin_m = placement.position_map_m;
  places_[object].sine = std::sin(placement.heading_rad);
  places_[object].cosine = std::cos(placement.heading_rad);
}

void RayCaster::MoveTo(double time_s, const Vector2d& eye_m) {
  for (std::size_t object = 0; object < objects_.size(); ++object) {
    if (objects_[object].track.is_moving()) Move(object, time_s);
  }
  if (std::abs(time_s - tilted_at_s_) >= kTiltPeriodS) {
    tilted_at_s_ = time_s;
    Tilt(time_s);
  }
  if (std::abs(time_s - sorted_at_s_) >= kSortPeriodS) {
    sorted_at_s_ = time_s;
    Sort(eye_m);
  }
}

void RayCaster::Tilt(double time_s) {
  for (std::size_t object = 0; object < objects_.size(); ++object) {
    Place& place = places_[object];
    if (!place.is_tilted) continue;
    const Eigen::Isometry3d T_map_object = PoseAt(objects_[object], *sea_, time_s);
    Eigen::Matrix3d R_object_map;  // level: x forward is (sine, cosine) in east, north
    R_object_map << place.sine, place.cosine, 0.0, -place.cosine, place.sine, 0.0, 0.0, 0.0, 1.0;
    place.R_tilt = R_object_map * T_map_object.linear();
    place.height_m = T_map_object.translation().z();
  }
}

RayCaster::Bins RayCaster::BinsOf(Item& item, const Vector2d& eye_m) const {
  const Place& place = places_[item.object];
  double radius_m = item.bounds.radius_m + kMarginM;
  item.low_map_m = item.bounds.low_m;
  item.high_map_m = item.bounds.high_m;
  if (place.is_tilted) {
    // A lean moves what is high up or far out.
    const double tilt_sine = std::sqrt(std::max(0.0, 1.0 - place.R_tilt(2, 2) * place.R_tilt(2, 2)));
    double reach_m = 0.0;
    for (const auto& p_m : item.bounds.points_m) reach_m = std::max(reach_m, p_m.norm() + item.bounds.radius_m);
    const double height_m = std::max(std::abs(item.bounds.low_m), std::abs(item.bounds.high_m));
    radius_m += tilt_sine * (height_m + tilt_sine * reach_m);
    item.low_map_m += place.height_m - tilt_sine * (reach_m + height_m);
    item.high_map_m += place.height_m + tilt_sine * (reach_m + height_m);
  }
  item.low_map_m -= kMarginM;
  item.high_map_m += kMarginM;
  std::vector<Vector2d> points_m;  // from the eye
  for (const auto& p_m : item.bounds.points_m) {
    points_m.emplace_back(place.origin_m - eye_m +
                          Vector2d(place.sine * p_m.x() - place.cosine * p_m.y(), place.cosine * p_m.x() + place.sine * p_m.y()));
  }
  const double first_rad = std::atan2(points_m[0].y(), points_m[0].x());
  double from_rad = 0.0;
  double to_rad = 0.0;
  double nearest_m = std::numeric_limits<double>::infinity();
  double farthest_m = 0.0;
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const double distance_m = points_m[i].norm();
    const double half_rad = distance_m > radius_m ? std::asin(radius_m / distance_m) : kPi;
    const double relative_rad = WrapToPi(std::atan2(points_m[i].y(), points_m[i].x()) - first_rad);
    from_rad = std::min(from_rad, relative_rad - half_rad);
    to_rad = std::max(to_rad, relative_rad + half_rad);
    farthest_m = std::max(farthest_m, distance_m + radius_m);
    nearest_m = std::min(nearest_m, DistanceToEdge(Vector2d::Zero(), points_m[i], points_m[i + 1 < points_m.size() ? i + 1 : 0]) - radius_m);
  }
  item.farthest_m = farthest_m;
  item.cosine_half = -1.0;
  // A hull that spans half a circle holds the eye.
  if (to_rad - from_rad >= kPi) {
    item.nearest_m = 0.0;
    return {0, kNumBins};
  }
  item.nearest_m = nearest_m;
  from_rad -= width_.half_horizontal_rad;
  to_rad += width_.half_horizontal_rad;
  const double middle_rad = first_rad + (from_rad + to_rad) / 2.0;
  item.middle = {std::cos(middle_rad), std::sin(middle_rad)};
  item.cosine_half = std::cos(std::min((to_rad - from_rad) / 2.0, kPi));
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
  const Place& place = places_[item.object];
  const Vector2d from_m = ray.origin_m.head<2>() - place.origin_m;
  const auto turn = [&place](const Vector2d& v) {
    return Vector2d(place.sine * v.x() + place.cosine * v.y(), place.sine * v.y() - place.cosine * v.x());
  };
  Ray own;
  own.origin_m << turn(from_m), ray.origin_m.z();
  own.direction << turn(ray.direction.head<2>()), ray.direction.z();
  if (place.is_tilted) {
    own.origin_m.z() -= place.height_m;
    own.origin_m = place.R_tilt.transpose() * own.origin_m;
    own.direction = place.R_tilt.transpose() * own.direction;
  }
  return Intersect(item.part->solid, own);
}

// Fills near_. A part is left out when it lies wholly to one side of the beam, above or below it.
void RayCaster::Gather(const Ray& axis, double max_range_m, double slope_margin) {
  near_.clear();
  const Vector2d plan = axis.direction.head<2>();
  const double angle_rad = std::atan2(plan.y(), plan.x());
  const auto& bin = bins_[static_cast<std::size_t>(WrapBin(static_cast<int>(std::floor(angle_rad * kBinsPerRad))))];
  if (bin.empty()) return;
  const double length = plan.norm();
  const Vector2d towards = plan / length;
  const double slope = axis.direction.z() / length;
  const double max_plan_m = max_range_m * length + kMarginM;
  for (const Item* item : bin) {
    if (item->nearest_m > max_range_m) break;
    if (item->cosine_half > 0.0 && towards.dot(item->middle) < item->cosine_half - kRoundingCosine) continue;
    const double from_m = std::max(item->nearest_m, 0.0);
    const double to_m = std::min(item->farthest_m, max_plan_m);
    const double highest_slope = slope + slope_margin;
    const double lowest_slope = slope - slope_margin;
    const double highest_m = axis.origin_m.z() + highest_slope * (highest_slope > 0.0 ? to_m : from_m);
    const double lowest_m = axis.origin_m.z() + lowest_slope * (lowest_slope > 0.0 ? from_m : to_m);
    if (highest_m < item->low_map_m - kRoundingM || lowest_m > item->high_map_m + kRoundingM) continue;
    near_.push_back(item);
  }
}

RayCaster::Meeting RayCaster::NearestOf(const Ray& ray, double max_range_m, const Item* skipped) const {
  Meeting best{nullptr, {max_range_m}};
  for (const Item* item : near_) {
    if (item->nearest_m > best.hit.range_m) break;
    if (item == skipped) continue;
    const auto hit = IntersectItem(*item, ray);
    if (hit && hit->range_m < best.hit.range_m) best = {item, *hit};
  }
  return best;
}

Echo RayCaster::ToEcho(const Meeting& meeting) const {
  Echo echo;
  echo.hit = meeting.hit;
  echo.object_id = objects_[meeting.item->object].id;
  echo.material = meeting.item->part->material;
  echo.reason = echo.object_id == kOwnVessel ? ReturnReason::kOwnVessel : ReturnReason::kObject;
  return echo;
}

// The surface that was met first, and the one behind it where that is porous.
Echoes RayCaster::ToEchoes(const Meeting& first, const Ray& ray, double max_range_m, bool wants_second) const {
  Echoes echoes;
  if (first.item == nullptr) return echoes;
  echoes.echo[0] = ToEcho(first);
  echoes.count = 1;
  if (!wants_second || !first.item->part->material.is_porous) return echoes;
  const Meeting second = NearestOf(ray, max_range_m, first.item);
  if (second.item == nullptr) return echoes;
  echoes.echo[1] = ToEcho(second);
  echoes.echo[1].is_behind_foliage = true;
  echoes.count = 2;
  return echoes;
}

Echoes RayCaster::Cast(const Ray& ray, double max_range_m, bool wants_second) {
  Gather(ray, max_range_m, 0.0);
  return ToEchoes(NearestOf(ray, max_range_m, nullptr), ray, max_range_m, wants_second);
}

// One echo of rays that meet surfaces close to each other, nearest first: between them, as the light is shared.
Echo RayCaster::Merge(const Meeting* begin, const Meeting* end, int num_rays) const {
  Echo echo = ToEcho(*begin);
  double sum_light = 0.0;
  double sum_range = 0.0;
  double sum_cosine = 0.0;
  double sum_reflectance = 0.0;
  for (const Meeting* meeting = begin; meeting != end; ++meeting) {
    const double light = std::max(meeting->item->part->material.reflectance, 1e-3);
    sum_light += light;
    sum_range += light * meeting->hit.range_m;
    sum_cosine += light * meeting->hit.incidence_cosine;
    sum_reflectance += meeting->item->part->material.reflectance;
    if (meeting != begin && meeting->item != (meeting - 1)->item && meeting->hit.range_m - (meeting - 1)->hit.range_m > kSameSurfaceM) {
      echo.reason = ReturnReason::kMixedEdge;
    }
  }
  const auto count = static_cast<double>(end - begin);
  echo.hit = {sum_range / sum_light, sum_cosine / sum_light};
  echo.material.reflectance = sum_reflectance / count;
  echo.share = count / num_rays;
  return echo;
}

Echoes RayCaster::CastBeam(const Ray& axis, double max_range_m, bool wants_second) {
  Gather(axis, max_range_m, 2.0 * width_.half_vertical_rad);
  if (near_.empty()) return {};
  const Vector3d right = Vector3d(axis.direction.y(), -axis.direction.x(), 0.0).normalized() * width_.half_horizontal_rad;
  const Vector3d up = right.normalized().cross(axis.direction) * width_.half_vertical_rad;
  std::array<Meeting, kBeamRays.size()> meetings;
  const auto meet = [&](const Offset& offset) {
    const Ray ray{axis.origin_m, (axis.direction + offset.horizontal * right + offset.vertical * up).normalized()};
    return NearestOf(ray, max_range_m, nullptr);
  };
  for (std::size_t i = 0; i < kNumProbeRays; ++i) meetings[i] = meet(kBeamRays[i]);
  const bool is_edge =
      std::any_of(meetings.begin() + 1, meetings.begin() + kNumProbeRays, [&](const Meeting& meeting) { return meeting.item != meetings[0].item; });
  if (!is_edge) return ToEchoes(meetings[0], axis, max_range_m, wants_second);
  for (std::size_t i = kNumProbeRays; i < kBeamRays.size(); ++i) meetings[i] = meet(kBeamRays[i]);
  const auto met = std::partition(meetings.begin(), meetings.end(), [](const Meeting& meeting) { return meeting.item != nullptr; });
  std::sort(meetings.begin(), met, [](const Meeting& a, const Meeting& b) { return a.hit.range_m < b.hit.range_m; });
  Echoes echoes;
  for (auto begin = meetings.begin(); begin != met && echoes.count < Echoes::kMaxCount;) {
    auto end = begin + 1;
    while (end != met && end->hit.range_m - (end - 1)->hit.range_m < kMergeM) ++end;
    echoes.echo[static_cast<std::size_t>(echoes.count++)] = Merge(&*begin, &*begin + (end - begin), static_cast<int>(kBeamRays.size()));
    begin = end;
  }
  return echoes;
}

}  // namespace lookout::sim
