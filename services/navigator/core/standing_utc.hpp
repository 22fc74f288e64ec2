// UTC that stands while the place moves on.
#pragma once

#include <array>
#include <chrono>
#include <optional>

#include "common/core/geodesy.hpp"
#include "common/core/utime.hpp"
#include "services/navigator/core/nmea.hpp"

namespace lookout::navigator {

/// Some plotters send the place of now each second or two, and put a UTC beside it that they set every ten seconds. Then the place is of its arrival.
/// A place that does not move is repeated, and as old as its UTC says; but where others moved on under a UTC that stood for as long, the boat is at
/// rest.
class StandingUtc {
 public:
  /// So long after the first of a UTC its place counts as another. A receiver that says more than one place of one UTC within a second leaves parts
  /// of a second out.
  static constexpr std::chrono::milliseconds kLeastStand{1500};
  /// Once one has stood so.
  static constexpr std::chrono::milliseconds kLeastStandAgain{700};

  /// A place is another from so far on: the same one is told with 3 to 8 digits of a minute, which are up to 1 m apart.
  static constexpr double kLeastMoveM = 1.0;

  /// Takes a sentence of one input.
  /// @param sentence  with a time of day and a position
  /// @return whether its UTC has stood while places moved on
  bool Stands(Utime arrival, const Sentence& sentence);

 private:
  struct Said {
    std::chrono::microseconds time_of_day{0};
    Utime since;          // arrival of the first of this time
    GeodeticPlace place;  // of that
  };
  std::array<std::optional<Said>, kNumSentenceTypes> said_;
  std::chrono::microseconds longest_stand_{0};  // under which a place moved on
};

}  // namespace lookout::navigator
