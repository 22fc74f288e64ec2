#include "lab/eval/tracks/alert_geometry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "common/core/angles.hpp"
#include "common/core/outlines.hpp"

namespace lookout::eval {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kEdgesOfBlock = 8;
// Slower turns are straight: in half a minute they are a few degrees.
constexpr double kTurnsFromRadps = DegToRad(1.5);
constexpr double kEndOfTurnRad = DegToRad(60.0);
constexpr double kStepS = 0.1;

Vector2d NearestOnEdge(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const Vector2d edge = b - a;
  const double length2 = edge.squaredNorm();
  const double share = length2 > 0.0 ? std::clamp((p - a).dot(edge) / length2, 0.0, 1.0) : 0.0;
  return a + share * edge;
}

// Squared; 0 where they cross.
double EdgeGap2(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  const double side_c = Cross(b - a, c - a);
  const double side_d = Cross(b - a, d - a);
  const double side_a = Cross(d - c, a - c);
  const double side_b = Cross(d - c, b - c);
  if (side_c * side_d < 0.0 && side_a * side_b < 0.0) return 0.0;
  return std::min({(NearestOnEdge(a, c, d) - a).squaredNorm(), (NearestOnEdge(b, c, d) - b).squaredNorm(), (NearestOnEdge(c, a, b) - c).squaredNorm(),
                   (NearestOnEdge(d, a, b) - d).squaredNorm()});
}

Eigen::AlignedBox2d BoxAround(const Polygon& corners_m) {
  Eigen::AlignedBox2d box_m;
  for (const auto& corner_m : corners_m) box_m.extend(corner_m);
  return box_m;
}

bool IsInside(const Vector2d& p_m, const Polygon& corners_m) { return corners_m.size() > 2 && Contains(corners_m, p_m); }

// Where a hull is after some time, against where it is now.
struct Shift {
  Vector2d by_m;
  double turned_rad = 0.0;
};

// The turn is kept for turning_s, and the way behind it is straight.
Shift ShiftOf(const MovingHull& hull, double turning_s, double time_s) {
  const double rate = hull.turn_radps;
  const double in_turn_s = std::min(turning_s, time_s);
  if (rate == 0.0 || in_turn_s <= 0.0) return {hull.velocity_mps * time_s, 0.0};
  const double turned_rad = rate * in_turn_s;
  const double sine = std::sin(turned_rad);
  const double cosine = std::cos(turned_rad);
  const auto& v = hull.velocity_mps;
  const Vector2d arc_m(((sine * v.x()) - ((1.0 - cosine) * v.y())) / rate, (((1.0 - cosine) * v.x()) + (sine * v.y())) / rate);
  const Vector2d after_mps(cosine * v.x() - sine * v.y(), sine * v.x() + cosine * v.y());
  return {arc_m + after_mps * (time_s - in_turn_s), turned_rad};
}

// How long the turn is kept: for each of its ends.
std::vector<double> EndsOf(const MovingHull& hull, double ahead_s) {
  const double rate = std::abs(hull.turn_radps);
  if (rate < kTurnsFromRadps) return {0.0};
  if (kEndOfTurnRad / rate >= ahead_s) return {0.0, ahead_s};
  return {0.0, kEndOfTurnRad / rate, ahead_s};
}

double RadiusOf(const Polygon& corners_m, const Vector2d& center_m) {
  double radius2_m2 = 0.0;
  for (const auto& corner_m : corners_m) radius2_m2 = std::max(radius2_m2, (corner_m - center_m).squaredNorm());
  return std::sqrt(radius2_m2);
}

struct TwoHulls {
  const Polygon& own_m;
  const MovingHull& own;
  const HullOutline& thing_m;
  const MovingHull& thing;
  Vector2d own_center_m;
  Vector2d thing_center_m;

  // The own hull moves; the other one is at rest, turns included.
  Polygon OwnAsSeenByThing(double own_turning_s, double thing_turning_s, double time_s) const {
    const auto own_shift = ShiftOf(own, own_turning_s, time_s);
    const auto thing_shift = ShiftOf(thing, thing_turning_s, time_s);
    const Eigen::Rotation2Dd own_turned(own_shift.turned_rad);
    const Eigen::Rotation2Dd turned_back(-thing_shift.turned_rad);
    Polygon hull_m;
    hull_m.reserve(own_m.size());
    for (const auto& corner_m : own_m) {
      const Vector2d moved_m = own_center_m + own_shift.by_m + own_turned * (corner_m - own_center_m);
      hull_m.emplace_back(thing_center_m + turned_back * (moved_m - thing_center_m - thing_shift.by_m));
    }
    return hull_m;
  }
};

struct OneApproach {
  double within_ahead_m = std::numeric_limits<double>::infinity();
  double within_lenient_m = std::numeric_limits<double>::infinity();
  double until_limit_s = std::numeric_limits<double>::infinity();
};

// Steps over the time in which the gap cannot become less than what counts.
OneApproach SweepOf(const ApproachQuestion& question, const TwoHulls& pair, double own_turning_s, double thing_turning_s, double greatest_mps) {
  const double cap_m = question.limit_m + kApproachCapM;
  OneApproach found;
  double time_s = 0.0;
  while (true) {
    const double gap_m = pair.thing_m.Gap(pair.OwnAsSeenByThing(own_turning_s, thing_turning_s, time_s));
    found.within_lenient_m = std::min(found.within_lenient_m, gap_m);
    if (time_s <= question.ahead_s) found.within_ahead_m = found.within_lenient_m;
    if (gap_m < question.limit_m) found.until_limit_s = std::min(found.until_limit_s, time_s);
    if (gap_m == 0.0 || time_s >= question.lenient_s || greatest_mps == 0.0) break;
    const double free_s = (gap_m - std::min(found.within_lenient_m, cap_m)) / greatest_mps;
    const double next_s = time_s + std::max(kStepS, free_s);
    // The ends of both times are looked at themselves.
    const double end_s = time_s < question.ahead_s ? question.ahead_s : question.lenient_s;
    time_s = std::min(next_s, end_s);
  }
  return found;
}

}  // namespace

HullOutline::HullOutline(Polygon corners_m) : corners_m_(std::move(corners_m)), box_m_(BoxAround(corners_m_)) {
  const std::size_t num_edges = corners_m_.size();
  block_box_m_.resize((num_edges + kEdgesOfBlock - 1) / kEdgesOfBlock);
  for (std::size_t i = 0; i < num_edges; ++i) {
    block_box_m_[i / kEdgesOfBlock].extend(corners_m_[i]);
    block_box_m_[i / kEdgesOfBlock].extend(corners_m_[(i + 1) % num_edges]);
  }
}

double HullOutline::Gap(const Polygon& hull_m, double enough_m) const {
  const auto box_m = BoxAround(hull_m);
  const double box_gap_m = std::sqrt(box_m_.squaredExteriorDistance(box_m));
  if (box_gap_m > enough_m) return box_gap_m;
  const std::size_t num_edges = corners_m_.size();
  double least_m2 = std::numeric_limits<double>::infinity();
  double least_block_m2 = std::numeric_limits<double>::infinity();
  const double enough_m2 = enough_m * enough_m;
  for (std::size_t block = 0; block < block_box_m_.size(); ++block) {
    const double block_m2 = block_box_m_[block].squaredExteriorDistance(box_m);
    least_block_m2 = std::min(least_block_m2, block_m2);
    if (block_m2 >= least_m2 || block_m2 > enough_m2) continue;
    const std::size_t end = std::min(num_edges, (block + 1) * kEdgesOfBlock);
    for (std::size_t i = block * kEdgesOfBlock; i < end; ++i) {
      const auto& a_m = corners_m_[i];
      const auto& b_m = corners_m_[i + 1 == num_edges ? 0 : i + 1];
      for (std::size_t k = 0, before = hull_m.size() - 1; k < hull_m.size(); before = k++) {
        least_m2 = std::min(least_m2, EdgeGap2(a_m, b_m, hull_m[before], hull_m[k]));
      }
    }
    if (least_m2 == 0.0) return 0.0;
  }
  // One shape may lie wholly within the other.
  if (box_gap_m == 0.0 && (IsInside(hull_m.front(), corners_m_) || IsInside(corners_m_.front(), hull_m))) return 0.0;
  if (least_m2 <= enough_m2) return std::sqrt(least_m2);
  // Blocks that were left out may be nearer than the edges that were looked at, and both are more than enough.
  return std::max(std::nextafter(enough_m, std::numeric_limits<double>::infinity()), std::sqrt(least_block_m2));
}

Vector2d HullOutline::NearestPoint(const Vector2d& p_m) const {
  Vector2d nearest_m = corners_m_.front();
  for (std::size_t i = 0, before = corners_m_.size() - 1; i < corners_m_.size(); before = i++) {
    const Vector2d on_edge_m = NearestOnEdge(p_m, corners_m_[before], corners_m_[i]);
    if ((on_edge_m - p_m).squaredNorm() < (nearest_m - p_m).squaredNorm()) nearest_m = on_edge_m;
  }
  return nearest_m;
}

TrueApproach ApproachWithin(const ApproachQuestion& question, const Polygon& own_m, const MovingHull& own, const HullOutline& thing_m,
                            const MovingHull& thing) {
  const double own_mps = own.velocity_mps.norm();
  const double thing_mps = thing.velocity_mps.norm();
  if (own_mps < kStandsBelowMps && thing_mps < kStandsBelowMps) return {};
  const TwoHulls pair{own_m, own, thing_m, thing, BoxAround(own_m).center(), thing_m.box_m().center()};
  const double greatest_mps = own_mps + thing_mps;
  TrueApproach result;
  // All that can happen is farther than what counts.
  const double now_m = thing_m.Gap(own_m, question.limit_m + kApproachCapM + greatest_mps * question.lenient_s);
  const double bound_m = now_m - greatest_mps * question.lenient_s;
  if (bound_m > question.limit_m + kApproachCapM) {
    result.least_m = result.greatest_m = result.straight_m = bound_m;
    return result;
  }
  const auto own_ends_s = EndsOf(own, question.lenient_s);
  const auto thing_ends_s = EndsOf(thing, question.lenient_s);
  double greatest_m = 0.0;
  for (const double own_turning_s : own_ends_s) {
    for (const double thing_turning_s : thing_ends_s) {
      double fastest_mps = greatest_mps;
      if (own_turning_s > 0.0) fastest_mps += std::abs(own.turn_radps) * RadiusOf(own_m, pair.own_center_m);
      if (thing_turning_s > 0.0) fastest_mps += std::abs(thing.turn_radps) * RadiusOf(thing_m.corners_m(), pair.thing_center_m);
      const auto one = SweepOf(question, pair, own_turning_s, thing_turning_s, fastest_mps);
      result.least_m = std::min(result.least_m, one.within_lenient_m);
      result.until_limit_s = std::min(result.until_limit_s, one.until_limit_s);
      greatest_m = std::max(greatest_m, one.within_ahead_m);
      if (own_turning_s == 0.0 && thing_turning_s == 0.0) result.straight_m = one.within_ahead_m;
    }
  }
  result.greatest_m = greatest_m;
  return result;
}

}  // namespace lookout::eval
