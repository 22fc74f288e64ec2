// ALERTS of a run, message by message, beside its truth.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string_view>

#include "common/core/bytes.hpp"
#include "lab/eval/tracks/alert_judge.hpp"
#include "lab/eval/tracks/alert_truth.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/tracks_t.hpp"

namespace lookout::eval {

/// As much of an alert as is judged, without the place of its track. All that the judge knows of the wire is in here.
JudgedAlert ToJudgedAlert(const alert_t& alert);
/// That nobody looks, which no truth of things can judge.
bool IsOfWatch(const alert_t& alert);

class AlertRun {
 public:
  /// @param truth  outlives this; knows its objects by now
  AlertRun(const Truth& truth, Polygon own_hull_m, const AlertRules& rules, CountReturns count_returns);

  /// TRACKS and ALERTS; others are left out. @return false where the message cannot be used
  bool Add(std::string_view channel, Bytes bytes);
  void Finish();

  const AlertScores& scores() const { return scores_; }
  /// Whether a scan had a known position. Of these some are not judged: those in which the own boat lies within a thing, as under a pier.
  bool has_position() const { return judge_.scores().num_runs > 0; }

 private:
  bool OnTracks(const tracks_t& message);
  bool OnAlerts(const alerts_t& message);

  const Truth& truth_;
  Polygon own_hull_m_;
  CountReturns count_returns_;
  AlertJudge judge_;
  AlertScores scores_;  // when the run is finished
  MapOrigin origin_{};
  std::unique_ptr<AlertTruth> alert_truth_;
  std::map<std::int64_t, AlertTrackPlace> place_of_;  // by track: where TRACKS had it last
  std::set<std::int64_t> watch_alerts_;               // ids
  std::set<std::int64_t> early_alerts_;               // of those that were never judged
};

}  // namespace lookout::eval
