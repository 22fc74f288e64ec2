// Which track belongs to which true thing, scan after scan.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "lab/eval/tracks/track_scan.hpp"

namespace lookout::eval {

/// A track may belong to a thing no farther than this, hull to hull. Outlines seen from one side and true ones overlap but for errors of position, so
/// that IoU says little of small things: a buoy of 0.5 m that is 0.5 m off has none.
inline constexpr double kTrackGateM = 2.0;
/// Returns from which on a thing in the water must be tracked; one with fewer may be, and counts neither way.
inline constexpr int kMinReturnsOfExpected = 5;

/// Must be tracked in this scan.
inline bool IsExpected(const TrueThing& thing) { return thing.is_in_water && thing.num_returns >= kMinReturnsOfExpected; }

/// Outline of a track; where the track states none, its place.
Polygon OutlineOf(const TrackState& track);

/// Verdict on a reported track. Hit: the one track of a thing that must be tracked. Double: a further track of such a thing. Excused: a track of
/// something else that is there (fewer returns, hidden, dock, pier, land), which need not be tracked. False: of nothing.
enum class Verdict { kHit, kExcused, kDouble, kFalse };
inline constexpr std::size_t kNumVerdicts = 4;

/// Matches of one scan.
struct Matched {
  std::map<int, const TrackState*> track_of;                         // by id of the thing, also of one that need not be tracked
  std::map<std::int64_t, Verdict> verdict_of;                        // of reported tracks, by id
  std::map<std::pair<int, std::int64_t>, double> gap_of_expected_m;  // thing, track: within the gate
};

/// Pairs of the scan before stay while they are within the gate (CLEAR MOT); the others are assigned so that as many as can have a partner, and the
/// gaps between hulls, and then the distances of centres, are least in sum. Things that need not be tracked take part, since a track that is nearer
/// to one of them is not a hit of another. Land takes none, and a thing without a return now takes no new one: a track that lies there is left out.
/// Cost: things x tracks x corners per scan.
class Matcher {
 public:
  /// @param all_tracks  outlive the result
  Matched Match(const TrueScan& scan, const std::vector<TrackState>& all_tracks);

 private:
  using Tracks = std::vector<const TrackState*>;

  void KeepPairs(const TrueScan& scan, const Tracks& tracks, const Eigen::MatrixXd& gap_m, Matched& matched, std::vector<bool>& has_thing) const;

  std::map<int, std::int64_t> before_;  // thing, track
};

}  // namespace lookout::eval
