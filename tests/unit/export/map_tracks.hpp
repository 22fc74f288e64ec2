// Tracks that stand, for the tests of the boat's own map.
#pragma once

#include <algorithm>
#include <vector>

#include "common/core/pose.hpp"
#include "lookout/track_t.hpp"

namespace lookout::exporter::test {

/// 2 m by 1 m, 1.5 m high, known to 0.3 m.
inline track_t StandingTrack(std::int64_t id, const Datum& datum, const Eigen::Vector2d& place_m, Utime first, Utime seen) {
  track_t track{};
  track.id = id;
  track.status = track_t::STATUS_CONFIRMED;
  track.kind = track_t::KIND_BUOY;
  track.first_utime_us = ToUtimeUs(first);
  track.seen_utime_us = ToUtimeUs(seen);
  const auto place = datum.Map().Reverse({place_m.x(), place_m.y(), 0.0});
  track.latitude_deg = place.latitude_deg;
  track.longitude_deg = place.longitude_deg;
  track.position_map_m[0] = place_m.x();
  track.position_map_m[1] = place_m.y();
  track.covariance[0][0] = track.covariance[1][1] = 0.09;
  track.length_m = 2.0F;
  track.width_m = 1.0F;
  track.top_above_water_m = 1.5F;
  track.num_segments = 1;
  track.segment_ids = {1};
  const auto east_m = static_cast<float>(place_m.x());
  const auto north_m = static_cast<float>(place_m.y());
  track.num_outline = 4;
  track.outline_east_m = {east_m - 1.0F, east_m + 1.0F, east_m + 1.0F, east_m - 1.0F};
  track.outline_north_m = {north_m - 0.5F, north_m - 0.5F, north_m + 0.5F, north_m + 0.5F};
  return track;
}

}  // namespace lookout::exporter::test
