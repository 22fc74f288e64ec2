// Judges the alerts of a run, scan after scan, by true hulls and courses. ALERTS.md defines the verdicts.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "common/core/guard_sector.hpp"
#include "lab/eval/tracks/alert_scan.hpp"
#include "lab/eval/tracks/alert_scores.hpp"

namespace lookout::eval {

/// The alert limits of the boat's config.
struct AlertRules {
  double cpa_limit_m = 5.0;
  double look_ahead_s = 30.0;
  double time_to_act_s = 15.0;  // an alert with so much time left comes in time however long it took
  GuardZoneParams zone = {};    // range 0: none
};

/// A thing nearer than this to the place that an alert tells is the one that the alert means.
inline constexpr double kAlertGateM = 3.0;
/// So far beyond a limit an alert is still right, and from so far on it is far.
inline constexpr double kRightWithinM = 1.0;
inline constexpr double kFarBeyondM = 3.0;
/// An alert that ended no longer ago than this still stands for its thing; so long a danger has to be away to be another one.
inline constexpr double kOneDangerS = 10.0;
/// A danger: so far below the limit, for so long on end, seen by so many returns.
inline constexpr double kDangerBelowLimitM = 1.0;
inline constexpr double kDangerLastsS = 2.0;
inline constexpr int kDangerReturns = 5;
/// An alert comes in time within this.
inline constexpr double kInTimeS = 3.0;
/// Pieces of land and structures that are nearer to each other belong together.
inline constexpr double kOneLandM = 3.0;

class AlertJudge {
 public:
  explicit AlertJudge(const AlertRules& rules) : rules_(rules) {}

  /// The next scan. Cost: an approach of each thing that can come near (ApproachWithin).
  void Add(const AlertScan& scan);
  /// The end of the run: open alerts and dangers are counted.
  void Finish();

  const AlertScores& scores() const { return scores_; }

 private:
  // The truth about a thing at one scan.
  struct Look {
    std::int64_t utime_us = 0;
    TrueApproach approach;
    double zone_m = 0.0;       // the nearest point of the thing in the zone's sector, from the reference point; infinite: nothing
    double wide_zone_m = 0.0;  // in a wider sector
  };
  struct Evaluated {
    const AlertThing* thing = nullptr;
    Look look;
    double bearing_rad = 0.0;  // of the thing's nearest point
  };
  // An alert while it holds.
  struct Episode {
    AlertVerdict verdict = AlertVerdict::kNothing;
    AlertEvent event;
    bool is_warning = false;
    bool is_in_berth = false;  // when the alert came up
  };
  // The telling of a thing by an alert.
  struct Told {
    std::int64_t alert_id = 0;
    int group = 0;
    std::int64_t last_us = 0;
    double first_distance_m = 0.0;
    double bearing_rad = 0.0;
  };
  struct Teller {
    std::int64_t utime_us = 0;
    std::int64_t alert_id = 0;
    double until_limit_s = 0.0;
  };
  struct Danger {
    AlertEvent event;
    std::int64_t start_us = 0;
    std::optional<Teller> told;
  };
  // A condition that has held on end, but for short gaps.
  struct Span {
    std::int64_t start_us = 0;
    std::int64_t last_us = 0;
    bool has_begun = false;

    // @return whether it began anew
    bool Hold(std::int64_t now_us);
    bool HasLasted(std::int64_t now_us) const;
  };
  struct Watched {
    Span wanted;
    std::optional<Teller> told_in_span;
    AlertEvent first;  // at the start of the span
    std::optional<Danger> danger;
    Span turning;  // by the tangent alone
    bool is_turning_counted = false;
  };

  Evaluated Evaluate(const AlertScan& scan, const AlertThing& thing) const;
  const Evaluated* FindThing(const AlertScan& scan, const JudgedAlert& alert) const;
  AlertVerdict VerdictOf(const AlertScan& scan, const JudgedAlert& alert, const Evaluated* found) const;
  bool IsRepeated(const JudgedAlert& alert, const AlertThing& thing, std::int64_t now_us) const;
  AlertFault FaultOf(const JudgedAlert& alert, const Evaluated* found, AlertVerdict verdict) const;
  AlertEvent EventOf(const AlertScan& scan, const JudgedAlert& alert, const Evaluated* found, AlertVerdict verdict) const;
  void Raise(const AlertScan& scan, const JudgedAlert& alert, const Evaluated* found);
  void Tell(const AlertScan& scan, const JudgedAlert& alert, const Evaluated* found);
  void CountStanding(const AlertScan& scan, double passed_s);
  void FollowDangers(const AlertScan& scan);
  void FollowDanger(const AlertScan& scan, const Evaluated& one, Watched& watched);
  void CloseEpisode(Episode episode);
  void CloseDanger(Watched& watched, std::int64_t now_us);

  AlertRules rules_;
  AlertScores scores_;
  std::optional<std::int64_t> first_us_;
  std::int64_t now_us_ = 0;     // of the last scan that was judged
  std::int64_t newest_us_ = 0;  // of the last scan
  bool has_run_in_ = false;
  std::vector<Evaluated> evaluated_;          // of this scan
  std::map<int, std::deque<Look>> looks_;     // by thing: of the last scans
  std::map<std::int64_t, Episode> episodes_;  // by alert: alerts that hold
  std::vector<Told> told_;                    // of the last seconds
  std::map<int, std::int64_t> teller_of_;     // by thing: the alert that tells it in this scan
  std::map<int, Watched> watched_;            // by thing
};

}  // namespace lookout::eval
