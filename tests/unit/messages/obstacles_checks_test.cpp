// What a process computes from of OBSTACLES and ALERT_ACK, and what it refuses, by which counter.
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

#include "common/messages/checks.hpp"

namespace lookout::messages {
namespace {

constexpr int kMaxBytes = 120'000;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

obstacles_t TwoObstacles() {
  obstacles_t message{};
  message.utime_us = 1'800'000'000'000'000;
  message.end_utime_us = message.utime_us + 100'000;
  message.num_parts = 1;
  message.datum_latitude_deg = 43.7;
  message.datum_longitude_deg = -72.3;
  for (const std::int32_t id : {3, 7}) {
    obstacle_t obstacle{};
    obstacle.utime_us = message.utime_us + 50'000;
    obstacle.id = id;
    obstacle.confidence = obstacle_t::CONFIDENCE_SURE;
    obstacle.num_points = 4;
    obstacle.covariance_m2[0] = obstacle.covariance_m2[2] = 1.0;
    obstacle.covariance_relative_m2[0] = obstacle.covariance_relative_m2[2] = 0.1;
    obstacle.num_footprint = obstacle.num_map = 2;
    obstacle.footprint_vessel_x_m = obstacle.footprint_vessel_y_m = obstacle.footprint_east_m = obstacle.footprint_north_m = {1.0F, 2.0F};
    obstacle.num_waterline = obstacle.num_waterline_map = 1;
    obstacle.waterline_vessel_x_m = obstacle.waterline_vessel_y_m = obstacle.waterline_east_m = obstacle.waterline_north_m = {3.0F};
    message.obstacles.push_back(obstacle);
  }
  message.num_obstacles = 2;
  return message;
}

TEST(ObstaclesCheck, AcceptsWhatTheGeoreferencerSends) {
  EXPECT_EQ(FaultOf(TwoObstacles(), kMaxBytes), std::nullopt);
  auto message = TwoObstacles();
  message.datum_ellipsoid_height_m = kUnknown;
  auto& obstacle = message.obstacles[1];
  obstacle.thing_probability = std::numeric_limits<float>::quiet_NaN();
  for (auto& number : obstacle.covariance_m2) number = kUnknown;
  EXPECT_EQ(FaultOf(message, kMaxBytes), std::nullopt) << "of a pose that does not know its own";

  // In the vessel frame only, and no datum.
  message = TwoObstacles();
  message.datum_latitude_deg = message.datum_longitude_deg = kUnknown;
  for (auto& placed : message.obstacles) {
    placed.status = obstacle_t::STATUS_VESSEL_FRAME_ONLY;
    placed.latitude_deg = placed.longitude_deg = placed.position_map_m[0] = placed.position_map_m[1] = kUnknown;
    placed.num_map = placed.num_waterline_map = 0;
    for (auto* numbers : {&placed.footprint_east_m, &placed.footprint_north_m, &placed.waterline_east_m, &placed.waterline_north_m}) numbers->clear();
  }
  EXPECT_EQ(FaultOf(message, kMaxBytes), std::nullopt);
}

TEST(ObstaclesCheck, RefusesByTheRightCounter) {
  struct Case {
    Fault fault;
    std::function<void(obstacles_t&, obstacle_t&)> spoil;
  };
  constexpr auto kInfinite = std::numeric_limits<float>::infinity();
  const std::vector<Case> cases{
      {kObstaclesTime, [](auto& scan, auto&) { scan.utime_us = std::numeric_limits<std::int64_t>::min(); }},
      {kObstaclesTime, [](auto& scan, auto&) { scan.end_utime_us = scan.utime_us - 1; }},
      {kObstaclesTime, [](auto& scan, auto&) { scan.end_utime_us += 61'000'000; }},
      {kObstaclesTime, [](auto& scan, auto& obstacle) { obstacle.utime_us = scan.end_utime_us + 1; }},
      {kObstaclesParts, [](auto& scan, auto&) { scan.seq = -1; }},
      {kObstaclesParts, [](auto& scan, auto&) { scan.part_index = 1; }},
      {kObstaclesParts, [](auto& scan, auto&) { scan.num_parts = 2001; }},
      {kObstaclesCount, [](auto&, auto& obstacle) { obstacle.num_points = 0; }},
      {kObstaclesCount, [](auto&, auto& obstacle) { obstacle.num_map = 1; }},
      {kObstaclesCount, [](auto&, auto& obstacle) { obstacle.num_waterline_map = 0; }},
      {kObstaclesCount, [](auto&, auto& obstacle) { obstacle.status = obstacle_t::STATUS_POSE_TIMEOUT; }},
      {kObstaclesId, [](auto&, auto& obstacle) { obstacle.id = 3; }},
      {kObstaclesNumber, [](auto&, auto& obstacle) { obstacle.position_map_m[1] = kUnknown; }},
      {kObstaclesNumber, [](auto&, auto& obstacle) { obstacle.position_map_m[0] = 2e7; }},
      {kObstaclesNumber, [](auto&, auto& obstacle) { obstacle.footprint_east_m[1] = kInfinite; }},
      {kObstaclesNumber, [](auto&, auto& obstacle) { obstacle.waterline_vessel_y_m[0] = 1e6F; }},
      {kObstaclesNumber, [](auto&, auto& obstacle) { obstacle.thing_probability = 1.5F; }},
      {kObstaclesNumber, [](auto&, auto& obstacle) { obstacle.top_above_water_m = kUnknown; }},
      {kObstaclesNumber, [](auto& scan, auto&) { scan.datum_longitude_deg = kUnknown; }},
      {kObstaclesNumber, [](auto& scan, auto&) { scan.datum_ellipsoid_height_m = 1e300; }},
      {kObstaclesCovariance, [](auto&, auto& obstacle) { obstacle.covariance_m2[0] = -1.0; }},
      {kObstaclesCovariance, [](auto&, auto& obstacle) { obstacle.covariance_relative_m2[1] = 0.2; }},
      {kObstaclesCovariance, [](auto&, auto& obstacle) { obstacle.covariance_relative_m2[2] = kUnknown; }},
      {kObstaclesCode, [](auto&, auto& obstacle) { obstacle.status = 3; }},
      {kObstaclesCode, [](auto&, auto& obstacle) { obstacle.kind = 2; }},
      {kObstaclesCode, [](auto&, auto& obstacle) { obstacle.confidence = 0; }},
  };
  for (std::size_t i = 0; i < cases.size(); ++i) {
    auto message = TwoObstacles();
    cases[i].spoil(message, message.obstacles[1]);
    EXPECT_EQ(FaultOf(message, kMaxBytes), cases[i].fault) << "case " << i;
  }
  const auto message = TwoObstacles();
  EXPECT_EQ(FaultOf(message, message.getEncodedSize() - 1), kObstaclesSize);
}

TEST(ObstaclesCheck, PartsAgreeWhenTheyAreOfOneScanOnOneMap) {
  const auto one = TwoObstacles();
  auto other = one;
  EXPECT_TRUE(AgreeAboutScan(one, other));
  other.datum_latitude_deg += 1e-9;
  EXPECT_FALSE(AgreeAboutScan(one, other));
  other = one;
  other.num_parts = 2;
  EXPECT_FALSE(AgreeAboutScan(one, other));
}

TEST(AcknowledgementCheck, RefusesByTheRightCounter) {
  alert_ack_t message{};
  message.alert_id = 4;
  message.source = "page";
  EXPECT_EQ(FaultOf(message), std::nullopt);
  message.alert_id = 0;
  EXPECT_EQ(FaultOf(message), kAckId);
  message.alert_id = -1;  // of the watch
  message.source = std::string(65, 'a');
  EXPECT_EQ(FaultOf(message), kAckSource);
  message.alert_raised_utime_us = std::numeric_limits<std::int64_t>::max();
  EXPECT_EQ(FaultOf(message), kAckTime);
}

TEST(OrderChecks, TakeNamesOfOneLine) {
  order_t message{};
  message.source = "page";
  message.kind = order_t::KIND_NAME;
  message.track_id = 7;
  for (const auto* good : {"", "Kiosk pier", "Anna's mooring buoy", "Sj\xC3\xB6str\xC3\xB6m"}) {
    message.name = good;
    EXPECT_EQ(FaultOf(message), std::nullopt) << good;
  }
  for (const auto* bad : {"  ", "two\nlines", "bell\x07", "\xC3", "\xC2\x85", "\xE2\x80\xAE turned", "del\x7F", "\xE2\x80\x8B"}) {
    message.name = bad;
    EXPECT_EQ(FaultOf(message), kOrderName) << bad;
  }
  message.name = std::string(40, 'a');
  EXPECT_EQ(FaultOf(message), std::nullopt);
  message.name += 'a';
  EXPECT_EQ(FaultOf(message), kOrderName);
  message.name = "land";
  message.track_id = 0;
  EXPECT_EQ(FaultOf(message), kOrderName) << "land, or what has no track";
}

TEST(OrderChecks, RefuseWhatCannotBe) {
  order_t message{};
  message.source = "page";
  EXPECT_EQ(FaultOf(message), kOrderKind);
  message.kind = order_t::KIND_SILENCE;
  EXPECT_EQ(FaultOf(message), std::nullopt);
  message.kind = order_t::KIND_SETTINGS;
  EXPECT_EQ(FaultOf(message), kOrderKind) << "no mode";
  message.mode = order_t::MODE_HARBOUR;
  message.guard_zone_range_m = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(FaultOf(message), std::nullopt) << "as the config says";
  message.cpa_limit_m = -1.0F;
  EXPECT_EQ(FaultOf(message), kOrderNumber);
  message.cpa_limit_m = std::numeric_limits<float>::infinity();
  EXPECT_EQ(FaultOf(message), kOrderNumber);
  message.source = std::string(65, 'a');
  EXPECT_EQ(FaultOf(message), kOrderSource);
  message.utime_us = std::numeric_limits<std::int64_t>::max();
  EXPECT_EQ(FaultOf(message), kOrderTime);
}

}  // namespace
}  // namespace lookout::messages
