// What of a scan's picture is a danger: things in the guard zone, and tracks that come too near.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/core/guard_sector.hpp"
#include "common/core/pose.hpp"
#include "common/core/utime.hpp"
#include "services/tracker/core/alerts.hpp"
#include "services/tracker/core/gatherer.hpp"
#include "services/tracker/core/scan.hpp"
#include "services/tracker/core/tracker.hpp"

namespace lookout::tracker {

/// What is within sector and range, one danger for each track and one for land. Each obstacle of the scan that is sure, or of a confirmed track,
/// counts from its first scan on (tentative ones where the zone takes them), as the vessel sees it: along the waterline of land where there is one,
/// else the outline. So it needs no pose. It is of the track that it was assigned to, of kLandTrack, or of kUnnamed. Confirmed tracks count beyond
/// what is seen of them now, where the own pose is known. Its places: of land the nearest in each bin of bearing, of all else the nearest point of
/// each obstacle.
/// @param own  placed, at the end of the scan
std::vector<Danger> GuardZoneDangers(const GuardZoneParams& params, const Picture& picture, std::span<const VesselOutline> outlines,
                                     const std::optional<Pose>& own);

/// Whether the own boat lies still: its velocity over ground, averaged over some seconds, is below half a knot. So sway in the berth and the noise of
/// the receiver are none, but a drift is.
class StillWatch {
 public:
  /// Scan by scan. A first one, one after more than 1 s or back in time, or after an unknown velocity begins anew.
  /// @param velocity_mps  NaN: not known, then it does not lie still
  bool Update(Utime time, const Eigen::Vector2d& velocity_mps);

 private:
  Eigen::Vector2d mean_mps_ = Eigen::Vector2d::Constant(kNan);
  Utime newest_;
};

/// Confirmed and coasting tracks, and land on the boat's way. Where the own boat lies still and the track stands, neither comes nearer to the other:
/// of them only the guard zone speaks, so a boat in its berth has peace, while one that drifts down on a pile is warned.
/// @param limit_m  of the closest approach
std::vector<Danger> ClosestApproachDangers(double limit_m, const Picture& picture, bool is_own_still);

}  // namespace lookout::tracker
