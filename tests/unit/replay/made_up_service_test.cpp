// A new service is one row of the service table and its folder: replay plans, runs and lists a made-up one that no code names.
#include <algorithm>
#include <fstream>
#include <gtest/gtest.h>
#include <memory>

#include "lookout/pose_t.hpp"
#include "tests/support/files.hpp"
#include "tools/replay/chain.hpp"

namespace lookout::replay {
namespace {

constexpr bus::Channel kFused{"FUSED", "pose_t", "fuser", 50, 100, false, true};

// With several inputs, and a state: the number of poses so far.
class FuserStage final : public Stage {
 public:
  FuserStage(bus::Bus& bus, const std::filesystem::path& /*config_folder*/, const StageInput& input) : reads_raw_(input.reads_raw) {
    bus::Subscribe<pose_t>(bus, bus::kPose, [this, &bus](const pose_t& pose) {
      pose_t fused = pose;
      fused.seq = 1000 + num_poses_++;
      bus::Publish(bus, kFused, fused);
    });
  }
  void Finish(Utime /*time*/) override { is_finished_ = true; }
  HealthReport Report() const override { return {HealthState::kOk, "", {{"poses", num_poses_}, {"finished", is_finished_}, {"raw", reads_raw_}}}; }

 private:
  bool reads_raw_;
  bool is_finished_ = false;
  std::int64_t num_poses_ = 0;
};

// Fuser, and the painter that reads what it publishes.
ServiceRows WithFuser() {
  ServiceRows rows = ReplayedServices();
  rows.push_back({"fuser",
                  "fuser",
                  "fused poses",
                  10,
                  "network",
                  "checks the config",
                  "poses",
                  {&bus::kObstacles, &bus::kSegments, &bus::kLidarScan, &bus::kPose}});
  rows.push_back({"painter", "painter", "pictures", 10, "network", "checks the config", "none", {&kFused}});
  return rows;
}

const ChannelSet kDayWithFused{"LIDAR_PACKETS", "LIDAR_SCAN", "LIDAR_ODOMETRY", "LIDAR_NMEA", "SEGMENTS", "NAV_RAW", "POSE", "OBSTACLES", "FUSED"};

std::string PlanWithFuser(const Request& request) { return InWords(MakeLogPlan(request, kDayWithFused, WithFuser())); }

TEST(MadeUpService, IsPlannedByItsRow) {
  EXPECT_EQ(
      PlanWithFuser({}),
      "ran: lidar, segmenter, odometer, navigator, georeferencer, tracker, ais, fuser, painter\nread: LIDAR_PACKETS, NAV_RAW, ALERT_ACK, ORDERS\n");
  EXPECT_EQ(PlanWithFuser({.only = {"fuser"}}), "ran: fuser\nread: LIDAR_SCAN, SEGMENTS, POSE, OBSTACLES\n");
  EXPECT_EQ(PlanWithFuser({.from = {"POSE"}, .only = {"fuser", "segmenter", "lidar"}}),
            "ran: lidar, segmenter, fuser\nread: LIDAR_PACKETS, POSE, OBSTACLES\n");
  EXPECT_EQ(PlanWithFuser({.from = {"OBSTACLES"}}),
            "ran: tracker, ais, fuser, painter\nread: LIDAR_SCAN, SEGMENTS, NAV_RAW, POSE, OBSTACLES, ALERT_ACK, ORDERS\n");
  EXPECT_EQ(PlanWithFuser({.from = {"FUSED"}}),
            "ran: tracker, ais, painter\nread: LIDAR_SCAN, SEGMENTS, NAV_RAW, POSE, OBSTACLES, ALERT_ACK, ORDERS, FUSED\n");
  EXPECT_THROW(PlanWithFuser({.from = {"FUSED"}, .only = {"georeferencer"}}), RequestError);
  EXPECT_EQ(InWords(MakeCapturePlan({}, WithFuser())),
            "ran: lidar, segmenter, odometer, navigator, georeferencer, tracker, ais, fuser, painter\nread: datagrams\n");
  EXPECT_THROW(MakeCapturePlan({.only = {"fuser"}}, WithFuser()), RequestError);
}

TEST(MadeUpService, IsListed) {
  EXPECT_EQ(ServiceNames(WithFuser()),
            (std::vector<std::string>{"lidar", "segmenter", "odometer", "navigator", "georeferencer", "tracker", "ais", "fuser", "painter"}));
  EXPECT_EQ(FromNames(), (std::vector<std::string>{"LIDAR_PACKETS", "LIDAR_SCAN", "LIDAR_ODOMETRY", "LIDAR_NMEA", "SEGMENTS", "NAV_RAW", "POSE",
                                                   "OBSTACLES", "TRACKS"}));
  EXPECT_EQ(FromNames(WithFuser()), (std::vector<std::string>{"LIDAR_PACKETS", "LIDAR_SCAN", "LIDAR_ODOMETRY", "LIDAR_NMEA", "SEGMENTS", "NAV_RAW",
                                                              "POSE", "OBSTACLES", "TRACKS", "FUSED"}));
}

TEST(MadeUpService, RunsBehindWhatItReads) {
  auto factories = StageFactories();
  factories.push_back({"fuser", [](const std::filesystem::path&) {},
                       [](bus::Bus& bus, const std::filesystem::path& folder, const StageInput& input) -> std::unique_ptr<Stage> {
                         return std::make_unique<FuserStage>(bus, folder, input);
                       }});
  Plan plan = MakeCapturePlan({.only = {"navigator", "fuser"}}, WithFuser());
  EXPECT_EQ(plan.services, (std::vector<std::string>{"navigator", "fuser"}));
  std::int64_t num_poses = 0;
  std::int64_t num_fused = 0;
  Chain chain(
      support::kDemoConfig, plan,
      [&](Utime, std::string_view channel, Bytes bytes) {
        num_poses += channel == "POSE" ? 1 : 0;
        if (channel == "FUSED") {
          EXPECT_EQ(bus::Decode<pose_t>(bytes).value().seq, 1000 + num_fused++);
        }
      },
      factories);
  Utime time = UtimeFromWire(1'782'907'200'000'000).value();
  for (int i = 0; i < 30; ++i, time += std::chrono::milliseconds(100)) {
    const std::string line = "$GPHDT,90.0,T*0C";
    chain.OnTextLine(time, {reinterpret_cast<const std::uint8_t*>(line.data()), line.size()});
  }
  chain.Finish();

  ASSERT_GT(num_poses, 0);
  EXPECT_EQ(chain.digests().at("FUSED").count, num_poses);
  EXPECT_EQ(chain.StageTimes().at(1).first, "fuser");
  const auto counters = chain.Counters();
  EXPECT_NE(std::ranges::find(counters, std::pair<std::string, std::int64_t>("fuser.poses", num_poses)), counters.end());
  EXPECT_NE(std::ranges::find(counters, std::pair<std::string, std::int64_t>("fuser.finished", 1)), counters.end());
  EXPECT_EQ(std::ranges::find(counters, std::pair<std::string, std::int64_t>("fuser.raw", 1)), counters.end());
}

// Channels name roles: a boat with another lidar has the row of another service, and no other row nor the channel table changes.
TEST(MadeUpService, FillsTheRoleOfAnother) {
  ServiceRows rows = ReplayedServices();
  ASSERT_EQ(rows.front().role, bus::kLidarScan.publisher);
  rows.front().name = "lidar32";
  EXPECT_EQ(InWords(MakeLogPlan({}, kDayWithFused, rows)),
            "ran: lidar32, segmenter, odometer, navigator, georeferencer, tracker, ais\nread: LIDAR_PACKETS, NAV_RAW, ALERT_ACK, ORDERS\n");
  EXPECT_EQ(InWords(MakeLogPlan({.from = {"LIDAR_SCAN"}}, kDayWithFused, rows)),
            "ran: segmenter, odometer, navigator, georeferencer, tracker, ais\nread: LIDAR_SCAN, NAV_RAW, ALERT_ACK, ORDERS\n");
  EXPECT_EQ(InWords(MakeLogPlan({.only = {"lidar32"}}, kDayWithFused, rows)), "ran: lidar32\nread: LIDAR_PACKETS\n");
  EXPECT_THROW(MakeLogPlan({.from = {"LIDAR_SCAN"}, .only = {"lidar32"}}, kDayWithFused, rows), RequestError);
  const auto plan = MakeCapturePlan({.only = {"lidar32", "segmenter"}}, rows);
  EXPECT_TRUE(plan.Publishes(bus::kLidarScan));
  EXPECT_TRUE(plan.Gives(bus::kSegments));
  EXPECT_FALSE(plan.Publishes(bus::kPose));
  try {
    MakeCapturePlan({.only = {"segmenter"}}, rows);
    FAIL() << "a segmenter without a lidar is planned";
  } catch (const RequestError& error) {
    EXPECT_STREQ(error.what(), "--only segmenter: a capture needs lidar32 too");
  }
}

// What a boat computes from its measurements replay computes too.
TEST(MadeUpService, WouldBeMissedWithoutAFactory) {
  for (const auto& channel : bus::kChannels) {
    const bool is_of_the_table = std::ranges::find(bus::kServices, channel.publisher, &bus::ServiceRow::role) != bus::kServices.end();
    if (!channel.is_replayed || !is_of_the_table) continue;
    const auto& rows = ReplayedServices();
    EXPECT_NE(std::ranges::find(rows, channel.publisher, &bus::ServiceRow::role), rows.end()) << "no factory in tools/replay: " << channel.publisher;
  }
  for (const auto& factory : StageFactories()) {
    EXPECT_NE(std::ranges::find(bus::kServices, factory.service, &bus::ServiceRow::name), bus::kServices.end()) << factory.service;
  }
}

}  // namespace
}  // namespace lookout::replay
