// Whether a log and a truth are of the same run, and how much of it they have in common.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>

#include "common/messages/scan_collector.hpp"
#include "lab/eval/metrics.hpp"
#include "lab/eval/truth.hpp"
#include "lookout/pose_t.hpp"

namespace lookout::eval {

/// How well scans agree with a truth, of returns that are looked up.
struct ReturnMatch {
  std::int64_t num_scans = 0;
  std::int64_t num_returns = 0;
  std::int64_t num_found = 0;     // the truth has a return of the same laser and time
  std::int64_t num_agreeing = 0;  // and of the same range, where the truth states one
};

class TruthMatch {
 public:
  /// @param truth  outlives this
  explicit TruthMatch(const Truth& truth);

  /// Whether a scan lies in the time of the truth. A scan outside is not scored.
  bool Holds(std::int64_t scan_utime_us) const;

  /// Counts a scan of the log, scored or not. @param scan_utime_us  in the order of the log
  void Count(std::int64_t scan_utime_us);

  /// A scan that is scored.
  void Add(const messages::ScanMessages& scan);
  void Add(const pose_t& pose);

  /// @param log, truth  names for people
  /// @return why the two do not belong together, with numbers; empty where they do
  std::string Fault(const std::string& log, const std::string& truth) const;

  /// @return "the log covers 4.0 s of the 10.0 s of the truth (40 %)", and how many scans were left out; empty where it covers all
  std::string Coverage() const;

 private:
  // Looks for the returns of a scan by their times; where those do not agree to a microsecond, as the lidar's clock was not that of the truth, by
  // their direction within some of its time.
  void MatchByTime(const lidar_scan_t& scan, ReturnMatch& match) const;
  void MatchByDirection(const lidar_scan_t& scan, ReturnMatch& match) const;

  const Truth& truth_;
  std::optional<TruthSpan> span_;
  std::int64_t num_scans_within_ = 0;
  std::int64_t num_scans_outside_ = 0;
  std::optional<std::int64_t> last_utime_us_;
  std::optional<TruthSpan> log_span_;     // of its scans
  std::optional<TruthSpan> scored_span_;  // of the scored scans
  ReturnMatch by_time_;
  ReturnMatch by_direction_;
  Summary pose_distance_m_;
};

}  // namespace lookout::eval
