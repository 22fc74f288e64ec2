// Follows obstacles over scans: sightings, visibility, association, motion, closest approach.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "common/core/elementary.hpp"
#include "common/core/health.hpp"
#include "services/tracker/core/encounter.hpp"
#include "services/tracker/core/picture.hpp"
#include "services/tracker/core/scan.hpp"
#include "services/tracker/core/without.hpp"

namespace lookout::tracker {

struct TrackerParams {
  Eigen::Isometry3d T_vessel_lidar = Eigen::Isometry3d::Identity();
  double reference_point_above_water_m = 0.0;
  double max_range_m = 0.0;                 // of the segmenter: farther things cannot be seen
  std::vector<Eigen::Vector2d> own_hull_m;  // vessel frame, convex, counter-clockwise
  EncounterParams encounter;
  double moving_probability = 0.95;   // a track above it moves
  double confirm_probability = 0.95;  // a track of a greater probability is confirmed
  double end_probability = 0.01;      // a tentative track of a lower existence ends
  Without without;
};

class Tracker {
 public:
  explicit Tracker(const TrackerParams& params);
  ~Tracker();

  /// Scans in the order of time. All tracks are forgotten with a scan in another map frame, after a gap of more than 10 s, after a step of time back,
  /// or after a jump of the own position that its speed does not explain; each reason has its counter. Cost and memory: README.md.
  const Picture& Update(const ScanInput& scan);
  /// Whether Update with this scan will begin anew.
  bool BeginsAnewWith(const ScanInput& scan) const;
  /// From the next scan on.
  void SetEncounter(const EncounterParams& encounter);
  /// Forgets everything but the next id, as at a start mark.
  void Reset();

  std::vector<Counter> counters() const;

 private:
  struct Memory;
  TrackerParams params_;
  std::unique_ptr<Memory> memory_;
};

}  // namespace lookout::tracker
