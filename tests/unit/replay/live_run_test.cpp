// The tracker, live and replayed: acknowledgements that a person gave, and a process that was restarted in mid-run.
#include "tools/replay/live_run.hpp"

#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/log_file.hpp"
#include "common/bus/memory_bus.hpp"
#include "services/tracker/params.hpp"
#include "services/tracker/service.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/tracker_shell/messages.hpp"
#include "tools/replay/chain.hpp"
#include "tools/replay/input.hpp"

namespace lookout::replay {
namespace {

namespace fs = std::filesystem;
namespace test = tracker::test;
using Messages = std::map<std::string, std::vector<std::vector<std::uint8_t>>, std::less<>>;

class LiveRun : public ::testing::Test {
 protected:
  support::TempDir folder_;
  fs::path log_ = folder_ / "day.lcmlog";
  std::vector<std::uint8_t> bytes_;  // of the log
  bus::LogWriter writer_{[this](Bytes bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }};
  Utime time_{std::chrono::seconds(1'800'000'000)};
  Messages live_;

  // One process of the tracker.
  struct Process {
    bus::MemoryBus bus;
    tracker::Service service{bus, tracker::LoadParams(support::kDemoConfig)};
  };
  std::unique_ptr<Process> process_;
  std::optional<alert_t> active_;  // in the latest ALERTS

  void Record(std::string_view channel, Bytes bytes) {
    time_ += std::chrono::milliseconds(1);
    writer_.Write(time_, channel, bytes);
  }
  void Start() {
    process_ = std::make_unique<Process>();
    for (const auto* channel : {&bus::kTracks, &bus::kAlerts}) {
      process_->bus.SubscribeRaw(*channel, [this](std::string_view name, Bytes bytes) {
        live_[std::string(name)].emplace_back(bytes.begin(), bytes.end());
        Record(name, bytes);
      });
    }
    bus::Subscribe<alerts_t>(process_->bus, bus::kAlerts, [this](const alerts_t& message) {
      active_.reset();
      for (const auto& alert : message.alerts) {
        if (alert.state == alert_t::STATE_ACTIVE) active_ = alert;
      }
    });
  }
  // As at SIGTERM, after all others have ended.
  void End() {
    process_->service.Finish();
    while (process_->bus.HandleOnce()) {
    }
  }
  template <typename Message>
  void Deliver(const bus::Channel& channel, const Message& message) {
    if (!process_) return;
    bus::Publish(process_->bus, channel, message);
    while (process_->bus.HandleOnce()) {
    }
  }
  template <typename Message>
  void Send(const bus::Channel& channel, const Message& message) {
    Record(channel.name, bus::Encode(message));
    Deliver(channel, message);
  }
  // At 3 m/s towards a thing that stands 60 m ahead.
  void SendScan(int number) {
    const auto offset_us = test::kScanUs * number;
    for (auto pose_us = offset_us; pose_us < offset_us + test::kScanUs; pose_us += 20'000) {
      auto pose = test::MakePose(pose_us, pose_us / 20'000);
      pose.position_map_m[1] = 3e-6 * static_cast<double>(pose_us);
      pose.velocity_map_mps[1] = 3.0;
      Send(bus::kPose, pose);
    }
    Send(bus::kLidarScan, test::MakeScan(offset_us, number));
    Send(bus::kSegments, test::MakeSegments(offset_us, number));
    Send(bus::kObstacles, test::MakeObstacles(offset_us, number, {test::MakeObstacle(1, test::kStartUs + offset_us + 50'000, {0.0, 60.0})}));
  }

  Messages Replay() {
    writer_.Flush();
    support::WriteFile(log_, std::string(bytes_.begin(), bytes_.end()));
    Messages messages;
    runtime::Progress progress("test", stderr, false);
    const auto inspection = Inspect({log_}, {.from = {"OBSTACLES"}});
    Chain chain(support::kDemoConfig, inspection.plan, [&messages](Utime, std::string_view channel, Bytes bytes) {
      messages[std::string(channel)].emplace_back(bytes.begin(), bytes.end());
    });
    const auto summary = Feed({log_}, inspection, chain, progress);
    Finish(summary, inspection, chain);
    return messages;
  }
  void ExpectReplayEqualsLive() {
    End();
    const auto messages = Replay();
    for (const auto* name : {"TRACKS", "ALERTS"}) {
      ASSERT_TRUE(messages.contains(name)) << name;
      EXPECT_EQ(messages.at(name).size(), live_.at(name).size()) << name;
      EXPECT_TRUE(messages.at(name) == live_.at(name)) << name;
    }
  }
};

TEST_F(LiveRun, TakesAcknowledgementsWithTheScansWithWhichTheyWereTaken) {
  Start();
  std::optional<alert_ack_t> waiting;  // to be recorded
  int num_sent = 0;
  for (int i = 0; i < 150; ++i) {
    SendScan(i);
    if (waiting && i % 3 == 0) {
      Record("ALERT_ACK", bus::Encode(*waiting));  // the recorder heard it later than the tracker
      waiting.reset();
    } else if (active_ && !waiting) {
      waiting.emplace();
      waiting->source = "page";
      waiting->seq = num_sent++;
      waiting->alert_id = active_->id;
      waiting->alert_raised_utime_us = active_->raised_utime_us;
      Deliver(bus::kAlertAck, *waiting);
    }
  }
  ASSERT_GE(num_sent, 1) << "no alert came up";
  int num_taken = 0;
  for (const auto& bytes : live_.at("ALERTS")) num_taken += bus::Decode<alerts_t>(bytes).value().num_acknowledged;
  EXPECT_GE(num_taken, 1);
  ExpectReplayEqualsLive();
}

TEST_F(LiveRun, BeginsAnewWhereTheProcessWasRestarted) {
  Start();
  for (int i = 0; i < 40; ++i) SendScan(i);
  process_.reset();  // killed
  for (int i = 40; i < 50; ++i) SendScan(i);
  Start();
  for (int i = 50; i < 120; ++i) SendScan(i);
  EXPECT_LE(live_.at("TRACKS").size(), 110U);
  EXPECT_GE(live_.at("TRACKS").size(), 108U);
  const auto begin = bus::Decode<alerts_t>(live_.at("ALERTS").back()).value().begin_seq;
  EXPECT_GE(begin, 50);
  EXPECT_LE(begin, 51);
  ExpectReplayEqualsLive();
}

TEST_F(LiveRun, BeginsWhereTheFirstProcessBegan) {
  for (int i = 0; i < 10; ++i) SendScan(i);
  Start();
  for (int i = 10; i < 60; ++i) SendScan(i);
  ExpectReplayEqualsLive();
}

TEST_F(LiveRun, WithoutAlertsInTheLogTakesAcknowledgementsAsTheyCome) {
  for (int i = 0; i < 60; ++i) SendScan(i);
  EXPECT_FALSE(ReadScript({}));
  const auto messages = Replay();
  EXPECT_EQ(messages.at("TRACKS").size(), 60U);
  EXPECT_EQ(messages.at("ALERTS").size(), 60U);
}

// OBSTACLES and POSE from elsewhere, and no more.
TEST_F(LiveRun, OfObstaclesAndPosesAloneKnowsNoSight) {
  for (int i = 0; i < 60; ++i) SendScan(i);
  writer_.Flush();
  support::WriteFile(log_, std::string(bytes_.begin(), bytes_.end()));
  bytes_.clear();
  {
    bus::LogReader reader(log_);
    bus::LogWriter some([this](Bytes bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); });
    while (const auto event = reader.Next()) {
      if (event->channel == "OBSTACLES" || event->channel == "POSE") some.Write(event->time, event->channel, event->bytes);
    }
    some.Flush();
  }
  const auto messages = Replay();
  ASSERT_EQ(messages.at("TRACKS").size(), 60U);
  for (const auto& bytes : messages.at("TRACKS")) EXPECT_EQ(bus::Decode<tracks_t>(bytes).value().sight, tracks_t::SIGHT_UNKNOWN);
}

}  // namespace
}  // namespace lookout::replay
