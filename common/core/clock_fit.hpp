// The relation of the host's clock to the sensor's, from the arrival of packets: offset and drift.
#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <optional>

namespace lookout {

/// A datagram may come late, not early: of the (host - sensor) of one second the least is the truest. Their slope is the drift (the median of the
/// slopes of all pairs, Theil and Sen: a third of the seconds may be bad); the offset is the least of the last two seconds, carried along that slope.
class ClockFit {
 public:
  /// @param time               by the sensor's oscillator, increasing
  /// @param host_minus_sensor  of a packet sent at `time`, at its arrival
  void Add(std::chrono::microseconds time, std::chrono::microseconds host_minus_sensor);

  /// Precondition: Add. @return host minus sensor now, without what datagrams take at the least
  std::chrono::microseconds offset() const;

  /// @return the last that was measured of the sensor's clock against the host's in 1e-6, positive when it is fast; nullopt before the
  ///         first ten seconds
  std::optional<double> drift_ppm() const;

  bool is_empty() const { return bins_.empty(); }

 private:
  struct Bin {
    std::chrono::microseconds end{0};
    std::chrono::microseconds time{0};  // of the least
    std::chrono::microseconds least{0};
  };

  void Measure();

  std::deque<Bin> bins_;  // by time; the last one is being filled
  std::chrono::microseconds now_{0};
  std::optional<double> slope_;  // of host minus sensor over sensor time
  int num_off_ = 0;              // samples in a row that are far off
};

}  // namespace lookout
