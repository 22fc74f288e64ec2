// Files of another kind than a program reads: a word in the terminal, the exit code of a file that cannot be read, and the command that helps.
#include <sys/stat.h>

#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/child.hpp"
#include "tests/support/files.hpp"

namespace lookout::system_test {
namespace {

using namespace support;
using std::string_literals::operator""s;

// lookout-page served a capture as a log that holds nothing, a pipe held whoever opened it, and nothing said what to do instead.
TEST(OtherFiles, AreNamedByEachProgramWithTheCommandThatHelps) {
  const TempDir folder;
  const auto path = [&folder](const std::string& name) { return (folder / name).string(); };
  WriteFile(folder / "capture", "\xD4\xC3\xB2\xA1\2\0\4\0"s + std::string(12, '\0') + "\1\0\0\0"s);
  WriteFile(folder / "packed", "\x1F\x8B\x08\0"s);
  WriteFile(folder / "bag", "#ROSBAG V2.0\n");
  WriteFile(folder / "sentences", "$GPHDT,90.0,T*0C\r\n");
  WriteFile(folder / "empty", "");
  std::filesystem::create_directory(folder / "folder");
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  const std::string config = kDemoConfig.string();
  const std::string none = path("none");

  struct Program {
    std::vector<std::string> command;  // the file stands behind it
    int exit_code;
    bool reads_captures;
  };
  const std::vector<Program> programs{{{Bin("page"), "--log"}, 1, false},
                                      {{Bin("export"), "--table", "pose", "--in"}, 1, false},
                                      {{Bin("log"), "info"}, 1, false},
                                      {{Bin("log"), "slice", "--out", none, "--in"}, 1, false},
                                      {{Bin("eval"), "--in"}, 1, false},
                                      {{Bin("diff"), path("capture")}, 2, false},
                                      {{Bin("import"), "--config", config, "--out", none, "--in"}, 1, false},
                                      {{Bin("replay"), "--config", config, "--out", none, "--in"}, 1, true}};
  const std::vector<std::pair<std::string, std::string>> kinds{{"capture", "lookout-replay --config DIR --in " + path("capture")},
                                                               {"sentences", "lookout-replay --config DIR --in " + path("sentences")},
                                                               {"packed", "gunzip -k " + path("packed")},
                                                               {"bag", "is a ROS bag"},
                                                               {"empty", "is empty"},
                                                               {"folder", "is a folder"},
                                                               {"pipe", "is a pipe"}};
  for (const auto& program : programs) {
    for (const auto& [file, words] : kinds) {
      if (program.reads_captures && (file == "capture" || file == "sentences")) continue;
      auto command = program.command;
      command.push_back(path(file));
      const auto result = RunProgram(command, path("out"));
      EXPECT_EQ(result.exit_code, program.exit_code) << command.front() << " " << file;
      // The first of two files that are compared is the capture.
      const auto& expected = program.exit_code == 2 ? kinds.front().second : words;
      EXPECT_NE(result.output.find(expected), std::string::npos) << command.front() << " " << file << ": " << result.output;
    }
  }
  EXPECT_FALSE(std::filesystem::exists(none));
}

}  // namespace
}  // namespace lookout::system_test
