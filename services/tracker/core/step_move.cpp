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

// What moves comes to places that were empty. A piece of a quay that is taken for the whole, now this piece and now that, seems to move to places
// where the quay was before.
void Step::LookAtWays() {
  constexpr double kWayM = 1.0;  // ago: farther off than returns that count for the place
  constexpr double kSlowestMps = 0.1;
  for (auto& track : known_.tracks) track.way = {};
  if (!is_sight_known_ || params_.without.watched_water) return;
  std::vector<const Followed*> leaders;
  std::vector<std::pair<Followed*, Eigen::Vector2d>> doubted;  // and their foremost places
  for (auto& track : known_.tracks) {
    if (track.outline_m.empty() || !track.body || !track.body->IsMoving(params_.moving_probability)) continue;
    if (!track.is_seen_now) {  // hidden by its tow, or missed
      if (track.is_confirmed) leaders.push_back(&track);
      continue;
    }
    const Eigen::Vector2d velocity_mps = track.body->velocity_mps();
    const double speed_mps = std::max(velocity_mps.norm(), kSlowestMps);
    const Eigen::Vector2d place_m = ForemostOf(track, velocity_mps / speed_mps);
    const std::chrono::duration<double> way_s(kWayM / speed_mps);
    track.way = known_.watched.OfWay(place_m, track.top_m, scan_.end_time - std::chrono::duration_cast<std::chrono::microseconds>(way_s));
    if (WasThere(track.way)) {
      doubted.emplace_back(&track, place_m);
    } else if (track.is_confirmed) {
      leaders.push_back(&track);
    }
  }
  // Where a boat was that leads or tows, its follower comes to; and others behind that. Two pieces of a quay do not excuse each other.
  for (std::size_t i = 0; i < leaders.size(); ++i) {
    std::erase_if(doubted, [&](const auto& follower) {
      auto* const track = follower.first;
      if (!HasGoneBefore(*leaders[i], follower.second)) return false;
      track->way = {};
      if (track->is_confirmed) leaders.push_back(track);
      return true;
    });
  }
}

// Of the corners that lead the nearest to the lidar: the far side is assumed, and what stands behind it is near.
Eigen::Vector2d Step::ForemostOf(const Followed& track, const Eigen::Vector2d& ahead) const {
  constexpr double kLeadsM = 0.5;
  double most_m = -std::numeric_limits<double>::infinity();
  for (const auto& corner : track.outline_m) most_m = std::max(most_m, corner.dot(ahead));
  const Eigen::Vector2d own_m = scan_.own->position_map_m.head<2>();
  Eigen::Vector2d foremost_m = track.middle_m;
  double least_m = std::numeric_limits<double>::infinity();
  for (const auto& corner : track.outline_m) {
    const double range_m = (corner - own_m).norm();
    if (corner.dot(ahead) < most_m - kLeadsM || range_m >= least_m) continue;
    least_m = range_m;
    foremost_m = corner;
  }
  return foremost_m;
}

// Whether it was at the place in the last seconds.
bool Step::HasGoneBefore(const Followed& leader, const Eigen::Vector2d& place_m) {
  constexpr double kOfWakeM = 1.0;
  const Eigen::Vector2d back_m = -WatchedWater::kKeptS * leader.body->velocity_mps();
  const Eigen::Vector2d off_m = place_m - leader.middle_m;
  const double share = std::clamp(off_m.dot(back_m) / std::max(back_m.squaredNorm(), 0.01), 0.0, 1.0);
  return (off_m - share * back_m).norm() < leader.radius_m + kOfWakeM;
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
