// Capture files as one stream of datagrams, each when it is due.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/core/health.hpp"
#include "common/core/utime.hpp"
#include "services/lidar/io/capture_reader.hpp"

namespace lookout::lidar {

class CapturePlayer {
 public:
  /// Stamps that go back, or on by more, are a bad stamp or the seam of two captures: they are not waited for.
  static constexpr std::chrono::seconds kMaxPause{5};
  /// So that a large capture of other things does not hold the caller.
  static constexpr std::int64_t kMaxFramesPerCall = 1024;

  /// Opens all files, so that a wrong one stops the start and not the run.
  ///
  /// @param files  in the order in which they are read
  /// @param speed  1 = as it was recorded; 0 = as fast as it is asked
  /// @throws std::runtime_error naming the file
  CapturePlayer(const std::vector<std::filesystem::path>& files, double speed);

  /// @param elapsed  since the start of playing, by a clock that does not jump
  /// @return the next datagram, when it is due; nullopt when it is not yet, at the end, and after kMaxFramesPerCall that hold none: is_empty()
  ///         is false then
  std::optional<Datagram> NextDue(std::chrono::microseconds elapsed);

  /// After NextDue() gave nothing: nothing is due, as the next datagram is known and comes later, or there is none.
  bool is_empty() const { return next_.has_value() || is_finished(); }

  /// Every datagram has been returned.
  bool is_finished() const { return !next_ && reader_index_ == readers_.size(); }

  /// A datagram was found: from then on there is a CaptureTime().
  bool has_begun() const { return has_begun_; }

  /// The recording's time now: the time of the last datagram plus the time passed since then; never past the next datagram.
  Utime CaptureTime(std::chrono::microseconds elapsed) const;

  /// Sum over the files of CaptureReader::counters(); captures_read, capture_stamp_jumps.
  std::vector<Counter> counters() const;

  /// A line for each file that is damaged or gave no datagram, as far as it has been read.
  std::vector<std::string> Warnings() const;

 private:
  void ReadNext();
  std::chrono::microseconds ToRecorded(std::chrono::microseconds elapsed) const;

  std::vector<std::filesystem::path> files_;
  std::vector<CaptureReader> readers_;
  std::size_t reader_index_ = 0;
  double speed_;
  std::optional<Datagram> next_;
  bool has_begun_ = false;
  Utime last_stamp_{};
  // Recorded time since the start, pauses that are not waited for left out.
  std::chrono::microseconds last_due_{0};
  std::chrono::microseconds next_due_{0};
  std::int64_t num_stamp_jumps_ = 0;
};

}  // namespace lookout::lidar
