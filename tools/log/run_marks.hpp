// Whether a log holds a run from its start to its end: marks of the raw channels.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/core/bytes.hpp"
#include "common/core/utime.hpp"
#include "lookout/lidar_packets_t.hpp"
#include "lookout/nav_raw_t.hpp"

namespace lookout::log {

/// LIDAR_PACKETS, LIDAR_PACKETS_2 and NAV_RAW begin with a start mark and end with an end mark where the log holds all that their process consumed.
/// Without a start mark the first results depend on messages before the log; without an end mark nobody knows the live run's results of the scan and
/// the poses under way.
class RunMarks {
 public:
  /// Whether messages of this channel can hold marks.
  static bool IsMarked(std::string_view channel) {
    return channel == bus::kLidarPackets.name || channel == bus::kLidarPackets2.name || channel == bus::kNavRaw.name;
  }

  /// A message of any channel, in the order of the log. Reads no more than the head.
  void Add(Utime time, std::string_view channel, Bytes bytes) {
    auto* const stream = std::ranges::find(streams_, channel, &Stream::channel);
    if (stream == streams_.end() || bytes.size() < kMarkOffset + 8) return;
    if (bus::ReadU64BigEndian(bytes, 0) != stream->fingerprint) return;  // nobody consumed a message of another type
    const auto mark = static_cast<std::int32_t>(bus::ReadU64BigEndian(bytes, kMarkOffset) >> 32);
    const auto holds = [&](std::int32_t searched) { return stream->is_bit ? (mark & searched) != 0 : mark == searched; };
    const bool is_start = holds(stream->start_mark);
    if (!stream->last) stream->begins_with_start = is_start;
    if (stream->last && is_start && !stream->ends_with_end) stream->is_cut_inside = true;
    stream->ends_with_end = holds(stream->end_mark);
    stream->last = time;
  }

  /// Raw channels of which there are messages, in the order of the channel table.
  std::vector<std::string> Channels() const {
    return Where([](const Stream&) { return true; });
  }

  /// Channels of Channels() that do not begin with a start mark, and that do not end with an end mark.
  std::vector<std::string> WithoutStart() const {
    return Where([](const Stream& stream) { return !stream.begins_with_start; });
  }
  std::vector<std::string> WithoutEnd() const {
    return Where([](const Stream& stream) { return !stream.ends_with_end; });
  }

  /// Channels of Channels() in which a run without an end mark is followed by another run.
  std::vector<std::string> CutInside() const {
    return Where([](const Stream& stream) { return stream.is_cut_inside; });
  }

  /// Time of the channel's event that came last; nullopt: none.
  std::optional<Utime> LastTime(std::string_view channel) const {
    const auto* const stream = std::ranges::find(streams_, channel, &Stream::channel);
    return stream == streams_.end() ? std::nullopt : stream->last;
  }

 private:
  // Behind fingerprint, utime_us and seq: `marks` of lidar_packets_t, `kind` of nav_raw_t; 32 bits.
  static constexpr std::size_t kMarkOffset = 24;

  struct Stream {
    std::string_view channel;
    std::uint64_t fingerprint;
    std::int32_t start_mark;
    std::int32_t end_mark;
    bool is_bit;  // marks are bits of a field; else they are its values
    std::optional<Utime> last = {};
    bool begins_with_start = false;
    bool ends_with_end = false;
    bool is_cut_inside = false;
  };

  template <typename Condition>
  std::vector<std::string> Where(Condition condition) const {
    std::vector<std::string> channels;
    for (const auto& stream : streams_) {
      if (stream.last && condition(stream)) channels.emplace_back(stream.channel);
    }
    return channels;
  }

  std::array<Stream, 3> streams_{
      {{bus::kLidarPackets.name, static_cast<std::uint64_t>(lidar_packets_t::getHash()), lidar_packets_t::MARK_START, lidar_packets_t::MARK_END,
        true},
       {bus::kNavRaw.name, static_cast<std::uint64_t>(nav_raw_t::getHash()), nav_raw_t::KIND_START, nav_raw_t::KIND_END, false},
       {bus::kLidarPackets2.name, static_cast<std::uint64_t>(lidar_packets_t::getHash()), lidar_packets_t::MARK_START, lidar_packets_t::MARK_END,
        true}}};
};

}  // namespace lookout::log
