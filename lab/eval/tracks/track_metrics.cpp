#include "lab/eval/tracks/track_metrics.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "common/core/assignment.hpp"
#include "lab/eval/tracks/track_geometry.hpp"
#include "lab/eval/tracks/track_histories.hpp"

namespace lookout::eval {
namespace {

struct Nearest {
  std::int64_t id = 0;
  double gap_m = std::numeric_limits<double>::infinity();
};

Nearest NearestTrack(const TrueThing& thing, const std::vector<TrackState>& tracks) {
  Nearest nearest;
  for (const auto& track : tracks) {
    if (track.status == TrackStatus::kLost) continue;
    const double gap_m = HullGap(OutlineOf(track), thing.outline_m, nearest.gap_m);
    if (gap_m < nearest.gap_m) nearest = {track.id, gap_m};
  }
  return nearest;
}

Nearest NearestThing(const TrackState& track, const TrueScan& scan) {
  Nearest nearest;
  for (const auto& thing : scan.things) {
    const double gap_m = HullGap(OutlineOf(track), thing.outline_m, nearest.gap_m);
    if (gap_m < nearest.gap_m) nearest = {thing.id, gap_m};
  }
  return nearest;
}

void ScoreClear(std::span<const TrueScan> truth, std::span<const std::vector<TrackState>> tracks, std::span<const Matched> run, TrackScores& scores) {
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
        const auto [nearest, gap_m] = NearestTrack(thing, tracks[n]);
        scores.events.push_back(
            {TrackEvent::What::kMissed, truth[n].utime_us, thing.id, thing.num_returns, 0, thing.position_m, nearest, gap_m, 0.0});
        continue;
      }
      const auto [before, is_first] = last.try_emplace(thing.id, track->second->id);
      if (!is_first && before->second != track->second->id) {
        ++scores.num_switches;
        scores.events.push_back({TrackEvent::What::kSwitch, truth[n].utime_us, thing.id, thing.num_returns, track->second->id, thing.position_m,
                                 before->second, 0.0, track->second->velocity_mps.norm()});
      }
      before->second = track->second->id;
    }
    std::vector<Eigen::Vector2d> estimates_m;
    bool has_double = false;
    for (const auto& track : tracks[n]) {
      const auto verdict = run[n].verdict_of.find(track.id);
      if (verdict == run[n].verdict_of.end() || verdict->second == Verdict::kExcused) continue;
      estimates_m.push_back(track.position_m);
      if (verdict->second == Verdict::kHit) continue;
      has_double = has_double || verdict->second == Verdict::kDouble;
      ++scores.num_false;
      const auto [nearest, gap_m] = NearestThing(track, truth[n]);
      scores.events.push_back(
          {TrackEvent::What::kFalse, truth[n].utime_us, 0, 0, track.id, track.position_m, nearest, gap_m, track.velocity_mps.norm()});
    }
    scores.has_double.Add(has_double ? 1.0 : 0.0);
    scores.gospa.Add(GospaOf(truths_m, estimates_m));
  }
  scores.num_runs_without_switch = scores.num_switches == 0 ? 1 : 0;
}

void ScoreIdentities(std::span<const Matched> run, TrackScores& scores) {
  std::map<std::pair<int, std::int64_t>, std::int64_t> num_together;
  std::map<std::int64_t, std::array<std::int64_t, kNumVerdicts>> num_by_verdict;
  for (const auto& matched : run) {
    for (const auto& [track, verdict] : matched.verdict_of) {
      ++num_by_verdict[track].at(static_cast<std::size_t>(verdict));
      if (verdict != Verdict::kExcused) ++scores.num_id_tracked;
    }
    for (const auto& [pair, gap_m] : matched.gap_of_expected_m) {
      if (matched.verdict_of.at(pair.second) != Verdict::kExcused) ++num_together[pair];
    }
  }
  for (const auto& [track, count] : num_by_verdict) {
    const auto of = [&count = count](Verdict verdict) { return count.at(static_cast<std::size_t>(verdict)); };
    const auto num_false = of(Verdict::kFalse) + of(Verdict::kDouble);
    if (num_false <= of(Verdict::kHit) + of(Verdict::kExcused)) continue;
    ++scores.num_false_tracks;
    if (of(Verdict::kDouble) > of(Verdict::kFalse)) ++scores.num_double_tracks;
  }
  scores.num_reported_ids = std::ssize(num_by_verdict);
  scores.greatest_ids = num_by_verdict.empty() ? 0 : num_by_verdict.rbegin()->first;
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

// Uses the same things and tracks as ScoreClear.
TrajectoryGospa TrajectoryGospaOfRun(std::span<const TrueScan> truth, std::span<const std::vector<TrackState>> tracks, std::span<const Matched> run) {
  std::vector<TrajectoryScan> scans(truth.size());
  for (std::size_t n = 0; n < truth.size(); ++n) {
    for (const auto& thing : truth[n].things) {
      if (IsExpected(thing)) scans[n].truths_m.emplace_back(thing.id, thing.position_m);
    }
    for (const auto& track : tracks[n]) {
      const auto verdict = run[n].verdict_of.find(track.id);
      if (verdict != run[n].verdict_of.end() && verdict->second != Verdict::kExcused) scans[n].estimates_m.emplace_back(track.id, track.position_m);
    }
  }
  return TrajectoryGospaOf(scans);
}

// All but the events.
auto AdditiveOfTracks(auto& scores) {
  return std::tie(scores.num_runs, scores.seconds, scores.num_expected, scores.num_missed, scores.num_false, scores.num_switches,
                  scores.num_runs_without_switch, scores.num_id_true, scores.num_id_tracked, scores.num_false_tracks, scores.num_double_tracks,
                  scores.has_double, scores.num_reported_ids, scores.greatest_ids, scores.hota, scores.gospa, scores.trajectory_gospa,
                  scores.near_buoy_tracked, scores.confirmed_s, scores.num_hidden, scores.num_found_again, scores.position_nees, scores.velocity_nees,
                  scores.num_things_with_covariance, scores.num_bad_covariances, scores.standing_speed_mps, scores.num_standing,
                  scores.num_called_moving, scores.speed_error_mps, scores.course_error_deg, scores.called_standing, scores.center_error_m,
                  scores.cpa_error_m, scores.tcpa_error_s, scores.num_crossings, scores.num_crossings_untracked, scores.num_crossings_turning,
                  scores.calibration, scores.num_alerts, scores.warned_ahead_s, scores.warned_after_s, scores.alerts_of_pass);
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

double TrackScores::FalseTracksPerHour() const { return static_cast<double>(num_false_tracks) / (seconds / 3600.0); }

double TrackScores::IdsPerTrack() const {
  if (num_reported_ids == 0) return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(greatest_ids) / static_cast<double>(num_reported_ids);
}

void TrackScores::Add(const TrackScores& other) { AddEach(AdditiveOfTracks(*this), AdditiveOfTracks(other)); }

void Calibration::Add(double probability, bool came_true) {
  const auto last = static_cast<double>(bins.size() - 1);
  auto& bin = bins.at(static_cast<std::size_t>(std::clamp(probability * static_cast<double>(bins.size()), 0.0, last)));
  bin.stated.Add(probability);
  bin.came_true.Add(came_true ? 1.0 : 0.0);
}

void Calibration::Add(const Calibration& other) {
  for (std::size_t i = 0; i < bins.size(); ++i) {
    bins.at(i).stated.Add(other.bins.at(i).stated);
    bins.at(i).came_true.Add(other.bins.at(i).came_true);
  }
}

std::int64_t Calibration::count() const {
  std::int64_t sum = 0;
  for (const auto& bin : bins) sum += bin.stated.count;
  return sum;
}

double Calibration::Error() const {
  double sum = 0.0;
  for (const auto& bin : bins) sum += std::abs(bin.stated.sum - bin.came_true.sum);
  return count() > 0 ? sum / static_cast<double>(count()) : std::numeric_limits<double>::quiet_NaN();
}

TrackScores ScoreTracks(std::span<const TrueScan> truth, std::span<const std::vector<TrackState>> tracks,
                        std::span<const std::vector<StatedAlert>> alerts, const ApproachLimits& limits) {
  if (truth.size() != tracks.size()) throw std::logic_error("as many scans of tracks as of truth are needed");
  if (!alerts.empty() && alerts.size() != truth.size()) throw std::logic_error("as many scans of alerts as of truth are needed, or none");
  TrackScores scores;
  if (truth.empty()) return scores;
  scores.num_runs = 1;
  // A scan lasts as long as it takes to the next.
  const double span_s = static_cast<double>(truth.back().utime_us - truth.front().utime_us) * 1e-6;
  scores.seconds = truth.size() > 1 ? span_s * static_cast<double>(truth.size()) / static_cast<double>(truth.size() - 1) : 0.0;
  Matcher matcher;
  std::vector<Matched> run;
  run.reserve(truth.size());
  for (std::size_t n = 0; n < truth.size(); ++n) run.push_back(matcher.Match(truth[n], tracks[n]));
  ScoreClear(truth, tracks, run, scores);
  ScoreIdentities(run, scores);
  scores.hota = HotaOf(truth, run);
  scores.trajectory_gospa = TrajectoryGospaOfRun(truth, tracks, run);
  for (const auto& [id, history] : HistoriesOf(truth, run, alerts)) ScoreHistory(history, limits, scores);
  std::ranges::stable_sort(scores.events, {}, &TrackEvent::utime_us);
  std::set<std::int64_t> raised;
  for (const auto& of_scan : alerts) {
    for (const auto& alert : of_scan) {
      if (alert.holds) raised.insert(alert.id);
    }
  }
  scores.num_alerts = static_cast<std::int64_t>(raised.size());
  return scores;
}

}  // namespace lookout::eval
