#include "services/odometer/core/registration.hpp"

#include <Eigen/Cholesky>
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
// A return is matched where its difference, as the shape weights it, is below this.
constexpr double kMatchedM = 0.2;

Vector6 Difference(const Eigen::Isometry3d& T, const Eigen::Isometry3d& from) {
  Vector6 difference;
  difference << T.translation() - from.translation(), RotationVector(T.linear() * from.linear().transpose());
  return difference;
}

struct Normal {
  Matrix6 information = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
};

// Also says which returns are matched.
Normal Sum(const std::vector<MapPoint>& points, const Eigen::Isometry3d& T_map_vessel, double search_m, double scale_m, const LocalMap& map,
           Fit& fit) {
  Normal normal;
  fit.information_spurious.setZero();
  fit.num_near = fit.num_matched = 0;
  double squares_m2 = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d arm_m = T_map_vessel.linear() * points[i].p_m;
    const Eigen::Vector3d p_map_m = arm_m + T_map_vessel.translation();
    const auto match = map.Nearest({p_map_m, T_map_vessel.linear() * points[i].normal, points[i].shape}, search_m);
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
    normal.gradient += weighted * difference_m;
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
  for (int i = 0; i < kMaxIterations; ++i) {
    const double scale_m = i < kWideIterations ? std::max(kScaleM, expected.search_m / 3.0) : kScaleM;
    const auto normal = Sum(points, fit.T_map_vessel, expected.search_m, scale_m, map, fit);
    fit.information_seen = normal.information;
    fit.information = normal.information + expected.information;
    const Vector6 gradient = normal.gradient + expected.information * Difference(fit.T_map_vessel, expected.T_map_vessel);
    const Vector6 step = -fit.information.ldlt().solve(gradient);
    if (!step.allFinite()) break;
    fit.T_map_vessel.translation() += step.head<3>();
    fit.T_map_vessel.linear() = RotationBy(step.tail<3>()) * fit.T_map_vessel.linear();
    const bool is_still = step.head<3>().norm() < kStepM && step.tail<3>().norm() < kStepRad;
    if (is_still && scale_m == kScaleM) break;
    if (is_still) i = std::max(i, kWideIterations - 1);
  }
  return fit;
}

}  // namespace lookout::odometer
