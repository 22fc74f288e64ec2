// The measurements of each segment.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "common/core/utime.hpp"
#include "services/segmenter/core/footprint.hpp"
#include "services/segmenter/core/groups.hpp"
#include "services/segmenter/core/line_simplifier.hpp"
#include "services/segmenter/core/returns.hpp"
#include "services/segmenter/core/scan.hpp"

namespace lookout::segmenter {

struct HullCorner {
  float x_m = 0.0F;
  float y_m = 0.0F;
  std::int32_t time_us = 0;  // of the return at this corner, since ScanHead::time, rounded down
};

/// Whether one scan is enough to believe in a segment.
enum class Confidence : std::int32_t { kTentative = 1, kSure = 2 };

/// Why a segment is tentative. Bits as on the wire.
enum Ground : std::int32_t {
  kFewReturns = 1,  // or very small: a buoy's one return and a drop of spray look the same
  kScattered = 2,   // many beams between its ends went through it, or its surroundings are scattered
  kAtSurface = 4,   // hardly higher than the water: foam, a glint, or a log awash
};

enum class SegmentKind : std::int32_t {
  kObstacle = 0,
  kLand = 1,  // shore, island, quay, pier
};

/// One obstacle in the lidar frame.
struct Segment {
  Utime time;  // mean of the times of its returns, rounded down
  std::int32_t id = 0;
  Confidence confidence = Confidence::kSure;
  std::int32_t grounds = 0;  // bits of Ground; 0 where it is sure
  SegmentKind kind = SegmentKind::kObstacle;
  // 0 to 1; NaN where the method states none, as the paper's.
  float thing_probability = std::numeric_limits<float>::quiet_NaN();  // to be no clutter
  float land_probability = std::numeric_limits<float>::quiet_NaN();
  std::int32_t num_points = 0;
  Point centroid;
  Point nearest;  // return nearest to the sensor; of equals the first
  Utime nearest_time;
  Point top;  // highest return along the vessel's up axis; of equals the first
  // Box around its footprint.
  float box_center_x_m = 0.0F;
  float box_center_y_m = 0.0F;
  float length_m = 0.0F;
  float width_m = 0.0F;
  float length_azimuth_rad = 0.0F;
  float min_z_m = 0.0F;
  float max_z_m = 0.0F;
  std::int32_t min_reflectivity = 0;
  float mean_reflectivity = 0.0F;
  std::int32_t max_reflectivity = 0;
  float seen_share = 1.0F;       // share of the columns between its ends that show it; in the rest something nearer hides it, or nothing came back
  std::vector<HullCorner> hull;  // counter-clockwise, 1 to kMaxHullCorners
  std::vector<HullCorner> waterline;  // of land: its nearest return in each direction, from left to right as the lidar sees it, at most
                                      // kMaxWaterlineCorners; empty for others
};

/// Measures the segments of one scan after the other, and keeps memory between them.
///
/// Hull and box are those of the nearest and the farthest return of each column. Lasers of a column look in directions up to 0.13 degrees apart, so a
/// return may lie outside of its hull by that much at its sides: 7 cm at 30 m, less than the beam is wide there. Where beams of a column look farther
/// aside, all returns count.
class Measurer {
 public:
  /// @param up  the vessel's z axis in the lidar frame, a unit vector: a lidar that is mounted tilted sees its own z axis lean
  explicit Measurer(const Eigen::Vector3d& up) : up_(up) {}

  /// @param groups    of the returns; group i becomes the segment of id i + 1
  /// @param segments  [groups.count] by id; what it held before is memory to use again
  void Measure(const Scan& scan, std::span<const Return> returns, const Groups& groups, std::vector<Segment>& segments);

  /// @param line  returns from left to right as the lidar sees them
  void MeasureWaterline(const Scan& scan, std::span<const Return> returns, std::span<const std::int32_t> line, Segment& segment);

 private:
  static void MeasureSingle(const Scan& scan, const Return& one, Segment& segment);
  void MeasureOne(const Scan& scan, std::span<const Return> returns, std::span<const std::int32_t> indices, Segment& segment);
  void Resize(std::size_t count, std::vector<Segment>& segments);

  Eigen::Vector3d up_;
  bool is_upright_ = true;  // beams of a column look the same way
  std::vector<std::size_t> begin_;
  std::vector<std::size_t> next_;
  std::vector<std::int32_t> sorted_;
  std::vector<FootprintPoint> footprint_;
  Footprint shape_;
  std::vector<FootprintPoint> line_;
  LineSimplifier simplifier_;
  std::vector<Segment> spare_;
};

/// One scan by itself.
std::vector<Segment> Measure(const Scan& scan, std::span<const Return> returns, const Groups& groups, const Eigen::Vector3d& up);

}  // namespace lookout::segmenter
