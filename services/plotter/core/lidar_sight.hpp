// Where a lidar looks to: calm water gives no returns, so the columns that come at all tell, and the beams that end on the own boat.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/core/angles.hpp"
#include "services/plotter/core/sectors.hpp"

namespace lookout::plotter {

struct LidarSightParams {
  Eigen::Isometry3d T_vessel_lidar = Eigen::Isometry3d::Identity();
  double above_water_m = 0.0;                 // the lidar, with the boat level
  double min_range_m = 0.0;                   // of the segmenter
  Sector field_of_view = {};                  // of the segmenter, azimuths of the lidar
  Eigen::AlignedBox3d own_vessel_box_m = {};  // vessel frame; empty = none
  double reach_m = 0.0;                       // horizontal, from the lidar
};

/// Config of the boat and its lidars from which the surroundings are made.
struct SurroundingsParams {
  std::vector<LidarSightParams> lidars;  // one, or two
  Eigen::AlignedBox3d own_vessel_box_m = {};
  double reach_m = 0.0;
  bool takes_tentative = false;
};

/// One scan in whole degrees of bearing from the lidar, from the bow clockwise. A degree counts as looked into when more than half of its columns
/// have a beam that passes the own boat and, at the reach, is between 0 and kTopM above the water.
class LidarSight {
 public:
  static constexpr std::size_t kNumBearings = 360;
  /// A person in a small boat.
  static constexpr double kTopM = 2.0;

  /// @param elevation_rad  of the rings
  LidarSight(const LidarSightParams& params, std::span<const float> elevation_rad);

  bool IsFor(std::span<const float> elevation_rad) const;

  /// Forgets the scan before.
  void Begin() { num_columns_ = num_looking_ = {}; }

  struct Column {
    double azimuth_rad = 0.0;
    double step_rad = 0.0;                      // to the next column
    double turned_rad = 0.0;                    // how far the bow has turned clockwise since the column
    std::span<const float> azimuth_offset_rad;  // [rings]
    std::span<const float> range_m;             // [rings] of the nearest return; 0 = none
  };
  void Add(const Column& column);

  bool Looks(std::size_t bearing_deg) const { return num_columns_[bearing_deg] > 0 && 2 * num_looking_[bearing_deg] > num_columns_[bearing_deg]; }

  Eigen::Vector2d place_m() const { return params_.T_vessel_lidar.translation().head<2>(); }

 private:
  bool GetsFar(const Eigen::Vector3d& direction_vessel) const;
  Eigen::Vector3d DirectionOf(double azimuth_rad, std::size_t ring) const;

  LidarSightParams params_;
  std::vector<float> elevation_rad_;
  std::array<std::vector<std::uint16_t>, kNumBearings> rings_;  // [degrees of azimuth] rings whose beams reach far enough there
  std::array<int, kNumBearings> num_columns_{};
  std::array<int, kNumBearings> num_looking_{};
};

/// Which sectors are looked into from the own boat to the reach, at each of seven bearings. Geometry is made once.
class SectorSight {
 public:
  /// @param lidar_place_m  vessel frame, of each lidar
  SectorSight(std::span<const Eigen::Vector2d> lidar_place_m, const Eigen::AlignedBox3d& own_vessel_box_m, double reach_m);

  /// @param lidars  in the order of the places; nullptr: no scan came from this lidar
  std::array<bool, kNumSectors> Looked(std::span<const LidarSight* const> lidars) const;

 private:
  static constexpr std::size_t kMostLidars = 2;
  using Bearings = std::array<std::uint16_t, kMostLidars>;  // bearings of one place, from each lidar

  std::array<std::vector<Bearings>, kNumSectors> places_;
};

}  // namespace lookout::plotter
