// Runs that are easy to write down: squares of 2 m that stand or go straight.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "lab/eval/tracks/track_geometry.hpp"
#include "lab/eval/tracks/track_metrics.hpp"

namespace lookout::eval {

inline constexpr std::int64_t kScanUs = 100'000;

inline Polygon SquareAt(const Eigen::Vector2d& center_m, double side_m = 2.0) {
  const double half_m = side_m / 2.0;
  return {center_m + Eigen::Vector2d(-half_m, -half_m), center_m + Eigen::Vector2d(half_m, -half_m), center_m + Eigen::Vector2d(half_m, half_m),
          center_m + Eigen::Vector2d(-half_m, half_m)};
}

inline TrueThing ThingAt(int id, const Eigen::Vector2d& center_m, int num_returns = 20, const Eigen::Vector2d& velocity_mps = {0.0, 0.0}) {
  TrueThing thing;
  thing.id = id;
  thing.outline_m = SquareAt(center_m);
  thing.position_m = center_m;
  thing.velocity_mps = velocity_mps;
  thing.num_returns = num_returns;
  thing.is_in_water = true;
  return thing;
}

inline TrackState TrackAt(std::int64_t id, const Eigen::Vector2d& center_m, const Eigen::Vector2d& velocity_mps = {0.0, 0.0}) {
  TrackState track;
  track.id = id;
  track.status = TrackStatus::kConfirmed;
  track.position_m = center_m;
  track.velocity_mps = velocity_mps;
  track.is_moving = velocity_mps.norm() > 0.0;
  track.covariance = Eigen::Matrix4d::Identity();
  track.outline_m = SquareAt(center_m);
  return track;
}

/// A run that is written scan by scan.
struct Case {
  std::vector<TrueScan> truth;
  std::vector<std::vector<TrackState>> tracks;

  void Add(std::vector<TrueThing> things, std::vector<TrackState> states) {
    truth.push_back({static_cast<std::int64_t>(truth.size()) * kScanUs, std::move(things), {}});
    tracks.push_back(std::move(states));
  }
  TrackScores Score() const { return ScoreTracks(truth, tracks); }
};

}  // namespace lookout::eval
