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
    Utime target_time = {};                         // to which it was propagated
    int number = -1;                                // -1: it had none
    std::optional<std::chrono::microseconds> time;  // nullopt: it is to be sent anew
  };

  explicit TargetSchedule(std::chrono::microseconds period) : period_(period) {}

  /// Those that are new, or were sent a period ago: the dangerous that are new first, in the order of `targets`; then by how long they have waited,
  /// where a second of the dangerous counts as four, so that an output with little room gets round all of them.
  std::vector<const Target*> Due(std::span<const Target> targets, std::chrono::microseconds now);

  void NoteSent(const Target& target, Utime target_time, int number, std::chrono::microseconds now);

  /// Sent targets that are there no more, by id: each is told once.
  std::vector<Sent> TakeEnded(std::span<const Target> targets);

  /// A new receiver knows of none: all are due. Ended targets are still told.
  void SendAnew();
  /// The same, and ended targets are not told: the number of one that ended while nobody listened may be that of another by now.
  void Forget() { sent_.clear(); }

 private:
  std::chrono::microseconds period_;
  std::map<std::int64_t, Sent> sent_;                      // by the target's id
  std::map<std::int64_t, std::chrono::microseconds> new_;  // not yet sent: since when
};

/// A target that has ended, where it would be at `time`: at most some seconds after it was sent.
Target EndedAt(const TargetSchedule::Sent& ended, Utime time);

}  // namespace lookout::plotter
