#include "lab/eval/tracks/alert_run.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/messages/checks.hpp"

namespace lookout::eval {

JudgedAlert ToJudgedAlert(const alert_t& alert) {
  JudgedAlert judged;
  judged.id = alert.id;
  judged.is_of_zone = alert.is_in_zone != 0;
  judged.is_of_approach = alert.comes_near != 0;
  judged.is_warning = alert.level == alert_t::LEVEL_WARNING;
  judged.holds = alert.state == alert_t::STATE_ACTIVE || alert.state == alert_t::STATE_ACKNOWLEDGED;
  judged.is_open = alert.state == alert_t::STATE_ACTIVE;
  judged.track_id = alert.track_id;
  judged.distance_m = static_cast<double>(alert.distance_m);
  judged.bearing_rad = static_cast<double>(alert.bearing_rad);
  judged.text = alert.text;
  return judged;
}

bool IsOfWatch(const alert_t& alert) { return alert.cause == alert_t::CAUSE_WATCH; }

AlertRun::AlertRun(const Truth& truth, Polygon own_hull_m, const AlertRules& rules, CountReturns count_returns)
    : truth_(truth), own_hull_m_(std::move(own_hull_m)), count_returns_(std::move(count_returns)), judge_(rules) {}

bool AlertRun::Add(std::string_view channel, Bytes bytes) {
  if (channel == bus::kTracks.name) {
    const auto message = bus::Decode<tracks_t>(bytes);
    return message && OnTracks(*message);
  }
  if (channel != bus::kAlerts.name) return true;
  const auto message = bus::Decode<alerts_t>(bytes);
  return message && OnAlerts(*message);
}

bool AlertRun::OnTracks(const tracks_t& message) {
  if (!messages::IsWellFormed(message)) return false;
  const MapOrigin origin{message.datum_latitude_deg, message.datum_longitude_deg, message.datum_ellipsoid_height_m};
  if (!std::ranges::all_of(origin, [](double value) { return std::isfinite(value); })) return true;
  if (!alert_truth_ || origin != origin_) {
    origin_ = origin;
    alert_truth_ = std::make_unique<AlertTruth>(truth_, origin, own_hull_m_);
    place_of_.clear();
  }
  for (const auto& track : message.tracks) {
    auto& place = place_of_[track.id];
    place.position_m = {track.position_map_m[0], track.position_map_m[1]};
    place.velocity_mps = {track.velocity_map_mps[0], track.velocity_map_mps[1]};
    place.existence_probability = static_cast<double>(track.existence_probability);
    place.outline_m.clear();
    for (std::size_t i = 0; i < track.outline_east_m.size(); ++i) {
      place.outline_m.emplace_back(static_cast<double>(track.outline_east_m[i]), static_cast<double>(track.outline_north_m[i]));
    }
  }
  return true;
}

bool AlertRun::OnAlerts(const alerts_t& message) {
  if (!std::cmp_equal(message.alerts.size(), message.num_alerts)) return false;
  if (message.is_watch) return true;
  std::optional<AlertScan> scan;
  if (alert_truth_) scan = alert_truth_->At(message.end_utime_us, count_returns_({message.utime_us, message.end_utime_us}));
  for (const auto& alert : message.alerts) {
    if (IsOfWatch(alert)) {
      watch_alerts_.insert(alert.id);
      continue;
    }
    auto judged = ToJudgedAlert(alert);
    judged.sounds = judged.holds && alert.id == message.sounding_alert_id;
    if (!scan) {
      if (judged.holds) early_alerts_.insert(alert.id);
      continue;
    }
    early_alerts_.erase(alert.id);
    const auto place = place_of_.find(judged.track_id);
    if (judged.track_id != 0 && place != place_of_.end()) judged.track = place->second;
    scan->alerts.push_back(std::move(judged));
  }
  if (scan) judge_.Add(*scan);
  return true;
}

void AlertRun::Finish() {
  judge_.Finish();
  scores_ = judge_.scores();
  scores_.num_watch_alerts = static_cast<std::int64_t>(watch_alerts_.size());
  scores_.num_early_alerts = static_cast<std::int64_t>(early_alerts_.size());
}

}  // namespace lookout::eval
