#include "services/georeferencer/core/georeferencer.hpp"

#include <algorithm>
#include <utility>

namespace lookout::georeferencer {

namespace {

// By ObstacleStatus.
constexpr std::array kObstacleCounts{"obstacles_ok", "obstacles_vessel_frame_only", "obstacles_pose_timeout"};

}  // namespace

Georeferencer::Georeferencer(const PlacementParams& placement, std::chrono::microseconds pose_timeout)
    : placement_(placement), pose_timeout_(pose_timeout) {}

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
      // A new run, in the past of the one before. Segments that wait and lie so far ahead of it belong to the old run.
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

bool Georeferencer::IsReady(const SegmentPart& part) const { return poses_.newest() != nullptr && poses_.newest()->time >= part.head.end_time; }

void Georeferencer::ReleaseReady(std::vector<ObstaclePart>& released) {
  while (!waiting_.empty() && IsReady(waiting_.front().part)) ReleaseFront(false, released);
}

void Georeferencer::ReleaseFront(bool has_timed_out, std::vector<ObstaclePart>& released) {
  const SegmentPart& part = waiting_.front().part;
  ObstaclePart& placed = released.emplace_back();
  placed.head = part.head;
  placed.datum = poses_.DatumAt(part.head.end_time);
  for (const auto& segment : part.segments) {
    if (segment.hull.size() > kMaxFootprintVertices) ++counts_["footprints_thinned"];
    if (segment.waterline.size() > kMaxWaterlineVertices) ++counts_["waterlines_thinned"];
    const auto& obstacle = placed.obstacles.emplace_back(PlaceSegment(segment, poses_, placed.datum, has_timed_out, placement_));
    counts_.Add(kObstacleCounts[static_cast<std::size_t>(obstacle.status)]);
  }
  ++counts_["parts_released"];
  waiting_.pop_front();
}

std::vector<Counter> Georeferencer::counters() const {
  auto counts = counts_;
  counts["parts_waiting"] = num_waiting();
  std::vector<Counter> counters;
  counts.AppendTo(counters);
  return counters;
}

}  // namespace lookout::georeferencer
