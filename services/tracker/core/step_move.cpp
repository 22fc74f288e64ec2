// How a track moves.
#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "services/tracker/core/step.hpp"

namespace lookout::tracker {

namespace {

// A seen outline that is farther off, or fits worse, is that of something else too, or of another part: it moves nothing. After so many it is a part.
constexpr double kMostOff = 16.0;
constexpr double kMostMisfit = 9.0;
constexpr int kMisfitsToAddPart = 3;
constexpr double kMovesProbability = 0.95;

double RadiusOf(const std::vector<Eigen::Vector2d>& outline_m, const Eigen::Vector2d& middle_m) {
  double radius = 0.0;
  for (const auto& corner : outline_m) radius = std::max(radius, (corner - middle_m).norm());
  return radius;
}

}  // namespace

void Step::Place(Followed& track) {
  track.outline_m = track.body->Outline();
  track.middle_m = track.body->center_m();
  track.radius_m = RadiusOf(track.outline_m, track.middle_m);
}

// Place and motion by the seen outline.
void Step::Move(Followed& track, std::size_t i, const Seen& seen, const Sides& sides) {
  const auto& sighting = sightings_[i];
  if (!track.body) {
    track.outline_m = seen.outline_m;
    track.middle_m = sighting.middle_m;
    track.radius_m = sighting.radius_m;
    return;
  }
  if (track.body->IsMoving(kMovesProbability)) ++track.num_moving;
  // Where another known track lies in the seen outline, that is not the outline of one thing.
  const bool grows = sighting.use != Sighting::Use::kLand && std::ranges::none_of(known_.tracks, [&](const Followed& other) {
                       return other.is_confirmed && other.id != track.id && IsWithin(other.middle_m, sighting.middle_m, sighting.radius_m) &&
                              Contains(seen.outline_m, other.middle_m);
                     });
  const auto shift = track.body->ShiftOf(seen.outline_m, sides, seen.covariance_relative_m2, sighting.range_m);
  if (shift.off < kMostOff && shift.misfit < kMostMisfit) {
    track.num_misfits = 0;
    track.body->Update(seen.outline_m, sides, seen.covariance_relative_m2, sighting.range_m, grows);
  } else if (++track.num_misfits >= kMisfitsToAddPart) {
    track.num_misfits = 0;
    track.body->AddPart(seen.outline_m, sides, sighting.range_m, shift.off >= kMostOff && !shift.is_part);
    if (params_.without.parts) track.body->KeepSeenPart();
  }
  Place(track);
}

// The returns of all that is not known to move. A drop is one return.
void Step::RememberGround() {
  constexpr std::size_t kLeastReturns = 2;
  known_.ground.Begin(scan_.end_time);
  std::vector<std::uint8_t> moves(sightings_.size(), 0);
  for (const auto& track : known_.tracks) {
    if (track.is_seen_now && track.frame != 0) moves[track.sighting] = 1;
  }
  for (std::size_t i = 0; i < sightings_.size(); ++i) {
    if (moves[i] == 0 && sightings_[i].places_m.size() >= kLeastReturns) known_.ground.Add(sightings_[i].places_m);
  }
}

void Step::LookAtGround() {
  for (auto& track : known_.tracks) {
    const bool moves = track.body && track.is_seen_now && track.body->IsMoving(params_.moving_probability);
    track.is_on_ground = moves && IsOnGround(track);
  }
}

// What moves comes to places that were empty. Whether most of the returns that lead lie where something stood, before the thing can have come there:
// then it is a piece of a quay that is taken for the whole, now this piece and now that, or it went over to what stands.
bool Step::IsOnGround(const Followed& track) const {
  constexpr double kWayM = 1.0;    // ago: farther off than cells that count for a place
  constexpr double kLeadsM = 0.5;  // behind the foremost return
  constexpr double kSlowestMps = 0.1;
  constexpr int kStandsFor = 3;  // half seconds: a crest passes
  const Eigen::Vector2d velocity_mps = track.body->velocity_mps();
  const double speed_mps = std::max(velocity_mps.norm(), kSlowestMps);
  const std::chrono::duration<double> way_s(kWayM / speed_mps);
  const auto before = scan_.end_time - std::chrono::duration_cast<std::chrono::microseconds>(way_s);
  const auto& places_m = sightings_[track.sighting].places_m;
  double foremost_m = -std::numeric_limits<double>::infinity();
  for (const auto& place_m : places_m) foremost_m = std::max(foremost_m, place_m.dot(velocity_mps) / speed_mps);
  int num_leading = 0;
  int num_on_ground = 0;
  for (const auto& place_m : places_m) {
    if (place_m.dot(velocity_mps) / speed_mps < foremost_m - kLeadsM) continue;
    ++num_leading;
    if (known_.ground.TimesMet(place_m, before) >= kStandsFor) ++num_on_ground;
  }
  return 2 * num_on_ground > num_leading;
}

// A moving thing is remembered in a frame of its own, until it has stood for a while.
void Step::ChooseFrame(Followed& track) {
  constexpr double kStandsInFrameS = 2.0;
  constexpr double kMovedM = 1.5;
  if (!track.body || !track.is_confirmed) return;
  if (!track.body->IsMoving(kMovesProbability)) {
    track.stood_s += dt_s_;
    if (track.stood_s > kStandsInFrameS) track.frame = 0;
    return;
  }
  track.stood_s = 0.0;
  if (track.frame == 0 && track.body->moved_m() > kMovedM) track.frame = ++known_.last_frame;
}

}  // namespace lookout::tracker
