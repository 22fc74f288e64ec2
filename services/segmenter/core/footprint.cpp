#include "services/segmenter/core/footprint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "common/core/outlines.hpp"

namespace lookout::segmenter {

namespace {

bool TurnsLeft(const FootprintPoint& a, const FootprintPoint& b, const FootprintPoint& c) {
  return (static_cast<double>(b.x_m) - a.x_m) * (static_cast<double>(c.y_m) - a.y_m) >
         (static_cast<double>(b.y_m) - a.y_m) * (static_cast<double>(c.x_m) - a.x_m);
}

bool IsBefore(const FootprintPoint& a, const FootprintPoint& b) {
  return std::tie(a.x_m, a.y_m, a.return_index) < std::tie(b.x_m, b.y_m, b.return_index);
}

constexpr std::size_t kManyPoints = 64;

// Sorts by IsBefore. Sorting takes most of the time of a hull, and a shore has thousands of points: large sets are first dealt into buckets of
// equal width in x. `dealt` and `ends` are memory.
void SortPoints(std::vector<FootprintPoint>& points, std::vector<FootprintPoint>& dealt, std::vector<std::size_t>& ends) {
  constexpr std::size_t kPointsPerBucket = 4;
  const auto [least, greatest] = std::ranges::minmax_element(points, {}, &FootprintPoint::x_m);
  const double least_m = points.empty() ? 0.0 : least->x_m;
  const double width_m = points.empty() ? 0.0 : greatest->x_m - least_m;
  if (points.size() < kManyPoints || width_m <= 0.0) {
    std::ranges::sort(points, IsBefore);
    return;
  }
  const std::size_t num_buckets = points.size() / kPointsPerBucket;
  const double buckets_per_m = static_cast<double>(num_buckets) / width_m;
  const auto bucket_of = [&](const FootprintPoint& point) {
    return std::min(num_buckets - 1, static_cast<std::size_t>((point.x_m - least_m) * buckets_per_m));
  };
  ends.assign(num_buckets + 1, 0);
  for (const auto& point : points) ++ends[bucket_of(point) + 1];
  for (std::size_t bucket = 1; bucket <= num_buckets; ++bucket) ends[bucket] += ends[bucket - 1];
  dealt.resize(points.size());
  for (const auto& point : points) dealt[ends[bucket_of(point)]++] = point;  // ends[b] starts as the begin of bucket b
  for (std::size_t bucket = 0, begin = 0; bucket < num_buckets; begin = ends[bucket++]) {
    std::sort(dealt.begin() + static_cast<std::ptrdiff_t>(begin), dealt.begin() + static_cast<std::ptrdiff_t>(ends[bucket]), IsBefore);
  }
  std::ranges::copy(dealt, points.begin());
}

// Takes out points within the four-sided figure of the farthest points along x and y: they are no corners of the hull (Akl and Toussaint, 1978).
void DropInside(std::vector<FootprintPoint>& points) {
  if (points.size() < kManyPoints) return;
  constexpr double kMarginM2 = 1e-6;  // for rounding
  FootprintPoint left = points.front();
  FootprintPoint right = left;
  FootprintPoint bottom = left;
  FootprintPoint top = left;
  for (const auto& point : points) {
    if (point.x_m < left.x_m) left = point;
    if (point.x_m > right.x_m) right = point;
    if (point.y_m < bottom.y_m) bottom = point;
    if (point.y_m > top.y_m) top = point;
  }
  struct Side {
    double x, y, at_least;  // a point is inside of it where x p.x + y p.y is more
  };
  const auto side = [](const FootprintPoint& from, const FootprintPoint& to) {
    const double x = static_cast<double>(from.y_m) - to.y_m;
    const double y = static_cast<double>(to.x_m) - from.x_m;
    return Side{x, y, x * from.x_m + y * from.y_m + kMarginM2};
  };
  const Side sides[] = {side(left, bottom), side(bottom, right), side(right, top), side(top, left)};
  std::erase_if(points, [&](const FootprintPoint& point) {
    bool is_inside = true;
    for (const Side& one : sides) is_inside = is_inside && one.x * point.x_m + one.y * point.y_m > one.at_least;
    return is_inside;
  });
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
      const auto [sine, cosine] = SinCosOf(angle_rad);
      directions[i] = {cosine, sine};
    }
    return directions;
  }();
  return kDirections;
}

double Along(const FootprintPoint& point, double x, double y) { return x * point.x_m + y * point.y_m; }

void Simplify(std::vector<FootprintPoint>& hull, std::vector<bool>& is_kept) {
  if (hull.size() <= kMaxHullCorners) return;
  is_kept.assign(hull.size(), false);
  // The farthest corner goes round with the direction: from the last one on, as long as the next is farther.
  const auto farthest_first = std::ranges::max_element(hull, {}, [](const FootprintPoint& corner) { return corner.x_m; });
  auto at = static_cast<std::size_t>(farthest_first - hull.begin());
  for (const auto& direction : Directions()) {
    const auto next = [&hull](std::size_t corner) { return corner + 1 < hull.size() ? corner + 1 : 0; };
    while (Along(hull[next(at)], direction.x, direction.y) > Along(hull[at], direction.x, direction.y)) at = next(at);
    is_kept[at] = true;
  }
  std::size_t num_kept = 0;
  for (std::size_t corner = 0; corner < hull.size(); ++corner) {
    if (is_kept[corner]) hull[num_kept++] = hull[corner];
  }
  hull.resize(num_kept);
}

// Around a hull, with a side along one of its edges.
struct Flush {
  Direction direction{1.0, 0.0};  // of the edge
  double min_along_m = 0.0;
  double max_along_m = 0.0;
  double min_across_m = 0.0;  // across = to the left
  double max_across_m = 0.0;

  double area_m2() const { return (max_along_m - min_along_m) * (max_across_m - min_across_m); }
};

// Calls handle(flush) for each edge in order. The farthest corners go round with the edge (rotating calipers, M. Shamos 1978).
template <typename Handler>
void ForEachFlush(std::span<const FootprintPoint> hull, Handler handle) {
  const std::size_t count = hull.size();
  if (count < 2) return;
  const auto next = [count](std::size_t corner) { return corner + 1 < count ? corner + 1 : 0; };
  std::size_t ahead = 0;
  std::size_t left = 0;
  std::size_t behind = 0;
  for (std::size_t corner = 0; corner < count; ++corner) {
    const auto& from = hull[corner];
    const auto& to = hull[next(corner)];
    const double edge_x_m = static_cast<double>(to.x_m) - from.x_m;
    const double edge_y_m = static_cast<double>(to.y_m) - from.y_m;
    const double edge_m = std::sqrt(edge_x_m * edge_x_m + edge_y_m * edge_y_m);
    const Direction along{edge_x_m / edge_m, edge_y_m / edge_m};
    // From the corner, so that nothing is lost of small boxes far away.
    const auto along_m = [&](std::size_t i) {
      return along.x * (static_cast<double>(hull[i].x_m) - from.x_m) + along.y * (static_cast<double>(hull[i].y_m) - from.y_m);
    };
    const auto across_m = [&](std::size_t i) {
      return along.x * (static_cast<double>(hull[i].y_m) - from.y_m) - along.y * (static_cast<double>(hull[i].x_m) - from.x_m);
    };
    if (corner == 0) ahead = next(corner);
    while (along_m(next(ahead)) > along_m(ahead)) ahead = next(ahead);
    if (corner == 0) left = ahead;
    while (across_m(next(left)) > across_m(left)) left = next(left);
    if (corner == 0) behind = left;
    while (along_m(next(behind)) < along_m(behind)) behind = next(behind);
    const double base_along_m = Along(from, along.x, along.y);
    const double base_across_m = Along(from, -along.y, along.x);
    const double width_m = count > 2 ? std::max(0.0, across_m(left)) : 0.0;  // a line has no width, also when rounded
    handle(Flush{along, base_along_m + std::min(0.0, along_m(behind)), base_along_m + along_m(ahead), base_across_m, base_across_m + width_m});
  }
}

Rectangle ToRectangle(const Flush& flush) {
  const double along_m = flush.max_along_m - flush.min_along_m;
  const double across_m = flush.max_across_m - flush.min_across_m;
  const bool is_along = along_m >= across_m;
  const Direction direction = is_along ? flush.direction : Direction{-flush.direction.y, flush.direction.x};
  double azimuth_rad = WrapTo2Pi(-Atan2(direction.y, direction.x));
  if (azimuth_rad >= kPi) azimuth_rad -= kPi;
  const auto rounded_rad = static_cast<float>(azimuth_rad);
  const double middle_along_m = (flush.min_along_m + flush.max_along_m) / 2.0;
  const double middle_across_m = (flush.min_across_m + flush.max_across_m) / 2.0;
  Rectangle rectangle;
  rectangle.center_x_m = static_cast<float>(flush.direction.x * middle_along_m - flush.direction.y * middle_across_m);
  rectangle.center_y_m = static_cast<float>(flush.direction.y * middle_along_m + flush.direction.x * middle_across_m);
  rectangle.length_m = static_cast<float>(std::max(along_m, across_m));
  rectangle.width_m = static_cast<float>(std::min(along_m, across_m));
  rectangle.length_azimuth_rad = rounded_rad < static_cast<float>(kPi) ? rounded_rad : 0.0F;
  return rectangle;
}

Rectangle AtOnePlace(std::span<const FootprintPoint> hull) {
  Rectangle rectangle;
  if (hull.empty()) return rectangle;
  rectangle.center_x_m = hull.front().x_m;
  rectangle.center_y_m = hull.front().y_m;
  return rectangle;
}

double DiameterAlongAxes(std::span<const FootprintPoint> hull) {
  const auto [left, right] = std::ranges::minmax_element(hull, {}, &FootprintPoint::x_m);
  const auto [bottom, top] = std::ranges::minmax_element(hull, {}, &FootprintPoint::y_m);
  return Hypot(static_cast<double>(right->x_m) - left->x_m, static_cast<double>(top->y_m) - bottom->y_m);
}

// Sum of the distances of points to the nearest side.
double Closeness(const Flush& flush, std::span<const FootprintPoint> points, std::size_t stride) {
  double sum_m = 0.0;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    const double along_m = Along(points[i], flush.direction.x, flush.direction.y);
    const double across_m = Along(points[i], -flush.direction.y, flush.direction.x);
    sum_m += std::min(std::min(along_m - flush.min_along_m, flush.max_along_m - along_m),
                      std::min(across_m - flush.min_across_m, flush.max_across_m - across_m));
  }
  return sum_m;
}

}  // namespace

std::vector<FootprintPoint> ConvexHull(std::vector<FootprintPoint> points) {
  std::vector<FootprintPoint> dealt;
  std::vector<std::size_t> ends;
  std::vector<FootprintPoint> hull;
  DropInside(points);
  SortPoints(points, dealt, ends);
  points.erase(std::unique(points.begin(), points.end(), AreAtOnePlace), points.end());
  ChainHull(points, TurnsLeft, hull);
  return hull;
}

std::vector<FootprintPoint> SimplifyHull(std::vector<FootprintPoint> hull) {
  std::vector<bool> is_kept;
  Simplify(hull, is_kept);
  return hull;
}

Rectangle LeastAreaRectangle(std::span<const FootprintPoint> hull) {
  Flush best;
  double least_m2 = std::numeric_limits<double>::infinity();
  ForEachFlush(hull, [&](const Flush& flush) {
    if (flush.area_m2() >= least_m2) return;
    least_m2 = flush.area_m2();
    best = flush;
  });
  return hull.size() < 2 ? AtOnePlace(hull) : ToRectangle(best);
}

Rectangle FitBox(std::span<const FootprintPoint> hull, std::span<const FootprintPoint> points) {
  if (hull.size() < 3 || DiameterAlongAxes(hull) > kLongestBoxM) return LeastAreaRectangle(hull);
  double least_m2 = std::numeric_limits<double>::infinity();
  ForEachFlush(hull, [&](const Flush& flush) { least_m2 = std::min(least_m2, flush.area_m2()); });
  const std::size_t stride = std::max<std::size_t>(1, points.size() / kBoxPoints);
  Flush best;
  double closest_m = std::numeric_limits<double>::infinity();
  ForEachFlush(hull, [&](const Flush& flush) {
    if (flush.area_m2() > kBoxArea * least_m2) return;
    const double sum_m = Closeness(flush, points, stride);
    if (sum_m >= closest_m) return;
    closest_m = sum_m;
    best = flush;
  });
  return ToRectangle(best);
}

void Footprint::Measure(const std::vector<FootprintPoint>& points) {
  corners_ = points;
  DropInside(corners_);
  SortPoints(corners_, dealt_, ends_);
  corners_.erase(std::unique(corners_.begin(), corners_.end(), AreAtOnePlace), corners_.end());
  ChainHull(corners_, TurnsLeft, hull_);
  Simplify(hull_, is_kept_);
  box_ = FitBox(hull_, points);
}

}  // namespace lookout::segmenter
