// The filter's state at one instant: a nominal state, the covariance of its error, and the status of its aids.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "common/core/utime.hpp"
#include "services/navigator/core/filter/level.hpp"
#include "services/navigator/core/filter/motion_trial.hpp"
#include "services/navigator/core/filter/params.hpp"
#include "services/navigator/core/pose.hpp"

namespace lookout::navigator::filter {

/// Places in the error: where each part begins, and single elements that have a use of their own. All are true value minus estimate; the rotation is
/// that about the level frame's axes which turns the estimated attitude into the true one, radians (Sola, "Quaternion kinematics for the error-state
/// Kalman filter", arXiv:1711.02508, section 7, global errors).
enum Part : int {
  kPosition = 0,       // east, north, up, m
  kVelocity = 3,       // east, north, up, m/s
  kRotation = 6,       // about east, north, up, rad
  kRate = 9,           // rad/s, vessel frame: bias of the gyroscopes, or without them the rate itself
  kAcceleration = 12,  // m/s2: bias of the accelerometers in the vessel frame; without strapdown navigation, acceleration in the level frame
  kFixError = 15,      // common error of the receiver's positions for a while: east, north, up, m
  kHeadingError = 18,  // slow error of the compass, rad, clockwise
  kWaterLevel = 19,    // up of the origin while the boat lies still on calm water, m
  kScanPlace = 20,     // of the reference point at the end of the last scan: east, north, m, and rotation about up, rad (ScanPlace)
  kNumErrors = 23,

  kPositionEast = kPosition,
  kPositionNorth = kPosition + 1,
  kPositionUp = kPosition + 2,
  kVelocityEast = kVelocity,
  kVelocityUp = kVelocity + 2,
  kRotationUp = kRotation + 2,
  kFixErrorUp = kFixError + 2,
  kScanRotation = kScanPlace + 2,
};

using ErrorVector = Eigen::Matrix<double, kNumErrors, 1>;
using ErrorCovariance = Eigen::Matrix<double, kNumErrors, kNumErrors>;

/// The source of a slow error. With another sensor, or another kind of fix, the error begins anew.
enum class ErrorKind { kNone, kRtk, kGnss, kTwoAntennas, kCompass, kCourse };

/// Speed of a boat before it is measured: standard deviation of each component ("a boat at 3 m/s").
inline constexpr double kUnknownSpeedSdMps = 3.0;

/// A slow error: a first-order Gauss-Markov process.
struct ErrorModel {
  ErrorKind kind = ErrorKind::kNone;
  double sd = 0.0;
  double up_factor = 1.0;  // of a fix: deviation of up as a multiple of sd
  double time_constant_s = 1.0;
};

/// How long a measurement has been refused, one after the other.
struct Refusals {
  // Since when the difference to the state has not changed.
  std::optional<Utime> since;
  Eigen::Vector3d first_residual = Eigen::Vector3d::Zero();
  // Since when each refused measurement has agreed with the one before; then time and value of the last measurement.
  std::optional<Utime> agreeing_since;
  Utime last;
  GeodeticPlace last_place;  // of fixes
  Eigen::Vector3d last_angles_rad = Eigen::Vector3d::Zero();
};

/// When measurements of a kind were used.
struct UseTimes {
  std::optional<Utime> last;
  double interval_s = 0.0;  // between the last two, at most 2 s

  void Use(Utime time);
  /// Measurements have stopped when none has come for 1 s, or, of slow measurements, for one and a half of their intervals plus 0.5 s.
  bool IsStoppedAt(Utime time) const;
  bool IsWithin(Utime time, std::chrono::microseconds age) const { return last && time - *last <= age; }
};

/// The best estimate, to which the errors are added.
struct NominalState {
  // East, north and up near the boat: the frame of all that follows. nullopt: no place is known yet, and attitude is against east, north and up
  // there.
  std::optional<Level> level;

  // Of the vessel's origin: the place of the IMU in it. Without heading p_level_m is the place of the antenna in east and north, and q_level_vessel
  // holds roll and pitch only.
  Eigen::Vector3d p_level_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_level_mps = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_level_vessel = Eigen::Quaterniond::Identity();
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();          // see kRate
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  // see kAcceleration
  Eigen::Vector3d fix_error_m = Eigen::Vector3d::Zero();
  double heading_error_rad = 0.0;
  double water_level_m = 0.0;
  // See kScanPlace; heading clockwise from north.
  Eigen::Vector2d scan_p_level_m = Eigen::Vector2d::Zero();
  double scan_heading_rad = 0.0;
  // Turn rate of the vessel, in its frame: follows from the IMU or from `rate`.
  Eigen::Vector3d angular_velocity_radps = Eigen::Vector3d::Zero();

  Eigen::Matrix3d R_level_vessel() const { return q_level_vessel.toRotationMatrix(); }
};

/// The place from which the next motion of the odometer goes. It is a copy of the state at the end of a scan, with its covariance (stochastic
/// cloning: Roumeliotis and Burdick, ICRA 2002), so that a motion is compared with what the state itself has done since.
struct ScanPlace {
  std::optional<Utime> time;  // nullopt: no scan yet, or the state was set anew since the last scan
  bool has_position = false;
  bool has_heading = false;
};

/// Which parts of the state mean something, what propagates them, and which measurements came when.
struct AidingStatus {
  bool has_position = false;
  bool has_height = false;
  bool has_heading = false;
  bool has_tilt = false;  // measured; else level

  bool has_gyro = false;      // `rate` is a bias
  bool is_strapdown = false;  // `acceleration` is a bias
  // The known error of the IMU when it stopped.
  Eigen::Vector3d last_gyro_bias_radps = Eigen::Vector3d::Zero();
  Eigen::Vector3d last_accelerometer_bias_mps2 = Eigen::Vector3d::Zero();

  ErrorModel fix_error_model;
  double fix_error_begun_sd_m = 0.0;  // deviation of the fix error when this error began
  ErrorModel heading_error_model;
  HeadingSource heading_source = HeadingSource::kNone;

  UseTimes fix;
  UseTimes sensor_heading;  // of an attitude sensor or a compass
  UseTimes course;          // of a course over ground that serves as heading
  UseTimes attitude_heading;
  UseTimes tilt;
  UseTimes heave;
  UseTimes imu;
  UseTimes velocity;
  UseTimes timed_velocity;
  std::optional<Utime> last_water_aid;
  double position_sd_at_fix_m = 0.0;

  ScanPlace scan_place;
  UseTimes odometry;                                // motions that agreed with the state
  MotionTrial motion_trial;                         // how far they may be believed
  std::optional<Utime> odometry_contradicts_since;  // each since then was refused
  // Fixes or headings contradicted a state that went by the lidar: its motions are not used until then, and next time for so long.
  std::optional<Utime> odometry_refused_until;
  double odometry_refusal_s = 0.0;
  // When a motion last corrected the way, and when the turn.
  std::optional<Utime> lidar_led_way;
  std::optional<Utime> lidar_led_turn;
  // By how much a compass has turned less than the lidar says, clockwise; forgotten within minutes, since both err a little all the time.
  double heading_apart_rad = 0.0;

  Refusals fix_refusals;
  Refusals heading_refusals;
  Refusals tilt_refusals;

  // The IMU contradicted fixes or attitudes that agree with each other: it is not used until then, and next time for so long.
  std::optional<Utime> imu_refused_until;
  double imu_refusal_s = 0.0;

  // Specific force since the last levelling by it, and how much the IMU has moved lately.
  Eigen::Vector3d force_sum_mps2 = Eigen::Vector3d::Zero();
  int num_forces = 0;
  Eigen::Vector3d mean_force_mps2 = Eigen::Vector3d::Zero();
  double force_variance_mps2_2 = 1.0;

  /// By how much more than compass and lidar may differ they have turned apart, rad.
  double HeadingDoubtRad() const;

  /// The source of the heading.
  const UseTimes& heading() const { return heading_source == HeadingSource::kCourse ? course : sensor_heading; }
};

struct State {
  Utime time;
  NominalState nominal;
  ErrorCovariance covariance = ErrorCovariance::Zero();
  AidingStatus aiding;

  /// The greater of east and north.
  double HorizontalVarianceM2() const;
};

/// Place of the antenna as seen from the origin, vessel frame.
Eigen::Vector3d AntennaLever(const FilterParams& params);

/// Nothing is known. Position and height get a deviation only when they are first measured.
///
/// @param tilt_sd_rad  of a boat whose tilt was not measured
State FreshState(Utime time, double tilt_sd_rad);

/// The IMU led the state astray: its effects are removed, and it is not used for a while, twice as long where that was so not long before.
void RefuseImu(double tilt_sd_rad, State& state);
bool IsImuRefused(const State& state);

/// The state was wrong for long though the lidar told it: its motions are not used for a while, twice as long where that was so not long before.
///
/// @param led  when they last corrected the wrong part of the state; nothing is refused where that is long ago
void RefuseOdometry(const std::optional<Utime>& led, State& state);
bool IsOdometryRefused(const State& state);

/// The next specific force is the first of a new mean.
void BeginMeanForce(State& state);

/// Adds an error to the nominal state.
void Inject(const ErrorVector& error, State& state);

/// Gives a part of the error a new deviation, and no correlation with the rest.
template <int kSize>
void ResetError(int part, const Eigen::Matrix<double, kSize, 1>& sd, State& state) {
  state.covariance.middleRows<kSize>(part).setZero();
  state.covariance.middleCols<kSize>(part).setZero();
  state.covariance.block<kSize, kSize>(part, part).diagonal() = sd.cwiseAbs2();
}
void ResetError3(int part, double sd, State& state);

/// Roll (starboard down), pitch (bow up) and heading (clockwise from north) of an attitude.
Eigen::Vector3d AnglesOf(const Eigen::Matrix3d& R_level_vessel);

/// d(roll, pitch, heading) / d(rotation about east, north, up). Not for a bow that points straight up or down.
Eigen::Matrix3d AngleJacobian(const Eigen::Matrix3d& R_level_vessel);

/// @return v x (as a matrix)
Eigen::Matrix3d Cross(const Eigen::Vector3d& v);

/// Rotation by a vector: axis times angle.
Eigen::Quaterniond RotationBy(const Eigen::Vector3d& rotation_rad);

/// Turns the vessel about the up axis, clockwise from above, and the errors of its attitude with it. The place of the last scan is void.
void TurnClockwise(double angle_rad, State& state);

/// Turns the vessel to this roll and pitch, keeping its heading and the deviation of the heading. The tilt is measured from now on.
///
/// @param q_level_vessel  of any heading
void BeginTilt(const Eigen::Quaterniond& q_level_vessel, double sd_rad, State& state);

/// The reference point on the water and the heading, and how the error changes them: of east, north and the rotation about up.
struct PlanarPlace {
  Eigen::Vector2d p_level_m = Eigen::Vector2d::Zero();
  double heading_rad = 0.0;  // clockwise from north of the level frame
  Eigen::Matrix<double, 3, kNumErrors> jacobian = Eigen::Matrix<double, 3, kNumErrors>::Zero();
};
PlanarPlace PlanarPlaceOf(const FilterParams& params, const State& state);

/// Makes the present place the place of the last scan.
void SetScanPlace(const FilterParams& params, State& state);

/// Moves the place that p_level_m describes by `lever_level_m`, which turns with the vessel; east and north only. The place of the last scan is void.
void ShiftPosition(const Eigen::Vector3d& lever_level_m, State& state);

double SecondsBetween(Utime from, Utime to);

}  // namespace lookout::navigator::filter
