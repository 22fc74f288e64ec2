// Whether a log holds a run from its start to its end: marks of the raw channels.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/utime.hpp"

namespace lookout::log {

/// LIDAR_PACKETS and NAV_RAW begin with a start mark and end with an end mark where the log holds all that their process consumed. Without a start
/// mark what is computed first depends on what came before the log; without an end mark nobody knows what the live run made of the scan and the poses
/// that were under way.
class RunMarks {
 public:
  /// Whether messages of this channel can hold marks.
  static bool IsMarked(std::string_view channel);

  /// A message of any channel, in the order of the log. Reads no more than the head.
  void Add(Utime time, std::string_view channel, Bytes bytes);

  /// Raw channels of which there are messages, in the order of the channel table.
  std::vector<std::string> Channels() const;

  /// Of these, those that do not begin with a start mark, and those that do not end with an end mark.
  std::vector<std::string> WithoutStart() const;
  std::vector<std::string> WithoutEnd() const;

  /// Of these, those where a run without an end mark is followed by another one.
  std::vector<std::string> CutInside() const;

  bool HasEnd(std::string_view channel) const;

  /// Time of the event that came last; nullopt: none.
  std::optional<Utime> LastTime(std::string_view channel) const;

 private:
  struct Stream {
    bool has_messages = false;
    bool begins_with_start = false;
    bool ends_with_end = false;
    bool is_cut_inside = false;
    Utime last;
  };
  std::array<Stream, 2> streams_;  // LIDAR_PACKETS, NAV_RAW
};

/// "LIDAR_PACKETS, NAV_RAW"
std::string Joined(const std::vector<std::string>& names);

}  // namespace lookout::log
