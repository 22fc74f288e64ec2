// Whether anybody looks. By the host's clock: live only, and outside the proof of replay.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "common/core/recently.hpp"
#include "common/core/utime.hpp"
#include "services/tracker/core/alerts.hpp"

namespace lookout::tracker {

/// After the first whole scan (nothing of it lost) nobody looks where none came for 0.5 s. A step of the host's clock, or a time in which this
/// process did not run, counts as 0.25 s at most.
class Watch {
 public:
  static constexpr std::chrono::milliseconds kLongest{500};

  /// A whole scan.
  void NoteScan() {
    has_scan_ = true;
    last_scan_ = time_.passed();
  }

  /// Ten times a second or more.
  void AdvanceTo(Utime host_time);

  bool is_failing() const { return has_scan_ && unseen() >= kLongest; }
  std::chrono::microseconds unseen() const { return time_.passed() - last_scan_; }
  std::int64_t num_failures() const { return num_failures_; }

  /// The alert, while it fails and once when it is over; ids from -1 down.
  const std::optional<Alert>& alert() const { return alert_; }
  /// Whether ALERTS are to be sent with it now: at its begin, every half second, at its end.
  bool TakeTurn();
  bool Acknowledge(const Acknowledgement& acknowledgement);

 private:
  PassedTime time_{std::chrono::milliseconds(250)};
  std::chrono::microseconds last_scan_{0};
  bool has_scan_ = false;
  std::int64_t num_failures_ = 0;
  Utime host_time_;
  std::optional<Alert> alert_;
  std::optional<std::chrono::microseconds> sent_;
};

}  // namespace lookout::tracker
