// Scans of walls that stand in the water, hand-drawn and seen from above, for the tests of the tracker's core.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "common/core/angles.hpp"
#include "services/tracker/core/outline.hpp"
#include "services/tracker/core/tracker.hpp"
#include "tests/unit/tracker/scans.hpp"

namespace lookout::tracker::test {

inline constexpr double kLidarM = 1.5;  // over the water
inline constexpr int kRings = 16;
inline constexpr int kColumns = 900;

struct Wall {
  Eigen::Vector2d from_m;
  Eigen::Vector2d to_m;
  double top_m = 0.0;
  int thing = 0;
  double reflects = 1.0;  // this share of the beams
};
using Walls = std::vector<Wall>;

inline Walls Box(const Eigen::Vector2d& middle_m, double east_m, double north_m, double top_m, int thing, double reflects = 1.0) {
  const Eigen::Vector2d half(0.5 * east_m, 0.5 * north_m);
  const Eigen::Vector2d a = middle_m - half;
  const Eigen::Vector2d b(middle_m.x() + half.x(), middle_m.y() - half.y());
  const Eigen::Vector2d c = middle_m + half;
  const Eigen::Vector2d d(middle_m.x() - half.x(), middle_m.y() + half.y());
  return {{a, b, top_m, thing, reflects}, {b, c, top_m, thing, reflects}, {c, d, top_m, thing, reflects}, {d, a, top_m, thing, reflects}};
}

inline Walls operator+(Walls one, const Walls& other) {
  one.insert(one.end(), other.begin(), other.end());
  return one;
}

/// Distance to a wall along a unit vector; infinite where it is not met.
inline double MeetsAfter(const Wall& wall, const Eigen::Vector2d& from_m, const Eigen::Vector2d& direction) {
  const Eigen::Vector2d along = wall.to_m - wall.from_m;
  const double turn = Cross(direction, along);
  if (std::abs(turn) < 1e-12) return std::numeric_limits<double>::infinity();
  const Eigen::Vector2d off = wall.from_m - from_m;
  const double distance_m = Cross(off, along) / turn;
  const double share = Cross(off, direction) / turn;
  return distance_m > 0.0 && share >= 0.0 && share <= 1.0 ? distance_m : std::numeric_limits<double>::infinity();
}

struct Called {
  int segment_id = 0;
  bool is_land = false;
  int piece = 0;  // 0 in all of a scan: it has no pieces
  double thing_probability = 1.0;
};
using Segmenter = std::function<Called(int thing, const Eigen::Vector2d& place_m)>;

/// What a lidar on a boat that heads north sees of walls, and what the segmenter makes of it. Segments of fewer returns than 3 are no obstacles.
inline ScanInput Look(int scan, const Eigen::Vector2d& own_m, const Walls& walls, const Segmenter& segmenter, std::mt19937_64& random) {
  ScanInput input = MakeScan(scan, own_m);
  Sweep sweep;
  for (int ring = 0; ring < kRings; ++ring) {
    sweep.elevation_rad.push_back(static_cast<float>((-15.0 + 2.0 * ring) * kPi / 180.0));
    sweep.azimuth_offset_rad.push_back(0.0F);
  }
  std::uniform_real_distribution<double> noise_m(-0.03, 0.03);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  struct Segment {
    std::vector<Eigen::Vector2d> places_m;
    Called called;
    double top_m = 0.0;
  };
  std::map<int, Segment> segments;
  bool has_pieces = false;
  for (int column = 0; column < kColumns; ++column) {
    const double azimuth_rad = kTwoPi * column / kColumns;
    const Eigen::Vector2d direction(std::sin(azimuth_rad), std::cos(azimuth_rad));
    std::vector<std::pair<double, const Wall*>> met;
    for (const auto& wall : walls) {
      const double distance_m = MeetsAfter(wall, own_m, direction);
      if (distance_m < 90.0) met.emplace_back(distance_m, &wall);
    }
    std::ranges::sort(met);
    sweep.azimuth_rad.push_back(static_cast<float>(azimuth_rad));
    sweep.time.push_back(input.time);
    for (const float elevation_rad : sweep.elevation_rad) {
      float range_m = 0.0F;
      Called called;
      for (const auto& [distance_m, wall] : met) {
        const double z = kLidarM + distance_m * std::tan(elevation_rad);
        if (z < 0.0) break;  // the water does not reflect
        if (z > wall->top_m || (wall->reflects < 1.0 && share(random) >= wall->reflects)) continue;
        const double seen_m = distance_m + noise_m(random);
        const Eigen::Vector2d place_m = own_m + seen_m * direction;
        called = segmenter(wall->thing, place_m);
        range_m = static_cast<float>(seen_m / std::cos(elevation_rad));
        auto& segment = segments[called.segment_id];
        segment.places_m.push_back(place_m);
        segment.called = called;
        segment.top_m = std::max(segment.top_m, z);
        break;
      }
      sweep.range_m.push_back(range_m);
      sweep.label.push_back(static_cast<std::int16_t>(called.segment_id));
      sweep.piece.push_back(static_cast<std::int16_t>(called.piece));
      has_pieces = has_pieces || called.piece > 0;
    }
  }
  if (!has_pieces) sweep.piece.clear();
  for (const auto& [id, segment] : segments) {
    if (id <= 0 || segment.places_m.size() < 3) continue;
    Seen seen;
    seen.segment_id = id;
    seen.time = input.end_time;
    seen.is_land = segment.called.is_land;
    seen.thing_probability = segment.called.thing_probability;
    seen.num_returns = static_cast<int>(segment.places_m.size());
    seen.outline_m = Polygon(SupportOf(segment.places_m));
    for (const auto& corner : seen.outline_m) seen.position_m += corner / static_cast<double>(seen.outline_m.size());
    seen.covariance_relative_m2 = 0.0004 * Eigen::Matrix2d::Identity();
    seen.covariance_m2 = 0.01 * Eigen::Matrix2d::Identity();
    seen.top_above_water_m = segment.top_m;
    input.seen.push_back(seen);
  }
  input.sweep = std::move(sweep);
  return input;
}

/// Of a tracker for these scans.
inline TrackerParams WallParams() {
  TrackerParams params;
  params.reference_point_above_water_m = kLidarM;
  params.max_range_m = 100.0;
  return params;
}

inline bool IsReported(const Track& track) { return track.status == TrackStatus::kConfirmed || track.status == TrackStatus::kCoasting; }

}  // namespace lookout::tracker::test
