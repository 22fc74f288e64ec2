// TRACKS and ALERTS depend on each channel, not on how the channels come in between each other.
#include <array>
#include <cstdint>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "common/bus/decode.hpp"
#include "services/tracker/service.hpp"
#include "tests/support/memory_bus.hpp"
#include "tests/unit/tracker_shell/messages.hpp"

namespace lookout::tracker {
namespace {

using Payload = std::vector<std::uint8_t>;

struct Stream {
  const bus::Channel* channel;
  std::vector<Payload> messages = {};

  template <typename Message>
  void Add(const Message& message) {
    messages.push_back(bus::Encode(message));
  }
};

constexpr double kJumpM = 10'000.0;
constexpr int kJumpPose = 100;  // the last before the jump

struct Inputs {
  Stream beams{&bus::kLidarScan};
  Stream labels{&bus::kSegments};
  Stream poses{&bus::kPose};
  Stream obstacles{&bus::kObstacles};
};

// Six seconds with all that happens: scans that a channel lost whole or in part, scans that came twice, beams and labels of other scans, obstacles
// that nobody could place, poses that know nothing, gaps, lidar and navigator that begin anew, a position that jumps by 10 km, another datum.
Inputs MakeInputs(std::mt19937& random) {
  const auto chance = [&random](double share) { return std::uniform_real_distribution<double>(0.0, 1.0)(random) < share; };
  Inputs inputs;
  std::int64_t pose_seq = 0;
  for (int i = 2; i < 310; ++i, ++pose_seq) {
    if (i == 150) pose_seq = 0;
    if (chance(0.01)) i += 20;  // navigator was silent
    auto pose = test::MakePose(20'000 * i, pose_seq);
    pose.position_map_m[0] = 0.1 * i;
    if (i > kJumpPose) pose.position_map_m[1] = kJumpM;
    if (chance(0.02)) pose.status = pose_t::STATUS_NO_HEADING;
    if (i > 250) pose.datum_longitude_deg += 1.0;
    inputs.poses.Add(pose);
  }
  std::int64_t seq = 0;
  for (int scan = 0; scan < 60; ++scan, ++seq) {
    if (scan == 40) seq = 0;
    const auto offset_us = test::kScanUs * scan;
    if (!chance(0.05)) {
      auto beams = test::MakeScan(offset_us, seq);
      if (chance(0.1)) beams.num_parts = 2;  // of which the other is lost
      if (beams.num_parts == 2) beams.num_turn_columns = 2 * beams.num_columns;
      if (chance(0.05)) ++beams.seq;
      inputs.beams.Add(beams);
    }
    if (!chance(0.05)) inputs.labels.Add(test::MakeSegments(chance(0.05) ? offset_us + 1 : offset_us, seq));
    if (chance(0.05)) continue;
    std::vector<obstacle_t> obstacles;
    for (int i = 0; i < 4; ++i) {
      obstacles.push_back(test::MakeObstacle(i + 1, test::kStartUs + offset_us + 10'000 * i, {20.0 * i + 0.1 * scan, 30.0}));
      auto& obstacle = obstacles.back();
      if (5 * scan > kJumpPose) obstacle.position_map_m[1] += kJumpM;
      if (!chance(0.05)) continue;
      obstacle.status = obstacle_t::STATUS_VESSEL_FRAME_ONLY;
      obstacle.num_map = 0;
      obstacle.footprint_east_m.clear();
      obstacle.footprint_north_m.clear();
    }
    auto whole = test::MakeObstacles(offset_us, seq, obstacles);
    if (scan > 50) whole.datum_longitude_deg += 1.0;
    if (!chance(0.3)) {
      inputs.obstacles.Add(whole);
      if (chance(0.1)) inputs.obstacles.Add(whole);
      continue;
    }
    for (int part = 0; part < 2; ++part) {
      auto half = whole;
      half.part_index = part;
      half.num_parts = half.num_obstacles = 2;
      half.obstacles.assign(obstacles.begin() + 2 * part, obstacles.begin() + 2 * part + 2);
      if (!chance(0.2)) inputs.obstacles.Add(half);
    }
  }
  return inputs;
}

struct Outputs {
  std::vector<Payload> tracks;
  std::vector<Payload> alerts;
  bool operator==(const Outputs&) const = default;
};

// Of one way in which the inputs come: at each step the next message of a channel that is drawn by these shares.
Outputs OutputsOf(const Inputs& inputs, const std::array<double, 4>& shares, std::mt19937& random) {
  bus::MemoryBus bus;
  Service service(bus, test::MakeParams());
  Outputs outputs;
  bus.SubscribeRaw(bus::kTracks, [&](std::string_view, Bytes bytes) { outputs.tracks.emplace_back(bytes.begin(), bytes.end()); });
  bus.SubscribeRaw(bus::kAlerts, [&](std::string_view, Bytes bytes) { outputs.alerts.emplace_back(bytes.begin(), bytes.end()); });
  const std::array streams{&inputs.beams, &inputs.labels, &inputs.poses, &inputs.obstacles};
  std::array<std::size_t, 4> next{};
  while (true) {
    std::array<double, 4> weights{};
    double sum = 0.0;
    for (std::size_t i = 0; i < streams.size(); ++i) {
      // One that is never drawn comes last.
      weights[i] = next[i] < streams[i]->messages.size() ? std::max(shares[i], 1e-12) : 0.0;
      sum += weights[i];
    }
    if (sum == 0.0) break;
    const auto drawn = std::discrete_distribution<std::size_t>(weights.begin(), weights.end())(random);
    bus.Publish(*streams[drawn]->channel, streams[drawn]->messages[next[drawn]++]);
    support::HandleAll(bus);
  }
  service.Finish();
  support::HandleAll(bus);
  return outputs;
}

TEST(TrackerInterleaving, GivesTheSameBytesHoweverTheChannelsInterleave) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto inputs = MakeInputs(random);
    const auto expected = OutputsOf(inputs, {1.0, 1.0, 1.0, 0.0}, random);  // OBSTACLES last
    ASSERT_GE(expected.tracks.size(), 40U);
    EXPECT_EQ(expected.alerts.size(), expected.tracks.size());
    for (const auto& shares : std::vector<std::array<double, 4>>{
             {0.0, 0.0, 0.0, 1.0}, {0.0, 1.0, 1.0, 1.0}, {1.0, 0.0, 1.0, 1.0}, {1.0, 1.0, 0.0, 1.0}, {1.0, 1.0, 5.0, 1.0}, {0.1, 0.3, 2.0, 1.0}}) {
      EXPECT_TRUE(OutputsOf(inputs, shares, random) == expected) << ::testing::PrintToString(shares);
    }
  }
}

// What the inputs above are worth.
TEST(TrackerInterleaving, MeetsScansWithAndWithoutSightPoseAndAllParts) {
  std::mt19937 random(1);
  const auto inputs = MakeInputs(random);
  int num_known = 0;
  int num_holes = 0;
  int num_tracks = 0;
  const auto outputs = OutputsOf(inputs, {1.0, 1.0, 5.0, 1.0}, random);
  for (const auto& payload : outputs.tracks) {
    const auto message = bus::Decode<tracks_t>(payload);
    ASSERT_TRUE(message);
    num_known += message->sight == tracks_t::SIGHT_KNOWN ? 1 : 0;
    num_holes += (message->scan_flags & lidar_scan_t::FLAG_HOLE) != 0 ? 1 : 0;
    num_tracks += message->num_tracks;
  }
  EXPECT_GT(num_known, 20);
  EXPECT_LT(num_known, static_cast<int>(outputs.tracks.size()) - 3);
  EXPECT_GT(num_holes, 0);
  EXPECT_GT(num_tracks, 50);
}

}  // namespace
}  // namespace lookout::tracker
