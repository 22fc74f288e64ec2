#include "lab/sim/options.hpp"

#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace lookout::sim {
namespace {

Options Parse(std::vector<std::string> more) {
  std::vector<std::string> words{"lookout-sim", "--config", ".", "--scene", "lake", "--seed", "1", "--pcap", "a.pcap"};
  words.insert(words.end(), more.begin(), more.end());
  std::vector<char*> argv;
  for (auto& word : words) argv.push_back(word.data());
  return ParseOptions(static_cast<int>(argv.size()), argv.data());
}

TEST(Options, ReadsALine) {
  const auto options = Parse({"--seconds", "2.5", "--rpm", "1200", "--drop", "0.1", "--navigation", "standalone", "--fault", "drop:1:2:0.5"});
  EXPECT_EQ(options.seconds, 2.5);
  EXPECT_EQ(options.simulation.lidar.rotation_rpm, 1200.0);
  EXPECT_EQ(options.network.drop_share, 0.1);
  EXPECT_EQ(options.simulation.navigation.gnss_sd_m, 1.5);
  EXPECT_EQ(options.simulation.navigation.heading_sd_deg, 2.0);
  EXPECT_EQ(options.simulation.faults.size(), 1U);
}

TEST(Options, BeginAtMicrosecondsOrUtc) {
  for (const auto* start : {"1787997610250000", "2026-08-29T10:00:10.25Z"}) {
    EXPECT_EQ(Parse({"--seconds", "1", "--start-utime-us", start}).start_utime_us, 1787997610250000) << start;
  }
  EXPECT_EXIT(Parse({"--seconds", "1", "--start-utime-us", "2026-08-29"}), testing::ExitedWithCode(2), "--start-utime-us");
}

TEST(Options, OverrideTheEffectsOfTheSceneAlsoByZeroAndLeaveTheOthers) {
  Effects effects;
  effects.set_return_mode(config::Scene::DUAL);
  effects.set_stray_probability(0.1);
  effects.set_range_sd_m(0.5);
  effects.MergeFrom(Parse({"--seconds", "1"}).effects);
  EXPECT_EQ(effects.return_mode(), config::Scene::DUAL);
  EXPECT_EQ(effects.stray_probability(), 0.1);
  effects.MergeFrom(Parse({"--seconds", "1", "--return-mode", "strongest", "--strays", "0"}).effects);
  EXPECT_EQ(effects.return_mode(), config::Scene::STRONGEST);
  EXPECT_EQ(effects.stray_probability(), 0.0);
  EXPECT_EQ(effects.range_sd_m(), 0.5);
}

// NaN used to pass: a run of no length, a head that never turns, noise that is not a number.
TEST(Options, RefusesWhatIsNoNumberOrOutOfRange) {
  for (const auto* value : {"nan", "-nan", "NaN", "inf", "-1", "1e9", "x", ""}) {
    EXPECT_EXIT(Parse({"--seconds", value}), testing::ExitedWithCode(2), "--seconds") << value;
    for (const auto* option : {"--rpm", "--drop", "--double", "--swap", "--strays", "--gnss-sd"}) {
      EXPECT_EXIT(Parse({"--seconds", "1", option, value}), testing::ExitedWithCode(2), option) << option << " " << value;
    }
    EXPECT_EXIT(Parse({"--seconds", "1", "--field-of-view", "10", value}), testing::ExitedWithCode(2), "--field-of-view") << value;
  }
}

TEST(Options, ChooseAHeadByEitherName) {
  EXPECT_EQ(Parse({"--seconds", "1"}).lidar, "");
  EXPECT_EQ(Parse({"--seconds", "1", "--lidar", "xt32"}).lidar, "xt32");
  EXPECT_EQ(Parse({"--seconds", "1", "--model", "hi-res"}).lidar, "hi-res");
  EXPECT_EXIT(Parse({"--seconds", "1", "--lidar", "os9"}), testing::ExitedWithCode(2), "--lidar");
  EXPECT_EXIT(Parse({"--seconds", "1", "--model", "xt32"}), testing::ExitedWithCode(2), "--model");
  EXPECT_EXIT(Parse({"--seconds", "1", "--out", "a.lcmlog"}), testing::ExitedWithCode(2), "--out");
}

TEST(Options, RefusesAFaultThatBeginsAfterTheEnd) { EXPECT_THROW(Parse({"--seconds", "1", "--fault", "gnss_gap:1:2"}), std::invalid_argument); }

}  // namespace
}  // namespace lookout::sim
