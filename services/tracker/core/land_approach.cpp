#include "services/tracker/core/land_approach.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <utility>

#include "common/core/angles.hpp"
#include "services/tracker/core/land.hpp"
#include "services/tracker/core/outline.hpp"
#include "services/tracker/core/turning.hpp"

namespace lookout::tracker {

namespace {

constexpr std::size_t kBins = 72;
// Of a cell of land: half its side, and the error of what fell into it.
constexpr double kLandSdM = 0.5 * LandMemory::kCellM;
constexpr double kLikely = 0.5;
// A boat that holds its distance to a quay comes no nearer than that.
constexpr double kMuchNearer = 0.5;
constexpr double kLeastLimitM = 0.5;
// Land is no row of points: places so near to a place are one face with it.
constexpr double kFaceM = 1.5;
constexpr int kArcSteps = 4;

// The way of the boat, straight on after the median of its turn.
std::vector<Eigen::Vector2d> WayOf(const Moving& self, const Eigen::Vector2d& place_m, double look_ahead_s) {
  std::vector<Eigen::Vector2d> way_m{place_m};
  Moving point{{place_m}, self.velocity_mps, self.turn_rate_radps};
  double turn_s = 0.0;
  if (point.turn_rate_radps != 0.0) {
    turn_s = std::min(look_ahead_s, MedianTurnS(point.turn_rate_radps));
    for (int i = 1; i <= kArcSteps; ++i) way_m.push_back(AfterTurn(point, turn_s * i / kArcSteps).hull_m.front());
    point = AfterTurn(point, turn_s);
  }
  way_m.emplace_back(way_m.back() + (look_ahead_s - turn_s) * point.velocity_mps);
  return way_m;
}

double Distance2(const std::vector<Eigen::Vector2d>& way_m, const Eigen::Vector2d& place_m) {
  double least_m2 = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < way_m.size(); ++i) {
    const Eigen::Vector2d along = way_m[i + 1] - way_m[i];
    const Eigen::Vector2d off = place_m - way_m[i];
    const double length_m2 = along.squaredNorm();
    const double share = length_m2 > 0.0 ? std::clamp(off.dot(along) / length_m2, 0.0, 1.0) : 0.0;
    least_m2 = std::min(least_m2, (off - share * along).squaredNorm());
  }
  return least_m2;
}

// The land about a place, convex.
std::vector<Eigen::Vector2d> FaceAt(std::span<const Eigen::Vector2d> shore_m, const Eigen::Vector2d& place_m) {
  std::vector<Eigen::Vector2d> face_m;
  std::ranges::copy_if(shore_m, std::back_inserter(face_m),
                       [&place_m](const Eigen::Vector2d& other_m) { return (other_m - place_m).squaredNorm() <= kFaceM * kFaceM; });
  return Polygon(SupportOf(face_m));
}

// The sooner one of two that are likely, else the likelier one.
bool IsGraver(const ClosestApproach& one, const ClosestApproach& other) {
  if (one.probability >= kLikely && other.probability >= kLikely) {
    return std::pair(one.tcpa_s, one.distance_m) < std::pair(other.tcpa_s, other.distance_m);
  }
  return one.probability > other.probability;
}

}  // namespace

std::optional<LandApproach> ApproachToLand(const Pose& own, const Moving& self, std::span<const Eigen::Vector2d> shore_m,
                                           const EncounterParams& params, double velocity_sd_mps) {
  const Eigen::Vector2d here_m = own.position_map_m.head<2>();
  double hull_m = 0.0;
  for (const auto& corner : self.hull_m) hull_m = std::max(hull_m, (corner - here_m).norm());
  const auto way_m = WayOf(self, here_m, params.look_ahead_s);
  // Beyond it the probability is below one half, however the way errs.
  const double aside_m = hull_m + params.limit_m + velocity_sd_mps * params.look_ahead_s;
  struct NearWay {
    double least_m2 = std::numeric_limits<double>::infinity();
    Eigen::Vector2d place_m;
    double bearing_rad = 0.0;

    void Keep(double measure_m2, const Eigen::Vector2d& other_m, double other_rad) {
      if (measure_m2 < least_m2) *this = {measure_m2, other_m, other_rad};
    }
  };
  // Of each bearing the place nearest to the way, and of those on the way the nearest to the boat: behind a pier head may lie a wall.
  std::array<std::array<NearWay, 2>, kBins> candidates;
  NearWay nearest;
  const double on_way_m2 = (hull_m + params.limit_m) * (hull_m + params.limit_m);
  for (const auto& place_m : shore_m) {
    const Eigen::Vector2d off = place_m - here_m;
    nearest.Keep(off.squaredNorm(), place_m, 0.0);
    const double to_way_m2 = Distance2(way_m, place_m);
    if (to_way_m2 > aside_m * aside_m) continue;
    const double bearing_rad = WrapTo2Pi(Atan2(off.x(), off.y()) - own.heading_rad);
    auto& [to_way, on_way] = candidates.at(std::min(static_cast<std::size_t>(bearing_rad / kTwoPi * kBins), kBins - 1));
    to_way.Keep(to_way_m2, place_m, bearing_rad);
    if (to_way_m2 <= on_way_m2) on_way.Keep(off.squaredNorm(), place_m, bearing_rad);
  }
  if (!std::isfinite(nearest.least_m2)) return std::nullopt;

  RelativeCovariance covariance = RelativeCovariance::Identity() * (kLandSdM * kLandSdM);
  covariance.bottomRightCorner<2, 2>() = Eigen::Matrix2d::Identity() * (velocity_sd_mps * velocity_sd_mps);
  const double nearest_m = GapOf(self.hull_m, std::array{nearest.place_m}).distance_m;
  const EncounterParams limits{std::min(params.limit_m, std::max(kLeastLimitM, kMuchNearer * nearest_m)), params.look_ahead_s};
  std::optional<LandApproach> land;
  for (const auto& of_bearing : candidates) {
    for (const auto& candidate : of_bearing) {
      if (!std::isfinite(candidate.least_m2)) continue;
      const auto approach = ClosestApproachOf(self, {FaceAt(shore_m, candidate.place_m)}, covariance, limits);
      if (!land || IsGraver(approach, land->approach)) {
        auto places = land ? std::move(land->places) : std::vector<DangerPlace>{};
        land = LandApproach{approach, limits.limit_m, candidate.bearing_rad, std::move(places)};
      }
      if (approach.probability < kLikely) continue;
      land->places.push_back({(candidate.place_m - here_m).norm(), candidate.bearing_rad, candidate.place_m});
    }
  }
  return land;
}

}  // namespace lookout::tracker
