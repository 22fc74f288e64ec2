#include "lab/eval/tracks/track_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lookout::eval {
namespace {

constexpr double kSecondsOfSwitches = 20.0;

// "never" where the time is infinite.
std::string Percentile(const Summary& summary, int percent, int decimals) {
  return summary.count() == 0 ? "-" : NumberOrNever(summary.Percentile(percent), decimals);
}

std::string Count(std::size_t count) { return Number(static_cast<std::int64_t>(count)); }

// In which ANEES lies in 95 of 100 cases where covariances are as stated: chi squared with two degrees of freedom for each thing, since errors of one
// thing hardly change from scan to scan. By E. B. Wilson and M. M. Hilferty, "The distribution of chi-square", PNAS 17 (1931).
std::string BandOf(std::int64_t num_things) {
  if (num_things == 0) return "-";
  constexpr double kTwoSided95 = 1.96;
  const double variance = 2.0 / (9.0 * 2.0 * static_cast<double>(num_things));
  const auto at = [&](double deviations) { return std::pow(1.0 - variance + deviations * std::sqrt(variance), 3.0); };
  return fmt::format("{}-{}", Number(std::max(at(-kTwoSided95), 0.0), 2), Number(at(kTwoSided95), 2));
}

void Add(TrackRun::Row& sum, const TrackRun::Row& row) {
  sum.scores.Add(row.scores);
  sum.labels.segments.Add(row.labels.segments);
  sum.labels.single.Add(row.labels.single);
  sum.labels.by_tracks.Add(row.labels.by_tracks);
}

// A scene counts as one, however many scans it has.
void AddValue(Mean& sum, const Mean& of_scene) {
  if (of_scene.count > 0) sum.Add(of_scene.value());
}

NamedTable Identities(const std::vector<TrackRow>& rows) {
  Table table({"scene", "tracker", "runs", "minutes", "MOTA_%", "IDF1_%", "HOTA_%", "DetA_%", "AssA_%", "missed_%", "false_%", "switches_20s",
               "no_switch_%", "false_tracks_h", "doubles_%", "ids_per_track"});
  for (const auto& [scene, row] : rows) {
    const auto& scores = row.scores;
    table.Add({scene, row.tracker, Number(scores.num_runs), Number(scores.seconds / 60.0, 2), Percent(scores.Mota()), Percent(scores.Idf1()),
               Percent(scores.hota.Value()), Percent(scores.hota.Detection()), Percent(scores.hota.Association()),
               Percent(ShareOf(scores.num_missed, scores.num_expected)), Percent(ShareOf(scores.num_false, scores.num_expected)),
               Number(static_cast<double>(scores.num_switches) * kSecondsOfSwitches / scores.seconds, 2),
               Percent(ShareOf(scores.num_runs_without_switch, scores.num_runs), 0), Number(scores.FalseTracksPerHour(), 0),
               Percent(scores.has_double.value(), 2), Number(scores.IdsPerTrack(), 2)});
  }
  return {"tracks_identities", "tracks: who is who (things in the water with 5 returns or more)", std::move(table)};
}

NamedTable Distances(const std::vector<TrackRow>& rows) {
  Table table({"scene", "tracker", "GOSPA_m", "localisation_m", "missed_m", "false_m", "T-GOSPA_m", "switching_m"});
  for (const auto& [scene, row] : rows) {
    const auto& gospa = row.scores.gospa;
    const auto& trajectories = row.scores.trajectory_gospa;
    table.Add({scene, row.tracker, Number(gospa.Rms(), 2), Number(gospa.LocalisationRms(), 2), Number(gospa.MissedRms(), 2),
               Number(gospa.FalseRms(), 2), Number(trajectories.Rms(), 2), Number(trajectories.SwitchRms(), 2)});
  }
  return {"tracks_gospa", "tracks: distance to the truth (the same things)", std::move(table)};
}

NamedTable Times(const std::vector<TrackRow>& rows) {
  Table table({"scene", "tracker", "things_5+", "confirmed_median_s", "confirmed_95_s", "things_1-4", "confirmed_median_s", "confirmed_95_s",
               "buoys_near", "in_2s_%", "hidden", "found_again_%"});
  for (const auto& [scene, row] : rows) {
    const auto& [many, few] = row.scores.confirmed_s;
    table.Add({scene, row.tracker, Count(many.count()), Percentile(many, 50, 2), Percentile(many, 95, 2), Count(few.count()), Percentile(few, 50, 2),
               Percentile(few, 95, 2), Number(row.scores.near_buoy_tracked.count), Percent(row.scores.near_buoy_tracked.value(), 0),
               Number(row.scores.num_hidden), Percent(ShareOf(row.scores.num_found_again, row.scores.num_hidden), 0)});
  }
  return {"tracks_times", "tracks: from the first return to the first track, and found again after 1 to 10 s", std::move(table)};
}

NamedTable States(const std::vector<TrackRow>& rows) {
  Table table({"scene", "tracker", "standing", "standing_mps", "called_moving", "moving_scans", "speed_95_mps", "course_95_deg", "called_standing_%",
               "centre_median_m", "ANEES_position", "band_95", "ANEES_velocity", "bad_covariances"});
  for (const auto& [scene, row] : rows) {
    const auto& scores = row.scores;
    table.Add({scene, row.tracker, Number(scores.num_standing), Number(scores.standing_speed_mps.value(), 3), Number(scores.num_called_moving),
               Count(scores.speed_error_mps.count()), Percentile(scores.speed_error_mps, 95, 2), Percentile(scores.course_error_deg, 95, 1),
               Percent(scores.called_standing.value()), Percentile(scores.center_error_m, 50, 2), Number(scores.position_nees.value(), 2),
               BandOf(scores.num_things_with_covariance), Number(scores.velocity_nees.value(), 2), Number(scores.num_bad_covariances)});
  }
  return {"tracks_states", "tracks: where things are and how they move", std::move(table)};
}

NamedTable Approaches(const std::vector<TrackRow>& rows) {
  Table table({"scene", "tracker", "crossings", "untracked", "turning", "cpa_m", "tcpa_s", "probabilities", "calibration", "passes",
               "warned_ahead_least_s", "warned_after_most_s", "alerts"});
  for (const auto& [scene, row] : rows) {
    const auto& scores = row.scores;
    table.Add({scene, row.tracker, Number(scores.num_crossings), Number(scores.num_crossings_untracked), Number(scores.num_crossings_turning),
               Number(scores.cpa_error_m.value(), 2), Number(scores.tcpa_error_s.value(), 2), Number(scores.calibration.count()),
               Number(scores.calibration.Error(), 3), Count(scores.warned_ahead_s.count()), Percentile(scores.warned_ahead_s, 0, 1),
               Percentile(scores.warned_after_s, 100, 1), Number(scores.num_alerts)});
  }
  return {"tracks_approaches", "tracks: closest approach, and what was warned of", std::move(table)};
}

// A row for the labels of single scans, which are the same for all trackers, then one for each tracker.
NamedTable Labels(const std::vector<TrackRow>& rows) {
  Table table({"scene", "labels", "scans (all: scenes)", "land_apart_%", "mIoU_%", "gain", "land_%", "land_too_many", "lost_%", "PQ_%", "SQ_%",
               "RQ_%", "OSE", "USE"});
  const auto add = [&table](const std::string& scene, const std::string& labels, const LabelFigures& figures, const std::string& apart,
                            const std::string& gain) {
    table.Add({scene, labels, Number(figures.iou.count), apart, Percent(figures.iou.value()), gain, Percent(figures.land_iou.value()),
               Number(figures.land_too_many.value(), 1), Percent(figures.lost.value()), Percent(figures.panoptic_quality.value()),
               Percent(figures.segmentation_quality.value()), Percent(figures.recognition_quality.value()), Number(figures.over_entropy.value(), 2),
               Number(figures.under_entropy.value(), 2)});
  };
  std::string last_scene;
  for (const auto& [scene, row] : rows) {
    if (row.labels.segments.count == 0) continue;
    if (scene != last_scene) add(scene, "single scans", row.labels.single, Percent(row.labels.segments.value()), "-");
    last_scene = scene;
    add(scene, row.tracker, row.labels.by_tracks, "-", Percent(row.labels.Gain()));
  }
  return {"tracks_labels", "labels of returns: of single scans (SEGMENTS) and by tracks", std::move(table)};
}

}  // namespace

std::vector<TrackRow> AddUp(const std::vector<TrackRow>& runs) {
  std::vector<TrackRow> rows;
  for (const auto& run : runs) {
    const auto same = std::ranges::find_if(rows, [&](const TrackRow& row) { return row.scene == run.scene && row.row.tracker == run.row.tracker; });
    if (same == rows.end()) {
      rows.push_back(run);
    } else {
      Add(same->row, run.row);
    }
  }
  return rows;
}

std::vector<TrackRow> OverAll(const std::vector<TrackRow>& rows, const std::string& name) {
  std::vector<TrackRow> all;
  for (const auto& [scene, row] : rows) {
    auto same = std::ranges::find_if(all, [&row = row](const TrackRow& one) { return one.row.tracker == row.tracker; });
    if (same == all.end()) same = all.insert(all.end(), {name, {row.tracker, {}, {}}});
    same->row.scores.Add(row.scores);
    AddValue(same->row.labels.segments, row.labels.segments);
    same->row.labels.single.AddValues(row.labels.single);
    same->row.labels.by_tracks.AddValues(row.labels.by_tracks);
  }
  return all;
}

NamedTable AblationTable(const std::vector<TrackRow>& rows) {
  Table table({"scenes", "tracker", "MOTA_%", "IDF1_%", "no_switch_%", "false_tracks_h", "doubles_%", "confirmed_median_s", "called_moving",
               "speed_95_mps", "gain", "land_%", "lost_%"});
  for (const auto& [scene, row] : rows) {
    const auto& scores = row.scores;
    table.Add({scene, row.tracker, Percent(scores.Mota()), Percent(scores.Idf1()),
               Percent(ShareOf(scores.num_runs_without_switch, scores.num_runs), 0), Number(scores.FalseTracksPerHour(), 0),
               Percent(scores.has_double.value(), 2), Percentile(scores.confirmed_s.front(), 50, 1), Number(scores.num_called_moving),
               Percentile(scores.speed_error_mps, 95, 2), Percent(row.labels.Gain()), Percent(row.labels.by_tracks.land_iou.value()),
               Percent(row.labels.by_tracks.lost.value())});
  }
  return {"tracks_ablation", "tracks: what each part of the tracker is worth", std::move(table)};
}

NamedTable LeftOutTable(const std::vector<TrackRow>& rows) {
  auto labels = Labels(rows);
  return {"tracks_left_out", labels.title + ", with evidence that was fitted without the scene", std::move(labels.table)};
}

std::vector<NamedTable> TablesOf(const std::vector<TrackRow>& rows) {
  return {Identities(rows), Distances(rows), Times(rows), States(rows), Approaches(rows), Labels(rows)};
}

}  // namespace lookout::eval
