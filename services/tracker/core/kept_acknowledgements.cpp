#include "services/tracker/core/kept_acknowledgements.hpp"

#include <algorithm>

namespace lookout::tracker {

namespace {

const Track* FindTrack(std::span<const Track> tracks, std::int64_t id) {
  const auto found = std::ranges::find(tracks, id, &Track::id);
  return found == tracks.end() ? nullptr : &*found;
}

}  // namespace

void KeptAcknowledgements::Keep(Utime time, const Datum& datum, std::span<const Alert> alerts, std::span<const Track> tracks) {
  datum_ = datum;
  kept_.clear();
  for (const auto& alert : alerts) {
    if (alert.state != AlertState::kAcknowledged) continue;
    Kept kept{time, alert.cause, alert.level, std::nullopt, Eigen::Vector2d::Zero()};
    if (alert.track_id == kUnnamed) continue;  // nobody knows what it was
    if (alert.track_id != kLandTrack) {
      const auto* track = FindTrack(tracks, alert.track_id);
      if (track == nullptr) continue;
      kept.position_m = track->position_m;
      kept.velocity_mps = track->velocity_mps;
    }
    kept_.push_back(kept);
  }
}

std::vector<Acknowledgement> KeptAcknowledgements::Take(Utime time, const Datum& datum, std::span<const Alert> alerts,
                                                        std::span<const Track> tracks) {
  std::erase_if(kept_, [&](const Kept& kept) { return time < kept.time || time - kept.time > kKeptFor || !datum.IsSameAs(datum_); });
  std::vector<Acknowledgement> taken;
  for (const auto& alert : alerts) {
    if (alert.state != AlertState::kActive) continue;
    const auto* track = FindTrack(tracks, alert.track_id);
    const auto same = std::ranges::find_if(kept_, [&](const Kept& kept) {
      if (alert.cause != kept.cause || alert.level > kept.level || alert.raised <= kept.time) return false;
      if (alert.track_id == kLandTrack || track == nullptr) return alert.track_id == kLandTrack && !kept.position_m;
      if (!kept.position_m) return false;
      const Eigen::Vector2d expected_m = *kept.position_m + ToSeconds(time - kept.time) * kept.velocity_mps;
      return (track->position_m - expected_m).norm() <= kSamePlaceM;
    });
    if (same == kept_.end()) continue;
    taken.push_back({time, "tracker", alert.id, alert.raised});
    kept_.erase(same);
  }
  return taken;
}

}  // namespace lookout::tracker
