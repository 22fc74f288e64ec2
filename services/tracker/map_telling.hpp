// When MAP is told, and in which parts.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

#include "services/tracker/core/script.hpp"
#include "services/tracker/core/tracker.hpp"
#include "services/tracker/map_wire.hpp"

namespace lookout::tracker {

/// Of one process. First what was given, a part with each scan, so that no burst is lost; the tracker has it from the scan after the last part on.
/// Then, after the first scan of each minute of message time, what is kept. So a log that holds the whole of what was given computes the same again,
/// and one that was cut before it tells of a process that used nothing of it.
class MapTelling {
 public:
  explicit MapTelling(GivenMap given) : given_(std::move(given)) {}

  /// After each scan.
  /// @param is_placed  with an own pose
  /// @return what is to be published
  std::optional<map_t> Next(const ScanLabel& label, bool is_placed, Tracker& tracker);

 private:
  void Tell(const ScanLabel& label, std::int32_t source, const OwnMap& map, std::optional<Utime> land_begin, int least_parts = 1);

  std::optional<GivenMap> given_;  // until it is in parts
  bool is_given_ = false;          // to the tracker
  bool is_cut_ = false;            // of what was given parts are missing
  OwnMap used_;                    // what was given, as MAP tells it
  std::deque<map_t> parts_;        // that wait
  std::int64_t next_seq_ = 0;
  std::optional<std::int64_t> minute_;  // of the last scan
  bool is_due_ = false;
};

}  // namespace lookout::tracker
