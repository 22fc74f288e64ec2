// Inputs of the scores of tracks: the truth after one scan, and a tracker's tracks. Map frame: east, north at one datum.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "lab/eval/truth.hpp"

namespace lookout::eval {

/// A true object at the end of a scan.
struct TrueThing {
  int id = 0;                                              // 1, 2, ...
  Polygon outline_m;                                       // at least one corner
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();    // centre of the rectangle of least area around it
  Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();  // over ground
  int num_returns = 0;                                     // in this scan
  bool is_in_water = false;                                // a boat, swimmer, buoy, marker
  bool is_land = false;                                    // IsLand; docks and piers are neither
  bool is_buoy = false;                                    // by its kind
};

/// The own boat at the end of a scan.
struct TrueBoat {
  Polygon outline_m;
  Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();
};

struct TrueScan {
  std::int64_t utime_us = 0;  // end of the scan
  std::vector<TrueThing> things;
  std::optional<TrueBoat> own;
};

/// The numbers are those of track_t.
enum class TrackStatus : std::int32_t { kTentative = 1, kConfirmed = 2, kCoasting = 3, kLost = 4 };

/// A track at the end of a scan, as a tracker states it.
struct TrackState {
  std::int64_t id = 0;
  TrackStatus status = TrackStatus::kTentative;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();
  bool is_moving = false;                                // the tracker says that the track moves
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();  // of position and velocity; NaN = not stated
  Polygon outline_m;                                     // empty: the position alone is known
  std::vector<std::int32_t> segment_ids;                 // of this scan, that it explains
  /// Closest approach to the own boat, hull to hull; NaN = it states none.
  double cpa_m = std::numeric_limits<double>::quiet_NaN();
  double tcpa_s = std::numeric_limits<double>::quiet_NaN();
  /// That it is below the limit within the look-ahead (ApproachLimits).
  double cpa_probability = std::numeric_limits<double>::quiet_NaN();

  /// Told to people as being there.
  bool IsReported() const { return status == TrackStatus::kConfirmed || status == TrackStatus::kCoasting; }
};

/// An alert at the end of a scan.
struct StatedAlert {
  std::int64_t id = 0;
  std::int64_t track_id = 0;    // 0 = of none
  bool is_of_approach = false;  // else of a guard zone
  bool holds = false;           // active or acknowledged: not over
};

}  // namespace lookout::eval
