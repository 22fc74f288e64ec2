#include "lab/sim/imu.hpp"

#include <gtest/gtest.h>

#include "tests/unit/sim/sim_fixture.hpp"

namespace lookout::sim {
namespace {

using namespace std::chrono_literals;

const Utime kImuStart = Utime(1'781'532'600s);
constexpr double kPeriodS = 0.01;
constexpr double kEarthRateRadps = 7.292115e-5;

// Round an ellipse in waves.
OwnMotion LivelyMotion() {
  OwnMotion motion;
  motion.semi_axes_m = {20.0, 12.0};
  motion.period_s = 50.0;
  motion.leeway_rad = {{0.05, 7.0, 0.3}};
  motion.roll_rad = {{DegToRad(8.0), 3.1, 0.0}, {DegToRad(2.0), 1.7, 1.0}};
  motion.pitch_rad = {{DegToRad(5.0), 2.6, 2.0}};
  motion.heave_m = {{0.2, 3.0, 0.5}};
  return motion;
}

Eigen::Vector3d FlipYz(const Eigen::Vector3d& v) { return {v.x(), -v.y(), -v.z()}; }

Eigen::Matrix3d RotationAt(const OwnMotion& motion, double time_s) { return StateAt(motion, 0.5, time_s).T_map_vessel().linear(); }

// In the vessel frame. The datum is at 43.63 N.
Eigen::Vector3d EarthRate(const Eigen::Matrix3d& R_map_vessel) {
  const double latitude_rad = DegToRad(43.63);
  return R_map_vessel.transpose() * (kEarthRateRadps * Eigen::Vector3d(0.0, std::cos(latitude_rad), std::sin(latitude_rad)));
}

Eigen::Matrix3d Turn(const Eigen::Vector3d& rotation_vector) {
  const double angle_rad = rotation_vector.norm();
  if (angle_rad == 0.0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle_rad, rotation_vector / angle_rad).toRotationMatrix();
}

// Attitude after 10 s by gyroscopes alone, from the true one at the start: angle between it and the true one.
template <typename MeasureFunction>
double AttitudeErrorRad(const OwnMotion& motion, MeasureFunction&& measure) {
  Eigen::Matrix3d R_map_vessel = RotationAt(motion, 0.01);
  for (int i = 2; i <= 1001; ++i) {
    const ImuMeasurement sample = measure(kImuStart + i * 10ms);
    const Eigen::Vector3d rate_radps = FlipYz(sample.angular_rate_radps) - EarthRate(R_map_vessel);
    R_map_vessel = R_map_vessel * Turn(rate_radps * kPeriodS);
  }
  return Eigen::AngleAxisd(R_map_vessel.transpose() * RotationAt(motion, 10.01)).angle();
}

TEST(Imu, AtRestSeesGravityAndTheTurnOfTheEarthAlone) {
  OwnMotion motion;  // bow to the north
  const Imu imu(motion, SmallBoat(), {}, kImuStart, 1);
  const auto truth = imu.Truth(kImuStart + 1s);
  // WGS84 at 43.63 N, 201 m: 9.8042 m/s2 by Somigliana's formula and the free-air gradient.
  EXPECT_NEAR(truth.specific_force_mps2.x(), 0.0, 1e-6);
  EXPECT_NEAR(truth.specific_force_mps2.y(), 0.0, 1e-6);
  EXPECT_NEAR(truth.specific_force_mps2.z(), -9.8042, 5e-4) << "z is down, and what holds the boat up points up";
  EXPECT_NEAR(truth.angular_rate_radps.x(), kEarthRateRadps * std::cos(DegToRad(43.63)), 1e-9);
  EXPECT_NEAR(truth.angular_rate_radps.y(), 0.0, 1e-9);
  EXPECT_NEAR(truth.angular_rate_radps.z(), -kEarthRateRadps * std::sin(DegToRad(43.63)), 1e-9);
  EXPECT_GT(truth.magnetic_gauss.z(), 0.4) << "on the northern half the field points down";
  EXPECT_NEAR(truth.pressure_kpa, 98.93, 0.05);
}

TEST(Imu, SignsAreThoseOfForwardStarboardDown) {
  // At time 0 of a sine: roll to starboard, then bow up, at 0.1 rad/s; a turn to starboard at 0.2 rad/s.
  OwnMotion motion;
  motion.roll_rad = {{0.1 / kTwoPi, 1.0, 0.0}};
  const Utime time = kImuStart + 1s + 5ms;  // the mean over -5 to +5 ms about a whole period
  EXPECT_NEAR(Imu(motion, SmallBoat(), {}, kImuStart, 1).Truth(time).angular_rate_radps.x(), 0.1, 1e-3);
  motion.roll_rad.clear();
  motion.pitch_rad = {{0.1 / kTwoPi, 1.0, 0.0}};
  EXPECT_NEAR(Imu(motion, SmallBoat(), {}, kImuStart, 1).Truth(time).angular_rate_radps.y(), 0.1, 1e-3);
  motion.pitch_rad.clear();
  motion.leeway_rad = {{0.2 / kTwoPi, 1.0, 0.0}};
  EXPECT_NEAR(Imu(motion, SmallBoat(), {}, kImuStart, 1).Truth(time).angular_rate_radps.z(), 0.2, 1e-3);
}

TEST(Imu, ABoatInATurnFeelsItsCentre) {
  // Counter-clockwise round a circle of 10 m at 2 pi m/s: 3.948 m/s2 to port.
  OwnMotion motion;
  motion.semi_axes_m = {10.0, 10.0};
  motion.period_s = 10.0;
  const auto truth = Imu(motion, SmallBoat(), {}, kImuStart, 1).Truth(kImuStart + 3s);
  EXPECT_NEAR(truth.specific_force_mps2.y(), -kTwoPi * kTwoPi / 10.0, 1e-3);
  EXPECT_NEAR(truth.specific_force_mps2.x(), 0.0, 0.02);
  EXPECT_NEAR(truth.angular_rate_radps.z(), -kTwoPi / 10.0, 1e-3) << "to port is negative";
}

TEST(Imu, TrueRatesIntegratedGiveBackTheTrueAttitude) {
  const auto motion = LivelyMotion();
  const Imu imu(motion, SmallBoat(), {}, kImuStart, 1);
  EXPECT_LT(AttitudeErrorRad(motion, [&](Utime time) { return imu.Truth(time); }), DegToRad(0.001));
}

TEST(Imu, MeasuredRatesIntegratedGiveBackTheTrueAttitudeWithinTheNoise) {
  const auto motion = LivelyMotion();
  // Per axis after 10 s: noise 0.008 deg/s/sqrt(Hz) x sqrt(10 s) = 0.025 deg, biases of 120 and 8 deg/h: 0.33 and 0.02 deg.
  const double sd_rad = DegToRad(std::hypot(0.025, 10.0 * std::hypot(120.0, 8.0) / 3600.0));
  double sum_of_squares = 0.0;
  constexpr int kNumSeeds = 20;
  for (std::uint64_t seed = 1; seed <= kNumSeeds; ++seed) {
    Imu imu(motion, SmallBoat(), {}, kImuStart, seed);
    const double error_rad = AttitudeErrorRad(motion, [&](Utime time) { return imu.Measure(time); });
    EXPECT_LT(error_rad, 4.0 * std::sqrt(3.0) * sd_rad) << "seed " << seed;
    sum_of_squares += error_rad * error_rad;
  }
  const double rms_rad = std::sqrt(sum_of_squares / kNumSeeds);
  EXPECT_GT(rms_rad, 0.5 * std::sqrt(3.0) * sd_rad) << "the noise that is promised is there";
  EXPECT_LT(rms_rad, 1.5 * std::sqrt(3.0) * sd_rad);
}

TEST(Imu, SpecificForceIntegratedGivesBackTheTrueVelocity) {
  const auto motion = LivelyMotion();
  const Imu imu(motion, SmallBoat(), {}, kImuStart, 1);
  const auto velocity = [&](double time_s) -> Eigen::Vector3d {
    return (StateAt(motion, 0.5, time_s + 1e-3).position_map_m - StateAt(motion, 0.5, time_s - 1e-3).position_map_m) / 2e-3;
  };
  Eigen::Vector3d v_map_mps = velocity(0.01);
  const auto rest = Imu(OwnMotion{}, SmallBoat(), {}, kImuStart, 1).Truth(kImuStart + 1s);
  const Eigen::Vector3d gravity_mps2(0.0, 0.0, rest.specific_force_mps2.z());
  for (int i = 2; i <= 1001; ++i) {
    const auto sample = imu.Truth(kImuStart + i * 10ms);
    v_map_mps += kPeriodS * (RotationAt(motion, (i - 0.5) * kPeriodS) * FlipYz(sample.specific_force_mps2) + gravity_mps2);
  }
  EXPECT_LT((v_map_mps - velocity(10.01)).norm(), 2e-3);
}

TEST(Imu, NoiseHasTheDensityThatIsPromised) {
  OwnMotion motion;
  ImuErrors errors;
  Imu imu(motion, SmallBoat(), errors, kImuStart, 3);
  const auto truth = imu.Truth(kImuStart + 1s);
  double gyro_square = 0.0;
  double force_square = 0.0;
  Eigen::Vector3d last_rate = imu.Measure(kImuStart + 20ms).angular_rate_radps;
  Eigen::Vector3d last_force = truth.specific_force_mps2;
  constexpr int kCount = 6000;
  for (int i = 0; i < kCount; ++i) {
    const auto sample = imu.Measure(kImuStart + 30ms + i * 10ms);
    gyro_square += (sample.angular_rate_radps - last_rate).squaredNorm() / 6.0;  // three axes, two samples: without the bias
    if (i > 0) force_square += (sample.specific_force_mps2 - last_force).squaredNorm() / 6.0;
    last_rate = sample.angular_rate_radps;
    last_force = sample.specific_force_mps2;
  }
  EXPECT_NEAR(std::sqrt(gyro_square / kCount), DegToRad(0.08), DegToRad(0.08) * 0.05);
  EXPECT_NEAR(std::sqrt(force_square / kCount), 0.037 / 60.0 * 10.0, 0.037 / 6.0 * 0.05);
}

TEST(MeasurementError, KeepsItsDeviationAndItsTimeConstant) {
  Random random(1, 100);
  double square = 0.0;
  double product = 0.0;
  constexpr int kCount = 200'000;
  MeasurementError error(2.0, 10.0);
  double last = error.Next(1.0, random);
  for (int i = 0; i < kCount; ++i) {
    const double value = error.Next(1.0, random);
    square += value * value;
    product += value * last;
    last = value;
  }
  EXPECT_NEAR(std::sqrt(square / kCount), 2.0, 0.1);
  EXPECT_NEAR(product / square, std::exp(-0.1), 0.01);
  MeasurementError white(2.0, 0.0);
  double white_product = 0.0;
  last = white.Next(1.0, random);
  for (int i = 0; i < kCount; ++i) {
    const double value = white.Next(1.0, random);
    white_product += value * last;
    last = value;
  }
  EXPECT_NEAR(white_product / kCount / 4.0, 0.0, 0.01);
  EXPECT_EQ(MeasurementError().Next(1.0, random), 0.0);
}

}  // namespace
}  // namespace lookout::sim
