#include "lab/eval/navigation/navigation_command.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "common/config/boat.hpp"
#include "common/core/angles.hpp"
#include "lab/eval/methods/figures.hpp"
#include "lab/eval/navigation/own_motion.hpp"
#include "lab/eval/navigation/pose_run.hpp"
#include "lab/eval/table.hpp"
#include "lab/sim/scene_file.hpp"

namespace lookout::eval {

namespace {

namespace fs = std::filesystem;

// Without the lidar's motion and with it, one after the other.
std::vector<PoseCase> Cases(const NavigationOptions& options) {
  sim::NavigationParams alone;
  alone.has_heading = false;
  const std::vector<PoseCase> sensors{{"RTK and two antennas, IMU", {}, true},
                                      {"RTK and two antennas", {}, false},
                                      {"standalone, IMU", sim::StandaloneNavigation(), true},
                                      {"standalone", sim::StandaloneNavigation(), false},
                                      {"receiver alone", alone, false}};
  std::vector<PoseCase> cases;
  for (const bool has_gap : {false, true}) {
    for (const auto& one : sensors) {
      for (const bool has_odometry : {false, true}) {
        auto& added = cases.emplace_back(one);
        added.has_odometry = has_odometry;
        if (!has_gap) continue;
        added.gap_begin_s = options.gap_begin_s;
        added.gap_end_s = options.gap_begin_s + options.gap_s;
      }
    }
  }
  return cases;
}

struct NavigationResults {
  std::vector<std::string> scenes;  // in the order of the plan
  std::map<std::string, OdometryScores> odometry;
  std::map<std::pair<std::string, std::size_t>, PoseScores> poses;  // by scene and case
};

std::string Decimals(double value, int decimals) { return Number(value, decimals); }

// Known %, way, drift, heading and errors of each motion; the header has the same order.
const std::vector<std::string> kMotionHeader{"known",   "way m",   "drift, % of the way", "heading, deg a minute", "rms forward mm",
                                             "port mm", "turn deg"};

std::vector<std::string> MotionCells(const OdometryScores& scores) {
  const auto known = static_cast<double>(scores.num_known);
  return {Percent(known / static_cast<double>(scores.num_scans)),    Decimals(scores.way_m, 0),
          Decimals(100.0 * scores.drift_m / scores.way_m, 2),        Decimals(60.0 * RadToDeg(scores.turned_rad) / scores.known_s, 2),
          Decimals(1e3 * std::sqrt(scores.forward_m2 / known), 1),   Decimals(1e3 * std::sqrt(scores.port_m2 / known), 1),
          Decimals(RadToDeg(std::sqrt(scores.turn_rad2 / known)), 3)};
}

Table::Row Joined(std::vector<std::string> first, const std::vector<std::string>& middle, const std::vector<std::string>& last) {
  first.insert(first.end(), middle.begin(), middle.end());
  first.insert(first.end(), last.begin(), last.end());
  return first;
}

NamedTable OdometryTable(const NavigationResults& results) {
  NamedTable named{"own_motion", "Own motion by the lidar (LIDAR_ODOMETRY) against the truth",
                   Table(Joined({"scene", "scans"}, kMotionHeader, {"NEES", "longest wrong s"}))};
  for (const auto& scene : results.scenes) {
    const auto& scores = results.odometry.at(scene);
    named.table.Add(Joined({scene, Number(scores.num_scans)}, MotionCells(scores),
                           {Decimals(scores.nees / static_cast<double>(scores.num_known), 2), Decimals(scores.longest_wrong_s, 1)}));
  }
  return named;
}

// A method in a scene.
struct MethodScores {
  std::string scene;
  std::string method;
  OdometryScores scores;
  double took_s = kNan;
};

NamedTable ComparisonTable(const std::vector<MethodScores>& results) {
  NamedTable named{"own_motion_kiss_icp", "Own motion by the lidar against the truth, beside KISS-ICP on the same scans",
                   Table(Joined({"scene", "scans", "method"}, kMotionHeader, {"longest wrong s", "ms a scan"}))};
  for (const auto& [scene, method, scores, took_s] : results) {
    named.table.Add(Joined({scene, Number(scores.num_scans), method}, MotionCells(scores),
                           {Decimals(scores.longest_wrong_s, 1), Decimals(1e3 * took_s / static_cast<double>(scores.num_scans), 1)}));
  }
  return named;
}

NamedTable GapTable(const NavigationResults& results, const std::vector<PoseCase>& cases) {
  NamedTable named{
      "gap", "POSE in the gap: all sentences but the IMU's are missing",
      Table({"scene", "sensors", "odometry", "on the earth", "heading deg 95 %", "position m 95 %", "at the end: known", "heading deg median",
             "position m median", "position m 95 %", "in the 95 % ellipse", "jump behind it m", "gated", "renewed", "odometry gated"})};
  for (const auto& scene : results.scenes) {
    for (std::size_t i = 0; i < cases.size(); ++i) {
      if (!cases[i].has_gap()) continue;
      const auto& scores = results.poses.at({scene, i});
      const auto num_placed = static_cast<double>(scores.position_errors_m.size());
      named.table.Add(
          {scene, cases[i].sensors, cases[i].has_odometry ? "with" : "without", Percent(num_placed / static_cast<double>(scores.num_poses)),
           Decimals(RadToDeg(PercentileOf(scores.heading_errors_rad, 0.95)), 2), Decimals(PercentileOf(scores.position_errors_m, 0.95), 2),
           fmt::format("{} of {}", scores.end_errors_m.size(), scores.jumps_m.size()),
           Decimals(RadToDeg(PercentileOf(scores.end_headings_rad, 0.5)), 2), Decimals(PercentileOf(scores.end_errors_m, 0.5), 2),
           Decimals(PercentileOf(scores.end_errors_m, 0.95), 2), Percent(static_cast<double>(scores.num_in_ellipse) / num_placed),
           Decimals(PercentileOf(scores.jumps_m, 1.0), 2), Number(scores.num_gated), Number(scores.num_renewed), Number(scores.num_gated_odometry)});
    }
  }
  return named;
}

NamedTable WholeTable(const NavigationResults& results, const std::vector<PoseCase>& cases) {
  NamedTable named{"whole", "POSE while nothing is missing, root mean squares",
                   Table({"scene", "sensors", "odometry", "on the earth", "position m", "velocity m/s", "heading deg", "in the 95 % ellipse", "gated",
                          "renewed", "odometry gated"})};
  for (const auto& scene : results.scenes) {
    for (std::size_t i = 0; i < cases.size(); ++i) {
      if (cases[i].has_gap()) continue;
      const auto& scores = results.poses.at({scene, i});
      const auto num_placed = static_cast<double>(scores.position_errors_m.size());
      named.table.Add({scene, cases[i].sensors, cases[i].has_odometry ? "with" : "without",
                       Percent(num_placed / static_cast<double>(scores.num_poses)), Decimals(RmsOf(scores.position_errors_m), 3),
                       Decimals(RmsOf(scores.velocity_errors_mps), 3), Decimals(RadToDeg(RmsOf(scores.heading_errors_rad)), 3),
                       Percent(static_cast<double>(scores.num_in_ellipse) / num_placed), Number(scores.num_gated), Number(scores.num_renewed),
                       Number(scores.num_gated_odometry)});
    }
  }
  return named;
}

fs::path KeptFile(const NavigationOptions& options, const std::string& scene, std::uint64_t seed) {
  if (options.kept_folder.empty()) return {};
  fs::create_directories(options.kept_folder);
  return options.kept_folder / fmt::format("{}-{}-{:.0f}.csv", scene, seed, options.plan.seconds);
}

// The motions of the scans whose motion the odometer knows; all others as unknown.
std::vector<OdometryMessage> WhereKnown(std::vector<OdometryMessage> motions, const std::vector<OdometryMessage>& odometer) {
  for (std::size_t i = 0; i < motions.size(); ++i) {
    if (odometer.at(i).message.status != lidar_odometry_t::STATUS_OK) motions[i].message.status = lidar_odometry_t::STATUS_UNKNOWN;
  }
  return motions;
}

int EvaluateBesideKissIcp(const NavigationOptions& options) {
  const auto boat = config::LoadBoat(options.config_folder);
  std::vector<MethodScores> results;
  ForEachRunWithProgress(options, [&](const fs::path& file, const std::string& name, std::uint64_t seed) {
    if (results.empty() || results.back().scene != name) {
      results.push_back({name, "odometer", {}, 0.0});
      results.push_back({name, "KISS-ICP", {}, 0.0});
      results.push_back({name, "KISS-ICP where odometer knows", {}, kNan});
    }
    const auto scene = sim::LoadScene(file, seed);
    const auto motions = CompareWithKissIcp(options.config_folder, scene, seed, options.plan.seconds);
    auto* rows = &results[results.size() - 3];
    rows[0].scores.Add(ScoreOdometry(motions.odometer, scene, boat));
    rows[0].took_s += motions.odometer_s;
    rows[1].scores.Add(ScoreOdometry(motions.kiss_icp, scene, boat));
    rows[1].took_s += motions.kiss_icp_s;
    rows[2].scores.Add(ScoreOdometry(WhereKnown(motions.kiss_icp, motions.odometer), scene, boat));
  });
  const std::vector<NamedTable> tables{ComparisonTable(results)};
  TableFiles files(options.csv_folder, tables, options.is_forced);
  PrintTables(tables, std::cout);
  files.Commit(tables);
  return EXIT_SUCCESS;
}

}  // namespace

int EvaluateNavigation(const NavigationOptions& options) {
  BeginRuns(options, false, "--navigation");
  if (options.has_kiss_icp) return EvaluateBesideKissIcp(options);
  if (options.gap_begin_s + options.gap_s + PoseScores::kBehindGapS > options.plan.seconds) {
    throw std::invalid_argument(fmt::format("--seconds: the gap of {:.0f} s begins at {:.0f} s, and {:.0f} s behind it are looked at", options.gap_s,
                                            options.gap_begin_s, PoseScores::kBehindGapS));
  }
  const auto cases = Cases(options);
  const auto boat = config::LoadBoat(options.config_folder);
  NavigationResults results;
  ForEachRunWithProgress(options, [&](const fs::path& file, const std::string& name, std::uint64_t seed) {
    if (results.scenes.empty() || results.scenes.back() != name) results.scenes.push_back(name);
    const auto scene = sim::LoadScene(file, seed);
    const auto motions = OdometryOf(options.config_folder, scene, seed, options.plan.seconds, KeptFile(options, name, seed));
    results.odometry[name].Add(ScoreOdometry(motions, scene, boat));
    for (std::size_t i = 0; i < cases.size(); ++i) {
      results.poses[{name, i}].Add(RunPose(options.config_folder, scene, boat, seed, options.plan.seconds, motions, cases[i]));
    }
  });
  const std::vector<NamedTable> tables{OdometryTable(results), GapTable(results, cases), WholeTable(results, cases)};
  TableFiles files(options.csv_folder, tables, options.is_forced);
  PrintTables(tables, std::cout);
  files.Commit(tables);
  return EXIT_SUCCESS;
}

}  // namespace lookout::eval
