// Observations of a boat on which all is well, to be spoilt by each test.
#pragma once

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <string>

#include "common/bus/services.hpp"
#include "common/core/angles.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "tests/support/files.hpp"
#include "tools/doctor/findings.hpp"
#include "tools/doctor/machine.hpp"

namespace lookout::doctor::test {

inline constexpr auto kOk = Grade::kOk;
inline constexpr auto kWarning = Grade::kWarning;
inline constexpr auto kFault = Grade::kFault;

inline const Utime kEnd{std::chrono::microseconds(1'700'000'000'000'000)};
inline std::int64_t Ago(double seconds) { return ToUtimeUs(kEnd) - std::llround(seconds * 1e6); }

inline ProcessSeen Running(const std::string& name, int pid = 7) {
  ProcessSeen process;
  process.last.process = name;
  process.last.host = "boat";
  process.last.pid = pid;
  process.last.state = health_t::STATE_OK;
  health_channel_t channel{};
  channel.channel = "LIDAR_SCAN";
  channel.is_input = 1;
  process.last.channels.push_back(channel);
  process.first = process.last;
  process.heard_last = kEnd;
  return process;
}

inline InterfaceSeen Interface(const std::string& name, const std::string& address, int prefix_bits) {
  return {name, io::ParseIpAddress(address), prefix_bits, true, name == "lo"};
}

/// config/demo, a lidar locked to PPS, RTK, PASHR, and all processes.
inline Observations Healthy() {
  Observations seen;
  seen.config = ReadConfig(support::kDemoConfig.string());
  seen.bus = {"udpm://239.255.76.67:7667?ttl=0", "239.255.76.67", 0, "lo", {}};
  seen.buffers = {4 << 20, 4 << 20, 2 << 20};
  seen.interfaces = {Interface("lo", "127.0.0.1", 8), Interface("eth0", "192.168.1.77", 24)};
  seen.is_host_clock_set = true;
  seen.end = kEnd;
  seen.watched_s = 5.0;

  auto& lidar = seen.lidar;
  lidar.via = Via::kItself;
  lidar.num_by_sender["192.168.1.201"] = 3770;
  lidar.num_packets = 3770;
  lidar.last = kEnd - std::chrono::milliseconds(2);
  lidar.first = lidar.last - std::chrono::microseconds(1327 * 3769);
  lidar.heard_last = lidar.last;
  lidar.model = "VLP-16";
  lidar.num_returns = 1;
  lidar.return_kind = lidar_scan_t::RETURN_STRONGEST;
  lidar_clock_t clock{};
  clock.state = lidar_clock_t::STATE_LOCKED;
  clock.time_source = lidar_clock_t::TIME_SENSOR;
  clock.offset_s = 0.001;
  clock.rotation_rpm = 600;
  lidar.first_clock = clock;
  clock.num_packets = 3000;
  lidar.last_clock = clock;

  auto& navigation = seen.navigation;
  navigation.via = Via::kItself;
  navigation.num_by_source["udp"] = 100;
  gnss_fix_t fix{};
  fix.arrival_utime_us = Ago(0.1);
  fix.source = "udp";
  fix.sentence_type = "GGA";
  fix.quality = gnss_fix_t::QUALITY_RTK_FIXED;
  fix.num_satellites = 14;
  fix.hdop = 0.7;
  fix.horizontal_sd_m = 0.02;
  fix.latitude_deg = 43.63;
  fix.longitude_deg = -72.15;
  navigation.fix = fix;
  navigation.fix_heard = kEnd - std::chrono::milliseconds(100);
  attitude_t attitude{};
  attitude.source = "udp";
  attitude.sentence_type = "PASHR";
  navigation.heading = attitude;
  pose_t pose{};
  pose.heading_source = pose_t::HEADING_PASHR;
  pose.has_attitude = 1;
  pose.heading_rad = 1.0;
  navigation.pose = pose;

  for (const auto& service : bus::kServices) seen.processes[std::string(service.name)].push_back(Running(std::string(service.name)));
  seen.obstacles = {50, 500, 500, 0};
  seen.look_out = {50, 12, 3, seen.end, alerts_t{}, seen.end};
  seen.disk.folder = "/logs";
  seen.disk.free_bytes = 500'000'000'000;
  return seen;
}

/// The findings of one subject, as one text; its worst grade.
struct Said {
  Grade grade = Grade::kOk;
  std::string text;
};
inline Said About(const Findings& findings, const std::string& subject) {
  Said said;
  for (const auto& finding : findings) {
    if (finding.subject != subject) continue;
    said.grade = std::max(said.grade, finding.grade);
    said.text += finding.text + "\n" + finding.cure + "\n";
    EXPECT_EQ(finding.cure.empty(), finding.grade == Grade::kOk) << finding.text;
  }
  return said;
}

}  // namespace lookout::doctor::test

#define EXPECT_SAYS(said, expected_grade, part)                    \
  do {                                                             \
    const auto one = (said);                                       \
    EXPECT_EQ(one.grade, expected_grade) << one.text;              \
    EXPECT_NE(one.text.find(part), std::string::npos) << one.text; \
  } while (false)
