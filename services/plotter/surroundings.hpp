// The surroundings of the boat at the scan of TRACKS: returns of each lidar, outlines of tracks, and sectors into which nobody looked.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "common/core/cover_watch.hpp"
#include "common/core/health.hpp"
#include "common/core/pose.hpp"
#include "common/messages/checks.hpp"
#include "common/messages/part_assembler.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "lookout/segments_t.hpp"
#include "lookout/tracks_t.hpp"
#include "services/plotter/core/lidar_sight.hpp"
#include "services/plotter/core/sectors.hpp"

namespace lookout::plotter {

/// Distances are horizontal, from the boat's reference point where POSE was last. Own motion within the scan and since is taken out where POSE knows
/// position and heading in one frame, which need not be on the earth; where it never does, the returns are as the lidar saw them. A scan that begins
/// before the frame does counts as not looked.
class Surroundings {
 public:
  explicit Surroundings(const SurroundingsParams& params);

  /// @param lidar  0, or 1 for the second one
  void OnScan(std::size_t lidar, const lidar_scan_t& message);
  void OnLabels(std::size_t lidar, const segments_t& message);
  void OnPose(const Pose& pose);

  /// @param tracks  the parts of one scan, well-formed. Where LIDAR_SCAN or SEGMENTS of that scan did not come, nobody looked.
  Look LookAt(std::span<const tracks_t> tracks);

  void AppendTo(std::vector<Counter>& counters) const;

 private:
  static constexpr auto kCountNames = std::to_array<std::string_view>(
      {"looks", "looks_without_scan", "looks_without_pose", "looks_between_poses", "looks_inconsistent", "outlines_refused"});
  // The chain behind the lidar is a scan or two late.
  static constexpr std::size_t kMostScans = 4;

  template <typename Message>
  struct Whole {
    messages::PartAssembler<Message> parts;
    std::deque<std::vector<Message>> scans;  // the oldest first
    void Add(const Message& message);
    const std::vector<Message>* Find(std::int64_t utime_us, std::int64_t seq) const;
  };
  struct Lidar {
    LidarSightParams params;
    Whole<lidar_scan_t> scans;
    Whole<segments_t> labels;
    CoverWatch cover;
    std::optional<LidarSight> sight;
  };
  struct Found {
    const std::vector<lidar_scan_t>* scan = nullptr;
    const std::vector<segments_t>* labels = nullptr;
  };
  /// Transform of points in the vessel frame of an earlier time to horizontal places in the present vessel frame.
  struct ToNow {
    Eigen::Matrix<double, 2, 3> turn = Eigen::Matrix<double, 2, 3>::Identity();
    Eigen::Vector2d shift_m = Eigen::Vector2d::Zero();
    double turned_rad = 0.0;  // turn of the bow since then, clockwise
    bool is_known = true;     // the way since then is known; true also where no place is ever known
  };

  Found FirstOf(const tracks_t& tracks) const;
  Found SecondOf(const tracks_t& tracks) const;
  std::vector<bool> TakenSegments(const std::vector<segments_t>& labels, std::span<const tracks_t> tracks) const;
  ToNow ToNowFrom(const Pose* now, Utime time) const;
  void WatchForCovers(Lidar& lidar, const std::vector<lidar_scan_t>& scan);
  bool AddReturns(Lidar& lidar, const Found& found, const std::vector<bool>& is_taken, const Pose* now, Look& look);
  /// @return whether the own motion within the part is known
  bool AddPart(Lidar& lidar, const lidar_scan_t& scan, const segments_t& labels, const std::vector<bool>& is_taken, const Pose* now, Look& look);
  void AddTracks(std::span<const tracks_t> tracks, const Pose& now, bool has_returns, Look& look);
  void AddLand(const tracks_t& tracks, const Pose& now, Look& look);

  SurroundingsParams params_;
  std::vector<Lidar> lidars_;
  SectorSight sector_sight_;
  PoseHistory poses_;
  // Remembered land, as it was told last.
  struct Waterline {
    Utime time;
    Datum datum;
    std::vector<Eigen::Vector2d> cells_m;  // map, their middles
  };
  Waterline waterline_;
  Counts<kCountNames> counts_;
  Counts<messages::kScanFaults> scans_refused_;
  Counts<messages::kSegmentsFaults> labels_refused_;
};

}  // namespace lookout::plotter
