#include "services/navigator/core/vectornav.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/core/angles.hpp"
#include "common/core/utime.hpp"
#include "services/navigator/core/bounds.hpp"

namespace lookout::navigator {

namespace {

using namespace std::chrono_literals;
using std::chrono::microseconds;

// Bounds of what can be: beyond the ranges of VectorNav's sensors (2000 deg/s, 16 g).
constexpr double kMaxRateRadps = 100.0;
constexpr double kMaxForceMps2 = 1000.0;
constexpr double kMaxFieldGauss = 100.0;
constexpr double kMicroteslaPerGauss = 100.0;

constexpr auto kGpsEpoch = std::chrono::sys_days(std::chrono::year(1980) / 1 / 6);

// Days from which GPS time has been one second more ahead of UTC: 18 s since 2017. IERS, Bulletin C (hpiers.obspm.fr), list of leap seconds;
// Bulletins C 71 and 72 announce none until the end of 2026.
constexpr std::array kLeapDays{std::chrono::sys_days(std::chrono::year(1981) / 7 / 1), std::chrono::sys_days(std::chrono::year(1982) / 7 / 1),
                               std::chrono::sys_days(std::chrono::year(1983) / 7 / 1), std::chrono::sys_days(std::chrono::year(1985) / 7 / 1),
                               std::chrono::sys_days(std::chrono::year(1988) / 1 / 1), std::chrono::sys_days(std::chrono::year(1990) / 1 / 1),
                               std::chrono::sys_days(std::chrono::year(1991) / 1 / 1), std::chrono::sys_days(std::chrono::year(1992) / 7 / 1),
                               std::chrono::sys_days(std::chrono::year(1993) / 7 / 1), std::chrono::sys_days(std::chrono::year(1994) / 7 / 1),
                               std::chrono::sys_days(std::chrono::year(1996) / 1 / 1), std::chrono::sys_days(std::chrono::year(1997) / 7 / 1),
                               std::chrono::sys_days(std::chrono::year(1999) / 1 / 1), std::chrono::sys_days(std::chrono::year(2006) / 1 / 1),
                               std::chrono::sys_days(std::chrono::year(2009) / 1 / 1), std::chrono::sys_days(std::chrono::year(2012) / 7 / 1),
                               std::chrono::sys_days(std::chrono::year(2015) / 7 / 1), std::chrono::sys_days(std::chrono::year(2017) / 1 / 1)};

Utime UtcOfGps(Utime gps_time) {
  // At the k-th of these days GPS time is k seconds more than UTC.
  std::chrono::seconds leap(0);
  for (const auto day : kLeapDays) {
    if (gps_time >= day + leap + 1s) ++leap;
  }
  return gps_time - leap;
}

double AngleRad(FieldReader& fields, std::size_t index, double max_deg) { return DegToRad(fields.Number(index, -max_deg, max_deg)); }

double YawRad(FieldReader& fields, std::size_t index) {
  const double yaw_rad = AngleRad(fields, index, 360.0);
  return std::isnan(yaw_rad) ? kNan : WrapTo2Pi(yaw_rad);
}

Eigen::Vector3d Vector(FieldReader& fields, std::size_t first, double max) {
  return {fields.Number(first, -max, max), fields.Number(first + 1, -max, max), fields.Number(first + 2, -max, max)};
}

StrapdownSample Sample(FieldReader& fields, std::size_t first) {
  StrapdownSample sample;
  sample.magnetic_field_ut = Vector(fields, first, kMaxFieldGauss) * kMicroteslaPerGauss;
  sample.specific_force_mps2 = Vector(fields, first + 3, kMaxForceMps2);
  sample.angular_velocity_radps = Vector(fields, first + 6, kMaxRateRadps);
  return sample;
}

}  // namespace

VnIns ReadVnIns(FieldReader& fields) {
  constexpr double kSecondsPerWeek = 7 * 86400.0;
  constexpr int kMaxWeek = 9999;
  constexpr int kFaultBits = 0x78;
  VnIns ins;
  const double time_of_week_s = fields.Number(0, 0.0, kSecondsPerWeek);
  const int week = fields.Count(1, kMaxWeek);
  // Before it has had GNSS time the sensor says week 0.
  if (week > 0 && !std::isnan(time_of_week_s)) {
    const Utime utc = UtcOfGps(kGpsEpoch + std::chrono::weeks(week) + microseconds(std::llround(time_of_week_s * 1e6)));
    ins.date = std::chrono::floor<std::chrono::days>(utc);
    ins.time_of_day = utc - *ins.date;
  }
  const int status = std::max(fields.Hex(2), 0);
  ins.mode = static_cast<VnIns::Mode>(status & 3);
  ins.has_fault = (status & kFaultBits) != 0;
  ins.yaw_rad = YawRad(fields, 3);
  ins.pitch_rad = AngleRad(fields, 4, 90.0);
  ins.roll_rad = AngleRad(fields, 5, 180.0);
  const double latitude_deg = fields.Number(6, -90.0, 90.0);
  const double longitude_deg = fields.Number(7, -180.0, 180.0);
  // Before it has a position the sensor says 0, 0.
  if (!std::isnan(latitude_deg + longitude_deg) && (latitude_deg != 0.0 || longitude_deg != 0.0)) {
    ins.position = GeodeticPosition{latitude_deg, longitude_deg};
  }
  ins.ellipsoid_height_m = fields.Number(8, kMinHeightM, kMaxHeightM);
  ins.velocity_ned_mps = Vector(fields, 9, kMaxSpeedMps);
  ins.attitude_sd_rad = DegToRad(fields.Number(12, 0.0, 360.0));
  ins.position_sd_m = fields.Number(13, 0.0, kMaxSdM);
  ins.velocity_sd_mps = fields.Number(14, 0.0, kMaxSdM);
  return ins;
}

VnYmr ReadVnYmr(FieldReader& fields) { return {YawRad(fields, 0), AngleRad(fields, 1, 90.0), AngleRad(fields, 2, 180.0), Sample(fields, 3)}; }

VnImu ReadVnImu(FieldReader& fields) {
  VnImu imu{Sample(fields, 0)};
  fields.IsEmpty(10);  // temperature and pressure are not used, but must be there
  return imu;
}

}  // namespace lookout::navigator
