#include "services/segmenter/core/measure.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "services/segmenter/core/footprint.hpp"

namespace lookout::segmenter {

namespace {

using std::chrono::microseconds;
using std::chrono::nanoseconds;

// At which its laser fired, since ScanHead::time.
nanoseconds TimeOf(const Scan& scan, const Return& one) {
  return nanoseconds(std::int64_t{scan.columns.time_ns[static_cast<std::size_t>(one.column)]} +
                     scan.head.rings[static_cast<std::size_t>(one.ring)].time_offset_ns);
}

microseconds RoundDown(nanoseconds time) { return std::chrono::floor<microseconds>(time); }

// The mean of whole nanoseconds, rounded down to microseconds: towards the past also where a scan's times are below zero.
microseconds RoundedMean(nanoseconds sum, std::int64_t count) {
  const std::int64_t divisor = 1000 * count;
  const std::int64_t quotient = sum.count() / divisor;
  return microseconds(sum.count() % divisor < 0 ? quotient - 1 : quotient);
}

HullCorner CornerAt(const Scan& scan, const Return& one) {
  return {one.point.x_m, one.point.y_m, static_cast<std::int32_t>(RoundDown(TimeOf(scan, one)).count())};
}

// Makes it new but for the memory of its corners.
void Forget(Segment& segment) {
  Segment fresh;
  fresh.hull.swap(segment.hull);
  fresh.waterline.swap(segment.waterline);
  fresh.hull.clear();
  fresh.waterline.clear();
  segment = std::move(fresh);
}

// Beams of a column that look aside of each other by less: 0.2 degrees, a column's width.
constexpr float kUprightRad = 0.0035F;

// A line on the water as exact as the lidar: its range is good to 3 cm, its footprint at 30 m is 0.1 m wide.
constexpr double kWaterlineOffM = 0.1;

}  // namespace

// A drop, in most cases: there is nothing to add up.
void Measurer::MeasureSingle(const Scan& scan, const Return& one, Segment& segment) {
  const HullCorner corner = CornerAt(scan, one);
  segment.time = segment.nearest_time = scan.head.time + RoundDown(TimeOf(scan, one));
  segment.num_points = 1;
  segment.nearest = segment.top = one.point;
  segment.centroid = {0.0F + one.point.x_m, 0.0F + one.point.y_m, 0.0F + one.point.z_m};  // a sum is never minus nought
  segment.min_z_m = segment.max_z_m = one.point.z_m;
  segment.min_reflectivity = segment.max_reflectivity = scan.columns.reflectivity[static_cast<std::size_t>(one.cell)];
  segment.mean_reflectivity = static_cast<float>(segment.min_reflectivity);
  segment.box_center_x_m = one.point.x_m;
  segment.box_center_y_m = one.point.y_m;
  segment.hull.push_back(corner);
}

// `indices` of the returns of one segment, in the order of their cells.
void Measurer::MeasureOne(const Scan& scan, std::span<const Return> returns, std::span<const std::int32_t> indices, Segment& segment) {
  double sum_x_m = 0.0;
  double sum_y_m = 0.0;
  double sum_z_m = 0.0;
  std::int64_t sum_ns = 0;
  std::int64_t sum_reflectivity = 0;
  double least_m2 = std::numeric_limits<double>::infinity();
  std::int32_t nearest = indices.front();
  double greatest_height_m = -std::numeric_limits<double>::infinity();
  std::int32_t highest = nearest;
  float min_z_m = returns[static_cast<std::size_t>(nearest)].point.z_m;
  float max_z_m = min_z_m;
  std::int32_t min_reflectivity = std::numeric_limits<std::int32_t>::max();
  std::int32_t max_reflectivity = 0;
  footprint_.clear();
  const Ring* rings = scan.head.rings.data();
  for (std::size_t i = 0; i < indices.size();) {
    // Of each column the nearest and the farthest return, in this order; of equals the first. Branchless, since a processor cannot guess them.
    const std::int32_t column = returns[static_cast<std::size_t>(indices[i])].column;
    const std::int64_t column_ns = scan.columns.time_ns[static_cast<std::size_t>(column)];
    std::int32_t near_index = indices[i];
    std::int32_t far_index = near_index;
    float near_m2 = std::numeric_limits<float>::infinity();
    float far_m2 = -near_m2;
    do {
      const std::int32_t index = indices[i++];
      const Return& one = returns[static_cast<std::size_t>(index)];
      const Point point = one.point;
      sum_ns += column_ns + rings[one.ring].time_offset_ns;
      const double x_m = point.x_m;
      const double y_m = point.y_m;
      const double z_m = point.z_m;
      sum_x_m += x_m;
      sum_y_m += y_m;
      sum_z_m += z_m;
      min_z_m = std::min(min_z_m, point.z_m);
      max_z_m = std::max(max_z_m, point.z_m);
      const double distance_m2 = x_m * x_m + y_m * y_m + z_m * z_m;
      if (distance_m2 < least_m2) {
        least_m2 = distance_m2;
        nearest = index;
      }
      const double height_m = up_.x() * x_m + up_.y() * y_m + up_.z() * z_m;
      if (height_m > greatest_height_m) {
        greatest_height_m = height_m;
        highest = index;
      }
      const std::int32_t reflectivity = scan.columns.reflectivity[static_cast<std::size_t>(one.cell)];
      sum_reflectivity += reflectivity;
      min_reflectivity = std::min(min_reflectivity, reflectivity);
      max_reflectivity = std::max(max_reflectivity, reflectivity);
      const float plan_m2 = point.x_m * point.x_m + point.y_m * point.y_m;
      near_index = plan_m2 < near_m2 ? index : near_index;
      near_m2 = plan_m2 < near_m2 ? plan_m2 : near_m2;
      far_index = plan_m2 > far_m2 ? index : far_index;
      far_m2 = plan_m2 > far_m2 ? plan_m2 : far_m2;
    } while (is_upright_ && i < indices.size() && returns[static_cast<std::size_t>(indices[i])].column == column);
    const auto take = [&](std::int32_t index) {
      const Point& point = returns[static_cast<std::size_t>(index)].point;
      footprint_.push_back({point.x_m, point.y_m, index});
    };
    take(near_index);
    if (near_m2 < far_m2) take(far_index);
  }
  segment.min_z_m = min_z_m;
  segment.max_z_m = max_z_m;
  segment.min_reflectivity = min_reflectivity;
  segment.max_reflectivity = max_reflectivity;
  segment.top = returns[static_cast<std::size_t>(highest)].point;
  const auto count = static_cast<double>(indices.size());
  const Return& nearest_return = returns[static_cast<std::size_t>(nearest)];
  segment.time = scan.head.time + RoundedMean(nanoseconds(sum_ns), static_cast<std::int64_t>(indices.size()));
  segment.num_points = static_cast<std::int32_t>(indices.size());
  segment.centroid = {static_cast<float>(sum_x_m / count), static_cast<float>(sum_y_m / count), static_cast<float>(sum_z_m / count)};
  segment.nearest = nearest_return.point;
  segment.nearest_time = scan.head.time + RoundDown(TimeOf(scan, nearest_return));
  segment.mean_reflectivity = static_cast<float>(static_cast<double>(sum_reflectivity) / count);

  if (footprint_.size() == 1) {
    segment.box_center_x_m = footprint_.front().x_m;
    segment.box_center_y_m = footprint_.front().y_m;
    segment.hull.push_back(CornerAt(scan, returns[static_cast<std::size_t>(footprint_.front().return_index)]));
    return;
  }
  shape_.Measure(footprint_);
  segment.box_center_x_m = shape_.box().center_x_m;
  segment.box_center_y_m = shape_.box().center_y_m;
  segment.length_m = shape_.box().length_m;
  segment.width_m = shape_.box().width_m;
  segment.length_azimuth_rad = shape_.box().length_azimuth_rad;
  for (const auto& corner : shape_.hull()) segment.hull.push_back(CornerAt(scan, returns[static_cast<std::size_t>(corner.return_index)]));
}

void Measurer::Measure(const Scan& scan, std::span<const Return> returns, const Groups& groups, std::vector<Segment>& segments) {
  // Returns sorted by segment; within one they stay in order. Those that follow each other are of one segment in most cases.
  const auto for_each_stretch = [&](auto handle) {
    for (std::size_t i = 0, end = 0; i < returns.size(); i = end) {
      const std::int32_t segment = groups.of_return[i];
      for (end = i + 1; end < returns.size() && groups.of_return[end] == segment;) ++end;
      if (segment != Groups::kNone) handle(static_cast<std::size_t>(segment), i, end);
    }
  };
  begin_.assign(static_cast<std::size_t>(groups.count) + 1, 0);
  for_each_stretch([this](std::size_t segment, std::size_t first, std::size_t end) { begin_[segment + 1] += end - first; });
  for (std::size_t segment = 1; segment < begin_.size(); ++segment) begin_[segment] += begin_[segment - 1];
  sorted_.resize(begin_.back());
  next_ = begin_;
  for_each_stretch([this](std::size_t segment, std::size_t first, std::size_t end) {
    std::int32_t* to = sorted_.data() + next_[segment];
    for (std::size_t i = first; i < end; ++i) *to++ = static_cast<std::int32_t>(i);
    next_[segment] += end - first;
  });
  is_upright_ = std::ranges::all_of(scan.head.rings, [](const Ring& ring) { return std::abs(ring.azimuth_offset_rad) <= kUprightRad; });
  Resize(static_cast<std::size_t>(groups.count), segments);
  for (std::size_t i = 0; i < segments.size(); ++i) {
    Segment& segment = segments[i];
    Forget(segment);
    const auto indices = std::span<const std::int32_t>(sorted_).subspan(begin_[i], begin_[i + 1] - begin_[i]);
    if (indices.size() == 1) {
      MeasureSingle(scan, returns[static_cast<std::size_t>(indices.front())], segment);
    } else {
      MeasureOne(scan, returns, indices, segment);
    }
    segment.id = static_cast<std::int32_t>(i) + 1;
  }
}

void Measurer::MeasureWaterline(const Scan& scan, std::span<const Return> returns, std::span<const std::int32_t> line, Segment& segment) {
  segment.waterline.clear();
  line_.clear();
  for (const std::int32_t index : line) {
    const Point& point = returns[static_cast<std::size_t>(index)].point;
    line_.push_back({point.x_m, point.y_m, index});
  }
  for (const auto& corner : simplifier_.Simplify(line_, kWaterlineOffM, kMaxWaterlineCorners)) {
    segment.waterline.push_back(CornerAt(scan, returns[static_cast<std::size_t>(corner.return_index)]));
  }
}

// Surplus segments are put aside with the memory of their corners.
void Measurer::Resize(std::size_t count, std::vector<Segment>& segments) {
  while (segments.size() > count) {
    spare_.push_back(std::move(segments.back()));
    segments.pop_back();
  }
  while (segments.size() < count && !spare_.empty()) {
    segments.push_back(std::move(spare_.back()));
    spare_.pop_back();
  }
  segments.resize(count);
}

std::vector<Segment> Measure(const Scan& scan, std::span<const Return> returns, const Groups& groups, const Eigen::Vector3d& up) {
  std::vector<Segment> segments;
  Measurer(up).Measure(scan, returns, groups, segments);
  return segments;
}

}  // namespace lookout::segmenter
