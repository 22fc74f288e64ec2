// Where the vessel frame is on the earth. NaN = not known.
#pragma once

#include <Eigen/Core>

#include "common/core/utime.hpp"
#include "services/navigator/core/nmea.hpp"

namespace lookout::navigator {

/// The numbers of pose_t.
/// kCoasting: as kOk, but no fix or no heading has come for about a second: propagated, with growing covariance.
enum class PoseStatus {
  kOk = 0,
  kNoHeading = 1,
  kNoPosition = 2,
  kUnknown = 3,
  kCoasting = 4,
  kRelative = 5,
  kRelativeCoasting = 6,
  kRelativeToBoat = 7
};
enum class HeadingSource { kNone = 0, kHdt = 1, kPashr = 2, kCourse = 3 };

/// Position, velocity (east, north, up), roll, pitch, heading.
using PoseCovariance = Eigen::Matrix<double, 9, 9>;

struct Pose {
  Utime time;  // a multiple of 20 ms
  PoseStatus status = PoseStatus::kUnknown;
  HeadingSource heading_source = HeadingSource::kNone;
  bool has_attitude = false;
  GeodeticPlace datum{kNan, kNan, kNan};  // origin of the map frame; of a relative pose: see pose_t
  double latitude_deg = kNan;             // of the reference point
  double longitude_deg = kNan;
  double ellipsoid_height_m = kNan;
  Eigen::Vector3d p_map_m = Eigen::Vector3d::Constant(kNan);  // while the height is not known, at the height of the datum
  Eigen::Vector3d velocity_map_mps = Eigen::Vector3d::Constant(kNan);
  double heading_rad = kNan;  // as roll and pitch against north and up where the boat is
  double pitch_rad = 0.0;
  double roll_rad = 0.0;
  double heave_m = kNan;
  PoseCovariance covariance = PoseCovariance::Constant(kNan);
};

}  // namespace lookout::navigator
