// Scores of tracks that need a thing's whole run: how soon it was tracked, how well, how it was warned of.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "lab/eval/tracks/track_matching.hpp"
#include "lab/eval/tracks/track_metrics.hpp"

namespace lookout::eval {

/// How one thing went over the run.
struct History {
  struct Moment {
    std::int64_t utime_us;
    const TrueThing* thing;
    const TrackState* track;  // nullptr = none
    const TrueScan* scan;
    const std::vector<StatedAlert>* alerts;  // nullptr = the tracker has none
  };
  std::vector<Moment> moments;  // at least one
};

/// Land apart, by id.
/// @param run     [scans]; of truth; outlives the result, as truth and alerts do
/// @param alerts  [scans], or empty
std::map<int, History> HistoriesOf(std::span<const TrueScan> truth, std::span<const Matched> run, std::span<const std::vector<StatedAlert>> alerts);

/// Adds what TrackScores has of confirmation, hiding, motion, errors, approaches and warnings.
void ScoreHistory(const History& history, const ApproachLimits& limits, TrackScores& scores);

}  // namespace lookout::eval
