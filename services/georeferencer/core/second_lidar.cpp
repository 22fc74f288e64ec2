#include "services/georeferencer/core/second_lidar.hpp"

#include <algorithm>
#include <utility>

namespace lookout::georeferencer {

namespace {

// Between the last shot of a scan and the first of the next: a column or two.
constexpr std::chrono::milliseconds kBetweenScans(5);
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
  if (!began_ || (!ends_.empty() && end - ends_.back() > kSilence)) began_ = end;
  if (ends_.empty() || ends_.back() != end) ends_.push_back(end);
  for (const auto& segment : part.segments) segments_.push_back(segment);
  while (ends_.size() > 1 && (end - ends_.front() > kKept || ends_.size() > kMaxKept)) ends_.pop_front();
  while (!segments_.empty() && (end - segments_.front().time > kKept || segments_.size() > kMaxKept)) {
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
  std::vector<Segment> taken;
  std::deque<Segment> kept;
  const bool is_going_on = IsGoingOn(end_time);
  for (auto& segment : segments_) {
    if (segment.time > end_time) {
      kept.push_back(std::move(segment));
    } else if (!is_going_on || segment.time < time - kBetweenScans || taken.size() >= kMaxSegments) {
      ++num_dropped_;
    } else {
      segment.time = std::max(segment.time, time);
      taken.push_back(std::move(segment));
    }
  }
  segments_ = std::move(kept);
  num_taken_ += static_cast<std::int64_t>(taken.size());
  return taken;
}

}  // namespace lookout::georeferencer
