// When each target is due on one output, and which have ended there.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "common/core/utime.hpp"
#include "services/plotter/core/scene.hpp"

namespace lookout::plotter {

/// Time is host time passed, as of PassedTime.
class TargetSchedule {
 public:
  /// The last report of a target.
  struct Sent {
    Target target;
    Utime target_time = {};                         // time to which the target was propagated
    int number = -1;                                // -1: the target had no number
    std::optional<std::chrono::microseconds> time;  // nullopt: the target is to be sent anew
  };

  explicit TargetSchedule(std::chrono::microseconds period) : period_(period) {}

  /// Targets that are new, or were sent a period ago. New dangerous targets come first, in the order of `targets`; then the others by how long they
  /// have waited, where a second of a dangerous target counts as four, so that an output with little room gets round all targets.
  std::vector<const Target*> Due(std::span<const Target> targets, std::chrono::microseconds now);

  void NoteSent(const Target& target, Utime target_time, int number, std::chrono::microseconds now);

  /// Sent targets that are there no more, by id: each is returned once.
  std::vector<Sent> TakeEnded(std::span<const Target> targets);

  /// All targets are due: a new receiver knows none. Ended targets are still told.
  void SendAnew();
  /// All targets are due, and ended targets are not told: the number of a target that ended while nobody listened may belong to another target by
  /// now.
  void Forget() { sent_.clear(); }

 private:
  std::chrono::microseconds period_;
  std::map<std::int64_t, Sent> sent_;                      // by the target's id
  std::map<std::int64_t, std::chrono::microseconds> new_;  // not yet sent: since when
};

/// A target that has ended, where it would be at `time`: at most some seconds after it was sent.
Target EndedAt(const TargetSchedule::Sent& ended, Utime time);

}  // namespace lookout::plotter
