// Brings the messages of one turn together: parts of LIDAR_SCAN, SEGMENTS and OBSTACLES with the same time and number.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include "lookout/lidar_scan_t.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/segments_t.hpp"

namespace lookout::eval {

struct Turn {
  std::map<int, lidar_scan_t> scans;  // by part_index
  std::map<int, segments_t> segments;
  std::map<int, obstacles_t> obstacles;

  /// Whether it begins and ends at the cut. Precondition: OBSTACLES are there.
  bool IsWhole() const;
};

class TurnCollector {
 public:
  /// @param on_turn  called with each turn of which all OBSTACLES came, in their order; scans and segments may be missing
  explicit TurnCollector(std::function<void(const Turn&)> on_turn) : on_turn_(std::move(on_turn)) {}

  /// Messages whose counts do not agree with their arrays are left out. @return whether it was taken
  bool Add(lidar_scan_t message);
  bool Add(segments_t message);
  bool Add(obstacles_t message);

  /// Turns of which OBSTACLES came, but not all parts. Complete after the last message only.
  std::int64_t num_incomplete() const;

 private:
  using Key = std::pair<std::int64_t, std::int64_t>;  // utime_us, seq
  Turn& TurnOf(std::int64_t utime_us, std::int64_t seq);

  // A turn waits for its obstacles for some seconds of turns at most.
  static constexpr std::size_t kMaxWaiting = 256;

  std::function<void(const Turn&)> on_turn_;
  std::map<Key, Turn> waiting_;
  std::int64_t num_given_up_ = 0;
};

}  // namespace lookout::eval
