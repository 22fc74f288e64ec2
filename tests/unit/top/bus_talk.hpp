// Messages as a bus would bring them, with hand-written numbers.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "lookout/health_t.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/pose_t.hpp"
#include "tests/support/messages.hpp"
#include "tools/top/board.hpp"

namespace lookout::top {

inline const TimePoint kStart{std::chrono::seconds(1000)};

inline TimePoint At(double seconds) { return kStart + std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(seconds)); }

template <typename T>
void Say(Board& board, const bus::Channel& channel, const T& message, double seconds) {
  board.Take(channel.name, bus::Encode(message), At(seconds));
}

inline pose_t PoseAt(std::int64_t utime_us, double heading_rad) {
  pose_t pose{};
  pose.utime_us = utime_us;
  pose.heading_rad = heading_rad;
  return pose;
}

inline obstacle_t ObstacleAt(int id, float range_m, float bearing_rad) {
  obstacle_t obstacle{};
  obstacle.utime_us = 1'000'000;
  obstacle.id = id;
  obstacle.confidence = obstacle_t::CONFIDENCE_SURE;
  obstacle.thing_probability = 0.97F;
  obstacle.range_m = range_m;
  obstacle.bearing_rad = bearing_rad;
  obstacle.latitude_deg = 43.5;
  obstacle.longitude_deg = -72.25;
  obstacle.length_m = 6.0F;
  obstacle.width_m = 2.5F;
  obstacle.height_m = 1.5F;
  return obstacle;
}

inline obstacles_t TurnOf(std::int64_t seq, std::vector<obstacle_t> obstacles, int part_index = 0, int num_parts = 1) {
  obstacles_t turn{};
  turn.utime_us = 1'000'000 + seq;
  turn.seq = seq;
  turn.part_index = part_index;
  turn.num_parts = num_parts;
  support::Fill(turn, std::move(obstacles));
  return turn;
}

inline health_t HealthOf(const std::string& process, std::int64_t seq, std::int32_t state = 0, const std::string& reason = "") {
  health_t health{};
  health.process = process;
  health.host = "boat";
  health.seq = seq;
  health.state = state;
  health.reason = reason;
  health.cpu_fraction = 0.125;
  health.resident_bytes = 14'000'000;
  return health;
}

inline void AddCounter(health_t& health, const std::string& name, std::int64_t count) {
  health_counter_t counter{};
  counter.name = name;
  counter.count = count;
  health.counters.push_back(counter);
  health.num_counters = static_cast<std::int32_t>(health.counters.size());
}

}  // namespace lookout::top
