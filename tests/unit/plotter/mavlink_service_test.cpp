// When distances are sent to an autopilot, and what else is.
#include <cmath>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "tests/unit/plotter/mavlink_fixture.hpp"

namespace lookout::plotter::test {
namespace {

TEST_F(MavlinkService, IsSilentWhenTheLookOutIsLostAndSaysSoOnce) {
  Run(10);
  EXPECT_EQ(Frames(support::kObstacleDistanceId).size(), 10U);
  ASSERT_EQ(Texts(), std::vector<std::string>{"Lookout: the look-out begins"});
  link_->sent.clear();
  // TRACKS come no more, all else does.
  for (int i = 0; i < 30; ++i) {
    Wait(kScanUs);
    SendScan();
    SendAlerts();
  }
  EXPECT_TRUE(Frames(support::kObstacleDistanceId).empty());
  ASSERT_EQ(Texts(), std::vector<std::string>{"Lookout: no look-out, no distances are sent"});
  EXPECT_EQ(Frames(support::kHeartbeatId).size(), 3U);
  EXPECT_EQ(Frames(support::kHeartbeatId).back().At<std::uint8_t>(7), 5);  // MAV_STATE_CRITICAL
  link_->sent.clear();
  Run(3);
  EXPECT_EQ(Texts(), std::vector<std::string>{"Lookout: the look-out is back"});
  EXPECT_EQ(Frames(support::kObstacleDistanceId).size(), 3U);
}

TEST_F(MavlinkService, IsSilentWithoutAlertsOrPose) {
  Run(10);
  for (int i = 0; i < 20; ++i) {
    Wait(kScanUs);
    SendScan();
    SendTracks();
    ++seq_;
  }
  link_->sent.clear();
  for (int i = 0; i < 10; ++i) {
    Wait(kScanUs);
    SendScan();
    SendTracks();
    ++seq_;
  }
  EXPECT_TRUE(Frames(support::kObstacleDistanceId).empty());
  Run(5);
  EXPECT_FALSE(Frames(support::kObstacleDistanceId).empty());
  Wait(1'200'000, false);
  link_->sent.clear();
  SendScan();
  SendTracks();
  SendAlerts();
  support::HandleAll(*bus_);
  EXPECT_TRUE(Frames(support::kObstacleDistanceId).empty());
}

TEST_F(MavlinkService, IsSilentWhileAnAlertSaysThatNobodyLooks) {
  Run(10);
  alerts_ = {AlertOf(-1, alert_t::CAUSE_WATCH)};
  NextScan();
  EXPECT_FALSE(Last());
  // A part of the guard zone alone: its sectors are unknown by themselves.
  alerts_ = {AlertOf(4, alert_t::CAUSE_WATCH)};
  NextScan();
  EXPECT_TRUE(Last());
}

// A boat is ahead and TRACKS, ALERTS and POSE come, but no scan does: distances went on while the text said that none are sent.
TEST_F(MavlinkService, SendsNoDistanceBetweenTheTextsThatNoneAreSentAndThatTheyAreBack) {
  for (const auto form : {MavlinkForm::kSectors, MavlinkForm::kPoints}) {
    output_.mavlink.form = form;
    host_us_ = kStartUs;
    Start();
    tracks_ = {TrackOf(4, Box(Ahead(1, 10.0, 0.0), 2.0, 2.0, -heading_rad_))};
    for (int i = 0; i < 60; ++i) {
      sends_scan_ = i < 10 || i >= 40;
      sends_labels_ = i < 10 || i >= 25;
      NextScan();
    }
    bool is_told_to_look = false;
    int num_distances = 0;
    for (const auto& frame : Frames()) {
      if (frame.message_id == support::kStatusTextId) is_told_to_look = frame.text() != "Lookout: no look-out, no distances are sent";
      if (frame.message_id != support::kObstacleDistanceId && frame.message_id != support::kObstacleDistance3dId) continue;
      EXPECT_TRUE(is_told_to_look);
      ++num_distances;
    }
    EXPECT_GE(num_distances, 30);
    EXPECT_EQ(Texts(), (std::vector<std::string>{"Lookout: the look-out begins", "Lookout: no look-out, no distances are sent",
                                                 "Lookout: the look-out is back"}));
    // A receiver takes 0.5 s of silence for "no data".
    link_->sent.clear();
    sends_scan_ = false;
    Run(30);
    EXPECT_TRUE(Frames(support::kObstacleDistanceId).empty());
    EXPECT_TRUE(Frames(support::kObstacleDistance3dId).empty());
    EXPECT_EQ(Frames(support::kHeartbeatId).back().At<std::uint8_t>(7), 5);  // MAV_STATE_CRITICAL
  }
}

// The segmenter never ran: the text said that the look-out begins, and the heartbeat that it is active, for a second.
TEST_F(MavlinkService, DoesNotBeginToLookBeforeALookHasSeen) {
  sends_scan_ = false;
  Run(60);
  EXPECT_EQ(Texts(), std::vector<std::string>{"Lookout: no look-out, no distances are sent"});
  for (const auto& frame : Frames(support::kHeartbeatId)) EXPECT_EQ(frame.At<std::uint8_t>(7), 5);  // MAV_STATE_CRITICAL
  sends_scan_ = true;
  Run(15);
  EXPECT_EQ(Texts().back(), "Lookout: the look-out is back");
  EXPECT_EQ(Frames(support::kHeartbeatId).back().At<std::uint8_t>(7), 4);  // MAV_STATE_ACTIVE
}

// An autopilot needs no position of ours; but it gets no word of clear water where no scan comes.
TEST_F(MavlinkService, IsHealthyWithoutAPositionAndNotWithoutTheScan) {
  pose_status_ = pose_t::STATUS_UNKNOWN;
  Run(15);
  EXPECT_EQ(service_->Report().reason, "");
  sends_scan_ = false;
  tracks_ = {TrackOf(4, Box(Ahead(1, 10.0, 0.0), 2.0, 2.0, 0.0))};
  Run(15);
  EXPECT_NE(service_->Report().reason.find("LIDAR_SCAN and SEGMENTS of TRACKS do not come"), std::string::npos) << service_->Report().reason;
  EXPECT_GE(support::CountOf(*service_, "looks_without_scan"), 15);
}

TEST_F(MavlinkService, TellsARaisedAlertOnce) {
  Run(5);
  link_->sent.clear();
  alerts_ = {AlertOf(3, alert_t::CAUSE_CLOSEST_APPROACH)};
  Run(130);
  alerts_.front().state = alert_t::STATE_ACKNOWLEDGED;
  Run(5);
  ASSERT_EQ(Texts(), std::vector<std::string>{"Lookout: boat 17: closest approach 3 m in 21 s"});
  EXPECT_EQ(Frames(support::kStatusTextId).front().At<std::uint8_t>(0), 4);  // MAV_SEVERITY_WARNING
}

TEST_F(MavlinkService, SendsAHeartbeatASecondFromTheStartOn) {
  Wait(10'000'000, false);
  const auto frames = Frames(support::kHeartbeatId);
  EXPECT_EQ(frames.size(), 11U);
  EXPECT_EQ(frames.front().At<std::uint8_t>(4), 18);
  EXPECT_EQ(frames.front().At<std::uint8_t>(5), 8);
  EXPECT_EQ(Texts(), std::vector<std::string>{"Lookout: no look-out, no distances are sent"});
}

TEST_F(MavlinkService, SendsPointsInPlaceOfSectors) {
  output_.mavlink.form = MavlinkForm::kPoints;
  Start();
  NextScan();
  auto points = Frames(support::kObstacleDistance3dId);
  ASSERT_EQ(points.size(), 1U);
  EXPECT_EQ(points.front().At<float>(4), 41.0F);
  things_ = {Box(Ahead(1, 12.0, 0.0), 2.0, 2.0, -heading_rad_)};
  turn_radps_ = 0.0;
  link_->sent.clear();
  NextScan();
  points = Frames(support::kObstacleDistance3dId);
  EXPECT_TRUE(Frames(support::kObstacleDistanceId).empty());
  ASSERT_GE(points.size(), 3U);
  for (std::size_t i = 1; i < points.size(); ++i) {
    EXPECT_EQ(points[i].At<std::uint32_t>(0), points[0].At<std::uint32_t>(0));
    EXPECT_EQ(points[i].At<std::uint8_t>(27), 12);
    EXPECT_GE(std::hypot(points[i].At<float>(4), points[i].At<float>(8)), std::hypot(points[i - 1].At<float>(4), points[i - 1].At<float>(8)));
  }
}

// 72 points of 40 bytes ten times a second are 2.5 times what 115200 baud carry. They filled the port: each was 0.5 s old when it left.
TEST_F(MavlinkService, SendsAsManyPointsAsTheCableCarriesUntilTheNextScan) {
  output_.mavlink.form = MavlinkForm::kPoints;
  Start();
  velocity_mps_ = {0.0, 0.0};
  turn_radps_ = 0.0;
  things_ = {Box(Ahead(0, 0.0, 3.0), 40.0, 50.0, -heading_rad_)};
  link_->bytes_per_s = 11'520.0;
  Run(2);
  double least_m = kNothing;
  for (std::size_t i = 0; i < kNumSectors; ++i) least_m = std::min(least_m, TrueDistance(i, 0.0));
  for (int i = 0; i < 100; ++i) {
    link_->sent.clear();
    NextScan();
    // The last point leaves within 0.1 s.
    EXPECT_LE(link_->delay(), std::chrono::milliseconds(104));
    const auto points = Frames(support::kObstacleDistance3dId);
    ASSERT_GE(points.size(), 20U);
    EXPECT_NEAR(std::hypot(points.front().At<float>(4), points.front().At<float>(8)), least_m, 0.1);
  }
}

TEST_F(MavlinkService, CountsTheHeartbeatsOfTheAutopilot) {
  EXPECT_EQ(support::CountOf(*service_, "output_pilot_heartbeats"), 0);
  const auto heartbeat = support::AutopilotHeartbeat();
  link_->received = {heartbeat, "noise", heartbeat.substr(0, 5), heartbeat.substr(5)};
  Wait(100'000);
  EXPECT_EQ(support::CountOf(*service_, "output_pilot_heartbeats"), 2);
  EXPECT_EQ(support::CountOf(*service_, "lines_refused"), 0);
}

}  // namespace
}  // namespace lookout::plotter::test
