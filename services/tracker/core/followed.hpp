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
#include "services/tracker/core/surface_motion.hpp"
#include "services/tracker/core/watched_water.hpp"

namespace lookout::tracker {

inline double Logit(double probability) {
  const double bounded = std::clamp(probability, 0.01, 0.99);
  return Log(bounded / (1.0 - bounded));
}
inline double Sigmoid(double log_odds) { return 1.0 / (1.0 + Exp(-log_odds)); }

inline constexpr double kBirthLogOdds = -2.0;
inline constexpr double kClearLogOdds = 2.0;       // of a thing beyond doubt at first sight
inline constexpr double kFirstStepM2 = 0.3 * 0.3;  // mean_step_m2 before there was a step
inline constexpr int kMostHits = 30;               // hits that count in a mean, the last ones most
inline constexpr int kMostLooks = 60;              // hits that speak for a thing

struct Followed {
  std::int64_t id = 0;      // in the order in which tracks began
  std::int64_t number = 0;  // given when it is confirmed; 0: not yet
  Utime first;
  Utime seen;
  Utime seen_alone;                        // when it was last seen by itself, and not inside of another track's sighting
  std::optional<Body> body;                // none until the track is likely: its last sighting stands for it
  SurfaceMotion surface;                   // once it has a body
  std::vector<Eigen::Vector2d> outline_m;  // predicted
  Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
  double radius_m = 0.0;
  Eigen::Matrix2d own_covariance_m2 = Eigen::Matrix2d::Zero();       // error of the own position when the track was seen last
  Eigen::Matrix2d relative_covariance_m2 = Eigen::Matrix2d::Zero();  // of the seen centre, relative to the own boat
  double log_odds = kBirthLogOdds;                                   // that something lasts there from scan to scan
  double mean_thing = 0.0;                                           // of the log odds that its segments are no clutter
  double mean_step_m2 = kFirstStepM2;                                // of the squared steps from sighting to sighting
  Eigen::Vector2d seen_m = Eigen::Vector2d::Zero();                  // middle of its last sighting
  double seen_radius_m = 0.0;                                        // of its last sighting
  double first_radius_m = 0.0;                                       // of its first sighting
  int num_hits = 0;
  int num_alone = 0;        // hits 4 m or more from confirmed tracks and 2 m or more from the own hull; nearer, parts, gear and crew stand still too
  double beams_met = 1.0;   // beams that ended in it, the last ones most: at first as if one of two had
  double beams_open = 2.0;  // beams that would have met it if it reflected each
  double top_m = 0.0;
  double sum_returns = 0.0;
  int num_moving = 0;                                 // scans in which it moved for sure
  Eigen::Vector2d first_m = Eigen::Vector2d::Zero();  // middle, when it was seen first
  std::optional<Watched> watched;                     // looks at the water in which it came up, before it did; nullopt: not asked yet
  bool is_on_ground = false;                          // it moves, and is seen where something stood before
  double watched_top_m = 0.0;                         // top_m with which `watched` was asked
  int num_misfits = 0;                                // scans in a row whose outline did not fit
  std::deque<bool> looks;                             // last scans that saw it, or should have: whether they did
  std::vector<std::int32_t> segment_ids;
  std::vector<std::pair<std::int64_t, Utime>> parents;  // by number
  std::vector<std::pair<std::int64_t, Utime>> children;
  std::int64_t frame = 0;  // of the ledger: 0 the earth, above 0 its own, since it moves
  double stood_s = 0.0;    // since it moved last
  bool is_confirmed = false;
  bool is_ended = false;
  bool is_proven = false;  // it was followed as a piece of land, and left its place: it is no land
  bool is_seen_now = false;
  std::size_t sighting = 0;  // by which it is seen now
  bool is_inside_now = false;
  std::int64_t inside_of = 0;               // the track that was seen by the segment in which this one lies; 0: land
  bool is_met = false;                      // most beams that could, ended in it in this scan
  double detection = 0.0;                   // probability that this scan sees it, if it is there
  Encounter overtaking = Encounter::kNone;  // OVERTAKING or OVERTAKEN, kept until both are past and clear

  // Log odds that it is a thing, and no clutter that lasts (crest, foam, drops): by the mean log odds of its segments, how often it was seen, and how
  // steadily it stands or moves. Fitted: logistic regression. Besides, only things, and parts of the own boat, stand still to some centimetres from
  // scan to scan (DECISIONS.md).
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
  // Log odds that it is no crest. A crest looks like a thing for as long as it lives. Crests are low, run, and come up in water that was seen to be
  // empty; none of these facts counts for a track that has lived longer than crests do. Fitted: logistic regression; the log odds of coming up count
  // in full (DECISIONS.md).
  double NoCrestLogOdds() const {
    constexpr double kHighM = 1.0;       // higher than any crest
    constexpr double kLowM = 0.5;        // as low as most crests
    constexpr double kLongestS = 5.0;    // that a crest lives
    constexpr double kAtFirstMps = 1.0;  // speed of a new track, until it is seen
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

  // Adds a track that this one came from or became; of more than kMostRelatives the newest stay.
  static void Relate(std::vector<std::pair<std::int64_t, Utime>>& relatives, std::int64_t other, Utime time) {
    constexpr std::size_t kMostRelatives = 100;
    if (relatives.size() == kMostRelatives) relatives.erase(relatives.begin());
    relatives.emplace_back(other, time);
  }
};

}  // namespace lookout::tracker
