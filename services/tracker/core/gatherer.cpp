#include "services/tracker/core/gatherer.hpp"

#include <algorithm>
#include <iterator>

namespace lookout::tracker {

namespace {

// lidar_scan_t, FLAG_HOLE: something inside the scan was lost.
constexpr std::int32_t kFlagHole = 4;
// A scan that comes so soon behind a later one was overtaken; else the lidar has begun anew in the past.
constexpr std::chrono::seconds kOvertaken(2);
constexpr std::int64_t kOvertakenScans = 50;
// Scans that lie so far ahead of a POSE that goes back in time are of the run before.
constexpr std::chrono::seconds kOtherRun(10);

// Whether the position jumped within a scan: between the two nobody knows where the boat was.
bool HasJumped(const Pose& start, const Pose& end) {
  constexpr double kMostJumpM = 10.0;  // beyond what its speed explains
  constexpr double kMostOfSpeed = 3.0;
  const double speed_mps = start.velocity_map_mps.allFinite() ? start.velocity_map_mps.norm() : 0.0;
  const double way_m = (end.position_map_m - start.position_map_m).head<2>().norm();
  return !(way_m <= kMostJumpM + kMostOfSpeed * speed_mps * ToSeconds(end.time - start.time));
}

}  // namespace

template <typename Part>
void Gatherer::Stream<Part>::Add(Part part) {
  if (newest_ && part.key.time < newest_->time) parts_.clear();
  newest_ = part.key;
  parts_.push_back(std::move(part));
  if (parts_.size() > kMaxWaiting) parts_.pop_front();
}

template <typename Part>
Gatherer::Arrival Gatherer::Stream<Part>::Of(const ScanKey& key) const {
  if (std::ranges::find(parts_, key, &Part::key) != parts_.end()) return Arrival::kHere;
  return newest_ && newest_->time > key.time ? Arrival::kNever : Arrival::kToCome;
}

template <typename Part>
std::optional<Part> Gatherer::Stream<Part>::Take(const ScanKey& key) {
  const auto found = std::ranges::find(parts_, key, &Part::key);
  if (found == parts_.end()) return std::nullopt;
  std::optional<Part> part = std::move(*found);
  parts_.erase(parts_.begin(), found + 1);
  if (!part->is_whole) part.reset();
  return part;
}

std::vector<GatheredScan> Gatherer::Add(ScanObstacles obstacles) {
  std::vector<GatheredScan> released;
  const auto key = obstacles.key;
  bool is_anew = false;
  if (newest_) {
    if (key == *newest_) {
      ++counts_["scans_doubled"];
      return released;
    }
    const bool is_back = key.time <= newest_->time;
    if (is_back && key.seq > 0 && key.seq < newest_->seq && newest_->seq - key.seq < kOvertakenScans && newest_->time - key.time < kOvertaken) {
      ++counts_["scans_late"];
      return released;
    }
    is_anew = is_back || key.seq < newest_->seq;
    if (is_back) {
      while (!waiting_.empty()) {
        ++counts_["scans_flushed"];
        ReleaseFront(true, released);
      }
    }
  }
  newest_ = key;
  if (!obstacles.is_whole) ++counts_["scans_incomplete"];
  waiting_.push_back({std::move(obstacles), is_anew, host_time_});
  ReleaseReady(released);
  if (waiting_.size() > kMaxWaiting) {
    ++counts_["scans_overflowed"];
    ReleaseFront(true, released);
    ReleaseReady(released);
  }
  return released;
}

std::vector<GatheredScan> Gatherer::Add(ScanBeams beams) {
  std::vector<GatheredScan> released;
  beams_.Add(std::move(beams));
  ReleaseReady(released);
  return released;
}

std::vector<GatheredScan> Gatherer::Add(ScanLabels labels) {
  std::vector<GatheredScan> released;
  labels_.Add(std::move(labels));
  ReleaseReady(released);
  return released;
}

std::vector<GatheredScan> Gatherer::Add(const Pose& pose, bool is_new_run) {
  std::vector<GatheredScan> released;
  if (const Pose* newest = poses_.newest()) {
    if (pose.time == newest->time) {
      // A navigator that began anew within a period of POSE sends the last time of the one before once more.
      if (is_new_run) navigator_began_.push_back(pose.time);
      ++counts_["poses_duplicate"];
      return released;
    }
    if (pose.time < newest->time) {
      ++counts_["pose_restarts"];
      while (!waiting_.empty() && waiting_.front().obstacles.key.time - pose.time > kOtherRun) {
        ++counts_["scans_flushed"];
        ReleaseFront(true, released);
      }
      poses_.Clear();
      navigator_began_.clear();
      oldest_pose_ = pose.time;
      is_new_run = true;
    }
  }
  if (!oldest_pose_) oldest_pose_ = pose.time;
  ++counts_["poses_taken"];
  pose_arrival_ = host_time_;
  if (is_new_run) navigator_began_.push_back(pose.time);
  poses_.Add(pose);
  ReleaseReady(released);
  return released;
}

std::vector<GatheredScan> Gatherer::AdvanceTo(Utime host_time) {
  std::vector<GatheredScan> released;
  host_time_ = host_time;
  for (auto& waiting : waiting_) {
    // Scans that came before host time was known, or before the host's clock was set back, begin to wait now.
    waiting.arrival = std::min(waiting.arrival.value_or(host_time), host_time);
  }
  pose_arrival_ = std::min(pose_arrival_.value_or(host_time), host_time);
  // Where the navigator is gone, each scan would wait in vain.
  const bool is_silent = host_time - *pose_arrival_ > timeout_;
  const auto is_given_up = [&](const Waiting& front) { return host_time - *front.arrival > timeout_ || (is_silent && HasSight(front.obstacles)); };
  while (!waiting_.empty() && is_given_up(waiting_.front())) {
    ++counts_["scans_timed_out"];
    last_timeout_ = host_time;
    ReleaseFront(true, released);
    ReleaseReady(released);
  }
  return released;
}

std::vector<GatheredScan> Gatherer::Finish() {
  std::vector<GatheredScan> released;
  while (!waiting_.empty()) {
    ++counts_["scans_flushed"];
    ReleaseFront(true, released);
  }
  return released;
}

bool Gatherer::IsReady(const ScanObstacles& obstacles) const {
  return poses_.newest() != nullptr && poses_.newest()->time >= obstacles.end_time && HasSight(obstacles);
}

// Whether LIDAR_SCAN and SEGMENTS of the scan have come, or will not.
bool Gatherer::HasSight(const ScanObstacles& obstacles) const {
  const auto waits_for = [&obstacles](bool will_come, const auto& stream) {
    return will_come && obstacles.is_whole && stream.Of(obstacles.key) == Arrival::kToCome;
  };
  return !waits_for(sources_.has_beams, beams_) && !waits_for(sources_.has_labels, labels_);
}

bool Gatherer::CanBegin(const ScanObstacles& obstacles) const {
  const auto lacks = [&obstacles](bool will_come, const auto& stream) { return will_come && stream.Of(obstacles.key) != Arrival::kHere; };
  return obstacles.is_whole && oldest_pose_ && *oldest_pose_ <= obstacles.key.time && !lacks(sources_.has_beams, beams_) &&
         !lacks(sources_.has_labels, labels_);
}

void Gatherer::ReleaseReady(std::vector<GatheredScan>& released) {
  while (!waiting_.empty() && IsReady(waiting_.front().obstacles)) ReleaseFront(false, released);
}

void Gatherer::ReleaseFront(bool is_given_up, std::vector<GatheredScan>& released) {
  auto waiting = std::move(waiting_.front());
  waiting_.pop_front();
  auto& obstacles = waiting.obstacles;
  is_anew_ |= waiting.is_anew;
  while (!navigator_began_.empty() && navigator_began_.front() <= obstacles.end_time) {
    is_anew_ = true;
    navigator_began_.pop_front();
  }
  if (!has_begun_ && !is_given_up && !CanBegin(obstacles)) {
    ++counts_["scans_before_begin"];
    beams_.Take(obstacles.key);
    labels_.Take(obstacles.key);
    return;
  }
  has_begun_ = true;
  GatheredScan& scan = released.emplace_back();
  scan.raw_seq = obstacles.raw_seq;
  scan.is_anew = std::exchange(is_anew_, false);
  scan.outlines = std::move(obstacles.outlines);
  auto& input = scan.input;
  input.time = obstacles.key.time;
  input.end_time = obstacles.end_time;
  input.seq = obstacles.key.seq;
  input.flags = obstacles.flags | (obstacles.is_whole ? 0 : kFlagHole);
  input.datum = obstacles.datum;
  input.seen = std::move(obstacles.seen);
  input.own_at_start = PoseAt(input.time, input.datum);
  input.own = PoseAt(input.end_time, input.datum);
  if (input.own_at_start && input.own && HasJumped(*input.own_at_start, *input.own)) {
    ++counts_["scans_with_jump"];
    input.own.reset();
  }
  input.sweep = SweepOf(obstacles.key);
  // Obstacles in a lost part would count as not seen.
  if (!obstacles.is_whole) input.sweep.reset();
  ++counts_["scans_released"];
  if (!input.sweep) ++counts_["scans_without_sight"];
  if (!input.own) ++counts_["scans_without_pose"];
  if (scan.is_anew) ++counts_["runs_begun"];
}

std::optional<Sweep> Gatherer::SweepOf(const ScanKey& key) {
  auto beams = beams_.Take(key);
  const auto labels = labels_.Take(key);
  if (!beams) return std::nullopt;
  Sweep& sweep = beams->sweep;
  if (labels) {
    const auto num_returns = static_cast<std::size_t>(beams->num_returns);
    const bool is_fitting = labels->num_returns == beams->num_returns && labels->label.size() == num_returns * sweep.range_m.size() &&
                            (labels->piece.empty() || labels->piece.size() == labels->label.size());
    if (!is_fitting) {
      ++counts_["labels_inconsistent"];
    } else {
      const auto of_nearest = [&](const std::vector<std::int16_t>& of_cells) {
        std::vector<std::int16_t> of_shots(sweep.range_m.size());
        for (std::size_t i = 0; i < of_shots.size(); ++i) of_shots[i] = of_cells[i * num_returns + beams->nearest[i]];
        return of_shots;
      };
      sweep.label = of_nearest(labels->label);
      if (!labels->piece.empty()) sweep.piece = of_nearest(labels->piece);
    }
  }
  return std::move(sweep);
}

std::optional<Pose> Gatherer::PoseAt(Utime time, const Datum& datum) const {
  auto pose = poses_.At(time);
  if (pose && !(pose->is_placed && pose->datum.IsSameAs(datum))) pose.reset();
  return pose;
}

std::vector<Counter> Gatherer::counters() const {
  auto counts = counts_;
  counts["scans_waiting"] = num_waiting();
  std::vector<Counter> counters;
  counts.AppendTo(counters);
  return counters;
}

}  // namespace lookout::tracker
