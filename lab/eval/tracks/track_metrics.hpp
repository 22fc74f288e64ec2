// Scores of tracks against the truth, of whole runs. TRACKS.md says the same in words.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lab/eval/metrics.hpp"
#include "lab/eval/tracks/hota.hpp"
#include "lab/eval/tracks/track_gospa.hpp"
#include "lab/eval/tracks/track_matching.hpp"
#include "lab/eval/tracks/track_scan.hpp"
#include "lab/eval/tracks/trajectory_gospa.hpp"

namespace lookout::eval {

/// When another boat is too near: limits of the boat's tracker (cpa_limit_m and look_ahead_s of tracker.txtpb; these are its defaults).
struct ApproachLimits {
  double limit_m = 5.0;  // hull to hull
  double look_ahead_s = 30.0;
};

/// Errors in a scan, for people who look for the reason: those that cost MOTA, standing things that are said to move, and moving ones that are said
/// to stand.
struct TrackEvent {
  enum class What { kMissed, kFalse, kSwitch, kMoving, kStanding, kApproach };
  What what = What::kMissed;
  std::int64_t utime_us = 0;
  int thing = 0;                                         // 0 = none
  int num_returns = 0;                                   // of the thing
  std::int64_t track = 0;                                // 0 = none
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  // of the thing; of a false track
  // Of a false track the thing, of a missed thing the track (of any status) whose hull is nearest, and the gap; of a switch the track before; 0 =
  // none.
  std::int64_t nearest = 0;
  double nearest_gap_m = 0.0;
  double speed_mps = 0.0;  // as the track says; of a thing that is said to stand, the true one; of an approach, the error of the velocity
};

/// Probabilities, and whether it came so, in ten bins.
struct Calibration {
  struct Bin {
    Mean stated;
    Mean came_true;
  };
  std::array<Bin, 10> bins;

  void Add(double probability, bool came_true);
  void Add(const Calibration& other);
  std::int64_t count() const;
  /// Expected calibration error: |mean stated - share that came true|, over the bins by their counts. NaN without any.
  double Error() const;
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
  std::int64_t num_id_tracked = 0;     // reported, and not left out
  std::int64_t num_false_tracks = 0;   // ids that are false in most of the scans in which they are reported
  std::int64_t num_double_tracks = 0;  // of these, those that lie on a thing that has another track
  Mean has_double;                     // share of the scans: a thing that must be tracked has a further track
  std::int64_t num_reported_ids = 0;   // tracks that were ever reported
  std::int64_t greatest_ids = 0;       // the greatest id of these; sum over the runs
  Hota hota;
  Gospa gospa{.num_scans = 0};
  TrajectoryGospa trajectory_gospa;

  // From the first return to the first scan with a reported track: [0] of 5 returns or more a scan (median), [1] of 1 to 4. Infinite: never.
  std::array<Summary, 2> confirmed_s;
  // Of buoys that came within kNearBuoyM of the middle of the own boat and had a return in the kNearBuoyS from then on: had a track by then.
  static constexpr double kNearBuoyM = 25.0;
  static constexpr double kNearBuoyS = 2.0;
  Mean near_buoy_tracked;
  // Between two scans in which a thing had 5 returns or more lay 1 to 10 s with scans without any: the track is the same within 1 s.
  std::int64_t num_hidden = 0;
  std::int64_t num_found_again = 0;

  // Squared error over the stated covariance, per degree of freedom; 1 = as stated. Velocity: of tracks that move.
  Mean position_nees;
  Mean velocity_nees;
  std::int64_t num_things_with_covariance = 0;
  std::int64_t num_bad_covariances = 0;  // not positive definite

  Mean standing_speed_mps;  // things that stand all the run, land apart
  std::int64_t num_standing = 0;
  std::int64_t num_called_moving = 0;  // of these, by a reported track in any scan
  // Of things above 0.5 m/s with 5 returns or more, 3 s after their first track. Course: where the track moves.
  Summary speed_error_mps;
  Summary course_error_deg;
  Mean called_standing;
  // Of things in the water of 3 m or more, 3 s after their first track, of which lidar had before it, in scans with 5 returns or more until now, no
  // more than half of the directions in which their outline lies around their centre.
  Summary center_error_m;

  // Of a moving thing that comes nearer, at the scan in which the true TCPA falls below 10 s: both truly keep course and speed from there.
  Mean cpa_error_m;
  Mean tcpa_error_s;
  std::int64_t num_crossings = 0;
  std::int64_t num_crossings_untracked = 0;
  std::int64_t num_crossings_turning = 0;  // left out: what turns keeps no course
  // Of all that comes nearer, at 1 m/s or more, 3 s after its first track; truly, both keep course and speed.
  Calibration calibration;

  // Alerts. A pass: a thing in the water comes nearer than the limit, at 0.3 m/s or more, 10 s after it was seen with 5 returns or later.
  std::int64_t num_alerts = 0;  // that came up, of any cause
  Summary warned_ahead_s;       // of each pass, from the first alert of an approach to when it is nearest; minus infinity: none came
  Summary warned_after_s;       // from when it is farther than the limit again to when the alert is over
  Summary alerts_of_pass;  // of each pass: alerts, by their ids, of tracks that were of this thing, from the pass before to when the last is over

  std::vector<TrackEvent> events;  // in the order of time; Add leaves those of the other out

  /// MOTA and IDF1, 0 to 1 (MOTA also below 0); NaN where nothing had to be tracked.
  double Mota() const;
  double Idf1() const;
  double FalseTracksPerHour() const;
  /// Greatest id over the number of tracks that were reported: 1 where no number is wasted. NaN without any.
  double IdsPerTrack() const;
  void Add(const TrackScores& other);
};

/// @param truth   scans of a run in the order of time
/// @param tracks  [scans] the tracker's tracks after each
/// @param alerts  [scans] its alerts; empty: it has none
/// Matcher assigns tracks to things in a scan. A remaining track counts as false, unless it is within the gate of a thing that need not be tracked:
/// one with fewer returns, a hidden one, docks, piers, land.
TrackScores ScoreTracks(std::span<const TrueScan> truth, std::span<const std::vector<TrackState>> tracks,
                        std::span<const std::vector<StatedAlert>> alerts = {}, const ApproachLimits& limits = {});

}  // namespace lookout::eval
