#include "services/georeferencer/wire.hpp"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/core/angles.hpp"
#include "services/georeferencer/core/georeferencer.hpp"
#include "tests/unit/georeferencer/messages.hpp"

namespace lookout::georeferencer {
namespace {

using test::At;
using test::MakePoseMessage;
using test::MakeSegmentMessage;
using test::MakeSegmentsMessage;

constexpr float kNanF = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfF = std::numeric_limits<float>::infinity();
constexpr double kInf = std::numeric_limits<double>::infinity();

segments_t GoodSegments() { return MakeSegmentsMessage(0, 3, {MakeSegmentMessage(1, 10'000, 3), MakeSegmentMessage(2, 99'000)}); }

std::string RefusalOf(const segments_t& message) {
  const auto result = ToSegmentPart(message, bus::kMaxMessageBytes);
  const auto* refusal = std::get_if<Refusal>(&result);
  return refusal == nullptr ? "" : std::string(*refusal);
}

std::string RefusalOf(const pose_t& message) {
  const auto result = ToPose(message);
  const auto* refusal = std::get_if<Refusal>(&result);
  return refusal == nullptr ? "" : std::string(*refusal);
}

TEST(ToSegmentPart, TakesAWholeMessageOver) {
  auto message = GoodSegments();
  message.scan_flags = 5;
  message.segments[0].hull_time_us[2] = 99'000;
  const auto result = ToSegmentPart(message, bus::kMaxMessageBytes);
  ASSERT_TRUE(std::holds_alternative<SegmentPart>(result));
  const auto& part = std::get<SegmentPart>(result);
  EXPECT_EQ(part.head.time, At(0));
  EXPECT_EQ(part.head.end_time, At(99'000));
  EXPECT_EQ(part.head.seq, 3);
  EXPECT_EQ(part.head.raw_seq, 30);
  EXPECT_EQ(part.head.scan_flags, 5);
  ASSERT_EQ(part.segments.size(), 2U);
  EXPECT_EQ(part.segments[0].hull[2].time, At(99'000));
  EXPECT_EQ(part.segments[0].hull[1].p_lidar_m, Eigen::Vector2d(11.0, 1.0));
  EXPECT_EQ(part.segments[1].id, 2);
}

TEST(ToSegmentPart, RefusesEachFaultUnderItsOwnName) {
  using Change = std::function<void(segments_t&)>;
  const std::vector<std::pair<Refusal, Change>> changes{
      {kSegmentsTime, [](segments_t& m) { m.utime_us = std::numeric_limits<std::int64_t>::min(); }},
      {kSegmentsTime, [](segments_t& m) { m.end_utime_us = std::numeric_limits<std::int64_t>::max(); }},
      {kSegmentsTime, [](segments_t& m) { m.end_utime_us = m.utime_us - 1; }},
      {kSegmentsTime, [](segments_t& m) { m.end_utime_us = m.utime_us + 60'000'001; }},
      {kSegmentsTime, [](segments_t& m) { m.segments[0].utime_us = m.utime_us - 1; }},
      {kSegmentsTime, [](segments_t& m) { m.segments[0].nearest_utime_us = m.end_utime_us + 1; }},
      {kSegmentsTime, [](segments_t& m) { m.segments[0].hull_time_us[0] = -1; }},
      {kSegmentsTime, [](segments_t& m) { m.segments[0].hull_time_us[0] = 99'001; }},
      {kSegmentsParts, [](segments_t& m) { m.seq = -1; }},
      {kSegmentsParts, [](segments_t& m) { m.raw_seq = -1; }},
      {kSegmentsParts, [](segments_t& m) { m.num_parts = 0; }},
      {kSegmentsParts, [](segments_t& m) { m.num_parts = 1001; }},
      {kSegmentsParts, [](segments_t& m) { m.part_index = 1; }},
      {kSegmentsParts, [](segments_t& m) { m.part_index = -1; }},
      {kSegmentsCount, [](segments_t& m) { m.num_turn_segments = 1; }},
      {kSegmentsCount, [](segments_t& m) { m.num_segments = 1; }},
      {kSegmentsCount, [](segments_t& m) { m.num_segments = -1; }},
      {kSegmentsCount, [](segments_t& m) { m.segments[0].num_hull = 4; }},
      {kSegmentsCount, [](segments_t& m) { m.segments[0].num_points = 0; }},
      {kSegmentsCount, [](segments_t& m) { m.segments[0] = MakeSegmentMessage(1, 0, 0); }},
      {kSegmentsId, [](segments_t& m) { m.segments[0].id = 0; }},
      {kSegmentsId, [](segments_t& m) { m.segments[1].id = 1; }},
      {kSegmentsId, [](segments_t& m) { m.segments[1].id = 3; }},
      {kSegmentsNumber, [](segments_t& m) { m.segments[0].centroid_m[2] = kNanF; }},
      {kSegmentsNumber, [](segments_t& m) { m.segments[0].nearest_m[0] = kInfF; }},
      {kSegmentsNumber, [](segments_t& m) { m.segments[0].hull_x_m[1] = 1e38F; }},
      {kSegmentsNumber, [](segments_t& m) { m.segments[0].hull_y_m[1] = -kInfF; }},
      {kSegmentsNumber, [](segments_t& m) { m.segments[0].length_m = -0.1F; }},
      {kSegmentsNumber, [](segments_t& m) { m.segments[0].width_m = kNanF; }},
      {kSegmentsNumber, [](segments_t& m) { m.segments[0].min_z_m = 1.0F; }},
      {kSegmentsNumber, [](segments_t& m) { m.segments[0].mean_reflectivity = kInfF; }},
  };
  EXPECT_EQ(RefusalOf(GoodSegments()), "");
  for (std::size_t i = 0; i < changes.size(); ++i) {
    auto message = GoodSegments();
    changes[i].second(message);
    EXPECT_EQ(RefusalOf(message), changes[i].first) << "change " << i;
  }
}

TEST(ToSegmentPart, RefusesWhatIsLargerThanAMessageMayBe) {
  std::vector<segment_t> segments;
  for (int id = 1; id <= 1400; ++id) segments.push_back(MakeSegmentMessage(id, 0));
  EXPECT_EQ(RefusalOf(MakeSegmentsMessage(0, 0, std::move(segments))), kSegmentsSize);
}

TEST(ToPose, TakesAPoseOver) {
  auto message = MakePoseMessage(20'000);
  message.position_map_m[1] = 7.0;
  message.heading_rad = 6.0;
  message.pitch_rad = 0.1;
  message.roll_rad = -0.2;
  message.heave_m = 0.3;
  message.covariance[1][8] = message.covariance[8][1] = 0.005;
  const auto result = ToPose(message);
  ASSERT_TRUE(std::holds_alternative<Pose>(result));
  const auto& pose = std::get<Pose>(result);
  EXPECT_EQ(pose.time, At(20'000));
  EXPECT_TRUE(pose.is_placed);
  EXPECT_EQ(pose.position_map_m.y(), 7.0);
  EXPECT_EQ(pose.heading_rad, 6.0);
  EXPECT_EQ(pose.pitch_rad, 0.1);
  EXPECT_EQ(pose.roll_rad, -0.2);
  EXPECT_EQ(pose.heave_m, 0.3);
  EXPECT_EQ(pose.covariance(1, 4), 0.005) << "north with heading";
  EXPECT_EQ(pose.covariance(0, 0), 0.01);
}

TEST(ToPose, AcceptsWhatIsHonestlyUnknown) {
  auto message = MakePoseMessage(0);
  message.datum_ellipsoid_height_m = kUnknown;
  message.heave_m = kUnknown;
  for (int i = 0; i < 9; ++i) message.covariance[2][i] = message.covariance[i][2] = kUnknown;
  EXPECT_EQ(RefusalOf(message), "");

  pose_t unknown{};
  unknown.utime_us = test::kStartUs;
  unknown.status = pose_t::STATUS_UNKNOWN;
  unknown.heading_rad = unknown.heave_m = unknown.pitch_rad = unknown.roll_rad = kUnknown;
  unknown.datum_latitude_deg = kUnknown;
  for (auto& number : unknown.position_map_m) number = kUnknown;
  const auto result = ToPose(unknown);
  ASSERT_TRUE(std::holds_alternative<Pose>(result));
  EXPECT_FALSE(std::get<Pose>(result).is_placed);
  EXPECT_EQ(std::get<Pose>(result).roll_rad, 0.0);
}

TEST(ToPose, RefusesEachFaultUnderItsOwnName) {
  using Change = std::function<void(pose_t&)>;
  const std::vector<std::pair<Refusal, Change>> changes{
      {kPoseTime, [](pose_t& m) { m.utime_us = std::numeric_limits<std::int64_t>::max(); }},
      {kPoseTime, [](pose_t& m) { m.utime_us += 1; }},
      {kPoseStatus, [](pose_t& m) { m.status = -1; }},
      {kPoseStatus, [](pose_t& m) { m.status = 5; }},
      {kPoseNumber, [](pose_t& m) { m.position_map_m[0] = kUnknown; }},
      {kPoseNumber, [](pose_t& m) { m.position_map_m[1] = 1e300; }},
      {kPoseNumber, [](pose_t& m) { m.position_map_m[2] = kInf; }},
      {kPoseNumber, [](pose_t& m) { m.heading_rad = kUnknown; }},
      {kPoseNumber, [](pose_t& m) { m.heading_rad = -0.1; }},
      {kPoseNumber, [](pose_t& m) { m.heading_rad = 1e300; }},
      {kPoseNumber, [](pose_t& m) { m.pitch_rad = 4.0; }},
      {kPoseNumber, [](pose_t& m) { m.roll_rad = kInf; }},
      {kPoseNumber, [](pose_t& m) { m.heave_m = 1e6; }},
      {kPoseNumber, [](pose_t& m) { m.datum_latitude_deg = 90.1; }},
      {kPoseNumber, [](pose_t& m) { m.datum_longitude_deg = kUnknown; }},
      {kPoseNumber, [](pose_t& m) { m.datum_ellipsoid_height_m = 1e300; }},
      {kPoseCovariance, [](pose_t& m) { m.covariance[0][0] = -1e-9; }},
      {kPoseCovariance, [](pose_t& m) { m.covariance[8][8] = kInf; }},
      {kPoseCovariance, [](pose_t& m) { m.covariance[4][4] = 1e300; }},
      {kPoseCovariance, [](pose_t& m) { m.covariance[0][1] = 0.001; }},
      {kPoseCovariance, [](pose_t& m) { m.covariance[0][1] = m.covariance[1][0] = 0.02; }},
      {kPoseCovariance, [](pose_t& m) { m.covariance[0][1] = kUnknown; }},
      {kPoseCovariance, [](pose_t& m) { m.covariance[0][0] = kUnknown, m.covariance[0][1] = m.covariance[1][0] = 0.1; }},
  };
  EXPECT_EQ(RefusalOf(MakePoseMessage(0)), "");
  for (std::size_t i = 0; i < changes.size(); ++i) {
    auto message = MakePoseMessage(0);
    changes[i].second(message);
    EXPECT_EQ(RefusalOf(message), changes[i].first) << "change " << i;
  }
}

// ---- OBSTACLES

// Places a message between poses that are all known.
ObstaclePart Placed(const segments_t& message) {
  const auto part = ToSegmentPart(message, bus::kMaxMessageBytes);
  EXPECT_TRUE(std::holds_alternative<SegmentPart>(part)) << std::get<Refusal>(part);
  Georeferencer georeferencer(PlacementParams{}, std::chrono::seconds(1));
  georeferencer.AddSegments(std::get<SegmentPart>(part));
  std::vector<ObstaclePart> released;
  for (int i = 0; i <= 5 && released.empty(); ++i) released = georeferencer.AddPose(test::MakePose(20'000 * i));
  EXPECT_EQ(released.size(), 1U);
  return released.at(0);
}

TEST(ToMessages, GivesOneMessageWithTheHeadOfTheTurn) {
  const auto messages = ToMessages(Placed(GoodSegments()), bus::kMaxMessageBytes);
  ASSERT_EQ(messages.size(), 1U);
  const auto& message = messages[0];
  EXPECT_EQ(message.utime_us, test::kStartUs);
  EXPECT_EQ(message.end_utime_us, test::kStartUs + 99'000);
  EXPECT_EQ(message.seq, 3);
  EXPECT_EQ(message.raw_seq, 30);
  EXPECT_EQ(message.part_index, 0);
  EXPECT_EQ(message.num_parts, 1);
  EXPECT_EQ(message.datum_latitude_deg, test::kLake.latitude_deg);
  ASSERT_EQ(message.num_obstacles, 2);
  const auto& obstacle = message.obstacles[0];
  EXPECT_EQ(obstacle.status, obstacle_t::STATUS_OK);
  EXPECT_EQ(obstacle.num_footprint, 3);
  EXPECT_EQ(obstacle.num_map, 3);
  EXPECT_TRUE(bus::Decode<obstacles_t>(bus::Encode(message)));
}

TEST(ToMessages, EncodedSizesAreThoseOfTheProof) {
  EXPECT_EQ(static_cast<std::size_t>(obstacles_t{}.getEncodedSize()), kHeadBytes);
  EXPECT_EQ(static_cast<std::size_t>(obstacle_t{}._getEncodedSizeNoHash()), kObstacleBytes);
  const auto messages = ToMessages(Placed(MakeSegmentsMessage(0, 0, {MakeSegmentMessage(1, 0, 30)})), bus::kMaxMessageBytes);
  EXPECT_EQ(static_cast<std::size_t>(messages[0].getEncodedSize()), kHeadBytes + kObstacleBytes + 30 * kVertexBytes);
  // The bound on how much larger than its segment an obstacle is: with one vertex, 152 against 104 bytes.
  EXPECT_EQ(MakeSegmentMessage(1, 0, 1)._getEncodedSizeNoHash(), 104);
}

// Ids over all messages, in their order.
std::vector<std::int32_t> Ids(const std::vector<obstacles_t>& messages) {
  std::vector<std::int32_t> ids;
  for (const auto& message : messages) {
    for (const auto& obstacle : message.obstacles) ids.push_back(obstacle.id);
  }
  return ids;
}

TEST(ToMessages, FullSegmentsOfAnyOutlineGoInAtMostTwoMessagesAndNoneIsLost) {
  for (const int num_vertices : {1, 2, 3, 10, 50, 139, 140, 141, 1000, 9000}) {
    std::vector<segment_t> segments;
    const int segment_bytes = MakeSegmentMessage(1, 0, num_vertices)._getEncodedSizeNoHash();
    const int num_segments = (bus::kMaxMessageBytes - segments_t{}.getEncodedSize()) / segment_bytes;
    for (int id = 1; id <= num_segments; ++id) segments.push_back(MakeSegmentMessage(id, 0, num_vertices));
    const auto messages = ToMessages(Placed(MakeSegmentsMessage(0, 0, std::move(segments))), bus::kMaxMessageBytes);
    ASSERT_GE(messages.size(), 1U);
    ASSERT_LE(messages.size(), 2U) << num_vertices;
    for (std::size_t i = 0; i < messages.size(); ++i) {
      EXPECT_LE(messages[i].getEncodedSize(), bus::kMaxMessageBytes) << num_vertices;
      EXPECT_EQ(messages[i].part_index, static_cast<int>(i));
      EXPECT_EQ(messages[i].num_parts, static_cast<int>(messages.size()));
    }
    const auto ids = Ids(messages);
    ASSERT_EQ(ids.size(), static_cast<std::size_t>(num_segments));
    for (int id = 1; id <= num_segments; ++id) EXPECT_EQ(ids[static_cast<std::size_t>(id - 1)], id);
  }
}

TEST(ToMessages, EachPartOfALargeTurnGivesTwoWhetherItNeedsThemOrNot) {
  for (const int part_index : {0, 1, 2}) {
    auto message = MakeSegmentsMessage(0, 0, {MakeSegmentMessage(60, 0)});
    message.num_turn_segments = 2000;
    message.num_parts = 3;
    message.part_index = part_index;
    const auto messages = ToMessages(Placed(message), bus::kMaxMessageBytes);
    ASSERT_EQ(messages.size(), 2U);
    EXPECT_EQ(messages[0].part_index, 2 * part_index);
    EXPECT_EQ(messages[1].part_index, 2 * part_index + 1);
    EXPECT_EQ(messages[0].num_parts, 6);
    EXPECT_EQ(messages[0].num_obstacles + messages[1].num_obstacles, 1);
  }
}

TEST(ToMessages, PartsOfATurnWithFewObstaclesMirrorThoseOfSegments) {
  auto message = MakeSegmentsMessage(0, 0, {MakeSegmentMessage(1, 0)});
  message.num_turn_segments = 50;
  message.num_parts = 2;
  message.part_index = 1;
  const auto messages = ToMessages(Placed(message), bus::kMaxMessageBytes);
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(messages[0].part_index, 1);
  EXPECT_EQ(messages[0].num_parts, 2);
}

TEST(ToMessages, BearingIsBelowTwoPiAlsoAsAFloat) {
  auto message = MakeSegmentsMessage(0, 0, {MakeSegmentMessage(1, 0)});
  message.segments[0].nearest_m[0] = 100.0F;
  message.segments[0].nearest_m[1] = 1e-6F;  // a hair to port
  const auto messages = ToMessages(Placed(message), bus::kMaxMessageBytes);
  EXPECT_LT(static_cast<double>(messages[0].obstacles[0].bearing_rad), kTwoPi);
}

TEST(ToMessages, AtTheBoundsOfWhatIsTakenAllNumbersAreFinite) {
  auto message = MakeSegmentsMessage(0, 0, {MakeSegmentMessage(1, 0, 3)});
  auto& segment = message.segments[0];
  for (auto& number : segment.centroid_m) number = -1e5F;
  for (auto& number : segment.nearest_m) number = 1e5F;
  segment.hull_x_m = {1e5F, -1e5F, -1e5F};
  segment.hull_y_m = {1e5F, 1e5F, -1e5F};
  auto pose_message = MakePoseMessage(0);
  for (auto& number : pose_message.position_map_m) number = 1e5;
  pose_message.datum_latitude_deg = 90.0;
  pose_message.datum_longitude_deg = 180.0;
  for (int i = 0; i < 9; ++i) pose_message.covariance[i][i] = 1e12;
  const auto pose = std::get<Pose>(ToPose(pose_message));
  PoseHistory poses;
  poses.Add(pose);
  const auto part = std::get<SegmentPart>(ToSegmentPart(message, bus::kMaxMessageBytes));
  ObstaclePart placed{part.head, pose.datum, {PlaceSegment(part.segments[0], poses, pose.datum, false, PlacementParams{})}};
  const auto obstacle = ToMessages(placed, bus::kMaxMessageBytes)[0].obstacles[0];
  EXPECT_EQ(obstacle.status, obstacle_t::STATUS_OK);
  for (const double number : {obstacle.latitude_deg, obstacle.longitude_deg, obstacle.position_map_m[0], obstacle.covariance_m2[0],
                              obstacle.covariance_m2[1], obstacle.top_above_water_m}) {
    EXPECT_TRUE(std::isfinite(number));
  }
  EXPECT_TRUE(std::isfinite(obstacle.footprint_north_m[2]));
}

}  // namespace
}  // namespace lookout::georeferencer
