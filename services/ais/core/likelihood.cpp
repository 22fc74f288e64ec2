#include "services/ais/core/likelihood.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"

namespace lookout::ais {

namespace {

// One fix in twenty is far worse than stated: multipath beside a quay, an antenna under a bridge.
constexpr double kFarShare = 0.05;
constexpr double kFarFactor = 3.0;

// Sizes: what AIS says is whole metres, and put in by people. One in eight is wrong.
constexpr double kWrongSizeShare = 0.12;
constexpr double kLengthSdM = 0.8;
constexpr double kLengthSdShare = 0.07;
constexpr double kBeamSdM = 0.6;
constexpr double kBeamSdShare = 0.1;
constexpr double kUsualLengthsM = 20.0;  // any other thing has a length and a width within so much
constexpr double kUsualBeamsM = 6.0;
// Seen share of a track's outline from which on its size is known; below, the size is a lower bound alone.
constexpr double kWellSeenShare = 0.45;

// Headings: one in eight is wrong.
constexpr double kWrongHeadingShare = 0.12;
constexpr double kHeadingSdRad = 0.14;         // a compass, and the side of a hull that is no rectangle
constexpr double kCourseAsHeadingSdRad = 0.3;  // leeway and current
constexpr double kLongRatio = 1.5;             // a rectangle has a direction where it is so much longer than wide

// Things that are no ship of AIS: most lie still.
constexpr double kStillShare = 0.6;
constexpr double kUsualSpeedMps = 3.0;
constexpr double kWrongSpeedShare = 0.03;
constexpr double kTrackVelocitySdMps = 0.25;
constexpr double kMostVelocityLogOdds = 4.0;

double Density(const Eigen::Vector2d& difference, const Eigen::Matrix2d& covariance) {
  const double determinant = covariance.determinant();
  const double exponent = -0.5 * difference.dot(covariance.inverse() * difference);
  return Exp(exponent) / (kTwoPi * std::sqrt(determinant));
}

double Density(double difference, double sd) { return Exp(-0.5 * (difference / sd) * (difference / sd)) / (sd * std::sqrt(kTwoPi)); }

double SizeLogOdds(double stated_m, double seen_m, double sd_m, double usual_m, bool is_well_seen) {
  if (std::isnan(stated_m) || std::isnan(seen_m)) return 0.0;
  // Larger than stated speaks against it however little was seen.
  if (!is_well_seen && seen_m <= stated_m + sd_m) return 0.0;
  const double likelihood = (1.0 - kWrongSizeShare) * Density(seen_m - stated_m, sd_m) + kWrongSizeShare / usual_m;
  const double log_odds = Log(likelihood * usual_m);
  return is_well_seen ? log_odds : std::min(log_odds, 0.0);
}

}  // namespace

double PositionLogOdds(const Eigen::Vector2d& mean_difference_m, const PredictedShip& ship, const TrackedThing& track, const Background& background) {
  const Eigen::Matrix2d covariance_m2 = ship.covariance_m2 + track.covariance_m2;
  const double near = Density(mean_difference_m, covariance_m2);
  const double far = Density(mean_difference_m, kFarFactor * kFarFactor * covariance_m2);
  // A place that no error explains has the density of next to nothing, not of nothing.
  constexpr double kLeast = 1e-12;
  return Log(std::max((1.0 - kFarShare) * near + kFarShare * far, kLeast) / background.tracks_per_m2);
}

double ShapeLogOdds(const Dimensions& dimensions, const TrackedThing& track) {
  const bool is_well_seen = track.seen_share >= kWellSeenShare;
  const double length_m = std::max(dimensions.length_m(), dimensions.beam_m());
  const double beam_m = std::min(dimensions.length_m(), dimensions.beam_m());
  return SizeLogOdds(length_m, track.length_m, kLengthSdM + kLengthSdShare * length_m, kUsualLengthsM, is_well_seen) +
         SizeLogOdds(beam_m, track.width_m, kBeamSdM + kBeamSdShare * beam_m, kUsualBeamsM, is_well_seen);
}

double HeadingLogOdds(const PredictedShip& ship, const TrackedThing& track) {
  if (std::isnan(ship.bow_rad) || std::isnan(track.length_bearing_rad) || track.seen_share < kWellSeenShare) return 0.0;
  if (!(track.length_m > kLongRatio * track.width_m)) return 0.0;
  // Which end is the bow a rectangle does not say.
  const double turned_rad = WrapTo2Pi(2.0 * (ship.bow_rad - track.length_bearing_rad));
  const double difference_rad = 0.5 * std::min(turned_rad, kTwoPi - turned_rad);
  const double sd_rad = ship.is_bow_measured ? kHeadingSdRad : kCourseAsHeadingSdRad;
  // Over a half turn, to which both ways belong.
  const double likelihood = (1.0 - kWrongHeadingShare) * Density(difference_rad, sd_rad) + kWrongHeadingShare / kPi;
  return Log(likelihood * kPi);
}

double VelocityLogOdds(const PredictedShip& ship, const TrackedThing& track) {
  if (!ship.velocity_map_mps.allFinite()) return 0.0;
  const Eigen::Matrix2d unit = Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d broad = unit * (kUsualSpeedMps * kUsualSpeedMps);
  const double track_variance = kTrackVelocitySdMps * kTrackVelocitySdMps;
  const Eigen::Matrix2d covariance = track.velocity_covariance + unit * (ship.velocity_sd_mps * ship.velocity_sd_mps + track_variance);
  const double same = (1.0 - kWrongSpeedShare) * Density(track.velocity_map_mps - ship.velocity_map_mps, covariance) +
                      kWrongSpeedShare * Density(track.velocity_map_mps, broad);
  const double other = kStillShare * Density(track.velocity_map_mps, track.velocity_covariance + unit * track_variance) +
                       (1.0 - kStillShare) * Density(track.velocity_map_mps, broad);
  constexpr double kLeast = 1e-12;
  return std::clamp(Log(std::max(same, kLeast) / std::max(other, kLeast)), -kMostVelocityLogOdds, kMostVelocityLogOdds);
}

}  // namespace lookout::ais
