// A text log that lookout-navigator plays live, recorded, beside its replay.
#include <chrono>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/log_file.hpp"
#include "tests/support/live_test.hpp"
#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::system_test {
namespace {

using namespace support;
namespace fs = std::filesystem;
using std::chrono::milliseconds;
// At a speed other than 1 poses had the stamps of the computer's clock, and were off by the way of the boat.
class LiveTextLog : public LiveTest {};

TEST_F(LiveTextLog, AtTwentyTimesTheSpeedIsRecordedAsItIsReplayed) {
  {
    std::ofstream log(folder_ / "day.nmea");
    for (int second = 0; second < 60; ++second) {
      log << navigator::RmcLine(navigator::NoonPlus(second), 50.0 + second * 9e-5, 8.0, 10.0, 0.0) << "\r\n" << navigator::HdtLine(0.5) << "\r\n";
    }
    std::ofstream(folder_ / "config/navigator.txtpb") << "# proto-file: config/schema/navigator.proto\n# proto-message: lookout.config.Navigator\n"
                                                         "source: LIVE use_lidar_nmea: false\n"
                                                         "heading_offset_deg: 0 pitch_offset_deg: 0 roll_offset_deg: 0\n"
                                                         "input { name: 'day' text_log { file: '../day.nmea' speed: 20 } }\n";
  }
  Child recorder({Bin("recorder"), "--config", Config()}, (folder_ / "recorder.out").string());
  std::this_thread::sleep_for(milliseconds(700));
  const auto played = RunProgram({Bin("navigator"), "--config", Config()}, (folder_ / "navigator.out").string());
  EXPECT_EQ(played.exit_code, 0) << played.output;
  EXPECT_NE(played.output.find("plays a text log of 2026-06-01 12:00:00 UTC, so POSE is not of now"), std::string::npos) << played.output;
  std::this_thread::sleep_for(milliseconds(300));
  EXPECT_EQ(recorder.Terminate().value_or(-1), 0) << recorder.Output();
  const auto replay =
      RunProgram({Bin("replay"), "--config", Config(), "--in", (folder_ / "day.nmea").string(), "--out", (folder_ / "again").string()},
                 (folder_ / "replay.out").string());
  ASSERT_EQ(replay.exit_code, 0) << replay.output;
  const auto live = ReadLog(FirstLogIn(folder_ / "logs"));
  const auto again = ReadLog(folder_ / "again");
  ASSERT_EQ(again.at("POSE").size(), 2951U);
  EXPECT_TRUE(live.contains("POSE") && live.at("POSE") == again.at("POSE")) << (live.contains("POSE") ? live.at("POSE").size() : 0);
}

}  // namespace
}  // namespace lookout::system_test
