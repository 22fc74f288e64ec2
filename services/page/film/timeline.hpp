// The entries of one or more logs, in the order of time: which messages make a moment or a span.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "services/page/core/request.hpp"
#include "services/page/film/log_part.hpp"

namespace lookout::page {

/// Where a message stands.
struct Place {
  Utime time;
  std::int64_t utime_us = 0;
  std::int64_t offset_bytes = 0;
  std::uint32_t size_bytes = 0;
  std::uint32_t duration_us = 0;
  std::uint16_t part = 0;  // of HEALTH the process, over all logs
  std::uint16_t file = 0;
};

struct Scan {
  std::int64_t utime_us = 0;
  std::int64_t end_utime_us = 0;
  Utime first;  // event of LIDAR_SCAN, SEGMENTS, OBSTACLES or TRACKS
  Utime last;
  Utime whole;  // the scan's `last`, or that of an earlier scan, whichever is later
};

struct Moment {
  Utime time;
  std::optional<std::size_t> scan;  // index into scans()
};

struct PlacesOfChannel {
  ChannelIndex channel = 0;
  std::vector<Place> places;
};

class Timeline {
 public:
  /// Appends the next entries. A time before the end is brought to the end: few, and by little.
  /// @param shift  added to its times; whole seconds
  void Append(const LogPart& part, std::uint16_t file, std::chrono::microseconds shift);

  /// Forgets earlier entries.
  void DropBefore(Utime time);

  bool is_empty() const { return !begin_; }
  /// Precondition of begin and end: not empty.
  Utime begin() const { return *begin_; }
  Utime end() const { return end_; }

  /// Whether there is a message of the channel.
  bool Holds(const bus::Channel& channel) const;

  /// Where a page begins to show it: when the first scan is whole that has TRACKS, with a POSE of its time or before it; else the first that has
  /// TRACKS; else begin(). Precondition: not empty.
  Utime OpensAt() const;

  const std::deque<Scan>& scans() const { return scans_; }
  const std::deque<SecondCell>& cells() const { return cells_; }
  const std::deque<FilmEvent>& events() const { return events_; }

  /// The moment that is asked for. Precondition: not empty.
  Moment Find(const At& request) const;

  /// The messages of a moment (PROTOCOL.md), channel by channel.
  std::vector<PlacesOfChannel> Of(const Moment& moment, const std::vector<ChannelIndex>& channels) const;

  /// Messages of a channel in a span: groups (parts of one scan; HEALTH of one second) as many as may be, evenly.
  std::vector<Place> Of(const Range& request, std::int64_t max_bytes) const;

 private:
  using Places = std::deque<Place>;

  const Places& Of(const bus::Channel& channel) const;
  void NoteScan(const Place& place);
  std::vector<Place> OfScan(const Places& places, const Scan& scan) const;
  std::vector<Place> OfSecond(const Places& places, const Scan& scan) const;
  std::vector<Place> OfPose(const Places& places, const Moment& moment) const;
  std::vector<Place> OfChannel(ChannelIndex channel, const Moment& moment) const;

  std::array<Places, bus::kChannels.size()> channels_;
  std::deque<Scan> scans_;
  std::deque<SecondCell> cells_;
  std::deque<FilmEvent> events_;
  std::vector<std::string> processes_;
  std::optional<Utime> begin_;
  Utime end_;
};

}  // namespace lookout::page
