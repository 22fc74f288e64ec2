// The scene of the plotter: the own ship, targets, alerts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/core/elementary.hpp"
#include "common/core/utime.hpp"

namespace lookout::plotter {

/// Latitude and longitude, WGS84.
struct Position {
  double latitude_deg = kNan;
  double longitude_deg = kNan;  // [-180, 180]
};

/// The own ship at an instant. NaN = not known.
struct OwnShip {
  Utime time = {};
  Position position = {};     // of the reference point
  double heading_rad = kNan;  // from true north, clockwise
  double speed_mps = kNan;    // over ground
  double course_rad = kNan;   // from true north, clockwise
  bool is_estimated = false;  // position or heading is only propagated: nothing has come for about a second

  bool is_placed() const { return !std::isnan(position.latitude_deg) && !std::isnan(position.longitude_deg); }
};

enum class TargetState { kAcquiring, kTracking, kLost };

// Level and NoticeState have the numbers of alert_t.
enum class Level : std::int32_t { kNone = 0, kCaution = 1, kWarning = 2 };
enum class NoticeState : std::int32_t { kActive = 1, kAcknowledged = 2, kRectified = 3, kCleared = 4 };
// Identifiers of alerts in sentences are made of these numbers, so the numbers stay. kPosition is the plotter's own; kPartUnseen comes from WATCH, as
// kWatch does: nobody looks into a part of the guard zone.
enum class Cause : std::int32_t { kGuardZone = 1, kClosestApproach = 2, kWatch = 3, kPosition = 4, kPartUnseen = 5 };

enum class Sound { kQuiet, kSounds, kSilenced };

/// One track, as it is to be shown.
struct Target {
  std::int64_t id = 0;          // id of the track
  std::string name;             // "boat 17": printable ASCII
  std::string given_name = {};  // by people, else of the ship by AIS, UTF-8; "": none
  TargetState state = TargetState::kTracking;
  Utime first;  // seen
  Position position;
  double velocity_east_mps = 0.0;  // 0 while the target stands
  double velocity_north_mps = 0.0;
  double speed_mps = 0.0;
  double course_rad = kNan;  // NaN while the target stands
  double length_m = kNan;    // along length_bearing_rad
  double width_m = kNan;
  double length_bearing_rad = kNan;  // from true north, clockwise, 0 to pi
  double distance_m = kNan;          // hull to hull, now
  double cpa_m = kNan;               // hull to hull
  double tcpa_s = kNan;              // 0 where the distance grows
  double cpa_probability = kNan;     // that the target passes at less than the limit
  Level level = Level::kNone;        // of the target's gravest alert that holds
};

/// One alert, as it is to be shown.
struct Notice {
  std::int64_t id = 0;  // of the alert; below 0: of the watch; 0: the plotter's own, which nobody acknowledges
  Cause cause = Cause::kWatch;
  Level level = Level::kWarning;
  NoticeState state = NoticeState::kActive;
  std::int64_t track_id = 0;  // 0: of none
  Utime raised;
  Utime changed;
  Sound sound = Sound::kQuiet;                 // one of all notices sounds; kSilenced: a warning that would sound
  std::chrono::microseconds unchanged_for{0};  // time passed since `changed`, however the host's clock was set meanwhile
  int escalation = 0;                          // how often the alert was raised again because nobody acknowledged it, 0 to 9; after 9 comes 1
  std::string text;
  bool is_old = false;  // nobody knows whether the alert still holds: it is neither told again nor cleared

  bool operator==(const Notice&) const = default;
};

/// Whether one target is shown before another: targets with an alert, the graver first; then targets that come too near, the sooner first; then the
/// nearer; then the lower id.
bool IsMoreDangerous(const Target& one, const Target& other);

/// The given name where all of it is printable ASCII and no longer than `max_bytes`, else the name: a part of a name could be another target's name.
const std::string& AsciiNameOf(const Target& target, std::size_t max_bytes);

/// Whether the target has an alert, or is likely to pass at less than the limit.
bool IsDangerous(const Target& target);

/// The position after a time, at an unchanged velocity. Error: below 1 mm for a few seconds, beside a pole too.
Position Propagated(const Position& position, double velocity_east_mps, double velocity_north_mps, double duration_s);

struct RangeAndBearing {
  double range_m = 0.0;
  double bearing_rad = 0.0;  // from true north at `from`, clockwise, 0 to 2 pi
};

/// Along the plane that touches the earth at `from`: short by 1 mm in 1 km.
RangeAndBearing RangeAndBearingOf(const Position& from, const Position& to);

}  // namespace lookout::plotter
