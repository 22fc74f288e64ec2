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

constexpr bus::Channel kTracks{"TRACKS", "pose_t", "tracker", 50, 100, false, true};

// With several inputs, and a state: the number of poses so far.
class TrackerStage final : public Stage {
 public:
  TrackerStage(bus::Bus& bus, const std::filesystem::path& /*config_folder*/, bool reads_raw) : reads_raw_(reads_raw) {
    bus::Subscribe<pose_t>(bus, bus::kPose, [this, &bus](const pose_t& pose) {
      pose_t track = pose;
      track.seq = 1000 + num_poses_++;
      bus::Publish(bus, kTracks, track);
    });
  }
  void Finish(Utime /*time*/) override { is_finished_ = true; }
  HealthReport Report() const override { return {HealthState::kOk, "", {{"poses", num_poses_}, {"finished", is_finished_}, {"raw", reads_raw_}}}; }

 private:
  bool reads_raw_;
  bool is_finished_ = false;
  std::int64_t num_poses_ = 0;
};

// Tracker, and the plotter that reads what it publishes.
ServiceRows WithTracker() {
  ServiceRows rows = ReplayedServices();
  rows.push_back(
      {"tracker", "tracks", 10, "network", "checks the config", "tracks", {&bus::kObstacles, &bus::kSegments, &bus::kLidarScan, &bus::kPose}});
  rows.push_back({"plotter", "pictures", 10, "network", "checks the config", "none", {&kTracks}});
  return rows;
}

const ChannelSet kDayWithTracks{"LIDAR_PACKETS", "LIDAR_SCAN", "LIDAR_NMEA", "SEGMENTS", "NAV_RAW", "POSE", "OBSTACLES", "TRACKS"};

std::string PlanWithTracker(const Request& request) { return InWords(MakeLogPlan(request, kDayWithTracks, WithTracker())); }

TEST(MadeUpService, IsPlannedByItsRow) {
  EXPECT_EQ(PlanWithTracker({}), "ran: vlp16, segmenter, navigator, georeferencer, tracker, plotter\nread: LIDAR_PACKETS, NAV_RAW\n");
  EXPECT_EQ(PlanWithTracker({.only = {"tracker"}}), "ran: tracker\nread: LIDAR_SCAN, SEGMENTS, POSE, OBSTACLES\n");
  EXPECT_EQ(PlanWithTracker({.from = {"POSE"}, .only = {"tracker", "segmenter", "vlp16"}}),
            "ran: vlp16, segmenter, tracker\nread: LIDAR_PACKETS, POSE, OBSTACLES\n");
  EXPECT_EQ(PlanWithTracker({.from = {"OBSTACLES"}}), "ran: tracker, plotter\nread: LIDAR_SCAN, SEGMENTS, POSE, OBSTACLES\n");
  EXPECT_EQ(PlanWithTracker({.from = {"TRACKS"}}), "ran: plotter\nread: TRACKS\n");
  EXPECT_THROW(PlanWithTracker({.from = {"TRACKS"}, .only = {"georeferencer"}}), RequestError);
  EXPECT_EQ(InWords(MakeCapturePlan({}, WithTracker())), "ran: vlp16, segmenter, navigator, georeferencer, tracker, plotter\nread: datagrams\n");
  EXPECT_THROW(MakeCapturePlan({.only = {"tracker"}}, WithTracker()), RequestError);
}

TEST(MadeUpService, IsListed) {
  EXPECT_EQ(ServiceNames(WithTracker()), (std::vector<std::string>{"vlp16", "segmenter", "navigator", "georeferencer", "tracker", "plotter"}));
  EXPECT_EQ(FromNames(), (std::vector<std::string>{"LIDAR_PACKETS", "LIDAR_SCAN", "LIDAR_NMEA", "SEGMENTS", "NAV_RAW", "POSE"}));
  EXPECT_EQ(FromNames(WithTracker()),
            (std::vector<std::string>{"LIDAR_PACKETS", "LIDAR_SCAN", "LIDAR_NMEA", "SEGMENTS", "NAV_RAW", "POSE", "OBSTACLES", "TRACKS"}));
}

TEST(MadeUpService, RunsBehindWhatItReads) {
  auto factories = StageFactories();
  factories.push_back({"tracker", [](const std::filesystem::path&) {},
                       [](bus::Bus& bus, const std::filesystem::path& folder, bool reads_raw) -> std::unique_ptr<Stage> {
                         return std::make_unique<TrackerStage>(bus, folder, reads_raw);
                       }});
  Plan plan = MakeCapturePlan({.only = {"navigator", "tracker"}}, WithTracker());
  EXPECT_EQ(plan.services, (std::vector<std::string>{"navigator", "tracker"}));
  std::int64_t num_poses = 0;
  std::int64_t num_tracks = 0;
  Chain chain(
      support::kDemoConfig, plan,
      [&](Utime, std::string_view channel, Bytes bytes) {
        num_poses += channel == "POSE" ? 1 : 0;
        if (channel == "TRACKS") {
          EXPECT_EQ(bus::Decode<pose_t>(bytes).value().seq, 1000 + num_tracks++);
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
  EXPECT_EQ(chain.digests().at("TRACKS").count, num_poses);
  EXPECT_EQ(chain.StageTimes().at(1).first, "tracker");
  const auto counters = chain.Counters();
  EXPECT_NE(std::ranges::find(counters, std::pair<std::string, std::int64_t>("tracker.poses", num_poses)), counters.end());
  EXPECT_NE(std::ranges::find(counters, std::pair<std::string, std::int64_t>("tracker.finished", 1)), counters.end());
  EXPECT_EQ(std::ranges::find(counters, std::pair<std::string, std::int64_t>("tracker.raw", 1)), counters.end());
}

// What a boat computes from its measurements replay computes too.
TEST(MadeUpService, WouldBeMissedWithoutAFactory) {
  for (const auto& channel : bus::kChannels) {
    const bool is_of_the_table = std::ranges::find(bus::kServices, channel.publisher, &bus::ServiceRow::name) != bus::kServices.end();
    if (!channel.is_replayed || !is_of_the_table) continue;
    const auto& rows = ReplayedServices();
    EXPECT_NE(std::ranges::find(rows, channel.publisher, &bus::ServiceRow::name), rows.end()) << "no factory in tools/replay: " << channel.publisher;
  }
  for (const auto& factory : StageFactories()) {
    EXPECT_NE(std::ranges::find(bus::kServices, factory.service, &bus::ServiceRow::name), bus::kServices.end()) << factory.service;
  }
}

}  // namespace
}  // namespace lookout::replay
