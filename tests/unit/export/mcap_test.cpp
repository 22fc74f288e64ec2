// Logs as MCAP files.
#include "tools/export/mcap.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <google/protobuf/descriptor.h>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "common/viewer/foxglove.pb.h"
#include "common/viewer/foxglove_messages.hpp"
#include "common/viewer/motion.pb.h"
#include "lookout/alerts_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/tracks_t.hpp"
#include "tests/support/files.hpp"
#include "tools/export/mcap_writer.hpp"
#include "tools/import/byte_source.hpp"
#include "tools/import/mcap_file.hpp"

namespace lookout::exporter {
namespace {

using importer::McapFile;
using importer::MemorySource;
using Payload = std::vector<std::uint8_t>;

McapFile Read(const Payload& bytes) { return McapFile(std::make_unique<MemorySource>(bytes)); }

Payload Write(int num_messages, std::size_t size) {
  Payload file;
  McapWriter writer("test", [&file](Bytes bytes) { file.insert(file.end(), bytes.begin(), bytes.end()); });
  const auto schema = writer.AddSchema("lookout.test_t", "x-lcm", "struct test_t {}");
  const auto first = writer.AddChannel(schema, "FIRST", "x-lcm");
  const auto second = writer.AddChannel(0, "SECOND", "cdr");
  writer.AddAttachment("boat.txtpb", "text/plain", 5, "name: \"boat\"\n");
  for (int i = 0; i < num_messages; ++i) {
    writer.AddMessage(i % 3 == 0 ? second : first, static_cast<std::uint64_t>(i) * 1000, Payload(size, static_cast<std::uint8_t>(i)));
  }
  writer.Finish();
  return file;
}

TEST(McapWriter, WritesWhatTheReaderReads) {
  for (const std::size_t size : {0U, 10U, 300'000U}) {
    const auto bytes = Write(20, size);
    EXPECT_EQ(bytes, Write(20, size));
    auto file = Read(bytes);
    const auto topics = file.IndexedTopics();
    ASSERT_EQ(topics.size(), 2U);
    EXPECT_EQ(topics.at(0).name, "FIRST");
    EXPECT_EQ(topics.at(0).type, "lookout.test_t");
    EXPECT_EQ(topics.at(0).encoding, importer::Encoding::kLcm);
    EXPECT_EQ(topics.at(0).num_messages, 13);
    EXPECT_EQ(topics.at(1).num_messages, 7);
    for (int i = 0; i < 20; ++i) {
      const auto message = file.Next();
      ASSERT_TRUE(message);
      EXPECT_EQ(message->topic->name, i % 3 == 0 ? "SECOND" : "FIRST");
      EXPECT_EQ(message->time_ns, i * 1000);
      EXPECT_EQ(Payload(message->bytes.begin(), message->bytes.end()), Payload(size, static_cast<std::uint8_t>(i)));
    }
    EXPECT_FALSE(file.Next());
    EXPECT_FALSE(file.losses().IsAny());
  }
}

TEST(McapWriter, WithoutAMessageWritesAWholeFile) {
  auto file = Read(Write(0, 0));
  EXPECT_FALSE(file.Next());
  EXPECT_FALSE(file.losses().IsAny());
}

// A log with messages of channels that are known, of one that is not, of a damaged one, and of before 1970.
TEST(Mcap, HoldsTheLogMessageForMessage) {
  const support::TempDir folder;
  Payload log;
  lidar_scan_t scan{};
  scan.num_parts = 1;
  std::int64_t number = 0;
  const auto append = [&](std::int64_t utime_us, std::string_view channel, const Payload& bytes) {
    bus::AppendLogEvent(log, number++, Utime(std::chrono::microseconds(utime_us)), channel, bytes);
  };
  append(1'000, "LIDAR_SCAN", bus::Encode(scan));
  append(2'000, "CAMERA", {1, 2, 3});
  append(2'000, "POSE", {0});
  support::WriteFile(folder / "log", {reinterpret_cast<const char*>(log.data()), log.size()});
  std::ostringstream errors;
  ASSERT_EQ(RunMcap({.inputs = {folder / "log"}, .table = "", .output = folder / "mcap"}, errors), kExitFine) << errors.str();
  EXPECT_NE(errors.str().find("1 messages could not be decoded, and are not drawn"), std::string::npos) << errors.str();
  const auto bytes = support::ReadFile(folder / "mcap");
  auto file = Read({bytes.begin(), bytes.end()});
  Payload back;
  number = 0;
  while (const auto message = file.Next()) {
    if (message->topic->encoding != importer::Encoding::kLcm) continue;
    bus::AppendLogEvent(back, number++, Utime(std::chrono::microseconds(message->time_ns / 1000)), message->topic->name, message->bytes);
  }
  EXPECT_EQ(back, log);
  EXPECT_EQ(RunMcap({.inputs = {folder / "log"}, .table = "", .output = folder / "mcap"}, errors), kExitFailed) << "it exists";
  EXPECT_EQ(RunMcap({.inputs = {folder / "log"}, .table = ""}, errors), kExitUsage);
}

struct Drawn {
  viewer::FoxgloveTopic topic;
  std::string bytes;
};

template <typename Message>
std::vector<Drawn> Draw(const bus::Channel& channel, const std::vector<Message>& messages) {
  std::vector<Drawn> drawn;
  viewer::FoxgloveMessages all([&drawn](viewer::FoxgloveTopic topic, const std::string& bytes) { drawn.push_back({topic, bytes}); });
  for (const auto& message : messages) all.Take(channel.name, bus::Encode(message));
  all.Finish();
  return drawn;
}

template <typename Message>
Message Parsed(const std::string& bytes) {
  Message message;
  EXPECT_TRUE(message.ParseFromString(bytes));
  return message;
}

TEST(FoxgloveMessages, JoinThePartsOfAScan) {
  lidar_scan_t part{};
  part.utime_us = 1'500'000;
  part.num_parts = 2;
  part.num_rings = part.num_returns = part.num_columns = part.num_cells = 1;
  part.elevation_rad = part.azimuth_offset_rad = part.origin_height_m = {0.0F};
  part.time_offset_ns = {0};
  part.return_kind = {1};
  part.azimuth_rad = {0.0F};
  part.time_ns = {0};
  part.num_turn_columns = 2;
  part.range = {500};
  part.reflectivity = {7};
  part.range_unit_m = 0.002;
  auto second = part;
  second.part_index = 1;
  auto next = part;  // its second part does not come
  next.seq = 1;
  const auto drawn = Draw(bus::kLidarScan, std::vector{part, second, next});
  ASSERT_EQ(drawn.size(), 2U);
  const auto cloud = Parsed<foxglove::PointCloud>(drawn[0].bytes);
  EXPECT_EQ(cloud.data().size(), 28U);
  EXPECT_EQ(cloud.point_stride(), 14U);
  EXPECT_EQ(cloud.timestamp().seconds(), 1);
  EXPECT_EQ(cloud.timestamp().nanos(), 500'000'000);
  EXPECT_EQ(cloud.data()[12], 7);
  EXPECT_EQ(Parsed<foxglove::PointCloud>(drawn[1].bytes).data().size(), 14U);
  EXPECT_EQ(Draw(bus::kLidarScan, std::vector(5, second)).size(), 5U) << "a part that comes again makes no cloud that grows";
}

TEST(FoxgloveMessages, DrawAnObstacleWhereItsPlaceIsKnownInTheMapElseBesideTheBoat) {
  obstacles_t message{};
  message.num_parts = 1;
  message.num_obstacles = 2;
  message.obstacles.resize(2);
  for (auto& obstacle : message.obstacles) {
    obstacle.id = static_cast<std::int32_t>(&obstacle - message.obstacles.data()) + 1;
    obstacle.confidence = obstacle_t::CONFIDENCE_SURE;
    obstacle.num_points = obstacle.num_footprint = 1;
    obstacle.footprint_vessel_x_m = obstacle.footprint_vessel_y_m = {3.0F};
  }
  auto& placed = message.obstacles[0];
  placed.num_map = 1;
  placed.footprint_east_m = placed.footprint_north_m = {100.0F};
  message.obstacles[1].status = obstacle_t::STATUS_VESSEL_FRAME_ONLY;
  const auto drawn = Draw(bus::kObstacles, std::vector{message});
  ASSERT_EQ(drawn.size(), 1U);
  const auto scene = Parsed<foxglove::SceneUpdate>(drawn[0].bytes);
  ASSERT_EQ(scene.entities_size(), 2);
  EXPECT_EQ(scene.deletions(0).type(), foxglove::SceneEntityDeletion::ALL);
  EXPECT_EQ(scene.entities(0).frame_id(), "map");
  EXPECT_EQ(scene.entities(0).lines(0).points(0).x(), 100.0);
  EXPECT_EQ(scene.entities(1).frame_id(), "vessel");
  EXPECT_EQ(scene.entities(1).lines(0).points(0).x(), 3.0);
}

// Heights by GNSS are metres off, and 200 m where the datum had none; obstacles have no height at all.
TEST(FoxgloveMessages, LetTheBoatFloatOnTheWaterOnWhichObstaclesAreDrawn) {
  pose_t pose{};
  pose.utime_us = 20'000;
  pose.has_attitude = true;
  pose.latitude_deg = pose.datum_latitude_deg = 1.0;
  pose.longitude_deg = pose.datum_longitude_deg = 2.0;
  pose.position_map_m[2] = 201.4;
  pose.ellipsoid_height_m = 201.4;
  pose.heave_m = 0.3;
  for (int i = 0; i < 9; ++i) pose.covariance[i][i] = 1.0;
  const auto drawn = Draw(bus::kPose, std::vector{pose});
  ASSERT_FALSE(drawn.empty());
  ASSERT_EQ(drawn[0].topic, viewer::FoxgloveTopic::kTransforms);
  const auto transforms = Parsed<foxglove::FrameTransforms>(drawn[0].bytes);
  ASSERT_EQ(transforms.transforms_size(), 1);
  EXPECT_EQ(transforms.transforms(0).child_frame_id(), "vessel");
  EXPECT_DOUBLE_EQ(transforms.transforms(0).translation().z(), 0.3);
}

TEST(FoxgloveMessages, JoinThePartsOfTracksOnTheMapAndLeaveOutWhatHasNoPlace) {
  tracks_t part{};
  part.num_parts = 2;
  part.num_tracks = 2;
  part.tracks.resize(2);
  for (auto& track : part.tracks) track.status = track_t::STATUS_CONFIRMED;
  part.tracks[0].id = 4;
  part.tracks[1].id = 5;
  part.tracks[1].velocity_map_mps[0] = 1e200;
  auto second = part;
  second.part_index = 1;
  second.tracks[0].id = 6;
  second.tracks[1].position_map_m[0] = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::string> places;
  int num_entities = 0;
  for (const auto& [topic, bytes] : Draw(bus::kTracks, std::vector{part, second})) {
    if (topic == viewer::FoxgloveTopic::kPlaces) places.push_back(Parsed<foxglove::GeoJSON>(bytes).geojson());
    if (topic == viewer::FoxgloveTopic::kTracks) num_entities += Parsed<foxglove::SceneUpdate>(bytes).entities_size();
  }
  EXPECT_EQ(num_entities, 2);
  ASSERT_EQ(places.size(), 1U);
  EXPECT_NE(places[0].find(" 4\""), std::string::npos) << places[0];
  EXPECT_NE(places[0].find(" 6\""), std::string::npos) << places[0];
  EXPECT_EQ(places[0].find(" 5\""), std::string::npos) << places[0];
}

TEST(FoxgloveMessages, TellAnAlertWhenItChanges) {
  alerts_t message{};
  message.num_alerts = 1;
  auto& alert = message.alerts.emplace_back();
  alert.id = 4;
  alert.level = alert_t::LEVEL_WARNING;
  alert.state = alert_t::STATE_ACTIVE;
  alert.text = "boat 17 in the guard zone\x1B";
  auto cleared = message;
  cleared.alerts[0].state = alert_t::STATE_CLEARED;
  const auto drawn = Draw(bus::kAlerts, std::vector{message, message, cleared});
  ASSERT_EQ(drawn.size(), 2U);
  const auto log = Parsed<foxglove::Log>(drawn[0].bytes);
  EXPECT_EQ(log.level(), foxglove::Log::ERROR);
  EXPECT_EQ(log.message(), "boat 17 in the guard zone? (active)");
  EXPECT_EQ(Parsed<foxglove::Log>(drawn[1].bytes).level(), foxglove::Log::INFO);
}

TEST(FoxgloveMessages, TellHowTheBoatMovesFiveTimesASecondAndNothingThatIsNotMeasured) {
  pose_t pose{};
  pose.utime_us = 400'000;
  pose.velocity_map_mps[0] = 3.0;
  pose.velocity_map_mps[1] = 4.0;
  pose.heading_source = pose_t::HEADING_HDT;
  pose.heading_rad = std::numbers::pi / 2;
  auto next = pose;
  next.utime_us = 420'000;
  auto last = pose;
  last.utime_us = 600'000;
  last.has_attitude = 1;
  last.roll_rad = std::numbers::pi / 4;
  last.heading_source = pose_t::HEADING_NONE;
  std::vector<viewer::Motion> motions;
  for (const auto& [topic, bytes] : Draw(bus::kPose, std::vector{pose, next, last})) {
    if (topic == viewer::FoxgloveTopic::kMotion) motions.push_back(Parsed<viewer::Motion>(bytes));
  }
  ASSERT_EQ(motions.size(), 2U);
  EXPECT_DOUBLE_EQ(motions[0].speed_mps(), 5.0);
  EXPECT_DOUBLE_EQ(motions[0].heading_deg(), 90.0);
  EXPECT_TRUE(std::isnan(motions[0].roll_deg()) && std::isnan(motions[0].pitch_deg()));
  EXPECT_TRUE(std::isnan(motions[1].heading_deg()));
  EXPECT_DOUBLE_EQ(motions[1].roll_deg(), 45.0);
}

// Each path of a plot is a topic and its fields.
void FindTopics(const nlohmann::json& value, std::set<std::string>& found) {
  const auto take = [&found](const std::string& text) {
    if (text.starts_with('/')) found.insert(text);
  };
  if (value.is_string()) take(value.get<std::string>());
  if (!value.is_structured()) return;
  for (const auto& [name, member] : value.items()) {
    take(name);
    FindTopics(member, found);
  }
}

TEST(FoxgloveLayout, ShowsTopicsThatAreExported) {
  const auto layout = nlohmann::json::parse(support::ReadFile(support::kSources / "tools/export/lookout.layout.json"));
  std::set<std::string> panels;
  const std::function<void(const nlohmann::json&)> take = [&](const nlohmann::json& part) {
    if (part.is_string()) {
      panels.insert(part.get<std::string>());
    } else {
      take(part.at("first"));
      take(part.at("second"));
    }
  };
  take(layout.at("layout"));
  std::set<std::string> configured;
  for (const auto& [panel, config] : layout.at("configById").items()) configured.insert(panel);
  EXPECT_EQ(panels, configured);

  std::set<std::string> shown;
  FindTopics(layout.at("configById"), shown);
  std::set<std::string> used;
  for (const auto& path : shown) {
    const auto dot = path.find('.');
    const auto topic = path.substr(0, dot);
    const auto row = std::ranges::find(viewer::kFoxgloveChannels, topic, &viewer::FoxgloveChannel::name);
    ASSERT_NE(row, viewer::kFoxgloveChannels.end()) << path;
    used.insert(topic);
    if (dot == std::string::npos) continue;
    const auto* type = google::protobuf::DescriptorPool::generated_pool()->FindMessageTypeByName(std::string(row->schema));
    ASSERT_NE(type, nullptr);
    EXPECT_NE(type->FindFieldByName(path.substr(dot + 1)), nullptr) << path;
  }
  // Frames are shown by themselves.
  EXPECT_EQ(used.size() + 1, viewer::kFoxgloveChannels.size());
}

}  // namespace
}  // namespace lookout::exporter
