#include "tools/doctor/notes.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "lookout/lidar_scan_t.hpp"
#include "lookout/nav_raw_t.hpp"
#include "lookout/obstacles_t.hpp"

namespace lookout::doctor {

namespace {

// lcm-log: sync word, number, time, two lengths.
constexpr std::int64_t kEventHeaderBytes = 28;

}  // namespace

Notes::Notes(Observations& seen, std::function<Utime()> clock) : seen_(seen), clock_(std::move(clock)) {}

void Notes::TakeFrom(bus::Bus& bus, Via via) {
  bus::Subscribe<lidar_packets_t>(bus, bus::kLidarPackets, [this, via](const lidar_packets_t& message) { OnPackets(message, via); });
  bus::Subscribe<lidar_clock_t>(bus, bus::kLidarClock, [this](const lidar_clock_t& message) {
    if (!seen_.lidar.first_clock) seen_.lidar.first_clock = message;
    seen_.lidar.last_clock = message;
  });
  bus::Subscribe<lidar_scan_t>(bus, bus::kLidarScan, [this](const lidar_scan_t& message) {
    seen_.lidar.model = message.model;
    seen_.lidar.num_returns = message.num_returns;
    if (!message.return_kind.empty()) seen_.lidar.return_kind = message.return_kind.front();
  });
  bus::Subscribe<nav_raw_t>(bus, bus::kNavRaw, [this, via](const nav_raw_t& message) {
    seen_.navigation.via = via;
    if (message.kind == nav_raw_t::KIND_SENTENCE || message.kind == nav_raw_t::KIND_IMU) ++seen_.navigation.num_by_source[message.source];
  });
  bus::Subscribe<gnss_fix_t>(bus, bus::kGnssFix, [this](const gnss_fix_t& message) { OnFix(message); });
  bus::Subscribe<attitude_t>(bus, bus::kAttitude, [this](const attitude_t& message) {
    if (std::isfinite(message.heading_rad)) seen_.navigation.heading = message;
  });
  bus::Subscribe<pose_t>(bus, bus::kPose, [this](const pose_t& message) { seen_.navigation.pose = message; });
}

void Notes::TakeRest(bus::Bus& bus) {
  bus::Subscribe<health_t>(bus, bus::kHealth, [this](const health_t& message) { OnHealth(message); });
  bus::Subscribe<obstacles_t>(bus, bus::kObstacles, [this](const obstacles_t& message) {
    auto& obstacles = seen_.obstacles;
    if (message.part_index == message.num_parts - 1) ++obstacles.num_turns;
    obstacles.num_obstacles += message.num_obstacles;
    for (const auto& obstacle : message.obstacles) {
      obstacles.num_placed += obstacle.status == obstacle_t::STATUS_OK ? 1 : 0;
      obstacles.num_timeouts += obstacle.status == obstacle_t::STATUS_POSE_TIMEOUT ? 1 : 0;
    }
  });
  bus.SubscribeAll([this](std::string_view channel, Bytes bytes) {
    num_log_bytes_ += kEventHeaderBytes + static_cast<std::int64_t>(channel.size() + bytes.size());
  });
}

void Notes::OnPackets(const lidar_packets_t& message, Via via) {
  auto& lidar = seen_.lidar;
  lidar.via = via;
  if (!seen_.config.lidar) return;
  for (int i = 0; i < message.num_packets; ++i) {
    const auto index = static_cast<std::size_t>(i);
    const auto time = UtimeFromWire(message.host_utime_us[index]);
    if (!time || message.udp_port[index] != seen_.config.lidar->data_port) continue;
    if (lidar.num_packets == 0) lidar.first = *time;
    lidar.last = *time;
    ++lidar.num_packets;
    lidar.heard_last = clock_();
  }
}

// A receiver tells one epoch in several sentences, maybe to several inputs, and not each tells how many satellites there are.
void Notes::OnFix(const gnss_fix_t& message) {
  auto& fix = seen_.navigation.fix;
  const bool says_less = fix && fix->num_satellites >= 0 && message.num_satellites < 0;
  constexpr std::int64_t kEpochUs = 1'500'000;  // of the slowest receivers, a fix a second, and some delay
  if (says_less && fix->quality > 0 && message.quality > 0 && std::abs(message.arrival_utime_us - fix->arrival_utime_us) < kEpochUs) return;
  fix = message;
  seen_.navigation.fix_heard = clock_();
}

void Notes::OnHealth(const health_t& message) {
  auto& instances = seen_.processes[message.process];
  const auto now = clock_();
  const auto found =
      std::ranges::find_if(instances, [&message](const ProcessSeen& seen) { return seen.last.pid == message.pid && seen.last.host == message.host; });
  if (found == instances.end()) {
    instances.push_back({message, message, now});
  } else {
    found->last = message;
    found->heard_last = now;
  }
}

}  // namespace lookout::doctor
