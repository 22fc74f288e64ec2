#include "lab/eval/tracks/track_truth.hpp"

#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>

#include "lab/eval/methods/outcome.hpp"
#include "lab/eval/tracks/track_geometry.hpp"

namespace lookout::eval {

std::map<std::int32_t, data::ScanObject> ObjectsOf(const Truth& truth) {
  std::map<std::int32_t, data::ScanObject> objects;
  for (const auto& [id, object] : truth.objects()) objects[id] = {object.name, object.kind, object.is_in_water};
  return objects;
}

TrackTruth::TrackTruth(const Truth& truth, const MapPlacement& map)
    : objects_(ObjectsOf(truth)), outlines_(truth.OutlinesIn(GeographicLib::LocalCartesian(map.origin[0], map.origin[1], map.origin[2]))) {
  const double sin = std::sin(map.y_axis_rad);
  const double cos = std::cos(map.y_axis_rad);
  R_map_north_ << cos, -sin, sin, cos;
  for (const auto& [id, object] : truth.objects()) {
    const auto outline_m = OutlineAt(id, 0);
    if (id > 0 && !object.is_moving && outline_m) standing_[id] = MakeThing(id, *outline_m);
  }
}

std::optional<Polygon> TrackTruth::OutlineAt(int id, std::int64_t utime_us) const {
  auto outline_m = outlines_.At(id, utime_us);
  if (outline_m) {
    for (auto& p_m : *outline_m) p_m = (R_map_north_ * p_m).eval();
  }
  return outline_m;
}

TrueThing TrackTruth::MakeThing(int id, const Polygon& outline_m) const {
  TrueThing thing;
  thing.id = id;
  thing.outline_m = outline_m;
  thing.position_m = CenterOf(outline_m);
  thing.is_in_water = objects_.at(id).is_in_water;
  thing.is_land = IsLand(objects_.at(id));
  thing.is_buoy = objects_.at(id).kind == "buoy";
  return thing;
}

Eigen::Vector2d TrackTruth::VelocityOf(int id, std::int64_t utime_us) const {
  constexpr std::int64_t kHalfUs = 50'000;
  const auto before_m = OutlineAt(id, utime_us - kHalfUs);
  const auto after_m = OutlineAt(id, utime_us + kHalfUs);
  return (CenterOf(*after_m) - CenterOf(*before_m)) / (2e-6 * static_cast<double>(kHalfUs));
}

TrueScan TrackTruth::At(std::int64_t utime_us, const std::map<int, int>& num_returns) const {
  TrueScan scan;
  scan.utime_us = utime_us;
  for (const auto& [id, object] : objects_) {
    if (id == data::kNoTrueObject) continue;
    const auto outline_m = OutlineAt(id, utime_us);
    if (!outline_m) continue;
    if (id == data::kOwnVesselObject) {
      scan.own = TrueBoat{*outline_m, VelocityOf(id, utime_us)};
      continue;
    }
    const auto standing = standing_.find(id);
    auto& thing = scan.things.emplace_back(standing != standing_.end() ? standing->second : MakeThing(id, *outline_m));
    if (standing == standing_.end()) thing.velocity_mps = VelocityOf(id, utime_us);
    const auto counted = num_returns.find(id);
    thing.num_returns = counted == num_returns.end() ? 0 : counted->second;
  }
  return scan;
}

}  // namespace lookout::eval
