#include "lab/eval/baselines/nearest_neighbour.hpp"

#include <algorithm>
#include <cstddef>
#include <tuple>

namespace lookout::eval {
namespace {

double Seconds(std::int64_t duration_us) { return static_cast<double>(duration_us) * 1e-6; }

Eigen::Vector2d PositionOf(const obstacle_t& obstacle) { return {obstacle.position_map_m[0], obstacle.position_map_m[1]}; }

std::vector<const obstacle_t*> UsableOf(const messages::ScanMessages& scan) {
  std::vector<const obstacle_t*> obstacles;
  for (const auto& [part_index, message] : scan.obstacles) {
    for (const auto& obstacle : message.obstacles) {
      const bool is_usable = obstacle.status == obstacle_t::STATUS_OK && obstacle.confidence == obstacle_t::CONFIDENCE_SURE &&
                             obstacle.kind != obstacle_t::KIND_LAND && PositionOf(obstacle).allFinite();
      if (is_usable) obstacles.push_back(&obstacle);
    }
  }
  return obstacles;
}

Polygon OutlineOf(const obstacle_t& obstacle) {
  Polygon outline_m;
  for (std::size_t i = 0; i < static_cast<std::size_t>(obstacle.num_map); ++i) {
    outline_m.emplace_back(static_cast<double>(obstacle.footprint_east_m[i]), static_cast<double>(obstacle.footprint_north_m[i]));
  }
  return outline_m;
}

}  // namespace

void NearestNeighbour::Predict(std::int64_t time_us) {
  for (auto& track : tracks_) {
    const Eigen::Vector2d moved_m = track.state.velocity_mps * Seconds(time_us - track.time_us);
    track.state.position_m += moved_m;
    for (auto& corner_m : track.state.outline_m) corner_m += moved_m;
    track.state.segment_ids.clear();
    track.time_us = time_us;
  }
}

// The obstacle's mean time is half a scan before its end; that difference is left out, as a plain tracker would.
void NearestNeighbour::Correct(Followed& track, const obstacle_t& obstacle, std::int64_t time_us) const {
  const double step_s = Seconds(time_us - track.hit_us);
  const Eigen::Vector2d error_m = PositionOf(obstacle) - track.state.position_m;
  track.state.position_m += params_.alpha * error_m;
  if (step_s > 0.0) track.state.velocity_mps += params_.beta / step_s * error_m;
  track.state.is_moving = track.state.velocity_mps.norm() > params_.moving_mps;
  track.state.outline_m = OutlineOf(obstacle);
  for (auto& corner_m : track.state.outline_m) corner_m += track.state.position_m - PositionOf(obstacle);
  track.state.segment_ids = {obstacle.id};
  track.hit_us = time_us;
}

std::vector<TrackState> NearestNeighbour::Update(const messages::ScanMessages& scan) {
  const std::int64_t time_us = scan.obstacles.begin()->second.end_utime_us;
  const auto obstacles = UsableOf(scan);
  Predict(time_us);

  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;  // distance, track, obstacle
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const double gate_m = params_.gate_m + params_.gate_growth_mps * Seconds(time_us - tracks_[i].hit_us);
    for (std::size_t k = 0; k < obstacles.size(); ++k) {
      const double distance_m = (PositionOf(*obstacles[k]) - tracks_[i].state.position_m).norm();
      if (distance_m <= gate_m) pairs.emplace_back(distance_m, i, k);
    }
  }
  std::ranges::sort(pairs);
  std::vector<bool> is_hit(tracks_.size());
  std::vector<bool> is_taken(obstacles.size());
  for (const auto& [distance_m, i, k] : pairs) {
    if (is_hit[i] || is_taken[k]) continue;
    is_hit[i] = true;
    is_taken[k] = true;
    Correct(tracks_[i], *obstacles[k], time_us);
  }
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    auto& looks = tracks_[i].looks;
    looks.push_back(is_hit[i]);
    if (looks.size() > static_cast<std::size_t>(params_.num_looks)) looks.erase(looks.begin());
  }
  std::erase_if(tracks_, [&](const Followed& track) {
    return track.looks.size() == static_cast<std::size_t>(params_.num_looks) && std::ranges::count(track.looks, true) == 0;
  });
  for (std::size_t k = 0; k < obstacles.size(); ++k) {
    if (is_taken[k]) continue;
    Followed track;
    track.state.id = ++last_id_;
    track.state.covariance.setConstant(std::numeric_limits<double>::quiet_NaN());  // the filter has none
    track.state.position_m = PositionOf(*obstacles[k]);
    track.state.outline_m = OutlineOf(*obstacles[k]);
    track.state.segment_ids = {obstacles[k]->id};
    track.time_us = time_us;
    track.hit_us = time_us;
    track.looks = {true};
    tracks_.push_back(std::move(track));
  }
  std::vector<TrackState> states;
  for (auto& track : tracks_) {
    const bool is_confirmed = track.state.status != TrackStatus::kTentative || std::ranges::count(track.looks, true) >= params_.num_hits;
    if (is_confirmed) track.state.status = track.hit_us == time_us ? TrackStatus::kConfirmed : TrackStatus::kCoasting;
    states.push_back(track.state);
  }
  return states;
}

}  // namespace lookout::eval
