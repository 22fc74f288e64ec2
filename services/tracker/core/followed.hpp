// A track while it is followed: all that is known of one thing, confirmed or not.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "common/core/elementary.hpp"
#include "common/core/utime.hpp"
#include "services/tracker/core/body.hpp"

namespace lookout::tracker {

inline double Logit(double probability) {
  const double bounded = std::clamp(probability, 0.01, 0.99);
  return Log(bounded / (1.0 - bounded));
}
inline double Sigmoid(double log_odds) { return 1.0 / (1.0 + Exp(-log_odds)); }

inline constexpr double kBirthLogOdds = -2.0;

struct Followed {
  std::int64_t id = 0;
  Utime first;
  Utime seen;
  Utime seen_alone;                        // when it was last seen by itself, and not inside of what another is seen by
  std::optional<Body> body;                // from when it is likely; before that, what was seen last stands for it
  std::vector<Eigen::Vector2d> outline_m;  // predicted
  Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
  double radius_m = 0.0;
  Eigen::Vector2d first_m = Eigen::Vector2d::Zero();
  Eigen::Matrix2d own_covariance_m2 = Eigen::Matrix2d::Zero();       // error of the own position, of the last time it was seen
  Eigen::Matrix2d relative_covariance_m2 = Eigen::Matrix2d::Zero();  // of the seen centre, relative to the own boat
  double log_odds = kBirthLogOdds;                                   // that something is there that lasts from scan to scan
  double sum_thing = 0.0;                                            // of the log odds of its segments that they are no clutter
  int num_hits = 0;
  double beams_met = 1.0;  // of those that could have: with one of two as what is known before
  double beams_open = 2.0;
  double top_m = 0.0;
  double sum_returns = 0.0;
  double land_votes = 0.0;
  int num_moving = 0;  // scans in which it moved for sure
  int num_misfits = 0;  // scans in a row whose outline was another
  std::deque<bool> looks;
  std::vector<std::int32_t> segment_ids;
  std::vector<std::pair<std::int64_t, Utime>> parents;
  std::vector<std::pair<std::int64_t, Utime>> children;
  bool is_confirmed = false;
  bool is_ended = false;
  bool is_seen_now = false;
  bool is_inside_now = false;
  std::int64_t inside_of = 0;  // the track that was seen by the segment in which this one lies; 0: land
  bool is_met = false;         // beams ended in it, in this scan
  double detection = 0.0;      // probability, this scan

  bool IsStanding() const {
    if (body && num_hits >= 5) return body->moving_probability() < 0.5;
    return (middle_m - first_m).norm() < 0.3 + 0.3 * std::max(0.0, ToSeconds(seen - first));
  }
  // That it is a thing and no clutter that lasts (crest, foam): what its segments look like, and how long it has lasted in one place.
  double ThingLogOdds() const {
    constexpr double kPerScan = 0.15;
    constexpr double kMostFor = 3.0;      // what looks like a thing, seen often
    constexpr double kMostAgainst = 1.5;  // what looks like clutter: drops and buoys of one return do
    constexpr double kPerSecondStanding = 1.5;
    constexpr double kPerSecondMoving = 0.5;
    constexpr double kMostForAge = 8.0;
    const double mean = sum_thing / std::max(1, num_hits);
    const double age_s = std::max(0.0, ToSeconds(seen - first));
    return mean * std::min(mean > 0.0 ? kMostFor : kMostAgainst, 1.0 + kPerScan * (num_hits - 1)) +
           std::min(kMostForAge, (IsStanding() ? kPerSecondStanding : kPerSecondMoving) * age_s);
  }
  double Existence() const { return Sigmoid(log_odds) * Sigmoid(ThingLogOdds()); }
  double UnseenS(Utime now) const { return ToSeconds(now - seen); }
};

}  // namespace lookout::tracker
