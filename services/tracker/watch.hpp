// Whether anybody looks. By the host's clock: live only, and outside the proof of replay.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/core/recently.hpp"
#include "common/core/utime.hpp"
#include "services/tracker/core/alerts.hpp"

namespace lookout::tracker {

/// Somebody looks while three whole scans (nothing of them lost) came within 1 s of message time, as many as it takes to raise an alert, and the last
/// of such three not 0.5 s ago. Until the first scan there is nothing to warn of, but nobody looks yet. A step of the host's clock, or a time in
/// which this process did not run, counts as 0.25 s at most.
class Watch {
 public:
  static constexpr std::chrono::milliseconds kLongest{500};
  static constexpr std::chrono::seconds kWithin{1};
  static constexpr std::size_t kScans = 3;

  void NoteScan(Utime scan_time, bool is_whole);

  /// Ten times a second or more.
  void AdvanceTo(Utime host_time);

  bool is_failing() const { return last_good_ && time_.passed() - *last_good_ >= kLongest; }
  /// "no whole scan for 1.2 s"; "no whole scan yet"; empty while somebody looks, and where the host's time is not known.
  std::string Complaint() const;
  std::int64_t num_failures() const { return num_failures_; }

  /// The alert, while it fails and once when it is over; ids from -1 down.
  const std::optional<Alert>& alert() const { return alert_; }
  /// Whether ALERTS are to be sent with it now: at its begin, every half second, at its end.
  bool TakeTurn();
  bool Acknowledge(const Acknowledgement& acknowledgement);

 private:
  PassedTime time_{std::chrono::milliseconds(250)};
  std::vector<Utime> whole_;                             // the last ones, within kWithin of each other
  std::optional<std::chrono::microseconds> last_whole_;  // host time passed
  std::optional<std::chrono::microseconds> last_good_;   // with which there were enough; before that, with the first scan
  bool has_looked_ = false;
  std::int64_t num_failures_ = 0;
  std::optional<Utime> host_time_;
  std::optional<Alert> alert_;
  std::optional<std::chrono::microseconds> sent_;
};

}  // namespace lookout::tracker
