#include "services/odometer/core/registration.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

#include "common/core/elementary.hpp"

namespace lookout::odometer {

namespace {

Eigen::Matrix3d Cross(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return matrix;
}

constexpr int kMaxIterations = 12;
// Steps smaller than this end the search.
constexpr double kStepM = 0.001;
constexpr double kStepRad = 1e-4;
// Differences of returns that stand: noise of the range, and the spacing of points on curved things.
constexpr double kNoiseM = 0.1;
// Scale of Geman-McClure's function at the end; at first it is a third of the distance that is searched.
constexpr double kScaleM = 0.15;
constexpr int kWideIterations = 4;
// At first a return may lie farther off, the more so the farther it is. In waves a small boat with a period of 3 s rolls by 15 deg/s, and its rate
// changes by 3 deg/s within a scan, so its attitude is known to a degree before the fit. Three deviations.
constexpr double kTiltRad = 0.05;
constexpr double kFarthestM = 6.0;
// A return is matched where its difference, as the shape weights it, is below this.
constexpr double kMatchedM = 0.2;

Vector6 Difference(const Eigen::Isometry3d& T, const Eigen::Isometry3d& from) {
  Vector6 difference;
  difference << T.translation() - from.translation(), RotationVector(T.linear() * from.linear().transpose());
  return difference;
}

struct Normal {
  Matrix6 information = Matrix6::Zero();
  Matrix6 curvature = Matrix6::Zero();  // derivative of the gradient
  Vector6 gradient = Vector6::Zero();
};

// Also says which returns are matched.
Normal Sum(const std::vector<MapPoint>& points, const Eigen::Isometry3d& T_map_vessel, double search_m, bool is_wide, const LocalMap& map,
           std::vector<Vector6>& pulls, Fit& fit) {
  Normal normal;
  pulls.assign(points.size(), Vector6::Zero());
  fit.information_spurious.setZero();
  fit.num_near = fit.num_matched = 0;
  double squares_m2 = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d arm_m = T_map_vessel.linear() * points[i].p_m;
    const Eigen::Vector3d p_map_m = arm_m + T_map_vessel.translation();
    const double reach_m = is_wide ? std::max(search_m, std::min(kFarthestM, search_m + kTiltRad * points[i].p_m.norm())) : search_m;
    const double scale_m = is_wide ? std::max(kScaleM, reach_m / 3.0) : kScaleM;
    const MapPoint point{p_map_m, T_map_vessel.linear() * points[i].normal, points[i].shape};
    auto match = map.Nearest(point, search_m);
    if (!match && reach_m > search_m) match = map.Nearest(point, reach_m);  // a cube of cubes: seldom
    fit.is_near[i] = match.has_value();
    fit.is_matched[i] = false;
    if (!match) continue;
    const Eigen::Vector3d difference_m = p_map_m - match->p_map_m;
    const Eigen::Vector3d weighted_m = match->weight * difference_m;
    const double square_m2 = difference_m.dot(weighted_m);
    const double ratio = scale_m * scale_m / (scale_m * scale_m + square_m2);
    const double weight = ratio * ratio / (kNoiseM * kNoiseM);
    Eigen::Matrix<double, 3, 6> jacobian;
    jacobian.leftCols<3>().setIdentity();
    jacobian.rightCols<3>() = -Cross(arm_m);
    const Eigen::Matrix<double, 6, 3> weighted = weight * (jacobian.transpose() * match->weight);
    normal.information += weighted * jacobian;
    const Vector6 bent = jacobian.transpose() * weighted_m;
    normal.curvature -= 4.0 * weight / (scale_m * scale_m + square_m2) * bent * bent.transpose();
    pulls[i] = weighted * difference_m;
    normal.gradient += pulls[i];
    const Vector6 along = jacobian.transpose() * match->along;
    fit.information_spurious += weight * along * along.transpose();
    ++fit.num_near;
    if (square_m2 > kMatchedM * kMatchedM) continue;
    fit.is_matched[i] = true;
    ++fit.num_matched;
    squares_m2 += square_m2;
  }
  fit.residual_m = fit.num_matched > 0 ? std::sqrt(squares_m2 / fit.num_matched) : 0.0;
  return normal;
}

// @param pulls  of each return at the fit
Matrix6 CovarianceOfThings(const std::vector<MapPoint>& points, const std::vector<Vector6>& pulls, const Matrix6& curvature, const Fit& fit) {
  // Where the returns differ by as much as the scale, the pulls hardly change with the place; what is left of that is uncertain, too.
  constexpr double kLeastCurvature = 0.2;
  Matrix6 nothing_known = 1e6 * Matrix6::Identity();  // no information from returns: the place is then known as well as predicted
  CubeIndex index;
  std::vector<Vector6> of_squares;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!fit.is_near[i]) continue;
    auto square = CubeOf(points[i].p_m, kSquareM);
    square.z() = 0;
    const auto [number, is_new] = index.Insert(square);
    if (is_new) of_squares.emplace_back(Vector6::Zero());
    of_squares[static_cast<std::size_t>(number)] += pulls[i];
  }
  Matrix6 scatter = Matrix6::Zero();
  for (const auto& pull : of_squares) scatter += pull * pull.transpose();
  // The eigenvectors make the information the identity, and the curvature diagonal.
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6> solver(curvature, fit.information);
  if (solver.info() != Eigen::Success) return nothing_known;
  const Vector6 inverse = solver.eigenvalues().cwiseMax(kLeastCurvature).cwiseInverse();
  const Matrix6 sensitivity = solver.eigenvectors() * inverse.asDiagonal() * solver.eigenvectors().transpose();
  const Matrix6 covariance = sensitivity * scatter * sensitivity;
  return covariance.allFinite() ? covariance : nothing_known;
}

}  // namespace

Eigen::Matrix3d RotationBy(const Eigen::Vector3d& rotation_rad) {
  const double angle_rad = rotation_rad.norm();
  if (angle_rad < 1e-12) return Eigen::Matrix3d::Identity();
  const auto [sin, cos] = SinCosOf(angle_rad);
  const Eigen::Matrix3d cross = Cross(rotation_rad / angle_rad);
  return Eigen::Matrix3d::Identity() + sin * cross + (1.0 - cos) * (cross * cross);
}

Eigen::Vector3d RotationVector(const Eigen::Matrix3d& R) { return 0.5 * Eigen::Vector3d(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1)); }

Fit Register(const std::vector<MapPoint>& points, const Expected& expected, const LocalMap& map) {
  Fit fit;
  fit.T_map_vessel = expected.T_map_begin;
  fit.is_near.assign(points.size(), false);
  fit.is_matched.assign(points.size(), false);
  std::vector<Vector6> pulls;
  Matrix6 curvature = Matrix6::Zero();
  for (int i = 0; i < kMaxIterations; ++i) {
    const auto normal = Sum(points, fit.T_map_vessel, expected.search_m, i < kWideIterations, map, pulls, fit);
    fit.information_seen = normal.information;
    fit.information = normal.information + expected.information;
    curvature = fit.information + normal.curvature;
    const Vector6 gradient = normal.gradient + expected.information * Difference(fit.T_map_vessel, expected.T_map_vessel);
    const Vector6 step = -fit.information.ldlt().solve(gradient);
    if (!step.allFinite()) break;
    fit.T_map_vessel.translation() += step.head<3>();
    fit.T_map_vessel.linear() = RotationBy(step.tail<3>()) * fit.T_map_vessel.linear();
    const bool is_still = step.head<3>().norm() < kStepM && step.tail<3>().norm() < kStepRad;
    if (is_still && i >= kWideIterations) break;
    if (is_still) i = std::max(i, kWideIterations - 1);
  }
  fit.covariance_of_things = CovarianceOfThings(points, pulls, curvature, fit);
  return fit;
}

}  // namespace lookout::odometer
