// Makers of messages. Makers of one folder's tests begin with these, and add what their tests are about.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "common/core/geodesy.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/segments_t.hpp"
#include "lookout/tracks_t.hpp"

namespace lookout::support {

/// The head of a message of a scan: LIDAR_SCAN, SEGMENTS, OBSTACLES, TRACKS or ALERTS, in one part.
///
/// @param duration_us  from the first to the last firing
template <typename Message>
Message OfScan(std::int64_t utime_us, std::int64_t seq, std::int64_t duration_us) {
  Message message{};
  message.utime_us = utime_us;
  message.seq = message.raw_seq = seq;
  message.end_utime_us = utime_us + duration_us;
  if constexpr (requires { message.num_parts; }) message.num_parts = 1;
  return message;
}

/// Puts an array with its counts into a message.
inline void Fill(obstacles_t& message, std::vector<obstacle_t> obstacles) {
  message.obstacles = std::move(obstacles);
  message.num_obstacles = static_cast<std::int32_t>(message.obstacles.size());
}
inline void Fill(segments_t& message, std::vector<segment_t> segments) {
  message.segments = std::move(segments);
  message.num_segments = message.num_turn_segments = static_cast<std::int32_t>(message.segments.size());
}
inline void Fill(tracks_t& message, std::vector<track_t> tracks) {
  message.tracks = std::move(tracks);
  message.num_tracks = message.num_scan_tracks = static_cast<std::int32_t>(message.tracks.size());
}
inline void Fill(alerts_t& message, std::vector<alert_t> alerts) {
  message.alerts = std::move(alerts);
  message.num_alerts = static_cast<std::int32_t>(message.alerts.size());
}

/// Sets the datum of a message.
template <typename Message, typename Place = GeodeticPlace>
void SetDatum(Message& message, const Place& datum) {
  message.datum_latitude_deg = datum.latitude_deg;
  message.datum_longitude_deg = datum.longitude_deg;
  message.datum_ellipsoid_height_m = datum.ellipsoid_height_m;
}

/// Makes it the scan of a lidar with two rings, -0.1 and 0.1 rad, and a return of 2 mm steps a shot; all columns are its own.
///
/// @param azimuth_rad, time_ns  of each column
/// @param range                 of each return
inline void FillColumns(lidar_scan_t& message, std::vector<float> azimuth_rad, std::vector<std::int32_t> time_ns, std::int16_t range) {
  message.range_unit_m = 0.002;
  message.num_rings = 2;
  message.elevation_rad = {-0.1F, 0.1F};
  message.azimuth_offset_rad = message.origin_height_m = {0.0F, 0.0F};
  message.time_offset_ns = {0, 2304};
  message.num_returns = 1;
  message.return_kind = {lidar_scan_t::RETURN_STRONGEST};
  message.azimuth_rad = std::move(azimuth_rad);
  message.time_ns = std::move(time_ns);
  message.num_turn_columns = message.num_columns = static_cast<std::int32_t>(message.azimuth_rad.size());
  message.num_cells = message.num_columns * 2;
  message.range.assign(static_cast<std::size_t>(message.num_cells), range);
  message.reflectivity.assign(static_cast<std::size_t>(message.num_cells), 7);
}

/// SEGMENTS of a part of a scan, each cell of which has this label; no segment.
inline segments_t LabelsOf(const lidar_scan_t& scan, std::int16_t label) {
  auto message = OfScan<segments_t>(scan.utime_us, scan.seq, scan.end_utime_us - scan.utime_us);
  message.part_index = scan.part_index;
  message.num_parts = scan.num_parts;
  message.num_rings = scan.num_rings;
  message.num_returns = scan.num_returns;
  message.first_column = scan.first_column;
  message.num_columns = scan.num_columns;
  message.num_cells = scan.num_cells;
  message.label.assign(static_cast<std::size_t>(scan.num_cells), label);
  return message;
}

/// Parts of a message, each with at most so many tracks, as the tracker sends them. One that needs no second part stays as it is.
inline std::vector<tracks_t> InParts(const tracks_t& whole, std::size_t most_tracks) {
  const auto num_parts = std::max<std::size_t>(1, (whole.tracks.size() + most_tracks - 1) / most_tracks);
  std::vector<tracks_t> parts(num_parts, whole);
  for (std::size_t i = 0; num_parts > 1 && i < num_parts; ++i) {
    const auto at = [&](std::size_t part) {
      return whole.tracks.begin() + static_cast<std::ptrdiff_t>(std::min(whole.tracks.size(), part * most_tracks));
    };
    parts[i].tracks.assign(at(i), at(i + 1));
    parts[i].num_tracks = static_cast<std::int32_t>(parts[i].tracks.size());
    parts[i].part_index = static_cast<std::int32_t>(i);
    parts[i].num_parts = static_cast<std::int32_t>(num_parts);
  }
  return parts;
}

}  // namespace lookout::support
