// The effect of the own position on the places of obstacles.
#include <algorithm>
#include <cstddef>
#include <utility>

#include "services/tracker/core/step.hpp"

namespace lookout::tracker {

// Obstacles that were placed earlier in the scan, where the own position became much better known within it.
void Step::LeaveOutdated() {
  constexpr double kTimes = 4.0;
  constexpr double kLeastM2 = 0.3 * 0.3;
  const auto own_m2 = [](const Pose& pose) { return std::max(0.0, pose.covariance(0, 0) + pose.covariance(1, 1)); };
  const double limit_m2 = kTimes * own_m2(*scan_.own) + kLeastM2;
  if (scan_.own_at_start && own_m2(*scan_.own_at_start) <= limit_m2) return;
  for (std::size_t i = 0; i < sightings_.size(); ++i) {
    if ((sightings_[i].seen.covariance_m2 - sightings_[i].seen.covariance_relative_m2).trace() <= limit_m2) continue;
    sightings_[i].use = Sighting::Use::kLeftOut;
    has_left_out_ = true;
    ++known_.num_outdated;
  }
}

// The own position became much better known: tracks move by the shift that brings most of them to segments of now. Where too few agree, each may be
// anywhere near.
void Step::Settle() {
  constexpr double kSds = 3.0;
  constexpr double kSameM = 0.5;
  constexpr double kLooseM = 0.2;
  constexpr double kFarM = 1.0;
  constexpr int kLeast = 2;
  constexpr std::size_t kMost = 40;  // tracks, and segments: each pair is tried on all
  const double sd_m = std::exchange(known_.settled_sd_m, 0.0);
  if (sd_m == 0.0) return;
  known_.watched.Clear();
  std::vector<Eigen::Vector2d> from_m;
  std::vector<Eigen::Vector2d> to_m;
  for (const auto& track : known_.tracks) {
    if (track.body && track.UnseenS(scan_.end_time) < 1.5 * dt_s_ && from_m.size() < kMost) from_m.push_back(track.seen_m);
  }
  for (std::size_t i = 0; i < sightings_.size() && to_m.size() < kMost; ++i) {
    if (sightings_[i].use == Sighting::Use::kFree && sightings_[i].seen.is_sure && !sightings_[i].seen.is_land)
      to_m.push_back(sightings_[i].middle_m);
  }
  const auto nearest_to = [&](const Eigen::Vector2d& place_m) {
    const auto nearest = std::ranges::min_element(to_m, {}, [&](const auto& to) { return (to - place_m).squaredNorm(); });
    return nearest == to_m.end() || (*nearest - place_m).norm() > kSameM ? nullptr : &*nearest;
  };
  // Of the tracks that a shift brings to segments: how many, and by how much in the mean.
  const auto brought_by = [&](const Eigen::Vector2d& shift_m) {
    std::pair<int, Eigen::Vector2d> brought(0, Eigen::Vector2d::Zero());
    for (const auto& from : from_m) {
      const auto* to = nearest_to(from + shift_m);
      if (to == nullptr) continue;
      ++brought.first;
      brought.second += *to - from;
    }
    if (brought.first > 0) brought.second /= brought.first;
    return brought;
  };
  auto best = brought_by(Eigen::Vector2d::Zero());
  for (const auto& from : from_m) {
    for (const auto& to : to_m) {
      if ((to - from).norm() > kSds * sd_m) continue;
      if (const auto brought = brought_by(to - from); brought.first > best.first) best = brought;
    }
  }
  const bool is_sure = best.first >= kLeast && 2 * static_cast<std::size_t>(best.first) >= from_m.size();
  const Eigen::Vector2d shift_m = is_sure ? best.second : Eigen::Vector2d::Zero();
  if (shift_m.norm() > kFarM) known_.land_pieces.Clear();
  if (!is_sure || shift_m.norm() > kSameM) {  // its places were elsewhere
    known_.ledger.Clear();
    known_.ground.Clear();
  }
  for (auto& track : known_.tracks) {
    track.seen_m += shift_m;
    track.first_m += shift_m;
    track.middle_m += shift_m;
    for (auto& corner : track.outline_m) corner += shift_m;
    if (!track.body) continue;
    track.body->Translate(shift_m);
    track.surface.Translate(shift_m);
    track.body->Loosen(is_sure && nearest_to(track.seen_m) != nullptr ? kLooseM * kLooseM : sd_m * sd_m);
    Place(track);
  }
}

}  // namespace lookout::tracker
