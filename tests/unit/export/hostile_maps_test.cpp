// Logs of any numbers: a map of them is whole, and every place in it is one on the earth.
#include <array>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <random>

#include "lookout/alerts_t.hpp"
#include "lookout/tracks_t.hpp"
#include "tests/unit/export/export_logs.hpp"

namespace lookout::exporter {
namespace {

class HostileMapTest : public ExportTest {
 protected:
  // Plain numbers, those at the ends of what is allowed, and any bits.
  double AnyNumber() {
    constexpr std::array kSpecial{0.0, -0.0, 90.0, -90.0, 180.0, -180.0, 1e-300, 1e30, 999'999.0, kNaN, std::numeric_limits<double>::infinity()};
    const auto kind = random_() % 8;
    if (kind == 0) return kSpecial[random_() % kSpecial.size()];
    if (kind == 1) {
      const std::uint64_t bits = random_();
      double number = 0.0;
      std::memcpy(&number, &bits, sizeof(number));
      return number;
    }
    return std::uniform_real_distribution<double>(-100.0, 100.0)(random_);
  }
  float AnyFloat() { return static_cast<float>(AnyNumber()); }
  std::vector<float> AnyFloats(std::size_t number) {
    std::vector<float> floats(number);
    for (auto& one : floats) one = AnyFloat();
    return floats;
  }
  std::int64_t AnyTime() {
    return random_() % 20 == 0 ? static_cast<std::int64_t>(random_()) : kStartUs + static_cast<std::int64_t>(random_() % 1'000'000);
  }
  std::string AnyText() {
    std::string text;
    for (int i = 0; i < 12; ++i) text += static_cast<char>(1 + random_() % 255);
    return text;
  }

  obstacle_t AnyObstacle() {
    obstacle_t obstacle{};
    obstacle.utime_us = AnyTime();
    obstacle.status = static_cast<std::int32_t>(random_() % 2);
    obstacle.kind = static_cast<std::int32_t>(random_() % 3);
    obstacle.latitude_deg = AnyNumber();
    obstacle.longitude_deg = AnyNumber();
    for (auto& one : obstacle.position_map_m) one = AnyNumber();
    for (auto& one : obstacle.covariance_m2) one = AnyNumber();
    obstacle.range_m = AnyFloat();
    obstacle.bearing_rad = AnyFloat();
    obstacle.height_m = AnyFloat();
    const std::size_t num_corners = random_() % 8;
    obstacle.num_footprint = obstacle.num_map = static_cast<std::int32_t>(num_corners);
    obstacle.footprint_vessel_x_m = obstacle.footprint_vessel_y_m = std::vector<float>(num_corners);
    obstacle.footprint_east_m = AnyFloats(num_corners);
    obstacle.footprint_north_m = AnyFloats(num_corners);
    const std::size_t num_waterline = random_() % 4;
    obstacle.num_waterline = obstacle.num_waterline_map = static_cast<std::int32_t>(num_waterline);
    obstacle.waterline_vessel_x_m = obstacle.waterline_vessel_y_m = std::vector<float>(num_waterline);
    obstacle.waterline_east_m = AnyFloats(num_waterline);
    obstacle.waterline_north_m = AnyFloats(num_waterline);
    return obstacle;
  }

  track_t AnyTrack() {
    track_t track{};
    track.id = static_cast<std::int64_t>(random_() % 3);
    track.status = static_cast<std::int32_t>(random_() % 6);
    track.first_utime_us = AnyTime();
    track.seen_utime_us = AnyTime();
    track.latitude_deg = AnyNumber();
    track.longitude_deg = AnyNumber();
    for (auto& one : track.position_map_m) one = AnyNumber();
    for (auto& row : track.covariance) {
      for (auto& one : row) one = AnyNumber();
    }
    track.speed_mps = AnyFloat();
    track.course_rad = AnyFloat();
    const std::size_t num_corners = random_() % 6;
    track.num_outline = static_cast<std::int32_t>(num_corners);
    track.outline_east_m = AnyFloats(num_corners);
    track.outline_north_m = AnyFloats(num_corners);
    return track;
  }

  void AddAnyMessages() {
    pose_t pose{};
    pose.utime_us = AnyTime();
    pose.status = static_cast<std::int32_t>(random_() % 6);
    pose.latitude_deg = AnyNumber();
    pose.longitude_deg = AnyNumber();
    pose.datum_latitude_deg = AnyNumber();
    pose.velocity_map_mps[0] = AnyNumber();
    Add(bus::kPose, pose);
    obstacles_t obstacles{};
    obstacles.utime_us = AnyTime();
    obstacles.end_utime_us = AnyTime();
    obstacles.num_parts = 1;
    obstacles.datum_latitude_deg = AnyNumber();
    obstacles.datum_longitude_deg = AnyNumber();
    for (int i = 0; i < 3; ++i) obstacles.obstacles.push_back(AnyObstacle());
    obstacles.num_obstacles = 3;
    Add(bus::kObstacles, obstacles);
    tracks_t tracks{};
    tracks.utime_us = AnyTime();
    tracks.end_utime_us = AnyTime();
    tracks.num_parts = 1;
    tracks.datum_latitude_deg = AnyNumber();
    tracks.datum_longitude_deg = AnyNumber();
    tracks.datum_ellipsoid_height_m = AnyNumber();
    for (int i = 0; i < 3; ++i) tracks.tracks.push_back(AnyTrack());
    tracks.num_tracks = 3;
    tracks.num_waterline = 5;
    tracks.waterline_east_m = AnyFloats(5);
    tracks.waterline_north_m = AnyFloats(5);
    Add(bus::kTracks, tracks);
    alerts_t alerts{};
    alerts.utime_us = alerts.end_utime_us = AnyTime();
    alerts.alerts.resize(1);
    alerts.alerts[0].id = static_cast<std::int64_t>(random_() % 50);
    alerts.alerts[0].state = alert_t::STATE_ACTIVE;
    alerts.alerts[0].text = AnyText();
    alerts.num_alerts = 1;
    Add(bus::kAlerts, alerts);
  }

  std::mt19937_64 random_{20261123};
};

// Every position in lists of lists.
void ExpectOnEarth(const nlohmann::json& coordinates) {
  if (coordinates.empty() || coordinates[0].is_array()) {
    for (const auto& one : coordinates) ExpectOnEarth(one);
    return;
  }
  ASSERT_EQ(coordinates.size(), 2U);
  EXPECT_LE(std::abs(coordinates[0].get<double>()), 180.0);
  EXPECT_LE(std::abs(coordinates[1].get<double>()), 90.0);
}

TEST_F(HostileMapTest, IsWholeWhateverTheNumbers) {
  for (int i = 0; i < 400; ++i) AddAnyMessages();
  for (const auto* table : {"obstacles", "tracks", "pose"}) {
    ASSERT_EQ(Export(table, "geojson"), kExitFine) << errors_;
    const auto map = nlohmann::json::parse(text_);
    ASSERT_GT(map["features"].size(), 3U);
    for (const auto& feature : map["features"]) ExpectOnEarth(feature["geometry"]["coordinates"]);
    for (const auto* format : {"kml", "gpx"}) {
      ASSERT_EQ(Export(table, format), kExitFine) << errors_;
      EXPECT_EQ(text_.find(">nan"), std::string::npos);
      EXPECT_EQ(text_.find("inf<"), std::string::npos);
      EXPECT_TRUE(text_.ends_with(format == std::string("kml") ? "</kml>\n" : "</gpx>\n"));
      for (const char letter : text_) ASSERT_TRUE(letter == '\n' || (letter >= ' ' && letter <= '~'));
    }
    ASSERT_EQ(Export(table), kExitFine) << errors_;
  }
  Request request{.inputs = {log_}, .table = "tracks", .format = "geojson", .output = folder_ / "out", .force = true};
  request.near = Circle{{10.0, 20.0, 0.0}, 8e6};
  ASSERT_EQ(Export(request), kExitFine) << errors_;
  EXPECT_TRUE(nlohmann::json::accept(text_));
}

}  // namespace
}  // namespace lookout::exporter
