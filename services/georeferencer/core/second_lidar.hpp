// The segments of a second lidar, which go out with the scan of the first during which they were seen.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "common/core/cover_watch.hpp"
#include "common/core/utime.hpp"
#include "services/georeferencer/core/obstacle.hpp"

namespace lookout::georeferencer {

/// How the second lidar looks during a scan of the first. Numbers are those of the flags on the wire.
enum class SecondSight : std::int32_t {
  kWhole = 0,
  kHole = 8,     // something that it saw during the scan is lost, or has not come
  kSilent = 16,  // it does not look: kWholeScans whole scans did not come within kWithin
};

/// What it gives depends on measurement times alone, as long as SEGMENTS_2 come within kMaxWait of POSE.
class SecondLidar {
 public:
  /// A scan of the first waits for the second until POSE is so far ahead of it.
  static constexpr std::chrono::milliseconds kMaxWait{500};
  /// The second counts from so long after its first scan on, by which this has come for sure, until so long after its last.
  static constexpr std::chrono::seconds kSettled{1};
  static constexpr std::chrono::seconds kSilence{2};
  /// It is expected from so long after the first scan of the first lidar on.
  static constexpr std::chrono::seconds kExpected{3};
  /// It looks while so many whole scans ended within so long: as many as it takes to raise an alert.
  static constexpr std::size_t kWholeScans = 3;
  /// Nor does it look where it has become dark (common/core/cover_watch.hpp): so many returns of a scan and fewer are none.
  static constexpr std::int64_t kMostStrays = 20;
  static constexpr std::chrono::seconds kWithin{1};
  /// With one scan of the first: as many messages as they may need are bounded.
  static constexpr std::size_t kMaxSegments = 180;

  /// The next SEGMENTS_2. Parts of one scan have one end, and come in their order.
  void Add(const SegmentPart& part);

  /// Whether a scan of the first must wait for more.
  ///
  /// @param newest_pose  time of the newest POSE
  bool Holds(Utime end_time, Utime newest_pose) const;

  /// How it looks during a scan of the first; to be asked before its segments are taken. Whole until it is expected.
  ///
  /// @param time, end_time  of the scan
  SecondSight SightDuring(Utime time, Utime end_time);

  /// @return the segments that were seen since the scan of the first before, at most 0.3 s ahead of this one's beginning, until its end; all earlier
  ///         ones are forgotten. Those that were seen while the first was dark lie before `time`
  std::vector<Segment> Take(Utime time, Utime end_time);

  std::int64_t num_dropped() const { return num_dropped_; }  // seen during no scan of the first, or too many
  /// Of them, those that came when the scan to which they belong had gone out, or so far ahead of the first that they were forgotten: the times of
  /// the two lidars do not fit. The first second of the second does not count.
  std::int64_t num_untimely() const { return num_untimely_; }
  std::int64_t num_taken() const { return num_taken_; }

 private:
  struct Scan {
    Utime end;
    bool is_whole = true;  // nothing of it was lost, and no scan before it; and it is not dark
  };

  bool IsGoingOn(Utime end_time) const;
  void NotePart(const SegmentPart& part);
  void NoteReturns();

  std::deque<Segment> segments_;     // by arrival
  std::deque<Scan> scans_;           // that have come, by their ends
  std::optional<std::int64_t> seq_;  // of the last scan of which a part has come
  std::int32_t next_part_ = 0;       // of that scan
  bool has_ended_ = true;            // that scan
  bool is_whole_ = false;            // that scan, so far
  std::int64_t num_returns_ = 0;     // of that scan, so far
  Darkness darkness_;
  std::optional<Utime> began_;       // end of the first scan since it was silent
  std::optional<Utime> last_taken_;  // end of the last scan of the first
  std::optional<Utime> first_time_;  // of the first scan of the first since that began
  std::int64_t num_dropped_ = 0;
  std::int64_t num_untimely_ = 0;
  std::int64_t num_taken_ = 0;
};

}  // namespace lookout::georeferencer
