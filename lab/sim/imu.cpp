#include "lab/sim/imu.hpp"

#include <GeographicLib/NormalGravity.hpp>
#include <cmath>

namespace lookout::sim {
namespace {

constexpr std::uint64_t kImuStream = 9;

// Earth's field near 43.6 N 72.2 W in 2026 by the World Magnetic Model 2025, rounded: east, north, up.
const Eigen::Vector3d kMagneticMapGauss(-0.046, 0.187, -0.487);
constexpr double kTemperatureCelsius = 25.0;

// International standard atmosphere, ISO 2533, below 11 km.
double PressureKpa(double height_m) { return 101.325 * std::pow(1.0 - 2.25577e-5 * height_m, 5.25588); }

// From the vessel frame (x forward, y port, z up) to the frame of the device.
Eigen::Vector3d ToDevice(const Eigen::Vector3d& v_vessel) { return {v_vessel.x(), -v_vessel.y(), -v_vessel.z()}; }

// Axis times angle of a rotation that is small against pi.
Eigen::Vector3d RotationVector(const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd angle_axis(rotation);
  return angle_axis.angle() * angle_axis.axis();
}

}  // namespace

Imu::Axis Imu::MakeAxis(double density, double start_bias, double stability, double time_constant_s, Random& random) {
  // White noise of a density in a band up to half of the sampling rate.
  return {start_bias * random.Normal(), MeasurementError(stability, time_constant_s), density / std::sqrt(ToSeconds(kPeriod))};
}

Imu::Imu(const OwnMotion& motion, const config::BoatFacts& boat, const ImuErrors& errors, Utime start, std::uint64_t seed)
    : motion_(motion), reference_point_above_water_m_(boat.reference_point_above_water_m), start_(start), random_(seed, kImuStream) {
  const auto datum = boat.datum.value_or(kLakeDatum);
  const auto& earth = GeographicLib::NormalGravity::WGS84();
  double north_mps2 = 0.0;
  double up_mps2 = 0.0;
  earth.Gravity(datum.latitude_deg, datum.ellipsoid_height_m, north_mps2, up_mps2);
  gravity_map_mps2_ = {0.0, 0.0, up_mps2};
  const double latitude_rad = DegToRad(datum.latitude_deg);
  earth_rate_map_radps_ = earth.AngularVelocity() * Eigen::Vector3d(0.0, std::cos(latitude_rad), std::sin(latitude_rad));
  pressure_kpa_ = PressureKpa(datum.ellipsoid_height_m);
  for (auto& axis : gyro_) {
    axis = MakeAxis(errors.gyro_density_radps_rthz, errors.gyro_start_bias_radps, errors.gyro_bias_stability_radps, errors.bias_time_constant_s,
                    random_);
  }
  for (auto& axis : accelerometer_) {
    axis = MakeAxis(errors.accelerometer_density_mps2_rthz, errors.accelerometer_start_bias_mps2, errors.accelerometer_bias_stability_mps2,
                    errors.bias_time_constant_s, random_);
  }
}

ImuMeasurement Imu::Truth(Utime time) const {
  const double period_s = ToSeconds(kPeriod);
  const double end_s = ToSeconds(time - start_);
  const auto state = [&](double time_s) { return StateAt(motion_, reference_point_above_water_m_, time_s); };
  const auto rotation = [&](double time_s) -> Eigen::Matrix3d { return state(time_s).T_map_vessel().linear(); };
  const auto position_m = [&](double time_s) { return state(time_s).position_map_m; };

  const Eigen::Matrix3d R_map_begin = rotation(end_s - period_s);
  const Eigen::Matrix3d R_map_end = rotation(end_s);
  const double middle_s = end_s - period_s / 2.0;
  const Eigen::Matrix3d R_vessel_map = rotation(middle_s).transpose();
  const Eigen::Vector3d rate_vessel_radps = RotationVector(R_map_begin.transpose() * R_map_end) / period_s;
  const Eigen::Vector3d acceleration_map_mps2 =
      (position_m(middle_s + period_s) - 2.0 * position_m(middle_s) + position_m(middle_s - period_s)) / (period_s * period_s);

  ImuMeasurement truth;
  truth.angular_rate_radps = ToDevice(rate_vessel_radps + R_vessel_map * earth_rate_map_radps_);
  truth.specific_force_mps2 = ToDevice(R_vessel_map * (acceleration_map_mps2 - gravity_map_mps2_));
  truth.magnetic_gauss = ToDevice(R_vessel_map * kMagneticMapGauss);
  truth.temperature_celsius = kTemperatureCelsius;
  truth.pressure_kpa = pressure_kpa_;
  return truth;
}

void Imu::AddErrors(std::array<Axis, 3>& axes, Eigen::Vector3d& values) {
  for (std::size_t i = 0; i < axes.size(); ++i) {
    auto& axis = axes[i];
    const double bias = axis.start_bias + axis.bias.Next(ToSeconds(kPeriod), random_);
    values[static_cast<Eigen::Index>(i)] += bias + axis.noise_sd * random_.Normal();
  }
}

ImuMeasurement Imu::Measure(Utime time) {
  auto measurement = Truth(time);
  AddErrors(gyro_, measurement.angular_rate_radps);
  AddErrors(accelerometer_, measurement.specific_force_mps2);
  return measurement;
}

}  // namespace lookout::sim
