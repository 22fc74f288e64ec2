// Nearest neighbour and nothing more: enough to run the process around it. To be replaced.
#include "services/tracker/core/tracker.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "services/tracker/core/alerts.hpp"

namespace lookout::tracker {

struct Tracker::Memory {
  Picture picture;
  std::int64_t next_id = 1;
  std::optional<Utime> last;
  Datum datum;
  std::int64_t num_resets = 0;
};

Tracker::Tracker(const TrackerParams& params) : params_(params), memory_(std::make_unique<Memory>()) {}
Tracker::~Tracker() = default;

void Tracker::Reset() {
  const auto next_id = memory_->next_id;
  const auto num_resets = memory_->num_resets + 1;
  *memory_ = {};
  memory_->next_id = next_id;
  memory_->num_resets = num_resets;
}

const Picture& Tracker::Update(const ScanInput& scan) {
  auto& memory = *memory_;
  if (memory.last &&
      (scan.end_time <= *memory.last || scan.end_time - *memory.last > std::chrono::seconds(10) || !scan.datum.IsSameAs(memory.datum))) {
    Reset();
  }
  const double dt_s = memory.last ? ToSeconds(scan.end_time - *memory.last) : 0.0;
  memory.last = scan.end_time;
  memory.datum = scan.datum;
  auto& picture = memory.picture;
  picture.is_sight_known = scan.sweep.has_value();
  picture.land_segment_ids.clear();
  picture.merged.clear();
  std::erase_if(picture.tracks, [](const Track& track) { return track.status == TrackStatus::kLost; });
  for (auto& track : picture.tracks) {
    track.position_m += dt_s * track.velocity_mps;
    track.segment_ids.clear();
    track.num_looks = std::min(track.num_looks + 1, 15);
  }
  for (const auto& seen : scan.seen) {
    if (seen.is_land) {
      picture.land_segment_ids.push_back(seen.segment_id);
      continue;
    }
    constexpr double kGateM = 4.0;
    Track* nearest = nullptr;
    double nearest_m = kGateM;
    for (auto& track : picture.tracks) {
      const double distance_m = (track.position_m - seen.position_m).norm();
      if (track.segment_ids.empty() && distance_m < nearest_m) {
        nearest = &track;
        nearest_m = distance_m;
      }
    }
    if (nearest == nullptr) {
      if (!seen.is_sure) continue;
      nearest = &picture.tracks.emplace_back();
      nearest->id = memory.next_id++;
      nearest->first = seen.time;
      nearest->position_m = seen.position_m;
    }
    Track& track = *nearest;
    track.seen = seen.time;
    track.segment_ids = {seen.segment_id};
    track.num_seen = std::min(track.num_seen + 1, 15);
    track.position_m += 0.3 * (seen.position_m - track.position_m);
    track.covariance.topLeftCorner<2, 2>() = seen.covariance_m2;
    track.covariance_relative_m2 = seen.covariance_relative_m2;
    track.outline_m = seen.outline_m;
    track.top_above_water_m = seen.top_above_water_m;
    track.mean_returns = seen.num_returns;
    track.existence_probability = track.num_seen >= 3 ? 0.99 : 0.5;
    track.status = track.num_seen >= 3 ? TrackStatus::kConfirmed : TrackStatus::kTentative;
  }
  for (auto& track : picture.tracks) {
    if (scan.end_time - track.seen > std::chrono::seconds(1)) track.status = TrackStatus::kLost;
    if (!scan.own) continue;
    const Eigen::Vector2d from_own_m = track.position_m - scan.own->position_map_m.head<2>();
    track.range_m = from_own_m.norm();
    track.bearing_rad = WrapTo2Pi(Atan2(from_own_m.x(), from_own_m.y()) - scan.own->heading_rad);
    track.approach.distance_m = track.approach.cpa_m = track.range_m;
    track.approach.probability = track.range_m < 30.0 ? 1.0 : 0.0;
  }
  return picture;
}

std::vector<Counter> Tracker::counters() const {
  const auto& tracks = memory_->picture.tracks;
  return {{"tracks", std::ssize(tracks)},
          {"tracks_confirmed", std::ranges::count(tracks, TrackStatus::kConfirmed, &Track::status)},
          {"tracker_resets", memory_->num_resets}};
}

Alerts::Alerts(const AlertParams& params) : params_(params) {}

const std::vector<Alert>& Alerts::Update(Utime time, bool /*is_whole*/, const std::vector<Danger>& dangers) {
  std::erase_if(alerts_, [](const Alert& alert) { return alert.state == AlertState::kCleared; });
  for (auto& alert : alerts_) {
    const bool holds =
        std::ranges::any_of(dangers, [&alert](const Danger& danger) { return danger.cause == alert.cause && danger.track_id == alert.track_id; });
    if (!holds) alert.state = AlertState::kCleared;
  }
  for (const auto& danger : dangers) {
    if (danger.probability < params_.raise_probability) continue;
    auto found =
        std::ranges::find_if(alerts_, [&danger](const Alert& alert) { return alert.cause == danger.cause && alert.track_id == danger.track_id; });
    if (found == alerts_.end()) {
      static_assert(sizeof(std::int64_t) == 8);
      found = alerts_.insert(alerts_.end(), Alert{});
      found->id = ToUtimeUs(time) % 1'000'000'000 + static_cast<std::int64_t>(alerts_.size());
      found->cause = danger.cause;
      found->track_id = danger.track_id;
      found->raised = found->changed = time;
      found->level = AlertLevel::kWarning;
    }
    found->distance_m = danger.distance_m;
    found->bearing_rad = danger.bearing_rad;
    found->cpa_m = danger.cpa_m;
    found->tcpa_s = danger.tcpa_s;
    found->cpa_probability = danger.probability;
  }
  return alerts_;
}

bool Alerts::Acknowledge(const Acknowledgement& acknowledgement, Utime time) {
  for (auto& alert : alerts_) {
    if (alert.id != acknowledgement.alert_id || alert.raised != acknowledgement.raised || alert.state != AlertState::kActive) continue;
    alert.state = AlertState::kAcknowledged;
    alert.changed = time;
    return true;
  }
  return false;
}

void Alerts::Rename(std::int64_t from_track, std::int64_t to_track) {
  for (auto& alert : alerts_) {
    if (alert.track_id == from_track) alert.track_id = to_track;
  }
}

}  // namespace lookout::tracker
