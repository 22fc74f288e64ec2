// Finds sentences that tell local time, beside sentences of the same input that tell UTC.
#pragma once

#include <chrono>
#include <optional>

#include "common/core/utime.hpp"
#include "services/navigator/core/nmea.hpp"

namespace lookout::navigator {

/// Chart programs put the time of their computer into GLL, which may be local, while RMC passes through with its UTC. Zones differ from UTC by whole
/// quarter hours. The sentence that says more of time is right: one with date and place (RMC) before ZDA, that before GGA and GNS, and those before
/// the rest.
class TimeZoneCheck {
 public:
  /// How far the computer's clock of such a program may be off, beside the quarter hours.
  static constexpr std::chrono::seconds kMostOff{30};

  /// @param now  arrival of the sentence, or another time that goes on as they come
  /// @return whether its time of day is off by whole quarter hours from one that says more: it is not to be used
  bool IsLocal(Utime now, const Sentence& sentence) const;

  /// Whether the sentence tells a time, and at least as much of it as the sentence by which others are refused.
  bool SaysAsMuch(const Sentence& sentence) const;

  /// The time of this sentence, which is not local, was used. It came at `now`.
  void Know(Utime now, const Sentence& sentence);

 private:
  struct Known {
    int rank = 0;
    Utime now;
    std::chrono::microseconds time_of_day{0};
  };
  std::optional<Known> known_;
};

}  // namespace lookout::navigator
