// lookout-replay on real recordings where they are at hand, on inputs that are wrong, and on text logs.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <set>
#include <string>

#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "lookout/gnss_fix_t.hpp"
#include "lookout/lidar_packets_t.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/pose_t.hpp"
#include "tests/support/child.hpp"
#include "tests/support/file_log.hpp"
#include "tests/support/files.hpp"
#include "tests/system/replay_fixture.hpp"

namespace lookout::system_test {
namespace {

using namespace support;

struct RealCapture {
  const char* file;
  int num_whole;
  int num_partial;
};

class ReplayOfRealCaptures : public Replay, public ::testing::WithParamInterface<RealCapture> {};

TEST_P(ReplayOfRealCaptures, CutsTurnsAndGivesTheSameBytesEachTime) {
  const auto capture = data_ / "vlp16" / GetParam().file;
  if (!fs::exists(capture)) GTEST_SKIP() << "no recording at " << capture;
  ExpectSameBytes(capture.string());
  EXPECT_EQ(CountTurns("first"), std::pair(GetParam().num_whole, GetParam().num_partial));
  EXPECT_EQ(RawRanges("first"), ExportedRanges("first"));
}

INSTANTIATE_TEST_SUITE_P(Vlp16, ReplayOfRealCaptures,
                         ::testing::Values(RealCapture{"mrpt_sample_velodyne_vlp16_gps.pcap", 3, 2}, RealCapture{"einride_vlp16_1000pkt.pcap", 12, 2},
                                           RealCapture{"rlu_vlp16_example.pcap", 0, 2}),
                         [](const auto& capture) {
                           const std::string file = capture.param.file;
                           return file.substr(0, file.find('_'));
                         });

TEST_F(Replay, OfACaptureWithAFixAndNoHeadingPlacesTheBoatAndNotTheObstacles) {
  const auto capture = data_ / "vlp16/mrpt_sample_velodyne_vlp16_gps.pcap";
  if (!fs::exists(capture)) GTEST_SKIP() << "no recording at " << capture;
  ASSERT_EQ(ReplayTo(capture.string(), "log").exit_code, 0);
  std::map<int, int> packets;
  for (const auto& bundle : Messages<lidar_packets_t>("log", "LIDAR_PACKETS")) {
    for (const int size : bundle.size_bytes) ++packets[size];
  }
  EXPECT_EQ(packets, (std::map<int, int>{{512, 57}, {1206, 293}}));
  int num_known = 0;
  for (const auto& pose : Messages<pose_t>("log", "POSE")) {
    if (pose.status != pose_t::STATUS_NO_HEADING) continue;
    ++num_known;
    EXPECT_NEAR(pose.latitude_deg, 36.829131, 1.0 / 111000.0);
    EXPECT_NEAR(pose.longitude_deg, -2.407572, 1.0 / 89000.0);
  }
  EXPECT_GT(num_known, 5);
  std::set<std::int64_t> turns;
  int num_obstacles = 0;
  for (const auto& message : Messages<obstacles_t>("log", "OBSTACLES")) {
    turns.insert(message.seq);
    for (const auto& obstacle : message.obstacles) {
      ++num_obstacles;
      EXPECT_EQ(obstacle.status, obstacle_t::STATUS_VESSEL_FRAME_ONLY);
      EXPECT_TRUE(std::isnan(obstacle.latitude_deg));
    }
  }
  EXPECT_EQ(turns.size(), 5U);  // the end of input flushes what waits
  EXPECT_GT(num_obstacles, 0);
}

TEST_F(Replay, RefusesTheWrongLidar) {
  const auto capture = data_ / "other_lidar/vv_hdl32_monterey.pcap";
  if (!fs::exists(capture)) GTEST_SKIP() << "no recording at " << capture;
  const auto result = ReplayTo(capture.string(), "log");
  EXPECT_EQ(result.exit_code, 1) << result.output;
  EXPECT_NE(result.output.find("HDL-32E"), std::string::npos) << result.output;
  EXPECT_FALSE(fs::exists(Path("log"))) << "an output of a run that failed";
}

TEST_F(Replay, OfBrokenCapturesEndsWithAClearErrorOrACountedRefusal) {
  if (!fs::exists(data_ / "bad_pcap")) GTEST_SKIP() << "no recordings at " << data_;
  int num_files = 0;
  for (const auto& folder : {"bad_pcap", "other_lidar"}) {
    for (const auto& entry : fs::directory_iterator(data_ / folder)) {
      const auto result = ReplayTo(entry.path().string(), "log");
      EXPECT_EQ(result.exit_code, 1) << entry.path() << ": " << result.output;
      EXPECT_NE(result.output.find("critical"), std::string::npos) << entry.path() << ": " << result.output;
      ++num_files;
    }
  }
  EXPECT_GE(num_files, 14);
}

TEST_F(Replay, DoesNotOverwriteItsInput) {
  std::ofstream(Path("in")) << "x";
  const auto result = ReplayTo(Path("in"), "in");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(ReadFile(folder_ / "in"), "x");
}

TEST_F(Replay, SaysWhichLineOfAConfigIsWrong) {
  fs::copy(config_, folder_ / "config");
  const auto text = ReadFile(folder_ / "config/lidar.txtpb");
  const auto line = std::to_string(std::ranges::count(text, '\n') + 1);
  std::ofstream(folder_ / "config/lidar.txtpb", std::ios::app) << "no_such_field: 1\n";
  const auto result = RunProgram({Bin("replay"), "--config", Path("config"), "--check"}, Path("check.out"));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.output.find("lidar.txtpb:" + line + ": "), std::string::npos) << result.output;
}

TEST_F(Replay, ChecksTheConfigAndPrintsWhatIsInForce) {
  const auto result = RunProgram({Bin("replay"), "--config", config_, "--check"}, Path("check.out"));
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NE(result.output.find("e1_cosine: 0.95  # default"), std::string::npos) << result.output;
}

// A boat in Amsterdam, 20 minutes (Signal K project).
TEST_F(Replay, ATextLogOfSentencesGivesATrack) {
  const auto log = data_ / "nmea/signalk_gps.log";
  if (!fs::exists(log)) GTEST_SKIP() << log << " is not there";
  const auto result = ReplayTo(log.string(), "track");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const auto poses = Messages<pose_t>("track", "POSE");
  // 08:54:11 to 09:14, every 20 ms.
  EXPECT_GT(poses.size(), 50'000U);
  const auto is_placed = [](const pose_t& pose) { return std::isfinite(pose.latitude_deg); };
  const auto num_placed = std::count_if(poses.begin(), poses.end(), is_placed);
  EXPECT_GT(num_placed, static_cast<std::ptrdiff_t>(0.9 * static_cast<double>(poses.size())));
  for (const auto& pose : poses) {
    if (!is_placed(pose)) continue;
    ASSERT_NEAR(pose.latitude_deg, 52.37, 0.1);
    ASSERT_NEAR(pose.longitude_deg, 4.91, 0.2);
  }
  const auto track =
      RunProgram({Bin("export"), "--in", Path("track"), "--table", "pose", "--format", "svg", "--out", Path("track.svg")}, Path("export.out"));
  EXPECT_EQ(track.exit_code, 0) << track.output;
  EXPECT_NE(ReadFile(Path("track.svg")).find("polyline"), std::string::npos);
}

TEST_F(Replay, ATextLogGivesTheSameBytesEachTime) {
  std::ofstream log(Path("day.nmea"));
  for (int second = 0; second < 10; ++second) {
    const std::string body =
        "GPRMC,08541" + std::to_string(second) + ".00,A,5222.32" + std::to_string(second) + "0,N,00454.5778,E,3.60,0.0,030414,,,A";
    int sum = 0;
    for (const char letter : body) sum ^= letter;
    log << '$' << body << '*' << "0123456789ABCDEF"[sum / 16] << "0123456789ABCDEF"[sum % 16] << "\r\n";
  }
  log.close();
  ExpectSameBytes(Path("day.nmea"));
  EXPECT_GT(Messages<pose_t>("first", "POSE").size(), 400U);
  EXPECT_EQ(Messages<gnss_fix_t>("first", "GNSS_FIX").size(), 10U);
}

}  // namespace
}  // namespace lookout::system_test
