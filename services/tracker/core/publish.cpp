#include "services/tracker/core/publish.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/core/angles.hpp"

namespace lookout::tracker {

namespace {

constexpr double kCoastingS = 1.0;
constexpr double kLineageS = 10.0;

TrackKind KindOf(const Track& track, bool is_moving) {
  constexpr double kBuoyM = 1.5;
  constexpr double kStructureM = 20.0;
  if (is_moving) return TrackKind::kBoat;
  if (track.seen_share < 0.4) return TrackKind::kUnknown;
  if (track.rectangle.length_m > kStructureM) return TrackKind::kStructure;
  if (track.rectangle.length_m < kBuoyM) return TrackKind::kBuoy;
  return TrackKind::kObstacle;
}

// Of a track as it is published: its place from the own boat, and its closest approach.
void Encountered(Track& track, const Pose& own, const Moving& self, const TrackerParams& params) {
  constexpr double kStandingMps = 0.05;                 // deviation of a standing thing: a mooring lets it swing
  constexpr double kTurnsForSureRadps = DegToRad(8.0);  // two deviations of a turn rate that is published
  const auto [sine, cosine] = SinCosOf(own.heading_rad);
  const Eigen::Vector2d forward(sine, cosine);
  const Eigen::Vector2d port(-cosine, sine);
  const Eigen::Vector2d place_m = own.position_map_m.head<2>();
  Moving other{track.outline_m, track.velocity_mps};
  if (std::fabs(track.turn_rate_radps) > kTurnsForSureRadps) other.turn_rate_radps = track.turn_rate_radps;
  RelativeCovariance covariance = RelativeCovariance::Zero();
  covariance.topLeftCorner<2, 2>() = track.covariance_relative_m2;
  covariance.bottomRightCorner<2, 2>() = Eigen::Matrix2d::Identity() * (kOwnVelocitySdMps * kOwnVelocitySdMps + kStandingMps * kStandingMps);
  track.approach_if_standing = ClosestApproachOf(self, {track.outline_m, Eigen::Vector2d::Zero()}, covariance, params.encounter);
  track.approach = track.approach_if_standing;
  if (!track.velocity_mps.isZero(0.0)) {
    covariance.bottomRightCorner<2, 2>() =
        Eigen::Matrix2d::Identity() * (kOwnVelocitySdMps * kOwnVelocitySdMps) + track.covariance.bottomRightCorner<2, 2>();
    track.approach = ClosestApproachOf(self, other, covariance, params.encounter);
  }
  track.encounter = EncounterOf(self, own.heading_rad, other, track.approach, params.encounter);
  track.range_m = GapOf(track.outline_m, std::array{place_m}).distance_m;
  const Eigen::Vector2d off = track.position_m - place_m;
  track.bearing_rad = WrapTo2Pi(Atan2(off.dot(-port), off.dot(forward)));
}

// Rule 13 d: no later change of bearing makes a crossing out of it.
Encounter StillOvertaking(Encounter before, const Track& track) {
  if (track.approach.tcpa_s <= 0.0) return Encounter::kNone;
  if (before != Encounter::kNone) return before;
  return track.encounter == Encounter::kOvertaking || track.encounter == Encounter::kOvertaken ? track.encounter : Encounter::kNone;
}

std::optional<Track> PublishedOf(const ScanInput& scan, const TrackerParams& params, const std::optional<Moving>& self, Followed& track) {
  const double unseen_s = track.UnseenS(scan.end_time);
  const double existence = track.Existence();
  if (!track.is_confirmed && !track.body) return std::nullopt;  // it is nothing yet
  Track out;
  out.id = track.PublicId();
  out.status = track.is_ended                               ? TrackStatus::kLost
               : !track.is_confirmed                        ? TrackStatus::kTentative
               : unseen_s <= kCoastingS && existence >= 0.5 ? TrackStatus::kConfirmed
                                                            : TrackStatus::kCoasting;
  if (track.is_ended && !track.is_confirmed) return std::nullopt;
  out.first = track.first;
  out.seen = track.seen;
  const bool is_moving = track.body && track.body->IsMoving(params.moving_probability);
  out.outline_m = track.outline_m;
  out.rectangle = RectangleAround(out.outline_m);
  out.position_m = out.rectangle.center_m;
  if (track.body) {
    out.covariance = track.body->covariance();
    out.moving_probability = track.body->moving_probability();
    out.seen_share = track.body->SeenShare();
    if (is_moving) out.velocity_mps = track.body->velocity_mps();
  } else {
    out.covariance.topLeftCorner<2, 2>() = 0.05 * Eigen::Matrix2d::Identity();
  }
  out.covariance_relative_m2 = out.covariance.topLeftCorner<2, 2>() + track.relative_covariance_m2;
  out.covariance.topLeftCorner<2, 2>() += track.relative_covariance_m2 + track.own_covariance_m2;
  out.existence_probability = track.is_confirmed ? existence : track.Probability();
  out.top_above_water_m = track.top_m;
  out.segment_ids = track.segment_ids;
  std::ranges::sort(out.segment_ids);
  for (auto* list : {&track.parents, &track.children}) {
    std::erase_if(*list, [&](const auto& one) { return ToSeconds(scan.end_time - one.second) > kLineageS; });
  }
  for (const auto& [id, since] : track.parents) out.parents.push_back(id);
  for (const auto& [id, since] : track.children) out.children.push_back(id);
  out.is_on_ground = is_moving && track.is_on_ground;
  out.num_looks = static_cast<int>(track.looks.size());
  out.num_seen = static_cast<int>(std::ranges::count(track.looks, true));
  out.mean_returns = track.sum_returns / std::max(1, track.num_hits);
  out.kind = KindOf(out, is_moving);
  if (track.body && is_moving) out.turn_rate_radps = track.body->turn_rate_radps();
  if (scan.own) {
    Encountered(out, *scan.own, *self, params);
    track.overtaking = StillOvertaking(track.overtaking, out);
    if (out.encounter != Encounter::kNone && track.overtaking != Encounter::kNone) out.encounter = track.overtaking;
  }
  return out;
}

}  // namespace

Moving SelfOf(const Pose& own, double turn_rate_radps, const TrackerParams& params) {
  const auto [sine, cosine] = SinCosOf(own.heading_rad);
  const Eigen::Vector2d forward(sine, cosine);
  const Eigen::Vector2d port(-cosine, sine);
  const Eigen::Vector2d place_m = own.position_map_m.head<2>();
  Moving self;
  for (const auto& corner : params.own_hull_m) self.hull_m.emplace_back(place_m + corner.x() * forward + corner.y() * port);
  if (self.hull_m.empty()) self.hull_m.push_back(place_m);
  if (own.velocity_map_mps.allFinite()) self.velocity_mps = own.velocity_map_mps;
  self.turn_rate_radps = turn_rate_radps;
  return self;
}

std::vector<Track> Published(const ScanInput& scan, const TrackerParams& params, const std::optional<Moving>& self, std::deque<Followed>& tracks) {
  std::vector<Track> published;
  for (auto& track : tracks) {
    if (auto one = PublishedOf(scan, params, self, track)) published.push_back(*std::move(one));
  }
  std::ranges::sort(published, {}, &Track::id);
  return published;
}

}  // namespace lookout::tracker
