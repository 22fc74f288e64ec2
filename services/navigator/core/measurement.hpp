// Measurements of sensors, with their times.
#pragma once

#include <chrono>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include "common/core/utime.hpp"
#include "services/navigator/core/nmea.hpp"

namespace lookout::navigator {

/// When something was measured.
struct MeasurementTime {
  Utime time;     // on the time scale of POSE: UTC of the sentence where usable, else arrival less the known part of its delay
  Utime arrival;  // at this computer, by its clock
  bool is_from_sentence = false;
  bool is_date_refused = false;  // the sentence's date is wrong, its time of day is right
  // In UTC: the sentence's, also where the computer's clock is far from it; else from the arrival by the fit of the clocks.
  Utime utc = time;
  bool has_sentence_utc = false;  // utc is the sentence's
  int num_leaps = 0;              // leap seconds that the source went through: in each the same UTC comes twice
};

/// Chooses between the time in a sentence and its arrival.
///
/// @param time_of_day  as in the sentence; nullopt = it has none
/// @param date         as in the sentence; nullopt = it has none. Without one, or where it is wrong (receivers whose week counter has rolled over),
///                     that day counts which brings the time nearest to the arrival
/// @param max_latency  the sentence's time is usable when it is not farther than this from the arrival, before or after (clocks differ)
MeasurementTime TimeOfMeasurement(Utime arrival, std::optional<std::chrono::microseconds> time_of_day, std::optional<std::chrono::sys_days> date,
                                  std::chrono::microseconds max_latency);

/// A position fix at the antenna, out of a sentence and earlier sentences of the same epoch.
struct GnssFix : FixValues {
  MeasurementTime when;
  std::string source;              // as in Item
  std::string_view sentence_type;  // Sentence::name
  bool is_gga() const { return sentence_type == "GGA" || sentence_type == "GNS"; }
  // The time scale of POSE was set since the fix before: the known place belongs to other instants.
  bool begins_time_scale = false;
};

/// Attitude of the vessel frame. Heading from true north clockwise, pitch positive bow up, roll positive starboard down.
struct Attitude : AttitudeValues {
  MeasurementTime when;
  std::string source;
  std::string_view sentence_type;  // Sentence::name
};

/// Velocity over ground, out of VTG, which has no time of its own.
struct GroundVelocity {
  Utime time;
  double speed_mps = kNan;
  double course_rad = kNan;
  std::string source{};  // as in Item
};

/// How fast the bow turns, out of ROT.
struct TurnRate {
  Utime time;
  double rate_radps = kNan;  // positive when the bow turns to starboard
};

/// One sample of a strapdown sensor whose axes are lined up with the boat, in the vessel frame (x forward, y port, z up). NaN = not said.
struct ImuSample {
  Utime time;
  Eigen::Vector3d angular_velocity_radps = kUnknownVector;
  Eigen::Vector3d specific_force_mps2 = kUnknownVector;  // at rest and level z is +9.81
};

/// @param sample  of a sensor that is lined up with the boat
inline ImuSample InVesselFrame(Utime time, const StrapdownSample& sample) {
  const auto turned = [](const Eigen::Vector3d& v) { return Eigen::Vector3d(v.x(), -v.y(), -v.z()); };
  return {time, turned(sample.angular_velocity_radps), turned(sample.specific_force_mps2)};
}

/// @param position_sd_m  of a fix without correction at HDOP 1, per axis
/// @param hdop           NaN = not said: 1 counts
/// @return standard deviation per axis; NaN when the fix was not measured
double HorizontalSdM(FixQuality quality, double hdop, double position_sd_m);

}  // namespace lookout::navigator
