#include "lab/eval/tracks/track_targets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace lookout::eval {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

enum class Weather { kClear, kOpenWater, kWaves, kRain };

Weather WeatherOf(const std::string& scene) {
  const auto is = [&scene](std::string_view word) { return scene.find(word) != std::string::npos; };
  if (is("open_water")) return Weather::kOpenWater;
  if (is("waves") || is("rough")) return Weather::kWaves;
  return is("rain") ? Weather::kRain : Weather::kClear;
}

using Condition = std::function<bool(const TrackRow&)>;

Condition In(std::vector<Weather> weathers) {
  return [weathers = std::move(weathers)](const TrackRow& row) { return std::ranges::find(weathers, WeatherOf(row.scene)) != weathers.end(); };
}

bool IsAnyScene(const TrackRow& /*row*/) { return true; }

bool HasBlackBuoys(const TrackRow& row) { return row.scene.find("black_buoys") != std::string::npos; }

struct Target {
  enum class Side { kAtLeast, kAtMost, kWithin };
  std::string what;
  Side side = Side::kAtMost;
  double value = 0.0;
  int decimals = 0;
  Condition is_of;
  std::function<double(const TrackRun::Row&)> figure;  // NaN: not shown
  bool is_of_each_scene = false;                       // else of all runs together
  double most = 0.0;                                   // of kWithin: from value to this

  bool IsReachedBy(double reached) const {
    if (side == Side::kWithin) return reached >= value && reached <= most;
    return side == Side::kAtLeast ? reached >= value : reached <= value;
  }
  bool IsWorse(double one, double other) const {
    // As ratios: half of the least is as far off as twice the most.
    const auto excess = [this](double reached) { return std::max(value / reached, reached / most); };
    if (side == Side::kWithin) return excess(one) > excess(other);
    return side == Side::kAtMost ? one > other : one < other;
  }
  std::string Text() const {
    if (side == Side::kWithin) return Number(value, decimals) + " to " + Number(most, decimals);
    return (side == Side::kAtLeast ? ">= " : "<= ") + Number(value, decimals);
  }
};

// Infinite: never.
double PercentileOf(const Summary& summary, int percent) { return summary.count() > 0 ? summary.Percentile(percent) : kNan; }

double GainOf(const TrackRun::Row& row) { return 100.0 * row.labels.Gain(); }

std::vector<Target> Targets() {
  using Side = Target::Side;
  using Row = TrackRun::Row;
  const auto clear = In({Weather::kClear, Weather::kOpenWater});
  const auto rough = In({Weather::kWaves, Weather::kRain});
  const auto mota = [](const Row& row) { return 100.0 * row.scores.Mota(); };
  const auto idf1 = [](const Row& row) { return 100.0 * row.scores.Idf1(); };
  const auto false_tracks = [](const Row& row) { return row.scores.FalseTracksPerHour(); };
  const auto confirmed = [](std::size_t kind, int percent) {
    return [kind, percent](const Row& row) { return PercentileOf(row.scores.confirmed_s.at(kind), percent); };
  };
  std::vector<Target> targets{
      {"MOTA, %", Side::kAtLeast, 98.0, 1, clear, mota},
      {"MOTA in waves and rain, %", Side::kAtLeast, 96.0, 1, rough, mota},
      {"IDF1, %", Side::kAtLeast, 98.0, 1, clear, idf1},
      {"IDF1 in waves and rain, %", Side::kAtLeast, 96.0, 1, rough, idf1},
      {"runs without a switch of identity, %", Side::kAtLeast, 95.0, 0, IsAnyScene,
       [](const Row& row) { return 100.0 * ShareOf(row.scores.num_runs_without_switch, row.scores.num_runs); }},
      {"false tracks an hour, clear", Side::kAtMost, 6.0, 0, In({Weather::kClear}), false_tracks},
      {"false tracks an hour, open water", Side::kAtMost, 6.0, 0, In({Weather::kOpenWater}), false_tracks},
      {"false tracks an hour, waves", Side::kAtMost, 30.0, 0, In({Weather::kWaves}), false_tracks},
      {"false tracks an hour, rain", Side::kAtMost, 30.0, 0, In({Weather::kRain}), false_tracks},
      {"scans in which a thing has two tracks, %", Side::kAtMost, 0.5, 2, IsAnyScene,
       [](const Row& row) { return 100.0 * row.scores.has_double.value(); }},
      {"greatest track number over tracks reported", Side::kAtMost, 1.5, 2, IsAnyScene, [](const Row& row) { return row.scores.IdsPerTrack(); }},
      {"confirmed, 5 returns or more, median, s", Side::kAtMost, 0.5, 2, IsAnyScene, confirmed(0, 50)},
      {"confirmed, 5 returns or more, 95 %, s", Side::kAtMost, 1.0, 2, IsAnyScene, confirmed(0, 95)},
      {"confirmed, 1 to 4 returns, median, s", Side::kAtMost, 2.0, 2, IsAnyScene, confirmed(1, 50)},
      {"confirmed, 1 to 4 returns, 95 %, s", Side::kAtMost, 4.0, 2, IsAnyScene, confirmed(1, 95)},
      {"black buoys tracked within 2 s of coming within 25 m, %", Side::kAtLeast, 90.0, 0, HasBlackBuoys,
       [](const Row& row) { return 100.0 * row.scores.near_buoy_tracked.value(); }},
      {"speed of standing things, mean, m/s", Side::kAtMost, 0.02, 3, IsAnyScene,
       [](const Row& row) { return row.scores.standing_speed_mps.value(); }},
      {"standing things called moving", Side::kAtMost, 0.0, 0, IsAnyScene,
       [](const Row& row) { return row.scores.num_standing > 0 ? static_cast<double>(row.scores.num_called_moving) : kNan; }},
      {"speed of moving things, 95 %, m/s", Side::kAtMost, 0.3, 2, IsAnyScene,
       [](const Row& row) { return PercentileOf(row.scores.speed_error_mps, 95); }},
      {"course of moving things, 95 %, deg", Side::kAtMost, 8.0, 1, IsAnyScene,
       [](const Row& row) { return PercentileOf(row.scores.course_error_deg, 95); }},
      {"centre of what is half seen, median, m", Side::kAtMost, 0.4, 2, IsAnyScene,
       [](const Row& row) { return PercentileOf(row.scores.center_error_m, 50); }},
      {"ANEES of position", Side::kWithin, 0.7, 2, IsAnyScene, [](const Row& row) { return row.scores.position_nees.value(); }, false, 1.4},
      {"ANEES of velocity", Side::kWithin, 0.7, 2, IsAnyScene, [](const Row& row) { return row.scores.velocity_nees.value(); }, false, 1.4},
      {"CPA 10 s before, mean, m", Side::kAtMost, 1.0, 2, IsAnyScene, [](const Row& row) { return row.scores.cpa_error_m.value(); }},
      {"TCPA 10 s before, mean, s", Side::kAtMost, 0.7, 2, IsAnyScene, [](const Row& row) { return row.scores.tcpa_error_s.value(); }},
      {"probabilities of CPA, error of calibration", Side::kAtMost, 0.05, 3, IsAnyScene,
       [](const Row& row) { return row.scores.calibration.Error(); }},
      {"found again with its id, %", Side::kAtLeast, 95.0, 1, IsAnyScene,
       [](const Row& row) { return 100.0 * ShareOf(row.scores.num_found_again, row.scores.num_hidden); }},
      {"labels by tracks: mIoU over single scans, points, mean", Side::kAtLeast, 2.5, 1, IsAnyScene, GainOf},
      {"labels by tracks: the same, least of a scene", Side::kAtLeast, 0.0, 1, IsAnyScene, GainOf, true},
      {"labels by tracks: mIoU of land, %", Side::kAtLeast, 95.0, 1, IsAnyScene,
       [](const Row& row) { return 100.0 * row.labels.by_tracks.land_iou.value(); }},
      {"labels by tracks: segments of land too many a scan", Side::kAtMost, 3.0, 1, IsAnyScene,
       [](const Row& row) { return row.labels.by_tracks.land_too_many.value(); }},
      {"single scans: segments of land too many a scan", Side::kAtMost, 3.0, 1, IsAnyScene,
       [](const Row& row) { return row.labels.single.land_too_many.value(); }},
      {"labels by tracks: things lost, %", Side::kAtMost, 4.0, 1, IsAnyScene,
       [](const Row& row) { return 100.0 * row.labels.by_tracks.lost.value(); }},
      {"single scans: things lost, %", Side::kAtMost, 4.0, 1, IsAnyScene, [](const Row& row) { return 100.0 * row.labels.single.lost.value(); }},
  };
  return targets;
}

struct Reached {
  double all = kNan;    // of all runs, or of the worst scene
  double worst = kNan;  // of a scene
  std::string worst_scene;
};

Reached ReachedBy(const Target& target, const std::vector<TrackRow>& scenes, const std::string& tracker) {
  Reached reached;
  std::vector<TrackRow> of_tracker;
  for (const auto& scene : scenes) {
    if (scene.row.tracker != tracker || !target.is_of(scene)) continue;
    of_tracker.push_back(scene);
    const double figure = target.figure(scene.row);
    if (std::isnan(figure) || (!std::isnan(reached.worst) && !target.IsWorse(figure, reached.worst))) continue;
    reached.worst = figure;
    reached.worst_scene = scene.scene;
  }
  if (target.is_of_each_scene) {
    reached.all = reached.worst;
  } else if (const auto all = OverAll(of_tracker, ""); !all.empty()) {
    reached.all = target.figure(all.front().row);
  }
  return reached;
}

}  // namespace

NamedTable TargetTable(const std::vector<TrackWorld>& worlds, const std::string& tracker, const std::string& other) {
  Table table({"world", "what", "target", tracker, "reached", "worst scene", other});
  for (const auto& world : worlds) {
    for (const auto& target : Targets()) {
      const auto reached = ReachedBy(target, world.scenes, tracker);
      if (std::isnan(reached.all)) continue;
      const auto beside = ReachedBy(target, world.scenes, other);
      table.Add(
          {world.name, target.what, target.Text(), NumberOrNever(reached.all, target.decimals), target.IsReachedBy(reached.all) ? "yes" : "MISSED",
           fmt::format("{} {}", NumberOrNever(reached.worst, target.decimals), reached.worst_scene), NumberOrNever(beside.all, target.decimals)});
    }
  }
  return {"tracks_targets", "tracks: targets (all runs together; labels: mean over the scenes)", std::move(table)};
}

}  // namespace lookout::eval
