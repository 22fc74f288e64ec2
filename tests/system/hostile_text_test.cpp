// Text of others: in logs, in configs. What programs print of it reaches a terminal, what they export a spreadsheet.
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>
#include <string>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "common/bus/services.hpp"
#include "lookout/health_t.hpp"
#include "lookout/run_info_t.hpp"
#include "tests/support/child.hpp"
#include "tests/support/file_log.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::system_test {
namespace {

using namespace support;
namespace fs = std::filesystem;

constexpr char kEvil[] =
    "=\033[31m\033]0;owned\a\x9B"
    "2J";

class HostileText : public ::testing::Test {
 protected:
  void SetUp() override { fs::copy(kDemoConfig, folder_ / "config"); }

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  // Standard output and standard error together.
  RunResult Run(const std::string& tool, const std::vector<std::string>& options) {
    std::vector<std::string> command{Bin(tool)};
    command.insert(command.end(), options.begin(), options.end());
    return RunProgram(command, Path("out"));
  }
  static void ExpectPrintable(const RunResult& result, const std::string& what) {
    const bool is_printable = std::ranges::all_of(result.output, [](char letter) { return letter == '\n' || (letter >= ' ' && letter <= '~'); });
    EXPECT_TRUE(is_printable) << what << ": " << ::testing::PrintToString(result.output);
  }

  // A log of one process whose every text is hostile.
  void WriteLog() {
    {
      std::ofstream text(Path("day.nmea"));
      for (int second = 0; second < 3; ++second) text << navigator::RmcLine(navigator::NoonPlus(second), 50.0, 8.0, 1.0, 0.0) << "\r\n";
    }
    ASSERT_EQ(Run("replay", {"--config", Path("config"), "--in", Path("day.nmea"), "--out", Path("day")}).exit_code, 0);
    bus::LogReader reader(Path("day"));
    support::FileLog writer(Path("evil"));
    while (auto event = reader.Next()) {
      if (event->channel == bus::kRunInfo.name) {
        auto run_info = *bus::Decode<run_info_t>(event->bytes);
        for (auto* text : {&run_info.program, &run_info.version, &run_info.host}) *text = kEvil;
        run_info.file_name.emplace_back(std::string(kEvil) + ".txtpb");
        run_info.file_text.emplace_back(kEvil);
        run_info.file_name.emplace_back("machine.txt");
        run_info.file_text.emplace_back(std::string("kernel: ") + kEvil + "\n");
        run_info.num_files = static_cast<std::int32_t>(run_info.file_name.size());
        writer.Write(event->time, event->channel, bus::Encode(run_info));
      } else {
        writer.Write(event->time, event->channel, event->bytes);
      }
    }
    health_t health{};
    health.process = health.host = health.reason = kEvil;
    writer.Write(navigator::NoonPlus(3), bus::kHealth.name, bus::Encode(health));
    writer.Write(navigator::NoonPlus(3), kEvil, bus::Encode(health));
    writer.Flush();
  }

  TempDir folder_;
};

TEST_F(HostileText, OfALogReachesNoTerminalAsAnEscapeSequence) {
  WriteLog();
  const auto replay = Run("replay", {"--config", Path("config"), "--in", Path("evil"), "--out", Path("again")});
  EXPECT_EQ(replay.exit_code, 0) << replay.output;
  EXPECT_NE(replay.output.find("=?[31m"), std::string::npos) << "the name of the file that differs is told\n" << replay.output;
  ExpectPrintable(replay, "replay");
  ExpectPrintable(Run("log", {"info", Path("evil")}), "log info");
  ExpectPrintable(Run("log", {"repair", Path("evil"), Path("repaired")}), "log repair");
  ExpectPrintable(Run("diff", {Path("evil"), Path("day")}), "diff");
  ExpectPrintable(Run("eval", {"--in", Path("evil")}), "eval");
  for (const char* table : {"health", "counters", "traffic", "fixes", "pose"}) {
    const auto exported = Run("export", {"--in", Path("evil"), "--table", table});
    ExpectPrintable(exported, table);
    EXPECT_EQ(exported.output.find(",="), std::string::npos) << exported.output;
  }
}

TEST_F(HostileText, OfAConfigReachesNoTerminalAsAnEscapeSequence) {
  std::ofstream(Path("config/lidar.txtpb")) << "source: UDP\nbind_address: '" << kEvil << "'\ncut_azimuth_deg: 0\n" << kEvil << "\n";
  const auto result = Run("lidar", {"--config", Path("config"), "--check"});
  EXPECT_EQ(result.exit_code, 2);
  ExpectPrintable(result, "lidar --check");
}

// They hung, deaf to SIGTERM.
TEST_F(HostileText, AsAConfigThatIsAFifoIsRefused) {
  fs::remove(folder_ / "config/boat.txtpb");
  ASSERT_EQ(mkfifo(Path("config/boat.txtpb").c_str(), 0600), 0);
  auto programs = bus::StartOrder();
  programs.insert(programs.end(), {"replay", "doctor"});
  for (const auto& program : programs) {
    const auto result = Run(program, {"--config", Path("config"), "--check"});
    EXPECT_EQ(result.exit_code, 2) << program << result.output;
    EXPECT_NE(result.output.find("boat.txtpb:1: file: is no regular file"), std::string::npos) << program << result.output;
  }
  const auto sim = Run("sim", {"--config", Path("config"), "--scene", "lake", "--seed", "1", "--seconds", "1", "--pcap", Path("x")});
  EXPECT_NE(sim.output.find("is no regular file"), std::string::npos) << sim.output;
}

}  // namespace
}  // namespace lookout::system_test
