// Recordings of the Autoferry sensor fusion data set (NTNU): lidar detections of a ferry, and where two boats truly were.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/core/geodesy.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/pose_t.hpp"

namespace lookout::importer {

/// Origin of its frame (north, east, down), from the data set's own description; heights are not in it.
/// Source: O. K. Helgesen et al., "Heterogeneous multi-sensor tracking for an autonomous surface vehicle in a littoral environment", Ocean
/// Engineering 252 (2022) 111168.
inline constexpr GeodeticPlace kAutoferryDatum{63.4389029083, 10.39908278, 0.0};

// Values that the files do not hold.
inline constexpr double kAutoferryDetectionSdM = 2.0;  // of a detection, along each axis: 2 m serve best in trackers that were tuned on these data
inline constexpr double kAutoferryOwnSdM = 0.5;        // of the own position, assumed: a receiver with corrections, and 0.1 s of the ferry's way
inline constexpr int kAutoferryReturns = 5;            // of a detection, assumed: the data's clustering kept no single returns

/// One scan of the lidar. Map frame at kAutoferryDatum: east, north.
struct FerryScan {
  std::int64_t utime_us = 0;
  Eigen::Vector2d own_m = Eigen::Vector2d::Zero();
  std::vector<Eigen::Vector2d> detections_m;  // on the map, not relative to the ferry
};

/// scenarioN_lidar_detections.json: a list, each with `time` (s since 1970), `ownshipPosition` (north, east) and `measurement`: detections relative
/// to the ferry, [[north ...], [east ...]], or [north, east] of a single one, or [] of none.
///
/// @return scans in the order of time, at least two
/// @throws std::runtime_error "file: reason"; times that do not grow, numbers that are out of range and larger files than 256 MiB are refused, too
std::vector<FerryScan> ReadFerryScans(const std::filesystem::path& file);

/// By target: places at times, in the order of time.
using FerryTruth = std::map<int, std::map<std::int64_t, Eigen::Vector2d>>;

/// scenarioN_ground_truth.json: a list of lists, each element with `targetID`, `position` (north, east, down) and `time`. @throws as ReadFerryScans
FerryTruth ReadFerryTruth(const std::filesystem::path& file);

/// Whether the file begins as scenarioN_lidar_detections.json does.
bool IsFerryScans(const std::filesystem::path& file);

/// A detection is a sure obstacle of one point, of status ok. In the vessel frame it stands as the course of the ferry has it (ToPoses).
std::vector<obstacles_t> ToObstacles(const std::vector<FerryScan>& scans);

/// The ferry every 20 ms, from a second before the first scan on: straight between scans, heading by the course over ground, as heading is not
/// measured; at a stand the last course, before the first way the course of the first metre.
std::vector<pose_t> ToPoses(const std::vector<FerryScan>& scans);

}  // namespace lookout::importer
