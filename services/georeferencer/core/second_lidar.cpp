#include "services/georeferencer/core/second_lidar.hpp"

#include <algorithm>
#include <utility>

namespace lookout::georeferencer {

namespace {

// Between the last shot of a scan and the first of the next. With an azimuth window the head is dark for the rest of its turn.
constexpr std::chrono::milliseconds kBetweenScans(300);
constexpr std::size_t kMaxKept = 20'000;  // segments, and ends of scans
// A scan of the first may be that late.
constexpr std::chrono::seconds kKept(10);

}  // namespace

void SecondLidar::Add(const SegmentPart& part) {
  const Utime end = part.head.end_time;
  if (!ends_.empty() && end < ends_.back()) {
    // It began anew in the past.
    num_dropped_ += static_cast<std::int64_t>(segments_.size());
    segments_.clear();
    ends_.clear();
    began_.reset();
  }
  // A scan has come whole with its last part. One whose last part was lost is covered by the next.
  if (part.head.part_index == part.head.num_parts - 1) {
    if (!began_ || (!ends_.empty() && end - ends_.back() > kSilence)) began_ = end;
    if (ends_.empty() || ends_.back() != end) ends_.push_back(end);
  }
  for (const auto& segment : part.segments) segments_.push_back(segment);
  while (ends_.size() > 1 && (end - ends_.front() > kKept || ends_.size() > kMaxKept)) ends_.pop_front();
  while (!segments_.empty() && (end - segments_.front().time > kKept || segments_.size() > kMaxKept)) {
    // No scan of the first came so far.
    if (last_taken_ && end - segments_.front().time > kKept) ++num_untimely_;
    segments_.pop_front();
    ++num_dropped_;
  }
}

bool SecondLidar::IsGoingOn(Utime end_time) const {
  return began_ && !ends_.empty() && end_time >= *began_ + kSettled && end_time <= ends_.back() + kSilence;
}

bool SecondLidar::Holds(Utime end_time, Utime newest_pose) const {
  if (!IsGoingOn(end_time) || newest_pose >= end_time + kMaxWait) return false;
  const auto covering = std::ranges::lower_bound(ends_, end_time);
  // Corners of a segment may have been seen after it.
  return covering == ends_.end() || newest_pose < *covering;
}

std::vector<Segment> SecondLidar::Take(Utime time, Utime end_time) {
  if (last_taken_ && end_time < *last_taken_) last_taken_.reset();  // the first began anew in the past
  std::vector<Segment> taken;
  std::deque<Segment> kept;
  const bool is_going_on = IsGoingOn(end_time);
  const auto is_settled = [this](const Segment& segment) { return began_ && segment.time >= *began_ + kSettled; };
  for (auto& segment : segments_) {
    const bool is_too_late = last_taken_ && segment.time <= *last_taken_;  // the scan to which it belonged is gone
    if (segment.time > end_time) {
      kept.push_back(std::move(segment));
    } else if (!is_going_on || is_too_late || segment.time < time - kBetweenScans || taken.size() >= kMaxSegments) {
      ++num_dropped_;
      if (is_too_late && is_settled(segment)) ++num_untimely_;
    } else {
      taken.push_back(std::move(segment));
    }
  }
  segments_ = std::move(kept);
  last_taken_ = end_time;
  num_taken_ += static_cast<std::int64_t>(taken.size());
  return taken;
}

}  // namespace lookout::georeferencer
