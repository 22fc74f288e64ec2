// From clouds of points with rings to scans as LIDAR_SCAN has them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/core/angles.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "tools/import/cloud_columns.hpp"
#include "tools/import/cloud_points.hpp"

namespace lookout::importer {

/// The fate of points; sums over all clouds.
struct CloudCounts {
  std::int64_t num_points = 0;
  std::int64_t num_empty = 0;          // no return
  std::int64_t num_out_of_range = 0;   // RingCloud; or above or below the bands
  std::int64_t num_no_time = 0;        // RingCloud; of clouds whose times are used
  std::int64_t num_hidden = 0;         // another point of the same ring and firing is nearer: third returns, or the end of a turn over its begin
  std::int64_t num_no_ring = 0;        // of an unknown ring: fewer than kMinRingPoints points so far
  std::int64_t num_refused = 0;        // clouds: no fields x y z, or more columns and rings than a scan may have
  std::int64_t num_times_refused = 0;  // clouds: RingCloud::are_times_refused
};

/// Makes scans. The beams of the sensor (elevation and height of origin of each ring) are learned from the clouds that it is shown, since a cloud
/// does not say them.
class CloudScans {
 public:
  static constexpr std::int64_t kMinRingPoints = 20;

  /// Learns from a cloud of the beginning, before the first Convert; some ten are enough.
  /// @return whether it has points
  bool Learn(const RosPointCloud& cloud);

  /// @param name     of the sensor, for LIDAR_SCAN.model
  /// @param stamp_ns of the cloud, as it is to be used
  /// @return the parts of a scan, in order; empty where the cloud cannot be one. A direction is off by half a column at most where points have
  ///         neither firing nor place; a range is rounded to a unit of 2 mm, or as much as the farthest point needs
  std::vector<lidar_scan_t> Convert(const RosPointCloud& cloud, std::int64_t stamp_ns, const std::string& model);

  /// Labels of the cells of the last scan: of all its parts, in their order; without any where its cloud had none.
  const std::vector<std::uint32_t>& cell_labels() const { return cell_labels_; }

  const CloudCounts& counts() const { return counts_; }
  /// What is missing in the clouds, or how they are read, in words, for people and RUN_INFO.
  std::vector<std::string> Remarks() const;

 private:
  // Sums of a ring for z = height + level tan(elevation).
  struct RingSums {
    double num = 0.0, level = 0.0, z = 0.0, level_level = 0.0, level_z = 0.0, z_z = 0.0;
  };
  struct Beam {
    std::int32_t ring = 0;
    double elevation_rad = 0.0;
    double origin_height_m = 0.0;
  };

  // Sums over points of one elevation, to 0.01 degrees.
  struct ElevationSums {
    double num = 0.0, level = 0.0, z = 0.0;
  };

  void Add(const RingCloud& cloud);
  void AddElevations(const RingCloud& cloud);
  bool AreRingsScattered() const;
  void Settle();
  void CutBands();
  std::int32_t BandOf(double elevation_rad) const;
  void MendRings(RingCloud& cloud);
  std::vector<Beam> Beams() const;
  std::vector<Beam> SortIntoBeams(RingCloud& cloud);
  static std::array<std::int32_t, kMaxImportRings> PlacesOf(const std::vector<Beam>& beams);
  static lidar_scan_t HeadOf(const std::vector<Beam>& beams, const CloudColumns& columns, std::int64_t stamp_ns);
  // [shots] places of points in the cloud; `second` is empty where the cloud has one return of a shot.
  static constexpr std::int32_t kNoPoint = -1;
  struct CellPoints {
    std::vector<std::int32_t> first;
    std::vector<std::int32_t> second;
  };
  bool IsOneShot(const RingPoint& one, const RingPoint& other) const;
  CellPoints SortIntoCells(const RingCloud& cloud, const std::vector<std::size_t>& cell_of_point, const std::vector<double>& ranges_m,
                           std::size_t num_cells);
  void FillCells(const RingCloud& cloud, const std::vector<Beam>& beams, const CloudColumns& columns, lidar_scan_t& scan);
  std::vector<lidar_scan_t> Refuse(std::string reason);

  std::array<RingSums, kMaxImportRings> sums_{};
  std::vector<ElevationSums> elevations_;           // while learning: bands are cut when all that is learned is known
  std::array<double, 2> learned_rad_{kPi, -kPi};    // lowest and highest elevation
  std::optional<std::array<double, 2>> bands_rad_;  // of a sensor without rings: lowest and highest elevation of the bands
  bool is_settled_ = false;
  std::int64_t next_seq_ = 0;
  CloudCounts counts_;
  std::vector<std::uint32_t> cell_labels_;
  std::string last_refusal_;
  bool has_times_ = true;
  bool has_rings_ = true;
  bool has_reflectivity_ = true;
  bool has_second_returns_ = false;
  bool is_clock_other_ = false;
};

}  // namespace lookout::importer
