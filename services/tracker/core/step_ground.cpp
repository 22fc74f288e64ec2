// Where something stands, and what seems to move there.
#include <algorithm>
#include <limits>
#include <vector>

#include "services/tracker/core/step.hpp"

namespace lookout::tracker {

// Remembers where sure segments and confirmed tracks are that are not known to move. Wakes and crests, into which a boat may come, are hardly ever
// sure; a drop is one return. The own gear goes along with the boat, and another boat may come where it was.
void Step::RememberGround() {
  constexpr std::size_t kLeastReturns = 2;
  known_.ground.Begin(scan_.end_time);
  std::vector<std::uint8_t> stands(sightings_.size(), 0);
  for (std::size_t i = 0; i < sightings_.size(); ++i) {
    const bool is_left_out = sightings_[i].use == Sighting::Use::kLeftOut || sightings_[i].seems_moving;
    stands[i] = sightings_[i].seen.is_sure && !is_left_out && !IsAtOwnHull(sightings_[i]) ? 1 : 0;
  }
  for (const auto& track : known_.tracks) {
    if (track.is_confirmed && track.frame == 0 && track.is_seen_now) stands[track.sighting] = 1;
  }
  // A moving track may come in several segments, and have parts that are no known track.
  for (const auto& track : known_.tracks) {
    if (track.frame == 0) continue;
    for (const std::int32_t number : track.segment_ids) stands[static_cast<std::size_t>(number - 1)] = 0;
    for (std::size_t i = 0; i < sightings_.size(); ++i) {
      const bool is_free = sightings_[i].use == Sighting::Use::kFree;
      if (is_free && IsWithin(sightings_[i].middle_m, track.middle_m, track.radius_m) && Contains(track.outline_m, sightings_[i].middle_m))
        stands[i] = 0;
    }
  }
  for (std::size_t i = 0; i < sightings_.size(); ++i) {
    if (stands[i] != 0 && sightings_[i].places_m.size() >= kLeastReturns) known_.ground.Add(sightings_[i].places_m, sightings_[i].heights_m);
  }
}

void Step::LookAtGround() {
  for (auto& track : known_.tracks) {
    if (!track.is_seen_now) continue;  // as before
    track.is_on_ground = track.body && track.body->IsMoving(params_.moving_probability) && IsOnGround(track);
  }
}

// A moving thing enters cells that were empty. True if most of the returns in its foremost 0.5 m lie in cells where something stood before the thing
// can have got there: then the track jumps between pieces of a quay, or has slipped onto something standing.
bool Step::IsOnGround(const Followed& track) const {
  constexpr double kWayM = 1.0;    // that the track goes meanwhile: what stood there before is ground
  constexpr double kLeadsM = 0.5;  // behind the foremost return
  constexpr double kSlowestMps = 0.1;
  constexpr int kStandsFor = 3;  // half seconds: a crest passes
  const Eigen::Vector2d velocity_mps = track.body->velocity_mps();
  const double speed_mps = std::max(velocity_mps.norm(), kSlowestMps);
  const std::chrono::duration<double> way_s(kWayM / speed_mps);
  const auto before = scan_.end_time - std::chrono::duration_cast<std::chrono::microseconds>(way_s);
  const auto& sighting = sightings_[track.sighting];
  double foremost_m = -std::numeric_limits<double>::infinity();
  for (const auto& place_m : sighting.places_m) foremost_m = std::max(foremost_m, place_m.dot(velocity_mps) / speed_mps);
  int num_leading = 0;
  int num_on_ground = 0;
  for (std::size_t i = 0; i < sighting.places_m.size(); ++i) {
    if (sighting.places_m[i].dot(velocity_mps) / speed_mps < foremost_m - kLeadsM) continue;
    ++num_leading;
    const double height_m = sighting.heights_m.empty() ? 0.0 : sighting.heights_m[i];
    if (known_.ground.TimesMet(sighting.places_m[i], height_m, before) >= kStandsFor) ++num_on_ground;
  }
  return 2 * num_on_ground > num_leading;
}

}  // namespace lookout::tracker
