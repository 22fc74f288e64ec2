// The alarm for what comes too near: watches a sector around the boat, like the guard zone of a radar.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/core/angles.hpp"
#include "common/core/utime.hpp"
#include "services/georeferencer/core/obstacle.hpp"

namespace lookout::georeferencer {

struct GuardZoneParams {
  double range_m = 0.0;          // horizontal, from the vessel's origin; 0 = no alarm
  Sector bearing;                // of the sector, from the bow clockwise
  bool takes_tentative = false;  // whether a tentative obstacle, which may be spray, gives alarm too
};

/// The point of an obstacle's seen outline that is nearest to the boat within a sector.
struct NearestPoint {
  double range_m = 0.0;      // horizontal, from the vessel's origin
  double bearing_rad = 0.0;  // from the bow clockwise, 0 to 2 pi
};

/// Along the outline: the footprint, or of land its waterline where there is one. Not only its corners: a long wall is nearest between two.
///
/// @return nullopt when nothing of the outline lies within the sector
std::optional<NearestPoint> NearestWithin(const Sector& bearing, const Obstacle& obstacle);

class GuardZone {
 public:
  explicit GuardZone(const GuardZoneParams& params) : params_(params) {}

  /// Takes the obstacles of a turn, or of a part of one. Parts of a turn come one after the other.
  void Add(const ObstaclePart& part);

  /// What is nearest within range and sector, in the latest turn or the one before: of the latest, parts may still be on their way.
  std::optional<NearestPoint> nearest() const;

  /// Turns in which the alarm came up: the turn before was clear.
  std::int64_t num_alarms() const { return num_alarms_; }

 private:
  GuardZoneParams params_;
  std::optional<Utime> turn_;
  std::optional<NearestPoint> latest_;
  std::optional<NearestPoint> before_;
  std::int64_t num_alarms_ = 0;
};

}  // namespace lookout::georeferencer
