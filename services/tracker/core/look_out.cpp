#include "services/tracker/core/look_out.hpp"

#include <algorithm>
#include <iterator>

namespace lookout::tracker {

namespace {

double SpeedOf(const std::optional<Pose>& own) { return own && own->velocity_map_mps.allFinite() ? own->velocity_map_mps.norm() : kNan; }

}  // namespace

void LookOut::Take(const Order& order, Utime time) {
  if (order.kind == OrderKind::kSilence) {
    sound_.Silence(time);
  } else {
    settings_ = order.settings;
  }
}

const Limits& LookOut::Begin(const std::optional<Pose>& own) {
  limits_ = LimitsOf(params_.limits, settings_, SpeedOf(own), params_.ability);
  return limits_;
}

GuardZoneParams LookOut::WholeZone() const {
  auto settings = settings_;
  settings.mode = Mode::kOpenWater;
  return LimitsOf(params_.limits, settings, 0.0, params_.ability).guard_zone;
}

void LookOut::Rename(const Picture& picture, Utime time) {
  for (const auto& [from, to] : picture.merged) {
    things_.Rename(from, to);
    proof_.Rename(from, to);
    alerts_.Rename(from, things_.ThingOf(to), time);
  }
  proof_.Update(picture.tracks);
  if (picture.is_waterline_told) shore_m_ = picture.waterline_m;
  things_.Update(time, picture.tracks, shore_m_);
  for (const auto& [from, to] : things_.merged()) alerts_.Rename(from, to, time);
}

const std::vector<Alert>& LookOut::Update(Utime time, bool is_whole, const Picture& picture, std::span<const VesselOutline> outlines,
                                          const std::optional<Pose>& own, const std::optional<Danger>& unseen) {
  const bool is_own_still = still_.Update(time, own ? Eigen::Vector2d(own->velocity_map_mps) : Eigen::Vector2d::Constant(kNan));
  auto dangers = GuardZoneDangers(limits_.guard_zone, picture, outlines, own, things_, &newcomers_, time);
  std::ranges::move(ClosestApproachDangers({limits_.cpa_limit_m, params_.ability}, picture, own, is_own_still, things_, &proof_, time),
                    std::back_inserter(dangers));
  if (unseen) dangers.push_back(*unseen);
  const auto& alerts = alerts_.Update(time, is_whole, dangers, {own, std::span(picture.tracks)});
  sounding_ = sound_.Update(time, alerts);
  return alerts;
}

}  // namespace lookout::tracker
