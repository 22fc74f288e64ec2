// A recorder on a disk that a test may spoil: logs that follow each other, and what is in them.
#pragma once

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <lcm/eventlog.h>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "lookout/nav_raw_t.hpp"
#include "lookout/pose_t.hpp"
#include "services/recorder/service.hpp"
#include "tests/support/bus_fixture.hpp"
#include "tests/support/files.hpp"

namespace lookout::recorder {

namespace fs = std::filesystem;
using std::chrono::seconds;
inline constexpr std::int64_t kPlenty = 1'000'000'000'000;

class Rotation : public support::BusTest {
 protected:
  support::TempDir temp_dir_;
  fs::path folder_ = temp_dir_.path();  // a test may look elsewhere
  Utime now_{seconds(1'800'000'000)};
  Params params_{.log_folder = folder_, .reserve_bytes = 0};
  std::int64_t seq_ = 0;

  Service Make(const Disk& disk = RealDisk()) {
    return Service(
        bus_, params_, run_info_t{}, [this] { return now_; }, disk);
  }
  void Send(int count = 1) {
    for (int i = 0; i < count; ++i) {
      pose_t message{};
      message.seq = seq_++;
      bus::Publish(bus_, bus::kPose, message);
    }
    HandleAll();
  }
  std::vector<fs::path> Files() const {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder_)) files.push_back(entry.path());
    std::ranges::sort(files);
    return files;
  }
  // The seq of every POSE of all logs in their order; each log must be whole, begin with RUN_INFO and number its events from 0.
  std::vector<std::int64_t> Recorded() const {
    std::vector<std::int64_t> seqs;
    for (const auto& file : Files()) {
      // LCM's own reader.
      lcm_eventlog_t* log = lcm_eventlog_create(file.c_str(), "r");
      std::int64_t number = 0;
      while (lcm_eventlog_event_t* event = lcm_eventlog_read_next_event(log)) {
        EXPECT_EQ(event->eventnum, number);
        EXPECT_TRUE(number > 0 || std::string(event->channel) == "RUN_INFO");
        ++number;
        const Bytes bytes(static_cast<const std::uint8_t*>(event->data), static_cast<std::size_t>(event->datalen));
        if (event->channel == bus::kPose.name) seqs.push_back(bus::ReadHeader(bytes)->seq);
        lcm_eventlog_free_event(event);
      }
      lcm_eventlog_destroy(log);
      bus::LogReader reader(file);
      std::int64_t num_events = 0;
      while (reader.Next()) ++num_events;
      EXPECT_EQ(reader.num_damaged(), 0) << file;
      EXPECT_EQ(num_events, number) << file;
    }
    return seqs;
  }
  static std::vector<std::int64_t> UpTo(std::int64_t count) {
    std::vector<std::int64_t> seqs;
    for (std::int64_t i = 0; i < count; ++i) seqs.push_back(i);
    return seqs;
  }
};

}  // namespace lookout::recorder
