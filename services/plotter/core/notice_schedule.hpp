// Which alerts are to be told on one output.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "services/plotter/core/scene.hpp"

namespace lookout::plotter {

/// What names a notice as long as it lives: the id of the alert; one of its own for each that is the plotter's own.
std::int64_t KeyOf(const Notice& notice);

/// A notice is due when it is new, when its level or its state has changed, and every kPeriod while it is not cleared. One that is there no more is
/// told once more, as cleared; what is old (is_old) is left as it was told. Time is host time passed.
class NoticeSchedule {
 public:
  static constexpr std::chrono::seconds kPeriod{10};

  struct Due {
    Notice notice;
    int revision = 1;  // 1 to 99: goes up with each change
  };

  /// @param notices  all that are there now
  std::vector<Due> Take(std::span<const Notice> notices, std::chrono::microseconds now);

  /// A new receiver knows of none.
  void SendAnew();

 private:
  struct Sent {
    Notice notice;
    int revision = 1;
    std::optional<std::chrono::microseconds> time;
  };
  std::map<std::int64_t, Sent> sent_;  // by KeyOf
};

}  // namespace lookout::plotter
