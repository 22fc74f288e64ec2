// How a track moves.
#include <algorithm>
#include <limits>
#include <optional>
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

// Place and motion by the seen outline and surface.
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
  MoveBySurface(track, sighting, sides, grows);
  Place(track);
}

// @param is_one  the returns are those of one thing: a boat beside a quay would be found to move as much as both do together
void Step::MoveBySurface(Followed& track, const Sighting& sighting, const Sides& sides, bool is_one) const {
  if (params_.without.surface) return;
  if (!is_one && track.body->IsMoving(0.5)) {
    track.surface.Clear();
    return;
  }
  std::optional<Eigen::Vector2d> velocity_mps;
  if (!sides.is_left_hidden && !sides.is_right_hidden) velocity_mps = track.body->velocity_mps();
  const auto surface = track.surface.Update(sighting.seen.time, sighting.places_m, sighting.heights_m, velocity_mps);
  if (surface) track.body->Update(*surface, sides, sighting.seen.covariance_relative_m2, sighting.range_m);
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
