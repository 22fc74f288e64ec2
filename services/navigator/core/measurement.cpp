#include "services/navigator/core/measurement.hpp"

#include <cmath>

namespace lookout::navigator {

namespace {

using std::chrono::microseconds;

// u-blox ZED-F9P data sheet (UBX-17051259), horizontal accuracy: 1.5 m alone, 1.0 m with SBAS, 0.01 m + 1 ppm of the baseline with RTK.
constexpr double kDifferentialFactor = 1.0 / 1.5;
constexpr double kRtkFixedSdM = 0.02;  // baseline of 10 km
// Assumptions, not measured: a float solution is good to some decimetres; dead reckoning of the receiver is much worse than a fix.
constexpr double kRtkFloatSdM = 0.3;
constexpr double kDeadReckoningFactor = 4.0;

}  // namespace

MeasurementTime TimeOfMeasurement(Utime arrival, std::optional<microseconds> time_of_day, std::optional<std::chrono::sys_days> date,
                                  microseconds max_latency) {
  if (!time_of_day) return {arrival, arrival, false};
  if (date && std::chrono::abs(*date + *time_of_day - arrival) <= max_latency) return {*date + *time_of_day, arrival, true};
  const Utime best = OnTheDayNearest(arrival, *time_of_day);
  if (std::chrono::abs(best - arrival) > max_latency) return {arrival, arrival, false};
  return {best, arrival, true, date.has_value()};
}

double HorizontalSdM(FixQuality quality, double hdop, double position_sd_m) {
  const double scale = hdop > 0.0 ? hdop : 1.0;  // NaN and 0 say nothing
  switch (quality) {
    case FixQuality::kGnss:
    case FixQuality::kPps:
      return scale * position_sd_m;
    case FixQuality::kDifferential:
      return scale * position_sd_m * kDifferentialFactor;
    case FixQuality::kRtkFixed:
      return scale * kRtkFixedSdM;
    case FixQuality::kRtkFloat:
      return scale * kRtkFloatSdM;
    case FixQuality::kDeadReckoning:
      return scale * position_sd_m * kDeadReckoningFactor;
    default:
      return kNan;
  }
}

}  // namespace lookout::navigator
