// What is seen in a scan, when the scans before are asked which of its pieces are one.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "services/tracker/core/followed.hpp"
#include "services/tracker/core/ledger.hpp"
#include "services/tracker/core/scan.hpp"
#include "services/tracker/core/sight.hpp"

namespace lookout::tracker {

struct Sightings {
  std::vector<Seen> seen;                // segment_id numbers them from 1
  std::vector<std::int32_t> of_piece;    // [pieces of the scan by number less one] index of seen; -1: there is no such piece
  std::vector<std::int32_t> of_segment;  // [segments of the scan by id less one] index of what has most of its returns; -1: there is no such segment
  std::vector<std::vector<Eigen::Vector2d>> places_m;  // [seen] returns, or corners
  std::vector<std::vector<double>> heights_m;          // [seen] of the returns, over the water; empty where these are not known
};

/// Asks the ledger. Where the scan has no labels, its segments are what is seen.
/// @param tracks  predicted to the scan
Sightings SightingsOf(const ScanInput& scan, const Sight& sight, const std::deque<Followed>& tracks, Ledger& ledger);

}  // namespace lookout::tracker
