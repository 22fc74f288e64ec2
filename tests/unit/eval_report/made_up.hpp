// Results with known numbers, made by hand.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "lab/eval/methods/results.hpp"

namespace lookout::eval {

/// Four turns with two objects each, one of them in the water.
inline Score MadeUpScore(double iou, double time_ms) {
  Score score;
  score.iou = {4, 4 * iou};
  score.water_iou = {4, 4 * (iou - 0.05)};
  score.iou_by_kind = {{"buoy", {4, 4 * (iou - 0.05)}}, {"shore", {4, 4 * (iou + 0.05)}}};
  score.recall_by_range = {{0, {4, 4}}, {2, {4, 1}}};
  score.near_recall_by_kind = {{"buoy", {4, 3}}, {"shore", {4, 4}}};
  score.iou_by_range = {{0, {4, 4 * 0.625}}, {2, {4, 4 * iou}}};
  score.segments = {4, 12};
  score.false_segments = {4, 3};
  score.with_segment = {8, 7};
  score.over_segmented = {8, 1};
  score.under_segmented = {12, 3};
  score.true_positives = {1000, 937};
  score.time_ms = {time_ms, time_ms, time_ms, time_ms * 2};
  return score;
}

/// One ring of level beams, a column a degree.
///
/// @param object, label  of each column; where both are 0 there is no return
inline WorstScan MadeUpScan(const std::vector<std::int32_t>& object, const std::vector<std::int32_t>& label) {
  WorstScan worst;
  worst.scene = "rain";
  worst.seed = 7;
  worst.index = 3;
  worst.iou = 0.125;
  auto& scan = worst.truth.scan;
  scan.head.range_unit_m = 0.002;
  scan.head.rings.resize(1);
  for (std::size_t column = 0; column < object.size(); ++column) {
    scan.columns.azimuth_rad.push_back(static_cast<float>(static_cast<double>(column) * std::numbers::pi / 180.0));
    scan.columns.time_ns.push_back(0);
    scan.columns.range.push_back(object[column] == 0 && label[column] == 0 ? 0 : 5000);
    scan.columns.reflectivity.push_back(0);
  }
  worst.truth.object = object;
  worst.truth.objects = {{1, {"<Anna>", "kayak", true}}, {2, {"shore", "shore", false}}};
  worst.label = label;
  return worst;
}

inline Results MadeUpResults() {
  Results results;
  results.command = "lookout-eval --scenes 'dense' <&>";
  results.version = "1.2 \"test\"";
  results.computer = "a <b>computer</b>";
  results.scenes = {"dense", "open<water>", "rain"};
  results.first_seed = 5;
  results.num_seeds = 3;
  results.seconds = 2.0;
  Score empty_water;
  empty_water.segments = empty_water.false_segments = {4, 0};
  empty_water.time_ms = {0.5, 0.5, 0.5, 0.5};
  const auto add = [&](const std::string& name, double dense_iou, double rain_iou, double time_ms) {
    MethodResult method;
    method.method = name;
    method.by_scene = {{"dense", MadeUpScore(dense_iou, time_ms)}, {"open<water>", empty_water}, {"rain", MadeUpScore(rain_iou, time_ms)}};
    results.methods.push_back(method);
  };
  add("ours", 0.902, 0.802, 1.25);
  add("paper W=512", 0.307, 0.803, 0.75);
  add("paper W=512 without BFS", 0.2, 0.1, 30.0);
  results.methods[1].by_scene["dense"].components = {4, 460 * 4};
  results.methods[1].by_scene["rain"].components = {4, 461 * 4};
  results.methods[1].by_scene["open<water>"].components = {4, 462 * 4};
  results.methods[0].stage_ms = {{"cluster", {0.25, 0.5}}, {"project", {0.125, 0.125}}, {"zeal", {0.1}}};
  // Two segments of 0.05 and none of an object; a hundred of 0.85, and 80 are; one of 1, and it is. The other bins are empty.
  auto& ours = results.methods[0].by_scene["dense"];
  ours.confidence.segments = {{50, {2, 0, 0.1}}, {850, {100, 80, 85.0}}, {1000, {1, 1, 1.0}}};
  ours.confidence.num_scans = 4;
  ours.outcomes_by_kind["buoy"].count = {7, 0, 1, 0, 0, 0};
  ours.outcomes_by_kind["dock"].count = {5, 1, 0, 4, 0, 0};
  results.methods[0].worst = {MadeUpScan({1, 1, 1, 2, 0, 0, -1}, {1, 1, 2, 0, 3, 0, 0})};
  results.curves = {{"Test <1>", "distance, m", "segments", {{"e1 = 0.95", {{1.0, 2.0}, {2.0, 3.25}}}}, "own & sure from 6.3 m"}};
  results.projections = {{512, 0.902, 1563.0, 5580.0, 0.079, std::numeric_limits<double>::quiet_NaN()}};
  return results;
}

}  // namespace lookout::eval
