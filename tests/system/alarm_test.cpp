// The guard zone of lookout-tracker on a live bus, without a navigator: told with the scan that raises the alert; and that nobody looks.
#include <algorithm>
#include <chrono>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/health_t.hpp"
#include "tests/support/child.hpp"
#include "tests/support/files.hpp"
#include "tests/support/live_bus.hpp"
#include "tests/unit/tracker_shell/messages.hpp"

namespace lookout::system_test {
namespace {

using namespace support;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::seconds;
namespace messages = tracker::test;

class Alarm : public ::testing::Test {
 protected:
  Alarm() {
    bus::Subscribe<health_t>(bus_, bus::kHealth, [this](const health_t& message) { reports_.push_back(message); });
    bus::Subscribe<alerts_t>(bus_, bus::kAlerts, [this](const alerts_t& message) {
      alerts_.push_back(message);
      alerts_time_ = Clock::now();
    });
  }

  // The obstacle is 8 m ahead; nobody knows where that is on the earth.
  void SendScan(bool has_obstacle) {
    const std::int64_t offset_us = messages::kScanUs * seq_;
    const auto sweep = messages::MakeSweep(offset_us, seq_, fires_from_deg_, fires_to_deg_);
    bus::Publish(bus_, bus::kLidarScan, sweep);
    bus::Publish(bus_, bus::kSegments, messages::MakeNoSegments(sweep));
    auto obstacle = messages::MakeObstacle(1, messages::kStartUs + offset_us, {8.0, 0.0});
    obstacle.status = obstacle_t::STATUS_POSE_TIMEOUT;
    obstacle.num_map = 0;
    obstacle.footprint_east_m.clear();
    obstacle.footprint_north_m.clear();
    bus::Publish(bus_, bus::kObstacles, messages::MakeObstacles(offset_us, seq_, has_obstacle ? std::vector{obstacle} : std::vector<obstacle_t>{}));
    sent_ = Clock::now();
    ++seq_;
  }

  // Sends a scan every 100 ms where asked to, until it is so.
  template <typename Condition>
  bool Until(const Condition& is_so, bool has_scans, bool has_obstacle = false) {
    return SendUntil(bus_, is_so, [&] {
      if (has_scans) SendScan(has_obstacle);
    });
  }

  bool IsReported(const std::string& piece) const { return !reports_.empty() && reports_.back().reason.find(piece) != std::string::npos; }
  bool IsTold(std::int32_t cause) const {
    return !alerts_.empty() && std::ranges::any_of(alerts_.back().alerts, [cause](const alert_t& alert) {
      return alert.cause == cause && alert.state == alert_t::STATE_ACTIVE;
    });
  }

  bus::LcmBus bus_{bus::DefaultLcmUrl()};
  std::vector<health_t> reports_;
  std::vector<alerts_t> alerts_;
  Clock::time_point alerts_time_;
  Clock::time_point sent_;
  std::int64_t seq_ = 0;
  double fires_from_deg_ = 0.0;
  double fires_to_deg_ = 360.0;
};

TEST_F(Alarm, IsToldAtOnceAndThatNobodyLooks) {
  const TempDir temp_dir;
  Child child({Bin("tracker"), "--config", kDemoConfig.string()}, (temp_dir / "out").string());
  ASSERT_TRUE(Until([this] { return !reports_.empty(); }, false)) << child.Output();
  EXPECT_EQ(reports_.back().state, health_t::STATE_STARTING);
  EXPECT_EQ(reports_.back().reason, "no look-out: no whole scan yet");
  ASSERT_TRUE(Until([this] { return !IsReported("no look-out"); }, true)) << reports_.back().reason;
  EXPECT_FALSE(IsTold(alert_t::CAUSE_GUARD_ZONE));

  ASSERT_TRUE(Until([this] { return IsTold(alert_t::CAUSE_GUARD_ZONE); }, true, true));
  // With the scan that raised it, or on a busy computer with the next: nothing waits for a POSE that does not come.
  EXPECT_LT(alerts_time_ - sent_, milliseconds(100));
  EXPECT_LE(seq_ - 1 - alerts_.back().seq, 1);
  EXPECT_EQ(alerts_.back().alerts.at(0).text, "obstacle in the guard zone: 8.0 m, 0 deg to starboard");

  const auto num_reports = reports_.size();
  ASSERT_TRUE(Until([this] { return IsTold(alert_t::CAUSE_WATCH); }, false));
  EXPECT_LT(Clock::now() - sent_, milliseconds(2000));
  EXPECT_TRUE(IsTold(alert_t::CAUSE_GUARD_ZONE)) << "an alert that stands does not end because nobody looks";
  ASSERT_TRUE(Until([this] { return IsReported("no look-out: no whole scan for "); }, false));
  EXPECT_LE(reports_.size() - num_reports, 3U) << "at once, and not with the next second but one";
  EXPECT_EQ(child.Terminate(), 0);
}

// The field of view is set on the lidar's own page to 90 to 270 deg, and the zone is ahead: nobody said so.
TEST_F(Alarm, SaysThatNobodyLooksIntoTheGuardZone) {
  fires_from_deg_ = 90.0;
  fires_to_deg_ = 270.0;
  const TempDir temp_dir;
  Child child({Bin("tracker"), "--config", kDemoConfig.string()}, (temp_dir / "out").string());
  ASSERT_TRUE(Until([this] { return IsTold(alert_t::CAUSE_WATCH); }, true)) << child.Output();
  EXPECT_FALSE(alerts_.back().is_watch) << "with a scan";
  EXPECT_GT(alerts_.back().alerts.at(0).id, 0);
  EXPECT_EQ(alerts_.back().alerts.at(0).text, "no look-out in the whole guard zone: 300 to 60 deg (the lidar does not fire there)");
  ASSERT_TRUE(Until([this] { return IsReported("no look-out in the whole guard zone: 300 to 60 deg (the lidar does not fire there)"); }, true));
  EXPECT_EQ(reports_.back().state, health_t::STATE_DEGRADED);
  EXPECT_EQ(child.Terminate(), 0);
}

}  // namespace
}  // namespace lookout::system_test
