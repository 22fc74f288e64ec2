#include "services/tracker/core/body.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"

namespace lookout::tracker {

namespace {

// A direction belongs to the near side where it points at the lidar by more than this cosine, to the far side where it points away by as much, and
// to the left or right end between: two directions of 22.5 deg each.
constexpr double kSideCosine = 0.3;
// How well one scan shows a side, and an end: the range's deviation and the roughness of hulls; an end lies between two beams, 0.2 deg apart (3.5
// mrad).
constexpr double kNearSdM = 0.04;
constexpr double kNearSdPerRange = 0.001;
constexpr double kEndSdM = 0.04;
constexpr double kEndSdPerRange = 0.0035;
// A side whose end was never seen is assumed to be as far behind as half of the width in sight, and that is known to half as much and 0.3 m.
constexpr double kLeastDepthM = 0.15;
constexpr double kGreatestAssumedDepthM = 1.5;
constexpr double kWidestBeamM = 4.0;
constexpr double kLeastSideSdM = 0.005;
constexpr double kSideWanderM2PerS = 0.01 * 0.01;      // outlines change as a boat swings
constexpr double kStandingWanderM2PerS = 0.03 * 0.03;  // what is moored swings, and positions by GNSS wander
constexpr double kAccelerationMps2 = 0.4;              // standard deviation over a second; small craft
constexpr double kFirstSpeedMps = 3.0;                 // standard deviation of what is not known
constexpr double kFirstJitterM2 = 0.05 * 0.05;
constexpr double kLeastJitterM2 = 0.015 * 0.015;
constexpr double kMostJitterM2 = 4.0;
constexpr double kJitterGain = 0.1;
// Evidence of motion is that of some 3 s, and half of it as the measurements of two scans are not independent.
constexpr double kMotionMemoryS = 3.0;
constexpr double kMotionWeight = 0.5;
constexpr double kMovingPriorLogOdds = -2.0;
constexpr double kGreatestLogOdds = 12.0;
// Motion must stand out by itself.
constexpr double kLeastSpeedMps = 0.2;
constexpr double kSpeedSds = 3.0;

double CrossOf(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// What a place is uncertain by from scan to scan. The errors of mounting and heading, which turn all of it about the boat, stay as they are
// meanwhile: of the covariance only what is more than theirs, about a degree, is noise.
Eigen::Matrix2d NoiseOf(const Eigen::Matrix2d& covariance_m2, double range_m) {
  constexpr double kTurnedRad = 0.015;
  const double turned_m = kTurnedRad * range_m;
  Eigen::Matrix2d noise = covariance_m2;
  const double kept = std::max(0.0, 1.0 - turned_m * turned_m / std::max(1e-9, 0.5 * noise.trace()));
  return kept * noise;
}

// Of a normal density at `off`, without the factor of 2 pi.
double LogDensity(const Eigen::Vector2d& off, const Eigen::Matrix2d& covariance) {
  return -0.5 * off.dot(covariance.inverse() * off) - 0.5 * Log(covariance.determinant());
}

}  // namespace

struct Body::Measured {
  enum class Kind { kNone, kEdge, kAtLeast };
  std::array<double, kDirections> reach_m{};  // from the origin of the map
  std::array<double, kDirections> variance_m2{};
  std::array<Kind, kDirections> kind{};
};

Body::Measured Body::Measure(const std::vector<Eigen::Vector2d>& seen_m, const Sides& sides, double range_m) const {
  const auto& directions = CompassDirections();
  Measured measured;
  measured.reach_m = SupportOf(seen_m);
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const auto& corner : seen_m) middle += corner / static_cast<double>(seen_m.size());
  Eigen::Vector2d sight = middle - sides.from_m;
  const double distance = sight.norm();
  if (distance > 0.0) sight /= distance;
  for (std::size_t i = 0; i < kDirections; ++i) {
    const double cosine = directions[i].dot(sight);
    const bool is_left = CrossOf(sight, directions[i]) > 0.0;
    const bool is_end = std::abs(cosine) <= kSideCosine;
    const bool is_hidden = is_left ? sides.is_left_hidden : sides.is_right_hidden;
    const bool is_edge = cosine < -kSideCosine || (is_end && !is_hidden);
    const double sd = is_end ? kEndSdM + kEndSdPerRange * range_m : kNearSdM + kNearSdPerRange * range_m;
    measured.variance_m2[i] = sd * sd;
    measured.kind[i] = is_edge ? Measured::Kind::kEdge : Measured::Kind::kAtLeast;
  }
  return measured;
}

Body::Body(const std::vector<Eigen::Vector2d>& seen_m, const Sides& sides, const Eigen::Matrix2d& noise_m2, double range_m) {
  const auto& directions = CompassDirections();
  const Measured measured = Measure(seen_m, sides, range_m);
  Eigen::Vector2d sight = Eigen::Vector2d::Zero();
  for (const auto& corner : seen_m) sight += (corner - sides.from_m) / static_cast<double>(seen_m.size());
  if (const double distance = sight.norm(); distance > 0.0) sight /= distance;
  const Eigen::Vector2d across(-sight.y(), sight.x());
  Eigen::Vector2d least = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d most = -least;
  for (const auto& corner : seen_m) {
    const Eigen::Vector2d place(sight.dot(corner), across.dot(corner));
    least = least.cwiseMin(place);
    most = most.cwiseMax(place);
  }
  const double width = most.y() - least.y();
  const double depth = std::max(most.x() - least.x(), std::clamp(0.5 * width, kLeastDepthM, kGreatestAssumedDepthM));
  const Eigen::Vector2d middle = (least.x() + 0.5 * depth) * sight + 0.5 * (least.y() + most.y()) * across;
  standing_ = middle;
  for (std::size_t i = 0; i < kDirections; ++i) {
    const double seen_reach = measured.reach_m[i] - directions[i].dot(middle);
    if (measured.kind[i] == Measured::Kind::kEdge) {
      sides_[i] = {seen_reach, measured.variance_m2[i], true};
    } else {
      const double assumed = 0.5 * depth * std::abs(directions[i].dot(sight)) + 0.5 * width * std::abs(directions[i].dot(across));
      const double sd = 0.3 + 0.5 * depth + 0.5 * std::min(width, kWidestBeamM);  // a boat seen from astern is much longer
      sides_[i] = {std::max(seen_reach, assumed), sd * sd, false};
    }
  }
  // The position is where the sides are counted from: it is known, the sides are not.
  standing_m2_ = Eigen::Matrix2d::Identity() * kLeastJitterM2 + NoiseOf(noise_m2, range_m);
  moving_ << middle, Eigen::Vector2d::Zero();
  moving_covariance_.setZero();
  moving_covariance_.topLeftCorner<2, 2>() = standing_m2_;
  moving_covariance_.bottomRightCorner<2, 2>() = Eigen::Matrix2d::Identity() * kFirstSpeedMps * kFirstSpeedMps;
  jitter_m2_ = kFirstJitterM2;
}

void Body::Predict(double dt_s) {
  standing_m2_ += Eigen::Matrix2d::Identity() * (kStandingWanderM2PerS * dt_s);
  Eigen::Matrix4d step = Eigen::Matrix4d::Identity();
  step.topRightCorner<2, 2>() = Eigen::Matrix2d::Identity() * dt_s;
  moving_ = step * moving_;
  moving_covariance_ = step * moving_covariance_ * step.transpose();
  const double q = kAccelerationMps2 * kAccelerationMps2;
  for (int i = 0; i < 2; ++i) {
    moving_covariance_(i, i) += q * dt_s * dt_s * dt_s / 3.0;
    moving_covariance_(i, i + 2) += q * dt_s * dt_s / 2.0;
    moving_covariance_(i + 2, i) += q * dt_s * dt_s / 2.0;
    moving_covariance_(i + 2, i + 2) += q * dt_s;
  }
  for (auto& side : sides_) side.variance_m2 += kSideWanderM2PerS * dt_s;
  log_likelihood_ratio_ *= std::max(0.0, 1.0 - dt_s / kMotionMemoryS);
}

Eigen::Vector2d Body::position_m() const { return prefers_moving_ ? Eigen::Vector2d(moving_.head<2>()) : standing_; }

Body::Shift Body::ShiftOf(const std::vector<Eigen::Vector2d>& seen_m, const Sides& sides, const Eigen::Matrix2d& noise_m2, double range_m) const {
  const auto& directions = CompassDirections();
  const Measured measured = Measure(seen_m, sides, range_m);
  const Eigen::Vector2d position = position_m();
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int num_edges = 0;
  for (std::size_t i = 0; i < kDirections; ++i) {
    if (measured.kind[i] != Measured::Kind::kEdge) continue;
    const double weight = 1.0 / (measured.variance_m2[i] + sides_[i].variance_m2);
    information += weight * directions[i] * directions[i].transpose();
    sum += weight * (measured.reach_m[i] - directions[i].dot(position) - sides_[i].reach_m) * directions[i];
    ++num_edges;
  }
  // The edges are of a few returns: as many directions are worth two.
  const Eigen::Matrix2d covariance = information.inverse();
  Shift shift{covariance * sum, covariance * (0.5 * num_edges) + Eigen::Matrix2d::Identity() * jitter_m2_ + NoiseOf(noise_m2, range_m), 0.0, 0.0};
  for (std::size_t i = 0; i < kDirections; ++i) {
    if (measured.kind[i] != Measured::Kind::kEdge) continue;
    const double left = measured.reach_m[i] - directions[i].dot(position + shift.shift_m) - sides_[i].reach_m;
    shift.misfit += left * left / (measured.variance_m2[i] + sides_[i].variance_m2 + jitter_m2_) / num_edges;
  }
  Eigen::Matrix2d spread = shift.covariance_m2 + moving_covariance_.topLeftCorner<2, 2>();
  if (!prefers_moving_) spread += standing_m2_;
  const Eigen::Vector2d& off = shift.shift_m;
  shift.off = off.dot(spread.inverse() * off);
  return shift;
}

void Body::Update(const std::vector<Eigen::Vector2d>& seen_m, const Sides& sides, const Eigen::Matrix2d& noise_m2, double range_m, bool grows) {
  const auto& directions = CompassDirections();
  const Measured measured = Measure(seen_m, sides, range_m);
  const Shift shift = ShiftOf(seen_m, sides, noise_m2, range_m);
  const Eigen::Vector2d measured_m = position_m() + shift.shift_m;

  if (num_measured_ >= 2) {
    const double bend_m2 = (measured_m - 2.0 * last_measured_[0] + last_measured_[1]).squaredNorm() / 12.0;
    jitter_m2_ = std::max(kLeastJitterM2, jitter_m2_ + kJitterGain * (std::min(bend_m2, kMostJitterM2) - jitter_m2_));
  }
  last_measured_ = {measured_m, last_measured_[0]};
  num_measured_ = std::min(num_measured_ + 1, 2);

  const Eigen::Vector2d off_standing = measured_m - standing_;
  const Eigen::Vector2d off_moving = measured_m - moving_.head<2>();
  const Eigen::Matrix2d spread_standing = standing_m2_ + shift.covariance_m2;
  const Eigen::Matrix2d spread_moving = moving_covariance_.topLeftCorner<2, 2>() + shift.covariance_m2;
  log_likelihood_ratio_ += kMotionWeight * (LogDensity(off_moving, spread_moving) - LogDensity(off_standing, spread_standing));
  log_likelihood_ratio_ = std::clamp(log_likelihood_ratio_, -kGreatestLogOdds, kGreatestLogOdds);

  const Eigen::Matrix2d gain_standing = standing_m2_ * spread_standing.inverse();
  standing_ += gain_standing * off_standing;
  standing_m2_ = (Eigen::Matrix2d::Identity() - gain_standing) * standing_m2_;
  const Eigen::Matrix<double, 4, 2> gain_moving = moving_covariance_.leftCols<2>() * spread_moving.inverse();
  moving_ += gain_moving * off_moving;
  moving_covariance_ -= gain_moving * spread_moving * gain_moving.transpose();
  moving_covariance_ = (0.5 * (moving_covariance_ + moving_covariance_.transpose())).eval();

  prefers_moving_ = log_likelihood_ratio_ + kMovingPriorLogOdds > 0.0;
  moving_probability_ = 1.0 / (1.0 + Exp(-(log_likelihood_ratio_ + kMovingPriorLogOdds)));
  const Eigen::Vector2d velocity = velocity_mps();
  const double speed = velocity.norm();
  const double speed_sd = speed > 0.0 ? std::sqrt(velocity.dot(moving_covariance_.bottomRightCorner<2, 2>() * velocity)) / speed : 0.0;
  if (speed < kLeastSpeedMps || speed < kSpeedSds * speed_sd) moving_probability_ = std::min(moving_probability_, 0.5);

  if (!grows) return;
  // Sides are counted from the position: what it is not known to does not change them, or they would follow a wrong speed.
  const Eigen::Vector2d position = position_m();
  const Eigen::Matrix2d spread = prefers_moving_ ? Eigen::Matrix2d(moving_covariance_.topLeftCorner<2, 2>()) : standing_m2_;
  for (std::size_t i = 0; i < kDirections; ++i) {
    const double off = measured.reach_m[i] - directions[i].dot(position) - sides_[i].reach_m;
    if (measured.kind[i] != Measured::Kind::kEdge && off <= 0.0) continue;
    const double variance = sides_[i].variance_m2;
    const double gain = variance / (variance + measured.variance_m2[i] + jitter_m2_ + directions[i].dot(spread * directions[i]));
    sides_[i].reach_m += gain * off;
    sides_[i].variance_m2 = std::max((1.0 - gain) * variance, kLeastSideSdM * kLeastSideSdM);
    sides_[i].is_seen = true;
  }
}

void Body::Loosen(double variance_m2) {
  standing_m2_ += Eigen::Matrix2d::Identity() * variance_m2;
  moving_covariance_.topLeftCorner<2, 2>() += Eigen::Matrix2d::Identity() * variance_m2;
  num_measured_ = 0;
  log_likelihood_ratio_ = std::min(log_likelihood_ratio_, 0.0);
}

void Body::Fade(double dt_s) {
  constexpr double kFadeS = 1.0;
  if (!prefers_moving_) return;
  moving_.tail<2>() *= std::max(0.0, 1.0 - dt_s / kFadeS);
  if (velocity_mps().norm() >= kLeastSpeedMps) return;
  standing_ = moving_.head<2>();
  standing_m2_ = moving_covariance_.topLeftCorner<2, 2>();
  log_likelihood_ratio_ = 0.0;
  moving_probability_ = 0.0;
  prefers_moving_ = false;
}

void Body::Include(const std::vector<Eigen::Vector2d>& outline_m) {
  const auto& directions = CompassDirections();
  const Support support = SupportOf(outline_m);
  for (std::size_t i = 0; i < kDirections; ++i) sides_[i].reach_m = std::max(sides_[i].reach_m, support[i] - directions[i].dot(position_m()));
}

void Body::Restart(const std::vector<Eigen::Vector2d>& seen_m, const Sides& sides, double range_m) {
  Body other(seen_m, sides, Eigen::Matrix2d::Zero(), range_m);
  other.moving_.tail<2>() = moving_.tail<2>();
  other.moving_covariance_.bottomRightCorner<2, 2>() = moving_covariance_.bottomRightCorner<2, 2>();
  other.log_likelihood_ratio_ = log_likelihood_ratio_;
  other.moving_probability_ = moving_probability_;
  other.prefers_moving_ = prefers_moving_;
  other.jitter_m2_ = jitter_m2_;
  *this = other;
}

std::vector<Eigen::Vector2d> Body::Outline() const {
  Support support;
  for (std::size_t i = 0; i < kDirections; ++i) support[i] = sides_[i].reach_m;
  auto corners = Polygon(support);
  const Eigen::Vector2d position = position_m();
  for (auto& corner : corners) corner += position;
  return corners;
}

double Body::SeenShare() const { return static_cast<double>(std::ranges::count_if(sides_, &Side::is_seen)) / static_cast<double>(kDirections); }

Eigen::Vector2d Body::middle_m() const {
  constexpr std::size_t kNorth = kDirections / 4;
  return {0.5 * (sides_[0].reach_m - sides_[Opposite(0)].reach_m), 0.5 * (sides_[kNorth].reach_m - sides_[Opposite(kNorth)].reach_m)};
}

Eigen::Vector2d Body::center_m() const { return position_m() + middle_m(); }

Eigen::Matrix4d Body::covariance() const {
  constexpr std::size_t kNorth = kDirections / 4;
  Eigen::Matrix4d covariance = moving_covariance_;
  if (!prefers_moving_) covariance.topLeftCorner<2, 2>() = standing_m2_;
  covariance(0, 0) += 0.25 * (sides_[0].variance_m2 + sides_[Opposite(0)].variance_m2);
  covariance(1, 1) += 0.25 * (sides_[kNorth].variance_m2 + sides_[Opposite(kNorth)].variance_m2);
  return covariance;
}

}  // namespace lookout::tracker
