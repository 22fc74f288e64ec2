#include "services/odometer/core/standing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "services/odometer/core/local_map.hpp"

namespace lookout::odometer {

namespace {

using Eigen::Vector3d;

// Neighbours on one surface differ by less: 0.15 m, and 2 % of the range, which is a wall seen at 10 deg by columns 0.2 deg apart.
constexpr double kSurfaceStepM = 0.15;
constexpr double kSurfaceStepPerRange = 0.02;
// Greatest step of the range from ring to ring, 2 deg apart, as a share of the range: a bank that rises by one in three.
constexpr double kBankStepPerRange = 0.12;
// Columns on either side by which the surface is told, and how uneven it may be: noise of the range, and bent hulls.
constexpr int kReach = 3;
constexpr double kUnevenM = 0.12;
constexpr double kPostM = 0.6;
// Deviation of a range; VLP-16 User Manual 63-9243 Rev E: accuracy +/- 3 cm.
constexpr double kRangeSdM = 0.03;

// Columns farther apart than so many times the usual step are no neighbours: the field of view ends there, or packets were lost.
constexpr double kMostSteps = 2.5;

// Angles between a column and the next, the last and the first too.
std::vector<double> StepsOf(const std::vector<double>& azimuth_rad) {
  std::vector<double> steps_rad(azimuth_rad.size());
  for (std::size_t i = 0; i < azimuth_rad.size(); ++i) steps_rad[i] = std::abs(WrapToPi(azimuth_rad[(i + 1) % azimuth_rad.size()] - azimuth_rad[i]));
  return steps_rad;
}

// How many columns adjoin each one on a side (1: by rising number, -1: by falling), one after the other.
std::vector<int> ReachesOf(const std::vector<bool>& has_next, int side) {
  const std::size_t num_columns = has_next.size();
  std::vector<int> reaches(num_columns);
  int reach = 0;
  // Twice around, since the last column may adjoin the first.
  for (std::size_t i = 0; i < 2 * num_columns; ++i) {
    const std::size_t column = side > 0 ? num_columns - 1 - i % num_columns : i % num_columns;
    const bool adjoins = has_next[side > 0 ? column : (column + num_columns - 1) % num_columns];
    reach = adjoins ? std::min(reach + 1, static_cast<int>(num_columns) - 1) : 0;
    reaches[column] = reach;
  }
  return reaches;
}

double MedianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

// The ranges of a scan as a ring of columns, or as several arcs of them.
class RangeImage {
 public:
  RangeImage(const Scan& scan, const StandingParams& params)
      : scan_(scan),
        T_vessel_lidar_(params.T_vessel_lidar),
        num_columns_(static_cast<int>(scan.azimuth_rad.size())),
        num_rings_(static_cast<int>(scan.rings.size())) {
    elevations_.reserve(scan.rings.size());
    for (const auto& ring : scan.rings) elevations_.push_back(SinCosOf(ring.elevation_rad));
    const auto steps_rad = StepsOf(scan.azimuth_rad);
    column_rad_ = MedianOf(steps_rad);
    std::vector<bool> has_next(steps_rad.size());
    for (std::size_t i = 0; i < steps_rad.size(); ++i) has_next[i] = steps_rad[i] <= kMostSteps * column_rad_;
    reach_up_ = ReachesOf(has_next, 1);
    reach_down_ = ReachesOf(has_next, -1);
  }

  int Column(int column) const { return column < 0 ? column + num_columns_ : column >= num_columns_ ? column - num_columns_ : column; }
  // Whether no gap lies between.
  bool Adjoins(int column, int offset) const {
    const auto& reaches = offset < 0 ? reach_down_ : reach_up_;
    return std::abs(offset) <= reaches[static_cast<std::size_t>(column)];
  }
  // 0 = no return
  double RangeM(int column, int ring) const {
    return scan_.range[static_cast<std::size_t>(Column(column)) * static_cast<std::size_t>(num_rings_) + static_cast<std::size_t>(ring)] *
           scan_.range_unit_m;
  }
  bool IsNear(int column, int offset, int ring, double range_m, double step_m) const {
    if (ring < 0 || ring >= num_rings_ || !Adjoins(column, offset)) return false;
    const double other_m = RangeM(column + offset, ring);
    return other_m > 0.0 && std::abs(other_m - range_m) < step_m;
  }

  Vector3d PointAt(int column, int ring) const {
    const auto& beam = scan_.rings[static_cast<std::size_t>(ring)];
    const auto elevation = elevations_[static_cast<std::size_t>(ring)];
    const double range_m = RangeM(column, ring);
    const auto azimuth = SinCosOf(scan_.azimuth_rad[static_cast<std::size_t>(Column(column))] + beam.azimuth_offset_rad);
    const double level_m = range_m * elevation.cos;
    return T_vessel_lidar_ * Vector3d(level_m * azimuth.cos, -level_m * azimuth.sin, range_m * elevation.sin + beam.origin_height_m);
  }

  // Whether one of the shots beside it met something as far away.
  bool HasNeighbour(int column, int ring) const {
    const double range_m = RangeM(column, ring);
    const double step_m = kSurfaceStepM + kSurfaceStepPerRange * range_m;
    return IsNear(column, 1, ring, range_m, step_m) || IsNear(column, -1, ring, range_m, step_m) || IsNear(column, 0, ring + 1, range_m, step_m) ||
           IsNear(column, 0, ring - 1, range_m, step_m);
  }

  // @return false where the surroundings say nothing: a wall seen at a grazing angle looks alike everywhere
  bool Describe(int column, int ring, TimedPoint& point) const;

 private:
  std::optional<Vector3d> CentreOfPost(int column, int ring, double range_m) const;
  struct Along {
    Vector3d along_m = Vector3d::Zero();  // 0: no neighbour says
    bool is_uneven = false;
  };
  Along AlongRing(int column, int ring, const Vector3d& p_m, double range_m) const;
  Vector3d AcrossRings(int column, int ring, const Vector3d& p_m, double range_m) const;

  const Scan& scan_;
  const Eigen::Isometry3d& T_vessel_lidar_;
  int num_columns_;
  int num_rings_;
  std::vector<SinCos> elevations_;
  double column_rad_ = 0.0;  // between most columns
  // [columns] how many adjoin it on either side, by rising and by falling number
  std::vector<int> reach_up_;
  std::vector<int> reach_down_;
};

// Centre of something narrow with free sight on both sides: the centre is the same from wherever the post is seen. Its returns lie on the side that
// faces the lidar; of a round post these are on average pi/4 of the radius before the axis. The centre lies behind them along the sight, not level:
// which way is up is not known here.
std::optional<Vector3d> RangeImage::CentreOfPost(int column, int ring, double range_m) const {
  const double step_m = kSurfaceStepM + kSurfaceStepPerRange * range_m;
  const double column_m = std::max(1e-3, range_m * column_rad_);
  const int most_columns = std::min(num_columns_, static_cast<int>(kPostM / column_m) + 1);
  int first = column;
  int last = column;
  for (const int side : {-1, 1}) {
    int& end = side < 0 ? first : last;
    while (last - first < most_columns && IsNear(column, end + side - column, ring, range_m, step_m)) end += side;
    const int next = end + side - column;
    // At the edge of the field of view the rest of a wall may be out of sight.
    if (last - first >= most_columns || !Adjoins(column, next)) return std::nullopt;
    // Something nearer hides the rest.
    const double beside_m = RangeM(column + next, ring);
    if (beside_m > 0.0 && beside_m < range_m) return std::nullopt;
  }
  const double radius_m = 0.5 * (last - first + 1) * column_m;
  // Returns beyond the ends of the scan are of another time.
  first = std::max(first, 0);
  last = std::min(last, num_columns_ - 1);
  Vector3d sum_m = Vector3d::Zero();
  for (int i = first; i <= last; ++i) sum_m += PointAt(i, ring);
  const Vector3d face_m = sum_m / (last - first + 1);
  const Vector3d outward = (face_m - T_vessel_lidar_.translation()).normalized();
  return face_m + (0.25 * std::numbers::pi * radius_m) * outward;
}

// Direction of the surface along the ring.
RangeImage::Along RangeImage::AlongRing(int column, int ring, const Vector3d& p_m, double range_m) const {
  const double step_m = kSurfaceStepM + kSurfaceStepPerRange * range_m;
  int reach = 0;
  while (reach < kReach && IsNear(column, reach + 1, ring, range_m, step_m * (reach + 1)) &&
         IsNear(column, -reach - 1, ring, range_m, step_m * (reach + 1))) {
    ++reach;
  }
  if (reach > 0) {
    const Vector3d one_m = PointAt(column - reach, ring);
    const Vector3d other_m = PointAt(column + reach, ring);
    const Vector3d along_m = other_m - one_m;
    const Vector3d away_m = p_m - one_m - along_m * (along_m.dot(p_m - one_m) / along_m.squaredNorm());
    return {along_m, away_m.squaredNorm() > kUnevenM * kUnevenM};
  }
  // The end of a surface: one side.
  for (const int side : {-1, 1}) {
    if (IsNear(column, 2 * side, ring, range_m, 2.0 * step_m) && IsNear(column, side, ring, range_m, step_m)) {
      return {PointAt(column + 2 * side, ring) - p_m, false};
    }
  }
  return {};
}

// Upwards along the surface; straight up where no other ring met it.
Vector3d RangeImage::AcrossRings(int column, int ring, const Vector3d& p_m, double range_m) const {
  const double step_m = kSurfaceStepM + kBankStepPerRange * range_m;
  const bool has_upper = IsNear(column, 0, ring + 1, range_m, step_m);
  const bool has_lower = IsNear(column, 0, ring - 1, range_m, step_m);
  if (!has_upper && !has_lower) return Vector3d::UnitZ();
  return (has_upper ? PointAt(column, ring + 1) : p_m) - (has_lower ? PointAt(column, ring - 1) : p_m);
}

bool RangeImage::Describe(int column, int ring, TimedPoint& point) const {
  const double range_m = RangeM(column, ring);
  if (const auto centre_m = CentreOfPost(column, ring, range_m)) {
    point.p_vessel_m = *centre_m;
    point.shape = Shape::kPost;
    return true;
  }
  const auto along = AlongRing(column, ring, point.p_vessel_m, range_m);
  if (along.is_uneven) return true;
  const Vector3d normal = along.along_m.cross(AcrossRings(column, ring, point.p_vessel_m, range_m));
  const double length = normal.norm();
  if (length <= 0.0) return false;
  point.normal = normal / length;
  // By the noise at both ends of the surface.
  point.normal_sd_rad = std::sqrt(2.0) * kRangeSdM / along.along_m.norm();
  point.shape = Shape::kSurface;
  return true;
}

}  // namespace

std::vector<TimedPoint> StandingPoints(const Scan& scan, double sample_m, const StandingParams& params) {
  std::vector<TimedPoint> points;
  // A torn scan of so few columns tells of no surface, and columns are looked at up to kReach to either side.
  if (scan.azimuth_rad.size() <= 2 * kReach) return points;
  const RangeImage image(scan, params);
  CubeIndex cubes;
  const std::int64_t end_ns = (scan.end_time - scan.time).count() * 1000;
  const auto num_rings = static_cast<int>(scan.rings.size());
  for (int column = 0; std::cmp_less(column, scan.azimuth_rad.size()); ++column) {
    for (int ring = 0; ring < num_rings; ++ring) {
      const double range_m = image.RangeM(column, ring);
      if (range_m <= 0.0 || range_m < params.min_range_m || range_m > params.max_range_m || !image.HasNeighbour(column, ring)) continue;
      TimedPoint point{image.PointAt(column, ring)};
      const auto& p_vessel_m = point.p_vessel_m;
      if (p_vessel_m.z() + params.reference_point_above_water_m < params.min_height_m) continue;
      if (!params.own_vessel_box_m.isEmpty() && params.own_vessel_box_m.contains(p_vessel_m)) continue;
      if (!cubes.Insert(CubeOf(p_vessel_m, sample_m)).second) continue;
      const auto time_ns = scan.time_ns[static_cast<std::size_t>(column)] + scan.rings[static_cast<std::size_t>(ring)].time_offset_ns;
      point.before_end_s = static_cast<double>(end_ns - time_ns) * 1e-9;
      if (image.Describe(column, ring, point)) points.push_back(point);
    }
  }
  return points;
}

}  // namespace lookout::odometer
