#include "tools/log/run_marks.hpp"

#include <algorithm>
#include <cstddef>

#include "common/bus/channels.hpp"
#include "common/bus/header.hpp"
#include "lookout/lidar_packets_t.hpp"
#include "lookout/nav_raw_t.hpp"

namespace lookout::log {

namespace {

// Behind fingerprint, utime_us and seq: `marks` of lidar_packets_t, `kind` of nav_raw_t; 32 bits.
constexpr std::size_t kMarkOffset = 24;

}  // namespace

std::array<RunMarks::Stream, 2> RunMarks::NoMessages() {
  return {{{bus::kLidarPackets.name, static_cast<std::uint64_t>(lidar_packets_t::getHash()), lidar_packets_t::MARK_START, lidar_packets_t::MARK_END,
            true},
           {bus::kNavRaw.name, static_cast<std::uint64_t>(nav_raw_t::getHash()), nav_raw_t::KIND_START, nav_raw_t::KIND_END, false}}};
}

bool RunMarks::IsMarked(std::string_view channel) { return channel == bus::kLidarPackets.name || channel == bus::kNavRaw.name; }

void RunMarks::Add(Utime time, std::string_view channel, Bytes bytes) {
  auto* const stream = std::ranges::find(streams_, channel, &Stream::channel);
  if (stream == streams_.end() || bytes.size() < kMarkOffset + 8) return;
  if (bus::ReadU64BigEndian(bytes, 0) != stream->fingerprint) return;  // what is no such message nobody consumed
  const auto mark = static_cast<std::int32_t>(bus::ReadU64BigEndian(bytes, kMarkOffset) >> 32);
  const auto holds = [&](std::int32_t searched) { return stream->is_bit ? (mark & searched) != 0 : mark == searched; };
  const bool is_start = holds(stream->start_mark);
  if (!stream->last) stream->begins_with_start = is_start;
  if (stream->last && is_start && !stream->ends_with_end) stream->is_cut_inside = true;
  stream->ends_with_end = holds(stream->end_mark);
  stream->last = time;
}

std::optional<Utime> RunMarks::LastTime(std::string_view channel) const {
  const auto* const stream = std::ranges::find(streams_, channel, &Stream::channel);
  return stream == streams_.end() ? std::nullopt : stream->last;
}

}  // namespace lookout::log
