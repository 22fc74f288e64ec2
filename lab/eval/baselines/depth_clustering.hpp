// Depth clustering: neighbours in the range image are one where the line between them faces the sensor steeply enough.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "common/core/angles.hpp"
#include "lab/eval/baselines/peer.hpp"

namespace lookout::eval {

/// One range per beam. [columns x rings], ring fastest, from the lowest up.
struct DepthImage {
  int num_columns = 0;
  std::vector<double> elevation_rad;  // [rings]
  std::vector<float> range_m;         // 0 = empty
  std::vector<bool> joins_next;       // [columns] whether the next column, the first after the last, is its neighbour

  int num_rings() const { return static_cast<int>(elevation_rad.size()); }
  std::size_t Pixel(int column, int ring) const { return static_cast<std::size_t>(column) * elevation_rad.size() + static_cast<std::size_t>(ring); }
  int NextColumn(int column) const { return column + 1 < num_columns ? column + 1 : 0; }
  int PreviousColumn(int column) const { return column > 0 ? column - 1 : num_columns - 1; }
};

/// Defaults: the authors' program for KITTI (github.com/PRBonn/depth_clustering, show_objects_kitti and DepthGroundRemover).
struct DepthGroundParams {
  int max_gap_rings = 4;                      // an empty pixel is filled from pixels at most so many rings above and below it ...
  double max_gap_step_m = 1.0;                // ... whose ranges differ by less
  int smoothing_rings = 9;                    // window of the Savitzky-Golay filter; odd
  double max_start_angle_rad = DegToRad(30);  // slope at the lowest pixel of a column, above which it is no ground
  double max_step_angle_rad = DegToRad(7);    // change of slope from pixel to pixel
};

/// Gives empty pixels between measured ones of their column the mean range of these.
void FillGaps(DepthImage& image, const DepthGroundParams& params);

/// Slope of the line to the next higher ring, 0 = level, smoothed along the column. 0 before smoothing where one of the two pixels is empty.
std::vector<double> SlopesOf(const DepthImage& image, const DepthGroundParams& params);

/// Starts at the lowest pixel of each column and goes on to neighbours of nearly the same slope.
///
/// @return [pixels] whether it is ground
/// Source: I. Bogoslavskyi and C. Stachniss, "Efficient Online Segmentation for Sparse 3D Laser Scans", PFG 85 (2017), section 3.
std::vector<bool> FindGround(const DepthImage& image, const DepthGroundParams& params);

/// Defaults: the papers' 10 degrees; ground and least size as in the authors' program for KITTI.
struct DepthClusteringParams {
  std::optional<DepthGroundParams> ground = DepthGroundParams{};  // nullopt = no ground is sought, and no gap filled
  double angle_rad = DegToRad(10);
  // The next pixel with a return counts as the neighbour, if it is at most so many columns or rings away.
  int reach_columns = 1;
  int reach_rings = 1;
  SizeLimits limits{20, 100'000};
};

/// Connected components of the image by beta = atan2(d2 sin a, d1 - d2 cos a) > angle, d1 >= d2, a the angle between the beams.
///
/// The image has the scan's own columns, and in dual return all returns of a shot; of these the ground step sees the nearest.
/// Source: I. Bogoslavskyi and C. Stachniss, "Fast Range Image-Based Segmentation of Sparse 3D Laser Scans for Online Operation", IROS 2016, and
/// "Efficient Online Segmentation for Sparse 3D Laser Scans", PFG 85 (2017). Written from these. Cost: proportional to the pixels.
Grouping DepthGrouping(const DepthClusteringParams& params);

}  // namespace lookout::eval
