// One event of an lcm-log as bytes, for a writer that hands bytes to the disk itself.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "common/core/bytes.hpp"
#include "common/core/utime.hpp"

namespace lookout::bus {

/// Bytes of an event in front of its channel's name. All numbers big-endian: sync word u32, event number i64, time i64 (us), length of the channel
/// i32, length of the data i32 (LCM: lcm/eventlog.c).
inline constexpr std::size_t kLogEventHeaderBytes = 28;
inline constexpr std::uint32_t kLogSyncWord = 0xEDA1DA01;

/// What an event may hold to be read again. LCM's own channels have at most 63 characters and never none, its reader stops at an event without name;
/// a length of the data beyond is taken for damage.
inline constexpr std::size_t kMaxLogChannelBytes = 63;
inline constexpr std::size_t kMaxLogDataBytes = 16U * 1024 * 1024;

/// Appends an event to `log`.
///
/// @param number   of the event in its file, from 0
/// @param channel  not empty: LCM's reader stops at an event without name
inline void AppendLogEvent(std::vector<std::uint8_t>& log, std::int64_t number, Utime time, std::string_view channel, Bytes bytes) {
  std::array<std::uint8_t, kLogEventHeaderBytes> header{};
  std::size_t place = 0;
  const auto put = [&](std::uint64_t value, int size) {
    for (int shift = 8 * (size - 1); shift >= 0; shift -= 8) header[place++] = static_cast<std::uint8_t>(value >> shift);
  };
  put(kLogSyncWord, 4);
  put(static_cast<std::uint64_t>(number), 8);
  put(static_cast<std::uint64_t>(ToUtimeUs(time)), 8);
  put(channel.size(), 4);
  put(bytes.size(), 4);
  log.insert(log.end(), header.begin(), header.end());
  log.insert(log.end(), channel.begin(), channel.end());
  log.insert(log.end(), bytes.begin(), bytes.end());
}

}  // namespace lookout::bus
