#include "lab/eval/tracks/alert_tables.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "common/core/angles.hpp"
#include "lab/eval/tracks/targets.hpp"

namespace lookout::eval {
namespace {

constexpr double kSecondsOfHour = 3600.0;
constexpr double kNoFigure = std::numeric_limits<double>::quiet_NaN();

double AnHour(std::int64_t count, const AlertScores& scores) {
  return scores.seconds > 0.0 ? static_cast<double>(count) * kSecondsOfHour / scores.seconds : kNoFigure;
}

double PerHour(double seconds, const AlertScores& scores) { return scores.seconds > 0.0 ? seconds * kSecondsOfHour / scores.seconds : kNoFigure; }

double DelayOf(const AlertScores& scores, int percent) { return scores.delay_s.count() > 0 ? scores.delay_s.Percentile(percent) : kNoFigure; }

NamedTable VerdictTable(const std::vector<AlertRow>& rows) {
  Table table({"scene", "runs", "hours", "alerts", "alerts_h", "right_h", "border_h", "far_h", "nothing_h", "repeated_h", "false_h", "repeated_%"});
  for (const auto& [scene, scores] : rows) {
    const auto rate = [&scores = scores](AlertVerdict verdict) { return Number(AnHour(scores.Num(verdict), scores), 1); };
    table.Add({scene, Number(scores.num_runs), Number(scores.seconds / kSecondsOfHour, 2), Number(scores.NumAlerts()),
               Number(AnHour(scores.NumAlerts(), scores), 1), rate(AlertVerdict::kRight), rate(AlertVerdict::kBorder), rate(AlertVerdict::kFar),
               rate(AlertVerdict::kNothing), rate(AlertVerdict::kRepeated), Number(AnHour(scores.NumFalse(), scores), 1),
               Percent(ShareOf(scores.Num(AlertVerdict::kRepeated), scores.NumAlerts()))});
  }
  return {"alerts_verdicts", "alerts: right and false, an hour", std::move(table)};
}

NamedTable LevelTable(const std::vector<AlertRow>& rows) {
  Table table({"scene", "level", "alerts", "right", "border", "far", "nothing", "repeated", "false_h"});
  for (const auto& [scene, scores] : rows) {
    for (const bool is_warning : {true, false}) {
      const auto count = [&scores = scores, is_warning](AlertVerdict verdict) { return Number(scores.Num(verdict, is_warning)); };
      table.Add({scene, is_warning ? "warning" : "caution", Number(scores.NumAlerts(is_warning)), count(AlertVerdict::kRight),
                 count(AlertVerdict::kBorder), count(AlertVerdict::kFar), count(AlertVerdict::kNothing), count(AlertVerdict::kRepeated),
                 Number(AnHour(scores.NumFalse(is_warning), scores), 1)});
    }
  }
  return {"alerts_levels", "alerts: the same by level, counted", std::move(table)};
}

NamedTable DangerTable(const std::vector<AlertRow>& rows) {
  Table table({"scene", "dangers", "in_time", "late", "missed", "delay_median_s", "delay_95_s"});
  for (const auto& [scene, scores] : rows) {
    table.Add({scene, Number(scores.NumDangers()), Number(scores.Num(DangerVerdict::kInTime)), Number(scores.Num(DangerVerdict::kLate)),
               Number(scores.Num(DangerVerdict::kMissed)), NumberOrNever(DelayOf(scores, 50), 1), NumberOrNever(DelayOf(scores, 95), 1)});
  }
  return {"alerts_dangers", "alerts: what was truly dangerous, and when it was told", std::move(table)};
}

NamedTable StandingTable(const std::vector<AlertRow>& rows) {
  Table table({"scene", "standing_mean", "standing_most", "warnings_mean", "scans_with_warning_%", "sound_s_h", "warning_sound_s_h", "sounding_s_h",
               "warning_sounding_s_h"});
  for (const auto& [scene, scores] : rows) {
    table.Add({scene, Number(scores.standing.value(), 2), Number(scores.most_standing), Number(scores.standing_warnings.value(), 2),
               Percent(scores.has_warning.value()), Number(PerHour(scores.sound_s, scores), 0), Number(PerHour(scores.warning_sound_s, scores), 0),
               Number(PerHour(scores.sounding_s, scores), 0), Number(PerHour(scores.warning_sounding_s, scores), 0)});
  }
  return {"alerts_standing", "alerts: how many stand at once, and how long they sound", std::move(table)};
}

NamedTable LeftOutTable(const std::vector<AlertRow>& rows) {
  Table table({"scene", "watch", "early", "open_dangers", "turning_dangers", "run_in_s"});
  for (const auto& [scene, scores] : rows) {
    table.Add({scene, Number(scores.num_watch_alerts), Number(scores.num_early_alerts), Number(scores.num_open_dangers),
               Number(scores.num_turning_dangers), Number(scores.run_in_s, 0)});
  }
  return {"alerts_left_out", "alerts: what is left out, since the truth does not know it", std::move(table)};
}

// Why alerts of each world are false or repeated, the most frequent cause first.
NamedTable FaultTable(const std::vector<AlertWorld>& worlds) {
  Table table({"world", "cause", "far", "nothing", "repeated", "of_false_%", "of_repeated_%", "most in"});
  for (const auto& world : worlds) {
    AlertScores sum;
    for (const auto& row : world.scenes) sum.Add(row.scores);
    const auto num_false = [](const AlertScores& scores, AlertFault fault) {
      return scores.Num(AlertVerdict::kFar, fault) + scores.Num(AlertVerdict::kNothing, fault);
    };
    const auto num_all = [&num_false](const AlertScores& scores, AlertFault fault) {
      return num_false(scores, fault) + scores.Num(AlertVerdict::kRepeated, fault);
    };
    std::vector<AlertFault> faults;
    for (std::size_t i = 1; i < kNumAlertFaults; ++i) {
      if (num_all(sum, static_cast<AlertFault>(i)) > 0) faults.push_back(static_cast<AlertFault>(i));
    }
    std::ranges::stable_sort(faults, std::greater{}, [&](AlertFault fault) { return num_all(sum, fault); });
    for (const auto fault : faults) {
      const auto worst = std::ranges::max_element(world.scenes, {}, [&](const AlertRow& row) { return num_all(row.scores, fault); });
      table.Add({world.name, std::string(NameOf(fault)), Number(sum.Num(AlertVerdict::kFar, fault)), Number(sum.Num(AlertVerdict::kNothing, fault)),
                 Number(sum.Num(AlertVerdict::kRepeated, fault)), Percent(ShareOf(num_false(sum, fault), sum.NumFalse()), 0),
                 Percent(ShareOf(sum.Num(AlertVerdict::kRepeated, fault), sum.Num(AlertVerdict::kRepeated)), 0), worst->scene});
    }
  }
  return {"alerts_causes", "alerts: why they are false or repeated, counted", std::move(table)};
}

std::vector<Target<AlertScores>> AlertTargets() {
  using Side = Target<AlertScores>::Side;
  const auto any = [](const std::string& /*scene*/) { return true; };
  const auto rough = [](const std::string& scene) { return WeatherOf(scene) == Weather::kWaves || WeatherOf(scene) == Weather::kRain; };
  const auto clear = [rough](const std::string& scene) { return !rough(scene); };
  const auto dense = [](const std::string& scene) { return scene.find("dense") != std::string::npos && scene.find("moored") == std::string::npos; };
  const auto marina = [](const std::string& scene) { return scene.find("marina") != std::string::npos; };
  const auto false_in_berth = [](const AlertScores& scores) {
    return scores.berth_s > 0.0 ? static_cast<double>(scores.num_false_in_berth) * kSecondsOfHour / scores.berth_s : kNoFigure;
  };
  const auto false_under_way = [](const AlertScores& scores) {
    const double under_way_s = scores.seconds - scores.berth_s;
    return under_way_s > 0.0 ? static_cast<double>(scores.NumFalse() - scores.num_false_in_berth) * kSecondsOfHour / under_way_s : kNoFigure;
  };
  const auto standing = [](const AlertScores& scores) { return scores.standing.value(); };
  return {
      {"false alerts an hour, moored", Side::kAtMost, 0.0, 1, any, false_in_berth},
      {"false alerts an hour, under way, clear", Side::kAtMost, 1.0, 1, clear, false_under_way},
      {"false alerts an hour, under way, waves and rain", Side::kAtMost, 6.0, 1, rough, false_under_way},
      {"repeated, % of all alerts", Side::kAtMost, 0.0, 1, any,
       [](const AlertScores& scores) { return 100.0 * ShareOf(scores.Num(AlertVerdict::kRepeated), scores.NumAlerts()); }},
      {"dangers missed, %", Side::kAtMost, 0.0, 1, any,
       [](const AlertScores& scores) { return 100.0 * ShareOf(scores.Num(DangerVerdict::kMissed), scores.NumDangers()); }},
      {"from when a danger can be known to its alert, median, s", Side::kAtMost, 0.5, 1, any,
       [](const AlertScores& scores) { return DelayOf(scores, 50); }},
      {"the same, 95 %, s", Side::kAtMost, 2.0, 1, any, [](const AlertScores& scores) { return DelayOf(scores, 95); }},
      {"alerts standing at once in dense, mean", Side::kAtMost, 2.0, 1, dense, standing},
      {"alerts standing at once in marina, mean", Side::kAtMost, 1.0, 1, marina, standing},
  };
}

AlertScores SumOf(const std::vector<AlertRow>& rows) {
  AlertScores sum;
  for (const auto& row : rows) sum.Add(row.scores);
  return sum;
}

NamedTable TargetsOf(const std::vector<AlertWorld>& worlds) {
  Table table({"world", "what", "target", "lookout", "reached", "worst scene", "hours"});
  for (const auto& world : worlds) {
    for (const auto& target : AlertTargets()) {
      const auto reached = ReachedBy(target, world.scenes, &AlertRow::scores, SumOf);
      if (std::isnan(reached.all)) continue;
      double seconds = 0.0;
      for (const auto& row : world.scenes) seconds += target.is_of(row.scene) ? row.scores.seconds : 0.0;
      Table::Row cells{world.name};
      std::ranges::move(TargetCells(target, reached), std::back_inserter(cells));
      cells.push_back(Number(seconds / kSecondsOfHour, 2));
      table.Add(std::move(cells));
    }
  }
  return {"alerts_targets", "alerts: targets (all runs together)", std::move(table)};
}

std::string NumberOrNothing(double value, int decimals) {
  if (std::isnan(value)) return {};
  return std::isinf(value) ? "inf" : Number(value, decimals);
}

}  // namespace

std::vector<AlertRow> AddUpAlerts(const std::vector<AlertRow>& runs) {
  std::vector<AlertRow> rows;
  for (const auto& run : runs) {
    auto same = std::ranges::find(rows, run.scene, &AlertRow::scene);
    if (same == rows.end()) same = rows.insert(rows.end(), {run.scene, {}});
    same->scores.Add(run.scores);
  }
  return rows;
}

std::vector<NamedTable> AlertTablesOf(const std::vector<AlertWorld>& worlds) {
  std::vector<AlertRow> rows;
  for (const auto& world : worlds) {
    rows.insert(rows.end(), world.scenes.begin(), world.scenes.end());
    rows.push_back({world.over_all, SumOf(world.scenes)});
  }
  return {TargetsOf(worlds), VerdictTable(rows), LevelTable(rows), FaultTable(worlds), DangerTable(rows), StandingTable(rows), LeftOutTable(rows)};
}

std::string AlertEventHeader() {
  return CsvRow({"scene",           "seed",
                 "second",          "verdict",
                 "level",           "cause",
                 "alert_id",        "track_id",
                 "thing",           "kind",
                 "true_distance_m", "true_approach_m",
                 "told_distance_m", "told_bearing_deg",
                 "delay_s",         "why",
                 "true_speed_mps",  "told_speed_mps",
                 "existence",       "text"});
}

std::string AlertEventRow(const std::string& scene, std::uint64_t seed, const AlertEvent& event) {
  return CsvRow({scene,
                 std::to_string(seed),
                 Number(event.second, 1),
                 event.what,
                 event.level,
                 event.cause,
                 Number(event.alert_id),
                 Number(event.track_id),
                 event.thing,
                 event.kind,
                 NumberOrNothing(event.distance_m, 2),
                 NumberOrNothing(event.approach_m, 2),
                 NumberOrNothing(event.told_distance_m, 2),
                 NumberOrNothing(RadToDeg(event.told_bearing_rad), 0),
                 NumberOrNothing(event.delay_s, 1),
                 std::string(NameOf(event.fault)),
                 NumberOrNothing(event.true_speed_mps, 1),
                 NumberOrNothing(event.told_speed_mps, 1),
                 NumberOrNothing(event.existence_probability, 2),
                 event.text});
}

}  // namespace lookout::eval
