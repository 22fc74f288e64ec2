// OBSTACLES depend on SEGMENTS and on POSE, not on how the two come in between each other.
#include <cstdint>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "common/bus/decode.hpp"
#include "services/georeferencer/service.hpp"
#include "tests/support/memory_bus.hpp"
#include "tests/unit/georeferencer/messages.hpp"

namespace lookout::georeferencer {
namespace {

using Payload = std::vector<std::uint8_t>;

struct Inputs {
  std::vector<Payload> segments;
  std::vector<Payload> poses;
};

// Some seconds of turns and poses with all that happens: unknown poses, gaps, a datum that changes, lost turns, parts, turns out of order.
Inputs MakeInputs(std::mt19937& random) {
  const auto chance = [&random](double share) { return std::uniform_real_distribution<double>(0.0, 1.0)(random) < share; };
  Inputs inputs;
  double heading_rad = 6.2;
  for (int i = 0; i < 500; ++i) {
    if (chance(0.02)) i += 20;  // navigator was silent
    auto pose = test::MakePoseMessage(20'000 * i, i);
    heading_rad = heading_rad > 6.26 ? 0.0 : heading_rad + 0.02;
    pose.heading_rad = heading_rad;
    pose.position_map_m[0] = 0.1 * i;
    pose.roll_rad = 0.001 * (i % 50);
    if (chance(0.02)) pose.status = pose_t::STATUS_NO_HEADING;
    if (i > 300) pose.datum_longitude_deg += 1.0;
    inputs.poses.push_back(bus::Encode(pose));
  }
  for (int turn = 0; turn < 105; ++turn) {  // some after the end of POSE
    if (chance(0.05)) continue;
    const std::int64_t offset_us = 100'000 * turn - (chance(0.05) ? 300'000 : 0);
    const int num_parts = chance(0.2) ? 2 : 1;
    for (int part = 0; part < num_parts; ++part) {
      std::vector<segment_t> segments;
      for (int i = 0; i < 5; ++i) {
        auto segment = test::MakeSegmentMessage(5 * part + i + 1, offset_us + 19'000 * i, 4);
        segment.hull_time_us = {19'000 * i, 0, 99'000, 50'000};
        if (i == 4) test::AddWaterline(segment, 10);
        segments.push_back(segment);
      }
      auto message = test::MakeSegmentsMessage(offset_us, turn, std::move(segments));
      message.num_parts = num_parts;
      message.part_index = part;
      message.num_turn_segments = chance(0.1) ? 100 : 10;
      inputs.segments.push_back(bus::Encode(message));
    }
  }
  return inputs;
}

// OBSTACLES of one way in which the inputs come: at each step SEGMENTS with the chance `share`.
std::vector<Payload> Obstacles(const Inputs& inputs, double share, std::mt19937& random) {
  bus::MemoryBus bus;
  Service service(bus, Params{PlacementParams{}, std::chrono::milliseconds(500)});
  std::vector<Payload> obstacles;
  bus.SubscribeRaw(bus::kObstacles, [&](std::string_view, Bytes bytes) { obstacles.emplace_back(bytes.begin(), bytes.end()); });
  std::size_t segment = 0;
  std::size_t pose = 0;
  while (segment < inputs.segments.size() || pose < inputs.poses.size()) {
    const bool is_segment = std::uniform_real_distribution<double>(0.0, 1.0)(random) < share;
    if (pose == inputs.poses.size() || (is_segment && segment < inputs.segments.size())) {
      bus.Publish(bus::kSegments, inputs.segments[segment++]);
    } else {
      bus.Publish(bus::kPose, inputs.poses[pose++]);
    }
    support::HandleAll(bus);
  }
  service.Finish();
  support::HandleAll(bus);
  return obstacles;
}

TEST(GeoreferencerInterleaving, GivesTheSameBytesHoweverTheChannelsInterleave) {
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    std::mt19937 random(seed);
    const auto inputs = MakeInputs(random);
    const auto expected = Obstacles(inputs, 0.0, random);  // all poses first
    ASSERT_GE(expected.size(), inputs.segments.size());
    EXPECT_EQ(Obstacles(inputs, 1.0, random), expected) << "all segments first, seed " << seed;
    for (const double share : {0.02, 0.1, 0.17, 0.3, 0.6})
      EXPECT_EQ(Obstacles(inputs, share, random), expected) << "seed " << seed << ", share " << share;
  }
}

TEST(GeoreferencerInterleaving, TheInputsOfThisTestMeetEveryStatusThatReplayKnows) {
  std::mt19937 random(1);
  const auto inputs = MakeInputs(random);
  int num_ok = 0;
  int num_vessel_only = 0;
  for (const auto& payload : Obstacles(inputs, 0.17, random)) {
    const auto message = bus::Decode<obstacles_t>(payload);
    ASSERT_TRUE(message);
    for (const auto& obstacle : message->obstacles) {
      num_ok += obstacle.status == obstacle_t::STATUS_OK ? 1 : 0;
      num_vessel_only += obstacle.status == obstacle_t::STATUS_VESSEL_FRAME_ONLY ? 1 : 0;
    }
  }
  EXPECT_GT(num_ok, 50);
  EXPECT_GT(num_vessel_only, 50);
}

}  // namespace
}  // namespace lookout::georeferencer
