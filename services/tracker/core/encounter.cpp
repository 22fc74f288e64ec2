#include "services/tracker/core/encounter.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/core/angles.hpp"
#include "services/tracker/core/normal.hpp"
#include "services/tracker/core/outline.hpp"
#include "services/tracker/core/turning.hpp"

namespace lookout::tracker {

namespace {

using Corners = std::span<const Eigen::Vector2d>;

// A slower relative motion is none: within a look-ahead of 30 s it is 1.5 m.
constexpr double kHardlyMovesMps = 0.05;
// A track's velocity is 0 until it moves for sure; this is below the speed of any boat under way.
constexpr double kStandsMps = 0.2;
// Rule 13: 22.5 deg abaft the beam.
constexpr double kAbaftBeamRad = DegToRad(112.5);
constexpr double kReciprocalRad = DegToRad(22.5);
// Rule 7 a: "if there is any doubt such risk shall be deemed to exist".
constexpr double kDoubt = 0.05;

// No tracked hull is known better; and smaller deviations would need many nodes.
constexpr double kLeastSdM = 0.05;
// Beyond so many deviations the density is nothing: 6e-5 of a normal distribution.
constexpr double kReach = 4.0;

// A node between 0 and 1, and its weight.
struct Node {
  double at;
  double weight;
};
// Rules of Gauss and Legendre.
constexpr std::array<Node, 1> kOneNode{{{0.5, 1.0}}};
constexpr std::array<Node, 2> kTwoNodes{{{0.2113248654051871, 0.5}, {0.7886751345948129, 0.5}}};
constexpr std::array<Node, 3> kThreeNodes{
    {{0.1127016653792583, 0.2777777777777778}, {0.5, 0.4444444444444444}, {0.8872983346207417, 0.2777777777777778}}};
constexpr std::array<Node, 4> kFourNodes{{{0.0694318442029737, 0.1739274225687269},
                                          {0.3300094782075719, 0.3260725774312731},
                                          {0.6699905217924281, 0.3260725774312731},
                                          {0.9305681557970263, 0.1739274225687269}}};
std::span<const Node> RuleFor(double deviations) {
  if (deviations < 0.4) return kOneNode;
  if (deviations < 1.5) return kTwoNodes;
  return kThreeNodes;
}

// A straight part of the edge of the region, or the chord of an arc of it.
struct Piece {
  Eigen::Vector2d from;
  Eigen::Vector2d along;  // unit
  double length_m;
  Eigen::Vector2d normal;  // outward
  Eigen::Vector2d center;  // of the arc
  double stretch;          // arc by chord; 1 where the piece is straight
  bool is_entry;           // the relative position may enter through it
};

// The distribution of the relative position at a time, and its correlation with the relative velocity.
struct Spread {
  Eigen::Vector2d mean;
  Eigen::Matrix2d inverse;  // of its covariance
  double peak = 0.0;        // of its density
  double least_sd_m = 0.0;  // along its axes
  double greatest_sd_m = 0.0;
  Eigen::Matrix2d gain;        // velocity by position
  Eigen::Matrix2d remaining;   // covariance of the velocity where the position is known
  Eigen::Matrix2d covariance;  // of the position
};

// v^T m v of a symmetrical matrix.
double Quadratic(const Eigen::Matrix2d& m, const Eigen::Vector2d& v) {
  return m(0, 0) * v.x() * v.x() + 2.0 * m(0, 1) * v.x() * v.y() + m(1, 1) * v.y() * v.y();
}

double GreatestEigenvalue(const Eigen::Matrix2d& m) {
  return 0.5 * (m(0, 0) + m(1, 1)) + Hypot(0.5 * (m(0, 0) - m(1, 1)), 0.5 * (m(0, 1) + m(1, 0)));
}

// Distance from a polygon; negative inside.
double SignedDistance(Corners polygon, const Eigen::Vector2d& point) {
  double least_m2 = std::numeric_limits<double>::infinity();
  bool is_inside = polygon.size() > 2;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d edge = polygon[i + 1 < polygon.size() ? i + 1 : 0] - polygon[i];
    const Eigen::Vector2d offset = point - polygon[i];
    const double length_m2 = edge.squaredNorm();
    const double share = length_m2 > 0.0 ? std::clamp(offset.dot(edge) / length_m2, 0.0, 1.0) : 0.0;
    least_m2 = std::min(least_m2, (offset - share * edge).squaredNorm());
    is_inside = is_inside && Cross(edge, offset) >= 0.0;
  }
  return (is_inside ? -1.0 : 1.0) * std::sqrt(least_m2);
}

// Least distance of a polygon from the way of a point that begins at the origin, and when it is reached first.
struct Approach {
  double distance_m = std::numeric_limits<double>::infinity();
  double time_s = 0.0;

  void Keep(double other_m, double other_s) {
    constexpr double kRoundingM = 1e-9;
    if (other_m > distance_m + kRoundingM || (other_m > distance_m - kRoundingM && other_s >= time_s)) return;
    distance_m = other_m;
    time_s = other_s;
  }
};

// Precondition: the velocity is not 0, and the origin is outside.
Approach ApproachOf(Corners polygon, const Eigen::Vector2d& velocity_mps, double distance_now_m) {
  Approach approach{distance_now_m, 0.0};
  const double speed2 = velocity_mps.squaredNorm();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const double time_s = polygon[i].dot(velocity_mps) / speed2;
    if (time_s > 0.0) approach.Keep((polygon[i] - time_s * velocity_mps).norm(), time_s);
    const Eigen::Vector2d edge = polygon[i + 1 < polygon.size() ? i + 1 : 0] - polygon[i];
    const double sine = Cross(velocity_mps, edge);
    if (sine == 0.0) continue;
    const double share = Cross(polygon[i], velocity_mps) / sine;
    const double crossing_s = Cross(polygon[i], edge) / sine;
    if (share >= 0.0 && share <= 1.0 && crossing_s > 0.0) approach.Keep(0.0, crossing_s);
  }
  return approach;
}

// The region of relative positions that are too near: a polygon and all places within the limit of it. The relative position enters and leaves it.
class Passage {
 public:
  Passage(Corners difference, const Eigen::Vector2d& velocity_mps, const RelativeCovariance& covariance, const EncounterParams& params)
      : difference_(difference),
        velocity_mps_(velocity_mps),
        position_(covariance.topLeftCorner<2, 2>()),
        cross_(covariance.topRightCorner<2, 2>()),
        velocity_(covariance.bottomRightCorner<2, 2>()),
        limit_m_(params.limit_m),
        look_ahead_s_(params.look_ahead_s) {}

  // @param cpa_m  without errors, at any later time
  double Probability(double cpa_m) {
    // Along each direction the variance is a convex parabola in time: nowhere is it greater than at both ends.
    const double greatest_sd_m = std::max(At(0.0).greatest_sd_m, At(look_ahead_s_).greatest_sd_m);
    if (cpa_m - limit_m_ > kReach * greatest_sd_m) return 0.0;
    const double speed_mps = velocity_mps_.norm();
    const double speed_sd_mps = std::sqrt(std::max(0.0, GreatestEigenvalue(velocity_)));
    const Spread start = At(0.0);
    const double now_m = DistanceTo(start.mean);
    if (now_m < -(kReach + 0.5) * start.greatest_sd_m) return 1.0;
    double probability = 0.0;
    if (now_m < kReach * start.greatest_sd_m) {
      MakePieces(start.least_sd_m);
      probability = InsideAt(start, now_m < 0.0);
    }
    double time_s = 0.0;
    while (time_s < look_ahead_s_ && probability < kCertain) {
      const Spread here = At(time_s);
      const double clear_m = std::fabs(DistanceTo(here.mean)) - kReach * here.greatest_sd_m;
      const double rest_s = look_ahead_s_ - time_s;
      const double rate_ps = std::sqrt(Quadratic(here.inverse, velocity_mps_)) + std::sqrt(here.inverse.cwiseProduct(velocity_).sum());
      const double panel_s = std::min(rest_s, std::max(kPanel / rate_ps, look_ahead_s_ / kMostPanels));  // rest_s where nothing moves
      const double skip_s = clear_m / (speed_mps + kReach * speed_sd_mps);
      if (skip_s > panel_s) {
        time_s += skip_s;
        continue;
      }
      if (pieces_.empty()) MakePieces(start.least_sd_m);
      for (const auto& [node, weight] : kFourNodes) probability += panel_s * weight * EntriesAt(At(time_s + panel_s * node));
      time_s += panel_s;
    }
    return std::clamp(probability, 0.0, 1.0);
  }

 private:
  static constexpr double kCertain = 0.9995;
  static constexpr double kMostPanels = 2000.0;  // bounds the cost of absurd speeds
  static constexpr double kPanel = 3.0;          // deviations that pass in one panel of time, of four nodes
  static constexpr double kSpacing = 2.5;        // deviations along the edge for which three nodes do

  Spread At(double time_s) const {
    Spread at;
    at.mean = time_s * velocity_mps_;
    at.covariance = position_ + time_s * (cross_ + cross_.transpose()) + time_s * time_s * velocity_;
    double greatest_m2 = GreatestEigenvalue(at.covariance);
    const double lacking_m2 = std::max(0.0, kLeastSdM * kLeastSdM - (at.covariance.trace() - greatest_m2));
    at.covariance.diagonal().array() += lacking_m2;
    greatest_m2 += lacking_m2;
    at.greatest_sd_m = std::sqrt(greatest_m2);
    at.least_sd_m = std::sqrt(std::max(at.covariance.trace() - greatest_m2, kLeastSdM * kLeastSdM));
    const double determinant = at.greatest_sd_m * at.greatest_sd_m * at.least_sd_m * at.least_sd_m;
    at.inverse << at.covariance(1, 1), -at.covariance(0, 1), -at.covariance(1, 0), at.covariance(0, 0);
    at.inverse /= determinant;
    at.peak = 1.0 / (kTwoPi * at.greatest_sd_m * at.least_sd_m);
    const Eigen::Matrix2d both = cross_ + time_s * velocity_;
    at.gain = both.transpose() * at.inverse;
    at.remaining = velocity_ - at.gain * both;
    return at;
  }

  double DistanceTo(const Eigen::Vector2d& point) const { return SignedDistance(difference_, point) - limit_m_; }

  void AddPiece(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Eigen::Vector2d& normal, const Eigen::Vector2d& center,
                double stretch) {
    const Eigen::Vector2d along = to - from;
    const double length_m = along.norm();
    if (length_m == 0.0) return;
    const double outward_mps = normal.dot(velocity_mps_);
    const double sd_mps = std::sqrt(std::max(0.0, Quadratic(velocity_, normal)));
    // The normals of an arc differ from that of its chord.
    const double turned_mps = stretch > 1.0 ? 0.5 * kGreatestArcRad * (velocity_mps_.norm() + kReach * sd_mps) : 0.0;
    pieces_.push_back({from, along / length_m, length_m, normal, center, stretch, outward_mps <= kReach * sd_mps + turned_mps});
  }

  // The arc about a corner, from one normal over an angle.
  void AddArc(const Eigen::Vector2d& center, Eigen::Vector2d normal, double angle_rad, double greatest_rad) {
    const double num = std::ceil(angle_rad / greatest_rad);
    if (!(num > 0.0) || limit_m_ <= 0.0) return;
    const auto [sine, cosine] = SinCosOf(angle_rad / num);
    const auto [half_sine, half_cosine] = SinCosOf(0.5 * angle_rad / num);
    for (int i = 0; i < static_cast<int>(num); ++i) {
      const Eigen::Vector2d next(cosine * normal.x() - sine * normal.y(), sine * normal.x() + cosine * normal.y());
      const Eigen::Vector2d middle(half_cosine * normal.x() - half_sine * normal.y(), half_sine * normal.x() + half_cosine * normal.y());
      AddPiece(center + limit_m_ * normal, center + limit_m_ * next, middle, center, 0.5 * angle_rad / num / half_sine);
      normal = next;
    }
  }

  void MakePieces(double sd_m) {
    // The chord is no farther than a third of a deviation from its arc.
    const double arc_rad = limit_m_ > 0.0 ? std::min(kGreatestArcRad, std::sqrt(8.0 * 0.3 * sd_m / limit_m_)) : kGreatestArcRad;
    std::vector<Eigen::Vector2d> corners;
    for (const auto& corner : difference_) {
      if (corners.empty() || (corner - corners.back()).squaredNorm() > 1e-12) corners.push_back(corner);
    }
    while (corners.size() > 1 && (corners.front() - corners.back()).squaredNorm() <= 1e-12) corners.pop_back();
    if (corners.size() == 1) {
      AddArc(corners[0], Eigen::Vector2d::UnitX(), kTwoPi, arc_rad);
      return;
    }
    const auto normal_from = [&corners](std::size_t i) -> Eigen::Vector2d {
      const Eigen::Vector2d edge = corners[(i + 1) % corners.size()] - corners[i];
      return Eigen::Vector2d(edge.y(), -edge.x()).normalized();
    };
    Eigen::Vector2d before = normal_from(corners.size() - 1);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Eigen::Vector2d normal = normal_from(i);
      AddArc(corners[i], before, std::fabs(Atan2(Cross(before, normal), before.dot(normal))), arc_rad);
      AddPiece(corners[i] + limit_m_ * normal, corners[(i + 1) % corners.size()] + limit_m_ * normal, normal, Eigen::Vector2d::Zero(), 1.0);
      before = normal;
    }
  }

  // Sums flow(offset from the mean, Mahalanobis distance squared, outward normal) over the edge, as far as `reach` deviations from the mean.
  // Midpoints of equal steps: of smooth functions that fade at both ends their error falls faster than any power of the step.
  template <typename Flow>
  double SumOverEdge(const Spread& at, double reach, bool entries_only, const Flow& flow) const {
    double sum = 0.0;
    const auto& inverse = at.inverse;
    const double farthest_from_mean_m = reach * at.greatest_sd_m;
    for (const auto& piece : pieces_) {
      if (entries_only && !piece.is_entry) continue;
      const Eigen::Vector2d offset = piece.from - at.mean;
      const double farthest_m = farthest_from_mean_m + piece.length_m;
      if (offset.squaredNorm() > farthest_m * farthest_m) continue;
      const Eigen::Vector2d scaled = inverse.col(0) * piece.along.x() + inverse.col(1) * piece.along.y();
      const double per_m2 = piece.along.dot(scaled);
      const double nearest_m = -offset.dot(scaled) / per_m2;
      const double free = reach * reach - (Quadratic(inverse, offset) - nearest_m * nearest_m * per_m2);
      if (free <= 0.0) continue;
      const double per_m = std::sqrt(per_m2);
      const double half_m = std::sqrt(free) / per_m;
      const double begin_m = std::max(0.0, nearest_m - half_m);
      const double end_m = std::min(piece.length_m, nearest_m + half_m);
      if (begin_m >= end_m) continue;
      const double width = (end_m - begin_m) * per_m;
      const auto rule = RuleFor(width);
      const int num = static_cast<int>(std::ceil(width / kSpacing));
      const double step_m = (end_m - begin_m) / num;
      double of_piece = 0.0;
      for (int i = 0; i < num; ++i) {
        for (const auto& [node, weight] : rule) {
          const Eigen::Vector2d point = piece.from + (begin_m + (i + node) * step_m) * piece.along;
          if (piece.stretch > 1.0) {
            const Eigen::Vector2d normal = (point - piece.center).normalized();
            of_piece += weight * flow(Eigen::Vector2d(piece.center + limit_m_ * normal - at.mean), normal);
          } else {
            of_piece += weight * flow(Eigen::Vector2d(point - at.mean), piece.normal);
          }
        }
      }
      sum += step_m * piece.stretch * of_piece;
    }
    return sum;
  }

  // Entries a second.
  double EntriesAt(const Spread& at) const {
    return SumOverEdge(at, kReach, true, [&](const Eigen::Vector2d& offset, const Eigen::Vector2d& normal) {
      const double density = at.peak * Exp(-0.5 * Quadratic(at.inverse, offset));
      const double inward_mps = -normal.dot(velocity_mps_ + at.gain.col(0) * offset.x() + at.gain.col(1) * offset.y());
      const double variance = Quadratic(at.remaining, normal);
      if (variance < 1e-12) return density * std::max(0.0, inward_mps);
      const double sd_mps = std::sqrt(variance);
      const NormalAt normal_at(inward_mps / sd_mps);
      return density * (sd_mps * normal_at.density + inward_mps * normal_at.below);
    });
  }

  // Probability that it is inside: by the theorem of Gauss the flow through the edge of a field whose divergence is the density. The field points out
  // to where the edge is nearest, measured in deviations, and fades away from there.
  double InsideAt(const Spread& at, bool is_inside) const {
    double least = std::numeric_limits<double>::infinity();
    Eigen::Vector2d normal = Eigen::Vector2d::UnitX();
    for (const auto& piece : pieces_) {
      const Eigen::Vector2d offset = piece.from - at.mean;
      const Eigen::Vector2d scaled = at.inverse * piece.along;
      const double nearest_m = std::clamp(-offset.dot(scaled) / piece.along.dot(scaled), 0.0, piece.length_m);
      const Eigen::Vector2d nearest = offset + nearest_m * piece.along;
      const double deviations2 = Quadratic(at.inverse, nearest);
      if (deviations2 >= least) continue;
      least = deviations2;
      normal = piece.normal;
    }
    if (least > kReach * kReach) return is_inside ? 1.0 : 0.0;
    const Eigen::Vector2d outward = at.covariance * normal / std::sqrt(Quadratic(at.covariance, normal));
    const Eigen::Vector2d along = at.inverse * outward;
    const Eigen::Vector2d across = Eigen::Vector2d(-outward.y(), outward.x()) * kTwoPi * at.peak;
    return SumOverEdge(at, 1.5 * kReach, false, [&](const Eigen::Vector2d& offset, const Eigen::Vector2d& normal_there) {
      const double aside = across.dot(offset);
      return normal_there.dot(outward) * at.peak * std::sqrt(kTwoPi) * Exp(-0.5 * aside * aside) * NormalAt(along.dot(offset)).below;
    });
  }

  static constexpr double kGreatestArcRad = 0.5;

  Corners difference_;
  Eigen::Vector2d velocity_mps_;
  Eigen::Matrix2d position_;
  Eigen::Matrix2d cross_;
  Eigen::Matrix2d velocity_;
  double limit_m_;
  double look_ahead_s_;
  std::vector<Piece> pieces_;
};

Eigen::Vector2d MiddleOf(Corners corners) {
  Eigen::Vector2d from = corners.front();
  Eigen::Vector2d to = corners.front();
  for (const auto& corner : corners) {
    from = from.cwiseMin(corner);
    to = to.cwiseMax(corner);
  }
  return 0.5 * (from + to);
}

// From north, clockwise, of a direction in east and north.
double CourseOf(const Eigen::Vector2d& direction) { return Atan2(direction.x(), direction.y()); }

}  // namespace

ClosestApproach ClosestApproachOf(const Moving& own, const Moving& other, const RelativeCovariance& covariance, const EncounterParams& params) {
  if (own.turn_rate_radps != 0.0 || other.turn_rate_radps != 0.0) return ApproachInTurns(own, other, covariance, params);
  const auto difference = DifferenceOf(own.hull_m, other.hull_m);  // displacements of the other hull for both to touch
  const Eigen::Vector2d velocity_mps = other.velocity_mps - own.velocity_mps;
  const double distance_m = SignedDistance(difference, Eigen::Vector2d::Zero());
  ClosestApproach approach;
  approach.distance_m = std::max(0.0, distance_m);
  Approach nearest{approach.distance_m, 0.0};
  if (distance_m > 0.0 && velocity_mps.norm() > 0.0) nearest = ApproachOf(difference, velocity_mps, distance_m);
  const bool is_moving = velocity_mps.norm() >= kHardlyMovesMps;
  approach.cpa_m = is_moving ? nearest.distance_m : approach.distance_m;
  approach.tcpa_s = is_moving ? nearest.time_s : 0.0;
  approach.probability = Passage(difference, velocity_mps, covariance, params).Probability(nearest.distance_m);
  const Eigen::Vector2d between_m = MiddleOf(other.hull_m) - MiddleOf(own.hull_m);
  if (distance_m > 0.0 && between_m.squaredNorm() > 0.0) approach.bearing_drift_radps = -Cross(between_m, velocity_mps) / between_m.squaredNorm();
  return approach;
}

Encounter EncounterOf(const Moving& own, double own_heading_rad, const Moving& other, const ClosestApproach& approach,
                      const EncounterParams& params) {
  if (other.velocity_mps.norm() < kStandsMps || approach.tcpa_s <= 0.0 || approach.tcpa_s > params.look_ahead_s) return Encounter::kNone;
  if (approach.probability < kDoubt) return Encounter::kNone;
  const Eigen::Vector2d between_m = MiddleOf(other.hull_m) - MiddleOf(own.hull_m);
  const double other_course_rad = CourseOf(other.velocity_mps);
  const double of_other_rad = WrapToPi(CourseOf(between_m) - own_heading_rad);  // where it is seen from the own boat
  const double of_own_rad = WrapToPi(CourseOf(-between_m) - other_course_rad);  // where it sees the own boat
  if (std::fabs(of_own_rad) > kAbaftBeamRad) return Encounter::kOvertaking;
  if (std::fabs(of_other_rad) > kAbaftBeamRad) return Encounter::kOvertaken;
  if (std::fabs(WrapToPi(other_course_rad - own_heading_rad - kPi)) <= kReciprocalRad) return Encounter::kHeadOn;
  return of_other_rad >= 0.0 ? Encounter::kCrossingGiveWay : Encounter::kCrossingStandOn;
}

}  // namespace lookout::tracker
