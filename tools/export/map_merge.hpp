// One map out of the MAP of many days.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/core/pose.hpp"
#include "lookout/map_t.hpp"
#include "lookout/tracks_t.hpp"
#include "services/tracker/core/gatherer.hpp"
#include "services/tracker/core/own_map.hpp"

namespace lookout::exporter {

/// What processes of the tracker were given and have kept, in any order of the logs; a log twice counts once.
///
/// Things of different processes are one where they lie within tracker::SamePlaceM and are of about one length, nearest pairs first; two things of
/// one process never are. A day's scans are the sum of those of its processes, or what a map that was given says of it, whichever is more. Land is
/// merged cell by cell, on the grid of the earth.
class MapMerge {
 public:
  /// @return false where the message is not well-formed: then it is left out
  bool Add(const map_t& message);
  /// What stands at the end of a process, after its last MAP.
  bool Add(const tracks_t& message);

  /// Once: things from south to north, ids from 1, and land by tile. Beyond the bounds of own_map.hpp the longest unseen are left out.
  tracker::OwnMap Merged();
  /// Of the last Merged.
  std::int64_t num_things_left_out() const { return num_things_left_out_; }
  std::int64_t num_cells_left_out() const { return num_cells_left_out_; }

 private:
  // A thing or a tile as it was told last.
  template <typename T>
  struct Told {
    std::int64_t seq = -1;  // of its message
    T what;
  };
  struct PlacedLand {
    tracker::MapLand land;
    Datum datum;
    double water_up_m = 0.0;
  };
  // One process of the tracker.
  struct Process {
    std::map<std::int64_t, tracker::MapThing> given;
    std::vector<tracker::MapLand> given_land;
    std::map<std::int64_t, Told<tracker::MapThing>> kept;
    std::map<std::pair<Utime, tracker::MapTile>, Told<PlacedLand>> land;  // by the begin of its memory, and tile
    std::int64_t kept_seq = -1;                                           // of the last KEPT
    std::optional<Utime> kept_time;                                       // end of the scan of the last KEPT
    Utime tracks_time;
    std::map<std::int64_t, tracker::MapThing> tracked;  // that stand in the last TRACKS, by track
  };
  // What one process says of one thing.
  struct Account {
    std::size_t process = 0;
    tracker::MapThing thing;
    std::vector<tracker::DayScans> given;  // of days before
    std::vector<tracker::DayScans> own;
  };
  using CellDays = std::pair<std::vector<std::int32_t>, Utime>;  // and seen last

  static void AddTracked(Process& process);
  std::vector<Account> Accounts();
  std::vector<tracker::MapThing> Things();
  std::vector<tracker::MapLand> Land();

  std::map<tracker::ScanKey, Process> processes_;  // by the scan at which they began
  std::int64_t num_things_left_out_ = 0;
  std::int64_t num_cells_left_out_ = 0;
};

}  // namespace lookout::exporter
