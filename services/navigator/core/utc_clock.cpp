#include "services/navigator/core/utc_clock.hpp"

#include <cmath>
#include <cstdint>

namespace lookout::navigator {

namespace {

using std::chrono::days;
using std::chrono::microseconds;

// GPS counts weeks in 10 bits; receivers of the first kind fall back by so much when the count rolls over.
constexpr days kRollover(1024 * 7);
// Other sources have been silent for so long that they do not contradict.
constexpr std::chrono::seconds kSilence(5);

struct Resolved {
  Utime utc;
  bool is_date_refused = false;
};

Utime OnTheDayNearest(Utime near, microseconds time_of_day) {
  constexpr std::chrono::hours kHalfADay(12);
  return std::chrono::floor<days>(near - time_of_day + kHalfADay) + time_of_day;
}

// A whole number of rollovers brings a date back to the day of the computer; any other difference may be the computer's fault.
Resolved MendRollover(Utime utc, Utime expected) {
  const auto behind = expected - utc;
  const auto num_rollovers =
      std::llround(static_cast<double>(behind.count()) / static_cast<double>(std::chrono::duration_cast<microseconds>(kRollover).count()));
  const Utime mended = utc + num_rollovers * kRollover;
  const auto left = mended < expected ? expected - mended : mended - expected;
  if (num_rollovers == 0 || left > days(1)) return {utc, false};
  return {mended, true};
}

}  // namespace

bool UtcClock::IsBackward(SourceClock& source, Utime utc, bool has_date) {
  // The first date corrects the guess of those before it.
  if (has_date && !source.has_date) source.last_utc.reset();
  source.has_date = source.has_date || has_date;
  if (!source.last_utc || utc >= *source.last_utc - kMaxBackward) {
    // Those without a date follow the day of the others: they do not speak against a date that was set back.
    if (has_date || !source.has_date) source.num_backward = 0;
    return false;
  }
  const bool is_forward = source.num_backward > 0 && utc >= *source.last_backward;
  source.num_backward = is_forward ? source.num_backward + 1 : 1;
  source.last_backward = utc;
  return source.num_backward < kMinForward;
}

void UtcClock::LearnThatItIsOff(SourceClock& source, Utime arrival, microseconds host_minus_utc) {
  const bool is_the_same = source.num_off > 0 && std::chrono::abs(host_minus_utc - source.off) <= max_latency_;
  source.num_off = is_the_same ? source.num_off + 1 : 1;
  source.off = host_minus_utc;
  const bool is_contradicted = last_agreement_ && arrival - *last_agreement_ < kSilence;
  if (source.num_off < kMinSentences || is_contradicted) return;
  is_off_ = std::chrono::abs(host_minus_utc) > max_latency_;
  off_ = is_off_ ? host_minus_utc : microseconds(0);
  off_fit_ = ClockFit();
  fine_fit_ = ClockFit();
}

void UtcClock::LearnFrom(SourceClock& source, Utime arrival, microseconds host_minus_utc, std::optional<microseconds> latency) {
  source.num_off = 0;
  last_agreement_ = arrival;
  if (is_off_) {
    off_fit_.Add(arrival.time_since_epoch(), host_minus_utc - latency.value_or(microseconds(0)));
    off_ = off_fit_.offset();
  } else if (latency) {
    fine_fit_.Add(arrival.time_since_epoch(), host_minus_utc - *latency);
  }
}

std::optional<MeasurementTime> UtcClock::OfSentence(SourceClock& source, Utime arrival, microseconds time_of_day,
                                                    std::optional<std::chrono::sys_days> date, std::optional<microseconds> latency,
                                                    bool is_measured) {
  const Utime expected = arrival - off_;
  MeasurementTime when = TimeOfMeasurement(expected, time_of_day, date, max_latency_);
  Resolved resolved{when.time, when.is_date_refused};
  if (!when.is_from_sentence) {
    const Utime near = source.dated_utc ? *source.dated_utc + (arrival - source.dated_arrival) : expected;
    resolved = date ? MendRollover(*date + time_of_day, expected) : Resolved{OnTheDayNearest(near, time_of_day), false};
  }
  // The first fix sets a receiver's clock right.
  if (is_measured && !source.has_measured) source.last_utc.reset();
  source.has_measured = is_measured;
  if (IsBackward(source, resolved.utc, date.has_value())) return std::nullopt;
  const bool is_same_instant = source.last_utc == resolved.utc;
  source.last_utc = resolved.utc;
  source.dated_utc = resolved.utc;
  source.dated_arrival = arrival;

  when.arrival = arrival;
  when.utc = resolved.utc;
  when.has_sentence_utc = true;
  when.is_date_refused = resolved.is_date_refused;
  const auto host_minus_utc = arrival - resolved.utc;
  if (!when.is_from_sentence) {
    // Another sentence of an instant, or the same again, was not measured later. How late it is tells nothing new.
    when.time = is_same_instant ? source.last_time : arrival - latency.value_or(microseconds(0));
    if (is_measured && !is_same_instant) LearnThatItIsOff(source, arrival, host_minus_utc);
  } else {
    if (is_measured) LearnFrom(source, arrival, host_minus_utc, latency);
    when.time = resolved.utc + off_;
  }
  source.last_time = when.time;
  return when;
}

void UtcClock::OnDate(SourceClock& source, Utime arrival, Utime utc) const {
  source.dated_utc = MendRollover(utc, arrival - off_).utc;
  // The first date corrects the guess of those before it.
  if (!source.has_date) source.last_utc.reset();
  source.has_date = true;
  source.dated_arrival = arrival;
}

MeasurementTime UtcClock::OfArrival(Utime arrival, std::optional<microseconds> latency) const {
  const auto fine = is_off_ || fine_fit_.is_empty() ? microseconds(0) : fine_fit_.offset();
  MeasurementTime when;
  when.time = arrival - fine - latency.value_or(microseconds(0));
  when.arrival = arrival;
  when.utc = when.time - off_;
  return when;
}

}  // namespace lookout::navigator
