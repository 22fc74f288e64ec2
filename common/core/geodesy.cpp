#include "common/core/geodesy.hpp"

#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"

namespace lookout {

namespace {

// WGS84 (NIMA TR8350.2, tables 3.1 to 3.4).
constexpr double kEquatorRadiusM = 6378137.0;
constexpr double kFlattening = 1.0 / 298.257223563;
constexpr double kPolarRadiusM = kEquatorRadiusM * (1.0 - kFlattening);
constexpr double kEccentricity2 = kFlattening * (2.0 - kFlattening);
constexpr double kSecondEccentricity2 = kEccentricity2 / (1.0 - kEccentricity2);
constexpr double kEquatorGravityMps2 = 9.7803253359;
constexpr double kSomigliana = 0.00193185265241;
constexpr double kCentrifugalShare = 0.00344978650684;  // of gravity at the equator

// x through longitude 0, z through the north pole.
Eigen::Vector3d ToEarth(const SinCos& latitude, const SinCos& longitude, double ellipsoid_height_m) {
  const double normal_m = kEquatorRadiusM / std::sqrt(1.0 - kEccentricity2 * latitude.sin * latitude.sin);
  const double from_axis_m = (normal_m + ellipsoid_height_m) * latitude.cos;
  return {from_axis_m * longitude.cos, from_axis_m * longitude.sin, ((1.0 - kEccentricity2) * normal_m + ellipsoid_height_m) * latitude.sin};
}

GeodeticPlace FromEarth(const Eigen::Vector3d& p_earth_m) {
  constexpr int kNumSteps = 3;
  const double from_axis_m = Hypot(p_earth_m.x(), p_earth_m.y());
  const double z_m = p_earth_m.z();
  // Direction of the reduced latitude, whatever its length; then of the latitude.
  double sine = z_m;
  double cosine = (1.0 - kFlattening) * from_axis_m;
  double latitude_sine = 0.0;
  double latitude_cosine = 0.0;
  for (int step = 0; step < kNumSteps; ++step) {
    const double length = Hypot(sine, cosine);
    sine = length > 0.0 ? sine / length : 1.0;
    cosine = length > 0.0 ? cosine / length : 0.0;
    latitude_sine = z_m + kSecondEccentricity2 * kPolarRadiusM * (sine * sine * sine);
    latitude_cosine = from_axis_m - kEccentricity2 * kEquatorRadiusM * (cosine * cosine * cosine);
    sine = (1.0 - kFlattening) * latitude_sine;
    cosine = latitude_cosine;
  }
  const double latitude_rad = Atan2(latitude_sine, latitude_cosine);
  const double length = Hypot(latitude_sine, latitude_cosine);
  const double sin_latitude = latitude_sine / length;
  const double cos_latitude = latitude_cosine / length;
  const double ellipsoid_height_m =
      from_axis_m * cos_latitude + z_m * sin_latitude - kEquatorRadiusM * std::sqrt(1.0 - kEccentricity2 * sin_latitude * sin_latitude);
  const double longitude_rad = from_axis_m == 0.0 ? 0.0 : Atan2(p_earth_m.y(), p_earth_m.x());
  return {RadToDeg(latitude_rad), RadToDeg(longitude_rad), ellipsoid_height_m};
}

}  // namespace

LocalFrame::LocalFrame(const GeodeticPlace& datum) {
  const SinCos latitude = SinCosOfDegrees(datum.latitude_deg);
  const SinCos longitude = SinCosOfDegrees(datum.longitude_deg);
  p_earth_datum_m_ = ToEarth(latitude, longitude, datum.ellipsoid_height_m);
  R_earth_map_.col(0) = Eigen::Vector3d(-longitude.sin, longitude.cos, 0.0);                                          // east
  R_earth_map_.col(1) = Eigen::Vector3d(-latitude.sin * longitude.cos, -latitude.sin * longitude.sin, latitude.cos);  // north
  R_earth_map_.col(2) = Eigen::Vector3d(latitude.cos * longitude.cos, latitude.cos * longitude.sin, latitude.sin);    // up
}

Eigen::Vector3d LocalFrame::Forward(const GeodeticPlace& place) const {
  const Eigen::Vector3d p_earth_m = ToEarth(SinCosOfDegrees(place.latitude_deg), SinCosOfDegrees(place.longitude_deg), place.ellipsoid_height_m);
  return R_earth_map_.transpose() * (p_earth_m - p_earth_datum_m_);
}

GeodeticPlace LocalFrame::Reverse(const Eigen::Vector3d& p_map_m) const { return FromEarth(p_earth_datum_m_ + R_earth_map_ * p_map_m); }

Eigen::Isometry3d LocalFrame::TransformFrom(const LocalFrame& other) const {
  Eigen::Isometry3d T_this_other = Eigen::Isometry3d::Identity();
  if (p_earth_datum_m_ == other.p_earth_datum_m_ && R_earth_map_ == other.R_earth_map_) return T_this_other;
  T_this_other.linear() = R_earth_map_.transpose() * other.R_earth_map_;
  T_this_other.translation() = R_earth_map_.transpose() * (other.p_earth_datum_m_ - p_earth_datum_m_);
  return T_this_other;
}

double NormalGravityMps2(double latitude_deg, double ellipsoid_height_m) {
  const double sine = SinCosOfDegrees(latitude_deg).sin;
  const double sine2 = sine * sine;
  const double on_ellipsoid_mps2 = kEquatorGravityMps2 * (1.0 + kSomigliana * sine2) / std::sqrt(1.0 - kEccentricity2 * sine2);
  const double share = ellipsoid_height_m / kEquatorRadiusM;
  return on_ellipsoid_mps2 * (1.0 - 2.0 * (1.0 + kFlattening + kCentrifugalShare - 2.0 * kFlattening * sine2) * share + 3.0 * share * share);
}

}  // namespace lookout
