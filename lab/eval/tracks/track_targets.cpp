#include "lab/eval/tracks/track_targets.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <string_view>
#include <utility>

#include "lab/eval/tracks/targets.hpp"

namespace lookout::eval {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

using Condition = std::function<bool(const std::string& scene)>;

Condition In(std::vector<Weather> weathers) {
  return [weathers = std::move(weathers)](const std::string& scene) { return std::ranges::find(weathers, WeatherOf(scene)) != weathers.end(); };
}

bool IsAnyScene(const std::string& /*scene*/) { return true; }

bool HasBlackBuoys(const std::string& scene) { return scene.find("black_buoys") != std::string::npos; }

// Infinite: never.
double PercentileOf(const Summary& summary, int percent) { return summary.count() > 0 ? summary.Percentile(percent) : kNan; }

double GainOf(const TrackRun::Row& row) { return 100.0 * row.labels.Gain(); }

std::vector<Target<TrackRun::Row>> Targets() {
  using Row = TrackRun::Row;
  using Side = Target<Row>::Side;
  const auto clear = In({Weather::kClear, Weather::kOpenWater});
  const auto rough = In({Weather::kWaves, Weather::kRain});
  const auto mota = [](const Row& row) { return 100.0 * row.scores.Mota(); };
  const auto idf1 = [](const Row& row) { return 100.0 * row.scores.Idf1(); };
  const auto false_tracks = [](const Row& row) { return row.scores.FalseTracksPerHour(); };
  const auto confirmed = [](std::size_t kind, int percent) {
    return [kind, percent](const Row& row) { return PercentileOf(row.scores.confirmed_s.at(kind), percent); };
  };
  return {
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
}

std::vector<TrackRow> OfTracker(const std::vector<TrackRow>& rows, const std::string& tracker) {
  std::vector<TrackRow> of_tracker;
  std::ranges::copy_if(rows, std::back_inserter(of_tracker), [&](const TrackRow& row) { return row.row.tracker == tracker; });
  return of_tracker;
}

TrackRun::Row SumOfTracker(const std::vector<TrackRow>& rows) { return OverAll(rows, "").front().row; }

}  // namespace

Weather WeatherOf(const std::string& scene) {
  const auto is = [&scene](std::string_view word) { return scene.find(word) != std::string::npos; };
  if (is("open_water")) return Weather::kOpenWater;
  if (is("waves") || is("rough")) return Weather::kWaves;
  return is("rain") ? Weather::kRain : Weather::kClear;
}

NamedTable TargetTable(const std::vector<TrackWorld>& worlds, const std::string& tracker, const std::string& other) {
  Table table({"world", "what", "target", tracker, "reached", "worst scene", other});
  for (const auto& world : worlds) {
    const auto own = OfTracker(world.scenes, tracker);
    const auto others = OfTracker(world.scenes, other);
    for (const auto& target : Targets()) {
      const auto reached = ReachedBy(target, own, &TrackRow::row, SumOfTracker);
      if (std::isnan(reached.all)) continue;
      Table::Row row{world.name};
      std::ranges::move(TargetCells(target, reached), std::back_inserter(row));
      row.push_back(NumberOrNever(ReachedBy(target, others, &TrackRow::row, SumOfTracker).all, target.decimals));
      table.Add(std::move(row));
    }
  }
  return {"tracks_targets", "tracks: targets (all runs together; labels: mean over the scenes)", std::move(table)};
}

}  // namespace lookout::eval
