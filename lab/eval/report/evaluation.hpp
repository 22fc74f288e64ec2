// Holds a log against the truth, scan by scan.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/messages/scan_collector.hpp"
#include "lab/eval/metrics.hpp"
#include "lab/eval/report/seen_footprint.hpp"
#include "lab/eval/truth.hpp"
#include "lookout/pose_t.hpp"

namespace lookout::eval {

/// Distances to the true outline.
struct Errors {
  Summary vertex_edge_m;       // of footprint vertices, to the line
  Summary vertex_outside_m;    // the same, 0 inside
  Summary position_outside_m;  // of obstacles, 0 inside

  void Add(const Errors& other);
};

/// An obstacle as a row of the first table.
struct ObstacleRow {
  obstacle_t obstacle;
  std::string object_name;                   // "?" = not known
  std::optional<double> position_outside_m;  // of the obstacle's centre
  std::optional<double> vertex_outside_m;    // greatest of the corners of the footprint
};

struct KindScore {
  Mean recall;  // share of the object-scans with enough returns that have a segment of their own
  Mean iou;     // of all object-scans with a return
};

class Evaluation {
 public:
  /// @param truth           may be nullptr; outlives this
  /// @param min_num_returns an object with fewer in a scan does not count for recall
  Evaluation(const Truth* truth, int min_num_returns);

  /// Where the lidar is on the boat. Without it, or without truth, `seen` stays empty.
  void SetMounting(const Eigen::Isometry3d& T_vessel_lidar) { T_vessel_lidar_ = T_vessel_lidar; }

  void Add(const messages::ScanMessages& scan);
  void Add(const pose_t& pose);

  std::int64_t num_scans = 0;
  std::int64_t num_whole_scans = 0;
  std::int64_t num_obstacles = 0;
  std::map<int, std::int64_t> num_by_status;
  std::optional<std::int64_t> table_utime_us;  // of the scan in `rows`: the last whole one, or the last
  std::vector<ObstacleRow> rows;

  // With truth:
  std::map<std::pair<std::string, bool>, Errors> errors_by_kind;  // kind, is_moving
  std::map<std::string, KindScore> scores_by_kind;
  Mean scan_iou;                       // of whole scans: mean over the objects
  Mean clutter_segments;               // per whole scan
  Mean sure_clutter_segments;          // sure ones among clutter segments
  Mean segments;                       // per whole scan
  std::int64_t num_returns = 0;        // of scans whose scan and segments are in the log
  std::int64_t num_joined = 0;         // returns that were found in the truth
  std::vector<SeenObstacle> seen;      // of status ok; in the order of their scans
  std::array<Summary, 4> pose_errors;  // horizontal m, heading deg, roll deg, pitch deg

 private:
  struct JoinedReturn {
    int label;
    std::int64_t time_ns;  // since utime_us of the scan
    int object_id;
    Eigen::Vector3f p_lidar_m;  // true
  };

  std::vector<JoinedReturn> Join(const messages::ScanMessages& scan);
  void Score(const messages::ScanMessages& scan, const Confusion::Matches& matches);
  void Measure(const messages::ScanMessages& scan, const Confusion::Matches& matches, const std::vector<JoinedReturn>& returns,
               std::vector<ObstacleRow>& scan_rows);
  void MeasureObstacle(const obstacles_t& message, const segment_t* segment, const std::vector<JoinedReturn>& returns, int object_id,
                       ObstacleRow& row);
  void MeasureSeen(const obstacles_t& message, const std::vector<JoinedReturn>& returns, int object_id, const obstacle_t& obstacle);
  const Outlines& OutlinesFor(const obstacles_t& message);

  const Truth* truth_;
  int min_num_returns_;
  std::array<double, 3> datum_{};  // of outlines_
  std::unique_ptr<Outlines> outlines_;
  std::unique_ptr<TruePoses> true_poses_;  // in the same map
  std::optional<Eigen::Isometry3d> T_vessel_lidar_;
  bool is_table_whole_ = false;
};

}  // namespace lookout::eval
