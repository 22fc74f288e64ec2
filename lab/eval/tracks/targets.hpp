// Targets for figures of runs, and the reached values.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "lab/eval/table.hpp"

namespace lookout::eval {

enum class Weather { kClear, kOpenWater, kWaves, kRain };
/// By the name of a scene: "open_water" is open water with crests; "waves", "rough" and "rain" are those; all others are clear.
Weather WeatherOf(const std::string& scene);

template <typename Scores>
struct Target {
  enum class Side { kAtLeast, kAtMost, kWithin };
  std::string what;
  Side side = Side::kAtMost;
  double value = 0.0;
  int decimals = 0;
  std::function<bool(const std::string& scene)> is_of;
  std::function<double(const Scores&)> figure;  // NaN: not shown
  bool is_of_each_scene = false;                // else of all runs together
  double most = 0.0;                            // of kWithin: from value to this

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

struct Reached {
  double all = std::numeric_limits<double>::quiet_NaN();    // of all runs, or of the worst scene
  double worst = std::numeric_limits<double>::quiet_NaN();  // of a scene
  std::string worst_scene;
};

/// @param rows    one of each scene
/// @param scores  what of a row the target is about
/// @param sum_of  of some rows, at least one: the same over all of them
template <typename Scores, typename Row, typename SumOf>
Reached ReachedBy(const Target<Scores>& target, const std::vector<Row>& rows, Scores Row::*scores, SumOf sum_of) {
  Reached reached;
  std::vector<Row> meant;
  for (const auto& row : rows) {
    if (!target.is_of(row.scene)) continue;
    meant.push_back(row);
    const double figure = target.figure(row.*scores);
    if (std::isnan(figure) || (!std::isnan(reached.worst) && !target.IsWorse(figure, reached.worst))) continue;
    reached.worst = figure;
    reached.worst_scene = row.scene;
  }
  if (target.is_of_each_scene) {
    reached.all = reached.worst;
  } else if (!meant.empty()) {
    reached.all = target.figure(sum_of(meant));
  }
  return reached;
}

/// Name, target, reached value, whether that is enough, and the worst scene.
template <typename Scores>
Table::Row TargetCells(const Target<Scores>& target, const Reached& reached) {
  return {target.what, target.Text(), NumberOrNever(reached.all, target.decimals), target.IsReachedBy(reached.all) ? "yes" : "MISSED",
          NumberOrNever(reached.worst, target.decimals) + " " + reached.worst_scene};
}

}  // namespace lookout::eval
