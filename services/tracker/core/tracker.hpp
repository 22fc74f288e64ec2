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
  double max_range_m = 0.0;                 // of the segmenter: beyond it nothing could have been seen
  std::vector<Eigen::Vector2d> own_hull_m;  // vessel frame, convex, counter-clockwise
  EncounterParams encounter;
  double moving_probability = 0.95;   // above which a track moves
  double confirm_probability = 0.95;  // existence
  double end_probability = 0.01;
  Without without;
};

class Tracker {
 public:
  explicit Tracker(const TrackerParams& params);
  ~Tracker();

  /// Scans in the order of time. One without a pose, in another map frame, after a step of time of more than 10 s or back, or after a jump of the own
  /// position that its speed does not explain, begins anew; each has its counter.
  /// Cost and memory: README.md.
  const Picture& Update(const ScanInput& scan);
  /// Whether Update with this scan will begin anew.
  bool BeginsAnewWith(const ScanInput& scan) const;
  /// From the next scan on.
  void SetEncounter(const EncounterParams& encounter);
  /// Start mark: everything is forgotten but the next id.
  void Reset();

  std::vector<Counter> counters() const;

 private:
  struct Memory;
  TrackerParams params_;
  std::unique_ptr<Memory> memory_;
};

}  // namespace lookout::tracker
