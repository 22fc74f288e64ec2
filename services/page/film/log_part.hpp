// The index of a log, or of a stretch of it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "common/core/utime.hpp"

namespace lookout::page {

/// A message that can be shown, in the order of the file.
struct LogEntry {
  Utime time;                     // of the event; never before the time of the previous entry (LogIndexer)
  std::int64_t utime_us = 0;      // of the message
  std::int64_t offset_bytes = 0;  // of the event in the file
  std::uint32_t size_bytes = 0;   // of the message
  std::uint32_t duration_us = 0;  // of the message's scan: end_utime_us - utime_us; 0 where the message has no end
  std::uint16_t channel = 0;      // index into the channel table
  std::uint16_t part = 0;         // part_index; of HEALTH the process, an index into `processes`

  bool operator==(const LogEntry&) const = default;
};

/// Events of one second.
struct SecondCell {
  std::int64_t second = 0;  // since 1970 UTC
  std::int32_t num_tracks = -1;
  std::int32_t num_lost = 0;
  std::int8_t alert_level = 0;
  std::int8_t health = -1;

  void Add(const SecondCell& other) {
    num_tracks = std::max(num_tracks, other.num_tracks);
    num_lost = static_cast<std::int32_t>(std::min<std::int64_t>(std::int64_t{num_lost} + other.num_lost, INT32_MAX));
    alert_level = std::max(alert_level, other.alert_level);
    health = std::max(health, other.health);
  }
  bool operator==(const SecondCell&) const = default;
};

enum class FilmEventKind : std::uint8_t { kAlert, kHealth, kLoss, kStart, kEnd, kGap };

struct FilmEvent {
  Utime time;
  FilmEventKind kind = FilmEventKind::kGap;
  std::uint8_t level = 0;  // 0 to 2, the gravest
  std::string text;        // for people: printable, at most kMaxFilmTextBytes

  bool operator==(const FilmEvent&) const = default;
};

inline constexpr std::size_t kMaxFilmTextBytes = 240;
inline constexpr std::size_t kMaxFilmEvents = 50'000;  // of one log; later events are left out
inline constexpr std::size_t kMaxFilmProcesses = 64;

struct LogPart {
  std::vector<LogEntry> entries;
  std::vector<SecondCell> cells;       // by time; a second that goes on in the next part is in both parts
  std::vector<FilmEvent> events;       // by time, nearly
  std::vector<std::string> processes;  // all so far

  bool operator==(const LogPart&) const = default;
};

}  // namespace lookout::page
