// Whether a boat can have got to where a fix says it is.
#pragma once

#include <cstdint>
#include <optional>

#include "common/core/geodesy.hpp"
#include "common/core/utime.hpp"

namespace lookout::navigator {

/// A fix is believed where a boat can have got there since the last believed fix; the first fix is always believed. Farther off either the receiver
/// is wrong (it sends yesterday's last place, or the almanac's, or a changed digit) or the earlier fixes were wrong. So fixes out of reach are held
/// until they have agreed with each other, and no fix came within reach, for as long as the earlier ones did: at least kLeastHold, at most kMostHold.
/// Then the boat is there.
///
/// A place nearer than 8.5 km (kMostSpeedMps in kMostHold) comes within reach as time passes without a believed fix: after 1 s at 140 m, after 13 s
/// at a minute of latitude.
///
/// Depends on times of measurements and on places alone.
class BelievedPlace {
 public:
  /// No boat has gone faster: the world water speed record (Spirit of Australia, 1978).
  static constexpr double kMostSpeedMps = 142.0;
  /// How far a boat gets in the time by which measurements without a time of their own are off.
  static constexpr double kSlackM = 50.0;
  /// Multiple of the deviations of both fixes, each per axis.
  static constexpr double kSlackInSds = 7.0;
  static constexpr std::chrono::seconds kLeastHold{10};
  static constexpr std::chrono::seconds kMostHold{60};
  /// Fewest fixes out of reach that establish a new place.
  static constexpr int kLeastFixes = 4;

  enum class Verdict {
    kBelieved,
    kHeld,      // out of reach
    kNewPlace,  // fixes were out of reach for so long that this one is believed
  };

  Verdict Judge(Utime time, const GeodeticPlace& place, double sd_m);

  /// The fix that was held last, until there is a new place.
  struct Held {
    Utime time;
    double distance_m = 0.0;  // from the last believed fix
    double since_s = 0.0;     // after the last believed fix
    double rest_s = 0.0;      // for how long fixes must stay there until they are believed
  };
  const std::optional<Held>& held() const { return held_; }

 private:
  // Successive fixes, each within reach of the fix before.
  struct Run {
    Utime first;
    Utime last;
    GeodeticPlace place;  // of the last fix, on the ellipsoid
    double sd_m = 0.0;
    std::int64_t count = 0;
  };

  static double DistanceM(const Run& run, const GeodeticPlace& place);
  static bool IsWithinReach(const Run& run, Utime time, const GeodeticPlace& place, double sd_m);
  static void Add(Utime time, const GeodeticPlace& place, double sd_m, Run& run);

  std::optional<Run> believed_;
  std::optional<Run> doubted_;
  std::optional<Held> held_;
};

}  // namespace lookout::navigator
