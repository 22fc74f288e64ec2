// Heading, roll, pitch and heave at a time, out of HDT and PASHR.
#pragma once

#include <chrono>
#include <optional>

#include "services/navigator/core/measurement.hpp"
#include "services/navigator/core/pose.hpp"
#include "services/navigator/core/track.hpp"

namespace lookout::navigator {

struct AttitudeParams {
  std::chrono::microseconds max_age{0};  // a sample is carried on for so long
  // Standard deviations where the sentence says none.
  double heading_sd_rad = 0.0;
  double tilt_sd_rad = 0.0;
};

struct HeadingEstimate {
  HeadingSource source = HeadingSource::kNone;
  double heading_rad = 0.0;  // 0 to 2 pi
  double sd_rad = 0.0;
  double rate_radps = 0.0;  // clockwise
};

struct TiltEstimate {
  double roll_rad = 0.0;
  double roll_sd_rad = 0.0;
  double pitch_rad = 0.0;
  double pitch_sd_rad = 0.0;
};

class AttitudeTracker {
 public:
  explicit AttitudeTracker(const AttitudeParams& params);

  /// @return whether the sample was newer than all of its kind
  bool Add(const Attitude& attitude);

  /// PASHR where it is alive, for it carries its time and its accuracy; else HDT.
  std::optional<HeadingEstimate> HeadingAt(Utime time) const;

  /// Both angles, or none.
  std::optional<TiltEstimate> TiltAt(Utime time) const;

  std::optional<double> HeaveAt(Utime time) const;

 private:
  AttitudeParams params_;
  Track pashr_heading_;
  Track hdt_heading_;
  Track roll_;
  Track pitch_;
  Track heave_;
};

}  // namespace lookout::navigator
