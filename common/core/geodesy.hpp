// Places on the earth (WGS84) and in the map frame, and gravity: closed forms that give the same on every computer, unlike a library that takes its
// trigonometric functions from the C library.
#pragma once

#include <Eigen/Geometry>

namespace lookout {

/// Rate at which WGS84's earth turns (NIMA TR8350.2, table 3.1).
inline constexpr double kEarthRateRadps = 7292115e-11;

struct GeodeticPlace {
  double latitude_deg = 0.0;   // -90 to 90
  double longitude_deg = 0.0;  // any; results are in [-180, 180]
  double ellipsoid_height_m = 0.0;
};

/// The place on the ellipsoid, without its height.
constexpr GeodeticPlace OnEllipsoid(const GeodeticPlace& place) { return {place.latitude_deg, place.longitude_deg, 0.0}; }

/// East, north and up at a datum: the map frame. A plane that touches the earth there, no projection.
class LocalFrame {
 public:
  explicit LocalFrame(const GeodeticPlace& datum);

  /// @return p_map_m
  /// Error: below 1e-8 m against GeographicLib's LocalCartesian for places anywhere on the earth, from 1 km below to 10 km above the ellipsoid.
  Eigen::Vector3d Forward(const GeodeticPlace& place) const;

  /// Error: below 1e-8 m for such places, and up to 1000 km height; below 1e-7 m up to 100 000 km. On the earth's axis the longitude is that of the
  /// meridian on which rounding puts it; at the very pole of a datum at longitude 0 it is 0. At the centre of the earth the answer is the north pole.
  /// If any part is NaN, all parts of the answer are. Source: B. Bowring, "The accuracy of geodetic latitude and height equations", Survey Review 28
  /// (1985), its step taken three times.
  GeodeticPlace Reverse(const Eigen::Vector3d& p_map_m) const;

  /// @return T_this_other, both fixed to the earth: translation and rotation. The identity, to the last bit, where the datum is the same.
  /// Error: below 1e-8 m.
  Eigen::Isometry3d TransformFrom(const LocalFrame& other) const;

 private:
  Eigen::Matrix3d R_earth_map_;
  Eigen::Vector3d p_earth_datum_m_;
};

/// Gravity of WGS84's ellipsoid, downwards along its normal, with the centrifugal part: Somigliana's formula, carried up by the second order of
/// height (NIMA TR8350.2, equations 4-1 and 4-3). Error: below 1e-6 m/s2 of GeographicLib's NormalGravity from 1 km below to 10 km above the
/// ellipsoid.
double NormalGravityMps2(double latitude_deg, double ellipsoid_height_m);

}  // namespace lookout
