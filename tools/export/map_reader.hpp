// Brings together what logs say of each scan, for the boat's own map.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "common/config/boat.hpp"
#include "common/core/pose.hpp"
#include "common/messages/part_assembler.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "lookout/tracks_t.hpp"
#include "services/tracker/core/gatherer.hpp"
#include "services/tracker/core/scan.hpp"
#include "services/tracker/core/sight.hpp"
#include "tools/export/map_merge.hpp"
#include "tools/export/sink.hpp"

namespace lookout::exporter {

/// TRACKS of each scan, in their order. The first of each second waits for its LIDAR_SCAN and POSE, which say, with the mounting of the lidar in
/// RUN_INFO, which water was looked through; it does not wait for ever, and a log without them has no sight.
///
/// A scan that was read before, as of a log that is there twice, is left out.
class MapReader {
 public:
  explicit MapReader(MapMerge& merge) : merge_(merge) {}

  /// TRACKS, LIDAR_SCAN, POSE or RUN_INFO, in the order of the log.
  Taken Take(std::string_view channel, Bytes bytes);
  /// End of the input.
  void Finish();

  /// Scans with known sight.
  std::int64_t num_looks() const { return num_looks_; }

 private:
  struct Waiting {
    tracker::ScanKey begin;
    tracker::ScanKey key;
    StandingScan scan;
    bool is_looked = false;
  };

  Taken TakeTracks(Bytes bytes);
  Taken TakeBeams(Bytes bytes);
  Taken TakePose(Bytes bytes);
  Taken TakeBoat(Bytes bytes);
  void AddTracks(std::span<const tracks_t> parts, bool is_whole);
  bool IsReady(const Waiting& waiting) const;
  void Release(std::size_t most_waiting);
  const tracker::Sight* SightOf(const Waiting& waiting);

  MapMerge& merge_;
  messages::PartAssembler<tracks_t> tracks_parts_;
  messages::PartAssembler<lidar_scan_t> beams_parts_;
  PoseHistory poses_;
  std::optional<config::BoatFacts> boat_;
  std::optional<double> max_range_m_;
  std::optional<tracker::Sight> sight_;  // of the boat in RUN_INFO
  std::deque<Waiting> waiting_;
  std::deque<std::pair<tracker::ScanKey, tracker::Sweep>> sweeps_;  // of the first scans of seconds
  tracker::ScanInput looked_;                                       // the scan of sight_
  std::optional<std::int64_t> tracks_second_;
  std::optional<std::int64_t> beams_second_;
  std::map<tracker::ScanKey, tracker::ScanKey> newest_;  // of each process: the last scan
  std::int64_t num_looks_ = 0;
};

}  // namespace lookout::exporter
