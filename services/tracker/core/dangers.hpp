// The dangers of a scan's picture: things in the guard zone, and tracks that come too near.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/core/guard_sector.hpp"
#include "common/core/pose.hpp"
#include "common/core/utime.hpp"
#include "services/tracker/core/danger.hpp"
#include "services/tracker/core/gatherer.hpp"
#include "services/tracker/core/newcomers.hpp"
#include "services/tracker/core/proof.hpp"
#include "services/tracker/core/scan.hpp"
#include "services/tracker/core/things.hpp"
#include "services/tracker/core/tracker.hpp"
#include "services/tracker/core/urgency.hpp"

namespace lookout::tracker {

/// Things within sector and range, one danger for each and one for land. Each obstacle of the scan that is sure, or of a confirmed track, counts from
/// its first scan on (a tentative one where the zone takes tentative ones). Its place is as the vessel sees it: along the waterline of land where
/// there is one, else along the outline; so no pose is needed. The obstacle is of the track that it was assigned to, of kLandTrack, or of kUnnamed.
/// Where the own pose is known, confirmed tracks also count by their whole outline. Places of a danger: of land the nearest in each bin of bearing;
/// of kUnnamed and of a thing of several tracks the nearest point of each obstacle.
///
/// A thing in the zone is a caution. A thing that comes nearer than the limit may be a warning (ClosestApproachDangers). Where the own pose or
/// velocity is not known, nobody can tell what comes nearer: then the zone warns.
///
/// A confirmed track that has been followed for a second, and whose outline by the tracker is in the zone, is known: one scan is enough. A thing that
/// is no confirmed track yet is just seen: crests are sure in single scans, too. A tentative track counts when it is likely a thing, and an obstacle
/// without a track when it has stayed for 0.8 s. Around a boat that lies still, a moving track that began beside something standing is most often a
/// piece of it, and counts when it has left.
///
/// @param own        placed, at the end of the scan
/// @param newcomers  obstacles of the zone without a track in the scans before; nullptr: all count at once
/// @param doubted    which moving tracks may be pieces, where the own boat lies still; nullptr: none
std::vector<Danger> GuardZoneDangers(const GuardZoneParams& params, const Picture& picture, std::span<const VesselOutline> outlines,
                                     const std::optional<Pose>& own, const Things& things = {}, Newcomers* newcomers = nullptr, Utime time = {},
                                     const Proof* doubted = nullptr);

/// Whether the own boat lies still: its velocity over ground, averaged over some seconds, is below half a knot. So sway in the berth and noise of the
/// receiver count as lying still, a drift does not.
class StillWatch {
 public:
  /// Scan by scan. The average begins anew with the first scan, after a gap of more than 1 s, a step back in time, or an unknown velocity.
  /// @param velocity_mps  NaN: not known, then it does not lie still
  bool Update(Utime time, const Eigen::Vector2d& velocity_mps);

 private:
  Eigen::Vector2d mean_mps_ = Eigen::Vector2d::Constant(kNan);
  Utime newest_;
};

struct ApproachParams {
  double limit_m = 0.0;  // nearer is too near, hull to hull
  OwnAbility ability = {};
};

/// Confirmed and coasting tracks, tentative tracks that last (Proof), and land on the boat's way. A danger that leaves less time than this boat needs
/// to act is grave. Where the own boat lies still and the track stands, neither comes nearer: the guard zone alone tells such tracks. So nothing
/// rings for a boat in its berth, while a boat that drifts down on a pile is warned. A moving track raises an alert of a boat that
/// lies still only when at most 15 s are left, or the time that this boat needs to act where that is longer.
///
/// A course that is not proven counts only where waiting longer would be too late and while the track is seen, and is just seen. The track counts as
/// if it stood where that is graver.
/// @param own    placed, at the end of the scan; nullopt: nobody knows how near anything will come
/// @param proof  nullptr: all courses are proven
std::vector<Danger> ClosestApproachDangers(const ApproachParams& params, const Picture& picture, const std::optional<Pose>& own, bool is_own_still,
                                           const Things& things = {}, const Proof* proof = nullptr, Utime time = {});

}  // namespace lookout::tracker
