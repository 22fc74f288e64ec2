#include "services/tracker/core/kept_acknowledgements.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <tuple>
#include <utility>

#include "common/core/angles.hpp"

namespace lookout::tracker {

namespace {

const Track* FindTrack(std::span<const Track> tracks, std::int64_t id) {
  const auto found = std::ranges::find(tracks, id, &Track::id);
  return found == tracks.end() ? nullptr : &*found;
}

}  // namespace

Eigen::Vector2d KeptAcknowledgements::Kept::ExpectedAt(Utime at) const { return position_m.value() + ToSeconds(at - time) * velocity_mps; }

// False where a distance or bearing is not known.
bool KeptAcknowledgements::Kept::IsSameLand(const Alert& alert) const {
  constexpr double kSameSideRad = DegToRad(60.0);
  return alert.distance_m >= 0.5 * distance_m && std::fabs(WrapToPi(alert.bearing_rad - bearing_rad)) <= kSameSideRad;
}

void KeptAcknowledgements::Keep(Utime time, const Datum& datum, std::span<const Alert> alerts, std::span<const Track> tracks) {
  Forget(time);
  auto older = std::exchange(kept_, {});
  for (const auto& alert : alerts) {
    if (alert.state != AlertState::kAcknowledged) continue;
    Kept kept{time, datum, alert.level, std::nullopt, Eigen::Vector2d::Zero(), alert.distance_m, alert.bearing_rad};
    if (alert.thing == kUnnamed) continue;  // nobody knows which thing it was
    if (alert.thing != kLandTrack) {
      const auto* track = FindTrack(tracks, alert.nearest_track);
      if (track == nullptr) continue;
      kept.position_m = track->position_m;
      kept.velocity_mps = track->velocity_mps;
    }
    if (const auto same = FindSame(older, kept); same != older.end()) older.erase(same);
    kept_.push_back(kept);
  }
  std::ranges::move(older, std::back_inserter(kept_));
}

void KeptAcknowledgements::Forget(Utime time) {
  std::erase_if(kept_, [time](const Kept& kept) { return time < kept.time || time - kept.time > kKeptFor; });
}

std::vector<KeptAcknowledgements::Kept>::iterator KeptAcknowledgements::FindSame(std::vector<Kept>& older, const Kept& kept) {
  auto same = older.end();
  double least_m = kSamePlaceM;
  for (auto one = older.begin(); one != older.end(); ++one) {
    if (one->position_m.has_value() != kept.position_m.has_value() || !one->datum.IsSameAs(kept.datum)) continue;
    const double distance_m = kept.position_m ? (*kept.position_m - one->ExpectedAt(kept.time)).norm() : 0.0;
    if (distance_m > least_m) continue;
    same = one;
    least_m = distance_m;
  }
  return same;
}

// How far an active alert is from where it is expected; nullopt: it is of something else, or graver, or was there before.
std::optional<double> KeptAcknowledgements::DistanceTo(const Kept& kept, Utime time, const Alert& alert, const Track* track) {
  if (alert.level > kept.level || alert.raised <= kept.time) return std::nullopt;
  if (kept.alert_id.value_or(alert.id) != alert.id) return std::nullopt;
  if (!kept.position_m) return alert.thing == kLandTrack && kept.IsSameLand(alert) ? std::optional(0.0) : std::nullopt;
  if (alert.thing == kLandTrack || track == nullptr) return std::nullopt;
  const double distance_m = (track->position_m - kept.ExpectedAt(time)).norm();
  return distance_m <= kSamePlaceM ? std::optional(distance_m) : std::nullopt;
}

std::vector<Acknowledgement> KeptAcknowledgements::Take(Utime time, const Datum& datum, std::span<const Alert> alerts,
                                                        std::span<const Track> tracks) {
  Forget(time);
  struct Pair {
    double distance_m;
    std::size_t kept;
    std::size_t alert;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < alerts.size(); ++i) {
    if (kept_.empty() || alerts[i].state != AlertState::kActive) continue;
    const auto* track = FindTrack(tracks, alerts[i].nearest_track);
    for (std::size_t k = 0; k < kept_.size(); ++k) {
      const auto distance_m = datum.IsSameAs(kept_[k].datum) ? DistanceTo(kept_[k], time, alerts[i], track) : std::nullopt;
      if (distance_m) pairs.push_back({*distance_m, k, i});
    }
  }
  std::ranges::sort(pairs, {}, [](const Pair& pair) { return std::tuple(pair.distance_m, pair.kept, pair.alert); });
  std::vector<Acknowledgement> taken;
  std::vector<bool> is_used(kept_.size(), false);
  std::vector<bool> is_taken(alerts.size(), false);
  std::vector<bool> is_done(kept_.size(), false);
  for (const auto& pair : pairs) {
    if (is_used[pair.kept] || is_taken[pair.alert]) continue;
    is_used[pair.kept] = is_taken[pair.alert] = true;
    const auto& alert = alerts[pair.alert];
    auto& kept = kept_[pair.kept];
    taken.push_back({time, "tracker", alert.id, alert.raised});
    kept.alert_id = alert.id;
    // As a caution it may be one that is just seen, and rises.
    is_done[pair.kept] = alert.level == kept.level;
  }
  std::vector<Kept> left;
  left.reserve(kept_.size());
  for (std::size_t k = 0; k < kept_.size(); ++k) {
    if (!is_done[k]) left.push_back(kept_[k]);
  }
  kept_ = std::move(left);
  return taken;
}

}  // namespace lookout::tracker
