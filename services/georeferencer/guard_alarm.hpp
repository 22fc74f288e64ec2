// The alarm of the guard zone over time: how many scans must see something in it, and whether anybody looks.
//
// It stands in HEALTH alone, so it may know the host's clock and stands outside the proof of replay.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/core/health.hpp"
#include "common/core/utime.hpp"
#include "common/messages/part_assembler.hpp"
#include "services/georeferencer/core/guard_zone.hpp"
#include "services/georeferencer/core/obstacle.hpp"

namespace lookout::georeferencer {

/// Something is in the zone when 3 of the last 5 whole scans show it, and no longer when it was not seen for 1 s of message time and 5 whole scans.
/// A scan is whole when all its parts came and no packet of it was lost. One that is not cannot say that nothing is there: it clears nothing and does
/// not count against; what it shows counts. What is older than 1 s counts neither way.
///
/// The zone is watched while whole scans come: after none for 0.5 s of host time it is not, until 3 came within 1 s, as many as it takes to raise an
/// alarm. So it is not watched at the start. Without host time (replay) this is not known.
class GuardAlarm {
 public:
  static constexpr std::size_t kWindowScans = 5;
  static constexpr int kScansToRaise = 3;
  static constexpr std::chrono::seconds kTimeToClear{1};
  static constexpr std::chrono::milliseconds kTimeToUnwatched{500};

  /// A scan, or a part of one. Whatever a part shows counts, also one that comes after its scan ended without it, or that disagrees with others about
  /// the number of parts: such a scan is not whole.
  ///
  /// @param nearest  of what this part shows within the zone; nullopt: nothing
  void Add(const ScanHead& head, const std::optional<NearestPoint>& nearest);

  /// Live only, ten times a second or more. A step of the host's clock, or a time in which this process did not run, counts as 0.25 s at most.
  void AdvanceTo(Utime host_time);

  /// What is nearest of the last five scans, or was last; nullopt while nothing is in the zone.
  std::optional<NearestPoint> nearest() const;

  bool is_unwatched() const { return host_time_ && !is_watched_; }

  /// Something is in the zone, or it is not watched.
  bool is_active() const { return is_raised_ || is_unwatched(); }

  /// Why it is not watched: "guard zone not watched: no whole scan for 3.2 s ...". Empty while it is.
  std::string UnwatchedText() const;

  /// alarm_active, alarms, nearest_cm (only with something in the zone), zone_unwatched, zone_times_unwatched, scans_whole, scans_partial.
  std::vector<Counter> counters() const;

  /// Alarms and times unwatched so far, and which of the two states are on: another value is worth a report at once.
  struct State {
    std::int64_t num_alarms = 0;
    std::int64_t num_times_unwatched = 0;
    bool is_raised = false;
    bool is_unwatched = false;
    bool operator==(const State&) const = default;
  };
  State state() const { return {num_alarms_, num_times_unwatched_, is_raised_, is_unwatched()}; }

 private:
  using ScanKey = std::pair<std::int64_t, std::int64_t>;  // utime_us, seq
  struct ZonePart {
    std::int64_t utime_us = 0;
    std::int64_t seq = 0;
    std::int32_t part_index = 0;
    std::int32_t num_parts = 0;
    std::int32_t scan_flags = 0;
    std::optional<NearestPoint> nearest;

    // None is refused for its num_parts: it may show what no other does.
    friend bool AgreeAboutScan(const ZonePart& /*one*/, const ZonePart& /*other*/) { return true; }
  };
  struct Seen {
    Utime time;
    bool is_whole = false;
    std::optional<NearestPoint> nearest;
  };

  void Evaluate(const std::vector<ZonePart>& parts, bool has_all_parts);
  void Evaluate(const Seen& scan);

  messages::PartAssembler<ZonePart> assembler_;
  std::optional<ScanKey> last_whole_;  // the last of which all parts came
  std::deque<Seen> window_;            // whole scans, and others that show something
  std::optional<Utime> newest_;
  bool is_raised_ = false;
  NearestPoint last_nearest_;
  Utime last_seen_;                         // message time; something was in the zone, or must be taken to be
  std::int64_t num_clear_ = 0;              // whole scans without, since then
  std::optional<Utime> host_time_;          // live only
  std::chrono::microseconds unseen_{0};     // host time since the last whole scan
  std::chrono::microseconds unwatched_{0};  // and since the last with which enough of them stood in the window
  bool is_watched_ = false;
  std::int64_t num_partial_since_ = 0;  // since the last whole scan
  std::int64_t num_alarms_ = 0;
  std::int64_t num_times_unwatched_ = 0;
  std::int64_t num_whole_ = 0;
  std::int64_t num_partial_ = 0;
};

}  // namespace lookout::georeferencer
