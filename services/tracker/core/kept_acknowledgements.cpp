#include "services/tracker/core/kept_acknowledgements.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
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
    if (alert.thing == kUnnamed) continue;  // nobody knows what it was
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

std::vector<Acknowledgement> KeptAcknowledgements::Take(Utime time, const Datum& datum, std::span<const Alert> alerts,
                                                        std::span<const Track> tracks) {
  Forget(time);
  std::vector<Acknowledgement> taken;
  for (const auto& alert : alerts) {
    if (alert.state != AlertState::kActive) continue;
    const auto* track = FindTrack(tracks, alert.nearest_track);
    const auto same = std::ranges::find_if(kept_, [&](const Kept& kept) {
      if (alert.level > kept.level || alert.raised <= kept.time || !datum.IsSameAs(kept.datum)) return false;
      if (alert.thing == kLandTrack || track == nullptr) return alert.thing == kLandTrack && !kept.position_m && kept.IsSameLand(alert);
      return kept.position_m && (track->position_m - kept.ExpectedAt(time)).norm() <= kSamePlaceM;
    });
    if (same == kept_.end()) continue;
    taken.push_back({time, "tracker", alert.id, alert.raised});
    // As a caution it may be one that is just seen, and rises.
    if (alert.level == same->level) kept_.erase(same);
  }
  return taken;
}

}  // namespace lookout::tracker
