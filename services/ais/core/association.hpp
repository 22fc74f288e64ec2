// Which track is which ship of AIS.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "common/core/health.hpp"
#include "common/core/utime.hpp"
#include "services/ais/core/likelihood.hpp"
#include "services/ais/core/ships.hpp"

namespace lookout::ais {

struct AssociationParams {
  double sure_probability = 0.99;  // above, evidence grows that a track is a ship
};

/// A ship that may be in the lidar's sight.
struct ShipInReach {
  const Ship* ship = nullptr;
  PredictedShip predicted;
};

/// Which track a ship is, or most likely is.
struct Identity {
  std::int32_t mmsi = 0;
  std::int64_t track_id = 0;      // 0: none is likely
  double probability = 0.0;       // that the ship is this track
  double none_probability = 1.0;  // that the ship is none of the tracks
  bool is_sure = false;
};

/// The probability of each pair given that one ship is at most one track and one track at most one ship.
///
/// @param weight  [ships x tracks] odds of a pair against the track being anything else, 0: cannot be
/// @param none_weight  [ships] odds of a ship not being any track
/// @return [ships x tracks + 1] marginal probabilities; the last column: none
/// Source: J. Williams, R. Lau, "Approximate evaluation of marginal association probabilities with belief propagation", IEEE Transactions on
/// Aerospace and Electronic Systems 50 (2014): exact where ships and tracks form no loop, and near elsewhere.
Eigen::MatrixXd PairProbabilities(const Eigen::MatrixXd& weight, const Eigen::VectorXd& none_weight);

/// Depends on ships, tracks and their times alone. A pair is sure once its log odds above those of sure_probability have added up over time, and
/// stays so until odds against it have.
class Association {
 public:
  explicit Association(const AssociationParams& params) : params_(params) {}

  /// @param ships   by MMSI
  /// @param tracks  by id, confirmed ones
  /// @return of each ship, in their order
  std::vector<Identity> Update(Utime time, std::span<const ShipInReach> ships, std::span<const TrackedThing> tracks);

  void Clear();
  std::vector<Counter> counters() const {
    std::vector<Counter> counters;
    counts_.AppendTo(counters);
    return counters;
  }

 private:
  using Key = std::pair<std::int32_t, std::int64_t>;  // MMSI, track
  struct Pair {
    double age_s = 0.0;
    Eigen::Vector2d mean_difference_m = Eigen::Vector2d::Zero();
    double evidence = 0.0;  // log odds, summed over seconds; 0 to kMostEvidence
    bool is_sure = false;
    bool is_near = false;  // in this scan
  };

  double WeightOf(const ShipInReach& ship, const TrackedThing& track, const Background& background, double step_s);
  void AddEvidence(const Key& key, double probability, double step_s);
  void MakeSure(const Key& key);

  static constexpr auto kCountNames = std::to_array<std::string_view>({"pairs_found", "pairs_given_up", "pairs_ended"});

  AssociationParams params_;
  std::map<Key, Pair> pairs_;
  std::map<std::int32_t, std::int64_t> sure_track_;  // by MMSI
  std::optional<Utime> last_time_;
  Counts<kCountNames> counts_;
};

}  // namespace lookout::ais
