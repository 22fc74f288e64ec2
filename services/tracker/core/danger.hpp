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

// Values of `thing` that are no track id. kLandTrack: land and all that stands beside it. kUnnamed: things in the guard zone without a track, or
// without a place on the map.
inline constexpr std::int64_t kLandTrack = 0;
inline constexpr std::int64_t kUnnamed = -1;
// Ids of -2 and below are tentative tracks, down to here. Below it: parts of the guard zone that nobody looks into.
inline constexpr std::int64_t kFirstUnseenId = -1'000'000;
// The second lidar does not look: what it would see is not seen.
inline constexpr std::int64_t kUnseenBySecond = kFirstUnseenId;
// The lidar sees nothing at all, for whatever reason. Below it: sectors in which something covers the lidar.
inline constexpr std::int64_t kSeesNothing = -2'000'000;
// Whether many things share the alert: an acknowledgement is of their places.
constexpr bool IsOfPlaces(std::int64_t thing) { return thing == kLandTrack || thing == kUnnamed || thing <= kFirstUnseenId; }

/// One thing in one scan is dangerous by one cause. A thing may have a danger of each cause.
struct Danger {
  AlertCause cause = AlertCause::kGuardZone;
  std::int64_t thing = kLandTrack;          // the track, or the thing that it belongs to
  std::int64_t nearest_track = kLandTrack;  // of the thing; 0: none, or land
  TrackKind kind = TrackKind::kUnknown;     // of nearest_track
  double probability = 0.0;                 // by the guard zone: 1 in it, less at its edge or in doubt
  double distance_m = 0.0;
  double bearing_rad = 0.0;
  double cpa_m = kNan;
  double tcpa_s = kNan;       // 0: boat and thing part, or hardly move
  double time_left_s = kNan;  // until the thing is too near; 0: it is, and comes nearer; NaN: it never will be
  bool is_grave = false;      // a warning: it leaves less time than the own boat needs
  bool is_just_seen = false;  // seen for so short a time that it may be nothing
  bool is_known = false;      // its track is confirmed and old enough: one scan is enough
  Utime first = {};           // when it was seen first
  Utime seen = {};            // when it was seen last
  Eigen::Vector2d place_map_m = Eigen::Vector2d::Constant(kNan);
  std::vector<DangerPlace> places = {};  // of land, kUnnamed and things of several tracks: these an acknowledgement covers
};

/// Whether, of two dangers of one cause and one thing, the first is told: the likely one, then the graver, then the sooner, then the nearer.
bool IsGraver(const Danger& one, const Danger& other);

}  // namespace lookout::tracker
