// Whether a sentence without a time of its own came in time, or waited in a queue with others.
#pragma once

#include <chrono>
#include <cstdint>

#include "common/core/utime.hpp"

namespace lookout::navigator {

/// The arrivals of one kind of sentence of one input. A sensor measures at an even interval. After a gap well beyond it, sentences that come faster
/// than that are a queue that is drained: the n-th of them was measured n intervals after the gap began, and so is late by the rest of the gap. It
/// must not count as measured on arrival, until the queue is empty. Where nothing comes faster, the sentences of the gap are lost, and the first
/// after it came in time.
///
/// Depends on the stamps of the arrivals alone.
class Arrivals {
 public:
  /// A sentence that may be late by no more than this counts: buses and serial drivers deliver several at once.
  static constexpr std::chrono::milliseconds kMaxLateness{100};
  /// No buffer holds more at the rate at which it is drained: what comes faster for longer is a sensor that sends more often now.
  static constexpr std::chrono::seconds kMaxDraining{15};
  /// An interval is learned from at least this many sentences, over at least this time.
  static constexpr int kMinCount = 10;
  static constexpr std::chrono::seconds kMinLearning{1};

  /// @param arrival  not before the last one
  /// @return whether the sentence came in time, as far as is known
  bool Add(Utime arrival);

 private:
  using microseconds = std::chrono::microseconds;

  bool IsGap(microseconds interval) const;
  void Learn(Utime arrival);
  void EndQueue(Utime arrival);

  bool has_last_ = false;
  Utime last_{};
  microseconds usual_{0};  // interval; 0 = not known yet
  // Since when the interval is learned anew, and how many sentences have come since.
  Utime learning_since_{};
  std::int64_t num_learned_ = 0;
  // After a gap: how late the last sentence was, if a queue is drained; and how late a sentence was at the begin of a while in which a queue would
  // have become shorter.
  bool is_queue_ = false;
  Utime drained_since_{};  // end of the last gap
  microseconds lateness_{0};
  microseconds gap_{0};  // the last interval that was a gap
  Utime while_begin_{};
  microseconds lateness_at_begin_{0};
};

}  // namespace lookout::navigator
