// A way from the obstacles of each scan to tracks. The boat's tracker and plain ones stand behind one interface.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/messages/scan_collector.hpp"
#include "lab/eval/tracks/track_scan.hpp"

namespace lookout::eval {

class MultiObjectTracker {
 public:
  MultiObjectTracker() = default;
  MultiObjectTracker(const MultiObjectTracker&) = delete;
  MultiObjectTracker& operator=(const MultiObjectTracker&) = delete;
  virtual ~MultiObjectTracker() = default;

  /// Name of the tracker in tables.
  virtual std::string name() const = 0;

  /// @param scan  the next one, with all parts of its OBSTACLES; obstacles of status OK are on the map
  /// @return the tracker's tracks at the end of the scan
  virtual std::vector<TrackState> Update(const messages::ScanMessages& scan) = 0;
};

using MultiObjectTrackers = std::vector<std::unique_ptr<MultiObjectTracker>>;

}  // namespace lookout::eval
