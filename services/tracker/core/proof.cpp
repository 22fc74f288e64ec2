#include "services/tracker/core/proof.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace lookout::tracker {

void Proof::Update(std::span<const Track> tracks) {
  constexpr double kShareOfWay = 0.5;
  std::set<std::int64_t> ids;
  for (const auto& track : tracks) {
    if (track.velocity_mps.isZero(0.0)) continue;
    ids.insert(track.id);
    auto& course = courses_.try_emplace(track.id, Course{track.seen, track.position_m, false}).first->second;
    const double speed_mps = track.velocity_mps.norm();
    const double seen_s = ToSeconds(track.seen - course.begin);
    const double way_m = (track.position_m - course.begin_m).norm();
    const bool is_long_enough = seen_s >= std::clamp(speed_mps / kGainMps2, kLeastS, kMostS);
    if (is_long_enough && way_m >= kShareOfWay * speed_mps * seen_s) course.is_proven = true;
    // It swung at its mooring; how it runs now is another course.
    if (!course.is_proven && seen_s > 2.0 * kMostS) course = {track.seen, track.position_m, false};
  }
  std::erase_if(courses_, [&ids](const auto& item) { return !ids.contains(item.first); });
}

void Proof::Rename(std::int64_t from_track, std::int64_t to_track) {
  auto moved = courses_.extract(from_track);
  if (!moved) return;
  moved.key() = to_track;
  courses_.insert(std::move(moved));
}

bool Proof::IsProven(const Track& track) const {
  if (track.velocity_mps.norm() <= kFastMps) return true;
  const auto found = courses_.find(track.id);
  return found != courses_.end() && found->second.is_proven;
}

}  // namespace lookout::tracker
