// Small logs in a folder of the test.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "common/bus/schema.hpp"
#include "lookout/lidar_packets_t.hpp"
#include "lookout/nav_raw_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/run_info_t.hpp"
#include "tests/support/file_log.hpp"
#include "tests/support/files.hpp"

namespace lookout::log_test {

namespace fs = std::filesystem;

// A type that no version of Lookout has, and its fingerprint as lcm-gen 1.3.1 gives it.
inline const std::vector<std::uint8_t> kUnknownFingerprint{0x7D, 0x10, 0xA8, 0xEF, 0xBF, 0xE5, 0xE4, 0xFF};

class SmallLog : public ::testing::Test {
 protected:
  support::TempDir folder_;
  // 2027-01-15T08:00:00Z
  Utime start_{std::chrono::seconds(1'800'000'000)};

  static bus::LogEvent Event(Utime time, std::string channel, std::vector<std::uint8_t> bytes) {
    return {time, std::move(channel), std::move(bytes)};
  }
  bus::LogEvent RunInfo(int second, const std::string& version = "0.1.0") const {
    run_info_t message{};
    message.program = "recorder";
    message.version = version;
    message.host = "boat";
    message.schema = bus::SchemaDigest();
    return Event(start_ + std::chrono::seconds(second), "RUN_INFO", bus::Encode(message));
  }
  bus::LogEvent Pose(int second, std::int64_t seq, double heading_rad = 1.0) const {
    pose_t message{};
    message.seq = seq;
    message.heading_rad = heading_rad;
    return Event(start_ + std::chrono::seconds(second), "POSE", bus::Encode(message));
  }

  bus::LogEvent Packets(int second, std::int64_t seq, std::int32_t marks = 0) const {
    lidar_packets_t message{};
    message.seq = seq;
    message.marks = marks;
    return Event(start_ + std::chrono::seconds(second), "LIDAR_PACKETS", bus::Encode(message));
  }
  bus::LogEvent NavRaw(int second, std::int64_t seq, std::int32_t kind = nav_raw_t::KIND_TICK) const {
    nav_raw_t message{};
    message.seq = seq;
    message.kind = kind;
    return Event(start_ + std::chrono::seconds(second), "NAV_RAW", bus::Encode(message));
  }

  fs::path Write(const std::string& name, const std::vector<bus::LogEvent>& events) const {
    support::FileLog writer(folder_ / name);
    for (const auto& event : events) writer.Write(event.time, event.channel, event.bytes);
    return folder_ / name;
  }
  static std::string Content(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static void SetContent(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }
  static std::vector<bus::LogEvent> Read(const fs::path& file) {
    std::vector<bus::LogEvent> events;
    bus::LogReader reader(file);
    while (auto event = reader.Next()) events.push_back(*std::move(event));
    EXPECT_EQ(reader.num_damaged(), 0);
    return events;
  }
};

}  // namespace lookout::log_test
