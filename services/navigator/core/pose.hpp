// Where the vessel frame is on the earth. NaN = not known.
#pragma once

#include <Eigen/Core>

#include "common/core/utime.hpp"
#include "services/navigator/core/nmea.hpp"

namespace lookout::navigator {

/// The numbers of pose_t.
enum class PoseStatus { kOk = 0, kNoHeading = 1, kNoPosition = 2, kUnknown = 3 };
enum class HeadingSource { kNone = 0, kHdt = 1, kPashr = 2, kCourse = 3 };

/// Geodetic origin of the map frame.
struct Datum {
  double latitude_deg = kUnknown;
  double longitude_deg = kUnknown;
  double ellipsoid_height_m = kUnknown;
};

/// Position, velocity (east, north, up), roll, pitch, heading.
using PoseCovariance = Eigen::Matrix<double, 9, 9>;

struct Pose {
  Utime time;  // a multiple of 20 ms
  PoseStatus status = PoseStatus::kUnknown;
  HeadingSource heading_source = HeadingSource::kNone;
  bool has_attitude = false;
  Datum datum;
  double latitude_deg = kUnknown;  // of the reference point
  double longitude_deg = kUnknown;
  double ellipsoid_height_m = kUnknown;
  Eigen::Vector3d p_map_m = Eigen::Vector3d::Constant(kUnknown);  // up is 0 while the height is not known
  Eigen::Vector3d velocity_map_mps = Eigen::Vector3d::Constant(kUnknown);
  double heading_rad = kUnknown;
  double pitch_rad = 0.0;
  double roll_rad = 0.0;
  double heave_m = kUnknown;
  PoseCovariance covariance = PoseCovariance::Constant(kUnknown);
};

}  // namespace lookout::navigator
