// Where the boat is, by the returns of a scan and what was seen before.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "services/odometer/core/local_map.hpp"

namespace lookout::odometer {

/// Place and attitude of the vessel along the axes of the map: east-like, north-like, up (m), rotation about them (rad).
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Rotation by a vector: axis times angle.
Eigen::Matrix3d RotationBy(const Eigen::Vector3d& rotation_rad);
/// The vector of a small rotation.
Eigen::Vector3d RotationVector(const Eigen::Matrix3d& R);

/// Side of a square of the water: what lies in one counts as one thing.
inline constexpr double kSquareM = 5.0;

/// The expected place, before the returns are used.
struct Expected {
  Eigen::Isometry3d T_map_vessel = Eigen::Isometry3d::Identity();
  /// Where the search begins.
  Eigen::Isometry3d T_map_begin = Eigen::Isometry3d::Identity();
  /// Inverse of the covariance of place and rotation; 0 = nothing is known of a direction.
  Matrix6 information = Matrix6::Zero();
  double search_m = 0.5;  // greatest distance of a return from the map point to which it belongs
};

struct Fit {
  Eigen::Isometry3d T_map_vessel = Eigen::Isometry3d::Identity();
  Matrix6 information = Matrix6::Zero();       // includes the expected place's
  Matrix6 information_seen = Matrix6::Zero();  // of the returns alone
  // The part of `information` that is expected of the noise of normals: along surfaces, where they tell nothing.
  Matrix6 information_spurious = Matrix6::Zero();
  // Covariance of the fit by the scatter of the things: see Register.
  Matrix6 covariance_of_things = Matrix6::Zero();
  std::vector<bool> is_near;     // [returns] a map point lies near the return
  std::vector<bool> is_matched;  // [returns] the return fits a map point
  int num_near = 0;
  int num_matched = 0;
  double residual_m = 0.0;  // root mean square over matched returns
};

/// Gauss-Newton with the nearest point of the map to each return, its differences weighted by the shape there and by Geman-McClure's function: what
/// moves counts for little.
///
/// Returns of one thing have their error in common: it moves, or waves show now this part of it and now that. So what the squares of the water pull
/// at the fit, each with all of its returns, says more of its error than single returns do: A^-1 B A^-1, where B is the sum of the outer products of
/// these pulls, and A how much the pulls change with the place (P. J. Huber, "The behavior of maximum likelihood estimates under nonstandard
/// conditions", 1967; of groups K.-Y. Liang and S. L. Zeger, "Longitudinal data analysis using generalized linear models", Biometrika 73, 1986).
///
/// @param points  vessel frame at the end of the scan
Fit Register(const std::vector<MapPoint>& points, const Expected& expected, const LocalMap& map);

}  // namespace lookout::odometer
