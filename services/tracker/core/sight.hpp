// Which beams of a scan would have met a thing, and where they ended.
#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "services/tracker/core/body.hpp"
#include "services/tracker/core/scan.hpp"

namespace lookout::tracker {

/// Beams that would have met a thing if it reflected each of them. Numbers are of all beams, estimated from at most 24 columns.
struct Look {
  double num_open = 0.0;    // beams that met the thing, nothing, or something behind it
  double num_met = 0.0;     // of these, beams that ended in it
  double num_hidden = 0.0;  // beams that met something nearer: they say nothing
};

class Sight {
 public:
  /// @param reference_point_above_water_m  of the vessel frame's origin on calm water
  Sight(const Eigen::Isometry3d& T_vessel_lidar, double reference_point_above_water_m, double max_range_m);

  /// @return false where the scan says nothing: no beams, or no poses
  bool Begin(const ScanInput& scan);

  /// Look at a thing that stands in the water, from the water up to `top_m`, with this outline on the map.
  Look At(std::span<const Eigen::Vector2d> outline_m, double top_m) const;

  /// Whether something nearer stands before the places next to the ends of a seen outline.
  Sides SidesOf(std::span<const Eigen::Vector2d> outline_m, double top_m) const;

  /// Whether a square on the map, from its lower left corner, is within reach of the beams.
  bool Reaches(const Eigen::Vector2d& corner_m, double side_m) const;
  /// Whether beams passed a place between the water and `top_m`, and none of them ended there: they met something far behind, or nothing.
  bool IsFree(const Eigen::Vector2d& place_m, double top_m) const;

  /// The lidar on the map, in the middle of the scan.
  Eigen::Vector2d from_m() const { return (start_.translation() + 0.5 * (end_.translation() - start_.translation())).head<2>(); }

  /// The scan, for WatchedWater to keep. The sweep is that of Begin; nullptr where the scan says nothing.
  const Sweep* sweep() const { return sweep_; }
  const Eigen::Isometry3d& start() const { return start_; }  // T_map_lidar, z over the water
  const Eigen::Isometry3d& end() const { return end_; }
  const std::vector<Eigen::Vector2d>& ring() const { return ring_; }           // cosine and sine of the elevation
  const std::vector<double>& unwrapped_rad() const { return unwrapped_rad_; }  // azimuth of each column, increasing
  double max_range_m() const { return max_range_m_; }

  /// Returns of one segment on the map, all of the scan in the order of its cells.
  struct Return {
    Eigen::Vector2d place_m;
    double height_m;  // over the water
    std::int16_t label;
    std::int16_t piece;
  };
  std::vector<Return> Returns() const;

 private:
  struct Span {
    int first = 0;  // column; may be negative or beyond the last: wrap
    int count = 0;
    double near_m = 0.0;  // horizontal, from the lidar
    double far_m = 0.0;
  };
  Span ColumnsOf(std::span<const Eigen::Vector2d> outline_m) const;
  int ColumnAt(double azimuth_rad) const;
  Eigen::Isometry3d PoseAt(int column) const;

  Eigen::Isometry3d T_vessel_lidar_;
  double reference_point_above_water_m_;
  double max_range_m_;
  const Sweep* sweep_ = nullptr;
  Eigen::Isometry3d start_ = Eigen::Isometry3d::Identity();  // T_map_lidar, z over the water
  Eigen::Isometry3d end_ = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Vector2d> ring_;    // cosine and sine of the elevation
  std::vector<Eigen::Vector2d> column_;  // cosine and sine of the azimuth
  std::vector<double> unwrapped_rad_;    // azimuth from the first column on, increasing
};

}  // namespace lookout::tracker
