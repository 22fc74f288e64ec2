// Which points of a cloud belong to one firing, and the direction and time of each firing and ring.
#pragma once

#include <cstdint>
#include <vector>

#include "tools/import/cloud_points.hpp"

namespace lookout::importer {

struct CloudColumns {
  static constexpr std::int32_t kNoColumn = -1;

  std::vector<std::int32_t> column_of_point;  // [points]
  std::vector<double> azimuth_rad;            // [columns] in [0, 2 pi); in the order of time
  std::vector<double> time_ns;                // [columns] since the stamp of the cloud
  std::vector<double> azimuth_offset_rad;     // [rings of the sensor, by number] to be added to the azimuth of the column
  std::vector<double> time_offset_ns;         // [rings] to be added to the time of the column; the least is 0
  bool is_by_place = false;                   // the cloud was organised
  bool is_by_time = false;                    // by the times of the shots
  bool is_grid = false;                       // by an even grid of azimuth. None of the three: by the azimuths of the shots
};

/// Columns at most: more is no turn of a lidar.
inline constexpr std::int32_t kMaxImportColumns = 16'384;

/// Columns are the first of these that is possible: the columns (or rows) of an organised cloud; the firings, by the times of the points, where their
/// period shows; the firings, by the azimuths of the points, where each ring keeps its phase; an even grid of azimuth, as wide as the commonest step.
/// Columns without points lie evenly between their neighbours.
///
/// @return without columns where the cloud has no points, or more than kMaxImportColumns
CloudColumns FindColumns(const RingCloud& cloud);

}  // namespace lookout::importer
