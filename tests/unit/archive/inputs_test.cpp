// What units are made of: config folders, programs, truths and recordings, and how their changes are noticed.
#include <chrono>
#include <gtest/gtest.h>
#include <sstream>
#include <stdexcept>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/lidar_beams_t.hpp"
#include "lookout/lidar_clock_t.hpp"
#include "lookout/lidar_packets_t.hpp"
#include "tests/unit/archive/support.hpp"
#include "tools/archive/programs.hpp"
#include "tools/archive/recording.hpp"
#include "tools/archive/walk.hpp"
#include "tools/archive/work.hpp"

namespace {

using namespace lookout;
using support::WriteFile;
namespace fs = std::filesystem;

class ArchiveInputs : public ::testing::Test {
 protected:
  support::TempDir dir_;
};

TEST_F(ArchiveInputs, AConfigIsAllFilesBelowItsFolder) {
  const auto config = dir_.path() / "config";
  fs::create_directories(config / "evidence");
  fs::create_directories(config / ".git");
  WriteFile(config / "segmenter.txtpb", "evidence: \"evidence/mine.txtpb\"");
  WriteFile(config / "evidence/mine.txtpb", "1");
  WriteFile(config / ".git/index", "1");
  fs::create_symlink("nowhere", config / "dangling");
  EXPECT_EQ(archive::FilesOfConfig(config), (std::vector<fs::path>{"evidence/mine.txtpb", "segmenter.txtpb"}));
  const auto digest = archive::DigestOfConfig(config);
  WriteFile(config / ".git/index", "2");
  EXPECT_EQ(archive::DigestOfConfig(config), digest);
  WriteFile(config / "evidence/mine.txtpb", "2");
  EXPECT_NE(archive::DigestOfConfig(config), digest);
}

TEST_F(ArchiveInputs, AConfigWhoseFoldersLeadInACircleIsRefused) {
  fs::create_directory_symlink(dir_.path(), dir_.path() / "again");
  EXPECT_THROW(archive::FilesOfConfig(dir_.path()), std::runtime_error);
  EXPECT_THROW(archive::FilesOfConfig(dir_.path() / "nowhere"), std::runtime_error);
}

TEST_F(ArchiveInputs, ProgramsThatAreReplacedHaveAnotherDigest) {
  for (const auto* name : {"lookout-replay", "lookout-export", "lookout-log", "lookout-import"}) WriteFile(dir_.path() / name, "1");
  archive::KnownPrograms known;
  const auto digest = known.DigestOf(dir_.path());
  EXPECT_EQ(digest, archive::DigestOfPrograms(dir_.path()));
  EXPECT_EQ(known.DigestOf(dir_.path()), digest);
  WriteFile(dir_.path() / "lookout-log", "2");
  EXPECT_NE(known.DigestOf(dir_.path()), digest);
  fs::remove(dir_.path() / "lookout-log");
  EXPECT_THROW(known.DigestOf(dir_.path()), std::runtime_error);
}

TEST_F(ArchiveInputs, ATruthIsWhatLookoutEvalReadsOfIt) {
  WriteFile(dir_.path() / "objects.csv", "1");
  const auto digest = archive::DigestOfTruth(dir_.path(), archive::DigestOfFile);
  WriteFile(dir_.path() / "notes.txt", "1");
  EXPECT_EQ(archive::DigestOfTruth(dir_.path(), archive::DigestOfFile), digest);
  WriteFile(dir_.path() / "pose.csv", "1");
  EXPECT_NE(archive::DigestOfTruth(dir_.path(), archive::DigestOfFile), digest);
}

TEST_F(ArchiveInputs, WhatCannotBeLookedAtIsAFaultAndALinkToNothingIsNot) {
  WriteFile(dir_.path() / "a.lcmlog", "1");
  fs::create_symlink("nowhere", dir_.path() / "dangling");
  fs::create_symlink("circle", dir_.path() / "circle");
  fs::create_symlink(std::string(300, 'n'), dir_.path() / "odd");  // ENAMETOOLONG
  const auto walk = archive::FilesBelow({dir_.path()}, dir_.path() / "archive");
  ASSERT_EQ(walk.files.size(), 1U);
  ASSERT_EQ(walk.faults.size(), 1U);
  EXPECT_EQ(walk.faults[0].first.filename(), "odd");
}

TEST_F(ArchiveInputs, ABatchGoesOnBehindAUnitThatCannotBeRead) {
  const archive::ArchiveFolder folder(dir_.path() / "archive");
  archive::Unit unit;
  unit.recipe = archive_test::AnyRecipe();
  unit.key = KeyOf(unit.recipe);
  unit.run = "second";
  unit.inputs = {{dir_.path() / "gone.lcmlog", 1, 1}};
  unit.programs = dir_.path();
  WriteFile(dir_.path() / "batch.jsonl", "torn\n" + UnitLine(unit) + "\n");
  std::ostringstream out;
  EXPECT_FALSE(archive::WorkOnBatch(folder, dir_.path() / "batch.jsonl", out));
  EXPECT_NE(out.str().find("a unit: not done: a line of the list of units cannot be used"), std::string::npos) << out.str();
  EXPECT_NE(out.str().find("second: not done: its recording cannot be found"), std::string::npos) << out.str();
}

// Two runs of one lidar whose tracker began anew.
template <typename Message>
std::string LogOfTwoRuns(const bus::Channel& also, const Message& message) {
  std::string bytes;
  bus::LogWriter writer([&bytes](Bytes some) { bytes.append(some.begin(), some.end()); });
  std::int64_t time_us = 1'000'000;
  const auto write = [&](const bus::Channel& channel, const std::vector<std::uint8_t>& payload) {
    writer.Write(Utime(std::chrono::microseconds(time_us)), channel.name, payload);
    time_us += 1000;
  };
  for (int run = 0; run < 2; ++run) {
    for (const bool is_end : {false, true}) {
      lidar_packets_t packets{};
      packets.utime_us = time_us;
      packets.marks = is_end ? std::int32_t{lidar_packets_t::MARK_END} : std::int32_t{lidar_packets_t::MARK_START};
      write(bus::kLidarPackets, bus::Encode(packets));
      if (!is_end) {
        alerts_t alerts{};
        alerts.begin_utime_us = time_us;
        write(bus::kAlerts, bus::Encode(alerts));
        if (run == 0) write(also, bus::Encode(message));
      }
    }
  }
  writer.Flush();
  return bytes;
}

TEST_F(ArchiveInputs, ALogWithASecondLidarOrBeamsIsNotCut) {
  const auto look = [this](const bus::Channel& channel, const auto& message) {
    WriteFile(dir_.path() / "x.lcmlog", LogOfTwoRuns(channel, message));
    archive::Recording again;
    archive::TakeFacts(archive::FactsText(archive::LookAt(dir_.path() / "x.lcmlog")), again);
    EXPECT_EQ(again.can_be_cut, !again.cuts_us.empty());
    return again.can_be_cut;
  };
  EXPECT_TRUE(look(bus::kLidarClock, lidar_clock_t{}));
  EXPECT_FALSE(look(bus::kLidarPackets2, lidar_packets_t{}));
  EXPECT_FALSE(look(bus::kLidarBeams, lidar_beams_t{}));
}

}  // namespace
