// Scores of tracks against the truth, of whole runs. README.md, "Tracks", says the same in words.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tools/eval/metrics.hpp"
#include "tools/eval/track_gospa.hpp"
#include "tools/eval/track_scan.hpp"

namespace lookout::eval {

/// A track may belong to a thing no farther than this, hull to hull. Outlines of what is seen from one side and of what is true overlap but for
/// errors of position, so that IoU says little of small things: a buoy of 0.5 m that is 0.5 m off has none.
inline constexpr double kTrackGateM = 2.0;
/// Returns from which on a thing in the water must be tracked; one with fewer may be, and counts neither way.
inline constexpr int kMinReturnsOfExpected = 5;

/// What costs MOTA in a scan, for people who look for the reason.
struct TrackEvent {
  enum class What { kMissed, kFalse, kSwitch };
  What what = What::kMissed;
  std::int64_t utime_us = 0;
  int thing = 0;                                         // 0 = none
  int num_returns = 0;                                   // of the thing
  std::int64_t track = 0;                                // 0 = none
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  // of the thing; of a false track
};

/// Figures of one run, or of several (Add).
struct TrackScores {
  std::int64_t num_runs = 0;
  double seconds = 0.0;

  // CLEAR MOT: K. Bernardin, R. Stiefelhagen, "Evaluating multiple object tracking performance", EURASIP J. Image and Video Processing 2008.
  std::int64_t num_expected = 0;  // things that must be tracked, over all scans
  std::int64_t num_missed = 0;
  std::int64_t num_false = 0;  // reported tracks on nothing, or on a thing that has another track already
  std::int64_t num_switches = 0;
  std::int64_t num_runs_without_switch = 0;
  // E. Ristani et al., "Performance measures and a data set for multi-target, multi-camera tracking", ECCV Workshops 2016.
  std::int64_t num_id_true = 0;
  std::int64_t num_id_tracked = 0;    // reported, and not left out
  std::int64_t num_false_tracks = 0;  // ids that are false in most of the scans in which they are reported
  Gospa gospa{.num_scans = 0};

  // From the first return to the first scan with a reported track: [0] of 5 returns or more a scan (median), [1] of 1 to 4. Infinite: never.
  std::array<Summary, 2> confirmed_s;
  // Between two scans in which a thing had 5 returns or more lay 1 to 10 s with scans without any: the track is the same within 1 s.
  std::int64_t num_hidden = 0;
  std::int64_t num_found_again = 0;

  // Squared error over the stated covariance, per degree of freedom; 1 = as stated. Velocity: of tracks that move.
  Mean position_nees;
  Mean velocity_nees;
  std::int64_t num_bad_covariances = 0;  // not positive definite

  Mean standing_speed_mps;  // things that stand all the run, land apart
  std::int64_t num_standing = 0;
  std::int64_t num_called_moving = 0;  // of these, by a reported track in any scan
  // Of things above 0.5 m/s with 5 returns or more, 3 s after their first track. Course: where the track moves.
  Summary speed_error_mps;
  Summary course_error_deg;
  Mean called_standing;
  Summary center_error_m;  // of things in the water of 3 m or more, 3 s after their first track: lidar sees but a side of them

  // Of what moves and comes nearer, at the scan in which the true TCPA falls below 10 s: both truly keep course and speed from there.
  Mean cpa_error_m;
  Mean tcpa_error_s;
  std::int64_t num_crossings = 0;
  std::int64_t num_crossings_untracked = 0;

  std::vector<TrackEvent> events;  // in the order of time; Add leaves those of the other out

  /// Both 0 to 1 (MOTA also below 0); NaN where nothing had to be tracked.
  double Mota() const;
  double Idf1() const;
  double FalseTracksPerMinute() const;
  void Add(const TrackScores& other);
};

/// @param truth   scans of a run in the order of time
/// @param tracks  [scans] what the tracker said after each
/// Who belongs to whom in a scan: pairs of the scan before stay while they are within the gate (CLEAR MOT); the others are assigned so that as many
/// as can have a partner, and the gaps between hulls, and then the distances of centres, are least in sum. Things that need not be tracked (fewer
/// returns, docks, piers) take part, since a track that is nearer to one of them is not a hit of another. A track that is left counts as false,
/// unless it is within the gate of such a thing or of land. Cost: things x tracks x corners per scan.
TrackScores ScoreTracks(std::span<const TrueScan> truth, std::span<const std::vector<TrackState>> tracks);

}  // namespace lookout::eval
