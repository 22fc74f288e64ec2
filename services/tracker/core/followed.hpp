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
#include "services/tracker/core/encounter.hpp"
#include "services/tracker/core/watched_water.hpp"

namespace lookout::tracker {

inline double Logit(double probability) {
  const double bounded = std::clamp(probability, 0.01, 0.99);
  return Log(bounded / (1.0 - bounded));
}
inline double Sigmoid(double log_odds) { return 1.0 / (1.0 + Exp(-log_odds)); }

inline constexpr double kBirthLogOdds = -2.0;
inline constexpr double kClearLogOdds = 2.0;       // of a thing that is beyond doubt at first sight
inline constexpr double kFirstStepM2 = 0.3 * 0.3;  // before there was one
inline constexpr int kMostHits = 30;               // that count in a mean, the last ones most
inline constexpr int kMostLooks = 60;              // that speak for it

struct Followed {
  std::int64_t id = 0;      // in the order in which they began
  std::int64_t number = 0;  // given when it is confirmed; 0: not yet
  Utime first;
  Utime seen;
  Utime seen_alone;                        // when it was last seen by itself, and not inside of another track's sighting
  std::optional<Body> body;                // from when it is likely; before that, its last sighting stands for it
  std::vector<Eigen::Vector2d> outline_m;  // predicted
  Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
  double radius_m = 0.0;
  Eigen::Matrix2d own_covariance_m2 = Eigen::Matrix2d::Zero();       // error of the own position, of the last time it was seen
  Eigen::Matrix2d relative_covariance_m2 = Eigen::Matrix2d::Zero();  // of the seen centre, relative to the own boat
  double log_odds = kBirthLogOdds;                                   // that something is there that lasts from scan to scan
  double mean_thing = 0.0;                                           // of the log odds of its segments that they are no clutter
  double mean_step_m2 = kFirstStepM2;                                // squared, from where it was expected to where it was seen
  Eigen::Vector2d seen_m = Eigen::Vector2d::Zero();                  // middle of its last sighting
  double seen_radius_m = 0.0;                                        // of it
  double first_radius_m = 0.0;                                       // of its first sighting
  int num_hits = 0;
  int num_alone = 0;       // of these away from all known things and from the own hull, to which parts, gear and crew stand still
  double beams_met = 1.0;  // of those that could have: with one of two as what is known before
  double beams_open = 2.0;
  double top_m = 0.0;
  double sum_returns = 0.0;
  int num_moving = 0;                                 // scans in which it moved for sure
  Eigen::Vector2d first_m = Eigen::Vector2d::Zero();  // middle, when it was seen first
  std::optional<Watched> watched;                     // the water in which it came up, before it did; nullopt: nobody has asked
  bool is_on_ground = false;                          // it moves, and is seen where something stood before
  double watched_top_m = 0.0;                         // with which it was asked
  int num_misfits = 0;                                // scans in a row whose outline was another
  std::deque<bool> looks;
  std::vector<std::int32_t> segment_ids;
  std::vector<std::pair<std::int64_t, Utime>> parents;  // by number
  std::vector<std::pair<std::int64_t, Utime>> children;
  std::int64_t frame = 0;  // of the ledger: 0 the earth, above 0 its own, since it moves
  double stood_s = 0.0;    // since it moved last
  bool is_confirmed = false;
  bool is_ended = false;
  bool is_proven = false;  // it left a place where land had been thought: no land
  bool is_seen_now = false;
  std::size_t sighting = 0;  // by which it is
  bool is_inside_now = false;
  std::int64_t inside_of = 0;               // the track that was seen by the segment in which this one lies; 0: land
  bool is_met = false;                      // beams ended in it, in this scan
  double detection = 0.0;                   // probability, this scan
  Encounter overtaking = Encounter::kNone;  // one overtakes the other, until they are past and clear

  // That it is a thing and no clutter that lasts (crest, foam, drops): the mean log odds of its segments, how often it was seen, and how steadily it
  // stands or moves. Fitted: logistic regression; besides, only things, and parts of the own boat, stand still to some centimetres from scan to scan
  // (DECISIONS.md).
  double ThingLogOdds() const {
    constexpr double kLeastStepM = 0.05;
    constexpr double kStillStepM = 0.05;
    constexpr int kLeastStill = 1;  // one step may be chance
    constexpr int kMostStill = 20;
    const double often = Log(std::min(num_hits, kMostLooks));
    const double step_m = std::sqrt(mean_step_m2);
    const double unsteady = Log(step_m + kLeastStepM);
    const double still = std::clamp(num_alone - kLeastStill, 0, kMostStill) * Exp(-step_m / kStillStepM);
    return -0.86 + std::clamp(mean_thing, -4.0, 4.0) * (0.90 + 0.31 * often) + 0.77 * often - unsteady * (0.39 + 0.53 * often) + still;
  }
  void AddLook(double thing_log_odds, double step_m) {
    ++num_hits;
    const double gain = 1.0 / std::min(num_hits, kMostHits);
    mean_thing += gain * (thing_log_odds - mean_thing);
    if (num_hits > 1) mean_step_m2 += (num_hits == 2 ? 1.0 : gain) * (step_m * step_m - mean_step_m2);
  }
  // The published id: a number from 1 up, or one of -2 and below until the track is confirmed.
  std::int64_t PublicId() const {
    constexpr std::int64_t kMostAtATime = 900'000;
    return number > 0 ? number : -2 - id % kMostAtATime;
  }
  double Existence() const { return Sigmoid(log_odds) * Sigmoid(ThingLogOdds()); }
  // That it is no crest, which looks like a thing for as long as it lives. Crests are low, run, and come up in water that was seen to be empty; none
  // of these facts counts for a track that has lived longer than a crest does. Fitted: logistic regression; the log odds of coming up count in full
  // (DECISIONS.md).
  double NoCrestLogOdds() const {
    constexpr double kHighM = 1.0;       // higher than any crest
    constexpr double kLowM = 0.5;        // as low as most
    constexpr double kLongestS = 5.0;    // that one lives
    constexpr double kAtFirstMps = 1.0;  // how fast it runs, before that is seen
    constexpr double kAtFirstS = 0.5;
    constexpr double kMostMps = 1.5;
    const double age_s = ToSeconds(seen - first);
    const double low_m = std::clamp(kHighM - top_m, 0.0, kHighM);
    const double runs_mps = std::min(((seen_m - first_m).norm() + kAtFirstMps * kAtFirstS) / (age_s + kAtFirstS), kMostMps);
    const double seen_share = (static_cast<double>(std::ranges::count(looks, true)) + 1.0) / (static_cast<double>(looks.size()) + 2.0);
    const double came_up = watched ? CameUpLogOdds(*watched, seen_share) : 0.0;
    const double crest = low_m * (2.0 + 2.1 * runs_mps) + std::min(1.0, low_m / kLowM) * came_up;
    return 6.3 - crest * std::max(0.0, 1.0 - age_s / kLongestS);
  }
  double Probability() const { return Existence() * Sigmoid(NoCrestLogOdds()); }
  double UnseenS(Utime now) const { return ToSeconds(now - seen); }

  // Tracks that it came from or became: the newest of many.
  static void Relate(std::vector<std::pair<std::int64_t, Utime>>& relatives, std::int64_t other, Utime time) {
    constexpr std::size_t kMostRelatives = 100;
    if (relatives.size() == kMostRelatives) relatives.erase(relatives.begin());
    relatives.emplace_back(other, time);
  }
};

}  // namespace lookout::tracker
