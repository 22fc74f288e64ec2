// Turns: how fast the own boat turns, and closest approach while either boat turns.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <deque>

#include "common/core/elementary.hpp"
#include "common/core/utime.hpp"
#include "services/tracker/core/encounter.hpp"

namespace lookout::tracker {

/// Over which time a turn is looked for.
struct TurnLook {
  std::chrono::milliseconds over;
  std::chrono::milliseconds least_over;
  std::chrono::milliseconds lately;  // the heading must still turn
  double least_radps;
};

/// Turn rate of the own boat's way.
class TurnWatch {
 public:
  /// Scan by scan. Over the last second from 3 deg/s on, over the last three from 1.5 deg/s on, and only where heading and course over ground turn
  /// the same way: a boat that yaws in waves goes straight on, and one that turns on the spot goes nowhere. The end of a turn shows in the heading of
  /// the last 0.4 s (1 s of a slow one). Of these rates the least counts. A gap of more than 1 s, or time that goes back, begins anew.
  /// @param heading_rad   from north, clockwise
  /// @param velocity_mps  over ground, east and north; NaN: not known
  /// @return clockwise; 0 where it does not turn, or not for long enough to be known
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

/// ClosestApproachOf where one of both turns. When a turn ends nobody knows: it goes on for a further change of heading that is spread exponentially
/// (mean 60 deg), and then straight on. Five ends of equal weight, at the middle of each fifth of that distribution, stand for all: the probability
/// is their mean; cpa and tcpa are those of the median. Both boats end their turns at the same time.
///
/// So nothing on the tangent that the boat is just turning away from raises an alert, while what lies on the tangent, on the arc and between them
/// does: there all five agree. Cost: 10 us where all is far, some 100 us where five probabilities are in doubt.
ClosestApproach ApproachInTurns(const Moving& own, const Moving& other, const RelativeCovariance& covariance, const EncounterParams& params);

/// The place of a boat after a time of its turn.
Moving AfterTurn(const Moving& moving, double time_s);

/// Duration of the turn in the median of its ends.
double MedianTurnS(double turn_rate_radps);

}  // namespace lookout::tracker
