// Brings together the messages of one scan from several channels, and waits for those still to come.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "common/core/elementary.hpp"
#include "common/core/health.hpp"
#include "common/core/pose.hpp"
#include "common/core/utime.hpp"
#include "services/tracker/core/scan.hpp"

namespace lookout::tracker {

/// Key of a scan: all its messages carry both.
struct ScanKey {
  Utime time;  // first firing
  std::int64_t seq = 0;

  friend bool operator==(const ScanKey&, const ScanKey&) = default;
  friend bool operator<(const ScanKey& one, const ScanKey& other) { return std::tie(one.time, one.seq) < std::tie(other.time, other.seq); }
};

/// Outline of an obstacle as the vessel sees it. That is known also where its place on the earth is not.
struct VesselOutline {
  std::int32_t segment_id = 0;
  bool is_sure = true;
  bool is_land = false;
  bool is_line = false;                                         // an open line: the waterline of land
  std::vector<Eigen::Vector2d> corners_m;                       // at least one
  Eigen::Vector2d nearest_m = Eigen::Vector2d::Constant(kNan);  // the nearest return
};

/// OBSTACLES of one scan.
struct ScanObstacles {
  ScanKey key;
  Utime end_time;
  std::int64_t raw_seq = 0;
  std::int32_t flags = 0;
  bool is_whole = true;  // all parts came
  Datum datum;
  std::vector<Seen> seen;               // obstacles with a place on the earth and a covariance
  std::vector<VesselOutline> outlines;  // of all obstacles
};

/// LIDAR_SCAN of one scan.
struct ScanBeams {
  ScanKey key;
  bool is_whole = true;
  Sweep sweep;  // its labels are not known yet
  int num_returns = 1;
  std::vector<std::uint8_t> nearest;  // [columns x rings] index of the shot's return that is the nearest, as in sweep.range_m
};

/// SEGMENTS of one scan: labels and pieces.
struct ScanLabels {
  ScanKey key;
  bool is_whole = true;
  int num_returns = 1;
  std::vector<std::int16_t> label;  // [columns x rings x returns]
  std::vector<std::int16_t> piece;  // the same; empty: each segment is one piece
};

/// A scan with all its messages.
struct GatheredScan {
  ScanInput input;
  std::int64_t raw_seq = 0;
  bool is_anew = false;  // lidar or navigator began anew: earlier tracks and poses count no more
  std::vector<VesselOutline> outlines;

  ScanKey key() const { return {input.time, input.seq}; }
};

/// A scan is released, in the order of OBSTACLES, once POSE has reached its last shot, and LIDAR_SCAN and SEGMENTS have come, or cannot come any
/// more, since a later scan of that channel has. The released scans depend on the order within each channel, not on how the channels interleave, as
/// long as AdvanceTo is not called (host time), time does not go back, and no channel is ahead of another by kMaxWaiting scans or
/// PoseHistory::kLength.
///
/// It begins with the first scan of which it has heard all: every part of every channel, and POSE since before its first shot. A gatherer that has
/// listened longer releases the same scans from that one on.
class Gatherer {
 public:
  /// Scans that wait: at 10 a second 6 s; 20 MB of a VLP-16.
  static constexpr std::size_t kMaxWaiting = 64;

  struct Sources {
    bool has_beams = true;   // whether LIDAR_SCAN will come at all
    bool has_labels = true;  // SEGMENTS
  };

  /// @param timeout  live only: how long a scan waits, by the host's clock
  Gatherer(const Sources& sources, std::chrono::microseconds timeout) : sources_(sources), timeout_(timeout) {}

  /// Each Add returns the scans that are released by it.
  std::vector<GatheredScan> Add(ScanObstacles obstacles);
  std::vector<GatheredScan> Add(ScanBeams beams);
  std::vector<GatheredScan> Add(ScanLabels labels);
  /// @param is_new_run  navigator began anew with this one
  std::vector<GatheredScan> Add(const Pose& pose, bool is_new_run);

  /// Live only: releases a scan that has waited longer than the timeout, with the messages that came; and a scan that waits for POSE alone when POSE
  /// has not come for as long.
  std::vector<GatheredScan> AdvanceTo(Utime host_time);

  /// End of input.
  std::vector<GatheredScan> Finish();

  std::int64_t num_waiting() const { return static_cast<std::int64_t>(waiting_.size()); }
  bool has_pose() const { return poses_.newest() != nullptr; }
  std::vector<Counter> counters() const;
  /// Host time at which a wait was given up last.
  std::optional<Utime> last_timeout() const { return last_timeout_; }

 private:
  enum class Arrival { kToCome, kHere, kNever };

  // The scans of one channel that nothing has used yet, in their order.
  template <typename Part>
  class Stream {
   public:
    void Add(Part part);
    Arrival Of(const ScanKey& key) const;
    // The message of this scan, if it is whole; earlier ones are of no use any more.
    std::optional<Part> Take(const ScanKey& key);

   private:
    std::deque<Part> parts_;
    std::optional<ScanKey> newest_;
  };

  struct Waiting {
    ScanObstacles obstacles;
    bool is_anew = false;
    std::optional<Utime> arrival;  // host time, where there is one
  };

  bool IsReady(const ScanObstacles& obstacles) const;
  bool HasSight(const ScanObstacles& obstacles) const;
  bool CanBegin(const ScanObstacles& obstacles) const;
  void ReleaseReady(std::vector<GatheredScan>& released);
  void ReleaseFront(bool is_given_up, std::vector<GatheredScan>& released);
  std::optional<Sweep> SweepOf(const ScanKey& key);
  std::optional<Pose> PoseAt(Utime time, const Datum& datum) const;

  static constexpr auto kCountNames =
      std::to_array<std::string_view>({"scans_released", "scans_doubled", "scans_late", "scans_timed_out", "scans_overflowed", "scans_flushed",
                                       "scans_before_begin", "scans_waiting", "scans_without_sight", "scans_without_pose", "scans_with_jump",
                                       "scans_incomplete", "labels_inconsistent", "runs_begun", "poses_taken", "poses_duplicate", "pose_restarts"});

  Sources sources_;
  std::chrono::microseconds timeout_;
  PoseHistory poses_;
  std::optional<Utime> oldest_pose_;   // since when POSE is heard
  std::deque<Utime> navigator_began_;  // anew, later than the last released scan
  Stream<ScanBeams> beams_;
  Stream<ScanLabels> labels_;
  std::deque<Waiting> waiting_;
  std::optional<ScanKey> newest_;  // of OBSTACLES
  bool has_begun_ = false;
  bool is_anew_ = false;  // to be told with the next released scan
  std::optional<Utime> host_time_;
  std::optional<Utime> pose_arrival_;  // of the last POSE, by host time; of one before host time was known, when that became known
  std::optional<Utime> last_timeout_;
  Counts<kCountNames> counts_;
};

}  // namespace lookout::tracker
