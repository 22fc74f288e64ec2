// Whether a log holds a run from its start to its end: marks of the raw channels.
#pragma once

#include <array>
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
  std::vector<std::string> Channels() const {
    return Where([](const Stream&) { return true; });
  }

  /// Of these, those that do not begin with a start mark, and those that do not end with an end mark.
  std::vector<std::string> WithoutStart() const {
    return Where([](const Stream& stream) { return !stream.begins_with_start; });
  }
  std::vector<std::string> WithoutEnd() const {
    return Where([](const Stream& stream) { return !stream.ends_with_end; });
  }

  /// Of these, those where a run without an end mark is followed by another one.
  std::vector<std::string> CutInside() const {
    return Where([](const Stream& stream) { return stream.is_cut_inside; });
  }

  /// Time of the channel's event that came last; nullopt: none.
  std::optional<Utime> LastTime(std::string_view channel) const;

 private:
  struct Stream {
    std::string_view channel;
    std::uint64_t fingerprint;
    std::int32_t start_mark;
    std::int32_t end_mark;
    bool is_bit;  // marks are bits of a field; else its values
    std::optional<Utime> last = {};
    bool begins_with_start = false;
    bool ends_with_end = false;
    bool is_cut_inside = false;
  };

  static std::array<Stream, 2> NoMessages();

  template <typename Condition>
  std::vector<std::string> Where(Condition condition) const {
    std::vector<std::string> channels;
    for (const auto& stream : streams_) {
      if (stream.last && condition(stream)) channels.emplace_back(stream.channel);
    }
    return channels;
  }

  std::array<Stream, 2> streams_ = NoMessages();
};

}  // namespace lookout::log
