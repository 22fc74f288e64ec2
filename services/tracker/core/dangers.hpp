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
/// its first scan on (tentative ones where the zone takes them), as the vessel sees it: along the waterline of land where there is one, else the
/// outline. So it needs no pose. It is of the track that it was assigned to, of kLandTrack, or of kUnnamed. Confirmed tracks count beyond their
/// visible part, where the own pose is known. Its places: of land the nearest in each bin of bearing, of things without a name and of a thing of
/// several tracks the nearest point of each obstacle.
///
/// A thing in the zone is worth a look. A thing that comes nearer than the limit calls for action (ClosestApproachDangers); only where the own pose
/// or velocity is not known, so that nobody can tell, the zone warns.
///
/// A confirmed track that has been followed for a second, and whose outline by the tracker is in the zone, is known: no scan need say so twice. A
/// thing that is no confirmed track yet is just seen: crests are sure in single scans, too. A tentative track counts where it is likely to be a
/// thing, and an obstacle without a track where it has stayed for 0.8 s.
/// Around a boat that lies still a moving track that began beside something that stands is most often a piece of it: it waits until it has left.
///
/// @param own        placed, at the end of the scan
/// @param newcomers  obstacles of the zone without a track in the scans before; nullptr: all count at once
/// @param doubted    which moving tracks may be pieces, where the own boat lies still; nullptr: none
std::vector<Danger> GuardZoneDangers(const GuardZoneParams& params, const Picture& picture, std::span<const VesselOutline> outlines,
                                     const std::optional<Pose>& own, const Things& things = {}, Newcomers* newcomers = nullptr, Utime time = {},
                                     const Proof* doubted = nullptr);

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

struct ApproachParams {
  double limit_m = 0.0;  // of the closest approach
  OwnAbility ability = {};
};

/// Confirmed and coasting tracks, and land on the boat's way. A danger that leaves no more time than this boat needs to act is grave. Where the own
/// boat lies still and the track stands, neither comes nearer to the other: of such pairs only the guard zone speaks, so nothing rings for a boat in
/// its berth, while one that drifts down on a pile is warned.
///
/// A fast course that is not proven counts only where waiting longer would be too late and while it is seen, and is just seen.
/// @param own    placed, at the end of the scan; nullopt: nobody knows how near anything will come
/// @param proof  nullptr: all are
std::vector<Danger> ClosestApproachDangers(const ApproachParams& params, const Picture& picture, const std::optional<Pose>& own, bool is_own_still,
                                           const Things& things = {}, const Proof* proof = nullptr, Utime time = {});

}  // namespace lookout::tracker
