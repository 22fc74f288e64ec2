// The sightings of a scan: its pieces, merged as the ledger decides.
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

/// The returns of one thing in a scan, by the ledger, and their use in this scan.
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
  bool seems_moving = false;  // land that may be a barge: it is not remembered as land
};

struct Sightings {
  std::vector<Sighting> all;
  std::int32_t num_groups = 0;  // the first so many of `all` are the groups of the ledger, in its order
  // Index of the sighting of each piece (by number less one) and segment (by id less one). Of a segment in several sightings it is the one with most
  // of its returns. -1: there is no such piece or segment, or it shows in second returns alone.
  std::vector<std::int32_t> of_piece;
  std::vector<std::int32_t> of_segment;
};

/// Merges the pieces of the scan as the ledger decides. Where the scan has no labels, its segments are the sightings.
/// @param tracks  predicted to the scan
/// @param ledger  nullptr: segments stay as the scan has them
Sightings SightingsOf(const ScanInput& scan, const Sight& sight, const std::deque<Followed>& tracks, Ledger* ledger);

}  // namespace lookout::tracker
