// The obstacles of the newest scan, nearest first.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "common/messages/heading_history.hpp"
#include "common/messages/part_assembler.hpp"
#include "lookout/pose_t.hpp"
#include "tools/top/rate_meter.hpp"

namespace lookout::top {

/// An obstacle without its outlines.
struct ObstacleLine : obstacle_t {
  double true_bearing_rad = std::numeric_limits<double>::quiet_NaN();  // of the nearest return, from true north clockwise; NaN = not known
};

/// The nearest of a scan, at most Nearest::kMaxLines.
struct NearestObstacles {
  std::vector<ObstacleLine> lines;       // nearest first; those without a range last
  std::vector<ObstacleLine> sure_lines;  // of those that are sure
  std::int64_t num_obstacles = 0;        // of the scan
  std::int64_t num_sure = 0;             // of them
  std::int64_t num_parts_missing = 0;
  TimePoint time;  // when its last message came
};

class Nearest {
 public:
  static constexpr std::size_t kMaxLines = 50;  // as many as a screen may have room for

  void Take(const pose_t& pose) { headings_.Add(pose.utime_us, pose.heading_rad); }
  /// @param part  well-formed (messages::IsWellFormed)
  void Take(const obstacles_t& part, TimePoint now);

  /// @return the newest scan that came whole, or, once the next has begun, as much of it as came; nullopt before the first
  const std::optional<NearestObstacles>& newest() const { return newest_; }

 private:
  // What is kept of a message.
  struct Part {
    std::int64_t utime_us = 0;
    std::int64_t seq = 0;
    std::int32_t part_index = 0;
    std::int32_t num_parts = 1;
    NearestObstacles nearest;
  };
  static NearestObstacles ToNearest(const std::vector<Part>& parts);

  messages::HeadingHistory headings_;
  messages::PartAssembler<Part> assembler_;
  std::optional<NearestObstacles> newest_;
};

}  // namespace lookout::top
