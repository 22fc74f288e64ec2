// One scan of a spinning lidar as the segmenter works on it. Values of these types are valid: wire.cpp lets no others in.
#pragma once

#include <cstdint>
#include <vector>

#include "common/core/utime.hpp"

namespace lookout::segmenter {

/// One laser. Rings are counted from the lowest beam up.
struct Ring {
  float elevation_rad = 0.0F;
  float azimuth_offset_rad = 0.0F;  // to be added to the azimuth of the column
  std::int32_t time_offset_ns = 0;  // to be added to the time of the column
  float origin_height_m = 0.0F;     // z at which the beam starts

  friend bool operator==(const Ring&, const Ring&) = default;
};

/// Members that all parts of a scan share.
struct ScanHead {
  Utime time;      // first firing
  Utime end_time;  // last shot
  std::int64_t seq = 0;
  std::int64_t raw_seq = 0;
  std::int32_t flags = 0;  // as on the wire, handed on
  int num_parts = 1;
  double range_unit_m = 0.0;
  std::vector<Ring> rings;
  int num_returns = 1;  // returns per laser shot: 1, or 2 in dual mode
  int num_turn_columns = 0;

  int num_rings() const { return static_cast<int>(rings.size()); }
  friend bool operator==(const ScanHead&, const ScanHead&) = default;
};

/// Firings in the order of time. A cell is a (column, ring, return): return fastest, then ring, then column.
struct Columns {
  std::vector<float> azimuth_rad;          // [columns] 0 to 2 pi, clockwise seen from above
  std::vector<std::int32_t> time_ns;       // [columns] since ScanHead::time
  std::vector<std::uint16_t> range;        // [cells] in range units; 0 = no return
  std::vector<std::uint8_t> reflectivity;  // [cells] device units

  int size() const { return static_cast<int>(azimuth_rad.size()); }
};

/// Columns [first_column, first_column + num_columns) of a scan.
struct ColumnSpan {
  int first_column = 0;
  int num_columns = 0;
};

struct Scan {
  ScanHead head;
  Columns columns;                // all of the scan
  std::vector<ColumnSpan> parts;  // [head.num_parts] as it came

  std::size_t num_cells() const { return columns.range.size(); }
};

}  // namespace lookout::segmenter
