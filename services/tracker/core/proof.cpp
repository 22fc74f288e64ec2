#include "services/tracker/core/proof.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "services/tracker/core/beside.hpp"

namespace lookout::tracker {

namespace {

bool Stands(const Track& track) {
  const bool is_confirmed = IsConfirmed(track);
  return is_confirmed && track.velocity_mps.isZero(0.0) && !track.outline_m.empty();
}

bool IsBesideWhatStands(const Track& track, std::span<const Track> tracks, std::span<const Eigen::Vector2d> shore_m, double gap_m) {
  if (track.outline_m.empty()) return false;
  return IsWithinAny(track, shore_m, gap_m) || std::ranges::any_of(tracks, [&track, gap_m](const Track& other) {
           return other.id != track.id && Stands(other) && IsWithin(track, other, gap_m);
         });
}

}  // namespace

Proof::Course Proof::CourseOf(const Track& track, std::span<const Track> tracks, std::span<const Eigen::Vector2d> shore_m) {
  const bool is_beside = IsBesideWhatStands(track, tracks, shore_m, kBesideM);
  return {track.seen, track.position_m, track.seen, 0.0, track.position_m, is_beside, !is_beside, false, false};
}

void Proof::Update(std::span<const Track> tracks, std::span<const Eigen::Vector2d> shore_m) {
  constexpr double kShareOfWay = 0.5;
  constexpr double kMostStepS = 0.2;  // a longer one is a pause
  std::set<std::int64_t> ids;
  for (const auto& track : tracks) {
    if (track.velocity_mps.isZero(0.0)) {
      const auto paused = courses_.find(track.id);
      if (paused != courses_.end() && ToSeconds(track.seen - paused->second.seen) < kPauseS) ids.insert(track.id);
      continue;
    }
    ids.insert(track.id);
    const auto [known, is_new] = courses_.try_emplace(track.id);
    auto& course = known->second;
    if (is_new) course = CourseOf(track, tracks, shore_m);
    const bool is_seen = track.seen != course.seen;
    const double step_s = ToSeconds(track.seen - course.seen);
    course.seen = track.seen;
    if (!is_seen) continue;  // its place is a guess
    course.on_ground_s = track.is_on_ground ? course.on_ground_s + std::min(step_s, kMostStepS) : 0.0;
    if (course.is_proven && course.on_ground_s < kOnGroundS) continue;
    if (track.is_on_ground) {
      // Its way begins anew. What was proven is doubted, but is no piece.
      course.begin = track.seen;
      course.begin_m = course.origin_m = track.position_m;
      course.was_proven = course.was_proven || course.is_proven;
      course.has_left = course.was_proven;
      course.is_proven = false;
      continue;
    }
    const double speed_mps = track.velocity_mps.norm();
    const double seen_s = ToSeconds(track.seen - course.begin);
    const double way_m = (track.position_m - course.begin_m).norm();
    const double gone_m = (track.position_m - course.origin_m).norm();
    const bool is_long_enough = seen_s >= std::clamp(speed_mps / kGainMps2, kLeastS, kMostS);
    const bool gets_there = is_long_enough && way_m >= kShareOfWay * speed_mps * seen_s;
    course.has_left = course.has_left || (gets_there && gone_m >= kLeavesM);
    course.is_proven =
        gets_there && (!course.is_beside || gone_m >= kPassesM || (course.has_left && !IsBesideWhatStands(track, tracks, shore_m, kTouchM)));
    if (course.is_proven || seen_s <= 2.0 * kMostS) continue;
    // The track swung at its mooring: its present run is another course. For a track that leaves slowly, the distance from where it began still
    // counts.
    if (course.is_beside) {
      course.begin = track.seen;
      course.begin_m = track.position_m;
    } else {
      course = CourseOf(track, tracks, shore_m);
    }
  }
  std::erase_if(courses_, [&ids](const auto& item) { return !ids.contains(item.first); });
}

void Proof::Rename(std::int64_t from_track, std::int64_t to_track) {
  auto moved = courses_.extract(from_track);
  if (!moved) return;
  moved.key() = to_track;
  const auto put = courses_.insert(std::move(moved));
  if (put.inserted) return;
  // Two tracks became one: the course keeps what either has proven.
  auto& course = put.position->second;
  course.has_left = course.has_left || put.node.mapped().has_left;
  course.is_proven = course.is_proven || put.node.mapped().is_proven;
  course.was_proven = course.was_proven || put.node.mapped().was_proven;
  course.on_ground_s = std::min(course.on_ground_s, put.node.mapped().on_ground_s);
}

bool Proof::IsProven(const Track& track) const {
  const auto found = courses_.find(track.id);
  return track.velocity_mps.isZero(0.0) || (found != courses_.end() && found->second.is_proven);
}

bool Proof::MayBePiece(std::int64_t track_id) const {
  const auto found = courses_.find(track_id);
  return found != courses_.end() && !found->second.is_proven && !found->second.has_left;
}

}  // namespace lookout::tracker
