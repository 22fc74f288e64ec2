// Known values of POSE of a log or a run, and why there are no tracks where they are missing.
#pragma once

#include <cstdint>
#include <string>

#include "lookout/pose_t.hpp"

namespace lookout::log {

struct PoseCounts {
  std::int64_t num_poses = 0;
  std::int64_t num_placed = 0;  // position and heading are known on the earth
  std::int64_t num_without_heading = 0;
  std::int64_t num_without_position = 0;
  std::int64_t num_relative = 0;   // in a relative frame; also counted as without position or heading
  std::int64_t num_to_boat = 0;    // relative poses without a known own motion
  std::int64_t num_by_course = 0;  // placed, and the heading is course over ground
  std::int64_t first_placed_us = 0;
  std::int64_t last_placed_us = 0;

  void Add(const pose_t& pose);

  /// @return "no POSE came", "POSE knows no heading (3000 of 3000)", ...; empty where one knew position and heading
  std::string WhyNotPlaced() const;

  /// @return "29.5 of 30.0 s relative to where the boat was at the start, by the lidar, 0.5 s without a known own motion"; empty where none was so
  std::string RelativeInWords() const;
};

}  // namespace lookout::log
