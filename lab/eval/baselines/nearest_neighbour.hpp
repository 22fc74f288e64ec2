// The plainest tracker that one would write: nearest neighbour, alpha-beta filter, three hits of five.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lab/eval/tracks/multi_object_tracker.hpp"

namespace lookout::eval {

struct NearestNeighbourParams {
  // Gains of position and velocity: usual values for tracking at a high rate (E. Brookner, "Tracking and Kalman Filtering Made Easy", Wiley 1998,
  // 1.2: critically damped for a fading memory of 0.7).
  double alpha = 0.51;
  double beta = 0.09;
  double gate_m = 3.0;           // of distance between position and prediction, drawn from the size of small boats
  double gate_growth_mps = 5.0;  // growth of the gate for each second since the last hit, from the speed of boats
  int num_hits = 3;              // of the last num_looks scans: then it is reported
  int num_looks = 5;             // as many misses in a row end the track
  double moving_mps = 0.5;       // a faster track counts as moving
};

/// Obstacles that are sure, placed and not land. Of all pairs of track and obstacle within the gate the nearest is taken first, then the nearest of
/// the remaining ones; at equal distance the track, and then the obstacle, of lower id comes first. Remaining obstacles begin tracks.
class NearestNeighbour final : public MultiObjectTracker {
 public:
  explicit NearestNeighbour(const NearestNeighbourParams& params = {}) : params_(params) {}

  std::string name() const override { return "nearest neighbour"; }
  std::vector<TrackState> Update(const messages::ScanMessages& scan) override;

 private:
  struct Followed {
    TrackState state;
    std::int64_t time_us = 0;  // of the state
    std::int64_t hit_us = 0;   // of the last obstacle
    std::vector<bool> looks;   // the last looks, newest last: hit or not
  };

  void Predict(std::int64_t time_us);
  void Correct(Followed& track, const obstacle_t& obstacle, std::int64_t time_us) const;

  NearestNeighbourParams params_;
  std::int64_t last_id_ = 0;
  std::vector<Followed> tracks_;  // by id
};

}  // namespace lookout::eval
