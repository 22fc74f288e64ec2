// The computer's clock against the UTC of the receivers, and with it the time of each measurement.
#pragma once

#include <chrono>
#include <optional>

#include "common/core/clock_fit.hpp"
#include "common/core/utime.hpp"
#include "services/navigator/core/measurement.hpp"

namespace lookout::navigator {

/// The state that UtcClock keeps of one source.
struct SourceClock {
  std::optional<Utime> last_utc;   // of the source's last measurement
  Utime last_time{};               // of the last measurement, on the time scale of POSE
  std::optional<Utime> dated_utc;  // of the source's last sentence, with or without a measurement, and (dated_arrival) when it came: gives the day to
                                   // sentences without a date
  Utime dated_arrival{};
  bool has_date = false;               // a sentence held a date; until then the day is guessed by the computer's clock
  bool has_measured = false;           // the last sentence told a measurement; else its time is the receiver's own clock
  std::optional<Utime> last_backward;  // last UTC that was refused because it ran back
  int num_backward = 0;
  int num_leaps = 0;  // leap seconds that the source went through, and (last_leap) the midnight of the last
  std::optional<std::chrono::sys_days> last_leap;
  Utime last_arrival{};     // arrival of the source's last new instant
  bool is_forward = false;  // that instant was after the one before; false for the later of two receivers on one line
  ClockFit fit;             // of arrival less UTC (leap seconds counted on), less the source's delay where known

  bool KnowsOffset() const { return !fit.is_empty() && fit.is_settled(); }
};

/// A receiver's delay cannot be distinguished from a clock that is off by as much. So while arrivals lie within `max_latency` of the UTC in
/// sentences, the computer's clock counts as UTC; sources whose delay is known (config) measure what it is off below that, which corrects
/// measurements without a time. When all sources agree that it is farther off, it is another time scale: the one in which POSE goes on, and
/// measurements are brought into it by the least of (arrival - UTC).
///
/// A sentence that comes late says nothing of the clock: see ClockFit. It was measured when it says. Through a leap second, in which UTC comes
/// twice, measurements go on evenly.
class UtcClock {
 public:
  /// The clock is called off from max_latency on, and not below this; and right again below this share of it.
  static constexpr std::chrono::milliseconds kMinOff{100};
  static constexpr double kShareToStayOff = 0.8;
  /// Datagrams overtake each other. A source whose time runs back by more is refused ...
  static constexpr std::chrono::seconds kMaxBackward{1};
  /// ... until so many of its sentences in a row run forward from there: its clock was set.
  static constexpr int kMinForward = 10;

  explicit UtcClock(std::chrono::microseconds max_latency) : max_latency_(max_latency) {}

  /// @param latency      delay of the source; nullopt = not known
  /// @param is_measured  false: from a receiver without a fix, whose clock may begin anywhere and so does not correct the computer's
  /// @return nullopt when the source's time runs backwards
  std::optional<MeasurementTime> OfSentence(SourceClock& source, Utime arrival, std::chrono::microseconds time_of_day,
                                            std::optional<std::chrono::sys_days> date, std::optional<std::chrono::microseconds> latency,
                                            bool is_measured = true);

  /// Date and time of a sentence that measures nothing (ZDA).
  void OnDate(SourceClock& source, Utime arrival, Utime utc) const;

  /// A burst of sentences of one epoch is shorter than this at 9600 baud with three of them; epochs are 50 ms apart or more.
  static constexpr std::chrono::milliseconds kBurst{50};
  /// The lateness of sentences of one source differs by less than this. A sentence that is late by more waited somewhere.
  static constexpr std::chrono::milliseconds kMinLateness{300};

  /// Lateness of a sentence without a time. Where one of the same source with a time came with it, kBurst before at most, and was late by
  /// `min_lateness` or more, it was as late itself.
  MeasurementTime OfArrival(const SourceClock& source, Utime arrival, std::optional<std::chrono::microseconds> latency,
                            std::chrono::microseconds min_lateness = kMinLateness) const;

  /// Whether a sentence with a time came kBurst before `arrival` at most, whose lateness is known.
  static bool IsBehindTimedSentence(const SourceClock& source, Utime arrival);

  /// The lead of the time scale of POSE over UTC, leap seconds counted on: it steps where the clock is found off, or right again.
  std::chrono::microseconds pose_minus_even_utc() const { return off_; }

  /// Computer's clock less UTC; 0 while it counts as UTC.
  std::chrono::microseconds host_minus_utc() const { return off_ + std::chrono::seconds(num_leaps_); }

 private:
  static bool IsBackward(SourceClock& source, Utime utc, bool has_date);
  void NoteLeapSecond(SourceClock& source, Utime arrival, Utime utc, std::chrono::microseconds latency) const;
  bool IsUsable(const SourceClock& source, std::chrono::microseconds host_minus_utc) const;
  void LearnFrom(SourceClock& source, Utime arrival, Utime utc, std::optional<std::chrono::microseconds> latency, bool is_usable);
  void CompareWithUtc(SourceClock& source, Utime arrival);
  void UseHostAsUtc();

  std::chrono::microseconds max_latency_;
  std::chrono::microseconds off_{0};  // computer's clock less UTC, leap seconds counted on
  bool is_off_ = false;
  int num_leaps_ = 0;  // of the source that was compared last: the computer's clock, which did not get them, is this many seconds ahead
  ClockFit off_fit_;   // while is_off_
  ClockFit fine_fit_;  // while not, of sources whose delay is known
  // The last source that says that the clock is right, or off by off_, and when.
  const SourceClock* agreeing_ = nullptr;
  Utime last_agreement_{};
};

}  // namespace lookout::navigator
