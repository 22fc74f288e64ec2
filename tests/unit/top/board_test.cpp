#include "tools/top/board.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <initializer_list>
#include <limits>
#include <random>

#include "common/core/angles.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/segments_t.hpp"
#include "tests/unit/top/bus_talk.hpp"

namespace lookout::top {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(RateMeter, CountsTheLastFiveSeconds) {
  RateMeter meter(kStart);
  EXPECT_FALSE(meter.At(At(0.9)));
  for (int i = 0; i < 100; ++i) meter.Add(At(0.1 * i), 1000);
  const auto busy = meter.At(At(10.0));
  ASSERT_TRUE(busy);
  EXPECT_NEAR(busy->messages_hz, 10.0, 0.3);
  EXPECT_NEAR(busy->bytes_per_s, 10'000.0, 300.0);
  EXPECT_EQ(meter.At(At(20.0))->messages_hz, 0.0);
}

TEST(RateMeter, IsRightBeforeFiveSecondsAreOver) {
  RateMeter meter(kStart);
  for (int i = 0; i < 20; ++i) meter.Add(At(0.1 * i), 10);
  EXPECT_NEAR(meter.At(At(2.0))->messages_hz, 10.0, 0.1);
}

TEST(Board, CountsLossByGapsAlsoInParts) {
  Board board(kStart);
  segments_t part{};
  part.seq = 1;
  part.num_parts = 2;
  Say(board, bus::kSegments, part, 0.1);
  part.seq = 3;  // part 1 of turn 1 and both of turn 2 (counted once) are missing
  Say(board, bus::kSegments, part, 0.2);
  const auto channels = board.Channels(At(0.7));
  ASSERT_EQ(channels.size(), 1U);
  EXPECT_EQ(channels[0].name, "SEGMENTS");
  EXPECT_EQ(channels[0].num_lost, 2);
  EXPECT_EQ(channels[0].num_bad, 0);
  EXPECT_NEAR(std::chrono::duration<double>(channels[0].age).count(), 0.5, 1e-6);
}

TEST(Board, CountsLossOfHealthPerProcess) {
  Board board(kStart);
  // Each counts for itself: 7 beside 100 is no gap.
  Say(board, bus::kHealth, HealthOf("lidar", 100), 0.1);
  Say(board, bus::kHealth, HealthOf("segmenter", 7), 0.2);
  Say(board, bus::kHealth, HealthOf("lidar", 101), 1.1);
  EXPECT_EQ(board.Channels(At(1.2))[0].num_lost, 0);
  Say(board, bus::kHealth, HealthOf("segmenter", 9), 1.2);
  EXPECT_EQ(board.Channels(At(1.2))[0].num_lost, 1);
}

health_t HealthOfPid(const std::string& process, std::int32_t pid, std::int64_t seq, const std::string& host = "boat") {
  auto health = HealthOf(process, seq);
  health.pid = pid;
  health.host = host;
  return health;
}

TEST(Board, ShowsTwoProcessesOfOneNameByHostAndProcessId) {
  Board board(kStart);
  for (int second = 0; second < 4; ++second) {
    Say(board, bus::kHealth, HealthOfPid("navigator", 11, second), second + 0.1);
    Say(board, bus::kHealth, HealthOfPid("navigator", 22, second), second + 0.2);
    Say(board, bus::kHealth, HealthOfPid("lidar", 33, second), second + 0.3);
    Say(board, bus::kHealth, HealthOfPid("lidar", 33, second, "shore"), second + 0.4);
  }
  const auto processes = board.Processes(At(4.0));
  ASSERT_EQ(processes.size(), 4U);
  EXPECT_EQ(processes[0].reason, "one of 2 lidars on this bus: pid 33 on boat");
  EXPECT_EQ(processes[1].name, "lidar@shore");
  EXPECT_EQ(processes[1].reason, "one of 2 lidars on this bus: pid 33 on shore");
  EXPECT_EQ(processes[2].reason, "one of 2 navigators on this bus: pid 11 on boat");
  EXPECT_EQ(processes[3].reason, "one of 2 navigators on this bus: pid 22 on boat");
  EXPECT_EQ(board.Channels(At(4.0))[0].num_lost, 0);  // each counts for itself
}

TEST(Board, ARestartTakesThePlaceOfTheProcessBefore) {
  Board board(kStart);
  Say(board, bus::kHealth, HealthOfPid("navigator", 11, 500), 1.0);
  for (std::int32_t pid = 12; pid < 500; ++pid) Say(board, bus::kHealth, HealthOfPid("navigator", pid, 0), pid);
  const auto processes = board.Processes(At(499.5));
  ASSERT_EQ(processes.size(), 1U);
  EXPECT_EQ(processes[0].reason, "");
  EXPECT_FALSE(processes[0].is_silent);
  EXPECT_EQ(board.num_unlisted(), 0);
}

TEST(Board, KeepsTheOrderOfTheChannelTable) {
  Board board(kStart);
  board.Take("ZEBRA", {}, At(0.1));
  board.Take("APPLE", {}, At(0.1));
  Say(board, bus::kHealth, HealthOf("lidar", 0), 0.1);
  Say(board, bus::kPose, PoseAt(0, 0.0), 0.1);
  const auto channels = board.Channels(At(0.2));
  ASSERT_EQ(channels.size(), 4U);
  EXPECT_EQ(channels[0].name, "POSE");
  EXPECT_EQ(channels[1].name, "HEALTH");
  EXPECT_EQ(channels[2].name, "APPLE");
  EXPECT_FALSE(channels[2].num_lost);
  EXPECT_EQ(channels[3].name, "ZEBRA");
}

TEST(Board, NeverDiesOfBytesAndCountsThem) {
  Board board(kStart);
  std::mt19937 random(1);
  auto turn = bus::Encode(TurnOf(1, {ObstacleAt(1, 5.0F, 0.0F)}));
  auto health = bus::Encode(HealthOf("lidar", 1));
  for (int i = 0; i < 2000; ++i) {
    for (const auto& channel : bus::kChannels) {
      std::vector<std::uint8_t> bytes(random() % 64);
      for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
      board.Take(channel.name, bytes, At(0.001 * i));
    }
    auto spoiled = i % 2 == 0 ? turn : health;
    for (int k = 0; k < 4; ++k) spoiled[8 + random() % (spoiled.size() - 8)] = static_cast<std::uint8_t>(random());
    board.Take(i % 2 == 0 ? "OBSTACLES" : "HEALTH", spoiled, At(0.001 * i));
    board.Obstacles(At(0.001 * i));
    board.AlertLines(At(0.001 * i));
  }
  const auto channels = board.Channels(At(2.0));
  ASSERT_EQ(channels.size(), bus::kChannels.size());
  for (const auto& channel : channels) EXPECT_GE(channel.num_bad, 2000) << channel.name;
  EXPECT_LE(board.Processes(At(2.0)).size(), Board::kMaxProcesses);
}

TEST(Board, ForgetsNothingAboutManyChannelsButTheirNames) {
  Board board(kStart);
  for (int i = 0; i < 1000; ++i) board.Take("JUNK" + std::to_string(i), {}, At(0.1));
  Say(board, bus::kPose, PoseAt(0, 0.0), 0.1);  // still finds its place
  const auto channels = board.Channels(At(0.2));
  EXPECT_EQ(channels.size(), Board::kMaxChannels + 1);
  EXPECT_EQ(channels[0].name, "POSE");
  EXPECT_EQ(board.num_unlisted(), 1000 - static_cast<std::int64_t>(Board::kMaxChannels));
}

// Invented processes under the names of the suite took its room for ever: what started again afterwards was not shown, nor its alarm.
TEST(Board, WhatIsSilentMakesRoomForWhatSpeaks) {
  Board board(kStart);
  Say(board, bus::kHealth, HealthOf("recorder", 0), 0.1);
  for (int i = 0; i < 200; ++i) {
    auto invented = HealthOf("lidar", 0);
    invented.host = "elsewhere" + std::to_string(i);
    Say(board, bus::kHealth, invented, 0.2);
  }
  EXPECT_GT(board.num_unlisted_health(), 0);
  const auto num_unlisted = board.num_unlisted_health();
  auto health = HealthOf("georeferencer", 0);
  health.pid = 4711;
  Say(board, bus::kHealth, health, 10.0);
  EXPECT_EQ(board.num_unlisted_health(), num_unlisted);
  const auto processes = board.Processes(At(10.1));
  EXPECT_LE(processes.size(), Board::kMaxProcesses);
  const auto is_shown = [&](const std::string& name) {
    return std::ranges::any_of(processes, [&](const auto& line) { return line.name.rfind(name, 0) == 0; });
  };
  EXPECT_TRUE(is_shown("georeferencer"));
  EXPECT_TRUE(is_shown("recorder")) << "silent, but the only one of its name";
}

TEST(Board, SortsObstaclesOfAllPartsAndKeepsTheNearest) {
  Board board(kStart);
  std::vector<obstacle_t> far;
  for (int i = 0; i < 49; ++i) far.push_back(ObstacleAt(10 + i, 50.0F + static_cast<float>(i), 1.0F));
  Say(board, bus::kObstacles, TurnOf(1, far, 0, 2), 0.1);
  EXPECT_EQ(board.Obstacles(At(0.1)), nullptr);  // half a scan
  auto lost_range = ObstacleAt(20, static_cast<float>(kNan), 0.0F);
  Say(board, bus::kObstacles, TurnOf(1, {lost_range, ObstacleAt(21, 7.5F, 2.0F), ObstacleAt(22, 3.25F, 3.0F)}, 1, 2), 0.2);
  const auto* obstacles = board.Obstacles(At(0.3));
  ASSERT_NE(obstacles, nullptr);
  EXPECT_EQ(obstacles->num_obstacles, 52);
  EXPECT_EQ(obstacles->num_parts_missing, 0);
  ASSERT_EQ(obstacles->lines.size(), 50U);
  EXPECT_EQ(obstacles->lines[0].id, 22);
  EXPECT_EQ(obstacles->lines[1].id, 21);
  EXPECT_EQ(obstacles->lines[49].id, 57);  // 97 m; the farthest and the one without range do not fit
}

TEST(Board, ShowsATurnWithoutItsLastPartWhenTheNextBegins) {
  Board board(kStart);
  Say(board, bus::kObstacles, TurnOf(1, {ObstacleAt(1, 5.0F, 0.0F)}, 1, 3), 0.1);
  Say(board, bus::kObstacles, TurnOf(2, {}, 0, 3), 0.2);
  const auto* obstacles = board.Obstacles(At(0.3));
  ASSERT_NE(obstacles, nullptr);
  EXPECT_EQ(obstacles->lines.size(), 1U);
  EXPECT_EQ(obstacles->num_parts_missing, 2);
}

TEST(Board, RefusesObstaclesThatAnnouncePartsWithoutEnd) {
  Board board(kStart);
  Say(board, bus::kObstacles, TurnOf(1, {}, 0, 2000), 0.1);
  Say(board, bus::kObstacles, TurnOf(2, {}, 0, 2001), 0.2);
  const auto channels = board.Channels(At(0.3));
  EXPECT_EQ(std::ranges::find(channels, bus::kObstacles.name, &ChannelLine::name)->num_bad, 1);
}

TEST(Board, ObstaclesAgeOutAfterTwoSeconds) {
  Board board(kStart);
  Say(board, bus::kObstacles, TurnOf(1, {ObstacleAt(1, 5.0F, 0.0F)}), 1.0);
  EXPECT_NE(board.Obstacles(At(2.9)), nullptr);
  EXPECT_EQ(board.Obstacles(At(3.1)), nullptr);
}

TEST(Board, TrueBearingTakesTheHeadingOfThatTimeAcrossNorth) {
  Board board(kStart);
  Say(board, bus::kPose, PoseAt(900'000, DegToRad(10.0)), 0.1);
  Say(board, bus::kPose, PoseAt(1'000'000, DegToRad(350.0)), 0.1);
  Say(board, bus::kPose, PoseAt(1'080'000, DegToRad(200.0)), 0.1);
  Say(board, bus::kObstacles, TurnOf(1, {ObstacleAt(1, 5.0F, static_cast<float>(DegToRad(30.0)))}), 0.2);
  EXPECT_NEAR(RadToDeg(board.Obstacles(At(0.3))->lines[0].true_bearing_rad), 20.0, 1e-4);
}

TEST(Board, WithoutAHeadingOfThatTimeTheTrueBearingIsNotKnown) {
  Board board(kStart);
  Say(board, bus::kPose, PoseAt(1'200'000, 1.0), 0.1);  // 0.2 s from it
  Say(board, bus::kObstacles, TurnOf(1, {ObstacleAt(1, 5.0F, 0.5F)}), 0.2);
  EXPECT_TRUE(std::isnan(board.Obstacles(At(0.3))->lines[0].true_bearing_rad));
  Say(board, bus::kPose, PoseAt(1'000'000, kNan), 0.3);
  Say(board, bus::kObstacles, TurnOf(2, {ObstacleAt(1, 5.0F, 0.5F)}), 0.4);
  EXPECT_TRUE(std::isnan(board.Obstacles(At(0.5))->lines[0].true_bearing_rad));
}

// Names that somebody invents push no process off the screen, whoever is heard first.
TEST(Board, KeepsTheProcessesOfTheSuiteAboveInventedNames) {
  Board board(kStart);
  for (int i = 0; i < 64; ++i) Say(board, bus::kHealth, HealthOf("a" + std::to_string(i), 0), 0.1);
  for (const std::string process : {"recorder", "lidar", "segmenter", "navigator", "georeferencer"}) {
    Say(board, bus::kHealth, HealthOf(process, 0), 0.2);
  }
  for (int i = 0; i < 1000; ++i) Say(board, bus::kHealth, HealthOf("b" + std::to_string(i), 0), 0.3);
  const auto processes = board.Processes(At(0.4));
  ASSERT_GE(processes.size(), 5U);
  EXPECT_EQ(processes[0].name, "lidar");
  EXPECT_EQ(processes[1].name, "segmenter");
  EXPECT_EQ(processes[2].name, "navigator");
  EXPECT_EQ(processes[3].name, "georeferencer");
  EXPECT_EQ(processes[4].name, "recorder");
  EXPECT_LE(processes.size(), 16U);
}

// A tracker that is up and has no scan yet sends no ALERTS; one that was stopped leaves the last word it had said.
TEST(Board, SaysThatNobodyLooksWhereATrackerIsAndNoAlertsCome) {
  Board board(kStart);
  Say(board, bus::kHealth, HealthOf("georeferencer", 1), 0.5);
  EXPECT_TRUE(board.AlertLines(At(1.0)).empty()) << "a tracker may start yet";
  Say(board, bus::kHealth, HealthOf("tracker", 1, health_t::STATE_DEGRADED, "no look-out: no whole scan yet"), 1.0);
  EXPECT_EQ(board.AlertLines(At(1.1)), std::vector<std::string>{"NO LOOK-OUT: no ALERTS yet"});
  Say(board, bus::kAlerts, alerts_t{}, 2.0);
  EXPECT_TRUE(board.AlertLines(At(2.9)).empty());
  EXPECT_EQ(board.AlertLines(At(4.0)), std::vector<std::string>{"NO LOOK-OUT: no ALERTS for 2 s"});
}

// A boat whose tracker did not start showed no alarm at all.
TEST(Board, SaysThatNobodyLooksWhereTheSuiteIsHeardWithoutATracker) {
  Board board(kStart);
  Say(board, bus::kHealth, HealthOf("somebody", 1), 0.1);
  Say(board, bus::kHealth, HealthOf("lidar_2", 1), 1.0);
  EXPECT_TRUE(board.AlertLines(At(3.9)).empty());
  EXPECT_EQ(board.AlertLines(At(4.0)), std::vector<std::string>{"NO LOOK-OUT: no ALERTS yet"});
}

// The key `c` forgot that there was a look-out, and processes that had died.
TEST(Board, CountsAnewAndForgetsNothingElse) {
  Board board(kStart);
  Say(board, bus::kHealth, HealthOf("recorder", 1), 0.1);
  Say(board, bus::kHealth, HealthOf("recorder", 4), 0.2);
  Say(board, bus::kAlerts, alerts_t{}, 0.3);
  board.Take("ALERTS", {}, At(0.4));
  for (std::size_t i = 0; i <= Board::kMaxChannels; ++i) board.Take("JUNK" + std::to_string(i), {}, At(0.4));
  ASSERT_EQ(board.Channels(At(0.5))[0].num_bad, 1);
  ASSERT_EQ(board.Channels(At(0.5))[1].num_lost, 2);
  ASSERT_GT(board.num_unlisted(), 0);
  board.CountAnew();
  for (const auto& channel : board.Channels(At(10.0))) EXPECT_EQ(channel.num_lost.value_or(0) + channel.num_bad, 0) << channel.name;
  EXPECT_EQ(board.num_unlisted(), 0);
  EXPECT_EQ(board.AlertLines(At(10.3)), std::vector<std::string>{"NO LOOK-OUT: no ALERTS for 10 s"});
  ASSERT_EQ(board.Processes(At(10.0)).size(), 1U);
  EXPECT_TRUE(board.Processes(At(10.0))[0].is_silent);
  Say(board, bus::kHealth, HealthOf("recorder", 6), 10.1);
  EXPECT_EQ(board.Channels(At(10.2))[1].num_lost, 1) << "the gap behind what was heard before";
}

TEST(Board, KeepsWarningsThatAreOverUntilSomebodyAcknowledgesThem) {
  Board board(kStart);
  alerts_t alerts{};
  for (const auto state :
       std::initializer_list<std::int32_t>{alert_t::STATE_RECTIFIED, alert_t::STATE_ACKNOWLEDGED, alert_t::STATE_CLEARED, alert_t::STATE_ACTIVE}) {
    alert_t alert{};
    alert.id = state;
    alert.level = alert_t::LEVEL_WARNING;
    if (state == alert_t::STATE_ACTIVE) alert.level = alert_t::LEVEL_CAUTION;
    alert.state = state;
    alert.text = "boat " + std::to_string(state);
    alerts.alerts.push_back(alert);
  }
  alerts.num_alerts = 4;
  Say(board, bus::kAlerts, alerts, 1.0);
  EXPECT_EQ(board.AlertLines(At(1.1)), (std::vector<std::string>{"CAUTION: boat 1", "WARNING OVER: boat 3"}));
  EXPECT_EQ(board.AlertLines(At(4.0)),
            (std::vector<std::string>{"NO LOOK-OUT: no ALERTS for 3 s", "before that: boat 1", "before that, over: boat 3"}));
}

TEST(Board, MarksTheAlertThatSoundsAndThoseThatAreSilenced) {
  Board board(kStart);
  alerts_t alerts{};
  for (const std::int64_t id : {1, 2, 3}) {
    alert_t alert{};
    alert.id = id;
    alert.level = alert_t::LEVEL_WARNING;
    if (id == 3) alert.level = alert_t::LEVEL_CAUTION;
    alert.state = alert_t::STATE_ACTIVE;
    alert.changed_utime_us = 1'000'000'000 * id;
    alert.text = "boat " + std::to_string(id);
    alerts.alerts.push_back(alert);
  }
  alerts.num_alerts = 3;
  alerts.sounding_alert_id = 2;
  Say(board, bus::kAlerts, alerts, 1.0);
  EXPECT_EQ(board.AlertLines(At(1.1)), (std::vector<std::string>{"WARNING: boat 1", "(*) WARNING: boat 2", "CAUTION: boat 3"}));
  // Silence since 1500 s: the second came up after.
  alerts.silenced_until_utime_us = 1'530'000'000;
  Say(board, bus::kAlerts, alerts, 1.2);
  EXPECT_EQ(board.AlertLines(At(1.3)), (std::vector<std::string>{"WARNING SILENCED: boat 1", "(*) WARNING: boat 2", "CAUTION: boat 3"}));
}

TEST(Board, TellsTheGreatestLatencyOfDataOnly) {
  Board board(kStart);
  auto health = HealthOf("lidar", 0);
  const auto add = [&health](const std::string& name, bool is_input, std::int64_t latency_p99_us) {
    health_channel_t channel{};
    channel.channel = name;
    channel.is_input = is_input ? 1 : 0;
    channel.latency_p99_us = latency_p99_us;
    health.channels.push_back(channel);
    health.num_channels = static_cast<std::int32_t>(health.channels.size());
  };
  add("LIDAR_SCAN", false, 107'000);
  add("LIDAR_CLOCK", false, 90'000);
  add("POSE", true, 999'000);
  add("HEALTH", false, 888'000);
  Say(board, bus::kHealth, health, 0.1);
  EXPECT_EQ(board.Processes(At(0.2))[0].latency_p99_us, 107'000);
}

TEST(Board, AProcessThatFallsSilentStays) {
  Board board(kStart);
  Say(board, bus::kHealth, HealthOf("lidar", 0), 0.1);
  auto other = HealthOf("lidar", 0);
  other.host = "shore";
  Say(board, bus::kHealth, other, 5.0);
  const auto processes = board.Processes(At(5.0));
  ASSERT_EQ(processes.size(), 2U);
  EXPECT_EQ(processes[0].name, "lidar");
  EXPECT_TRUE(processes[0].is_silent);
  EXPECT_EQ(processes[1].name, "lidar@shore");
  EXPECT_FALSE(processes[1].is_silent);
}

}  // namespace
}  // namespace lookout::top
