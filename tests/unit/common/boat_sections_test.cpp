// A boat in one file: sections of boat.txtpb in place of files, and the defaults where neither is there.
#include "common/config/boat_sections.hpp"

#include <algorithm>
#include <filesystem>
#include <gtest/gtest.h>
#include <string>

#include "common/bus/services.hpp"
#include "common/config/boat.hpp"
#include "common/config/text_config.hpp"
#include "config/schema/lidar.pb.h"
#include "config/schema/navigator.pb.h"
#include "config/schema/recorder.pb.h"
#include "config/schema/tracker.pb.h"
#include "tests/support/files.hpp"

namespace lookout::config {
namespace {

namespace fs = std::filesystem;

const std::string kFacts =
    "name: \"one\"\nlidar { x_m: 0 y_m: 0 z_m: 1 roll_deg: 0 pitch_deg: 0 yaw_deg: 0 }\ngnss_antenna { x_m: 0 y_m: 0 z_m: 1 }\n"
    "reference_point_above_water_m: 0\nown_vessel { min_x_m: -1 max_x_m: 1 min_y_m: -1 max_y_m: 1 min_z_m: -1 max_z_m: 2 }\n";

std::string WhatOf(const std::function<void()>& load) {
  try {
    load();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

class BoatSections : public testing::Test {
 protected:
  support::TempDir folder_;
  const fs::path boat_ = folder_ / "boat.txtpb";
};

TEST_F(BoatSections, HoldWhatTheFileWould) {
  support::WriteFile(boat_, kFacts + "tracker { cpa_limit_m: 7 guard_zone { range_m: 12 } }\n");
  const auto of_section = Load<Tracker>(folder_, "tracker.txtpb");
  EXPECT_EQ(of_section.cpa_limit_m(), 7.0);
  EXPECT_EQ(of_section.guard_zone().range_m(), 12.0);
  const auto text = EffectiveTextOf(folder_, "tracker.txtpb");
  EXPECT_EQ(PlaceInWords(folder_, "tracker.txtpb"), "tracker in boat.txtpb");

  support::WriteFile(boat_, kFacts);
  support::WriteFile(folder_ / "tracker.txtpb", "cpa_limit_m: 7 guard_zone { range_m: 12 }\n");
  EXPECT_EQ(Load<Tracker>(folder_, "tracker.txtpb").SerializeAsString(), of_section.SerializeAsString());
  EXPECT_EQ(EffectiveTextOf(folder_, "tracker.txtpb"), text) << "RUN_INFO does not tell the one from the other";
  EXPECT_EQ(PlaceInWords(folder_, "tracker.txtpb"), "tracker.txtpb");
}

TEST_F(BoatSections, OfTheLidarHaveAnotherNameThanItsPlace) {
  support::WriteFile(boat_, kFacts + "lidar_input { data_port: 7502 model: MODEL_OUSTER }\n");
  EXPECT_EQ(Load<Lidar>(folder_, "lidar.txtpb").data_port(), 7502);
  EXPECT_EQ(LoadBoat(folder_).lidar.p_vessel_m.z(), 1.0);
  EXPECT_EQ(SectionOf("lidar.txtpb"), "lidar_input");
  for (const auto* file : {"boat.txtpb", "lidar_2.txtpb", "imu.txtpb", "datum.txtpb", "lidar.json", "lake.txtpb"})
    EXPECT_EQ(SectionOf(file), "") << file;
}

// The values of config/catabot are those of a boat that says no more than its facts.
TEST_F(BoatSections, AbsentHaveTheDefaults) {
  support::WriteFile(boat_, kFacts);
  for (const auto& service : bus::kServices) {
    const auto file = std::string(service.name) + ".txtpb";
    EXPECT_TRUE(IsAbsent(folder_, file)) << file << " has no section in boat.proto";
    if (service.name == "tracker") continue;  // whose guard zone is chosen
    if (!fs::exists(support::kCatabotConfig / file)) continue;
    auto given = EffectiveTextOf(support::kCatabotConfig, file);
    for (const std::string mark = "  # default"; given.find(mark) != std::string::npos;) given.erase(given.find(mark), mark.size());
    auto absent = EffectiveTextOf(folder_, file);
    for (const std::string mark = "  # default"; absent.find(mark) != std::string::npos;) absent.erase(absent.find(mark), mark.size());
    EXPECT_EQ(absent, given) << file;
  }
  EXPECT_EQ(Load<Navigator>(folder_, "navigator.txtpb").bind_address(), "0.0.0.0");
  EXPECT_FALSE(Load<Tracker>(folder_, "tracker.txtpb").has_guard_zone());
}

// A file that leaves the address out has no input by UDP, as ever; one that is not there has it.
TEST_F(BoatSections, OfTheNavigatorHaveNoInputThatTheyDoNotName) {
  support::WriteFile(boat_, kFacts + "navigator { use_lidar_nmea: true }\n");
  EXPECT_FALSE(Load<Navigator>(folder_, "navigator.txtpb").has_bind_address());
  support::WriteFile(boat_, kFacts);
  support::WriteFile(folder_ / "navigator.txtpb", "source: LIVE use_lidar_nmea: true heading_offset_deg: 0 pitch_offset_deg: 0 roll_offset_deg: 0\n");
  EXPECT_FALSE(Load<Navigator>(folder_, "navigator.txtpb").has_bind_address());
}

TEST_F(BoatSections, BesideTheirFileAreRefusedWithTheirLine) {
  support::WriteFile(boat_, kFacts + "\ntracker {\n  cpa_limit_m: 7\n}\n");
  support::WriteFile(folder_ / "tracker.txtpb", "cpa_limit_m: 7\n");
  EXPECT_EQ(WhatOf([&] { Load<Tracker>(folder_, "tracker.txtpb"); }),
            boat_.string() + ":7: tracker: stands beside tracker.txtpb, which holds the same values: keep one of both");
}

TEST_F(BoatSections, AreFaultyWithTheirLineForEveryProcess) {
  support::WriteFile(boat_, kFacts + "plotter {\n  output { name: 1 }\n}\nrecorder { log_folder: \"x\" max_file_s: 0 }\n");
  const auto fault = WhatOf([&] { Load<Tracker>(folder_, "tracker.txtpb"); });
  EXPECT_NE(fault.find("boat.txtpb:7: plotter.output.name: "), std::string::npos) << fault;
  EXPECT_NE(fault.find("boat.txtpb:9: recorder.max_file_s: must be at least 1"), std::string::npos) << fault;
}

TEST_F(BoatSections, HaveTheLinesOfRelationsBetweenFields) {
  support::WriteFile(boat_, "#\n" + kFacts +
                                "navigator { nmea_port: 10111 }  # clear_probability: 1\ntracker {\n  # clear_probability: 0.1\n"
                                "  clear_probability: 0.4\n  raise_probability: 0.3\n}\npage { port: 1 }\n");
  EXPECT_EQ(FaultLine(folder_ / "tracker.txtpb", "clear_probability", "is wrong"), boat_.string() + ":10: tracker.clear_probability: is wrong");
  EXPECT_EQ(FaultLine(folder_ / "tracker.txtpb", "port", "is not set"), boat_.string() + ":8: tracker.port: is not set");
  EXPECT_EQ(FaultLine(folder_ / "page.txtpb", "port", "is wrong"), boat_.string() + ":13: page.port: is wrong");
  EXPECT_EQ(FaultLine(folder_ / "plotter.txtpb", "output", "is wrong"), (folder_ / "plotter.txtpb").string() + ":1: output: is wrong");
}

TEST_F(BoatSections, OnOneLineAreTakenApart) {
  support::WriteFile(boat_, kFacts + "page { max_clients: 2 } tracker { wait_timeout_s: 1 }\n");
  EXPECT_EQ(FindValues(folder_ / "page.txtpb").text.find("wait"), std::string::npos);
  const auto text = FindValues(folder_ / "tracker.txtpb").text;
  EXPECT_EQ(text.find("max_clients"), std::string::npos) << text;
  EXPECT_NE(text.find("tracker { wait_timeout_s: 1 }"), std::string::npos) << text;
}

// trakcer.txtpb was a missing tracker.txtpb before; now it would be the defaults, without a word.
TEST_F(BoatSections, AndFilesOfAWrongNameAreTold) {
  support::WriteFile(boat_, kFacts);
  support::WriteFile(folder_ / "trakcer.txtpb", "cpa_limit_m: 7\n");
  EXPECT_EQ(WhatOf([&] { Load<Tracker>(folder_, "tracker.txtpb"); }),
            (folder_ / "trakcer.txtpb").string() + ":1: file: there is no config/schema/trakcer.proto");
}

TEST_F(BoatSections, ALinkWithoutATargetIsNoAbsentFile) {
  support::WriteFile(boat_, kFacts);
  fs::create_symlink("nowhere", folder_ / "recorder.txtpb");
  EXPECT_NE(WhatOf([&] { Load<Recorder>(folder_, "recorder.txtpb"); }).find("recorder.txtpb:1: file: cannot be read"), std::string::npos);
}

TEST_F(BoatSections, AreNoPartOfTheFactsInRunInfo) {
  support::WriteFile(boat_, kFacts + "tracker { cpa_limit_m: 7 }\n");
  EXPECT_EQ(EffectiveTextOf(folder_, "boat.txtpb").find("cpa_limit_m"), std::string::npos);
  const auto files = FilesInForce(folder_);
  EXPECT_EQ(files.size(), bus::kServices.size() + 1);
  EXPECT_TRUE(std::ranges::is_sorted(files));
  // The old name of the lidar's file stands for the new one.
  support::WriteFile(folder_ / "vlp16.txtpb", "data_port: 2369\n");
  const auto renamed = FilesInForce(folder_);
  EXPECT_EQ(std::ranges::count(renamed, "lidar.txtpb"), 0);
  EXPECT_EQ(std::ranges::count(renamed, "vlp16.txtpb"), 1);
}

}  // namespace
}  // namespace lookout::config
