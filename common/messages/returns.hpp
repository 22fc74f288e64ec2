// The returns of a scan, one by one, with place, time and label.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include "common/core/angles.hpp"
#include "common/core/frames.hpp"
#include "common/messages/pieces.hpp"
#include "common/messages/words.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "lookout/segments_t.hpp"

namespace lookout::messages {

struct Return {
  std::int64_t utime_us;  // at which its laser fired, nearest microsecond
  int column;             // of the part, from 0
  int ring;               // from the lowest beam up
  int return_index;
  double azimuth_rad;  // clockwise from the lidar's x axis; not wrapped
  double range_m;
  Eigen::Vector3d p_lidar_m;
  int reflectivity;  // device units
  bool has_label;    // else the log holds no SEGMENTS of this part
  int label;         // 1.. = id of its segment, 0 = in none
  int piece;         // 1.. = number of its piece, 0 = in no segment
  std::string_view reason;
};

/// Calls `use(Return)` for each return, by column, then ring, then return of one firing.
///
/// @param scan    a part of a scan, well-formed
/// @param labels  of the same columns; nullptr where there are none
template <typename Use>
void ForEachReturn(const lidar_scan_t& scan, const segments_t* labels, Use use) {
  const auto num_rings = static_cast<std::size_t>(scan.num_rings);
  const auto num_returns = static_cast<std::size_t>(scan.num_returns);
  const auto piece = labels != nullptr ? PiecesOf(*labels) : std::vector<std::int16_t>();
  std::size_t cell = 0;
  for (std::size_t column = 0; column < static_cast<std::size_t>(scan.num_columns); ++column) {
    for (std::size_t ring = 0; ring < num_rings; ++ring) {
      for (std::size_t k = 0; k < num_returns; ++k, ++cell) {
        const auto count = static_cast<std::uint16_t>(scan.range[cell]);
        if (count == 0) continue;
        Return result{};
        const std::int64_t time_ns = std::int64_t{scan.time_ns[column]} + scan.time_offset_ns[ring];
        // Nearest microsecond, halves up; the shift keeps the division of negative numbers downwards.
        constexpr std::int64_t kShiftUs = 10'000'000;
        result.utime_us = scan.utime_us + (time_ns + 500 + kShiftUs * 1000) / 1000 - kShiftUs;
        result.column = static_cast<int>(column);
        result.ring = static_cast<int>(ring);
        result.return_index = static_cast<int>(k);
        result.azimuth_rad = static_cast<double>(scan.azimuth_rad[column]) + static_cast<double>(scan.azimuth_offset_rad[ring]);
        result.range_m = count * scan.range_unit_m;
        result.p_lidar_m = result.range_m * BeamDirection(result.azimuth_rad, static_cast<double>(scan.elevation_rad[ring]));
        result.p_lidar_m.z() += static_cast<double>(scan.origin_height_m[ring]);
        result.reflectivity = scan.reflectivity[cell];
        result.has_label = labels != nullptr;
        if (result.has_label) {
          const int label = labels->label[cell];
          result.label = label > 0 ? label : 0;
          result.piece = piece[cell];
          if (label < 0) result.reason = words::WordOf(words::kReason, -label);
        }
        use(result);
      }
    }
  }
}

}  // namespace lookout::messages
