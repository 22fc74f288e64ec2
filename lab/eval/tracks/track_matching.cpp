#include "lab/eval/tracks/track_matching.hpp"

#include <algorithm>
#include <cstddef>

#include "common/core/assignment.hpp"
#include "lab/eval/tracks/track_geometry.hpp"

namespace lookout::eval {
namespace {

using Tracks = std::vector<const TrackState*>;

// A column for each track and one for each thing that stays alone, which costs more than any pair.
void AssignRest(const TrueScan& scan, const Tracks& tracks, const Eigen::MatrixXd& gap_m, Matched& matched, std::vector<bool>& has_thing) {
  constexpr double kShareOfDistance = 0.01;  // decides between hulls that overlap alike
  constexpr double kMostOfDistanceM = 50.0;
  constexpr double kAlone = 1.5 * (kTrackGateM + kShareOfDistance * kMostOfDistanceM);
  constexpr double kImpossible = 1e6;
  std::vector<std::size_t> things;
  for (std::size_t i = 0; i < scan.things.size(); ++i) {
    const auto& thing = scan.things[i];
    if (!thing.is_land && thing.num_returns > 0 && !matched.track_of.contains(thing.id)) things.push_back(i);
  }
  if (things.empty()) return;
  Eigen::MatrixXd cost(static_cast<Eigen::Index>(things.size()), static_cast<Eigen::Index>(tracks.size() + things.size()));
  cost.fill(kAlone);
  for (std::size_t row = 0; row < things.size(); ++row) {
    for (std::size_t k = 0; k < tracks.size(); ++k) {
      const double pair_m = gap_m(static_cast<Eigen::Index>(things[row]), static_cast<Eigen::Index>(k));
      const double distance_m = (scan.things[things[row]].position_m - tracks[k]->position_m).norm();
      cost(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(k)) =
          has_thing[k] || pair_m > kTrackGateM ? kImpossible : pair_m + kShareOfDistance * std::min(distance_m, kMostOfDistanceM);
    }
  }
  const auto assigned = CheapestAssignment(cost);
  for (std::size_t row = 0; row < things.size(); ++row) {
    const auto k = static_cast<std::size_t>(assigned[row]);
    if (k >= tracks.size()) continue;
    matched.track_of[scan.things[things[row]].id] = tracks[k];
    has_thing[k] = true;
  }
}

void Judge(const TrueScan& scan, const Tracks& tracks, const Eigen::MatrixXd& gap_m, const std::vector<bool>& has_thing, Matched& matched) {
  for (std::size_t k = 0; k < tracks.size(); ++k) {
    bool may_be_left_out = has_thing[k];
    bool is_double = false;
    for (std::size_t i = 0; i < scan.things.size(); ++i) {
      const double pair_m = gap_m(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k));
      if (pair_m > kTrackGateM) continue;
      if (IsExpected(scan.things[i])) {
        matched.gap_of_expected_m[{scan.things[i].id, tracks[k]->id}] = pair_m;
        is_double = true;
      } else {
        may_be_left_out = true;
      }
    }
    matched.verdict_of[tracks[k]->id] = may_be_left_out ? Verdict::kExcused : is_double ? Verdict::kDouble : Verdict::kFalse;
  }
  for (const auto& thing : scan.things) {
    const auto track = matched.track_of.find(thing.id);
    if (IsExpected(thing) && track != matched.track_of.end()) matched.verdict_of[track->second->id] = Verdict::kHit;
  }
}

}  // namespace

Polygon OutlineOf(const TrackState& track) { return track.outline_m.empty() ? Polygon{track.position_m} : track.outline_m; }

Matched Matcher::Match(const TrueScan& scan, const std::vector<TrackState>& all_tracks) {
  std::vector<const TrackState*> tracks;
  for (const auto& track : all_tracks) {
    if (track.IsReported()) tracks.push_back(&track);
  }
  Eigen::MatrixXd gap_m(static_cast<Eigen::Index>(scan.things.size()), static_cast<Eigen::Index>(tracks.size()));
  for (std::size_t k = 0; k < tracks.size(); ++k) {
    const auto outline_m = OutlineOf(*tracks[k]);
    for (std::size_t i = 0; i < scan.things.size(); ++i) {
      gap_m(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = HullGap(outline_m, scan.things[i].outline_m, kTrackGateM);
    }
  }
  Matched matched;
  std::vector<bool> has_thing(tracks.size());
  KeepPairs(scan, tracks, gap_m, matched, has_thing);
  AssignRest(scan, tracks, gap_m, matched, has_thing);
  Judge(scan, tracks, gap_m, has_thing, matched);
  before_.clear();
  for (const auto& [id, track] : matched.track_of) before_[id] = track->id;
  return matched;
}

void Matcher::KeepPairs(const TrueScan& scan, const Tracks& tracks, const Eigen::MatrixXd& gap_m, Matched& matched,
                        std::vector<bool>& has_thing) const {
  for (std::size_t i = 0; i < scan.things.size(); ++i) {
    const auto before = before_.find(scan.things[i].id);
    if (before == before_.end() || scan.things[i].is_land) continue;
    const auto track = std::ranges::find(tracks, before->second, [](const TrackState* one) { return one->id; });
    if (track == tracks.end()) continue;
    const auto k = static_cast<std::size_t>(track - tracks.begin());
    if (gap_m(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) > kTrackGateM) continue;
    matched.track_of[scan.things[i].id] = *track;
    has_thing[k] = true;
  }
}

}  // namespace lookout::eval
