// Standing things around the boat, from the scans, and how the boat moved past them.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <vector>

#include "services/odometer/core/local_map.hpp"
#include "services/odometer/core/standing.hpp"
#include "tools/calibrate/hand_eye.hpp"
#include "tools/calibrate/pose_track.hpp"

namespace lookout::calibrate {

/// Assumptions with which the scans are read.
struct Assumed {
  Eigen::Isometry3d T_vessel_lidar = Eigen::Isometry3d::Identity();
  Latency latency;
  double min_range_m = 1.0;  // nearer returns may come from the own boat
  double max_range_m = 100.0;
  double reference_point_above_water_m = 0.0;
  Eigen::AlignedBox3d own_vessel_box_m;
  /// Returns lower than this above calm water are left out; nullopt while roll and pitch of the mounting are not known.
  std::optional<double> min_height_m;
};

/// Returns of a scan, straightened: vessel frame at the end of the scan.
std::vector<odometer::MapPoint> StandingIn(const odometer::Scan& scan, const PoseTrack& track, const Assumed& assumed);

struct PairParams {
  std::size_t key_scans = 10;                             // between two moments that are compared
  std::size_t half_scans = 3;                             // scans on each side of a moment whose returns make the moment's surroundings
  std::vector<std::size_t> lags{1, 2, 4, 8, 16, 32, 64};  // moments later
  bool both_ways = true;                                  // each moment against the surroundings of the other, too
  double search_m = 1.0;                                  // greatest distance of a return from its place by POSE
};

/// How the vessel moved between moments, by registering the points of a scan with the surroundings of another moment. Pairs that do not fit are left
/// out.
std::vector<RelativeMotion> MotionsPast(const std::vector<odometer::Scan>& scans, const PoseTrack& track, const Assumed& assumed,
                                        const PairParams& params);

}  // namespace lookout::calibrate
