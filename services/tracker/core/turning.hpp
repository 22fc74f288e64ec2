// Turns: how fast the own boat turns, and closest approach while either boat turns.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <deque>

#include "common/core/elementary.hpp"
#include "common/core/utime.hpp"
#include "services/tracker/core/encounter.hpp"

namespace lookout::tracker {

/// How a turn is looked for.
struct TurnLook {
  std::chrono::milliseconds over;        // the rate is a mean over this time
  std::chrono::milliseconds least_over;  // or over this at least, after a start
  std::chrono::milliseconds lately;      // in this last part of it the heading must still turn
  double least_radps;
};

/// Turn rate of the own boat's way.
class TurnWatch {
 public:
  /// Scan by scan. The boat turns when heading and course over ground have turned the same way by 3 deg/s or more over the last second, or by 1.5
  /// deg/s over the last three: a boat that yaws in waves goes straight on, and a boat that turns on the spot goes nowhere. The end of a turn shows
  /// in the heading of the last 0.4 s (1 s of a slow turn). The least of these rates counts. A gap of more than 1 s, or time that goes back, begins
  /// anew.
  /// @param heading_rad   from north, clockwise
  /// @param velocity_mps  over ground, east and north; NaN: not known
  /// @return turn rate, clockwise; 0 where the boat does not turn, or not for long enough to be known
  double Update(Utime time, double heading_rad, const Eigen::Vector2d& velocity_mps);
  void Reset() { looks_.clear(); }

 private:
  struct Look {
    Utime time;
    double heading_rad = 0.0;
    double course_rad = kNan;  // NaN: too slow to have one
  };
  double RateOf(const TurnLook& look) const;

  std::deque<Look> looks_;
};

/// ClosestApproachOf where one boat, or both, turn. Nobody knows when a turn ends: the boat turns on by a further angle that is spread exponentially
/// (mean 60 deg), and then goes straight on. Five ends of equal weight, at the middle of each fifth of that distribution, stand for all: the
/// probability is the mean over the five; cpa and tcpa are those of the median end. Both boats end their turns at the same time.
///
/// So a thing on the tangent that the boat is just turning away from raises no alert, while a thing to which every end leads does. Cost: 10 us where
/// all is far, some 100 us where five probabilities are in doubt.
ClosestApproach ApproachInTurns(const Moving& own, const Moving& other, const RelativeCovariance& covariance, const EncounterParams& params);

/// The place of a boat after a time of its turn.
Moving AfterTurn(const Moving& moving, double time_s);

/// Duration of the turn in the median of its ends.
double MedianTurnS(double turn_rate_radps);

}  // namespace lookout::tracker
