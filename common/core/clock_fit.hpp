// The relation of the host's clock to a source's, from the arrival of its messages: offset and drift.
#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <optional>

namespace lookout {

/// A message can arrive late, never early: of all (host - source) within one second the least is nearest to the truth. The slope of these is the
/// drift (median of the slopes of all pairs, Theil and Sen); the offset is the least of the last two seconds, extrapolated along that slope.
///
/// - An arrival earlier than the offset allows proves that the host's clock was set back, or that the offset was of late messages: it counts at once.
/// - A later arrival is a late message, or the host's clock was set forward. A stall whose queue is then drained looks like such a step, but
///   returns to the old offset. So it counts as a step when for three seconds of both clocks nothing arrives in time and the lateness does not
///   shrink. Until then, and while the lateness shrinks, the offset stays.
class ClockFit {
 public:
  /// Crystals are good to 100 ppm at worst, and there are two of them.
  static constexpr double kMaxDriftPpm = 200.0;

  /// @param time             by the source's clock, increasing. One that comes out of order, or again, is ignored; one that goes back by more than
  ///                         two seconds starts a new fit
  /// @param host_minus_time  of a message sent at `time`, at its arrival
  void Add(std::chrono::microseconds time, std::chrono::microseconds host_minus_time);

  /// Precondition: Add. @return host minus source now, without what messages take at the least
  std::chrono::microseconds offset() const;

  /// @return the last that was measured of the source's clock against the host's in 1e-6, positive when it is fast, within kMaxDriftPpm; nullopt
  ///         before the first ten seconds
  std::optional<double> drift_ppm() const;

  bool is_empty() const { return bins_.empty(); }

  /// Messages came in time by one offset for three seconds of both clocks: it is the offset of the clocks, not of a queue that is being drained.
  bool is_settled() const { return is_settled_; }

 private:
  struct Sample {
    std::chrono::microseconds time{0};
    std::chrono::microseconds host_minus_time{0};

    std::chrono::microseconds host() const { return time + host_minus_time; }
  };
  struct Bin {
    std::chrono::microseconds end{0};
    Sample least;
  };

  struct Late {
    std::chrono::microseconds host{0};  // of the first
    Sample least;
  };

  std::chrono::microseconds Carried(const Sample& sample, std::chrono::microseconds time) const;
  void Begin(const Sample& sample);
  void OnLate(const Sample& sample);
  void OnTimely(const Sample& sample);
  void Measure();

  std::deque<Bin> bins_;   // of timely messages, by time; the last one is being filled
  Sample first_;           // of the timely ones since the offset was found
  Sample last_;            // of the timely ones
  std::deque<Late> late_;  // since the last timely one: the least of each part of a second of the host's
  std::chrono::microseconds last_late_{0};
  std::chrono::microseconds now_{0};
  std::optional<double> slope_;  // of host minus source over the source's time
  int num_samples_ = 0;          // since the offset was found, at most as many as it takes to settle
  int num_early_ = 0;            // in a row that are impossibly early by far
  bool is_settled_ = false;
};

}  // namespace lookout
