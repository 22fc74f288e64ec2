// What a scan's measurement says of a body.
#include "services/tracker/core/body_measured.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

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
// A far side that was never seen is assumed as far behind as the visible side is wide: round things are, and a boat is as often seen from an end as
// from its side. Beyond a boat's beam it is rather seen from its side.
constexpr double kLeastDepthM = 0.15;
constexpr double kGreatestAssumedDepthM = 2.0;
constexpr double kWidestBeamM = 3.0;
constexpr double kFarSdM = 0.2;
constexpr double kFarSdPerWidth = 0.5;
// A measurement that is shorter than the known outline is a part: by so many deviations, and by a share of the size.
constexpr double kPartSds = 2.0;
constexpr double kPartShare = 0.15;

double CrossOf(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace

// The errors of mounting and heading, which turn all places about the boat, stay as they are from scan to scan: only the part of the covariance
// beyond theirs, about a degree, is noise.
Eigen::Matrix2d NoiseOf(const Eigen::Matrix2d& covariance_m2, double range_m) {
  constexpr double kTurnedRad = 0.015;
  const double turned_m = kTurnedRad * range_m;
  const double kept = std::max(0.0, 1.0 - turned_m * turned_m / std::max(1e-9, 0.5 * covariance_m2.trace()));
  return kept * covariance_m2;
}

Body::Measured Body::Measure(const std::vector<Eigen::Vector2d>& seen_m, const Sides& sides, double range_m) const {
  const auto directions = SideDirections();
  Measured measured;
  measured.reach_m = SupportFrom(seen_m);
  if (prefers_moving_) {
    for (std::size_t i = 0; i < kDirections; ++i) measured.reach_m[i] += directions[i].dot(velocity_mps()) * sides.before_s;
  }
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
  measured.sight = sight;
  return measured;
}

// Whether the measurement is shorter than this part.
Body::Measured Body::MeasuredBy(Measured measured, const Reaches& known) const {
  measured.short_m = 0.0;
  for (std::size_t i = 0; i < kDirections / 2; ++i) {
    const std::size_t j = Opposite(i);
    if (measured.kind[i] != Measured::Kind::kEdge || measured.kind[j] != Measured::Kind::kEdge || !known[i].is_seen || !known[j].is_seen) continue;
    const double known_m = known[i].reach_m + known[j].reach_m;
    const double sd_m = std::sqrt(measured.variance_m2[i] + measured.variance_m2[j] + known[i].variance_m2 + known[j].variance_m2);
    const double short_m = known_m - measured.reach_m[i] - measured.reach_m[j];
    if (short_m > kPartSds * sd_m + kPartShare * known_m) measured.short_m = std::max(measured.short_m, short_m);
  }
  return measured;
}

Body::First Body::FirstOutline(const Measured& measured, const std::vector<Eigen::Vector2d>& seen_m) const {
  const auto directions = SideDirections();
  const Eigen::Vector2d& sight = measured.sight;
  const Eigen::Vector2d across(-sight.y(), sight.x());
  Eigen::Vector2d least = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d most = -least;
  for (const auto& corner : seen_m) {
    const Eigen::Vector2d place(sight.dot(corner), across.dot(corner));
    least = least.cwiseMin(place);
    most = most.cwiseMax(place);
  }
  const double width = most.y() - least.y();
  const double depth = std::max(most.x() - least.x(), std::clamp(width, kLeastDepthM, kGreatestAssumedDepthM));
  First first{(least.x() + 0.5 * depth) * sight + 0.5 * (least.y() + most.y()) * across, {}};
  for (std::size_t i = 0; i < kDirections; ++i) {
    const double seen_reach = measured.reach_m[i] - directions[i].dot(first.middle_m);
    if (measured.kind[i] == Measured::Kind::kEdge) {
      first.sides[i] = {seen_reach, measured.variance_m2[i], true};
    } else {
      const double assumed = 0.5 * depth * std::abs(directions[i].dot(sight)) + 0.5 * width * std::abs(directions[i].dot(across));
      const double sd = kFarSdM + kFarSdPerWidth * std::min(width, kWidestBeamM);  // a boat seen from astern is much longer
      first.sides[i] = {std::max(seen_reach, assumed), sd * sd, false};
    }
  }
  return first;
}

Body::Shift Body::ShiftOf(const std::vector<Eigen::Vector2d>& seen_m, const Sides& sides, const Eigen::Matrix2d& noise_m2, double range_m) const {
  const auto measured = Measure(seen_m, sides, range_m);
  const auto part = PartOf(measured, noise_m2, range_m);
  const auto& known = part ? others_[*part].sides : sides_;
  return ShiftOf(MeasuredBy(measured, known), known, noise_m2, range_m);
}

std::optional<std::size_t> Body::PartOf(const Measured& measured, const Eigen::Matrix2d& noise_m2, double range_m) const {
  constexpr double kOfLess = 2.0;  // where only some of a known part would be seen: another part seen whole fits better
  const auto off_by = [&](const Reaches& known) {
    const auto shift = ShiftOf(MeasuredBy(measured, known), known, noise_m2, range_m);
    return shift.off + shift.misfit + (shift.is_part ? kOfLess : 0.0);
  };
  std::optional<std::size_t> best;
  if (others_.empty()) return best;
  double least = off_by(sides_);
  for (std::size_t k = 0; k < others_.size(); ++k) {
    const double off = off_by(others_[k].sides);
    if (off >= least) continue;
    least = off;
    best = k;
  }
  return best;
}

Body::Shift Body::ShiftOf(const Measured& measured, const Reaches& known, const Eigen::Matrix2d& noise_m2, double range_m) const {
  const auto directions = SideDirections();
  const Eigen::Vector2d position = position_m();
  constexpr double kNothing = 1e-6;  // 1/m2, where no side is an edge
  Eigen::Matrix2d information = kNothing * Eigen::Matrix2d::Identity();
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int num_edges = 0;
  if (measured.short_m > 0.0) {
    // A part lies somewhere in the outline: where it is seen is a guess.
    constexpr double kTimes = 2.0;
    const double weight = 1.0 / (kTimes * 0.25 * measured.short_m * measured.short_m);
    information = weight * Eigen::Matrix2d::Identity();
    Eigen::Vector2d off = Eigen::Vector2d::Zero();
    int num_pairs = 0;
    for (std::size_t i = 0; i < kDirections; ++i) {
      const std::size_t j = Opposite(i);
      if (measured.kind[i] != Measured::Kind::kEdge || measured.kind[j] != Measured::Kind::kEdge) continue;
      const double off_m = 0.5 * ((measured.reach_m[i] - known[i].reach_m) - (measured.reach_m[j] - known[j].reach_m)) - directions[i].dot(position);
      off += off_m * directions[i];
      ++num_pairs;
    }
    sum = weight / num_pairs * off;
  }
  for (std::size_t i = 0; i < kDirections; ++i) {
    const double beyond_m = measured.reach_m[i] - directions[i].dot(position) - known[i].reach_m;
    if (!measured.Tells(i, beyond_m)) continue;
    const double weight = 1.0 / (measured.variance_m2[i] + known[i].variance_m2);
    information += weight * directions[i] * directions[i].transpose();
    sum += weight * beyond_m * directions[i];
    ++num_edges;
  }
  // The edges are of a few returns: as many directions are worth two.
  const Eigen::Matrix2d covariance = information.inverse();
  const double times = std::max(1.0, 0.5 * num_edges);
  Shift shift{covariance * sum, covariance * times + Eigen::Matrix2d::Identity() * jitter_m2_ + NoiseOf(noise_m2, range_m), 0.0, 0.0};
  for (std::size_t i = 0; i < kDirections; ++i) {
    const double beyond_m = measured.reach_m[i] - directions[i].dot(position) - known[i].reach_m;
    if (!measured.Tells(i, beyond_m)) continue;
    const double left = beyond_m - directions[i].dot(shift.shift_m);
    shift.misfit += left * left / (measured.variance_m2[i] + known[i].variance_m2 + jitter_m2_) / num_edges;
  }
  shift.is_part = measured.short_m > 0.0;
  const auto off_by = [](const Eigen::Vector2d& off, const Eigen::Matrix2d& spread) { return off.dot(spread.inverse() * off); };
  const double outline_m = outline_sd_m();
  const Eigen::Matrix2d spread_moving =
      shift.covariance_m2 + moving_covariance_.topLeftCorner<2, 2>() + outline_m * outline_m * Eigen::Matrix2d::Identity();
  shift.off = off_by(position + shift.shift_m - moving_.head<2>(), spread_moving);
  // A thing that is thought to stand may have begun to move: then it is where it would be if it moved.
  if (!prefers_moving_) shift.off = std::min(shift.off, off_by(shift.shift_m, spread_moving + standing_m2_));
  return shift;
}

}  // namespace lookout::tracker
