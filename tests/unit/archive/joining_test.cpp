// Which files are one run, and where a run may be cut.
#include "tools/archive/joining.hpp"

#include <gtest/gtest.h>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "lookout/alerts_t.hpp"
#include "tools/archive/cut_finder.hpp"

namespace {

using namespace lookout;
using archive::Mark;
using archive::Recording;
using archive::ScannedFile;

constexpr std::int64_t kS = 1'000'000;

ScannedFile Log(const std::string& path, std::int64_t start_s, std::int64_t end_s, archive::StreamEnds lidar) {
  ScannedFile file;
  file.path = path;
  file.recording.state = Recording::State::kSound;
  file.recording.kind = "lcm-log";
  file.recording.start_us = start_s * kS;
  file.recording.end_us = end_s * kS;
  file.recording.lidar = lidar;
  return file;
}

TEST(ArchiveJoining, JoinsRotatedFilesByTheirNumbersAndNotByTheirNames) {
  const std::vector<ScannedFile> files{Log("/x/b", 0, 10, {true, true, false, 0, 99}), Log("/x/a", 10, 20, {true, false, false, 100, 180}),
                                       Log("/x/c", 20, 30, {true, false, true, 183, 200}), Log("/x/d", 31, 40, {true, true, true, 0, 50})};
  EXPECT_EQ(archive::JoinRuns(files), (std::vector<archive::RunFiles>{{0, 1, 2}, {3}}));
}

TEST(ArchiveJoining, KeepsApartWhatDoesNotGoOn) {
  const archive::StreamEnds first{true, true, false, 0, 99};
  const auto num_runs = [&first](const ScannedFile& second) { return archive::JoinRuns({Log("/x/a", 0, 10, first), second}).size(); };
  EXPECT_EQ(num_runs(Log("/x/b", 10, 20, {true, false, false, 100, 200})), 1U);
  EXPECT_EQ(num_runs(Log("/x/b", 10, 20, {true, true, false, 100, 200})), 2U) << "a start mark";
  EXPECT_EQ(num_runs(Log("/x/b", 10, 20, {true, false, false, 99, 200})), 2U) << "the same numbers";
  EXPECT_EQ(num_runs(Log("/x/b", 10, 20, {true, false, false, 5000, 6000})), 2U) << "a large gap of numbers";
  EXPECT_EQ(num_runs(Log("/x/b", 100, 120, {true, false, false, 100, 200})), 2U) << "a large gap of time";
  EXPECT_EQ(num_runs(Log("/y/b", 10, 20, {true, false, false, 100, 200})), 2U) << "another folder";
  auto capture = Log("/x/b", 10, 20, {true, false, false, 100, 200});
  capture.recording.kind = "capture";
  EXPECT_EQ(num_runs(capture), 2U);
  auto foreign = capture;
  foreign.recording.state = Recording::State::kForeign;
  EXPECT_EQ(num_runs(foreign), 1U) << "not used";
}

TEST(ArchiveScene, IsTheNameWithoutItsNumberOrThatOfTheFolder) {
  EXPECT_EQ(archive::SceneOf("/logs/rain-11.lcmlog"), "rain");
  EXPECT_EQ(archive::SceneOf("/logs/open_water.pcap"), "open_water");
  EXPECT_EQ(archive::SceneOf("/logs/fog/2026-11-27T10.lcmlog"), "fog");
  EXPECT_EQ(archive::SceneOf("/logs/a-b-7.lcmlog"), "a-b");
  EXPECT_EQ(archive::SceneOf("/logs/-7.lcmlog"), "-7");
}

std::vector<std::uint8_t> Alerts(std::int64_t begin_us, bool is_watch = false) {
  alerts_t message{};
  message.utime_us = begin_us;
  message.begin_utime_us = begin_us;
  message.is_watch = is_watch ? 1 : 0;
  return bus::Encode(message);
}

class ArchiveCuts : public ::testing::Test {
 protected:
  void Lidar(std::int64_t time_us, Mark mark) { finder_.AddRaw(bus::kLidarPackets.name, time_us, mark); }
  void Navigator(std::int64_t time_us, Mark mark) { finder_.AddRaw(bus::kNavRaw.name, time_us, mark); }
  void Tracker(std::int64_t time_us, std::int64_t begin_us) { finder_.AddAlerts(time_us, Alerts(begin_us)); }
  void FirstRun() {
    Lidar(10, Mark::kStart);
    Navigator(11, Mark::kStart);
    Tracker(12, 12);
    Lidar(20, Mark::kEnd);
    Navigator(21, Mark::kEnd);
  }
  archive::CutFinder finder_;
};

TEST_F(ArchiveCuts, AreWhereAllProcessesBeganAnew) {
  FirstRun();
  Navigator(30, Mark::kStart);
  Lidar(31, Mark::kStart);
  Tracker(32, 32);
  EXPECT_EQ(finder_.cuts_us(), std::vector<std::int64_t>{30});
}

TEST_F(ArchiveCuts, AreNoneWhereTheTrackerWentOn) {
  FirstRun();
  Navigator(30, Mark::kStart);
  Lidar(31, Mark::kStart);
  Tracker(32, 12);
  Tracker(33, 33);
  EXPECT_TRUE(finder_.cuts_us().empty());
}

TEST_F(ArchiveCuts, AreNoneWhereOneProcessWentOn) {
  FirstRun();
  Lidar(30, Mark::kStart);
  Navigator(31, Mark::kNone);
  Tracker(32, 32);
  EXPECT_TRUE(finder_.cuts_us().empty());
}

TEST_F(ArchiveCuts, WaitForASecondLidarToo) {
  const auto second = [this](std::int64_t time_us, Mark mark) { finder_.AddRaw(bus::kLidarPackets2.name, time_us, mark); };
  second(9, Mark::kStart);
  FirstRun();
  second(22, Mark::kEnd);
  Navigator(30, Mark::kStart);
  Lidar(31, Mark::kStart);
  Tracker(32, 32);
  EXPECT_TRUE(finder_.cuts_us().empty());
  second(33, Mark::kStart);
  EXPECT_EQ(finder_.cuts_us(), std::vector<std::int64_t>{30});
}

TEST_F(ArchiveCuts, AreNoneWithoutAnEndMark) {
  Lidar(10, Mark::kStart);
  Navigator(11, Mark::kStart);
  Tracker(12, 12);
  Lidar(20, Mark::kEnd);
  Navigator(30, Mark::kStart);
  Lidar(31, Mark::kStart);
  Tracker(32, 32);
  EXPECT_TRUE(finder_.cuts_us().empty());
}

TEST_F(ArchiveCuts, AreNoneWithoutAlerts) {
  Lidar(10, Mark::kStart);
  Lidar(20, Mark::kEnd);
  Lidar(30, Mark::kStart);
  finder_.AddAlerts(31, Alerts(31, true));
  EXPECT_TRUE(finder_.cuts_us().empty());
}

TEST_F(ArchiveCuts, AreTakenBackWhereAClockGoesBackBehindThem) {
  FirstRun();
  Navigator(30, Mark::kStart);
  Lidar(31, Mark::kStart);
  Tracker(32, 32);
  Lidar(25, Mark::kNone);
  EXPECT_TRUE(finder_.cuts_us().empty());
}

TEST_F(ArchiveCuts, AreNoneWhereTheNextRunBeginsAtAnEarlierTime) {
  FirstRun();
  Navigator(21, Mark::kStart);
  Lidar(31, Mark::kStart);
  Tracker(32, 32);
  EXPECT_TRUE(finder_.cuts_us().empty());
}

}  // namespace
