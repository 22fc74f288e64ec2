#include "services/segmenter/core/measure.hpp"

#include <algorithm>
#include <chrono>
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

// The mean of whole nanoseconds, rounded down to microseconds: towards the past also where a turn's times are below zero.
microseconds RoundedMean(nanoseconds sum, std::int64_t count) {
  const std::int64_t divisor = 1000 * count;
  const std::int64_t quotient = sum.count() / divisor;
  return microseconds(sum.count() % divisor < 0 ? quotient - 1 : quotient);
}

// `indices` of the returns of one segment, in the order of their cells.
Segment MeasureOne(const Scan& scan, std::span<const Return> returns, std::span<const std::int32_t> indices, const Eigen::Vector3d& up) {
  Segment segment;
  double sum_x_m = 0.0;
  double sum_y_m = 0.0;
  double sum_z_m = 0.0;
  nanoseconds sum_time{0};
  std::int64_t sum_reflectivity = 0;
  double least_m2 = std::numeric_limits<double>::infinity();
  std::int32_t nearest = indices.front();
  double greatest_height_m = -std::numeric_limits<double>::infinity();
  segment.min_z_m = segment.max_z_m = returns[static_cast<std::size_t>(nearest)].point.z_m;
  std::vector<FootprintPoint> footprint;
  footprint.reserve(indices.size());
  for (const std::int32_t index : indices) {
    const Return& one = returns[static_cast<std::size_t>(index)];
    const Point& point = one.point;
    sum_x_m += point.x_m;
    sum_y_m += point.y_m;
    sum_z_m += point.z_m;
    sum_time += TimeOf(scan, one);
    segment.min_z_m = std::min(segment.min_z_m, point.z_m);
    segment.max_z_m = std::max(segment.max_z_m, point.z_m);
    const double distance_m2 = SquaredDistance(point, Point{});
    if (distance_m2 < least_m2) {
      least_m2 = distance_m2;
      nearest = index;
    }
    const double height_m = up.x() * point.x_m + up.y() * point.y_m + up.z() * point.z_m;
    if (height_m > greatest_height_m) {
      greatest_height_m = height_m;
      segment.top = point;
    }
    const std::int32_t reflectivity = scan.columns.reflectivity[static_cast<std::size_t>(one.cell)];
    sum_reflectivity += reflectivity;
    segment.max_reflectivity = std::max(segment.max_reflectivity, reflectivity);
    footprint.push_back({point.x_m, point.y_m, index});
  }
  const auto count = static_cast<double>(indices.size());
  const Return& nearest_return = returns[static_cast<std::size_t>(nearest)];
  segment.time = scan.head.time + RoundedMean(sum_time, static_cast<std::int64_t>(indices.size()));
  segment.num_points = static_cast<std::int32_t>(indices.size());
  segment.centroid = {static_cast<float>(sum_x_m / count), static_cast<float>(sum_y_m / count), static_cast<float>(sum_z_m / count)};
  segment.nearest = nearest_return.point;
  segment.nearest_time = scan.head.time + RoundDown(TimeOf(scan, nearest_return));
  segment.mean_reflectivity = static_cast<float>(static_cast<double>(sum_reflectivity) / count);

  const auto hull = SimplifyHull(ConvexHull(std::move(footprint)));
  const auto rectangle = LeastAreaRectangle(hull);
  segment.length_m = rectangle.length_m;
  segment.width_m = rectangle.width_m;
  segment.length_azimuth_rad = rectangle.length_azimuth_rad;
  segment.hull.reserve(hull.size());
  for (const auto& corner : hull) {
    const auto time = RoundDown(TimeOf(scan, returns[static_cast<std::size_t>(corner.return_index)]));
    segment.hull.push_back({corner.x_m, corner.y_m, static_cast<std::int32_t>(time.count())});
  }
  return segment;
}

}  // namespace

std::vector<Segment> Measure(const Scan& scan, std::span<const Return> returns, const Groups& segments, const Eigen::Vector3d& up) {
  // Returns sorted by segment; within one they stay in order.
  std::vector<std::size_t> begin(static_cast<std::size_t>(segments.count) + 1, 0);
  for (const std::int32_t segment : segments.of_return) {
    if (segment != Groups::kNone) ++begin[static_cast<std::size_t>(segment) + 1];
  }
  for (std::size_t segment = 1; segment < begin.size(); ++segment) begin[segment] += begin[segment - 1];
  std::vector<std::int32_t> sorted(begin.back());
  auto next = begin;
  for (std::size_t i = 0; i < returns.size(); ++i) {
    if (segments.of_return[i] != Groups::kNone) sorted[next[static_cast<std::size_t>(segments.of_return[i])]++] = static_cast<std::int32_t>(i);
  }

  std::vector<Segment> measured;
  measured.reserve(static_cast<std::size_t>(segments.count));
  for (std::size_t segment = 0; segment + 1 < begin.size(); ++segment) {
    const std::span<const std::int32_t> indices(sorted.data() + begin[segment], begin[segment + 1] - begin[segment]);
    measured.push_back(MeasureOne(scan, returns, indices, up));
    measured.back().id = static_cast<std::int32_t>(segment) + 1;
  }
  return measured;
}

}  // namespace lookout::segmenter
