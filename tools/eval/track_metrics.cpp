#include "tools/eval/track_metrics.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "common/core/angles.hpp"
#include "tools/eval/track_assignment.hpp"
#include "tools/eval/track_geometry.hpp"

namespace lookout::eval {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kStandingMps = 0.05;
constexpr double kMovingMps = 0.5;
constexpr double kSettledS = 3.0;  // a track has this long to learn how its thing moves
constexpr double kLongThingM = 3.0;
constexpr double kLeastHiddenS = 1.0;
constexpr double kMostHiddenS = 10.0;
constexpr double kFoundAgainS = 1.0;
constexpr double kWarningS = 10.0;
constexpr double kTcpaStepS = 1.0;         // a TCPA that falls by more from one scan to the next does so by a turn
constexpr double kLeastApproachMps = 1.0;  // slower, TCPA says little
// What never had a track counts where it was there for twice the time in which 95 % should have one (1 s, 4 s).
constexpr std::array<double, 2> kLeastSeenS{1.0, 4.0};

double SecondsBetween(std::int64_t from_us, std::int64_t to_us) { return static_cast<double>(to_us - from_us) * 1e-6; }

bool IsExpected(const TrueThing& thing) { return thing.is_in_water && thing.num_returns >= kMinReturnsOfExpected; }

double LengthOf(const Polygon& outline_m) {
  double length_m = 0.0;
  for (const auto& a_m : outline_m) {
    for (const auto& b_m : outline_m) length_m = std::max(length_m, (a_m - b_m).norm());
  }
  return length_m;
}

Polygon OutlineOf(const TrackState& track) { return track.outline_m.empty() ? Polygon{track.position_m} : track.outline_m; }

enum class Verdict { kHit, kLeftOut, kFalse };

struct Matched {
  std::map<int, const TrackState*> track_of;                         // by id of the thing, also of one that need not be tracked
  std::map<std::int64_t, Verdict> verdict_of;                        // of reported tracks, by id; a hit is one of a thing that must be tracked
  std::map<std::pair<int, std::int64_t>, double> gap_of_expected_m;  // thing, track: within the gate
};

// Assigns scan after scan.
class Matcher {
 public:
  Matched Match(const TrueScan& scan, const std::vector<TrackState>& all_tracks) {
    std::vector<const TrackState*> tracks;
    for (const auto& track : all_tracks) {
      if (track.IsReported()) tracks.push_back(&track);
    }
    Eigen::MatrixXd gap_m(static_cast<Eigen::Index>(scan.things.size()), static_cast<Eigen::Index>(tracks.size()));
    for (std::size_t k = 0; k < tracks.size(); ++k) {
      const auto outline_m = OutlineOf(*tracks[k]);
      for (std::size_t i = 0; i < scan.things.size(); ++i) {
        gap_m(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = HullGap(outline_m, scan.things[i].outline_m, kTrackGateM);
      }
    }
    Matched matched;
    std::vector<bool> has_thing(tracks.size());
    KeepPairs(scan, tracks, gap_m, matched, has_thing);
    AssignRest(scan, tracks, gap_m, matched, has_thing);
    Judge(scan, tracks, gap_m, has_thing, matched);
    before_.clear();
    for (const auto& [id, track] : matched.track_of) before_[id] = track->id;
    return matched;
  }

 private:
  using Tracks = std::vector<const TrackState*>;

  void KeepPairs(const TrueScan& scan, const Tracks& tracks, const Eigen::MatrixXd& gap_m, Matched& matched, std::vector<bool>& has_thing) const {
    for (std::size_t i = 0; i < scan.things.size(); ++i) {
      const auto before = before_.find(scan.things[i].id);
      if (before == before_.end() || scan.things[i].is_land) continue;
      const auto track = std::ranges::find(tracks, before->second, [](const TrackState* one) { return one->id; });
      if (track == tracks.end()) continue;
      const auto k = static_cast<std::size_t>(track - tracks.begin());
      if (gap_m(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) > kTrackGateM) continue;
      matched.track_of[scan.things[i].id] = *track;
      has_thing[k] = true;
    }
  }

  // A column for each track and one for each thing that stays alone, which costs more than any pair.
  static void AssignRest(const TrueScan& scan, const Tracks& tracks, const Eigen::MatrixXd& gap_m, Matched& matched, std::vector<bool>& has_thing) {
    constexpr double kShareOfDistance = 0.01;  // decides between hulls that overlap alike
    constexpr double kMostOfDistanceM = 50.0;
    constexpr double kAlone = 1.5 * (kTrackGateM + kShareOfDistance * kMostOfDistanceM);
    constexpr double kImpossible = 1e6;
    std::vector<std::size_t> things;
    for (std::size_t i = 0; i < scan.things.size(); ++i) {
      if (!scan.things[i].is_land && !matched.track_of.contains(scan.things[i].id)) things.push_back(i);
    }
    if (things.empty()) return;
    Eigen::MatrixXd cost(static_cast<Eigen::Index>(things.size()), static_cast<Eigen::Index>(tracks.size() + things.size()));
    cost.fill(kAlone);
    for (std::size_t row = 0; row < things.size(); ++row) {
      for (std::size_t k = 0; k < tracks.size(); ++k) {
        const double pair_m = gap_m(static_cast<Eigen::Index>(things[row]), static_cast<Eigen::Index>(k));
        const double distance_m = (scan.things[things[row]].position_m - tracks[k]->position_m).norm();
        cost(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(k)) =
            has_thing[k] || pair_m > kTrackGateM ? kImpossible : pair_m + kShareOfDistance * std::min(distance_m, kMostOfDistanceM);
      }
    }
    const auto assigned = CheapestAssignment(cost);
    for (std::size_t row = 0; row < things.size(); ++row) {
      const auto k = static_cast<std::size_t>(assigned[row]);
      if (k >= tracks.size()) continue;
      matched.track_of[scan.things[things[row]].id] = tracks[k];
      has_thing[k] = true;
    }
  }

  static void Judge(const TrueScan& scan, const Tracks& tracks, const Eigen::MatrixXd& gap_m, const std::vector<bool>& has_thing, Matched& matched) {
    for (std::size_t k = 0; k < tracks.size(); ++k) {
      bool may_be_left_out = has_thing[k];
      for (std::size_t i = 0; i < scan.things.size(); ++i) {
        const double pair_m = gap_m(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k));
        if (pair_m > kTrackGateM) continue;
        if (IsExpected(scan.things[i])) {
          matched.gap_of_expected_m[{scan.things[i].id, tracks[k]->id}] = pair_m;
        } else {
          may_be_left_out = true;
        }
      }
      matched.verdict_of[tracks[k]->id] = may_be_left_out ? Verdict::kLeftOut : Verdict::kFalse;
    }
    for (const auto& thing : scan.things) {
      const auto track = matched.track_of.find(thing.id);
      if (IsExpected(thing) && track != matched.track_of.end()) matched.verdict_of[track->second->id] = Verdict::kHit;
    }
  }

  std::map<int, std::int64_t> before_;  // thing, track
};

using Run = std::vector<Matched>;

void ScoreClear(std::span<const TrueScan> truth, std::span<const std::vector<TrackState>> tracks, const Run& run, TrackScores& scores) {
  std::map<int, std::int64_t> last;  // thing, track
  for (std::size_t n = 0; n < truth.size(); ++n) {
    std::vector<Eigen::Vector2d> truths_m;
    for (const auto& thing : truth[n].things) {
      if (!IsExpected(thing)) continue;
      truths_m.push_back(thing.position_m);
      ++scores.num_expected;
      const auto track = run[n].track_of.find(thing.id);
      if (track == run[n].track_of.end()) {
        ++scores.num_missed;
        scores.events.push_back({TrackEvent::What::kMissed, truth[n].utime_us, thing.id, thing.num_returns, 0, thing.position_m});
        continue;
      }
      const auto [before, is_first] = last.try_emplace(thing.id, track->second->id);
      if (!is_first && before->second != track->second->id) {
        ++scores.num_switches;
        scores.events.push_back({TrackEvent::What::kSwitch, truth[n].utime_us, thing.id, thing.num_returns, track->second->id, thing.position_m});
      }
      before->second = track->second->id;
    }
    std::vector<Eigen::Vector2d> estimates_m;
    for (const auto& track : tracks[n]) {
      const auto verdict = run[n].verdict_of.find(track.id);
      if (verdict == run[n].verdict_of.end() || verdict->second == Verdict::kLeftOut) continue;
      estimates_m.push_back(track.position_m);
      if (verdict->second != Verdict::kFalse) continue;
      ++scores.num_false;
      scores.events.push_back({TrackEvent::What::kFalse, truth[n].utime_us, 0, 0, track.id, track.position_m});
    }
    scores.gospa.Add(GospaOf(truths_m, estimates_m));
  }
  scores.num_runs_without_switch = scores.num_switches == 0 ? 1 : 0;
}

void ScoreIdentities(const Run& run, TrackScores& scores) {
  std::map<std::pair<int, std::int64_t>, std::int64_t> num_together;
  std::map<std::int64_t, std::array<std::int64_t, 3>> num_by_verdict;
  for (const auto& matched : run) {
    for (const auto& [track, verdict] : matched.verdict_of) {
      ++num_by_verdict[track].at(static_cast<std::size_t>(verdict));
      if (verdict != Verdict::kLeftOut) ++scores.num_id_tracked;
    }
    for (const auto& [pair, gap_m] : matched.gap_of_expected_m) {
      if (matched.verdict_of.at(pair.second) != Verdict::kLeftOut) ++num_together[pair];
    }
  }
  for (const auto& [track, count] : num_by_verdict) {
    if (2 * count[static_cast<std::size_t>(Verdict::kFalse)] > count[0] + count[1] + count[2]) ++scores.num_false_tracks;
  }
  std::map<int, Eigen::Index> row_of;
  std::map<std::int64_t, Eigen::Index> column_of;
  for (const auto& [pair, count] : num_together) {
    row_of.try_emplace(pair.first, static_cast<Eigen::Index>(row_of.size()));
    column_of.try_emplace(pair.second, static_cast<Eigen::Index>(column_of.size()));
  }
  Eigen::MatrixXd cost = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(row_of.size()), static_cast<Eigen::Index>(column_of.size()));
  for (const auto& [pair, count] : num_together) cost(row_of.at(pair.first), column_of.at(pair.second)) = -static_cast<double>(count);
  const auto assigned = CheapestAssignment(cost);
  for (std::size_t row = 0; row < assigned.size(); ++row) {
    if (assigned[row] >= 0) scores.num_id_true += static_cast<std::int64_t>(-cost(static_cast<Eigen::Index>(row), assigned[row]));
  }
}

// How one thing went over the run.
struct History {
  struct Moment {
    std::int64_t utime_us;
    const TrueThing* thing;
    const TrackState* track;  // nullptr = none
    const TrueScan* scan;
  };
  std::vector<Moment> moments;

  bool IsStanding() const {
    return std::ranges::all_of(moments, [](const Moment& one) { return one.thing->velocity_mps.norm() < kStandingMps; });
  }
};

std::map<int, History> HistoriesOf(std::span<const TrueScan> truth, const Run& run) {
  std::map<int, History> histories;
  for (std::size_t n = 0; n < truth.size(); ++n) {
    for (const auto& thing : truth[n].things) {
      const auto track = run[n].track_of.find(thing.id);
      histories[thing.id].moments.push_back({truth[n].utime_us, &thing, track == run[n].track_of.end() ? nullptr : track->second, &truth[n]});
    }
  }
  return histories;
}

void ScoreConfirmation(const History& history, TrackScores& scores) {
  if (!history.moments.front().thing->is_in_water) return;
  const auto first = std::ranges::find_if(history.moments, [](const auto& one) { return one.thing->num_returns > 0; });
  if (first == history.moments.end()) return;
  const auto tracked = std::find_if(first, history.moments.end(), [](const auto& one) { return one.track != nullptr; });
  Summary num_returns;
  for (auto one = first; one != history.moments.end() && one <= tracked; ++one) num_returns.Add(one->thing->num_returns);
  if (num_returns.Median() < 1.0) return;  // hidden again
  const std::size_t kind = num_returns.Median() < kMinReturnsOfExpected ? 1 : 0;
  if (tracked != history.moments.end()) {
    scores.confirmed_s.at(kind).Add(SecondsBetween(first->utime_us, tracked->utime_us));
  } else if (SecondsBetween(first->utime_us, history.moments.back().utime_us) >= kLeastSeenS.at(kind)) {
    scores.confirmed_s.at(kind).Add(kInfinity);
  }
}

void ScoreHidden(const History& history, TrackScores& scores) {
  const auto& moments = history.moments;
  std::optional<std::size_t> last_seen;
  bool was_hidden = false;
  for (std::size_t n = 0; n < moments.size(); ++n) {
    if (moments[n].thing->num_returns == 0) was_hidden = true;
    if (!IsExpected(*moments[n].thing)) continue;
    const double hidden_s = last_seen ? SecondsBetween(moments[*last_seen].utime_us, moments[n].utime_us) : 0.0;
    const bool is_back = was_hidden && hidden_s >= kLeastHiddenS && hidden_s <= kMostHiddenS;
    if (is_back && moments[*last_seen].track != nullptr) {
      ++scores.num_hidden;
      for (std::size_t k = n; k < moments.size() && SecondsBetween(moments[n].utime_us, moments[k].utime_us) <= kFoundAgainS; ++k) {
        if (moments[k].track == nullptr) continue;
        if (moments[k].track->id == moments[*last_seen].track->id) ++scores.num_found_again;
        break;
      }
    }
    last_seen = n;
    was_hidden = false;
  }
}

// nullopt: not a covariance.
std::optional<double> NeesOf(const Eigen::Vector2d& error, const Eigen::Matrix2d& covariance) {
  if (!covariance.allFinite() || covariance(0, 0) <= 0.0 || covariance.determinant() <= 0.0) return std::nullopt;
  return error.dot(covariance.inverse() * error) / 2.0;
}

void ScoreErrors(const TrueThing& thing, const TrackState& track, bool is_settled, TrackScores& scores) {
  if (!track.covariance.hasNaN() && IsExpected(thing)) {
    const auto position_nees = NeesOf(track.position_m - thing.position_m, track.covariance.topLeftCorner<2, 2>());
    if (position_nees) scores.position_nees.Add(*position_nees);
    const auto velocity_nees =
        track.is_moving ? NeesOf(track.velocity_mps - thing.velocity_mps, track.covariance.bottomRightCorner<2, 2>()) : std::optional(0.0);
    if (velocity_nees && track.is_moving) scores.velocity_nees.Add(*velocity_nees);
    if (!position_nees || !velocity_nees) ++scores.num_bad_covariances;
  }
  if (!is_settled || !IsExpected(thing)) return;
  if (LengthOf(thing.outline_m) >= kLongThingM) scores.center_error_m.Add((track.position_m - thing.position_m).norm());
  if (thing.velocity_mps.norm() < kMovingMps) return;
  scores.speed_error_mps.Add(std::abs(track.velocity_mps.norm() - thing.velocity_mps.norm()));
  scores.called_standing.Add(track.is_moving ? 0.0 : 1.0);
  if (!track.is_moving) return;
  const double course_rad = std::atan2(track.velocity_mps.x(), track.velocity_mps.y());
  const double true_course_rad = std::atan2(thing.velocity_mps.x(), thing.velocity_mps.y());
  scores.course_error_deg.Add(std::abs(RadToDeg(WrapToPi(course_rad - true_course_rad))));
}

void ScoreMotion(const History& history, TrackScores& scores) {
  const bool is_standing = history.IsStanding();
  bool was_tracked = false;
  bool was_called_moving = false;
  std::int64_t first_us = 0;
  for (const auto& moment : history.moments) {
    if (moment.track == nullptr || moment.thing->num_returns == 0) continue;
    if (!was_tracked) first_us = moment.utime_us;
    was_tracked = true;
    if (is_standing) {
      scores.standing_speed_mps.Add(moment.track->velocity_mps.norm());
      was_called_moving = was_called_moving || moment.track->is_moving;
    }
    ScoreErrors(*moment.thing, *moment.track, SecondsBetween(first_us, moment.utime_us) >= kSettledS, scores);
  }
  if (!is_standing || !was_tracked) return;
  ++scores.num_standing;
  if (was_called_moving) ++scores.num_called_moving;
}

void ScoreApproaches(const History& history, TrackScores& scores) {
  double before_s = 0.0;  // 0 = not known
  for (const auto& [utime_us, thing, track, scan] : history.moments) {
    if (!scan->own || !IsExpected(*thing) || thing->velocity_mps.norm() < kMovingMps ||
        (thing->velocity_mps - scan->own->velocity_mps).norm() < kLeastApproachMps) {
      before_s = 0.0;
      continue;
    }
    const auto& own = *scan->own;
    const auto truth = ApproachOf(own.outline_m, own.velocity_mps, thing->outline_m, thing->velocity_mps);
    const bool is_warning = before_s > kWarningS && truth.tcpa_s <= kWarningS && before_s - truth.tcpa_s < kTcpaStepS;
    before_s = truth.tcpa_s;
    if (!is_warning) continue;
    ++scores.num_crossings;
    if (track == nullptr) {
      ++scores.num_crossings_untracked;
      continue;
    }
    Approach stated{track->cpa_m, track->tcpa_s};
    if (std::isnan(stated.cpa_m)) stated = ApproachOf(own.outline_m, own.velocity_mps, OutlineOf(*track), track->velocity_mps);
    scores.cpa_error_m.Add(std::abs(stated.cpa_m - truth.cpa_m));
    scores.tcpa_error_s.Add(std::abs(stated.tcpa_s - truth.tcpa_s));
  }
}

}  // namespace

double TrackScores::Mota() const {
  if (num_expected == 0) return std::numeric_limits<double>::quiet_NaN();
  return 1.0 - static_cast<double>(num_missed + num_false + num_switches) / static_cast<double>(num_expected);
}

double TrackScores::Idf1() const {
  if (num_expected == 0) return std::numeric_limits<double>::quiet_NaN();
  return 2.0 * static_cast<double>(num_id_true) / static_cast<double>(num_expected + num_id_tracked);
}

double TrackScores::FalseTracksPerMinute() const { return static_cast<double>(num_false_tracks) / (seconds / 60.0); }

void TrackScores::Add(const TrackScores& other) {
  num_runs += other.num_runs;
  seconds += other.seconds;
  num_expected += other.num_expected;
  num_missed += other.num_missed;
  num_false += other.num_false;
  num_switches += other.num_switches;
  num_runs_without_switch += other.num_runs_without_switch;
  num_id_true += other.num_id_true;
  num_id_tracked += other.num_id_tracked;
  num_false_tracks += other.num_false_tracks;
  gospa.Add(other.gospa);
  for (std::size_t i = 0; i < confirmed_s.size(); ++i) confirmed_s.at(i).Add(other.confirmed_s.at(i));
  num_hidden += other.num_hidden;
  num_found_again += other.num_found_again;
  position_nees.Add(other.position_nees);
  velocity_nees.Add(other.velocity_nees);
  num_bad_covariances += other.num_bad_covariances;
  standing_speed_mps.Add(other.standing_speed_mps);
  num_standing += other.num_standing;
  num_called_moving += other.num_called_moving;
  speed_error_mps.Add(other.speed_error_mps);
  course_error_deg.Add(other.course_error_deg);
  called_standing.Add(other.called_standing);
  center_error_m.Add(other.center_error_m);
  cpa_error_m.Add(other.cpa_error_m);
  tcpa_error_s.Add(other.tcpa_error_s);
  num_crossings += other.num_crossings;
  num_crossings_untracked += other.num_crossings_untracked;
}

TrackScores ScoreTracks(std::span<const TrueScan> truth, std::span<const std::vector<TrackState>> tracks) {
  if (truth.size() != tracks.size()) throw std::logic_error("as many scans of tracks as of truth are needed");
  TrackScores scores;
  if (truth.empty()) return scores;
  scores.num_runs = 1;
  // A scan lasts as long as it takes to the next.
  const double span_s = SecondsBetween(truth.front().utime_us, truth.back().utime_us);
  scores.seconds = truth.size() > 1 ? span_s * static_cast<double>(truth.size()) / static_cast<double>(truth.size() - 1) : 0.0;
  Matcher matcher;
  Run run;
  for (std::size_t n = 0; n < truth.size(); ++n) run.push_back(matcher.Match(truth[n], tracks[n]));
  ScoreClear(truth, tracks, run, scores);
  ScoreIdentities(run, scores);
  for (const auto& [id, history] : HistoriesOf(truth, run)) {
    if (history.moments.front().thing->is_land) continue;
    ScoreConfirmation(history, scores);
    ScoreHidden(history, scores);
    ScoreMotion(history, scores);
    ScoreApproaches(history, scores);
  }
  return scores;
}

}  // namespace lookout::eval
