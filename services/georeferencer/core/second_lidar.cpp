#include "services/georeferencer/core/second_lidar.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
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
  if (!scans_.empty() && end < scans_.back().end) {
    // The second lidar began anew in the past.
    num_dropped_ += static_cast<std::int64_t>(segments_.size());
    segments_.clear();
    scans_.clear();
    began_.reset();
    seq_.reset();
  }
  NotePart(part);
  // A scan has come with its last part. A scan whose last part was lost is covered by the next scan.
  if (part.head.part_index == part.head.num_parts - 1) {
    if (!began_ || (!scans_.empty() && end - scans_.back().end > kSilence)) began_ = end;
    NoteReturns();
    if (scans_.empty() || scans_.back().end != end) scans_.push_back({end, is_whole_});
  }
  for (const auto& segment : part.segments) segments_.push_back(segment);
  while (scans_.size() > 1 && (end - scans_.front().end > kKept || scans_.size() > kMaxKept)) scans_.pop_front();
  while (!segments_.empty() && (end - segments_.front().time > kKept || segments_.size() > kMaxKept)) {
    // No scan of the first lidar reached the time of this segment.
    if (last_taken_ && end - segments_.front().time > kKept) ++num_untimely_;
    segments_.pop_front();
    ++num_dropped_;
  }
}

// A scan is whole where all its parts came in their order, directly after the last part of the scan before.
void SecondLidar::NotePart(const SegmentPart& part) {
  const auto& head = part.head;
  if (head.part_index == 0 || seq_ != head.seq) {
    is_whole_ = head.scan_flags == 0 && head.part_index == 0 && (!seq_ || (has_ended_ && head.seq == *seq_ + 1));
    next_part_ = 0;
    num_returns_ = 0;
  }
  num_returns_ += part.num_returns;
  is_whole_ = is_whole_ && head.part_index == next_part_;
  has_ended_ = head.part_index == head.num_parts - 1;
  seq_ = head.seq;
  ++next_part_;
}

// Called when the last part of a scan came: a dark scan is not whole.
void SecondLidar::NoteReturns() {
  if (darkness_.Add(num_returns_, kMostStrays)) is_whole_ = false;
}

bool SecondLidar::IsGoingOn(Utime end_time) const {
  return began_ && !scans_.empty() && end_time >= *began_ + kSettled && end_time <= scans_.back().end + kSilence;
}

bool SecondLidar::Holds(Utime end_time, Utime newest_pose) const {
  if (!IsGoingOn(end_time) || newest_pose >= end_time + kMaxWait) return false;
  const auto covering = std::ranges::lower_bound(scans_, end_time, {}, &Scan::end);
  // Corners of a segment may have been seen after it.
  return covering == scans_.end() || newest_pose < covering->end;
}

SecondSight SecondLidar::SightDuring(Utime time, Utime end_time) {
  if (last_taken_ && end_time < *last_taken_) first_time_.reset();  // the first began anew in the past
  if (!first_time_) first_time_ = time;
  if (end_time < *first_time_ + kExpected) return SecondSight::kWhole;
  const auto num_whole =
      std::ranges::count_if(scans_, [end_time](const Scan& scan) { return scan.is_whole && scan.end <= end_time && scan.end > end_time - kWithin; });
  if (!IsGoingOn(end_time) || num_whole < static_cast<std::ptrdiff_t>(kWholeScans)) return SecondSight::kSilent;
  // Scans of the second lidar count that began before this scan ended; while the first lidar is dark, also those since its last scan.
  const auto covering = std::ranges::lower_bound(scans_, end_time, {}, &Scan::end);
  const bool is_covered = covering != scans_.end() && covering->end <= end_time + kBetweenScans;
  const bool was_dark = last_taken_ && *last_taken_ < time && *last_taken_ >= time - kBetweenScans;
  const Utime since = was_dark ? *last_taken_ : time;
  const bool has_hole = std::any_of(scans_.begin(), is_covered ? std::next(covering) : covering,
                                    [since](const Scan& scan) { return scan.end > since && !scan.is_whole; });
  return has_hole || !is_covered ? SecondSight::kHole : SecondSight::kWhole;
}

std::vector<Segment> SecondLidar::Take(Utime time, Utime end_time) {
  if (last_taken_ && end_time < *last_taken_) last_taken_.reset();  // the first began anew in the past
  std::vector<Segment> taken;
  std::deque<Segment> kept;
  const bool is_going_on = IsGoingOn(end_time);
  const auto is_settled = [this](const Segment& segment) { return began_ && segment.time >= *began_ + kSettled; };
  for (auto& segment : segments_) {
    const bool is_too_late = last_taken_ && segment.time <= *last_taken_;  // the scan to which the segment belonged has gone out
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
