// Which returns of a scan are looked at, and where they are: where both methods begin.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "common/core/angles.hpp"
#include "services/segmenter/core/scan.hpp"

namespace lookout::segmenter {

/// Why a return is in no segment. Numbers as on the wire.
enum class Reason : std::int16_t { kRange = 1, kOwnVessel = 2, kFieldOfView = 3, kShadowed = 4, kTooSmall = 5 };

/// Why a return is in no segment, as its label says.
constexpr std::int16_t ToLabel(Reason reason) { return static_cast<std::int16_t>(-static_cast<std::int16_t>(reason)); }

/// In the lidar frame. Single precision, as on the wire: measurements hold for the published points.
struct Point {
  float x_m = 0.0F;
  float y_m = 0.0F;
  float z_m = 0.0F;
};

inline double SquaredDistance(const Point& a, const Point& b) {
  const double x_m = static_cast<double>(a.x_m) - b.x_m;
  const double y_m = static_cast<double>(a.y_m) - b.y_m;
  const double z_m = static_cast<double>(a.z_m) - b.z_m;
  return x_m * x_m + y_m * y_m + z_m * z_m;
}

/// A return that is looked at.
struct Return {
  Point point{};
  float range_m = 0.0F;  // from where the beam starts
  std::int32_t cell = 0;
  std::int32_t column = 0;
  std::int32_t ring = 0;
};

struct ReturnFilter {
  double min_range_m = 0.5;
  double max_range_m = 120.0;
  double max_repeat_gap_m = 0.1;           // two returns of a shot that are no farther apart are one
  Sector field_of_view{};                  // of azimuths
  Eigen::AlignedBox3d own_vessel_box_m{};  // vessel frame; empty = none
  Eigen::Isometry3d T_vessel_lidar = Eigen::Isometry3d::Identity();
};

/// A return that repeats another of its shot: no point of its own.
struct Repeat {
  std::int32_t cell = 0;
  std::int32_t of_return = 0;  // index into ClassifiedReturns::returns
};

struct ClassifiedReturns {
  std::vector<Return> returns;      // those that are looked at, in the order of their cells
  std::vector<Repeat> repeats;      // in the order of their cells; none where a shot has one return
  std::vector<std::int16_t> label;  // [cells] minus the reason where a return is not looked at, else 0
};

/// Sorts out the returns that are out of range, else out of the field of view, else of the own vessel, and places all others. Of the placed returns
/// it sets those apart that repeat another of their shot.
///
/// In dual return a shot with one echo is reported twice. Ranges are compared in whole range units, and only those of placed returns: a return beside
/// a sorted-out one is no repeat, so that no obstacle at a limit is lost. Point of a return at range r, azimuth a (of its column, plus the offset of
/// its ring) and elevation e: (r cos e cos a, -r cos e sin a, r sin e + origin height). Cost: one sine and cosine per column and ring, none per
/// return. Allocates nothing once it has seen a scan of that size.
class ReturnClassifier {
 public:
  explicit ReturnClassifier(const ReturnFilter& filter) : filter_(filter) {}

  /// The result holds until the next call.
  const ClassifiedReturns& Classify(const Scan& scan);
  const ClassifiedReturns& result() const { return result_; }

 private:
  // Sines and cosines of one ring, so that the direction of a return takes no trigonometry: the azimuths of column and ring are added by the addition
  // theorem.
  struct RingGeometry {
    double cos_elevation_cos_offset;
    double cos_elevation_sin_offset;
    double sin_elevation;
    double azimuth_offset_rad;
    double origin_height_m;
  };

  void SetRepeatsApart(const Scan& scan);

  ReturnFilter filter_;
  std::vector<RingGeometry> rings_;
  std::vector<std::uint32_t> occupied_;  // scratch: cells of a column that hold a return, as offsets from its first; [cells of a column + 1]
  ClassifiedReturns result_;
};

/// One scan by itself.
ClassifiedReturns ClassifyReturns(const Scan& scan, const ReturnFilter& filter);

}  // namespace lookout::segmenter
