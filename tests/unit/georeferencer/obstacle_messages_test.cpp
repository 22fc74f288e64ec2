// OBSTACLES out of what was placed: their fields, their sizes, their parts.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/core/angles.hpp"
#include "common/messages/pose_message.hpp"
#include "services/georeferencer/core/georeferencer.hpp"
#include "services/georeferencer/wire.hpp"
#include "tests/unit/georeferencer/messages.hpp"

namespace lookout::georeferencer {
namespace {

using test::AddWaterline;
using test::MakeGoodSegments;
using test::MakePoseMessage;
using test::MakeSegmentMessage;
using test::MakeSegmentsMessage;

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
  const auto messages = ToMessages(Placed(MakeGoodSegments()), bus::kMaxMessageBytes);
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
  EXPECT_EQ(obstacle.num_waterline, 0);
  EXPECT_EQ(obstacle.num_waterline_map, 0);
  EXPECT_EQ(obstacle.kind, obstacle_t::KIND_OBSTACLE);
  EXPECT_EQ(obstacle.confidence, obstacle_t::CONFIDENCE_SURE);
  const auto& land = message.obstacles[1];
  EXPECT_EQ(land.kind, obstacle_t::KIND_LAND);
  EXPECT_EQ(land.num_waterline, 4);
  EXPECT_EQ(land.waterline_vessel_x_m, (std::vector<float>{20, 20, 20, 20}));
  EXPECT_EQ(land.waterline_vessel_y_m, (std::vector<float>{0, -1, -2, -3}));
  EXPECT_EQ(land.num_waterline_map, 4);
  ASSERT_EQ(land.waterline_east_m.size(), 4U);
  ASSERT_EQ(land.waterline_north_m.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {  // heading north
    EXPECT_NEAR(land.waterline_east_m[i], static_cast<float>(i), 1e-6F);
    EXPECT_NEAR(land.waterline_north_m[i], 20.0F, 1e-6F);
  }
  EXPECT_TRUE(bus::Decode<obstacles_t>(bus::Encode(message)));
}

TEST(ToMessages, RepeatWhatTheSegmenterSays) {
  auto message = MakeSegmentsMessage(0, 0, {MakeSegmentMessage(1, 0)});
  message.segments[0].confidence = segment_t::CONFIDENCE_TENTATIVE;
  message.segments[0].grounds = 1 + 2 + 4;
  message.segments[0].seen_share = 0.125F;
  message.segments[0].thing_probability = 0.375F;
  const auto obstacle = ToMessages(Placed(message), bus::kMaxMessageBytes).at(0).obstacles.at(0);
  EXPECT_EQ(obstacle.confidence, obstacle_t::CONFIDENCE_TENTATIVE);
  EXPECT_EQ(obstacle.grounds, 7);
  EXPECT_EQ(obstacle.seen_share, 0.125F);
  EXPECT_EQ(obstacle.thing_probability, 0.375F);
}

TEST(ToMessages, AProbabilityThatTheSegmenterDoesNotStateIsNotInvented) {
  auto message = MakeSegmentsMessage(0, 0, {MakeSegmentMessage(1, 0)});
  message.segments[0].thing_probability = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(std::isnan(ToMessages(Placed(message), bus::kMaxMessageBytes).at(0).obstacles.at(0).thing_probability));
}

TEST(ToMessages, AWaterlineThatIsNotOnTheEarthIsThereInTheVesselFrame) {
  const auto part = ToSegmentPart(MakeGoodSegments(), bus::kMaxMessageBytes);
  Georeferencer georeferencer(PlacementParams{}, std::chrono::seconds(1));
  georeferencer.AddSegments(std::get<SegmentPart>(part));
  const auto land = ToMessages(georeferencer.Finish().at(0), bus::kMaxMessageBytes).at(0).obstacles.at(1);
  EXPECT_EQ(land.status, obstacle_t::STATUS_VESSEL_FRAME_ONLY);
  EXPECT_EQ(land.num_waterline, 4);
  EXPECT_EQ(land.num_waterline_map, 0);
  EXPECT_TRUE(land.waterline_east_m.empty() && land.waterline_north_m.empty());
}

TEST(ToMessages, EncodedSizesAreThoseOfTheProof) {
  EXPECT_EQ(static_cast<std::size_t>(obstacles_t{}.getEncodedSize()), kHeadBytes);
  EXPECT_EQ(static_cast<std::size_t>(obstacle_t{}._getEncodedSizeNoHash()), kObstacleBytes);
  auto land = MakeSegmentMessage(1, 0, 30);
  AddWaterline(land, 7);
  const auto messages = ToMessages(Placed(MakeSegmentsMessage(0, 0, {land})), bus::kMaxMessageBytes);
  EXPECT_EQ(static_cast<std::size_t>(messages[0].getEncodedSize()), kHeadBytes + kObstacleBytes + 37 * kVertexBytes);
  // The bound on how much larger than its segment an obstacle is: (164 + 16 n) / (132 + 12 n) with n vertices, below 4 / 3.
  EXPECT_EQ(segment_t{}._getEncodedSizeNoHash(), 132);
  EXPECT_EQ(land._getEncodedSizeNoHash(), 132 + 37 * 12);
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

// Land with the largest outline and waterline that are carried, and with more of both than that.
TEST(ToMessages, WaterlinesOfAnyLengthGoInAtMostTwoMessagesAndNoneIsLost) {
  for (const int num_vertices : {0, 1, 20, 255, 256, 257, 4000}) {
    for (const int num_hull : {1, 140, 1000}) {
      auto land = MakeSegmentMessage(1, 0, num_hull);
      AddWaterline(land, num_vertices);
      const int num_segments = (bus::kMaxMessageBytes - segments_t{}.getEncodedSize()) / land._getEncodedSizeNoHash();
      std::vector<segment_t> segments(static_cast<std::size_t>(num_segments), land);
      for (int id = 1; id <= num_segments; ++id) segments[static_cast<std::size_t>(id - 1)].id = id;
      const auto messages = ToMessages(Placed(MakeSegmentsMessage(0, 0, std::move(segments))), bus::kMaxMessageBytes);
      ASSERT_LE(messages.size(), 2U) << num_vertices << ", " << num_hull;
      for (const auto& message : messages) {
        EXPECT_LE(message.getEncodedSize(), bus::kMaxMessageBytes) << num_vertices << ", " << num_hull;
        for (const auto& obstacle : message.obstacles) EXPECT_EQ(obstacle.num_waterline_map, std::min(num_vertices, 256));
      }
      const auto ids = Ids(messages);
      ASSERT_EQ(ids.size(), static_cast<std::size_t>(num_segments));
      for (int id = 1; id <= num_segments; ++id) EXPECT_EQ(ids[static_cast<std::size_t>(id - 1)], id);
    }
  }
}

// A turn of 18 segments has as many OBSTACLES as SEGMENTS, whatever stands in them; it could not tell the reader of a second one.
TEST(ToMessages, EighteenOfTheLargestObstaclesFitIntoOneMessage) {
  std::vector<segment_t> segments;
  for (int id = 1; id <= 18; ++id) {
    segments.push_back(MakeSegmentMessage(id, 0, 140));
    AddWaterline(segments.back(), 256);
  }
  auto message = MakeSegmentsMessage(0, 0, std::move(segments));
  message.num_parts = 2;
  const auto messages = ToMessages(Placed(message), bus::kMaxMessageBytes);
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(messages[0].num_obstacles, 18);
  EXPECT_EQ(messages[0].num_parts, 2);
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
  message.num_turn_segments = 18;
  message.num_parts = 2;
  message.part_index = 1;
  const auto messages = ToMessages(Placed(message), bus::kMaxMessageBytes);
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(messages[0].part_index, 1);
  EXPECT_EQ(messages[0].num_parts, 2);
  message.num_turn_segments = 19;
  EXPECT_EQ(ToMessages(Placed(message), bus::kMaxMessageBytes).size(), 2U);
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
  segment.num_waterline = 2;
  segment.waterline_x_m = {1e5F, -1e5F};
  segment.waterline_y_m = {-1e5F, 1e5F};
  segment.waterline_time_us = {0, 0};
  auto pose_message = MakePoseMessage(0);
  for (auto& number : pose_message.position_map_m) number = 1e5;
  pose_message.datum_latitude_deg = 90.0;
  pose_message.datum_longitude_deg = 180.0;
  for (int i = 0; i < 9; ++i) pose_message.covariance[i][i] = 1e12;
  const auto pose = std::get<Pose>(messages::ToPose(pose_message));
  PoseHistory poses;
  poses.Add(pose);
  const auto part = std::get<SegmentPart>(ToSegmentPart(message, bus::kMaxMessageBytes));
  ObstaclePart placed{part.head, pose.datum, {PlaceSegment(part.segments[0], poses, pose.datum, false, PlacementParams{})}};
  const auto obstacle = ToMessages(placed, bus::kMaxMessageBytes)[0].obstacles[0];
  EXPECT_EQ(obstacle.status, obstacle_t::STATUS_OK);
  for (const double number : {obstacle.latitude_deg, obstacle.longitude_deg, obstacle.position_map_m[0], obstacle.covariance_m2[0],
                              obstacle.covariance_m2[1], obstacle.covariance_relative_m2[2], obstacle.top_above_water_m}) {
    EXPECT_TRUE(std::isfinite(number));
  }
  EXPECT_TRUE(std::isfinite(obstacle.footprint_north_m[2]));
  EXPECT_TRUE(std::isfinite(obstacle.waterline_east_m[1]));
}

}  // namespace
}  // namespace lookout::georeferencer
