// One measured quantity along time: its last samples, from which a value near them is read.
#pragma once

#include <chrono>
#include <optional>

#include "common/core/utime.hpp"

namespace lookout::navigator {

struct TrackParams {
  bool is_angle = true;                    // differences go the short way round, values are given as the last sample plus a difference, not wrapped
  double max_rate = 0.0;                   // per second: a greater rate is a jump of the sensor, not a motion
  std::chrono::microseconds max_carry{0};  // so far beyond the last sample the rate counts; beyond that the value is held
  double drift = 0.0;                      // growth of the standard deviation per second away from a sample
};

/// A value read from a track.
struct TrackValue {
  double value = 0.0;
  double sd = 0.0;
  double rate = 0.0;  // per second; 0 where it is held
};

class Track {
 public:
  /// Two samples farther apart say nothing about what is between them.
  static constexpr std::chrono::seconds kMaxSpacing{1};
  /// Samples nearer than this give no rate: a sensor's noise would be all of it.
  static constexpr std::chrono::milliseconds kMinSpacing{10};

  explicit Track(const TrackParams& params) : params_(params) {}

  /// @return whether the sample was taken: its time is after that of the last
  bool Add(Utime time, double value, double sd);

  /// @return between the last samples: on the line through them; after them: carried on along it; nullopt when no sample is within `max_age`
  std::optional<TrackValue> At(Utime time, std::chrono::microseconds max_age) const;

 private:
  struct Sample {
    Utime time;
    double value = 0.0;
    double sd = 0.0;
  };
  // The newest sample that is far enough before the last to give a rate.
  const std::optional<Sample>& Previous() const;
  // Of the stretch between that and the last, where it gives one.
  std::optional<double> Rate() const;

  TrackParams params_;
  // older_ to newer_ to the sample after newer_: each at least kMinSpacing apart.
  std::optional<Sample> older_;
  std::optional<Sample> newer_;
  std::optional<Sample> last_;
};

}  // namespace lookout::navigator
