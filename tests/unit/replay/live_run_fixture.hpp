// A tracker that ran live, and the replay of its log.
#pragma once

#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "common/bus/log_file.hpp"
#include "services/tracker/params.hpp"
#include "services/tracker/service.hpp"
#include "tests/support/files.hpp"
#include "tests/support/memory_bus.hpp"
#include "tests/unit/tracker_shell/messages.hpp"
#include "tools/replay/chain.hpp"
#include "tools/replay/input.hpp"
#include "tools/replay/live_run.hpp"

namespace lookout::replay {

namespace fs = std::filesystem;
namespace test = tracker::test;
using Messages = std::map<std::string, std::vector<std::vector<std::uint8_t>>, std::less<>>;

inline constexpr std::string_view kTrackerText = "# proto-file: config/schema/tracker.proto\n# proto-message: lookout.config.Tracker\n";

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
    Process(const fs::path& config, tracker::Handover& handover)
        : service(bus, tracker::LoadParams(config),
                  {.before = handover.Read(), .hand_over = [&handover](const auto& alerts, const auto& tracks) { handover.Write(alerts, tracks); }}) {
    }
    bus::MemoryBus bus;
    tracker::Service service;
  };
  tracker::Handover handover_{folder_.path()};
  fs::path replay_config_ = WithoutGuardZone();
  fs::path config_ = replay_config_;  // of the live run
  std::unique_ptr<Process> process_;
  std::optional<alert_t> active_;  // in the latest ALERTS
  double moved_m_ = 0.0;           // north, all of the map
  double moved_deg_ = 0.0;         // its datum

  // The scans of these tests look into hardly any of it, of which ALERTS would tell.
  fs::path WithoutGuardZone() const {
    const auto config = folder_.path() / "replay_config";
    fs::copy(support::kDemoConfig, config, fs::copy_options::recursive);
    support::WriteFile(config / "tracker.txtpb", kTrackerText);
    return config;
  }

  void Record(std::string_view channel, Bytes bytes) {
    time_ += std::chrono::milliseconds(1);
    writer_.Write(time_, channel, bytes);
  }
  void Start() {
    process_ = std::make_unique<Process>(config_, handover_);
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
  template <typename Message>
  void Deliver(const bus::Channel& channel, const Message& message) {
    if (!process_) return;
    bus::Publish(process_->bus, channel, message);
    support::HandleAll(process_->bus);
  }
  template <typename Message>
  void Send(const bus::Channel& channel, const Message& message) {
    Record(channel.name, bus::Encode(message));
    Deliver(channel, message);
  }
  // At 3 m/s towards a thing that stands 60 m ahead.
  void SendScan(int number) { SendScan(number, number); }
  void SendScan(int number, std::int64_t seq) {
    SendPoses(number);
    SendSight(number, seq);
    SendObstacles(number, seq);
  }
  void SendPoses(int number) {
    const auto offset_us = test::kScanUs * number;
    for (auto pose_us = offset_us; pose_us < offset_us + test::kScanUs; pose_us += 20'000) {
      auto pose = test::MakePose(pose_us, pose_us / 20'000);
      pose.position_map_m[1] = 3e-6 * static_cast<double>(pose_us) + moved_m_;
      pose.datum_latitude_deg += moved_deg_;
      pose.velocity_map_mps[1] = 3.0;
      Send(bus::kPose, pose);
    }
  }
  void SendSight(int number, std::int64_t seq) {
    Send(bus::kLidarScan, test::MakeScan(test::kScanUs * number, seq));
    Send(bus::kSegments, test::MakeSegments(test::kScanUs * number, seq));
  }
  void SendObstacles(int number, std::int64_t seq) {
    const auto offset_us = test::kScanUs * number;
    auto message = test::MakeObstacles(offset_us, seq, {test::MakeObstacle(1, test::kStartUs + offset_us + 50'000, {0.0, 60.0 + moved_m_})});
    message.datum_latitude_deg += moved_deg_;
    Send(bus::kObstacles, message);
  }
  // Sails on until the alert of the thing ahead is a warning, and acknowledges it.
  // @return the number of the next scan; 0: there was none
  int AcknowledgeTheWarning() {
    for (int number = 0; number < 170; ++number) {
      SendScan(number);
      if (!active_ || active_->level != alert_t::LEVEL_WARNING) continue;
      alert_ack_t message{};
      message.source = "page";
      message.alert_id = active_->id;
      message.alert_raised_utime_us = active_->raised_utime_us;
      Send(bus::kAlertAck, message);
      SendScan(number + 1);
      return number + 2;
    }
    return 0;
  }
  // How many scans of a process say that an alert is not acknowledged.
  int NumActive(std::int64_t begin_seq) const {
    int number = 0;
    for (const auto& bytes : live_.at("ALERTS")) {
      const auto message = bus::Decode<alerts_t>(bytes).value();
      if (message.begin_seq != begin_seq) continue;
      number += std::ranges::any_of(message.alerts, [](const alert_t& alert) { return alert.state == alert_t::STATE_ACTIVE; }) ? 1 : 0;
    }
    return number;
  }
  // What another tracker, which began with scan 8, has of the same scan: whatever is active it was told to take note of.
  void RecordOfSecondTracker(alerts_t message) {
    message.begin_seq = 8;
    message.begin_utime_us = test::kStartUs + 8 * test::kScanUs;
    message.acknowledged.clear();
    for (const auto& alert : message.alerts) {
      if (alert.state != alert_t::STATE_ACTIVE) continue;
      auto& acknowledgement = message.acknowledged.emplace_back();
      acknowledgement = {};
      acknowledgement.source = "second";
      acknowledgement.alert_id = alert.id;
      acknowledgement.alert_raised_utime_us = alert.raised_utime_us;
    }
    message.num_acknowledged = static_cast<std::int32_t>(message.acknowledged.size());
    Record(bus::kAlerts.name, bus::Encode(message));
  }
  alerts_t LastAlerts() const { return bus::Decode<alerts_t>(live_.at("ALERTS").back()).value(); }

  Messages Replay() {
    writer_.Flush();
    support::WriteFile(log_, std::string(bytes_.begin(), bytes_.end()));
    Messages messages;
    runtime::Progress progress("test", stderr, false);
    const auto inspection = Inspect({log_}, {.from = {"OBSTACLES"}});
    Chain chain(replay_config_, inspection.plan, [&messages](Utime, std::string_view channel, Bytes bytes) {
      messages[std::string(channel)].emplace_back(bytes.begin(), bytes.end());
    });
    const auto summary = Feed({log_}, inspection, chain, progress);
    Finish(summary, inspection, chain);
    return messages;
  }
  void ExpectReplayEqualsLive() {
    const auto messages = Replay();
    for (const auto* name : {"TRACKS", "ALERTS"}) {
      ASSERT_TRUE(messages.contains(name)) << name;
      EXPECT_EQ(messages.at(name).size(), live_.at(name).size()) << name;
      EXPECT_TRUE(messages.at(name) == live_.at(name)) << name;
    }
  }
};

}  // namespace lookout::replay
