// A danger: one thing in one scan that may be dangerous.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/core/elementary.hpp"
#include "common/core/utime.hpp"
#include "services/tracker/core/picture.hpp"
#include "services/tracker/core/told_places.hpp"

namespace lookout::tracker {

// Numbers of both are those of the wire.
enum class AlertCause : std::int32_t { kGuardZone = 1, kClosestApproach = 2, kWatch = 3 };
inline constexpr std::size_t kNumCauses = 3;
enum class AlertLevel : std::int32_t { kCaution = 1, kWarning = 2 };

// As the thing of an alert or a danger, beside the ids of tracks: land with all that stands beside it; and things in the guard zone that are no track
// yet, or have no place on the map.
inline constexpr std::int64_t kLandTrack = 0;
inline constexpr std::int64_t kUnnamed = -1;
// Those of -2 and below are tentative tracks; from here down they are parts of the guard zone that nobody looks into.
inline constexpr std::int64_t kFirstUnseenId = -1'000'000;
// What a second lidar would see, which does not look; the parts of the zone are below it.
inline constexpr std::int64_t kUnseenBySecond = kFirstUnseenId;
// A lidar that sees nothing at all, for whatever reason; what covers it is below.
inline constexpr std::int64_t kSeesNothing = -2'000'000;
// An alert that many things share.
constexpr bool IsOfPlaces(std::int64_t thing) { return thing == kLandTrack || thing == kUnnamed || thing <= kFirstUnseenId; }

/// By one cause. Of one thing there may be one of each cause.
struct Danger {
  AlertCause cause = AlertCause::kGuardZone;
  std::int64_t thing = kLandTrack;          // the track, or the thing that it belongs to
  std::int64_t nearest_track = kLandTrack;  // of the thing; 0: none, or land
  TrackKind kind = TrackKind::kUnknown;     // of it
  double probability = 0.0;                 // of a guard zone 1: it is in it
  double distance_m = 0.0;
  double bearing_rad = 0.0;
  double cpa_m = kNan;
  double tcpa_s = kNan;       // 0: they part, or hardly move
  double time_left_s = kNan;  // until it is too near; 0: it is, and comes nearer; NaN: it does not come nearer
  bool is_grave = false;      // act now
  bool is_just_seen = false;  // for so short that it may be nothing
  bool is_known = false;      // its track is confirmed and old enough: one scan is enough
  Utime first = {};           // seen
  Utime seen = {};            // last
  Eigen::Vector2d place_map_m = Eigen::Vector2d::Constant(kNan);
  std::vector<DangerPlace> places = {};  // of land and of things without a track, at least one: so far an acknowledgement goes
};

/// Of two dangers of one cause and one thing the one that is told: the likely one, then the graver, then the sooner, then the nearer.
bool IsGraver(const Danger& one, const Danger& other);

}  // namespace lookout::tracker
