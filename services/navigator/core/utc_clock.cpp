#include "services/navigator/core/utc_clock.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace lookout::navigator {

namespace {

using namespace std::chrono_literals;
using std::chrono::days;
using std::chrono::microseconds;

// Other sources have been silent for so long that they do not contradict.
constexpr std::chrono::seconds kSilence(5);
// A second less the interval of a receiver, of 2 Hz and more.
constexpr std::chrono::milliseconds kMinLeapBack(400);
// A receiver of 1 Hz says the same instant twice, at least this far apart; sentences of one instant come within half a second at 4800 baud.
constexpr std::chrono::milliseconds kMinLeapRepeat(700);

}  // namespace

bool UtcClock::IsBackward(SourceClock& source, Utime utc, bool has_date) {
  // The first date corrects the guess of those before it.
  if (has_date && !source.has_date) source.last_utc.reset();
  source.has_date = source.has_date || has_date;
  if (!source.last_utc || utc >= *source.last_utc - kMaxBackward) {
    // Sources without a date follow the day of the others: they do not speak against a date that was set back.
    if (has_date || !source.has_date) source.num_backward = 0;
    return false;
  }
  const bool is_forward = source.num_backward > 0 && utc >= *source.last_backward;
  source.num_backward = is_forward ? source.num_backward + 1 : 1;
  source.last_backward = utc;
  return source.num_backward < kMinForward;
}

// A receiver says 23:59:60, which is the first second of the next month as utime counts, and then that second; or it says 59 or 00 twice. In any case
// its time goes back by a second while time goes on.
void UtcClock::NoteLeapSecond(SourceClock& source, Utime arrival, Utime utc, microseconds latency) const {
  const auto midnight = std::chrono::round<days>(utc);
  const bool is_new_month = std::chrono::year_month_day(midnight).day() == std::chrono::day(1);
  if (!is_new_month || utc < midnight - 1s || utc >= midnight + 1s || !source.last_utc || source.last_leap == midnight) return;
  const auto back = *source.last_utc - utc;
  const bool is_back = (back >= kMinLeapBack && back < 1s) || (back == 0us && arrival - source.last_arrival >= kMinLeapRepeat);
  const auto known = !source.KnowsOffset() ? off_ : source.fit.offset();
  const auto late = arrival - (utc + std::chrono::seconds(source.num_leaps)) - latency - known;
  if (!is_back || late < kMinLeapBack) return;
  ++source.num_leaps;
  source.last_leap = midnight;
}

// A sentence ahead of the clock is of another time scale. One behind it may have come late, where it is known when those come that do not.
bool UtcClock::IsUsable(const SourceClock& source, microseconds host_minus_utc) const {
  const auto ahead = host_minus_utc - off_;
  if (ahead < -max_latency_) return false;
  if (!source.KnowsOffset()) return ahead <= max_latency_;
  return std::chrono::abs(source.fit.offset() - off_) <= max_latency_;
}

void UtcClock::UseHostAsUtc() {
  if (is_off_) fine_fit_ = ClockFit();
  is_off_ = false;
  off_ = microseconds(0);
}

// The clock error by one source, once it is sure.
void UtcClock::CompareWithUtc(SourceClock& source, Utime arrival) {
  const auto off = source.fit.offset();
  const microseconds limit = std::max<microseconds>(max_latency_, kMinOff);
  const auto limit_now = is_off_ ? microseconds(std::llround(kShareToStayOff * static_cast<double>(limit.count()))) : limit;
  const bool is_right = std::chrono::abs(off) <= limit_now;
  // Only another source that spoke lately can contradict.
  const bool is_contradicted = agreeing_ != nullptr && agreeing_ != &source && std::chrono::abs(arrival - last_agreement_) < kSilence;
  if (source.num_leaps > 0 && std::chrono::abs(off + std::chrono::seconds(source.num_leaps)) < std::chrono::abs(off)) {
    // The computer's clock got the leap second: it is UTC again.
    source.num_leaps = 0;
    source.fit = ClockFit();
    return;
  }
  if (is_right) {
    UseHostAsUtc();
  } else if (!is_off_ || std::chrono::abs(off - off_) > max_latency_) {
    if (is_contradicted) return;
    is_off_ = true;
    off_fit_ = source.fit;
    off_ = off;
  }
  agreeing_ = &source;
  last_agreement_ = arrival;
  num_leaps_ = source.num_leaps;
}

void UtcClock::LearnFrom(SourceClock& source, Utime arrival, Utime utc, std::optional<microseconds> latency, bool is_usable) {
  const auto time = utc.time_since_epoch();
  const auto host_minus_utc = arrival - utc - latency.value_or(microseconds(0));
  source.fit.Add(time, host_minus_utc);
  if (is_usable && is_off_) {
    off_fit_.Add(time, host_minus_utc);
    off_ = off_fit_.offset();
  } else if (is_usable && latency) {
    fine_fit_.Add(time, host_minus_utc);
  }
  if (source.fit.is_settled()) CompareWithUtc(source, arrival);
}

std::optional<MeasurementTime> UtcClock::OfSentence(SourceClock& source, Utime arrival, microseconds time_of_day,
                                                    std::optional<std::chrono::sys_days> date, std::optional<microseconds> latency,
                                                    bool is_measured) {
  const Utime expected = arrival - off_ - std::chrono::seconds(source.num_leaps);
  MeasurementTime when = TimeOfMeasurement(expected, time_of_day, date, max_latency_);
  if (!when.is_from_sentence && date) {
    when.utc = MendRollover(*date + time_of_day, expected);
    when.is_date_refused = when.utc != *date + time_of_day;
  } else if (!when.is_from_sentence) {
    when.utc = OnTheDayNearest(source.dated_utc ? *source.dated_utc + (arrival - source.dated_arrival) : expected, time_of_day);
  }
  // The first fix sets a receiver's clock right.
  if (is_measured && !source.has_measured) {
    source.last_utc.reset();
    source.fit = ClockFit();
  }
  source.has_measured = is_measured;
  const int num_leaps_before = source.num_leaps;
  NoteLeapSecond(source, arrival, when.utc, latency.value_or(microseconds(0)));
  if (IsBackward(source, when.utc, date.has_value())) return std::nullopt;
  const bool is_same_instant = source.last_utc == when.utc && source.num_leaps == num_leaps_before;
  if (!is_same_instant) source.is_forward = source.last_utc && when.utc > *source.last_utc;
  source.last_utc = when.utc;
  source.dated_utc = when.utc;
  source.dated_arrival = arrival;
  if (!is_same_instant) source.last_arrival = arrival;

  when.arrival = arrival;
  when.has_sentence_utc = true;
  when.num_leaps = source.num_leaps;
  const Utime even_utc = when.utc + std::chrono::seconds(source.num_leaps);
  when.is_from_sentence = IsUsable(source, arrival - even_utc);
  if (is_measured && !is_same_instant) LearnFrom(source, arrival, even_utc, latency, when.is_from_sentence);
  if (when.is_from_sentence) {
    when.time = even_utc + off_;
  } else {
    // Another sentence of an instant, or the same again, was not measured later.
    when.time = is_same_instant ? source.last_time : arrival - latency.value_or(microseconds(0));
  }
  source.last_time = when.time;
  return when;
}

void UtcClock::OnDate(SourceClock& source, Utime arrival, Utime utc) const {
  source.dated_utc = MendRollover(utc, arrival - off_ - std::chrono::seconds(source.num_leaps));
  // The first date corrects the guess of those before it.
  if (!source.has_date) source.last_utc.reset();
  source.has_date = true;
  source.dated_arrival = arrival;
}

bool UtcClock::IsBehindTimedSentence(const SourceClock& source, Utime arrival) {
  const bool is_known = source.last_utc && source.is_forward && source.KnowsOffset();
  return is_known && arrival >= source.last_arrival && arrival - source.last_arrival <= kBurst;
}

MeasurementTime UtcClock::OfArrival(const SourceClock& source, Utime arrival, std::optional<microseconds> known_latency,
                                    microseconds min_lateness) const {
  const auto latency = known_latency.value_or(microseconds(0));
  auto late = microseconds(0);
  if (IsBehindTimedSentence(source, arrival)) {
    late = source.last_arrival - (*source.last_utc + std::chrono::seconds(source.num_leaps)) - latency - source.fit.offset();
  }
  if (late < min_lateness) late = microseconds(0);
  const auto fine = is_off_ || fine_fit_.is_empty() ? microseconds(0) : fine_fit_.offset();
  MeasurementTime when;
  when.time = arrival - fine - latency - late;
  when.arrival = arrival;
  when.utc = when.time - host_minus_utc();
  return when;
}

}  // namespace lookout::navigator
