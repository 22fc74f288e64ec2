#include "services/ais/core/association.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "common/core/angles.hpp"

namespace lookout::ais {

namespace {

// Errors of AIS and of the own receiver last a minute and more: longer means tell nothing new.
constexpr double kMeanS = 60.0;
// Tracks that stand so far from the ship, in deviations and metres, are no candidates.
constexpr double kMostDeviations = 6.0;
constexpr double kMostDistanceM = 150.0;
// Tracks within so much say how densely things stand about the ship.
constexpr double kNeighbourhoodM = 30.0;
// A ship in reach of the lidar has a track of its own so often.
constexpr double kTrackedShare = 0.95;
constexpr int kNumRounds = 40;

// Evidence: log odds times seconds.
constexpr double kMostStep = 7.0;  // of log odds, in a second
constexpr double kMostStepAway = 3.0;
constexpr double kSureEvidence = 1.0;
constexpr double kFirstEvidence = 6.0;  // of a pair that has become sure
constexpr double kMostEvidence = 20.0;
// The outline and the speed of a track settle so long.
constexpr double kLeastAgeS = 3.0;
// Time between two scans counts for no more: a pause of the lidar tells nothing.
constexpr double kMostStepS = 1.0;

double LogOddsOf(double probability) {
  constexpr double kLeast = 1e-6;
  const double bounded = std::clamp(probability, kLeast, 1.0 - kLeast);
  return Log(bounded / (1.0 - bounded));
}

Background BackgroundOf(const ShipInReach& ship, std::span<const TrackedThing> tracks) {
  const auto num_near = std::ranges::count_if(
      tracks, [&ship](const auto& track) { return (track.center_map_m - ship.predicted.center_map_m).norm() < kNeighbourhoodM; });
  return {static_cast<double>(std::max<std::ptrdiff_t>(num_near, 1)) / (kPi * kNeighbourhoodM * kNeighbourhoodM)};
}

}  // namespace

Eigen::MatrixXd PairProbabilities(const Eigen::MatrixXd& weight, const Eigen::VectorXd& none_weight) {
  const auto num_ships = weight.rows();
  const auto num_tracks = weight.cols();
  Eigen::MatrixXd to_ship = Eigen::MatrixXd::Ones(num_ships, num_tracks);
  Eigen::MatrixXd to_track = Eigen::MatrixXd::Zero(num_ships, num_tracks);
  for (int round = 0; round < kNumRounds; ++round) {
    for (Eigen::Index i = 0; i < num_ships; ++i) {
      double sum = none_weight[i];
      for (Eigen::Index k = 0; k < num_tracks; ++k) sum += weight(i, k) * to_ship(i, k);
      for (Eigen::Index k = 0; k < num_tracks; ++k) {
        const double others = sum - weight(i, k) * to_ship(i, k);
        to_track(i, k) = weight(i, k) / std::max(others, none_weight[i]);
      }
    }
    for (Eigen::Index k = 0; k < num_tracks; ++k) {
      double sum = 1.0;
      for (Eigen::Index i = 0; i < num_ships; ++i) sum += to_track(i, k);
      for (Eigen::Index i = 0; i < num_ships; ++i) to_ship(i, k) = 1.0 / std::max(sum - to_track(i, k), 1.0);
    }
  }
  Eigen::MatrixXd probability(num_ships, num_tracks + 1);
  for (Eigen::Index i = 0; i < num_ships; ++i) {
    double sum = none_weight[i];
    for (Eigen::Index k = 0; k < num_tracks; ++k) sum += weight(i, k) * to_ship(i, k);
    for (Eigen::Index k = 0; k < num_tracks; ++k) probability(i, k) = weight(i, k) * to_ship(i, k) / sum;
    probability(i, num_tracks) = none_weight[i] / sum;
  }
  return probability;
}

std::vector<Identity> Association::Update(Utime time, std::span<const ShipInReach> ships, std::span<const TrackedThing> tracks) {
  const double step_s = last_time_ ? std::clamp(ToSeconds(time - *last_time_), 0.0, kMostStepS) : 0.0;
  last_time_ = time;
  for (auto& [key, pair] : pairs_) pair.is_near = false;

  const auto num_ships = static_cast<Eigen::Index>(ships.size());
  const auto num_tracks = static_cast<Eigen::Index>(tracks.size());
  Eigen::MatrixXd weight = Eigen::MatrixXd::Zero(num_ships, num_tracks);
  for (Eigen::Index i = 0; i < num_ships; ++i) {
    const auto& ship = ships[static_cast<std::size_t>(i)];
    const auto background = BackgroundOf(ship, tracks);
    for (Eigen::Index k = 0; k < num_tracks; ++k) {
      weight(i, k) = kTrackedShare * WeightOf(ship, tracks[static_cast<std::size_t>(k)], background, step_s);
    }
  }
  const auto probability = PairProbabilities(weight, Eigen::VectorXd::Constant(num_ships, 1.0 - kTrackedShare));

  std::erase_if(pairs_, [](const auto& entry) { return !entry.second.is_near && !entry.second.is_sure; });
  for (Eigen::Index i = 0; i < num_ships; ++i) {
    for (Eigen::Index k = 0; k < num_tracks; ++k) {
      AddEvidence({ships[static_cast<std::size_t>(i)].ship->mmsi, tracks[static_cast<std::size_t>(k)].id}, probability(i, k), step_s);
    }
  }
  // Pairs of a ship that is gone, or of a track that has ended, are forgotten.
  std::erase_if(pairs_, [&](const auto& entry) {
    const auto& [mmsi, track_id] = entry.first;
    const bool is_there = std::ranges::binary_search(ships, mmsi, {}, [](const auto& ship) { return ship.ship->mmsi; }) &&
                          std::ranges::binary_search(tracks, track_id, {}, &TrackedThing::id);
    if (is_there) return false;
    if (entry.second.is_sure) {
      ++counts_["pairs_ended"];
      sure_track_.erase(mmsi);
    }
    return true;
  });

  std::vector<Identity> identities;
  identities.reserve(ships.size());
  for (Eigen::Index i = 0; i < num_ships; ++i) {
    auto& identity = identities.emplace_back();
    identity.mmsi = ships[static_cast<std::size_t>(i)].ship->mmsi;
    identity.none_probability = probability(i, num_tracks);
    const auto sure = sure_track_.find(identity.mmsi);
    identity.is_sure = sure != sure_track_.end();
    for (Eigen::Index k = 0; k < num_tracks; ++k) {
      const auto id = tracks[static_cast<std::size_t>(k)].id;
      const bool is_better = identity.is_sure ? id == sure->second : probability(i, k) > identity.probability;
      if (!is_better) continue;
      identity.track_id = id;
      identity.probability = probability(i, k);
    }
  }
  return identities;
}

double Association::WeightOf(const ShipInReach& ship, const TrackedThing& track, const Background& background, double step_s) {
  const Eigen::Vector2d difference_m = track.center_map_m - ship.predicted.center_map_m;
  const Key key(ship.ship->mmsi, track.id);
  const auto found = pairs_.find(key);
  const bool is_known = found != pairs_.end();
  if (!is_known && difference_m.norm() > kMostDistanceM) return 0.0;
  const Eigen::Matrix2d covariance_m2 = ship.predicted.covariance_m2 + track.covariance_m2;
  const double deviations = std::sqrt(difference_m.dot(covariance_m2.inverse() * difference_m));
  const double most = is_known && found->second.is_sure ? 2.0 * kMostDeviations : kMostDeviations;
  if (!(deviations <= most)) return 0.0;
  auto& pair = is_known ? found->second : pairs_[key];
  if (!is_known) pair.mean_difference_m = difference_m;
  pair.is_near = true;
  pair.age_s += step_s;
  if (step_s > 0.0) pair.mean_difference_m += (difference_m - pair.mean_difference_m) * (step_s / std::min(pair.age_s + step_s, kMeanS));
  return Exp(PositionLogOdds(pair.mean_difference_m, ship.predicted, track, background) + ShapeLogOdds(ship.ship->dimensions, track) +
             HeadingLogOdds(ship.predicted, track) + VelocityLogOdds(ship.predicted, track));
}

void Association::AddEvidence(const Key& key, double probability, double step_s) {
  const auto found = pairs_.find(key);
  if (found == pairs_.end()) return;
  auto& pair = found->second;
  const double log_odds = pair.is_near ? LogOddsOf(probability) : -kMostStepAway;
  if (pair.is_sure) {
    pair.evidence = std::min(pair.evidence + std::clamp(log_odds, -kMostStepAway, kMostStepAway) * step_s, kMostEvidence);
    if (pair.evidence > 0.0) return;
    ++counts_["pairs_given_up"];
    pair.is_sure = false;
    pair.evidence = 0.0;
    sure_track_.erase(key.first);
    return;
  }
  const double step = std::clamp(log_odds, -kMostStep, kMostStep) - LogOddsOf(params_.sure_probability);
  pair.evidence = std::max(pair.evidence + step * step_s, 0.0);
  if (pair.evidence >= kSureEvidence && pair.age_s >= kLeastAgeS) MakeSure(key);
}

// One ship, one track: what was sure of either before is not any more.
void Association::MakeSure(const Key& key) {
  std::erase_if(sure_track_, [&](const auto& other) {
    if (other.first != key.first && other.second != key.second) return false;
    ++counts_["pairs_given_up"];
    auto& pair = pairs_[other];
    pair.is_sure = false;
    pair.evidence = 0.0;
    return true;
  });
  auto& pair = pairs_[key];
  pair.is_sure = true;
  pair.evidence = kFirstEvidence;
  sure_track_[key.first] = key.second;
  ++counts_["pairs_found"];
}

void Association::Clear() {
  pairs_.clear();
  sure_track_.clear();
  last_time_.reset();
}

}  // namespace lookout::ais
