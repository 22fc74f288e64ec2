#include "services/georeferencer/wire.hpp"

#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <utility>

#include "common/bus/channels.hpp"
#include "tests/unit/georeferencer/messages.hpp"

namespace lookout::georeferencer {
namespace {

using test::At;
using test::MakeGoodSegments;
using test::MakePoseMessage;
using test::MakeSegmentMessage;
using test::MakeSegmentsMessage;
using namespace messages;  // NOLINT(google-build-using-namespace): the names of the faults

constexpr float kNanF = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfF = std::numeric_limits<float>::infinity();
constexpr double kInf = std::numeric_limits<double>::infinity();

std::string RefusalOf(const segments_t& message) {
  const auto result = ToSegmentPart(message, bus::kMaxMessageBytes);
  const auto* refusal = std::get_if<Refusal>(&result);
  return refusal == nullptr ? "" : std::string(*refusal);
}

std::string RefusalOf(const pose_t& message) {
  const auto result = messages::ToPose(message);
  const auto* refusal = std::get_if<Refusal>(&result);
  return refusal == nullptr ? "" : std::string(*refusal);
}

TEST(ToSegmentPart, TakesAWholeMessageOver) {
  auto message = MakeGoodSegments();
  message.scan_flags = 5;
  message.segments[0].hull_time_us[2] = 99'000;
  message.segments[0].confidence = segment_t::CONFIDENCE_TENTATIVE;
  message.segments[0].grounds = segment_t::GROUND_SCATTERED;
  message.segments[0].seen_share = 0.25F;
  message.segments[0].thing_probability = 0.375F;
  message.segments[1].waterline_time_us[3] = 99'000;
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
  EXPECT_EQ(part.segments[0].rating.confidence, Confidence::kTentative);
  EXPECT_EQ(part.segments[0].rating.grounds, segment_t::GROUND_SCATTERED);
  EXPECT_EQ(part.segments[0].rating.kind, Kind::kObstacle);
  EXPECT_EQ(part.segments[0].rating.seen_share, 0.25F);
  EXPECT_EQ(part.segments[0].rating.thing_probability, 0.375F);
  EXPECT_TRUE(part.segments[0].waterline.empty());
  EXPECT_EQ(part.segments[1].id, 2);
  EXPECT_EQ(part.segments[1].rating.confidence, Confidence::kSure);
  EXPECT_EQ(part.segments[1].rating.kind, Kind::kLand);
  ASSERT_EQ(part.segments[1].waterline.size(), 4U);
  EXPECT_EQ(part.segments[1].waterline[2].p_lidar_m, Eigen::Vector2d(20.0, -2.0));
  EXPECT_EQ(part.segments[1].waterline[3].time, At(99'000));
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
      {kSegmentsTime, [](segments_t& m) { m.segments[1].waterline_time_us[0] = -1; }},
      {kSegmentsTime, [](segments_t& m) { m.segments[1].waterline_time_us[3] = 99'001; }},
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
      {kSegmentsCount, [](segments_t& m) { m.segments[1].num_waterline = 3; }},
      {kSegmentsCount, [](segments_t& m) { m.segments[1].num_waterline = -1; }},
      {kSegmentsCount, [](segments_t& m) { m.segments[1].waterline_x_m.clear(); }},
      {kSegmentsCount, [](segments_t& m) { m.segments[1].waterline_y_m.pop_back(); }},
      {kSegmentsCount, [](segments_t& m) { m.segments[1].waterline_time_us.push_back(0); }},
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
      {kSegmentsNumber, [](segments_t& m) { m.segments[0].min_reflectivity = -1; }},
      {kSegmentsNumber, [](segments_t& m) { m.segments[0].min_reflectivity = 1; }},
      {kSegmentsNumber, [](segments_t& m) { m.segments[0].box_center_m[0] = kNanF; }},
      {kSegmentsNumber, [](segments_t& m) { m.segments[0].box_center_m[1] = -kInfF; }},
      {kSegmentsNumber, [](segments_t& m) { m.segments[0].seen_share = -0.01F; }},
      {kSegmentsNumber, [](segments_t& m) { m.segments[0].seen_share = 1.01F; }},
      {kSegmentsNumber, [](segments_t& m) { m.segments[0].seen_share = kNanF; }},
      {kSegmentsNumber, [](segments_t& m) { m.segments[0].thing_probability = -0.01F; }},
      {kSegmentsNumber, [](segments_t& m) { m.segments[0].thing_probability = 1.01F; }},
      {kSegmentsNumber, [](segments_t& m) { m.segments[0].land_probability = -kInfF; }},
      {kSegmentsNumber, [](segments_t& m) { m.segments[1].land_probability = 1.01F; }},
      {kSegmentsNumber, [](segments_t& m) { m.segments[1].waterline_x_m[3] = kNanF; }},
      {kSegmentsNumber, [](segments_t& m) { m.segments[1].waterline_y_m[0] = 1e38F; }},
      {kSegmentsCode, [](segments_t& m) { m.segments[0].confidence = 0; }},
      {kSegmentsCode, [](segments_t& m) { m.segments[0].confidence = 3; }},
      {kSegmentsCode, [](segments_t& m) { m.segments[0].grounds = -1; }},
      {kSegmentsCode, [](segments_t& m) { m.segments[0].grounds = 8; }},
      {kSegmentsCode, [](segments_t& m) { m.segments[0].kind = -1; }},
      {kSegmentsCode, [](segments_t& m) { m.segments[1].kind = 2; }},
  };
  EXPECT_EQ(RefusalOf(MakeGoodSegments()), "");
  for (std::size_t i = 0; i < changes.size(); ++i) {
    auto message = MakeGoodSegments();
    changes[i].second(message);
    EXPECT_EQ(RefusalOf(message), changes[i].first) << "change " << i;
  }
}

TEST(ToSegmentPart, AcceptsProbabilitiesThatAreNotStatedAndThoseAtTheEnds) {
  for (const float probability : {kNanF, 0.0F, 1.0F}) {
    auto message = MakeGoodSegments();
    message.segments[0].thing_probability = message.segments[0].land_probability = probability;
    EXPECT_EQ(RefusalOf(message), "") << probability;
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
  const auto result = messages::ToPose(message);
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
  message.datum_ellipsoid_height_m = kNan;
  message.heave_m = kNan;
  for (int i = 0; i < 9; ++i) message.covariance[2][i] = message.covariance[i][2] = kNan;
  EXPECT_EQ(RefusalOf(message), "");

  pose_t unknown{};
  unknown.utime_us = test::kStartUs;
  unknown.status = pose_t::STATUS_UNKNOWN;
  unknown.heading_rad = unknown.heave_m = unknown.pitch_rad = unknown.roll_rad = kNan;
  unknown.datum_latitude_deg = kNan;
  for (auto& number : unknown.position_map_m) number = kNan;
  const auto result = messages::ToPose(unknown);
  ASSERT_TRUE(std::holds_alternative<Pose>(result));
  EXPECT_FALSE(std::get<Pose>(result).is_placed);
  EXPECT_EQ(std::get<Pose>(result).roll_rad, 0.0);
}

TEST(ToPose, AcceptsARelativePoseWhoseMotionIsNotKnown) {
  auto message = MakePoseMessage(0);
  message.status = pose_t::STATUS_RELATIVE_TO_BOAT;
  message.datum_latitude_deg = message.datum_longitude_deg = message.latitude_deg = message.longitude_deg = kNan;
  message.datum_ellipsoid_height_m = 1.8e12;
  for (auto& part : message.velocity_map_mps) part = kNan;
  for (int i = 0; i < 9; ++i) {
    for (const int unknown : {2, 3, 4, 5}) message.covariance[unknown][i] = message.covariance[i][unknown] = kNan;
  }
  EXPECT_EQ(RefusalOf(message), "");
  const auto pose = std::get<Pose>(messages::ToPose(message));
  EXPECT_TRUE(pose.is_placed && pose.datum.IsRelative() && pose.covariance.allFinite());
  EXPECT_TRUE(pose.velocity_map_mps.hasNaN());
}

TEST(ToPose, RefusesEachFaultUnderItsOwnName) {
  using Change = std::function<void(pose_t&)>;
  const std::vector<std::pair<Refusal, Change>> changes{
      {messages::kPoseTime, [](pose_t& m) { m.utime_us = std::numeric_limits<std::int64_t>::max(); }},
      {messages::kPoseTime, [](pose_t& m) { m.utime_us += 1; }},
      {messages::kPoseStatus, [](pose_t& m) { m.status = -1; }},
      {messages::kPoseStatus, [](pose_t& m) { m.status = pose_t::STATUS_RELATIVE_TO_BOAT + 1; }},
      {messages::kPoseNumber, [](pose_t& m) { m.status = pose_t::STATUS_RELATIVE; }},  // with a datum on the earth
      {messages::kPoseNumber, [](pose_t& m) { m.position_map_m[0] = kNan; }},
      {messages::kPoseNumber, [](pose_t& m) { m.position_map_m[1] = 1e300; }},
      {messages::kPoseNumber, [](pose_t& m) { m.position_map_m[2] = kInf; }},
      {messages::kPoseNumber, [](pose_t& m) { m.heading_rad = kNan; }},
      {messages::kPoseNumber, [](pose_t& m) { m.heading_rad = -0.1; }},
      {messages::kPoseNumber, [](pose_t& m) { m.heading_rad = 1e300; }},
      {messages::kPoseNumber, [](pose_t& m) { m.pitch_rad = 4.0; }},
      {messages::kPoseNumber, [](pose_t& m) { m.roll_rad = kInf; }},
      {messages::kPoseNumber, [](pose_t& m) { m.heave_m = 1e6; }},
      {messages::kPoseNumber, [](pose_t& m) { m.datum_latitude_deg = 90.1; }},
      {messages::kPoseNumber, [](pose_t& m) { m.datum_longitude_deg = kNan; }},
      {messages::kPoseNumber, [](pose_t& m) { m.datum_ellipsoid_height_m = 1e300; }},
      {messages::kPoseCovariance, [](pose_t& m) { m.covariance[0][0] = -1e-9; }},
      {messages::kPoseCovariance, [](pose_t& m) { m.covariance[8][8] = kInf; }},
      {messages::kPoseCovariance, [](pose_t& m) { m.covariance[4][4] = 1e300; }},
      {messages::kPoseCovariance, [](pose_t& m) { m.covariance[0][1] = 0.001; }},
      {messages::kPoseCovariance, [](pose_t& m) { m.covariance[0][1] = m.covariance[1][0] = 0.02; }},
      {messages::kPoseCovariance, [](pose_t& m) { m.covariance[0][1] = kNan; }},
      {messages::kPoseCovariance, [](pose_t& m) { m.covariance[0][0] = kNan, m.covariance[0][1] = m.covariance[1][0] = 0.1; }},
  };
  EXPECT_EQ(RefusalOf(MakePoseMessage(0)), "");
  for (std::size_t i = 0; i < changes.size(); ++i) {
    auto message = MakePoseMessage(0);
    changes[i].second(message);
    EXPECT_EQ(RefusalOf(message), changes[i].first) << "change " << i;
  }
}

}  // namespace
}  // namespace lookout::georeferencer
