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

/// How the second lidar looks during a scan of the first. The numbers are those of the flags on the wire.
enum class SecondSight : std::int32_t {
  kWhole = 0,
  kHole = 8,     // something that the second lidar saw during the scan is lost, or has not come
  kSilent = 16,  // the second lidar does not look: kWholeScans whole scans did not come within kWithin
};

/// The released segments depend on measurement times alone, as long as SEGMENTS_2 come within kMaxWait of POSE.
class SecondLidar {
 public:
  /// A scan of the first lidar waits for the second until POSE is this far ahead of the scan.
  static constexpr std::chrono::milliseconds kMaxWait{500};
  /// The second lidar counts from kSettled after its first scan, by when that scan has come for sure, until kSilence after its last scan.
  static constexpr std::chrono::seconds kSettled{1};
  static constexpr std::chrono::seconds kSilence{2};
  /// The second lidar is expected from this long after the first scan of the first lidar.
  static constexpr std::chrono::seconds kExpected{3};
  /// The second lidar looks while kWholeScans whole scans ended within kWithin: as many as it takes to raise an alert.
  static constexpr std::size_t kWholeScans = 3;
  /// A dark lidar does not look either (common/core/cover_watch.hpp): a scan with this many returns or fewer counts as empty.
  static constexpr std::int64_t kMostStrays = 20;
  static constexpr std::chrono::seconds kWithin{1};
  /// Segments that go out with one scan of the first lidar at most: this bounds the number of messages.
  static constexpr std::size_t kMaxSegments = 180;

  /// The next SEGMENTS_2. Parts of one scan have one end, and come in their order.
  void Add(const SegmentPart& part);

  /// Whether a scan of the first must wait for more.
  ///
  /// @param newest_pose  time of the newest POSE
  bool Holds(Utime end_time, Utime newest_pose) const;

  /// How the second lidar looks during a scan of the first; to be asked before Take. kWhole until the second lidar is expected.
  ///
  /// @param time, end_time  of the scan
  SecondSight SightDuring(Utime time, Utime end_time);

  /// @return the segments that were seen between the ends of the previous scan of the first lidar and of this scan, at most 0.3 s before this scan
  ///         begins; all earlier segments are forgotten. Segments that were seen while the first lidar was dark lie before `time`
  std::vector<Segment> Take(Utime time, Utime end_time);

  std::int64_t num_dropped() const { return num_dropped_; }  // seen during no scan of the first, or too many
  /// Dropped segments that came when the scan to which they belong had gone out, or so far ahead of the first lidar that they were forgotten: the
  /// times of the two lidars do not fit. The first second of the second lidar does not count.
  std::int64_t num_untimely() const { return num_untimely_; }
  std::int64_t num_taken() const { return num_taken_; }

 private:
  struct Scan {
    Utime end;
    bool is_whole = true;  // neither a part of this scan nor the scan before was lost, and this scan is not dark
  };

  bool IsGoingOn(Utime end_time) const;
  void NotePart(const SegmentPart& part);
  void NoteReturns();

  std::deque<Segment> segments_;     // by arrival
  std::deque<Scan> scans_;           // that have come, by their ends
  std::optional<std::int64_t> seq_;  // of the last scan of which a part has come
  std::int32_t next_part_ = 0;       // of that scan
  bool has_ended_ = true;            // that scan
  bool is_whole_ = false;            // the scan seq_, so far
  std::int64_t num_returns_ = 0;     // of the scan seq_, so far
  Darkness darkness_;
  std::optional<Utime> began_;       // end of the first scan since the second lidar was silent
  std::optional<Utime> last_taken_;  // end of the last scan of the first
  std::optional<Utime> first_time_;  // of the first scan of the first lidar since it began
  std::int64_t num_dropped_ = 0;
  std::int64_t num_untimely_ = 0;
  std::int64_t num_taken_ = 0;
};

}  // namespace lookout::georeferencer
