#include "services/ais/core/gatherer.hpp"

#include <algorithm>
#include <utility>

namespace lookout::ais {

Gatherer::Steps Gatherer::AddTime(Utime time) {
  Steps steps;
  nav_time_ = std::max(nav_time_.value_or(time), time);
  ReleaseReady(steps);
  return steps;
}

Gatherer::Steps Gatherer::Add(Item item) {
  Steps steps;
  if (item.is_start && nav_time_ && item.time < *nav_time_) {
    // The host's clock was set back: what waits is of the run before.
    Flush(steps);
    for (auto& early : items_) steps.push_back({.item = std::move(early)});
    items_.clear();
    nav_time_.reset();
    newest_.reset();
  }
  nav_time_ = std::max(nav_time_.value_or(item.time), item.time);
  items_.push_back(std::move(item));
  ReleaseReady(steps);
  while (items_.size() > kMostItems) {
    ++counts_["sentences_early"];
    steps.push_back({.item = std::move(items_.front())});
    items_.pop_front();
  }
  return steps;
}

Gatherer::Steps Gatherer::Add(const Pose& pose) {
  Steps steps;
  if (const Pose* newest = poses_.newest()) {
    if (pose.time == newest->time) {
      ++counts_["poses_duplicate"];
      return steps;
    }
    if (pose.time < newest->time) {
      ++counts_["pose_restarts"];
      poses_.Clear();
    }
  }
  ++counts_["poses_taken"];
  poses_.Add(pose);
  ReleaseReady(steps);
  return steps;
}

Gatherer::Steps Gatherer::Add(TracksOfScan scan) {
  Steps steps;
  if (newest_ && scan.end_time == *newest_) {
    ++counts_["scans_doubled"];
    return steps;
  }
  // The lidar began anew in the past.
  if (newest_ && scan.end_time < *newest_) Flush(steps);
  newest_ = scan.end_time;
  waiting_.push_back({std::move(scan), host_time_});
  ReleaseReady(steps);
  if (waiting_.size() > kMostWaiting) {
    ++counts_["scans_overflowed"];
    ReleaseFront(steps);
    ReleaseReady(steps);
  }
  return steps;
}

Gatherer::Steps Gatherer::AdvanceTo(Utime host_time) {
  Steps steps;
  host_time_ = host_time;
  // Scans that came before host time was known, or before the host's clock was set back, begin to wait now.
  for (auto& waiting : waiting_) waiting.arrival = std::min(waiting.arrival.value_or(host_time), host_time);
  while (!waiting_.empty() && host_time - *waiting_.front().arrival > timeout_) {
    ++counts_["scans_timed_out"];
    last_timeout_ = host_time;
    ReleaseFront(steps);
    ReleaseReady(steps);
  }
  return steps;
}

Gatherer::Steps Gatherer::Finish() {
  Steps steps;
  Flush(steps);
  return steps;
}

bool Gatherer::IsReady(const TracksOfScan& scan) const {
  return nav_time_ && *nav_time_ >= scan.end_time && poses_.newest() != nullptr && poses_.newest()->time >= scan.end_time;
}

void Gatherer::ReleaseReady(Steps& steps) {
  while (!waiting_.empty() && IsReady(waiting_.front().scan)) ReleaseFront(steps);
}

void Gatherer::ReleaseFront(Steps& steps) {
  auto scan = std::move(waiting_.front().scan);
  waiting_.pop_front();
  while (!items_.empty() && items_.front().time < scan.end_time) {
    steps.push_back({.item = std::move(items_.front())});
    items_.pop_front();
  }
  auto own = poses_.At(scan.end_time);
  ++counts_["scans_released"];
  if (!own) ++counts_["scans_without_pose"];
  steps.push_back({.scan = std::move(scan), .own = std::move(own)});
}

void Gatherer::Flush(Steps& steps) {
  while (!waiting_.empty()) {
    ++counts_["scans_flushed"];
    ReleaseFront(steps);
  }
}

std::vector<Counter> Gatherer::counters() const {
  auto counts = counts_;
  counts["scans_waiting"] = num_waiting();
  std::vector<Counter> counters;
  counts.AppendTo(counters);
  return counters;
}

}  // namespace lookout::ais
