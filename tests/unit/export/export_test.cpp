#include "tools/export/export.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>

#include "common/io/stop_signal.hpp"
#include "common/messages/words.hpp"
#include "tests/support/file_log.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/export/export_logs.hpp"

namespace lookout::exporter {
namespace {

TEST_F(ExportTest, FailsOnAMissingLogAndLeavesNoFile) {
  EXPECT_EQ(Export("pose"), kExitFailed);
  EXPECT_NE(errors_.find("no such file"), std::string::npos) << errors_;
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(ExportTest, FailsWhenTheLogHoldsNothingOfTheTableAndLeavesNoFile) {
  Add(bus::kLidarScan, MakeScan(0));
  EXPECT_EQ(Export("pose"), kExitFailed);
  EXPECT_NE(errors_.find("holds no POSE"), std::string::npos) << errors_;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.partial"));
}

TEST_F(ExportTest, KeepsAnOlderFileWhenItFails) {
  std::ofstream(folder_ / "out") << "yesterday";
  Add(bus::kLidarScan, MakeScan(0));
  EXPECT_EQ(Export("pose"), kExitFailed);
  EXPECT_EQ(text_, "yesterday");
}

TEST_F(ExportTest, RefusesAFileThatExistsUnlessItIsForced) {
  std::ofstream(folder_ / "out") << "yesterday";
  Add(bus::kPose, pose_t{});
  Request request{.inputs = {log_}, .table = "pose", .output = folder_ / "out"};
  EXPECT_EQ(Export(request), kExitFailed);
  EXPECT_EQ(text_, "yesterday");
  EXPECT_NE(errors_.find("exists already; --force replaces it"), std::string::npos) << errors_;
  request.force = true;
  EXPECT_EQ(Export(request), kExitFine);
  EXPECT_EQ(Rows().size(), 1U);
}

TEST_F(ExportTest, SaysWhatIsWrongWithTheRequest) {
  Add(bus::kLidarScan, MakeScan(0));
  EXPECT_EQ(Export("pose", "ply"), kExitUsage);
  EXPECT_NE(errors_.find("for --table returns only"), std::string::npos) << errors_;
  EXPECT_EQ(Export("segments", "svg"), kExitUsage);
  EXPECT_EQ(Export("returns", "xlsx"), kExitUsage);
  EXPECT_EQ(Export("retruns"), kExitUsage);
  EXPECT_EQ(Export("returns", "csv", 3), kExitUsage);
  EXPECT_EQ(Export(Request{.inputs = {log_}, .table = "returns", .output = log_}), kExitUsage);
  EXPECT_NE(errors_.find("is one of the inputs"), std::string::npos) << errors_;
}

TEST_F(ExportTest, CountsMessagesThatItCannotTakeAndGoesOn) {
  auto bytes = bus::Encode(MakeScan(0));
  bytes.pop_back();
  AddBytes("LIDAR_SCAN", bytes);
  auto scan = MakeScan(1);
  scan.num_parts = 0;
  Add(bus::kLidarScan, scan);
  Add(bus::kLidarScan, MakeScan(2, 1));
  AddBytes("SEGMENTS", {1, 2, 3});
  EXPECT_EQ(Export("returns"), kExitFine);
  EXPECT_EQ(Rows().size(), 2U);
  EXPECT_NE(errors_.find("1 messages of LIDAR_SCAN could not be decoded"), std::string::npos) << errors_;
  EXPECT_NE(errors_.find("1 messages of LIDAR_SCAN contradict themselves"), std::string::npos) << errors_;
  EXPECT_NE(errors_.find("1 messages of SEGMENTS could not be decoded"), std::string::npos) << errors_;
}

// SEGMENTS of a version before, whose type had another fingerprint: that is no damage, and a replay makes them anew.
TEST_F(ExportTest, SaysWhatToDoAboutTypesOfAnotherVersion) {
  auto bytes = bus::Encode(MakeSegments(MakeScan(0)));
  bytes[7] ^= 1;
  Add(bus::kLidarScan, MakeScan(0));
  for (int i = 0; i < 2; ++i) AddBytes("SEGMENTS", bytes);
  const std::string said =
      "lookout-export: 2 messages of SEGMENTS are of another type than this version's SEGMENTS: lookout-replay makes SEGMENTS anew of the log\n";
  EXPECT_EQ(Export("returns"), kExitFine);
  EXPECT_EQ(errors_, said);
  EXPECT_EQ(Export("segments"), kExitFailed);
  EXPECT_TRUE(errors_.starts_with(said)) << errors_;
  EXPECT_TRUE(errors_.ends_with("lookout-export: the input holds no SEGMENTS of this version's type\n")) << errors_;
}

TEST_F(ExportTest, WritesTheHeaderOnceAlsoWhenTheFirstMessagesAreBad) {
  AddBytes("POSE", {});
  AddBytes("POSE", {0});
  Add(bus::kPose, pose_t{});
  EXPECT_EQ(Export("pose"), kExitFine);
  EXPECT_EQ(Rows().size(), 1U);
  EXPECT_TRUE(text_.starts_with("utime_us,latitude_deg"));
}

TEST_F(ExportTest, SkipsDamagedStretchesAndSaysSo) {
  for (int seq = 0; seq < 3; ++seq) Add(bus::kPose, pose_t{});
  writer_.reset();
  std::filesystem::resize_file(log_, std::filesystem::file_size(log_) - 5);
  EXPECT_EQ(Export("pose"), kExitFine);
  EXPECT_EQ(Rows().size(), 2U);
  EXPECT_NE(errors_.find("1 damaged stretches skipped"), std::string::npos) << errors_;
}

TEST_F(ExportTest, ReadsSeveralLogsAsOneAlsoAcrossTheLabelsOfAScan) {
  Add(bus::kLidarScan, MakeScan(0, 1));
  const auto first = log_;
  writer_.reset();
  log_ = folder_ / "log2";
  Add(bus::kSegments, MakeSegments(MakeScan(0, 1), 5));
  EXPECT_EQ(Export(Request{.inputs = {first, log_}, .table = "returns", .output = folder_ / "out"}), kExitFine);
  ASSERT_EQ(Rows().size(), 2U);
  EXPECT_TRUE(Rows()[0].ends_with(",5,,,5"));
}

TEST_F(ExportTest, EndsWithoutAFileWhenItIsStopped) {
  Add(bus::kPose, pose_t{});
  writer_.reset();
  const pid_t child = fork();  // what is asked stays asked in a process
  if (child == 0) {
    io::CatchStopSignals();
    raise(SIGINT);
    std::ostringstream errors;
    const int code = exporter::Run({.inputs = {log_}, .table = "pose", .output = folder_ / "out"}, errors);
    _exit(errors.str().find("stopped by SIGINT") != std::string::npos ? code : -1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), kExitFailed);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.partial"));
}

TEST_F(ExportTest, PlyHoldsOneVertexPerReturnOfTheScan) {
  Add(bus::kLidarScan, MakeScan(0));
  Add(bus::kSegments, MakeSegments(MakeScan(0), 1));
  Add(bus::kLidarScan, MakeScan(1, 1));
  Add(bus::kSegments, MakeSegments(MakeScan(1, 1), 2));
  ASSERT_EQ(Export("returns", "ply"), kExitFine) << errors_;
  EXPECT_NE(text_.find("element vertex 2\n"), std::string::npos);
  EXPECT_NE(text_.find("scan 1,"), std::string::npos);
  const std::string end = "end_header\n";
  const auto body = text_.substr(text_.find(end) + end.size());
  constexpr std::size_t kVertexBytes = 3 * 4 + 3 + 4 + 4 + 2;
  ASSERT_EQ(body.size(), 2 * kVertexBytes);
  EXPECT_EQ(body.substr(kVertexBytes, 4), std::string("\0\0\x20\x41", 4));  // x = 10.0F of the upper ring
  EXPECT_EQ(body[kVertexBytes + 19], 2);                                    // label
  EXPECT_EQ(body[kVertexBytes + 23], 1);                                    // ring
  ASSERT_EQ(Export("returns", "ply", 0), kExitFine);
  EXPECT_NE(text_.find("element vertex 4\n"), std::string::npos);
  EXPECT_EQ(Export("returns", "ply", 9), kExitFailed);
  EXPECT_NE(errors_.find("no scan 9"), std::string::npos) << errors_;
}

TEST_F(ExportTest, PcdHoldsOnePointPerReturnOfTheScan) {
  Add(bus::kLidarScan, MakeScan(0));
  Add(bus::kSegments, MakeSegments(MakeScan(0), 1));
  Add(bus::kLidarScan, MakeScan(1, 1));
  Add(bus::kSegments, MakeSegments(MakeScan(1, 1), 2));
  ASSERT_EQ(Export("returns", "pcd"), kExitFine) << errors_;
  EXPECT_NE(text_.find("\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA binary\n"), std::string::npos);
  const std::string end = "DATA binary\n";
  const auto body = text_.substr(text_.find(end) + end.size());
  constexpr std::size_t kPointBytes = 3 * 4 + 4 + 4 + 2 + 4;
  ASSERT_EQ(body.size(), 2 * kPointBytes);
  EXPECT_EQ(body.substr(kPointBytes, 4), std::string("\0\0\x20\x41", 4));  // x = 10.0F of the upper ring
  EXPECT_EQ(body[kPointBytes + 16], 2);                                    // label
  EXPECT_EQ(body[kPointBytes + 20], 1);                                    // ring
  EXPECT_EQ(Export("returns", "pcd", 9), kExitFailed);
  EXPECT_EQ(Export("pose", "pcd"), kExitUsage);
}

TEST_F(ExportTest, PlyColoursTellSegmentsApart) {
  auto scan = MakeScan(0, 1);
  auto segments = MakeSegments(scan);
  segments.label = {1, 2};
  Add(bus::kLidarScan, scan);
  Add(bus::kSegments, segments);
  ASSERT_EQ(Export("returns", "ply"), kExitFine);
  const auto body = text_.substr(text_.find("end_header\n") + 11);
  EXPECT_NE(body.substr(12, 3), body.substr(25 + 12, 3));
}

TEST(ExportProgram, EndsQuietlyWhenNobodyReads) {
  const std::string program = support::Bin("export");
  ASSERT_TRUE(std::filesystem::exists(program)) << program << " is not built";
  const support::TempDir folder;
  const auto log = folder / "log";
  {
    support::FileLog writer(log);
    for (int i = 0; i < 20'000; ++i) writer.Write(Utime(std::chrono::microseconds(kStartUs)), "POSE", bus::Encode(pose_t{}));
  }
  const std::string command = "bash -c 'set -o pipefail; " + program + " --in " + log.string() + " --table pose | head -n 1 > /dev/null'";
  EXPECT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(std::system((program + " --in /nonexistent --table pose 2> /dev/null").c_str()) >> 8, kExitFailed);
  EXPECT_EQ(std::system((program + " --table pose > /dev/null 2>&1").c_str()) >> 8, kExitUsage);
  EXPECT_EQ(std::system((program + " --in " + log.string() + " --table nothing > /dev/null 2>&1").c_str()) >> 8, kExitUsage);
  EXPECT_EQ(std::system((program + " --in " + log.string() + " --table returns --format ply --scan x > /dev/null 2>&1").c_str()) >> 8, kExitUsage);
  EXPECT_EQ(std::system((program + " --help > /dev/null").c_str()), 0);
  EXPECT_EQ(std::system((program + " --version > /dev/null").c_str()), 0);
  std::filesystem::remove(log);
}

TEST(Words, StandInTheReadmeOfTheWire) {
  std::ifstream file(support::kSources / "lcmtypes/README.md");
  ASSERT_TRUE(file);
  std::ostringstream readme;
  readme << file.rdbuf();
  const auto expect_listed = [&](const auto& list) {
    for (const auto& word : list) {
      EXPECT_NE(readme.str().find("`" + std::string(word.text) + "`"), std::string::npos) << word.text << " is not in lcmtypes/README.md";
    }
  };
  expect_listed(words::kReason);
  expect_listed(words::kObstacleStatus);
  expect_listed(words::kConfidence);
  expect_listed(words::kGround);
  expect_listed(words::kKind);
  expect_listed(words::kTrackStatus);
  expect_listed(words::kTrackKind);
  expect_listed(words::kEncounter);
  expect_listed(words::kAisSender);
  expect_listed(words::kAisState);
  expect_listed(words::kHeadingSource);
  expect_listed(words::kAlertCause);
  expect_listed(words::kAlertLevel);
  expect_listed(words::kAlertState);
  expect_listed(words::kPoseStatus);
  expect_listed(words::kTimeSource);
  expect_listed(words::kClockState);
  expect_listed(words::kFixQuality);
  expect_listed(words::kHealthState);
}

}  // namespace
}  // namespace lookout::exporter
