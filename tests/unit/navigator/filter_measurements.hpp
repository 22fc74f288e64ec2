// Measurements for tests of the filter, near one place, in seconds from noon.
#pragma once

#include <GeographicLib/Geodesic.hpp>
#include <cmath>

#include "common/core/angles.hpp"
#include "services/navigator/core/filter/pose_filter.hpp"
#include "tests/unit/navigator/filter_params.hpp"
#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::navigator {

inline constexpr double kLatitudeDeg = 43.63;
inline constexpr double kLongitudeDeg = -72.15;

inline GnssFix Fix(double time_s, const char* type = "RMC") {
  GnssFix fix;
  fix.when = {NoonPlus(time_s), NoonPlus(time_s), true};
  fix.source = "udp";
  fix.sentence_type = type;
  fix.quality = FixQuality::kGnss;
  fix.position = GeodeticPlace{kLatitudeDeg, kLongitudeDeg};
  fix.horizontal_sd_m = 2.0;
  return fix;
}

inline GnssFix MovingFix(double time_s, double speed_mps, double course_deg) {
  GnssFix fix = Fix(time_s);
  fix.speed_mps = speed_mps;
  fix.course_rad = DegToRad(course_deg);
  return fix;
}

inline Attitude HeadingSample(double time_s, double heading_deg) {
  Attitude attitude;
  attitude.when = {NoonPlus(time_s), NoonPlus(time_s), false};
  attitude.sentence_type = "HDT";
  attitude.heading_rad = WrapTo2Pi(DegToRad(heading_deg));
  return attitude;
}

inline Attitude AttitudeSample(double time_s, double heading_deg, double roll_deg, double pitch_deg) {
  Attitude attitude = HeadingSample(time_s, heading_deg);
  attitude.sentence_type = "PASHR";
  attitude.roll_rad = DegToRad(roll_deg);
  attitude.pitch_rad = DegToRad(pitch_deg);
  return attitude;
}

// Of a boat at rest, level.
inline ImuSample RestSample(double time_s) { return {NoonPlus(time_s), Eigen::Vector3d::Zero(), Eigen::Vector3d(0.0, 0.0, 9.80474)}; }

// Metres on the ellipsoid from the test's place.
inline double DistanceM(const Pose& pose) {
  double distance_m = 0.0;
  GeographicLib::Geodesic::WGS84().Inverse(kLatitudeDeg, kLongitudeDeg, pose.latitude_deg, pose.longitude_deg, distance_m);
  return distance_m;
}

inline double SdM(const Pose& pose) { return std::sqrt(pose.covariance(0, 0)); }

}  // namespace lookout::navigator
