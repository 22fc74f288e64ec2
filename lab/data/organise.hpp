// From points to a scan: which laser and which firing each point came from.
#pragma once

#include <cstdint>
#include <vector>

#include "lab/data/labelled_scan.hpp"
#include "lab/data/point_cloud.hpp"

namespace lookout::data {

struct OrganisedCloud {
  static constexpr std::int32_t kNoCell = -1;

  LabelledScan labelled;
  std::vector<std::int32_t> cell_of_point;  // [points] kNoCell = the point has no cell
  bool are_rings_found = false;             // else they are bands
  std::int64_t num_moved = 0;               // points whose cell was taken, now in the free cell of a neighbouring column
  std::int64_t num_hidden = 0;              // points whose cell and its neighbours were taken: without a cell
  std::int64_t num_out_of_range = 0;        // at the sensor itself or beyond kMaxCloudRangeM: without a cell
};

inline constexpr double kMaxCloudRangeM = 500.0;
inline constexpr int kMaxCloudRings = 128;
inline constexpr int kMaxCloudColumns = 4096;

/// Rings are heaps of elevations with gaps between them at least twice as wide as any heap; where there are none such (each laser has an origin of
/// its own, a cloud was moved or thinned), 64 bands of equal height stand for them. Columns are as wide as the commonest step of azimuth along a
/// ring. Where two points fall into a cell the nearer one has it.
///
/// @return a scan that LIDAR_SCAN can hold. Its ranges are exact to half a unit (2 mm, or as much as the farthest point needs); a direction is that
///         of its cell: off by half a column at most (one and a half where moved), and by half the height of its ring
/// Cost: sorting of the points.
OrganisedCloud Organise(const PointCloud& cloud);

}  // namespace lookout::data
