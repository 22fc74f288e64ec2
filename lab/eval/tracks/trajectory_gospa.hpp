// T-GOSPA: how far a set of estimated trajectories is from the set of true ones, with a price for every change of partner.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "lab/eval/tracks/track_gospa.hpp"

namespace lookout::eval {

/// Price of a change of partner, gamma: gamma^2 = c^2 / 2, so that a change costs as much as a miss does, as in MOTA.
inline constexpr double kSwitchCostM = 14.142135623730951;

/// Ids and places in a scan; an id once at most in each.
struct TrajectoryScan {
  std::vector<std::pair<std::int64_t, Eigen::Vector2d>> truths_m;
  std::vector<std::pair<std::int64_t, Eigen::Vector2d>> estimates_m;
};

/// Trajectory GOSPA of runs, in squares, so that runs can be added: metric^2 = GOSPA's metric^2 + gamma^2 x switches.
struct TrajectoryGospa {
  Gospa scans{.num_scans = 0};
  double num_switches = 0.0;  // from one partner to another 1, from one to none or from none to one 1/2

  void Add(const TrajectoryGospa& other);
  /// Root of the mean over the scans of metric^2, and of what switches add; NaN without a scan.
  double Rms() const;
  double SwitchRms() const;
};

/// One assignment for the whole run, truths to estimates scan by scan, whose cost is low: an upper bound of the metric, never below the GOSPA of the
/// scans. To find the least cost of all is hard (an assignment over many scans at once); here pairs of trajectories are assigned anew, each
/// pair optimally over the whole run, until none gets better. Of 500 random cases of up to 3 x 3 trajectories and 6 scans it is above the least cost
/// in 2 (test TrajectoryGospa.IsHardlyEverAboveTheLeastCost). Distances are cut off at kGospaCutOffM, and p is 2.
///
/// A partner may be kept while one of the two is not there; then it saves and costs nothing. Trajectories that begin or end cost no switch.
/// Deterministic. Cost: pairs of truths that share an estimate x estimates within the cut-off of each x scans; after kMaxTrajectoryWork states it
/// takes what it has.
/// Source: A. F. Garcia-Fernandez, A. S. Rahmathullah, L. Svensson, "A metric on the space of finite sets of trajectories for evaluation of
/// multi-target tracking algorithms", IEEE Trans. Signal Processing 68 (2020), definition 4.
TrajectoryGospa TrajectoryGospaOf(std::span<const TrajectoryScan> scans);
inline constexpr std::size_t kMaxTrajectoryWork = 50'000'000;

}  // namespace lookout::eval
