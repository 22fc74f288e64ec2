#include "common/messages/pose_message.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "common/core/angles.hpp"
#include "common/core/utime.hpp"

namespace lookout::messages {

namespace {

// Bounds wide enough for any boat, so that arithmetic inside stays far from overflow.
constexpr double kMaxMapM = 1.4e7;  // the earth's diameter, and more: a datum may be wrong
constexpr double kMaxHeightM = 1e5;
constexpr double kMaxHeaveM = 1e3;
constexpr double kMaxVariance = 1e12;
constexpr std::int64_t kPoseGridUs = 20'000;  // pose_t: a multiple of it
// Rounding of a covariance that went through a filter.
constexpr double kCovarianceTolerance = 1e-6;

bool IsAtMost(double value, double bound) { return std::abs(value) <= bound; }  // NaN is not

// Rows of pose_t::covariance that are used: east, north, roll, pitch, heading.
constexpr std::array<std::size_t, 5> kCovarianceRows{0, 1, 6, 7, 8};

bool IsUnknownOrZero(double value) { return std::isnan(value) || value == 0.0; }

// Symmetric, no variance below 0, no correlation above 1; what belongs to an unknown variance is unknown or 0.
bool IsCovariance(const double (&covariance)[9][9]) {
  for (std::size_t i = 0; i < 9; ++i) {
    const double variance = covariance[i][i];
    if (!std::isnan(variance) && !(variance >= 0.0 && variance <= kMaxVariance)) return false;
    for (std::size_t k = 0; k < i; ++k) {
      const double a = covariance[i][k];
      const double b = covariance[k][i];
      const double bound = std::sqrt(variance * covariance[k][k]) * (1.0 + kCovarianceTolerance);
      if (std::isnan(bound)) {
        if (!IsUnknownOrZero(a) || !IsUnknownOrZero(b)) return false;
      } else if (!IsAtMost(a, bound) || !IsAtMost(b, bound) || !IsAtMost(a - b, kCovarianceTolerance * bound)) {
        return false;
      }
    }
  }
  return true;
}

double OrZero(double value) { return std::isnan(value) ? 0.0 : value; }

bool IsDatum(const Datum& datum, bool is_relative) {
  if (is_relative) return datum.IsRelative() && datum.ellipsoid_height_m >= 1.0;
  return IsAtMost(datum.latitude_deg, 90.0) && IsAtMost(datum.longitude_deg, 180.0) && IsAtMost(OrZero(datum.ellipsoid_height_m), kMaxHeightM);
}

}  // namespace

std::variant<Pose, Fault> ToPose(const pose_t& message) {
  const auto time = UtimeFromWire(message.utime_us);
  if (!time || message.utime_us % kPoseGridUs != 0) return kPoseTime;
  if (message.status < pose_t::STATUS_OK || message.status > pose_t::STATUS_RELATIVE_TO_BOAT) return kPoseStatus;
  Pose pose;
  pose.time = *time;
  pose.is_placed = IsPlaced(message);
  pose.datum = {message.datum_latitude_deg, message.datum_longitude_deg, message.datum_ellipsoid_height_m};
  pose.position_map_m = {message.position_map_m[0], message.position_map_m[1], message.position_map_m[2]};
  pose.heading_rad = message.heading_rad;
  pose.pitch_rad = OrZero(message.pitch_rad);
  pose.roll_rad = OrZero(message.roll_rad);
  pose.heave_m = OrZero(message.heave_m);
  if (!IsAtMost(pose.pitch_rad, kPi) || !IsAtMost(pose.roll_rad, kPi) || !IsAtMost(pose.heave_m, kMaxHeaveM)) return kPoseNumber;
  if (pose.is_placed) {
    const auto& p_m = message.position_map_m;
    if (!IsAtMost(p_m[0], kMaxMapM) || !IsAtMost(p_m[1], kMaxMapM) || !IsAtMost(p_m[2], kMaxMapM) || !IsDatum(pose.datum, IsRelative(message)) ||
        !(pose.heading_rad >= 0.0 && pose.heading_rad <= kTwoPi)) {
      return kPoseNumber;
    }
    if (!IsCovariance(message.covariance)) return kPoseCovariance;
    for (int i = 0; i < 2; ++i) pose.velocity_map_mps[i] = message.velocity_map_mps[i];
    for (std::size_t i = 0; i < kCovarianceRows.size(); ++i) {
      for (std::size_t k = 0; k < kCovarianceRows.size(); ++k) {
        pose.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = message.covariance[kCovarianceRows[i]][kCovarianceRows[k]];
      }
    }
  }
  return pose;
}

}  // namespace lookout::messages
