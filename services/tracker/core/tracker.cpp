#include "services/tracker/core/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "common/core/angles.hpp"
#include "services/tracker/core/own_map.hpp"
#include "services/tracker/core/standing.hpp"
#include "services/tracker/core/step.hpp"
#include "services/tracker/core/turning.hpp"

namespace lookout::tracker {

namespace {

constexpr double kMostGapOfTimeS = 10.0;  // between scans; beyond, everything begins anew
constexpr double kMostJumpM = 10.0;       // of the own position, beyond what its speed explains
constexpr double kUnseenEndS = 30.0;      // a confirmed track that could not be seen for so long ends; sooner where it was not followed for as long
constexpr double kLeastUnseenEndS = 2.0;
constexpr int kHardlyKnownHits = 5;
constexpr double kTentativeEndS = 1.0;
constexpr double kHardlyKnownEndS = 0.7;
constexpr double kCoastingS = 1.0;
constexpr double kLineageS = 10.0;
constexpr double kTypicalRangeM = 20.0;  // at which an error of heading counts as one of position
constexpr double kLeastSettlingM = 0.1;
constexpr double kWaterlineRangeM = 150.0;
constexpr std::size_t kMostWaterline = 2000;
constexpr std::int64_t kWaterlineEvery = 10;

}  // namespace

struct Tracker::Memory {
  explicit Memory(const TrackerParams& params) : known{Sight(params.T_vessel_lidar, params.reference_point_above_water_m, params.max_range_m)} {}

  Known known;
  StandingThings standing = {};
  std::optional<Utime> time;
  Datum datum;
  std::optional<Pose> own;
  TurnWatch turn;
  std::vector<Eigen::Vector2d> shore_m;  // remembered land with water before it
  double own_m2 = 0.0;                   // greatest variance of the own place since positions were last taken to have moved together
  Picture picture;
  std::int64_t num_restarts_time = 0;
  std::int64_t num_restarts_datum = 0;
  std::int64_t num_restarts_jump = 0;
  std::int64_t num_confirmed = 0;
  std::int64_t num_scans = 0;
};

namespace {

TrackKind KindOf(const Track& track, bool is_moving) {
  constexpr double kBuoyM = 1.5;
  constexpr double kStructureM = 20.0;
  if (is_moving) return TrackKind::kBoat;
  if (track.seen_share < 0.4) return TrackKind::kUnknown;
  if (track.rectangle.length_m > kStructureM) return TrackKind::kStructure;
  if (track.rectangle.length_m < kBuoyM) return TrackKind::kBuoy;
  return TrackKind::kObstacle;
}

constexpr double kOwnVelocitySdMps = 0.15;  // where POSE is placed

// The own boat, as closest approach sees it.
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

// Of a track as it is published: where it lies from the own boat, and what it will do.
void Encountered(Track& track, const Pose& own, const Moving& self, const TrackerParams& params) {
  constexpr double kStandingMps = 0.05;                 // deviation of what stands: a mooring lets it swing
  constexpr double kTurnsForSureRadps = DegToRad(8.0);  // two deviations of a turn rate that is published
  const auto [sine, cosine] = SinCosOf(own.heading_rad);
  const Eigen::Vector2d forward(sine, cosine);
  const Eigen::Vector2d port(-cosine, sine);
  const Eigen::Vector2d place_m = own.position_map_m.head<2>();
  Moving other{track.outline_m, track.velocity_mps};
  if (std::fabs(track.turn_rate_radps) > kTurnsForSureRadps) other.turn_rate_radps = track.turn_rate_radps;
  RelativeCovariance covariance = RelativeCovariance::Zero();
  covariance.topLeftCorner<2, 2>() = track.covariance_relative_m2;
  covariance.bottomRightCorner<2, 2>() = Eigen::Matrix2d::Identity() * (kOwnVelocitySdMps * kOwnVelocitySdMps);
  if (track.velocity_mps.isZero(0.0)) {
    covariance.bottomRightCorner<2, 2>() += Eigen::Matrix2d::Identity() * (kStandingMps * kStandingMps);
  } else {
    covariance.bottomRightCorner<2, 2>() += track.covariance.bottomRightCorner<2, 2>();
  }
  track.approach = ClosestApproachOf(self, other, covariance, params.encounter);
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

}  // namespace

Tracker::Tracker(const TrackerParams& params) : params_(params), memory_(std::make_unique<Memory>(params)) {}
Tracker::~Tracker() = default;

void Tracker::Reset() {
  memory_->known.tracks.clear();
  memory_->known.together_s.clear();
  memory_->known.ledger.Clear();
  memory_->known.land.Clear();
  memory_->known.land_pieces.Clear();
  memory_->known.clutter = {};
  memory_->known.watched.Clear();
  memory_->standing.ForgetTracks();
  memory_->time.reset();
  memory_->own.reset();
  memory_->turn.Reset();
  memory_->shore_m.clear();
  memory_->own_m2 = 0.0;
}

const Picture& Tracker::Update(const ScanInput& scan) {
  Memory& memory = *memory_;
  if (memory.time) {
    const double dt_s = ToSeconds(scan.end_time - *memory.time);
    if (dt_s <= 0.0 || dt_s > kMostGapOfTimeS) {
      ++memory.num_restarts_time;
      Reset();
    } else if (scan.own && memory.own && !scan.datum.IsSameAs(memory.datum)) {
      ++memory.num_restarts_datum;
      Reset();
    } else if (scan.own && memory.own) {
      const double speed_mps = memory.own->velocity_map_mps.allFinite() ? memory.own->velocity_map_mps.norm() : 0.0;
      const double way_m = (scan.own->position_map_m - memory.own->position_map_m).head<2>().norm();
      if (way_m > kMostJumpM + 3.0 * speed_mps * ToSeconds(scan.end_time - memory.own->time)) {
        ++memory.num_restarts_jump;
        Reset();
      }
    }
  }
  const double dt_s = memory.time ? ToSeconds(scan.end_time - *memory.time) : 0.0;
  memory.time = scan.end_time;
  if (scan.own) {
    memory.own = scan.own;
    memory.datum = scan.datum;
  }
  if (scan.own) {
    // A fix after a gap, or a filter that settles, moves everything at once.
    const auto& covariance = scan.own->covariance;
    const double own_m2 = covariance(0, 0) + covariance(1, 1) + covariance(4, 4) * kTypicalRangeM * kTypicalRangeM;
    if (own_m2 < 0.5 * memory.own_m2 && std::sqrt(memory.own_m2) - std::sqrt(own_m2) > kLeastSettlingM) {
      memory.known.settled_sd_m = std::sqrt(memory.own_m2);
      memory.own_m2 = own_m2;
    }
    if (own_m2 > memory.own_m2) memory.own_m2 = own_m2;
  }
  Step step(params_, scan, memory.known, dt_s);
  step.Run();
  std::optional<Moving> self;
  if (scan.own) {
    const double turn_rate_radps = memory.turn.Update(scan.end_time, scan.own->heading_rad, scan.own->velocity_map_mps);
    self = SelfOf(*scan.own, turn_rate_radps, params_);
  }

  Picture& picture = memory.picture;
  picture = {};
  picture.is_sight_known = step.is_sight_known();
  picture.land_segment_ids = step.land_ids();
  picture.merged = step.merged();
  picture.track_of_piece = step.track_of_piece();
  for (auto& track : memory.known.tracks) {
    const double unseen_s = track.UnseenS(scan.end_time);
    const double existence = track.Existence();
    const bool is_hardly_known = track.num_hits < kHardlyKnownHits;
    const double known_s = std::clamp(ToSeconds(track.seen - track.first), kLeastUnseenEndS, kUnseenEndS);
    const double end_s = !track.is_confirmed ? kTentativeEndS : is_hardly_known ? kHardlyKnownEndS : known_s;
    if (unseen_s > end_s || existence < (track.is_confirmed ? 0.05 : params_.end_probability) ||
        (!track.is_confirmed && track.log_odds < kBirthLogOdds - 1.0))
      track.is_ended = true;
    if (!track.is_confirmed && !track.body) continue;  // it is nothing yet
    Track out;
    out.id = track.PublicId();
    out.status = track.is_ended                               ? TrackStatus::kLost
                 : !track.is_confirmed                        ? TrackStatus::kTentative
                 : unseen_s <= kCoastingS && existence >= 0.5 ? TrackStatus::kConfirmed
                                                              : TrackStatus::kCoasting;
    if (track.is_ended && !track.is_confirmed) continue;
    out.first = track.first;
    out.seen = track.seen;
    const bool is_moving = track.body && track.body->IsMoving(params_.moving_probability);
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
    out.num_looks = static_cast<int>(track.looks.size());
    out.num_seen = static_cast<int>(std::ranges::count(track.looks, true));
    out.mean_returns = track.sum_returns / std::max(1, track.num_hits);
    out.kind = KindOf(out, is_moving);
    if (track.body && is_moving) out.turn_rate_radps = track.body->turn_rate_radps();
    if (scan.own) {
      Encountered(out, *scan.own, *self, params_);
      track.overtaking = StillOvertaking(track.overtaking, out);
      if (out.encounter != Encounter::kNone && track.overtaking != Encounter::kNone) out.encounter = track.overtaking;
    }
    picture.tracks.push_back(std::move(out));
  }
  memory.num_confirmed = std::ranges::count_if(memory.known.tracks, &Followed::is_confirmed);
  std::erase_if(memory.known.tracks, [](const Followed& track) { return track.is_ended; });
  std::ranges::sort(memory.known.tracks, {}, &Followed::id);
  std::ranges::sort(picture.tracks, {}, &Track::id);
  memory.standing.Update(scan, step.is_sight_known() ? &memory.known.sight : nullptr, params_.max_range_m, picture.tracks);
  if (scan.own) {
    memory.known.land.Forget(scan.own->position_map_m.head<2>());
    if (memory.num_scans++ % kWaterlineEvery == 0) {
      picture.waterline_m = memory.known.land.Waterline(scan.own->position_map_m.head<2>(), kWaterlineRangeM, kMostWaterline);
      memory.shore_m = picture.waterline_m;
    }
    if (!self->velocity_mps.isZero(0.0)) {
      picture.land_approach = ApproachToLand(*scan.own, *self, memory.shore_m, params_.encounter, kOwnVelocitySdMps);
    }
  }
  return picture;
}

void Tracker::GiveMap(const OwnMap& map) { memory_->standing.Give(map.things); }

OwnMap Tracker::TakeMap() { return {.things = memory_->standing.TakeChanged(), .land = memory_->known.land.TakeChanged()}; }

std::optional<Utime> Tracker::land_begin() const { return memory_->known.land.begin(); }

std::vector<Counter> Tracker::counters() const {
  const Memory& memory = *memory_;
  return {{"tracks", static_cast<std::int64_t>(memory.known.tracks.size())},
          {"tracks_confirmed", memory.num_confirmed},
          {"clutter_per_scan", std::llround(memory.known.clutter.total())},
          {"obstacles_outdated", memory.known.num_outdated},
          {"tracks_over_limit", memory.known.num_over_limit},
          {"land_tiles", static_cast<std::int64_t>(memory.known.land.num_tiles())},
          {"restarts_by_time", memory.num_restarts_time},
          {"restarts_by_datum", memory.num_restarts_datum},
          {"restarts_by_jump", memory.num_restarts_jump},
          {"map_things_given", memory.standing.num_given()},
          {"map_things_known", memory.standing.num_known_seen()},
          {"map_things_gone", memory.standing.num_gone()},
          {"map_things_over_limit", memory.standing.num_over_limit()}};
}

}  // namespace lookout::tracker
