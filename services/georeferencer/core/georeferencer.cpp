#include "services/georeferencer/core/georeferencer.hpp"

#include <algorithm>
#include <utility>

namespace lookout::georeferencer {

namespace {

// By ObstacleStatus.
constexpr std::array kObstacleCounts{"obstacles_ok", "obstacles_vessel_frame_only", "obstacles_pose_timeout"};

}  // namespace

Georeferencer::Georeferencer(const PlacementParams& placement, std::chrono::microseconds pose_timeout,
                             const std::optional<Eigen::Isometry3d>& T_vessel_lidar_2)
    : placement_(placement), pose_timeout_(pose_timeout) {
  if (!T_vessel_lidar_2) return;
  second_placement_ = placement;
  second_placement_->T_vessel_lidar = *T_vessel_lidar_2;
}

std::vector<ObstaclePart> Georeferencer::AddSecond(const SegmentPart& part) {
  std::vector<ObstaclePart> released;
  second_.Add(part);
  ReleaseReady(released);
  return released;
}

std::vector<ObstaclePart> Georeferencer::AddSegments(SegmentPart part) {
  std::vector<ObstaclePart> released;
  waiting_.push_back({std::move(part), host_time_});
  ReleaseReady(released);
  if (waiting_.size() > kMaxWaiting) {
    ++counts_["parts_overflowed"];
    ReleaseFront(true, released);
    ReleaseReady(released);
  }
  return released;
}

std::vector<ObstaclePart> Georeferencer::AddPose(const Pose& pose) {
  std::vector<ObstaclePart> released;
  if (const Pose* newest = poses_.newest()) {
    if (pose.time == newest->time) {
      ++counts_["poses_duplicate"];
      return released;
    }
    if (pose.time < newest->time) {
      // A new run of the navigator begins, in the past of the run before. Waiting segments farther ahead than PoseHistory::kLength belong to the old
      // run.
      ++counts_["pose_restarts"];
      while (!waiting_.empty() && waiting_.front().part.head.time - pose.time > PoseHistory::kLength) {
        ++counts_["parts_flushed"];
        ReleaseFront(false, released);
      }
      poses_.Clear();
    }
  }
  ++counts_["poses_taken"];
  pose_arrival_ = host_time_;
  poses_.Add(pose);
  ReleaseReady(released);
  return released;
}

std::vector<ObstaclePart> Georeferencer::AdvanceTo(Utime host_time) {
  std::vector<ObstaclePart> released;
  host_time_ = host_time;
  for (auto& waiting : waiting_) {
    // Segments that came before host time was known, or before the host's clock was set back, begin to wait now.
    waiting.arrival = std::min(waiting.arrival.value_or(host_time), host_time);
  }
  pose_arrival_ = std::min(pose_arrival_.value_or(host_time), host_time);
  // Where the navigator is gone, each scan would wait in vain.
  const bool is_silent = host_time - *pose_arrival_ > 2 * pose_timeout_;
  while (!waiting_.empty() && (is_silent || host_time - *waiting_.front().arrival > pose_timeout_)) {
    ++counts_["parts_timed_out"];
    last_timeout_ = host_time;
    ReleaseFront(true, released);
    ReleaseReady(released);
  }
  return released;
}

std::vector<ObstaclePart> Georeferencer::Finish() {
  std::vector<ObstaclePart> released;
  while (!waiting_.empty()) {
    ++counts_["parts_flushed"];
    ReleaseFront(false, released);
  }
  return released;
}

bool Georeferencer::IsReady(const SegmentPart& part) const {
  const auto* newest = poses_.newest();
  return newest != nullptr && newest->time >= part.head.end_time && !(second_placement_ && second_.Holds(part.head.end_time, newest->time));
}

void Georeferencer::ReleaseReady(std::vector<ObstaclePart>& released) {
  while (!waiting_.empty() && IsReady(waiting_.front().part)) ReleaseFront(false, released);
}

void Georeferencer::ReleaseFront(bool has_timed_out, std::vector<ObstaclePart>& released) {
  const SegmentPart part = std::move(waiting_.front().part);
  waiting_.pop_front();
  if (second_placement_ && part.head.part_index == 0) TakeSecond(part.head);
  const bool is_same_scan = second_placement_ && further_.head.seq == part.head.seq && further_.head.time == part.head.time;
  const bool is_furthered = is_same_scan && further_.num_segments > 0;
  ObstaclePart& placed = released.emplace_back();
  placed.head = part.head;
  if (is_same_scan) placed.head.scan_flags |= static_cast<std::int32_t>(further_.sight);
  if (is_furthered) {
    placed.head.num_parts += static_cast<std::int32_t>(further_.parts.size());
    placed.head.num_scan_segments += further_.num_segments;
  }
  const ScanHead head = placed.head;
  placed.datum = poses_.DatumAt(part.head.end_time);
  for (const auto& segment : part.segments) Place(segment, has_timed_out, placement_, placed);
  ++counts_["parts_released"];
  if (is_furthered && part.head.part_index == part.head.num_parts - 1) ReleaseSecond(head, has_timed_out, released);
}

void Georeferencer::Place(const Segment& segment, bool has_timed_out, const PlacementParams& placement, ObstaclePart& placed) {
  if (segment.hull.size() > kMaxFootprintVertices) ++counts_["footprints_thinned"];
  if (segment.waterline.size() > kMaxWaterlineVertices) ++counts_["waterlines_thinned"];
  const auto& obstacle = placed.obstacles.emplace_back(PlaceSegment(segment, poses_, placed.datum, has_timed_out, placement));
  counts_.Add(kObstacleCounts[static_cast<std::size_t>(obstacle.status)]);
}

void Georeferencer::TakeSecond(const ScanHead& head) {
  further_ = {.head = head, .parts = {}, .num_segments = 0, .sight = second_.SightDuring(head.time, head.end_time)};
  num_second_silent_ += further_.sight == SecondSight::kSilent ? 1 : 0;
  num_second_holes_ += further_.sight == SecondSight::kHole ? 1 : 0;
  for (auto& segment : second_.Take(head.time, head.end_time)) {
    // So few fit into one message, however large their outlines are.
    constexpr std::size_t kSegmentsOfPart = 18;
    segment.id = kSecondLidarId + ++further_.num_segments;
    if (further_.parts.empty() || further_.parts.back().size() >= kSegmentsOfPart) further_.parts.emplace_back();
    further_.parts.back().push_back(std::move(segment));
  }
}

// @param head  of the scan, with the counts of both
void Georeferencer::ReleaseSecond(const ScanHead& head, bool has_timed_out, std::vector<ObstaclePart>& released) {
  for (const auto& segments : further_.parts) {
    ObstaclePart placed;
    placed.head = head;
    placed.head.part_index = released.back().head.part_index + 1;
    placed.datum = released.back().datum;
    for (const auto& segment : segments) {
      Place(segment, has_timed_out, *second_placement_, placed);
      // It is placed by the time at which it was seen; on the wire the times of a scan lie within it.
      auto& obstacle = placed.obstacles.back();
      obstacle.time = std::max(obstacle.time, head.time);
    }
    counts_["obstacles_of_second"] += static_cast<std::int64_t>(segments.size());
    released.push_back(std::move(placed));
  }
  further_ = {};
}

std::vector<Counter> Georeferencer::counters() const {
  auto counts = counts_;
  counts["parts_waiting"] = num_waiting();
  counts["segments_of_second_dropped"] = second_.num_dropped();
  counts["segments_of_second_untimely"] = second_.num_untimely();
  std::vector<Counter> counters;
  counts.AppendTo(counters);
  if (second_placement_) {
    counters.push_back({"scans_without_second", num_second_silent_});
    counters.push_back({"scans_with_hole_of_second", num_second_holes_});
  }
  return counters;
}

}  // namespace lookout::georeferencer
