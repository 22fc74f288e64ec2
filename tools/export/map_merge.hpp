// One map out of the standing things that many processes of the tracker saw.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "common/core/pose.hpp"
#include "services/tracker/core/gatherer.hpp"
#include "services/tracker/core/sight.hpp"
#include "tools/export/own_map.hpp"
#include "tools/export/standing_things.hpp"

namespace lookout::exporter {

/// Processes in the order of time. A finished process is merged into the map: a thing of the process and a thing of the map are one where they lie
/// within SamePlaceM and have about the same length, nearest pairs first; two things of one process never are. The scans of a day are summed over its
/// processes. Land is merged cell by cell, on the grid of the earth.
class MapMerge {
 public:
  /// @param begin  the scan at which the process of the tracker began
  /// @param sight  nullptr: sight is not known
  void Add(const tracker::ScanKey& begin, const StandingScan& scan, const tracker::Sight* sight);

  /// Middles of the cells of land that TRACKS told after a scan. A cell that was told for 10 s of a day is land.
  void AddLand(Utime time, const Datum& datum, std::span<const Eigen::Vector2d> middles_m);

  /// To be called once. Things from south to north, and land by tile. Beyond the bounds of own_map.hpp the things and tiles that were unseen for
  /// longest are left out.
  OwnMap Merged();
  /// Numbers of things and cells that Merged left out.
  std::int64_t num_things_left_out() const { return num_things_left_out_; }
  std::int64_t num_cells_left_out() const { return num_cells_left_out_; }
  std::int64_t num_over_limit() const { return num_over_limit_; }

 private:
  struct Process {
    StandingThings standing;
    Utime last;
  };
  struct ToldCell {
    Utime first;  // of the last day
    Utime seen;
    std::vector<std::int32_t> days;
  };
  using Cell = std::pair<std::int32_t, std::int32_t>;  // of the land memory: east, north

  void EndProcessesBefore(Utime time);
  void Join(const StandingThings& process);
  void JoinSeen(std::vector<MapThing> seen);
  std::vector<MapLand> Land();
  void LeaveOutLand(std::size_t num_tiles, std::vector<MapLand>& land);

  std::map<tracker::ScanKey, Process> processes_;  // by the scan at which they began
  std::map<std::int64_t, MapThing> things_;        // by number
  std::int64_t next_number_ = 1;
  std::vector<std::pair<Datum, std::map<Cell, ToldCell>>> land_;  // by the map frame in which the land was told
  std::int64_t num_things_left_out_ = 0;
  std::int64_t num_cells_left_out_ = 0;
  std::int64_t num_over_limit_ = 0;
};

}  // namespace lookout::exporter
