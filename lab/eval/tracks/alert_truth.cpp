#include "lab/eval/tracks/alert_truth.hpp"

#include <GeographicLib/LocalCartesian.hpp>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "common/core/angles.hpp"
#include "lab/eval/tracks/alert_judge.hpp"
#include "lab/eval/tracks/track_geometry.hpp"

namespace lookout::eval {
namespace {

using Eigen::Vector2d;

constexpr std::int64_t kHalfWindowUs = 500'000;
// Slower than this the course says nothing of a turn.
constexpr double kHasCourseMps = 0.3;

Vector2d MeanOf(const Polygon& corners_m) {
  Vector2d sum_m = Vector2d::Zero();
  for (const auto& corner_m : corners_m) sum_m += corner_m;
  return sum_m / static_cast<double>(corners_m.size());
}

double AngleOf(const Vector2d& direction) { return std::atan2(direction.y(), direction.x()); }

}  // namespace

AlertTruth::AlertTruth(const Truth& truth, const MapOrigin& origin, Polygon own_hull_m)
    : own_hull_m_(std::move(own_hull_m)), outlines_(truth.OutlinesIn(GeographicLib::LocalCartesian(origin[0], origin[1], origin[2]))) {
  for (const auto& [id, object] : truth.objects()) {
    if (id <= 0) continue;
    const auto outline_m = outlines_.At(id, 0);
    if (!outline_m) continue;
    Known known;
    known.is_moving = object.is_moving;
    known.thing.id = id;
    known.thing.group = id;
    known.thing.name = object.name;
    known.thing.kind = object.kind;
    known.thing.is_in_water = object.is_in_water;
    if (!known.is_moving) known.thing.outline_m = std::make_shared<const HullOutline>(*outline_m);
    known_[id] = std::move(known);
  }
  GroupLand();
}

// Each piece has the least id of those that it hangs together with.
void AlertTruth::GroupLand() {
  std::vector<AlertThing*> land;
  for (auto& [id, known] : known_) {
    if (!known.thing.is_in_water && !known.is_moving) land.push_back(&known.thing);
  }
  for (std::size_t i = 0; i < land.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (land[i]->group == land[k]->group) continue;
      if (HullGap(land[i]->outline_m->corners_m(), land[k]->outline_m->corners_m(), kOneLandM) > kOneLandM) continue;
      const auto [least, other] = std::minmax(land[i]->group, land[k]->group);
      const int stays = least;
      const int goes = other;
      for (auto* piece : land) {
        if (piece->group == goes) piece->group = stays;
      }
    }
  }
}

MovingHull AlertTruth::MotionOf(int id, std::int64_t utime_us) const {
  const auto span = outlines_.SpanOf(id);
  const std::int64_t from_us = std::max(utime_us - kHalfWindowUs, span->begin_us);
  const std::int64_t to_us = std::min(utime_us + kHalfWindowUs, span->end_us);
  if (to_us <= from_us) return {};
  const double half_s = 0.5e-6 * static_cast<double>(to_us - from_us);
  const Vector2d first_m = MeanOf(*outlines_.At(id, from_us));
  const Vector2d middle_m = MeanOf(*outlines_.At(id, from_us + (to_us - from_us) / 2));
  const Vector2d last_m = MeanOf(*outlines_.At(id, to_us));
  MovingHull motion;
  motion.velocity_mps = (last_m - first_m) / (2.0 * half_s);
  if (motion.velocity_mps.norm() > kHasCourseMps) {
    motion.turn_radps = WrapToPi(AngleOf(last_m - middle_m) - AngleOf(middle_m - first_m)) / half_s;
  }
  return motion;
}

// The outline is the hull in the vessel frame, turned and moved.
AlertOwnBoat AlertTruth::OwnOf(const Polygon& outline_m, std::int64_t utime_us) const {
  const double yaw_rad = AngleOf(outline_m[1] - outline_m[0]) - AngleOf(own_hull_m_[1] - own_hull_m_[0]);
  AlertOwnBoat own;
  own.hull_m = outline_m;
  own.heading_rad = WrapTo2Pi(kPi / 2.0 - yaw_rad);
  own.reference_m = outline_m[0] - Eigen::Rotation2Dd(yaw_rad) * own_hull_m_[0];
  own.motion = MotionOf(data::kOwnVesselObject, utime_us);
  return own;
}

std::optional<AlertScan> AlertTruth::At(std::int64_t utime_us, const std::map<int, int>& num_returns) const {
  const auto own_outline_m = outlines_.At(data::kOwnVesselObject, utime_us);
  if (!own_outline_m) return std::nullopt;
  AlertScan scan;
  scan.utime_us = utime_us;
  scan.own = OwnOf(*own_outline_m, utime_us);
  scan.things.reserve(known_.size());
  for (const auto& [id, known] : known_) {
    auto& thing = scan.things.emplace_back(known.thing);
    if (known.is_moving) {
      thing.outline_m = std::make_shared<const HullOutline>(*outlines_.At(id, utime_us));
      thing.motion = MotionOf(id, utime_us);
    }
    const auto counted = num_returns.find(id);
    thing.num_returns = counted == num_returns.end() ? 0 : counted->second;
  }
  return scan;
}

}  // namespace lookout::eval
