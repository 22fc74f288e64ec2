#include "services/segmenter/core/footprint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "common/core/angles.hpp"

namespace lookout::segmenter {

namespace {

// Above 0 where the way from a over b to c turns left.
double Turn(const FootprintPoint& a, const FootprintPoint& b, const FootprintPoint& c) {
  return (static_cast<double>(b.x_m) - a.x_m) * (static_cast<double>(c.y_m) - a.y_m) -
         (static_cast<double>(b.y_m) - a.y_m) * (static_cast<double>(c.x_m) - a.x_m);
}

bool IsBefore(const FootprintPoint& a, const FootprintPoint& b) {
  return std::tie(a.x_m, a.y_m, a.return_index) < std::tie(b.x_m, b.y_m, b.return_index);
}

// Sorts by IsBefore. Sorting takes most of the time of a hull, and a shore has thousands of points: large sets are first dealt into buckets of
// equal width in x.
void SortPoints(std::vector<FootprintPoint>& points) {
  constexpr std::size_t kMinSizeForBuckets = 64;
  constexpr std::size_t kPointsPerBucket = 4;
  const auto [least, greatest] = std::ranges::minmax_element(points, {}, &FootprintPoint::x_m);
  const double least_m = points.empty() ? 0.0 : least->x_m;
  const double width_m = points.empty() ? 0.0 : greatest->x_m - least_m;
  if (points.size() < kMinSizeForBuckets || width_m <= 0.0) {
    std::ranges::sort(points, IsBefore);
    return;
  }
  const std::size_t num_buckets = points.size() / kPointsPerBucket;
  const double buckets_per_m = static_cast<double>(num_buckets) / width_m;
  const auto bucket_of = [&](const FootprintPoint& point) {
    return std::min(num_buckets - 1, static_cast<std::size_t>((point.x_m - least_m) * buckets_per_m));
  };
  std::vector<std::size_t> end(num_buckets + 1, 0);
  for (const auto& point : points) ++end[bucket_of(point) + 1];
  for (std::size_t bucket = 1; bucket <= num_buckets; ++bucket) end[bucket] += end[bucket - 1];
  std::vector<FootprintPoint> dealt(points.size());
  for (const auto& point : points) dealt[end[bucket_of(point)]++] = point;  // end[b] starts as the begin of bucket b
  for (std::size_t bucket = 0, begin = 0; bucket < num_buckets; begin = end[bucket++]) {
    std::sort(dealt.begin() + static_cast<std::ptrdiff_t>(begin), dealt.begin() + static_cast<std::ptrdiff_t>(end[bucket]), IsBefore);
  }
  points = std::move(dealt);
}

bool AreAtOnePlace(const FootprintPoint& a, const FootprintPoint& b) { return a.x_m == b.x_m && a.y_m == b.y_m; }

struct Direction {
  double x;
  double y;
};

// [kMaxHullCorners] unit vectors, counter-clockwise from x.
const std::array<Direction, kMaxHullCorners>& Directions() {
  static const auto kDirections = [] {
    std::array<Direction, kMaxHullCorners> directions{};
    for (std::size_t i = 0; i < directions.size(); ++i) {
      const double angle_rad = kTwoPi * static_cast<double>(i) / static_cast<double>(directions.size());
      directions[i] = {std::cos(angle_rad), std::sin(angle_rad)};
    }
    return directions;
  }();
  return kDirections;
}

double Along(const FootprintPoint& point, double x, double y) { return x * point.x_m + y * point.y_m; }

}  // namespace

std::vector<FootprintPoint> ConvexHull(std::vector<FootprintPoint> points) {
  SortPoints(points);
  points.erase(std::unique(points.begin(), points.end(), AreAtOnePlace), points.end());
  if (points.size() < 3) return points;

  std::vector<FootprintPoint> hull;
  const auto extend = [&hull](const FootprintPoint& point, std::size_t min_size) {
    while (hull.size() >= min_size && Turn(hull[hull.size() - 2], hull.back(), point) <= 0.0) hull.pop_back();
    hull.push_back(point);
  };
  for (const auto& point : points) extend(point, 2);
  const std::size_t lower_size = hull.size();
  for (auto point = points.rbegin() + 1; point != points.rend(); ++point) extend(*point, lower_size + 1);
  hull.pop_back();  // the first once more
  return hull;
}

std::vector<FootprintPoint> SimplifyHull(std::vector<FootprintPoint> hull) {
  if (hull.size() <= kMaxHullCorners) return hull;
  std::vector<bool> is_kept(hull.size(), false);
  // The farthest corner goes round with the direction: from the last one on, as long as the next is farther.
  const auto farthest_first = std::ranges::max_element(hull, {}, [](const FootprintPoint& corner) { return corner.x_m; });
  auto at = static_cast<std::size_t>(farthest_first - hull.begin());
  for (const auto& direction : Directions()) {
    const auto next = [&hull](std::size_t corner) { return corner + 1 < hull.size() ? corner + 1 : 0; };
    while (Along(hull[next(at)], direction.x, direction.y) > Along(hull[at], direction.x, direction.y)) at = next(at);
    is_kept[at] = true;
  }
  std::vector<FootprintPoint> kept;
  for (std::size_t corner = 0; corner < hull.size(); ++corner) {
    if (is_kept[corner]) kept.push_back(hull[corner]);
  }
  return kept;
}

Rectangle LeastAreaRectangle(std::span<const FootprintPoint> hull) {
  double least_m2 = std::numeric_limits<double>::infinity();
  double length_m = 0.0;
  double width_m = 0.0;
  Direction direction{1.0, 0.0};
  for (std::size_t corner = 0; hull.size() > 1 && corner < hull.size(); ++corner) {
    const auto& from = hull[corner];
    const auto& to = hull[corner + 1 < hull.size() ? corner + 1 : 0];
    const double edge_x_m = static_cast<double>(to.x_m) - from.x_m;
    const double edge_y_m = static_cast<double>(to.y_m) - from.y_m;
    const double edge_m = std::sqrt(edge_x_m * edge_x_m + edge_y_m * edge_y_m);
    const double x = edge_x_m / edge_m;
    const double y = edge_y_m / edge_m;
    double min_along_m = std::numeric_limits<double>::infinity();
    double max_along_m = -min_along_m;
    double max_across_m = 0.0;
    for (const auto& point : hull) {
      const double to_x_m = static_cast<double>(point.x_m) - from.x_m;
      const double to_y_m = static_cast<double>(point.y_m) - from.y_m;
      const double along_m = x * to_x_m + y * to_y_m;
      min_along_m = std::min(min_along_m, along_m);
      max_along_m = std::max(max_along_m, along_m);
      if (hull.size() > 2) max_across_m = std::max(max_across_m, x * to_y_m - y * to_x_m);  // a line has no width, also when rounded
    }
    const double along_m = max_along_m - min_along_m;
    if (along_m * max_across_m >= least_m2) continue;
    least_m2 = along_m * max_across_m;
    const bool is_along = along_m >= max_across_m;
    length_m = is_along ? along_m : max_across_m;
    width_m = is_along ? max_across_m : along_m;
    direction = is_along ? Direction{x, y} : Direction{-y, x};
  }
  double azimuth_rad = WrapTo2Pi(-std::atan2(direction.y, direction.x));
  if (azimuth_rad >= kPi) azimuth_rad -= kPi;
  const auto rounded_rad = static_cast<float>(azimuth_rad);
  return {static_cast<float>(length_m), static_cast<float>(width_m), rounded_rad < static_cast<float>(kPi) ? rounded_rad : 0.0F};
}

}  // namespace lookout::segmenter
