// A scan as the lookout method works on it: returns levelled, and found by line and column.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "common/core/angles.hpp"
#include "services/segmenter/core/returns.hpp"
#include "services/segmenter/core/scan.hpp"

namespace lookout::segmenter {

/// A return with the vessel's z axis up and the lidar at the origin: x and y are seen from above.
struct LevelPoint {
  float x_m = 0.0F;
  float y_m = 0.0F;
  float height_m = 0.0F;
  float range_m = 0.0F;  // horizontal
};

inline float SquaredPlanDistance(const LevelPoint& one, const LevelPoint& other) {
  const float x_m = one.x_m - other.x_m;
  const float y_m = one.y_m - other.y_m;
  return x_m * x_m + y_m * y_m;
}

/// Two returns, one of them at this range, that are farther apart in range than this are farther apart than `reach_m`, however they are rounded.
inline float WidestRange(double reach_m, float range_m) {
  constexpr double kRoundedM = 1e-3;
  constexpr double kRoundedShare = 4e-6;
  return static_cast<float>(reach_m + kRoundedM + kRoundedShare * range_m);
}

/// Lines are the rings, from the lowest up, each once per return of a shot: line = ring x returns per shot + return.
///
/// Columns make a whole circle: where the scan is a part of one, empty columns stand for the rest. Where a lidar fires the beams of a column to more
/// than a column's width aside (Ouster: up to 3 degrees), each return stands in the column that it looks along.
class ScanGrid {
 public:
  static constexpr std::int32_t kNone = -1;
  /// More than any window of columns is wide.
  static constexpr int kMinColumns = 64;

  /// @param R_vessel_lidar  rotation from the lidar to the vessel frame: it levels the returns
  /// Cost: proportional to the cells. Allocates nothing once it has seen a scan of that size.
  void Fill(const Scan& scan, std::span<const Return> returns, const Eigen::Matrix3d& R_vessel_lidar);

  int num_lines() const { return num_lines_; }
  int num_columns() const { return num_columns_; }
  int num_layers() const { return num_layers_; }
  int RingOf(int line) const { return num_layers_ == 1 ? line : line / 2; }  // a division by a number unknown at compile time takes long
  /// The usual angle from a column to the next: the median round the circle, so that holes and the cut of the scan do not count.
  double column_step_rad() const { return column_step_rad_; }
  int num_rings() const { return static_cast<int>(elevation_rad_.size()); }
  double ElevationOf(int ring) const { return elevation_rad_[static_cast<std::size_t>(ring)]; }
  /// The angle from a ring to the next, mean of both sides; rings of many lidars are not equally far apart. kLoneRingStepRad where there is one ring.
  double RingStepOf(int ring) const { return ring_step_rad_[static_cast<std::size_t>(ring)]; }
  /// RingStepOf the ring that is nearest to an elevation.
  double RingStepAt(double elevation_rad) const;
  static constexpr double kLoneRingStepRad = DegToRad(2.0);
  /// The part of the sphere that beams of a ring see, over the width of a column: RingStepOf in whole microradians, so that sums of it are exact.
  std::int32_t WeightOfRing(int ring) const { return weight_of_ring_[static_cast<std::size_t>(ring)]; }
  /// A sum of weights as square degrees.
  double SquareDegreesOf(std::int64_t weight) const { return RadToDeg(static_cast<double>(weight) * 1e-6) * RadToDeg(column_step_rad_); }

  int Wrap(int column) const { return column < 0 ? column + num_columns_ : column < num_columns_ ? column : column - num_columns_; }
  /// @param column  0 to num_columns() - 1
  std::int32_t At(int line, int column) const {
    return return_at_[static_cast<std::size_t>(line) * static_cast<std::size_t>(num_columns_) + static_cast<std::size_t>(column)];
  }
  /// Horizontal range; infinite where there is no return.
  float RangeAt(int line, int column) const {
    return range_at_[static_cast<std::size_t>(line) * static_cast<std::size_t>(num_columns_) + static_cast<std::size_t>(column)];
  }
  /// The farthest that a shot met, of its one or two returns; infinite where there is none. A shot whose return is reported twice is as one of one
  /// return.
  float FarthestOfShot(int ring, int column) const {
    if (num_layers_ == 1) return RangeAt(ring, column);
    const float one_m = RangeAt(ring * num_layers_, column);
    const float other_m = RangeAt(ring * num_layers_ + 1, column);
    return std::isinf(one_m) ? other_m : std::isinf(other_m) ? one_m : std::max(one_m, other_m);
  }
  /// The nearest that a shot met; infinite where there is none.
  float NearestOfShot(int ring, int column) const {
    if (num_layers_ == 1) return RangeAt(ring, column);
    return std::min(RangeAt(ring * num_layers_, column), RangeAt(ring * num_layers_ + 1, column));
  }
  /// The first column from this one on, up to the last, in which a line has a return; num_columns() where there is none.
  int NextOccupied(int line, int column) const;
  /// [columns]
  std::span<const float> RangesOf(int line) const {
    return std::span(range_at_).subspan(static_cast<std::size_t>(line) * static_cast<std::size_t>(num_columns_),
                                        static_cast<std::size_t>(num_columns_));
  }
  const LevelPoint& PointOf(std::int32_t index) const { return points_[static_cast<std::size_t>(index)]; }
  std::span<const LevelPoint> points() const { return points_; }
  /// Column and line of the grid in which a return stands.
  std::int32_t ColumnOf(std::int32_t index) const { return column_of_[static_cast<std::size_t>(index)]; }
  std::int32_t LineOf(std::int32_t index) const { return line_of_[static_cast<std::size_t>(index)]; }
  /// Returns column by column.
  std::span<const std::int32_t> by_column() const { return by_column_; }

  /// Columns that an arc of this length takes at this distance, rounded up; at most half of the circle.
  int ColumnsOf(double length_m, double range_m) const;

 private:
  static constexpr int kWordBits = 64;

  void MeasureColumns(const Scan& scan);
  void MeasureRings(const Scan& scan);
  void SortByColumn();

  int num_lines_ = 0;
  int num_columns_ = 0;
  int num_layers_ = 1;
  double column_step_rad_ = 0.0;
  std::vector<double> elevation_rad_;         // [rings]
  std::vector<double> ring_step_rad_;         // [rings]
  std::vector<std::int32_t> weight_of_ring_;  // [rings]
  std::vector<std::int32_t> return_at_;       // [lines x columns]
  std::vector<float> range_at_;               // [lines x columns]
  std::size_t words_per_line_ = 0;
  std::vector<std::uint64_t> occupied_;  // [lines x words] a bit for each column: whether there is a return
  std::vector<LevelPoint> points_;       // [returns]
  std::vector<std::int32_t> column_of_;  // [returns]
  std::vector<std::int32_t> line_of_;    // [returns]
  std::vector<std::int32_t> by_column_;  // [returns]
  bool is_shifted_ = false;
  std::vector<std::int32_t> shift_of_;  // [rings] columns
  // Scratch.
  std::vector<float> steps_rad_;
  std::vector<std::int32_t> next_in_column_;
};

inline int ScanGrid::NextOccupied(int line, int column) const {
  const std::uint64_t* words = occupied_.data() + static_cast<std::size_t>(line) * words_per_line_;
  auto word = static_cast<std::size_t>(column / kWordBits);
  std::uint64_t bits = words[word] & (~std::uint64_t{0} << (column % kWordBits));
  while (bits == 0) {
    if (++word == words_per_line_) return num_columns_;
    bits = words[word];
  }
  return static_cast<int>(word) * kWordBits + std::countr_zero(bits);
}

}  // namespace lookout::segmenter
