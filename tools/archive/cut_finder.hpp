// Where a log may be cut so that what replay makes of the parts is what it makes of the whole.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "common/core/bytes.hpp"

namespace lookout::archive {

enum class Mark { kNone, kStart, kEnd };

/// The mark of a message of LIDAR_PACKETS or NAV_RAW; its type is right.
Mark MarkOf(std::string_view channel, Bytes bytes);

/// Finds the times at which every process had ended and began anew: both raw channels end with an end mark and begin again with a start mark, and the
/// next ALERTS come from another process than the last ALERTS. Where the tracker went on, or no ALERTS tell that it did not, its tracks live on over
/// the marks: there is no cut. There is no cut either where a clock went back, as a part is a stretch of log time.
class CutFinder {
 public:
  /// A message of LIDAR_PACKETS or NAV_RAW, in the order of the log.
  void AddRaw(std::string_view channel, std::int64_t time_us, Mark mark);
  /// A message of ALERTS.
  void AddAlerts(std::int64_t time_us, Bytes bytes);

  const std::vector<std::int64_t>& cuts_us() const { return cuts_us_; }

 private:
  struct Stream {
    bool is_there = false;
    bool has_ended = false;
    bool has_begun_again = false;  // since the pending cut
  };
  void NoteTime(std::int64_t time_us);
  void Confirm();

  std::array<Stream, 3> streams_{};                               // lidar, navigator, second lidar
  std::optional<std::pair<std::int64_t, std::int64_t>> tracker_;  // begin of the process of the last ALERTS: time, number of its scan
  std::optional<std::int64_t> pending_us_;
  bool is_new_tracker_ = false;  // since the pending cut
  std::int64_t latest_us_ = INT64_MIN;
  std::vector<std::int64_t> cuts_us_;
};

}  // namespace lookout::archive
