// Is the filter as good as it says? Motion and errors are drawn from the very models that it has, many times; the normalised errors must then have
// their chi-square distributions. And recordings of real sensors.
#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <random>
#include <sstream>
#include <vector>

#include "common/core/frames.hpp"
#include "services/navigator/core/lines.hpp"
#include "services/navigator/core/navigator.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/navigator/filter_measurements.hpp"

namespace lookout::navigator {
namespace {

namespace fs = std::filesystem;
const fs::path kData = support::kRecordings;

// A boat that goes round, rolls and pitches; its sensors with white noise, slow errors and biases as the filter supposes them.
class DrawnBoat {
 public:
  explicit DrawnBoat(unsigned seed) : random_(seed) {
    for (int axis = 0; axis < 3; ++axis) {
      gyro_bias_radps_[axis] = params_.gyro_bias_sd_radps * Normal();
      accelerometer_bias_mps2_[axis] = params_.accelerometer_bias_sd_mps2 * Normal();
    }
    for (auto& error : slow_fix_error_m_) error = 0.5 * kFixSdM * Normal();
    slow_heading_error_rad_ = 0.25 * kHeadingSdRad * Normal();
  }

  double Normal() { return normal_(random_); }

  struct Truth {
    Eigen::Vector3d p_map_m;
    Eigen::Vector3d velocity_map_mps;
    Eigen::Vector3d angles_rad;  // roll, pitch, heading
    Eigen::Matrix3d R_map_vessel;
  };
  static Truth At(double t) {
    Truth truth;
    const double turn = 0.1 * t;
    truth.p_map_m = {20.0 * std::sin(turn), 20.0 * std::cos(turn), 0.1 * std::sin(1.5 * t)};
    truth.velocity_map_mps = {2.0 * std::cos(turn), -2.0 * std::sin(turn), 0.15 * std::cos(1.5 * t)};
    truth.angles_rad = {0.08 * std::sin(1.3 * t), 0.05 * std::sin(1.7 * t), WrapTo2Pi(kPi / 2.0 + turn)};
    truth.R_map_vessel = RotationMapVessel(truth.angles_rad[2], truth.angles_rad[1], truth.angles_rad[0]);
    return truth;
  }

  ImuSample Imu(double t, double step_s) {
    const auto begin = At(t - step_s);
    const auto end = At(t);
    const auto middle = At(t - step_s / 2.0);
    const Eigen::AngleAxisd turn(begin.R_map_vessel.transpose() * end.R_map_vessel);
    const auto earth = filter::EarthAt({kLatitudeDeg, kLongitudeDeg, 0.0});
    const Eigen::Vector3d acceleration_mps2 =
        (end.velocity_map_mps - begin.velocity_map_mps) / step_s + 2.0 * earth.rate_level_radps.cross(middle.velocity_map_mps);
    ImuSample sample;
    sample.time = NoonPlus(t);
    sample.angular_velocity_radps = turn.angle() / step_s * turn.axis() + middle.R_map_vessel.transpose() * earth.rate_level_radps + gyro_bias_radps_;
    sample.specific_force_mps2 =
        middle.R_map_vessel.transpose() * (acceleration_mps2 + Eigen::Vector3d(0.0, 0.0, earth.gravity_mps2)) + accelerometer_bias_mps2_;
    for (int axis = 0; axis < 3; ++axis) {
      sample.angular_velocity_radps[axis] += params_.gyro_noise_radps_rthz / std::sqrt(step_s) * Normal();
      sample.specific_force_mps2[axis] += params_.accelerometer_noise_mps2_rthz / std::sqrt(step_s) * Normal();
    }
    return sample;
  }

  GnssFix MakeFix(double t, double since_last_s) {
    const auto truth = At(t);
    Eigen::Vector3d antenna_m = truth.p_map_m + truth.R_map_vessel * params_.p_vessel_antenna_m;
    const double kept = std::exp(-since_last_s / 60.0);
    for (int axis = 0; axis < 3; ++axis) {
      auto& slow_m = slow_fix_error_m_[static_cast<std::size_t>(axis)];
      slow_m = kept * slow_m + std::sqrt(1.0 - kept * kept) * 0.5 * kFixSdM * Normal();
      antenna_m[axis] += slow_m + std::sqrt(0.75) * kFixSdM * Normal();
    }
    const GeographicLib::LocalCartesian map(kLatitudeDeg, kLongitudeDeg, 0.0);
    GnssFix fix = Fix(t, "GGA");
    fix.quality = FixQuality::kRtkFixed;
    fix.horizontal_sd_m = fix.vertical_sd_m = kFixSdM;
    map.Reverse(antenna_m.x(), antenna_m.y(), antenna_m.z(), fix.position->latitude_deg, fix.position->longitude_deg, fix.direct_ellipsoid_height_m);
    return fix;
  }

  // Farther apart than errors of such sensors have in common.
  Attitude MakeAttitude(double t, double since_last_s) {
    const auto truth = At(t);
    const double kept = std::exp(-since_last_s / 30.0);
    slow_heading_error_rad_ = kept * slow_heading_error_rad_ + std::sqrt(1.0 - kept * kept) * 0.25 * kHeadingSdRad * Normal();
    auto attitude = AttitudeSample(t, 0.0, 0.0, 0.0);
    attitude.roll_rad = truth.angles_rad[0] + kTiltSdRad * Normal();
    attitude.pitch_rad = truth.angles_rad[1] + kTiltSdRad * Normal();
    attitude.heading_rad = WrapTo2Pi(truth.angles_rad[2] + slow_heading_error_rad_ + std::sqrt(1.0 - 0.25 * 0.25) * kHeadingSdRad * Normal());
    attitude.heading_sd_rad = kHeadingSdRad;
    attitude.roll_sd_rad = attitude.pitch_sd_rad = kTiltSdRad;
    return attitude;
  }

  const FilterParams& params() const { return params_; }

 private:
  static constexpr double kFixSdM = 0.05;
  static constexpr double kHeadingSdRad = DegToRad(0.4);
  static constexpr double kTiltSdRad = DegToRad(0.3);

  static FilterParams Params() {
    auto params = TestFilterParams();
    params.datum = GeodeticPlace{kLatitudeDeg, kLongitudeDeg, 0.0};
    params.p_vessel_antenna_m = {-0.8, 0.4, 0.9};
    params.velocity_sd_mps = 0.1;
    return params;
  }

  FilterParams params_ = Params();
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  Eigen::Vector3d gyro_bias_radps_;
  Eigen::Vector3d accelerometer_bias_mps2_;
  std::array<double, 3> slow_fix_error_m_{};
  double slow_heading_error_rad_ = 0.0;
};

struct Nees {
  double position = 0.0;
  double velocity = 0.0;
  double angles = 0.0;
  double nis = 0.0;
};

// Mean over the runs, per degree of freedom, at the end of each.
Nees MeanNees(int num_runs, double duration_s, double gap_from_s) {
  Nees mean;
  for (int run = 0; run < num_runs; ++run) {
    DrawnBoat boat(static_cast<unsigned>(run));
    PoseFilter filter(boat.params());
    const int num_steps = static_cast<int>(std::lround(duration_s * 100.0));
    for (int i = 1; i <= num_steps; ++i) {
      const double t = 0.01 * i;
      filter.Add(boat.Imu(t, 0.01));
      if (i % 20 == 0 && t < gap_from_s) filter.Add(boat.MakeFix(t, 0.2));
      if (i % 50 == 0) filter.Add(boat.MakeAttitude(t, 0.5));
      if (i % 2 == 0) filter.At(NoonPlus(t));
    }
    const auto pose = filter.At(NoonPlus(duration_s));
    const auto truth = DrawnBoat::At(duration_s);
    const Eigen::Vector3d position_m = pose.p_map_m - truth.p_map_m;
    const Eigen::Vector3d velocity_mps = pose.velocity_map_mps - truth.velocity_map_mps;
    const Eigen::Vector3d angles_rad(pose.roll_rad - truth.angles_rad[0], pose.pitch_rad - truth.angles_rad[1],
                                     WrapToPi(pose.heading_rad - truth.angles_rad[2]));
    const auto nees = [&](const Eigen::Vector3d& error, int row) {
      const Eigen::Matrix3d covariance = pose.covariance.block<3, 3>(row, row);
      return error.dot(covariance.inverse() * error) / 3.0 / num_runs;
    };
    mean.position += nees(position_m, 0);
    mean.velocity += nees(velocity_mps, 3);
    mean.angles += nees(angles_rad, 6);
    mean.nis += filter.nis_sum() / static_cast<double>(filter.num_nis_degrees()) / num_runs;
  }
  return mean;
}

// Of 60 runs with three degrees of freedom each, the mean lies between 0.72 and 1.33 in 998 of 1000 cases (chi-square of 180 degrees, 0.1 and 99.9
// %). A velocity that is not measured, gyroscopes' scale that the filter reckons with and that is right here, make some of it smaller.
TEST(Consistency, ErrorsAreWhatTheCovarianceSays) {
  const auto nees = MeanNees(60, 30.0, 1e9);
  std::printf("NEES per degree of freedom: position %.2f, velocity %.2f, attitude %.2f; NIS %.2f\n", nees.position, nees.velocity, nees.angles,
              nees.nis);
  for (const double value : {nees.position, nees.velocity, nees.angles}) {
    EXPECT_GT(value, 0.5);
    EXPECT_LT(value, 1.33);
  }
  EXPECT_NEAR(nees.nis, 1.0, 0.1);
}

TEST(Consistency, HoldsWhilePositionIsPropagated) {
  const auto nees = MeanNees(60, 28.0, 20.0);
  std::printf("after 8 s without a fix: position %.2f, velocity %.2f, attitude %.2f; NIS %.2f\n", nees.position, nees.velocity, nees.angles,
              nees.nis);
  for (const double value : {nees.position, nees.velocity, nees.angles}) {
    EXPECT_GT(value, 0.4);
    EXPECT_LT(value, 1.33);
  }
}

// A handheld IMU that lies still, is turned about, and spun: whenever it lies still again, up is where gravity says.
TEST(Recordings, OfAnImuHoldGravityWithinADegreeAtRest) {
  const fs::path file = kData / "imu/xio_fusion_sensor_data.csv";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not at hand";
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  PoseFilter filter(TestFilterParams());
  Eigen::Vector3d mean_force = Eigen::Vector3d::UnitZ();
  double rest_s = 0.0;
  double last_s = 0.0;
  double greatest_rad = 0.0;
  double rest_sum_s = 0.0;
  std::int64_t next_pose = 0;
  while (std::getline(in, line)) {
    std::istringstream fields(line);
    std::vector<double> values;
    for (std::string field; std::getline(fields, field, ',');) values.push_back(std::stod(field));
    ASSERT_GE(values.size(), 7U);
    const double time_s = values[0];
    const Eigen::Vector3d rate_degps(values[1], values[2], values[3]);
    const Eigen::Vector3d force_g(values[4], values[5], values[6]);
    filter.Add(ImuSample{NoonPlus(time_s), rate_degps * DegToRad(1.0), force_g * 9.80665});
    const bool is_at_rest = rate_degps.norm() < 1.0 && std::abs(force_g.norm() - 0.994) < 0.02;
    rest_s = is_at_rest ? rest_s + time_s - last_s : 0.0;
    mean_force = is_at_rest ? Eigen::Vector3d(0.95 * mean_force + 0.05 * force_g) : force_g;
    last_s = time_s;
    const auto grid = static_cast<std::int64_t>(std::floor(time_s / 0.02));
    if (grid < next_pose) continue;
    next_pose = grid + 1;
    const auto pose = filter.At(NoonPlus(0.02 * static_cast<double>(grid)));
    if (rest_s < 1.0) continue;
    rest_sum_s += 0.02;
    ASSERT_TRUE(pose.has_attitude);
    const Eigen::Vector3d up = RotationMapVessel(0.0, pose.pitch_rad, pose.roll_rad).transpose() * Eigen::Vector3d::UnitZ();
    greatest_rad = std::max(greatest_rad, std::acos(std::clamp(up.dot(mean_force.normalized()), -1.0, 1.0)));
  }
  std::printf("at rest for %.0f s, gravity off by %.2f deg at most\n", rest_sum_s, RadToDeg(greatest_rad));
  EXPECT_GT(rest_sum_s, 40.0);
  EXPECT_LT(RadToDeg(greatest_rad), 1.0);
}

// 20 minutes of a boat in Amsterdam with a receiver alone, 1 Hz: no leaps between poses, and near all fixes.
TEST(Recordings, OfABoatGiveASmoothTrack) {
  const fs::path file = kData / "nmea/signalk_gps.log";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not at hand";
  std::ifstream in(file);
  NavigatorParams params;
  params.max_sentence_latency = std::chrono::milliseconds(500);
  params.position_sd_m = 2.5;
  params.filter = TestFilterParams();
  params.use_lidar_odometry = false;  // no frame of its own where the heading is not known
  Navigator navigator(params);
  std::int64_t seq = 0;
  std::optional<Utime> now;
  std::optional<Pose> last;
  double greatest_step_m = 0.0;
  double greatest_from_fix_m = 0.0;
  int num_placed = 0;
  int num_poses = 0;
  const auto consume = [&](const Item& item) {
    const auto output = navigator.Consume(item);
    for (const auto& pose : output.poses) {
      ++num_poses;
      const bool is_placed = pose.status == PoseStatus::kOk || pose.status == PoseStatus::kNoHeading || pose.status == PoseStatus::kCoasting;
      if (is_placed) ++num_placed;
      if (is_placed && last && !std::isnan(last->latitude_deg)) {
        greatest_step_m = std::max(greatest_step_m, (pose.p_map_m - last->p_map_m).head<2>().norm());
      }
      last = pose;
    }
    if (output.fix && output.fix->position && last && !std::isnan(last->latitude_deg)) {
      double distance_m = 0.0;
      GeographicLib::Geodesic::WGS84().Inverse(output.fix->position->latitude_deg, output.fix->position->longitude_deg, last->latitude_deg,
                                               last->longitude_deg, distance_m);
      greatest_from_fix_m = std::max(greatest_from_fix_m, distance_m);
    }
  };
  constexpr auto kRecordedDay = std::chrono::sys_days(std::chrono::year(2014) / 4 / 3);  // of the recording
  for (std::string line; std::getline(in, line);) {
    while (!line.empty() && line.back() == '\r') line.pop_back();
    const auto parsed = ParseSentence(line);
    if (parsed.fault != SentenceFault::kNone) continue;
    // A second's sentences come a fifth of a second after it.
    const auto& time_of_day = parsed.sentence.time_of_day;
    if (time_of_day) now = std::max(now.value_or(kRecordedDay), kRecordedDay + *time_of_day + std::chrono::milliseconds(200));
    if (!now) continue;
    if (seq == 0) consume({*now, seq++, ItemKind::kStart, {}, {}});
    consume({*now, seq++, ItemKind::kSentence, kUdpSource, line});
  }
  std::printf("%d poses, %d placed; greatest step in 20 ms %.2f m, farthest from a fix %.1f m\n", num_poses, num_placed, greatest_step_m,
              greatest_from_fix_m);
  EXPECT_GT(num_poses, 50'000);
  EXPECT_GT(num_placed, num_poses * 98 / 100);
  EXPECT_LT(greatest_step_m, 3.0) << "a new fix with other satellites moves it within its deviation";
  EXPECT_LT(greatest_from_fix_m, 15.0);
}

}  // namespace
}  // namespace lookout::navigator
