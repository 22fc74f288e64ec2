#include "services/tracker/core/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "common/core/angles.hpp"
#include "services/tracker/core/publish.hpp"
#include "services/tracker/core/step.hpp"
#include "services/tracker/core/turning.hpp"

namespace lookout::tracker {

namespace {

constexpr double kMostGapOfTimeS = 10.0;  // between scans; beyond, everything begins anew
constexpr double kMostJumpM = 10.0;       // of the own position, beyond the way that its speed explains
constexpr double kTypicalRangeM = 20.0;   // at which an error of heading counts as one of position
constexpr double kLeastSettlingM = 0.1;
constexpr double kWaterlineRangeM = 150.0;
constexpr std::size_t kMostWaterline = 2000;
constexpr std::int64_t kWaterlineEvery = 10;

}  // namespace

struct Tracker::Memory {
  explicit Memory(const TrackerParams& params) : known{Sight(params.T_vessel_lidar, params.reference_point_above_water_m, params.max_range_m)} {}

  Known known;
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

  std::int64_t* WhyAnew(const ScanInput& scan);
  double Advance(const ScanInput& scan);
  std::optional<Moving> Self(const ScanInput& scan, const TrackerParams& params);
  void ForgetEnded();
  void LookAtLand(const Pose& here, const Moving& self, const EncounterParams& params);
};

Tracker::Tracker(const TrackerParams& params) : params_(params), memory_(std::make_unique<Memory>(params)) {}
Tracker::~Tracker() = default;

void Tracker::SetEncounter(const EncounterParams& encounter) { params_.encounter = encounter; }

void Tracker::Reset() {
  memory_->known.tracks.clear();
  memory_->known.together_s.clear();
  memory_->known.ledger.Clear();
  memory_->known.land.Clear();
  memory_->known.land_pieces.Clear();
  memory_->known.clutter = {};
  memory_->known.watched.Clear();
  memory_->known.ground.Clear();
  memory_->time.reset();
  memory_->own.reset();
  memory_->turn.Reset();
  memory_->shore_m.clear();
  memory_->own_m2 = 0.0;
}

bool Tracker::BeginsAnewWith(const ScanInput& scan) const { return memory_->WhyAnew(scan) != nullptr; }

const Picture& Tracker::Update(const ScanInput& scan) {
  Memory& memory = *memory_;
  if (auto* const restarts = memory.WhyAnew(scan)) {
    ++*restarts;
    Reset();
  }
  Step step(params_, scan, memory.known, memory.Advance(scan));
  step.Run();
  const auto self = memory.Self(scan, params_);
  memory.picture = step.TakePicture();
  memory.picture.tracks = Published(scan, params_, self, memory.known.tracks);
  memory.ForgetEnded();
  if (self) memory.LookAtLand(*scan.own, *self, params_.encounter);
  return memory.picture;
}

// Counter of the reason why the tracks are forgotten; nullptr: there is none.
std::int64_t* Tracker::Memory::WhyAnew(const ScanInput& scan) {
  if (!time) return nullptr;
  const double since_s = ToSeconds(scan.end_time - *time);
  if (since_s <= 0.0 || since_s > kMostGapOfTimeS) return &num_restarts_time;
  if (!scan.own || !own) return nullptr;
  if (!scan.datum.IsSameAs(datum)) return &num_restarts_datum;
  const double speed_mps = own->velocity_map_mps.allFinite() ? own->velocity_map_mps.norm() : 0.0;
  const double way_m = (scan.own->position_map_m - own->position_map_m).head<2>().norm();
  return way_m > kMostJumpM + 3.0 * speed_mps * ToSeconds(scan.end_time - own->time) ? &num_restarts_jump : nullptr;
}

// @return seconds since the last scan
double Tracker::Memory::Advance(const ScanInput& scan) {
  const double since_s = time ? ToSeconds(scan.end_time - *time) : 0.0;
  time = scan.end_time;
  if (!scan.own) return since_s;
  own = scan.own;
  datum = scan.datum;
  // A fix after a gap, or a filter that settles, moves everything at once. In a frame that is not on the earth nothing corrects the place.
  const auto& covariance = scan.own->covariance;
  const double now_m2 = covariance(0, 0) + covariance(1, 1) + covariance(4, 4) * kTypicalRangeM * kTypicalRangeM;
  if (!datum.IsRelative() && now_m2 < 0.5 * own_m2 && std::sqrt(own_m2) - std::sqrt(now_m2) > kLeastSettlingM) {
    known.settled_sd_m = std::sqrt(own_m2);
    own_m2 = now_m2;
  }
  own_m2 = std::max(own_m2, now_m2);
  return since_s;
}

std::optional<Moving> Tracker::Memory::Self(const ScanInput& scan, const TrackerParams& params) {
  if (!scan.own) return std::nullopt;
  return SelfOf(*scan.own, turn.Update(scan.end_time, scan.own->heading_rad, scan.own->velocity_map_mps), params);
}

void Tracker::Memory::ForgetEnded() {
  num_confirmed = std::ranges::count_if(known.tracks, &Followed::is_confirmed);
  std::erase_if(known.tracks, [](const Followed& track) { return track.is_ended; });
  std::ranges::sort(known.tracks, {}, &Followed::id);
}

void Tracker::Memory::LookAtLand(const Pose& here, const Moving& self, const EncounterParams& params) {
  const Eigen::Vector2d place_m = here.position_map_m.head<2>();
  known.land.Forget(place_m);
  if (num_scans++ % kWaterlineEvery == 0) {
    picture.waterline_m = known.land.Waterline(place_m, kWaterlineRangeM, kMostWaterline);
    picture.is_waterline_told = true;
    shore_m = picture.waterline_m;
  }
  if (!self.velocity_mps.isZero(0.0)) picture.land_approach = ApproachToLand(here, self, shore_m, params, kOwnVelocitySdMps);
}

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
          {"restarts_by_jump", memory.num_restarts_jump}};
}

}  // namespace lookout::tracker
