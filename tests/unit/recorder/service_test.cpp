#include "services/recorder/service.hpp"

#include <unistd.h>

#include <filesystem>
#include <gtest/gtest.h>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/bus/memory_bus.hpp"
#include "lookout/lidar_nmea_t.hpp"

namespace lookout::recorder {
namespace {

namespace fs = std::filesystem;
using std::chrono::microseconds;
using std::chrono::seconds;

class Recorder : public ::testing::Test {
 protected:
  fs::path folder_ = fs::temp_directory_path() / ("lookout_recorder_test_" + std::to_string(getpid()));
  bus::MemoryBus bus_;
  Utime now_{seconds(1'800'000'000)};

  void TearDown() override { fs::remove_all(folder_); }

  Service Make() {
    return Service(bus_, Params{folder_}, run_info_t{}, [this] { return now_; });
  }
  void HandleAll() {
    while (bus_.HandleOnce()) {
    }
  }
  std::vector<bus::LogEvent> Events(const fs::path& file) {
    std::vector<bus::LogEvent> events;
    bus::LogReader reader(file);
    while (auto event = reader.Next()) events.push_back(*event);
    return events;
  }
};

TEST_F(Recorder, BeginsWithRunInfoAndLogsEveryChannelWithItsTimeOfReceipt) {
  fs::path file;
  {
    Service service = Make();
    file = service.log_file();
    now_ += microseconds(5);
    bus::Publish(bus_, bus::kLidarNmea, lidar_nmea_t{});
    bus_.Publish(bus::Channel{"SOMEBODY_ELSES", "", "", 1, 1, false, false}, std::vector<std::uint8_t>{1, 2, 3});
    HandleAll();
    EXPECT_EQ(service.Report().state, HealthState::kOk);
  }
  EXPECT_EQ(file.filename(), "20270115T080000Z.lcmlog");
  const auto events = Events(file);
  ASSERT_EQ(events.size(), 3U);
  EXPECT_EQ(events[0].channel, "RUN_INFO");
  EXPECT_EQ(events[1].channel, "LIDAR_NMEA");
  EXPECT_EQ(events[1].time, now_);
  EXPECT_EQ(events[2].channel, "SOMEBODY_ELSES");
  EXPECT_EQ(events[2].bytes, (std::vector<std::uint8_t>{1, 2, 3}));
}

TEST_F(Recorder, RepeatsRunInfoEveryTenSecondsAndLogsItOnce) {
  Service service = Make();
  for (int i = 0; i < 21; ++i) {
    now_ += seconds(1);
    service.AdvanceTo(now_);
    HandleAll();
  }
  const auto events = Events(service.log_file());
  ASSERT_EQ(events.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    const auto message = bus::Decode<run_info_t>(events[static_cast<std::size_t>(i)].bytes);
    ASSERT_TRUE(message);
    EXPECT_EQ(message->seq, i);
  }
}

TEST_F(Recorder, NeverOverwritesALog) {
  const Service first = Make();
  const Service second = Make();
  EXPECT_NE(first.log_file(), second.log_file());
  EXPECT_EQ(second.log_file().filename(), "20270115T080000Z-1.lcmlog");
}

TEST_F(Recorder, SaysWhyALogCannotBeMade) {
  EXPECT_THROW(Service(bus_, Params{"/proc/nowhere"}, run_info_t{}, [this] { return now_; }), std::runtime_error);
}

}  // namespace
}  // namespace lookout::recorder
