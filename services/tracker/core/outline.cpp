#include "services/tracker/core/outline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"

namespace lookout::tracker {

namespace {

using Corners = std::span<const Eigen::Vector2d>;

// Rounding of coordinates up to 1000 km.
constexpr double kRoundingM = 1e-9;
// Corners nearer than this are one: no lidar tells them apart.
constexpr double kOneCornerM = 1e-6;

// The half-plane not farther than `offset_m` along `normal`, a unit vector.
struct HalfPlane {
  Eigen::Vector2d normal;
  double offset_m;
};

// The part of a polygon in a half-plane. Source: I. Sutherland and G. Hodgman, "Reentrant Polygon Clipping", 1974.
void Clip(const HalfPlane& side, std::vector<Eigen::Vector2d>& polygon, std::vector<Eigen::Vector2d>& scratch) {
  const auto beyond_m = [&side](const Eigen::Vector2d& corner) { return side.normal.dot(corner) - side.offset_m; };
  scratch.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const auto& next = polygon[i + 1 < polygon.size() ? i + 1 : 0];
    const double here_m = beyond_m(polygon[i]);
    const double there_m = beyond_m(next);
    if (here_m <= kRoundingM) scratch.push_back(polygon[i]);
    if ((here_m <= kRoundingM) != (there_m <= kRoundingM)) {
      scratch.emplace_back(polygon[i] + std::clamp(here_m / (here_m - there_m), 0.0, 1.0) * (next - polygon[i]));
    }
  }
  polygon.swap(scratch);
}

void DropTwins(std::vector<Eigen::Vector2d>& polygon) {
  const auto is_twin = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return (a - b).squaredNorm() < kOneCornerM * kOneCornerM; };
  polygon.erase(std::unique(polygon.begin(), polygon.end(), is_twin), polygon.end());
  while (polygon.size() > 1 && is_twin(polygon.front(), polygon.back())) polygon.pop_back();
}

// The polygon within all reaches, each farther by `slack_m`.
std::vector<Eigen::Vector2d> Within(const Support& support, double slack_m) {
  const auto reach = [&](std::size_t direction) { return support[direction] + slack_m; };
  const double west = -reach(8);
  const double south = -reach(12);
  if (reach(0) < west - kRoundingM || reach(4) < south - kRoundingM) return {};
  std::vector<Eigen::Vector2d> polygon{{west, south}, {reach(0), south}, {reach(0), reach(4)}, {west, reach(4)}};
  polygon.reserve(kDirections + 2);
  std::vector<Eigen::Vector2d> scratch;
  scratch.reserve(kDirections + 2);
  for (std::size_t i = 0; i < kDirections; ++i) {
    if (i % 4 != 0) Clip({CompassDirections()[i], reach(i)}, polygon, scratch);
  }
  DropTwins(polygon);
  return polygon;
}

// How far all must give way so that something lies within all of them. Nothing does exactly where three of them exclude each other (E. Helly, 1923):
// where their normals, weighted so that they cancel out, reach to less than nothing. The weight of each is the sine of the angle between the other
// two, 0 of the third where these are opposite.
double Contradiction(const Support& support) {
  const auto sine = [](std::size_t steps) { return steps == kDirections / 2 ? 0.0 : CompassDirections()[steps].y(); };
  double slack_m = 0.0;
  for (std::size_t i = 0; i < kDirections; ++i) {
    for (std::size_t j = i + 1; j <= i + kDirections / 2 && j < kDirections; ++j) {
      for (std::size_t k = std::max(j + 1, i + kDirections / 2); k <= j + kDirections / 2 && k < kDirections; ++k) {
        const Eigen::Vector3d weights(sine(k - j), sine(kDirections - (k - i)), sine(j - i));
        slack_m = std::max(slack_m, -(weights[0] * support[i] + weights[1] * support[j] + weights[2] * support[k]) / weights.sum());
      }
    }
  }
  return slack_m;
}

// The half-planes whose intersection is the polygon: those of its edges, and of the rectangle around it, which ends a line or a needle.
std::vector<HalfPlane> SidesOf(Corners polygon) {
  std::vector<HalfPlane> sides;
  sides.reserve(4 + polygon.size());
  for (std::size_t direction = 0; direction < kDirections; direction += kDirections / 4) {
    const auto& normal = CompassDirections()[direction];
    double reach_m = -std::numeric_limits<double>::infinity();
    for (const auto& corner : polygon) reach_m = std::max(reach_m, normal.dot(corner));
    sides.push_back({normal, reach_m});
  }
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d along = polygon[i + 1 < polygon.size() ? i + 1 : 0] - polygon[i];
    const double length_m = along.norm();
    if (length_m == 0.0) continue;
    const Eigen::Vector2d normal = Eigen::Vector2d(along.y(), -along.x()) / length_m;
    sides.push_back({normal, normal.dot(polygon[i])});
  }
  return sides;
}

// Whether their rectangles have a gap: then clipping leaves nothing, and need not be done.
bool AreApart(Corners first, Corners second) {
  constexpr double kGapM = 1e-6;  // far above rounding
  const auto rectangle = [](Corners polygon) {
    std::pair bounds(polygon.front(), polygon.front());
    for (const auto& corner : polygon) bounds = {bounds.first.cwiseMin(corner), bounds.second.cwiseMax(corner)};
    return bounds;
  };
  const auto [first_least, first_most] = rectangle(first);
  const auto [second_least, second_most] = rectangle(second);
  return ((first_least - second_most).array() > kGapM).any() || ((second_least - first_most).array() > kGapM).any();
}

// A corner of the difference of two polygons, and the corners of both that it comes from.
struct Pair {
  Eigen::Vector2d from_m;
  Eigen::Vector2d to_m;

  Eigen::Vector2d Difference() const { return from_m - to_m; }
  Pair Towards(const Pair& other, double share) const { return {from_m + share * (other.from_m - from_m), to_m + share * (other.to_m - to_m)}; }
};

// A polygon's edges in the order of their angles from east, beginning at its southernmost corner. Of the same turned by half a circle for sign -1.
class EdgeWalk {
 public:
  EdgeWalk(Corners polygon, double sign) : polygon_(polygon), sign_(sign) {
    const auto is_before = [sign](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
      return sign * a.y() != sign * b.y() ? sign * a.y() < sign * b.y() : sign * a.x() < sign * b.x();
    };
    at_ = static_cast<std::size_t>(std::min_element(polygon.begin(), polygon.end(), is_before) - polygon.begin());
    num_left_ = polygon.size() > 1 ? polygon.size() : 0;
  }

  bool HasEdge() const { return num_left_ > 0; }
  const Eigen::Vector2d& Corner() const { return polygon_[at_]; }
  Eigen::Vector2d Edge() const { return sign_ * (polygon_[Next()] - polygon_[at_]); }
  void Advance() {
    at_ = Next();
    --num_left_;
  }

 private:
  std::size_t Next() const { return at_ + 1 < polygon_.size() ? at_ + 1 : 0; }

  Corners polygon_;
  double sign_;
  std::size_t at_ = 0;
  std::size_t num_left_ = 0;
};

// The corners of the difference, counter-clockwise: the edges of both, merged by their angles.
std::vector<Pair> PairsOf(Corners first, Corners second) {
  EdgeWalk from(first, 1.0);
  EdgeWalk to(second, -1.0);
  std::vector<Pair> pairs{{from.Corner(), to.Corner()}};
  pairs.reserve(first.size() + second.size() + 1);
  while (from.HasEdge() || to.HasEdge()) {
    double turn = from.HasEdge() ? 1.0 : -1.0;
    if (from.HasEdge() && to.HasEdge()) turn = Cross(from.Edge(), to.Edge());
    if (turn >= 0.0 && from.HasEdge()) from.Advance();
    if (turn <= 0.0 && to.HasEdge()) to.Advance();
    pairs.push_back({from.Corner(), to.Corner()});
  }
  if (pairs.size() > 1) pairs.pop_back();  // back at the first
  return pairs;
}

// The origin as a mean of the corners of a triangle, where it lies in one of those that the polygon's first corner spans with its edges.
Pair AtOrigin(const std::vector<Pair>& pairs) {
  for (std::size_t i = 1; i + 1 < pairs.size(); ++i) {
    const Eigen::Vector2d a = pairs[0].Difference();
    const Eigen::Vector2d b = pairs[i].Difference();
    const Eigen::Vector2d c = pairs[i + 1].Difference();
    const Eigen::Vector3d weights(Cross(b, c), Cross(c, a), Cross(a, b));
    const double area = weights.sum();
    if (area <= 0.0 || weights.minCoeff() < -1e-12 * area) continue;
    const auto mean = [&](const auto& member) -> Eigen::Vector2d {
      return (weights[0] * pairs[0].*member + weights[1] * pairs[i].*member + weights[2] * pairs[i + 1].*member) / area;
    };
    const Eigen::Vector2d shared_m = 0.5 * (mean(&Pair::from_m) + mean(&Pair::to_m));
    return {shared_m, shared_m};
  }
  return {pairs[0].from_m, pairs[0].from_m};
}

}  // namespace

const Directions& CompassDirections() {
  static const Directions directions = [] {
    Directions made;
    for (std::size_t i = 0; i < kDirections; ++i) {
      const auto [sine, cosine] = SinCosOfDegrees(22.5 * static_cast<double>(i));
      made[i] = {cosine, sine};
    }
    return made;
  }();
  return directions;
}

Support SupportOf(std::span<const Eigen::Vector2d> corners_m) {
  const auto& directions = CompassDirections();
  Support support;
  support.fill(-std::numeric_limits<double>::infinity());
  for (const auto& corner : corners_m) {
    for (std::size_t i = 0; i < kDirections; ++i) support[i] = std::max(support[i], directions[i].dot(corner));
  }
  return support;
}

std::vector<Eigen::Vector2d> Polygon(const Support& support) {
  auto polygon = Within(support, 0.0);
  if (polygon.empty()) polygon = Within(support, Contradiction(support));
  return polygon;
}

// As by SidesOf, without keeping them: most points lie outside of the rectangle already.
bool Contains(std::span<const Eigen::Vector2d> polygon, const Eigen::Vector2d& point_m) {
  bool is_west_of_one = false;
  bool is_east_of_one = false;
  bool is_south_of_one = false;
  bool is_north_of_one = false;
  for (const auto& corner : polygon) {
    is_west_of_one |= point_m.x() - corner.x() <= kRoundingM;
    is_east_of_one |= corner.x() - point_m.x() <= kRoundingM;
    is_south_of_one |= point_m.y() - corner.y() <= kRoundingM;
    is_north_of_one |= corner.y() - point_m.y() <= kRoundingM;
  }
  if (!(is_west_of_one && is_east_of_one && is_south_of_one && is_north_of_one)) return false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d along = polygon[i + 1 < polygon.size() ? i + 1 : 0] - polygon[i];
    const double length_m = along.norm();
    if (length_m == 0.0) continue;
    const Eigen::Vector2d normal = Eigen::Vector2d(along.y(), -along.x()) / length_m;
    if (normal.dot(point_m) - normal.dot(polygon[i]) > kRoundingM) return false;
  }
  return true;
}

std::vector<Eigen::Vector2d> DifferenceOf(std::span<const Eigen::Vector2d> first, std::span<const Eigen::Vector2d> second) {
  std::vector<Eigen::Vector2d> difference;
  for (const auto& pair : PairsOf(first, second)) difference.push_back(pair.Difference());
  return difference;
}

Gap GapOf(std::span<const Eigen::Vector2d> first, std::span<const Eigen::Vector2d> second) {
  const auto pairs = PairsOf(first, second);
  bool is_inside = pairs.size() > 2;
  Pair nearest = pairs.front();
  double least_m2 = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto& next = pairs[i + 1 < pairs.size() ? i + 1 : 0];
    const Eigen::Vector2d corner = pairs[i].Difference();
    const Eigen::Vector2d along = next.Difference() - corner;
    is_inside = is_inside && Cross(along, corner) <= 0.0;
    const double length_m2 = along.squaredNorm();
    const double share = length_m2 > 0.0 ? std::clamp(-corner.dot(along) / length_m2, 0.0, 1.0) : 0.0;
    const double distance_m2 = (corner + share * along).squaredNorm();
    if (distance_m2 >= least_m2) continue;
    least_m2 = distance_m2;
    nearest = pairs[i].Towards(next, share);
  }
  const double distance_m = std::sqrt(least_m2);
  if (is_inside && distance_m > kRoundingM) nearest = AtOrigin(pairs);
  return {is_inside || distance_m <= kRoundingM ? 0.0 : distance_m, nearest.from_m, nearest.to_m};
}

double AreaOf(std::span<const Eigen::Vector2d> polygon) {
  double twice_m2 = 0.0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) twice_m2 += Cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
  return 0.5 * twice_m2;
}

std::vector<Eigen::Vector2d> Intersection(std::span<const Eigen::Vector2d> first, std::span<const Eigen::Vector2d> second) {
  if (first.empty() || second.empty() || AreApart(first, second)) return {};
  std::vector<Eigen::Vector2d> polygon(first.begin(), first.end());
  std::vector<Eigen::Vector2d> scratch;
  for (const auto& side : SidesOf(second)) Clip(side, polygon, scratch);
  DropTwins(polygon);
  return polygon;
}

}  // namespace lookout::tracker
