#include "services/navigator/core/arrivals.hpp"

#include <algorithm>

namespace lookout::navigator {

namespace {

using namespace std::chrono_literals;
using std::chrono::microseconds;

// A queue that is drained at one and a third of the usual rate has become shorter by a quarter of that while. Sentences that are drained more slowly
// count as a loss, and their remaining lateness as a delay.
constexpr microseconds kMinWhile = 300ms;
constexpr int kMinIntervalsInWhile = 2;
constexpr int kShrinkingShare = 4;

}  // namespace

bool Arrivals::IsGap(microseconds interval) const { return usual_ > 0us && interval > usual_ + usual_ / 4 + kMaxLateness; }

void Arrivals::Learn(Utime arrival) {
  ++num_learned_;
  const auto since = arrival - learning_since_;
  if (num_learned_ < kMinCount || since < kMinLearning) return;
  usual_ = since / num_learned_;
  learning_since_ = arrival;
  num_learned_ = 0;
}

void Arrivals::EndQueue(Utime arrival) {
  is_queue_ = false;
  lateness_ = 0us;
  learning_since_ = arrival;
  num_learned_ = 0;
}

bool Arrivals::Add(Utime arrival) {
  if (!has_last_ || arrival < last_) {
    has_last_ = true;
    last_ = arrival;
    EndQueue(arrival);
    return true;
  }
  const auto interval = arrival - last_;
  last_ = arrival;
  if (IsGap(interval)) {
    // Twice the same gap is a sensor that sends more seldom now.
    const bool is_usual_now = gap_ > 0us && std::chrono::abs(interval - gap_) < interval / 4;
    gap_ = interval;
    if (is_usual_now) {
      usual_ = interval;
      EndQueue(arrival);
      return true;
    }
    lateness_ += interval - usual_;
    is_queue_ = true;
    drained_since_ = arrival;
    while_begin_ = arrival;
    lateness_at_begin_ = lateness_;
    return false;
  }
  gap_ = 0us;
  if (!is_queue_) {
    Learn(arrival);
    return true;
  }
  lateness_ = std::max<microseconds>(lateness_ + interval - usual_, 0us);
  const auto since = arrival - while_begin_;
  const bool is_while_over = since >= std::max<microseconds>(kMinWhile, kMinIntervalsInWhile * usual_);
  const bool is_lost = is_while_over && lateness_at_begin_ - lateness_ < since / kShrinkingShare;
  if (is_while_over) {
    while_begin_ = arrival;
    lateness_at_begin_ = lateness_;
  }
  // Rounding of the interval adds up in a long queue: it also ends where sentences come no faster than usual.
  const bool is_drained = lateness_ <= kMaxLateness / 2 && interval >= usual_ - usual_ / 4;
  if (is_drained || is_lost || arrival - drained_since_ > kMaxDraining) EndQueue(arrival);
  return !is_queue_;
}

}  // namespace lookout::navigator
