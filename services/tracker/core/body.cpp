#include "services/tracker/core/body.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "services/tracker/core/body_measured.hpp"

namespace lookout::tracker {

namespace {

// The visible part of a thing changes with waves, aspect and beams that just meet it, over about a second: by so much, and by a share of its size.
constexpr double kOutlineSdM = 0.05;
constexpr double kOutlineSdPerSize = 0.03;
constexpr double kOutlineS = 0.5;
constexpr double kHeadingSdRad = 0.0035;  // 0.2 deg, of a compass with two antennas; it changes as the boat turns
// At first the visible share is unknown: so many times that error, less and less over some seconds.
constexpr double kFirstOutline = 1.5;
constexpr double kFirstOutlineS = 2.0;
// Some of a thing is never seen, however long it is looked at: overhangs, low parts, parts that do not reflect.
constexpr double kNeverSeenSdM = 0.05;
constexpr double kNeverSeenSdPerSize = 0.06;
// At first more and more of a thing comes into sight, as if it moved: by so much, and by a share of its size, in the time since it was seen first.
constexpr double kShownSdM = 0.1;
constexpr double kShownSdPerSize = 0.1;
constexpr double kLeastAgeS = 0.3;
constexpr double kLeastSideSdM = 0.005;
constexpr double kSideWanderM2PerS = 0.01 * 0.01;      // outlines change as a boat swings
constexpr double kStandingWanderM2PerS = 0.03 * 0.03;  // a moored thing swings, and positions by GNSS wander
constexpr double kAccelerationMps2 = 0.12;             // standard deviation over a second, of a thing that keeps its speed
constexpr double kManoeuvreMps2 = 0.8;                 // of a thing that does not; small craft
constexpr double kManoeuvreSds = 3.0;                  // mean distance of a second from the expected place: then it manoeuvres
constexpr double kManoeuvreS = 1.0;
// Turn rates: small boats turn by up to 20 deg/s, for some seconds.
constexpr double kTurnRateRadps = 0.1;
constexpr double kTurnS = 10.0;
constexpr double kTurnKnownRadps = 0.07;  // greatest standard deviation of a rate that is published
constexpr double kTurnKnownAfterS = 3.0;
constexpr double kTurnsAfterS = 1.0;
constexpr double kFirstSpeedMps = 5.0;  // standard deviation of an unknown value
constexpr double kFirstJitterM2 = 0.05 * 0.05;
constexpr double kLeastJitterM2 = 0.015 * 0.015;
constexpr double kMostJitterM2 = 4.0;
constexpr double kJitterGain = 0.1;
// Evidence of motion covers some 3 s.
constexpr double kMotionMemoryS = 3.0;
constexpr double kMovingPriorLogOdds = -2.0;
constexpr double kGreatestLogOdds = 12.0;
// The speed must be so many deviations above 0 for motion to begin, and half as many for it to go on.
constexpr double kLeastSpeedMps = 0.2;
constexpr double kSpeedSds = 3.0;
constexpr double kSpeedSdsOn = 1.5;
constexpr double kMovesAfterS = 0.6;
// Deviation that is added to the velocity of a thing that is not where it was expected. Rather than move, it shows another part, since waves show one
// part and hide another; a thing that jumps the same way twice moves. Chosen on seeds 21 to 24 of the own scenes.
constexpr double kJumpMps = 0.1;
constexpr double kGoesOnMps = 1.0;
constexpr double kJumpsWithinS = 3.0;
constexpr double kLoosenedS = 1.0;
// Deviation that is added to the velocity of a track that goes on as another track.
constexpr double kOtherTrackMps = 0.3;

// Errors of a speed by the surface, over the second of a shift: of the own place and heading, and a share of the speed, as another part of the hull
// is met.
constexpr double kOwnChangeMps = 0.15;
constexpr double kHeadingChangeRad = 0.003;
constexpr double kSurfaceSpeedShare = 0.03;
// How well a surface is found again differs from thing to thing: its speeds scatter by so many times the variance, in the mean of some seconds.
constexpr double kSurfaceScatterS = 2.0;
constexpr double kMostSurfaceScatter = 30.0;

constexpr std::size_t kMostParts = 3;  // beside the one that is seen

// Of a normal density at `off`, without the factor of 2 pi.
double LogDensity(const Eigen::Vector2d& off, const Eigen::Matrix2d& covariance) {
  return -0.5 * off.dot(covariance.inverse() * off) - 0.5 * Log(covariance.determinant());
}

}  // namespace

Body::Body(const std::vector<Eigen::Vector2d>& seen_m, const Sides& sides, const Eigen::Matrix2d& noise_m2, double range_m) {
  const auto first = FirstOutline(Measure(seen_m, sides, range_m), seen_m);
  standing_ = first_m_ = first.middle_m;
  sides_ = first.sides;
  // The position is the origin of the sides: it is known, the sides are not.
  standing_m2_ = Eigen::Matrix2d::Identity() * kLeastJitterM2 + NoiseOf(noise_m2, range_m);
  moving_ << first.middle_m, Eigen::Vector2d::Zero(), 0.0;
  moving_covariance_.setZero();
  moving_covariance_.topLeftCorner<2, 2>() = standing_m2_;
  moving_covariance_.block<2, 2>(2, 2) = Eigen::Matrix2d::Identity() * kFirstSpeedMps * kFirstSpeedMps;
  moving_covariance_(4, 4) = kTurnRateRadps * kTurnRateRadps;
  jitter_m2_ = kFirstJitterM2;
}

void Body::Predict(double dt_s) {
  standing_m2_ += Eigen::Matrix2d::Identity() * (kStandingWanderM2PerS * dt_s);
  // A coordinated turn, whose rate dies away.
  const Eigen::Vector2d velocity = velocity_mps();
  const auto [sine, cosine] = SinCosOf(moving_[4] * dt_s);
  Eigen::Matrix2d turn;
  turn << cosine, -sine, sine, cosine;
  if (moved_s_ >= kTurnsAfterS) turned_ = (turn * turned_).eval();
  const Eigen::Vector2d turned = turn * velocity;
  const Eigen::Vector2d across(-turned.y(), turned.x());
  const double kept = std::max(0.0, 1.0 - dt_s / kTurnS);
  MotionCovariance step = MotionCovariance::Identity();
  step.block<2, 2>(0, 2) = 0.5 * dt_s * (Eigen::Matrix2d::Identity() + turn);
  step.block<2, 2>(2, 2) = turn;
  step.block<2, 1>(0, 4) = 0.5 * dt_s * dt_s * across;
  step.block<2, 1>(2, 4) = dt_s * across;
  step(4, 4) = kept;
  moving_.head<2>() += 0.5 * dt_s * (velocity + turned);
  moving_.segment<2>(2) = turned;
  moving_[4] *= kept;
  moving_covariance_ = (step * moving_covariance_ * step.transpose()).eval();
  const double q = kAccelerationMps2 * kAccelerationMps2;
  for (int i = 0; i < 2; ++i) {
    moving_covariance_(i, i) += q * dt_s * dt_s * dt_s / 3.0;
    moving_covariance_(i, i + 2) += q * dt_s * dt_s / 2.0;
    moving_covariance_(i + 2, i) += q * dt_s * dt_s / 2.0;
    moving_covariance_(i + 2, i + 2) += q * dt_s;
  }
  moving_covariance_(4, 4) += (1.0 - kept * kept) * kTurnRateRadps * kTurnRateRadps;
  for (auto& side : sides_) side.variance_m2 += kSideWanderM2PerS * dt_s;
  for (auto& part : others_) {
    for (auto& side : part.sides) side.variance_m2 += kSideWanderM2PerS * dt_s;
  }
  log_likelihood_ratio_ *= std::max(0.0, 1.0 - dt_s / kMotionMemoryS);
  since_update_s_ += dt_s;
  since_jump_s_ += dt_s;
  age_s_ += dt_s;
}

Eigen::Vector2d Body::position_m() const { return prefers_moving_ ? Eigen::Vector2d(moving_.head<2>()) : standing_; }

Eigen::Matrix2d Body::velocity_covariance() const {
  const double shown_mps = (kShownSdM + kShownSdPerSize * size_m()) / std::max(age_s_, kLeastAgeS);
  return moving_covariance_.block<2, 2>(2, 2) + Eigen::Matrix2d::Identity() * shown_mps * shown_mps;
}

double Body::outline_sd_m() const {
  const double first = 1.0 + (kFirstOutline - 1.0) * std::max(0.0, 1.0 - age_s_ / kFirstOutlineS);
  return first * (kOutlineSdM + kOutlineSdPerSize * size_m());
}

void Body::Update(const std::vector<Eigen::Vector2d>& seen_m, const Sides& sides, const Eigen::Matrix2d& noise_m2, double range_m, bool grows) {
  const auto directions = SideDirections();
  Measured measured = Measure(seen_m, sides, range_m);
  if (const auto part = PartOf(measured, noise_m2, range_m)) {
    std::swap(sides_, others_[*part].sides);
    others_[*part].unseen_s = 0.0;
    num_measured_ = 0;
    parts_s_ = 0.0;
  }
  measured = MeasuredBy(measured, sides_);
  const Shift shift = ShiftOf(measured, sides_, noise_m2, range_m);
  const Eigen::Vector2d measured_m = position_m() + shift.shift_m;
  const double dt_s = std::max(since_update_s_, 0.01);
  since_update_s_ = 0.0;
  ForgetParts(dt_s);

  if (measured.short_m > 0.0) num_measured_ = 0;
  if (num_measured_ >= 2) {
    const double bend_m2 = (measured_m - 2.0 * last_measured_[0] + last_measured_[1]).squaredNorm() / 12.0;
    jitter_m2_ = std::max(kLeastJitterM2, jitter_m2_ + kJitterGain * (std::min(bend_m2, kMostJitterM2) - jitter_m2_));
  }
  last_measured_ = {measured_m, last_measured_[0]};
  num_measured_ = std::min(num_measured_ + 1, 2);

  // An error that lasts for a while counts once for that while: as noise of each scan it is as much greater.
  const Eigen::Vector2d across(-measured.sight.y(), measured.sight.x());
  const double outline_m = outline_sd_m();
  const double heading_m = kHeadingSdRad * range_m;
  const Eigen::Matrix2d staying_m2 = Eigen::Matrix2d::Identity() * (outline_m * outline_m) + heading_m * heading_m * across * across.transpose();
  const double times = std::max(1.0, shift.misfit) * std::max(1.0, 2.0 * kOutlineS / dt_s);
  Decide(measured_m, shift.covariance_m2 + times * staying_m2, dt_s);

  if (!grows) return;
  if (measured.short_m > 0.0) {
    TakePart(measured, dt_s);
    return;
  }
  parts_s_ = 0.0;
  // Displacement by this outline: the common part of all sides is motion, or an error of the place. A thing that has stood for long is placed best by
  // where it stands.
  const bool stands = !prefers_moving_ && age_s_ > kFirstOutlineS;
  const Eigen::Vector2d placed_m = stands ? standing_ : measured_m;
  for (std::size_t i = 0; i < kDirections; ++i) {
    const double off = measured.reach_m[i] - directions[i].dot(placed_m) - sides_[i].reach_m;
    if (measured.kind[i] != Measured::Kind::kEdge && off <= 0.0) continue;
    const double variance = sides_[i].variance_m2;
    const double gain = variance / (variance + measured.variance_m2[i] + jitter_m2_);
    sides_[i].reach_m += gain * off;
    if (measured.kind[i] != Measured::Kind::kEdge) continue;
    sides_[i].variance_m2 = std::max((1.0 - gain) * variance, kLeastSideSdM * kLeastSideSdM);
    sides_[i].is_seen = true;
  }
  if (!prefers_moving_ || !stands_out_) return;
  AssumeBy(measured);
  Center();
}

void Body::Decide(const Eigen::Vector2d& measured_m, const Eigen::Matrix2d& covariance_m2, double dt_s) {
  const Eigen::Vector2d off_standing = measured_m - standing_;
  const Eigen::Vector2d off_moving = measured_m - moving_.head<2>();
  const Eigen::Matrix2d spread_standing = standing_m2_ + covariance_m2;
  const Eigen::Matrix2d spread_moving = moving_covariance_.topLeftCorner<2, 2>() + covariance_m2;
  Weigh(LogDensity(off_moving, spread_moving) - LogDensity(off_standing, spread_standing));

  const Eigen::Matrix2d gain_standing = standing_m2_ * spread_standing.inverse();
  standing_ += gain_standing * off_standing;
  standing_m2_ = (Eigen::Matrix2d::Identity() - gain_standing) * standing_m2_;

  // A track that stays to one side of its predicted place manoeuvres.
  const double gain_mean = std::min(1.0, dt_s / kManoeuvreS);
  mean_off_m_ += gain_mean * (off_moving - mean_off_m_);
  const double off = mean_off_m_.dot(spread_moving.inverse() * mean_off_m_) / gain_mean;
  if (off > kManoeuvreSds * kManoeuvreSds) {
    moving_covariance_.block<2, 2>(2, 2) += Eigen::Matrix2d::Identity() * (kManoeuvreMps2 * kManoeuvreMps2 * dt_s);
  }
  CorrectMoving(0, off_moving, spread_moving);

  if (prefers_moving_ != (log_likelihood_ratio_ + kMovingPriorLogOdds > 0.0)) parts_s_ = 0.0;  // they are counted from another place
  prefers_moving_ = log_likelihood_ratio_ + kMovingPriorLogOdds > 0.0;
  moving_probability_ = 1.0 / (1.0 + Exp(-(log_likelihood_ratio_ + kMovingPriorLogOdds)));
  const Eigen::Vector2d velocity = velocity_mps();
  const double speed = velocity.norm();
  const double speed_sd = speed > 0.0 ? std::sqrt(velocity.dot(velocity_covariance() * velocity)) / speed : 0.0;
  // Where the outline jumps the way that the track goes, its velocity is less sure for a while, and it moves all the same.
  const bool is_loosened = stands_out_ && goes_on_ && since_jump_s_ < kLoosenedS;
  stands_out_ = speed > kLeastSpeedMps && (is_loosened || speed > (stands_out_ ? kSpeedSdsOn : kSpeedSds) * speed_sd);
  moved_s_ = stands_out_ && prefers_moving_ ? moved_s_ + dt_s : 0.0;
  if (moved_s_ < kMovesAfterS) moving_probability_ = std::min(moving_probability_, 0.5);
}

void Body::Update(const SurfaceShift& surface, const Sides& sides, const Eigen::Matrix2d& noise_m2, double range_m) {
  const Eigen::Vector2d sight = (center_m() - sides.from_m).normalized();
  const Eigen::Vector2d across(-sight.y(), sight.x());
  const double heading_m = kHeadingChangeRad * range_m;
  const Eigen::Matrix2d shift_m2 = surface.covariance_m2 + NoiseOf(noise_m2, range_m) + heading_m * heading_m * across * across.transpose();
  const Eigen::Vector2d seen_mps = surface.shift_m / surface.over_s;
  // In a turn it is the velocity of half of that time ago.
  const double turned_rad = 0.5 * surface.over_s * moving_[4];
  const double share2 = kSurfaceSpeedShare * kSurfaceSpeedShare + turned_rad * turned_rad;
  const double speed2 = kOwnChangeMps * kOwnChangeMps + share2 * seen_mps.squaredNorm();
  Eigen::Matrix2d noise = shift_m2 / (surface.over_s * surface.over_s) + speed2 * Eigen::Matrix2d::Identity();
  const Eigen::Vector2d off_moving = seen_mps - velocity_mps();
  const Eigen::Matrix2d expected = noise + moving_covariance_.block<2, 2>(2, 2);
  const double off = std::min(kMostSurfaceScatter, 0.5 * off_moving.dot(expected.inverse() * off_moving));
  surface_scatter_ += std::min(1.0, surface.new_s / kSurfaceScatterS) * (off - surface_scatter_);
  // Shifts over the same time say the same.
  noise *= std::max(1.0, surface_scatter_) * surface.over_s / surface.new_s;
  const Eigen::Matrix2d spread_moving = moving_covariance_.block<2, 2>(2, 2) + noise;
  Weigh(LogDensity(off_moving, spread_moving) - LogDensity(seen_mps, noise));
  CorrectMoving(2, off_moving, spread_moving);
}

// @param log_ratio  of the likelihood of a measurement, moving over standing
void Body::Weigh(double log_ratio) { log_likelihood_ratio_ = std::clamp(log_likelihood_ratio_ + log_ratio, -kGreatestLogOdds, kGreatestLogOdds); }

// @param first   0: the position was measured; 2: the velocity
// @param off     measured less expected
// @param spread  covariance of `off`
void Body::CorrectMoving(Eigen::Index first, const Eigen::Vector2d& off, const Eigen::Matrix2d& spread) {
  const Eigen::Matrix<double, 5, 2> gain = moving_covariance_.middleCols<2>(first) * spread.inverse();
  moving_ += gain * off;
  moving_covariance_ -= gain * spread * gain.transpose();
  moving_covariance_ = (0.5 * (moving_covariance_ + moving_covariance_.transpose())).eval();
}

void Body::Loosen(double variance_m2) {
  standing_m2_ += Eigen::Matrix2d::Identity() * variance_m2;
  moving_covariance_.topLeftCorner<2, 2>() += Eigen::Matrix2d::Identity() * variance_m2;
  num_measured_ = 0;
  log_likelihood_ratio_ = std::min(log_likelihood_ratio_, 0.0);
}

void Body::Translate(const Eigen::Vector2d& by_m) {
  standing_ += by_m;
  first_m_ += by_m;
  moving_.head<2>() += by_m;
  for (auto& measured : last_measured_) measured += by_m;
}

void Body::Fade(double dt_s) {
  constexpr double kFadeS = 1.0;
  if (!prefers_moving_) return;
  moving_.tail<3>() *= std::max(0.0, 1.0 - dt_s / kFadeS);
  if (velocity_mps().norm() >= kLeastSpeedMps) return;
  standing_ = moving_.head<2>();
  standing_m2_ = moving_covariance_.topLeftCorner<2, 2>();
  log_likelihood_ratio_ = 0.0;
  moving_probability_ = 0.0;
  prefers_moving_ = false;
}

void Body::MoveAs(const Body& before) {
  moving_.tail<3>() = before.moving_.tail<3>();
  moving_covariance_.bottomRightCorner<3, 3>() = before.moving_covariance_.bottomRightCorner<3, 3>();
  moving_covariance_.block<2, 3>(0, 2).setZero();
  moving_covariance_.block<3, 2>(2, 0).setZero();
  moving_covariance_.block<2, 2>(2, 2) += Eigen::Matrix2d::Identity() * (kOtherTrackMps * kOtherTrackMps);
  if (before.prefers_moving_ && !prefers_moving_) {
    moving_.head<2>() = standing_;
    parts_s_ = 0.0;
  }
  log_likelihood_ratio_ = std::max(before.log_likelihood_ratio_, 0.0);
  moving_probability_ = before.moving_probability_;
  prefers_moving_ = before.prefers_moving_;
  stands_out_ = before.stands_out_;
  moved_s_ = before.moved_s_;
  if (prefers_moving_) age_s_ = before.age_s_;
  jitter_m2_ = before.jitter_m2_;
}

void Body::AddPart(const std::vector<Eigen::Vector2d>& seen_m, const Sides& sides, double range_m, bool has_jumped) {
  // The place at the end of the scan.
  auto now_m = seen_m;
  auto now_sides = sides;
  if (prefers_moving_) {
    for (auto& corner : now_m) corner += sides.before_s * velocity_mps();
  }
  now_sides.before_s = 0.0;
  const auto first = FirstOutline(Measure(now_m, now_sides, range_m), now_m);
  // A moving thing shows another part of itself, unless it was not where it should be.
  const bool jumps = has_jumped || !prefers_moving_;
  const Eigen::Vector2d jump_m = first.middle_m - center_m();
  goes_on_ = jumps && since_jump_s_ < kJumpsWithinS && jump_m.dot(last_jump_m_) > 0.0;
  last_jump_m_ = jump_m;
  since_jump_s_ = 0.0;
  const double jump_mps = jumps ? (goes_on_ ? kGoesOnMps : kJumpMps) : 0.0;
  moving_covariance_.block<2, 2>(2, 2) += Eigen::Matrix2d::Identity() * (jump_mps * jump_mps);
  if (goes_on_) {
    // The earlier outline is where it was, and no part of the thing.
    others_.clear();
  } else {
    if (others_.size() == kMostParts) others_.erase(std::ranges::max_element(others_, {}, &Part::unseen_s));
    others_.push_back({sides_, 0.0});
  }
  sides_ = first.sides;
  const auto directions = SideDirections();
  for (std::size_t i = 0; i < kDirections; ++i) sides_[i].reach_m += directions[i].dot(first.middle_m - position_m());
  num_measured_ = 0;
  parts_s_ = since_update_s_ = 0.0;
}

Eigen::Vector2d Body::center_m() const { return position_m() + middle_m(); }

Eigen::Matrix4d Body::covariance() const {
  constexpr std::size_t kNorth = kDirections / 4;
  Eigen::Matrix4d covariance = moving_covariance_.topLeftCorner<4, 4>();
  if (!prefers_moving_) covariance.topLeftCorner<2, 2>() = standing_m2_;
  const auto whole = WholeSides();
  const Eigen::Vector2d middle_m2(0.25 * (whole[0].variance_m2 + whole[Opposite(0)].variance_m2),
                                  0.25 * (whole[kNorth].variance_m2 + whole[Opposite(kNorth)].variance_m2));
  covariance.bottomRightCorner<2, 2>() = velocity_covariance();
  const double never_seen_m = kNeverSeenSdM + kNeverSeenSdPerSize * size_m();
  covariance.topLeftCorner<2, 2>() += Eigen::Matrix2d::Identity() * (never_seen_m * never_seen_m);
  covariance.topLeftCorner<2, 2>() += turned_ * middle_m2.asDiagonal() * turned_.transpose();
  return covariance;
}

double Body::turn_rate_radps() const {
  const bool is_known = moved_s_ >= kTurnKnownAfterS && moving_covariance_(4, 4) < kTurnKnownRadps * kTurnKnownRadps;
  return is_known ? -moving_[4] : kNan;
}

}  // namespace lookout::tracker
