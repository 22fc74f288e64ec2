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
#include "tests/system/child.hpp"
#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::system_test {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using Payloads = std::map<std::string, std::vector<std::vector<std::uint8_t>>>;

Payloads Read(const fs::path& file) {
  Payloads payloads;
  bus::LogReader reader(file);
  while (auto event = reader.Next()) payloads[event->channel].push_back(std::move(event->bytes));
  return payloads;
}

// At a speed other than 1 poses had the stamps of the computer's clock, and were off by the way of the boat.
TEST(LiveTextLog, AtTwentyTimesTheSpeedIsRecordedAsItIsReplayed) {
  const auto folder = fs::temp_directory_path() / ("lookout_live_text_log_" + std::to_string(getpid()));
  const auto start_folder = fs::current_path();
  fs::create_directories(folder);
  fs::copy(fs::path(LOOKOUT_SOURCE_DIR) / "config/demo", folder / "config");
  fs::current_path(folder);  // the recorder's logs/ is made here
  {
    std::ofstream log(folder / "day.nmea");
    for (int second = 0; second < 60; ++second) {
      log << navigator::RmcLine(navigator::NoonPlus(second), 50.0 + second * 9e-5, 8.0, 10.0, 0.0) << "\r\n" << navigator::HdtLine(0.5) << "\r\n";
    }
    std::ofstream(folder / "config/navigator.txtpb") << "# proto-file: config/schema/navigator.proto\n# proto-message: lookout.config.Navigator\n"
                                                        "source: LIVE use_lidar_nmea: false\n"
                                                        "heading_offset_deg: 0 pitch_offset_deg: 0 roll_offset_deg: 0\n"
                                                        "input { name: 'day' text_log { file: '../day.nmea' speed: 20 } }\n";
  }
  const auto bin = [](const std::string& name) { return std::string(LOOKOUT_BIN_DIR) + "/lookout-" + name; };
  const auto config = (folder / "config").string();
  Child recorder({bin("recorder"), "--config", config}, (folder / "recorder.out").string());
  std::this_thread::sleep_for(milliseconds(700));
  const auto played = RunProgram({bin("navigator"), "--config", config}, (folder / "navigator.out").string());
  EXPECT_EQ(played.exit_code, 0) << played.output;
  EXPECT_NE(played.output.find("plays a text log of 2026-06-01 12:00:00 UTC, so POSE is not of now"), std::string::npos) << played.output;
  std::this_thread::sleep_for(milliseconds(300));
  EXPECT_EQ(recorder.Terminate().value_or(-1), 0) << recorder.Output();
  fs::path recording;
  for (const auto& entry : fs::directory_iterator(folder / "logs")) {
    if (entry.path().extension() == ".lcmlog") recording = entry.path();
  }
  const auto replay = RunProgram({bin("replay"), "--config", config, "--in", (folder / "day.nmea").string(), "--out", (folder / "again").string()},
                                 (folder / "replay.out").string());
  ASSERT_EQ(replay.exit_code, 0) << replay.output;
  const auto live = Read(recording);
  const auto again = Read(folder / "again");
  ASSERT_EQ(again.at("POSE").size(), 2951U);
  EXPECT_TRUE(live.contains("POSE") && live.at("POSE") == again.at("POSE")) << (live.contains("POSE") ? live.at("POSE").size() : 0);
  fs::current_path(start_folder);
  if (!::testing::Test::HasFailure()) fs::remove_all(folder);
}

}  // namespace
}  // namespace lookout::system_test
