// lookout-replay as a user runs it, on captures and logs in a folder of the test.
#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "lookout/lidar_packets_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "tests/support/child.hpp"
#include "tests/support/file_log.hpp"
#include "tests/support/files.hpp"

namespace lookout::system_test {

namespace fs = std::filesystem;

class Replay : public ::testing::Test {
 protected:
  support::TempDir folder_;
  const fs::path data_ = support::kRecordings;
  const std::string config_ = support::kCatabotConfig.string();

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  support::RunResult ReplayTo(const std::string& in, const std::string& out, const std::vector<std::string>& options = {}) {
    return ReplayWith(config_, in, out, options);
  }
  support::RunResult ReplayWith(const std::string& config, const std::string& in, const std::string& out,
                                const std::vector<std::string>& options = {}) {
    std::vector<std::string> command{support::Bin("replay"), "--config", config, "--in", in, "--out", Path(out), "--force"};
    command.insert(command.end(), options.begin(), options.end());
    return support::RunProgram(command, Path("replay.out"));
  }

  // Three seconds of the simulated lake, replayed once, as the log "day".
  void MakeDay() {
    const auto sim = support::RunProgram(
        {support::Bin("sim"), "--config", config_, "--scene", "lake", "--seed", "2", "--seconds", "3", "--pcap", Path("sim.pcap")}, Path("sim.out"));
    ASSERT_EQ(sim.exit_code, 0) << sim.output;
    ASSERT_EQ(ReplayTo(Path("sim.pcap"), "day").exit_code, 0);
  }

  // The first events of a log, as a recorder leaves them that is killed there.
  void Cut(const std::string& log, const std::string& cut, std::size_t num_events) {
    bus::LogReader reader(Path(log));
    support::FileLog writer(Path(cut));
    for (std::size_t i = 0; i < num_events; ++i) {
      const auto event = reader.Next();
      ASSERT_TRUE(event);
      writer.Write(event->time, event->channel, event->bytes);
    }
  }

  // The files of a recorder that began a new one after half of the events, RUN_INFO first in each.
  void Rotate(const std::string& log, const std::string& first, const std::string& second) {
    std::vector<bus::LogEvent> events;
    bus::LogReader reader(Path(log));
    while (const auto event = reader.Next()) events.push_back(*event);
    ASSERT_EQ(events.front().channel, "RUN_INFO");
    support::FileLog one(Path(first));
    support::FileLog other(Path(second));
    other.Write(events[events.size() / 2].time, "RUN_INFO", events.front().bytes);
    for (std::size_t i = 0; i < events.size(); ++i) (i < events.size() / 2 ? one : other).Write(events[i].time, events[i].channel, events[i].bytes);
  }

  template <typename T>
  std::vector<T> Messages(const std::string& log, const std::string& channel) {
    std::vector<T> messages;
    bus::LogReader reader(Path(log));
    while (const auto event = reader.Next()) {
      if (event->channel != channel) continue;
      const auto message = bus::Decode<T>(event->bytes);
      EXPECT_TRUE(message);
      if (message) messages.push_back(*message);
    }
    return messages;
  }

  // Replays twice and wants the same file; replays the replay and wants the same payloads on every channel.
  void ExpectSameBytes(const std::string& capture) {
    const auto first = ReplayTo(capture, "first");
    ASSERT_EQ(first.exit_code, 0) << first.output;
    ASSERT_EQ(ReplayTo(capture, "second").exit_code, 0);
    EXPECT_EQ(support::ReadFile(folder_ / "first"), support::ReadFile(folder_ / "second"));
    const auto again = ReplayTo(Path("first"), "again");
    ASSERT_EQ(again.exit_code, 0) << again.output;
    EXPECT_TRUE(PayloadsByChannel("first") == PayloadsByChannel("again"));
  }

  // Payloads of each channel in their order. How channels lie between each other in the file is not promised.
  std::map<std::string, std::vector<std::vector<std::uint8_t>>> PayloadsByChannel(const std::string& log) {
    std::map<std::string, std::vector<std::vector<std::uint8_t>>> payloads;
    bus::LogReader reader(Path(log));
    while (auto event = reader.Next()) payloads[event->channel].push_back(std::move(event->bytes));
    return payloads;
  }

  // Turns of a log: whole and partial.
  std::pair<int, int> CountTurns(const std::string& log) {
    std::map<std::int64_t, int> flags;
    for (const auto& scan : Messages<lidar_scan_t>(log, "LIDAR_SCAN")) flags[scan.seq] = scan.flags;
    int num_whole = 0;
    for (const auto& [seq, flag] : flags) {
      const bool is_partial = (flag & lidar_scan_t::FLAG_PARTIAL_START) != 0 || (flag & lidar_scan_t::FLAG_PARTIAL_END) != 0;
      num_whole += is_partial ? 0 : 1;
    }
    return {num_whole, static_cast<int>(flags.size()) - num_whole};
  }

  // Ranges above 0 in the raw packets, and how often each count occurs.
  std::map<int, int> RawRanges(const std::string& log) {
    std::map<int, int> histogram;
    for (const auto& bundle : Messages<lidar_packets_t>(log, "LIDAR_PACKETS")) {
      std::size_t offset = 0;
      for (const int size : bundle.size_bytes) {
        if (size == 1206) {
          for (int block = 0; block < 12; ++block) {
            for (int channel = 0; channel < 32; ++channel) {
              const std::size_t place = offset + static_cast<std::size_t>(100 * block + 4 + 3 * channel);
              const int range = bundle.payload[place] | bundle.payload[place + 1] << 8;
              if (range > 0) ++histogram[range];
            }
          }
        }
        offset += static_cast<std::size_t>(size);
      }
    }
    return histogram;
  }

  std::map<int, int> ExportedRanges(const std::string& log) {
    const auto result =
        support::RunProgram({support::Bin("export"), "--in", Path(log), "--table", "returns", "--out", Path("returns.csv")}, Path("export.out"));
    EXPECT_EQ(result.exit_code, 0) << result.output;
    std::ifstream in(Path("returns.csv"));
    std::map<int, int> histogram;
    std::string line;
    std::getline(in, line);
    EXPECT_EQ(line, "scan_utime_us,utime_us,ring,return_index,azimuth_deg,range_m,x_m,y_m,z_m,reflectivity,label,reason,track_id,piece");
    while (std::getline(in, line)) {
      std::istringstream row(line);
      std::string field;
      for (int i = 0; i < 6; ++i) std::getline(row, field, ',');
      const double count = std::stod(field) / 0.002;
      EXPECT_NEAR(count, std::round(count), 1e-6);
      ++histogram[static_cast<int>(std::lround(count))];
    }
    return histogram;
  }
};

}  // namespace lookout::system_test
