#include "tools/eval/turn_collector.hpp"

#include <algorithm>

#include "common/core/utime.hpp"

namespace lookout::eval {
namespace {

bool HasPlace(std::int64_t utime_us, int part_index, int num_parts) {
  return UtimeFromWire(utime_us).has_value() && part_index >= 0 && part_index < num_parts;
}

bool HasCells(std::int64_t num_columns, std::int64_t num_rings, std::int64_t num_returns, std::int64_t num_cells) {
  // Each count is at most the size of a message, so that products of two cannot overflow.
  return num_columns >= 0 && num_rings >= 0 && num_returns >= 0 && (num_columns == 0 || num_rings * num_returns <= num_cells) &&
         num_columns * num_rings * num_returns == num_cells;
}

}  // namespace

bool Turn::IsWhole() const {
  const int flags = obstacles.begin()->second.scan_flags;
  return (flags & lidar_scan_t::FLAG_PARTIAL_START) == 0 && (flags & lidar_scan_t::FLAG_PARTIAL_END) == 0;
}

Turn& TurnCollector::TurnOf(std::int64_t utime_us, std::int64_t seq) {
  Turn& turn = waiting_[{utime_us, seq}];
  if (waiting_.size() > kMaxWaiting) {
    auto oldest = waiting_.begin();
    if (&oldest->second == &turn) ++oldest;
    if (!oldest->second.obstacles.empty()) ++num_given_up_;
    waiting_.erase(oldest);
  }
  return turn;
}

bool TurnCollector::Add(lidar_scan_t message) {
  if (!HasPlace(message.utime_us, message.part_index, message.num_parts) ||
      !HasCells(message.num_columns, message.num_rings, message.num_returns, message.num_cells)) {
    return false;
  }
  const int part_index = message.part_index;
  TurnOf(message.utime_us, message.seq).scans.insert_or_assign(part_index, std::move(message));
  return true;
}

bool TurnCollector::Add(segments_t message) {
  if (!HasPlace(message.utime_us, message.part_index, message.num_parts) ||
      !HasCells(message.num_columns, message.num_rings, message.num_returns, message.num_cells)) {
    return false;
  }
  const int part_index = message.part_index;
  TurnOf(message.utime_us, message.seq).segments.insert_or_assign(part_index, std::move(message));
  return true;
}

bool TurnCollector::Add(obstacles_t message) {
  if (!HasPlace(message.utime_us, message.part_index, message.num_parts)) return false;
  for (const auto& obstacle : message.obstacles) {
    if (obstacle.num_map != 0 && obstacle.num_map != obstacle.num_footprint) return false;
  }
  const Key key{message.utime_us, message.seq};
  const auto num_parts = static_cast<std::size_t>(message.num_parts);
  const int part_index = message.part_index;
  Turn& turn = TurnOf(message.utime_us, message.seq);
  turn.obstacles.insert_or_assign(part_index, std::move(message));
  if (turn.obstacles.size() == num_parts) {
    on_turn_(turn);
    waiting_.erase(key);
  }
  return true;
}

std::int64_t TurnCollector::num_incomplete() const {
  return num_given_up_ + std::ranges::count_if(waiting_, [](const auto& entry) { return !entry.second.obstacles.empty(); });
}

}  // namespace lookout::eval
