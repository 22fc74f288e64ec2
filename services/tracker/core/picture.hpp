// The picture after a scan, as it is published.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "common/core/elementary.hpp"
#include "common/core/utime.hpp"
#include "services/tracker/core/encounter.hpp"
#include "services/tracker/core/land_approach.hpp"
#include "services/tracker/core/outline.hpp"

namespace lookout::tracker {

inline constexpr std::int64_t kNoTrack = -1;  // the track of a piece that is not followed

// Numbers of both are those of the wire.
enum class TrackStatus : std::int32_t { kTentative = 1, kConfirmed = 2, kCoasting = 3, kLost = 4 };
enum class TrackKind : std::int32_t { kObstacle = 0, kBuoy = 1, kBoat = 2, kStructure = 3, kUnknown = 4 };

/// One track after a scan, propagated to its end; track_t says what the members mean.
struct Track {
  std::int64_t id = 0;  // from 1 up in the order of confirmation; -2 and below of a tentative track
  TrackStatus status = TrackStatus::kTentative;
  TrackKind kind = TrackKind::kUnknown;
  Utime first;
  Utime seen;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  Eigen::Matrix2d covariance_relative_m2 = Eigen::Matrix2d::Zero();
  double turn_rate_radps = kNan;
  double existence_probability = 0.0;
  double moving_probability = 0.0;
  Rectangle rectangle;
  double top_above_water_m = 0.0;
  double seen_share = 0.0;
  std::vector<Eigen::Vector2d> outline_m;
  std::vector<std::int32_t> segment_ids;
  std::vector<std::int64_t> parents;
  std::vector<std::int64_t> children;
  bool is_on_ground = false;  // it moves, and is seen where something stood before
  int num_seen = 0;
  int num_looks = 0;
  double mean_returns = 0.0;
  double range_m = 0.0;
  double bearing_rad = 0.0;
  ClosestApproach approach;
  ClosestApproach approach_if_standing;  // as if its velocity were 0: of a course that is not proven
  Encounter encounter = Encounter::kNone;
};
/// Whether the track has been confirmed: it is there, or hidden for a moment.
inline bool IsConfirmed(const Track& track) { return track.status == TrackStatus::kConfirmed || track.status == TrackStatus::kCoasting; }

/// The picture after a scan.
struct Picture {
  bool is_sight_known = false;
  std::vector<Track> tracks;  // by id
  std::vector<std::int32_t> land_segment_ids;
  /// [pieces] by number less one, or, of a Sweep without pieces, [segments] by id less one: the id of its track, 0 for land, kNoTrack where it is not
  /// followed.
  std::vector<std::int64_t> track_of_piece;
  std::vector<Eigen::Vector2d> waterline_m;  // remembered land with water before it; told every tenth scan, else empty
  bool is_waterline_told = false;
  std::optional<LandApproach> land_approach;  // nullopt: the own boat hardly moves, its pose is not known, or no land is near its way
  /// Tracks that became part of another in this scan, and tentative ones that got their number (from, to).
  std::vector<std::pair<std::int64_t, std::int64_t>> merged;
};

}  // namespace lookout::tracker
