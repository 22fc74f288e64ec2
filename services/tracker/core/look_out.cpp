#include "services/tracker/core/look_out.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace lookout::tracker {

namespace {

double SpeedOf(const std::optional<Pose>& own) { return own && own->velocity_map_mps.allFinite() ? own->velocity_map_mps.norm() : kNan; }

}  // namespace

void LookOut::Take(const Order& order, Utime time) {
  if (order.kind == OrderKind::kSilence) {
    sound_.Silence(time);
  } else if (order.kind == OrderKind::kName) {
    namings_.push_back(order);
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
    names_.Rename(from, to);
  }
  if (picture.is_waterline_told) shore_m_ = picture.waterline_m;
  proof_.Update(picture.tracks, shore_m_);
  things_.Update(time, picture.tracks, shore_m_, &proof_, is_own_still_);
  for (const auto& [from, to] : things_.merged()) alerts_.Rename(from, to, time);
  names_.Follow(picture.tracks, things_);
  Name(picture, time);
}

void LookOut::Name(const Picture& picture, Utime time) {
  for (const auto& naming : std::exchange(namings_, {})) {
    const auto id = naming.track_id;
    if (std::ranges::find(picture.tracks, id, &Track::id) == picture.tracks.end()) {
      ++num_names_of_no_track_;
    } else {
      names_.Give(id, naming.name, time);
    }
  }
}

const std::vector<Alert>& LookOut::Update(Utime time, bool is_whole, const Picture& picture, std::span<const VesselOutline> outlines,
                                          const std::optional<Pose>& own, std::span<const Danger> unseen) {
  is_own_still_ = still_.Update(time, own ? Eigen::Vector2d(own->velocity_map_mps) : Eigen::Vector2d::Constant(kNan));
  auto dangers = GuardZoneDangers(limits_.guard_zone, picture, outlines, own, things_, &newcomers_, time, is_own_still_ ? &proof_ : nullptr);
  std::ranges::move(ClosestApproachDangers({limits_.cpa_limit_m, params_.ability}, picture, own, is_own_still_, things_, &proof_, time),
                    std::back_inserter(dangers));
  std::ranges::copy(unseen, std::back_inserter(dangers));
  told_ = alerts_.Update(time, is_whole, dangers, {own, std::span(picture.tracks)});
  for (const auto& [from, to] : alerts_.adopted()) names_.Rename(from, to);
  names_.Update(time, picture.tracks, told_);
  for (auto& alert : told_) alert.name = names_.Of(alert);
  sounding_ = sound_.Update(time, told_);
  return told_;
}

}  // namespace lookout::tracker
