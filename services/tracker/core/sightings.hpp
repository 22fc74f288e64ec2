// The sightings of a scan, once the earlier scans have decided which of its pieces are one.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "services/tracker/core/followed.hpp"
#include "services/tracker/core/ledger.hpp"
#include "services/tracker/core/scan.hpp"
#include "services/tracker/core/sight.hpp"

namespace lookout::tracker {

/// One sighting, and its use in this scan.
struct Sighting {
  enum class Use { kFree, kLand, kAssigned, kTaken, kLeftOut };

  Seen seen;                              // segment_id: its number in this scan, from 1
  std::vector<Eigen::Vector2d> places_m;  // returns, or corners where these are not known
  std::vector<double> heights_m = {};     // of the returns, over the water; empty where these are not known
  Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
  double radius_m = 0.0;
  double range_m = 0.0;             // of the middle from the lidar
  std::optional<Sides> sides = {};  // asked for where they are needed
  Use use = Use::kFree;
  bool seems_moving = false;  // land that may be none: it is not remembered
};

struct Sightings {
  std::vector<Sighting> all;
  std::int32_t num_groups = 0;  // of the ledger: the first ones of all, in its order
  // The sighting of pieces (by number less one) and segments (by id less one), by index; of a segment in several the one with most of its returns;
  // -1: there is no such piece or segment, or it shows in second returns alone.
  std::vector<std::int32_t> of_piece;
  std::vector<std::int32_t> of_segment;
};

/// Asks the ledger. Where the scan has no labels, its segments are the sightings.
/// @param tracks  predicted to the scan
/// @param ledger  nullptr: segments stay as the scan has them
Sightings SightingsOf(const ScanInput& scan, const Sight& sight, const std::deque<Followed>& tracks, Ledger* ledger);

}  // namespace lookout::tracker
