// What the tracker says where nobody looks into a part of the guard zone: ALERTS and HEALTH.
#include <algorithm>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "services/tracker/alert_text.hpp"
#include "services/tracker/service.hpp"
#include "tests/support/bus_fixture.hpp"
#include "tests/unit/tracker_shell/messages.hpp"
#include "tests/unit/tracker_shell/service_fixture.hpp"

namespace lookout::tracker {
namespace {

Params MakeZoneParams() {
  auto params = test::MakeParams();
  params.look_out.limits.guard_zone = {.range_m = 10.0, .bearing = {DegToRad(300.0), DegToRad(120.0)}};
  params.zone_sight.zone = params.look_out.limits.guard_zone;
  params.zone_sight.min_range_m = 0.5;
  params.zone_sight.T_vessel_lidar.translation().z() = 1.0;
  params.zone_sight.own_vessel_box_m = {Eigen::Vector3d(-1.0, -0.5, -1.0), Eigen::Vector3d(1.0, 0.5, 2.0)};
  params.zone_sight.own_hull_m = {Eigen::Vector2d(-1.0, -0.5), Eigen::Vector2d(1.0, 0.5)};
  return params;
}

class TrackerServiceZone : public support::BusTest {
 protected:
  // Scans over empty water of a lidar that fires from one azimuth clockwise to another.
  void Scans(int count, double from_deg, double to_deg, std::int32_t flags = 0) {
    for (int i = 0; i < count; ++i, ++number_) {
      const auto offset_us = test::kScanUs * number_;
      for (int k = 1; k <= 5; ++k) Send(bus::kPose, test::MakePose(offset_us + 20'000 * k, 5 * number_ + k));
      if (number_ == 0) Send(bus::kPose, test::MakePose(0, 0));
      const auto sweep = test::MakeSweep(offset_us, number_, from_deg, to_deg);
      Send(bus::kLidarScan, sweep);
      Send(bus::kSegments, test::MakeNoSegments(sweep));
      auto obstacles = test::MakeObstacles(offset_us, number_, {});
      obstacles.scan_flags = flags;
      Send(bus::kObstacles, obstacles);
    }
  }
  // The last word of the zone; empty: none.
  alert_t Told() const { return alerts_.back().alerts.empty() ? alert_t{} : alerts_.back().alerts.front(); }

  Service service_{bus_, MakeZoneParams()};
  support::Kept<alerts_t> alerts_{bus_, bus::kAlerts};
  int number_ = 1;
};

TEST_F(TrackerServiceZone, SaysNothingOverEmptyWaterThatIsLookedAt) {
  Scans(100, 0.0, 360.0);
  ASSERT_GT(alerts_.size(), 90U);
  for (const auto& message : alerts_) EXPECT_TRUE(message.alerts.empty());
  EXPECT_EQ(service_.Report().reason.find("look-out"), std::string::npos) << service_.Report().reason;
}

// A lidar that fires 90 to 270 deg only, zone ahead: nothing was said, HEALTH was ok.
TEST_F(TrackerServiceZone, SaysWhichPartNobodyLooksInto) {
  Scans(25, 90.0, 270.0);
  EXPECT_TRUE(alerts_.back().alerts.empty());
  Scans(10, 90.0, 270.0);
  const auto alert = Told();
  EXPECT_EQ(alert.cause, alert_t::CAUSE_WATCH);
  EXPECT_EQ(alert.level, alert_t::LEVEL_WARNING) << "it is all of the zone";
  EXPECT_EQ(alert.state, alert_t::STATE_ACTIVE);
  EXPECT_GT(alert.id, 0) << "ids below 0 are of the watch that goes by the clock";
  EXPECT_EQ(alert.track_id, 0);
  EXPECT_FALSE(alerts_.back().is_watch);
  EXPECT_EQ(alert.text, "no look-out in the whole guard zone: 300 to 60 deg (the lidar does not fire there)");
  EXPECT_NE(service_.Report().reason.find(alert.text), std::string::npos) << service_.Report().reason;
  EXPECT_EQ(service_.Report().state, HealthState::kDegraded);

  alert_ack_t acknowledgement{};
  acknowledgement.source = "page";
  acknowledgement.alert_id = alert.id;
  acknowledgement.alert_raised_utime_us = alert.raised_utime_us;
  Send(bus::kAlertAck, acknowledgement);
  Scans(100, 90.0, 270.0);
  EXPECT_EQ(Told().id, alert.id) << "raised once";
  EXPECT_EQ(Told().state, alert_t::STATE_ACKNOWLEDGED);
  EXPECT_NE(service_.Report().reason.find("no look-out in the whole guard zone"), std::string::npos) << "it is so all the same";

  Scans(60, 0.0, 360.0);
  EXPECT_TRUE(alerts_.back().alerts.empty());
  const auto last = std::ranges::find_if(
      alerts_, [](const alerts_t& message) { return !message.alerts.empty() && message.alerts.front().state == alert_t::STATE_CLEARED; });
  ASSERT_NE(last, alerts_.end());
  EXPECT_EQ(last->alerts.front().text, "look-out in all of the guard zone again");
  EXPECT_EQ(service_.Report().reason.find("look-out"), std::string::npos) << service_.Report().reason;
}

// As with every warning of which nobody took note; but it says that it is over.
TEST_F(TrackerServiceZone, SaysThatItIsOverWhereNobodyTookNote) {
  Scans(40, 90.0, 270.0);
  Scans(80, 0.0, 360.0);
  EXPECT_EQ(Told().state, alert_t::STATE_RECTIFIED);
  EXPECT_EQ(Told().text, "look-out in all of the guard zone again");
  EXPECT_EQ(service_.Report().reason.find("look-out"), std::string::npos) << service_.Report().reason;
}

// What was acknowledged hides no other part.
TEST_F(TrackerServiceZone, RaisesAnewWhatWasNotTold) {
  Scans(35, 20.3, 359.5);
  const auto first = Told();
  EXPECT_EQ(first.level, alert_t::LEVEL_CAUTION);
  EXPECT_EQ(first.text, "no look-out in part of the guard zone: 0 to 20 deg (the lidar does not fire there)");
  alert_ack_t acknowledgement{};
  acknowledgement.source = "page";
  acknowledgement.alert_id = first.id;
  acknowledgement.alert_raised_utime_us = first.raised_utime_us;
  Send(bus::kAlertAck, acknowledgement);
  Scans(35, 50.3, 359.5);
  EXPECT_GT(Told().id, first.id);
  EXPECT_EQ(Told().state, alert_t::STATE_ACTIVE);
  EXPECT_EQ(Told().text, "no look-out in part of the guard zone: 0 to 50 deg (the lidar does not fire there)");
}

constexpr std::int32_t kSecondSilent = obstacles_t::FLAG_SECOND_SILENT;

// Its cable is pulled: ALERTS said nothing, and the stern was blind.
TEST_F(TrackerServiceZone, SaysThatTheSecondLidarDoesNotLook) {
  Scans(10, 0.0, 360.0);
  Scans(2, 0.0, 360.0, kSecondSilent);
  EXPECT_TRUE(alerts_.back().alerts.empty());
  Scans(3, 0.0, 360.0, kSecondSilent);
  const auto alert = Told();
  EXPECT_EQ(alert.cause, alert_t::CAUSE_WATCH);
  EXPECT_EQ(alert.level, alert_t::LEVEL_CAUTION);
  EXPECT_EQ(alert.state, alert_t::STATE_ACTIVE);
  EXPECT_GT(alert.id, 0) << "ids below 0 are of the watch that goes by the clock";
  EXPECT_EQ(alert.track_id, 0);
  EXPECT_EQ(alert.text, "no look-out by the second lidar");
  EXPECT_EQ(alerts_.back().sounding_alert_id, alert.id);
  EXPECT_EQ(service_.Report().state, HealthState::kDegraded);
  EXPECT_NE(service_.Report().reason.find("no look-out by the second lidar"), std::string::npos) << service_.Report().reason;

  Scans(60, 0.0, 360.0);
  EXPECT_TRUE(alerts_.back().alerts.empty());
  const auto last = std::ranges::find_if(
      alerts_, [](const alerts_t& message) { return !message.alerts.empty() && message.alerts.front().state == alert_t::STATE_CLEARED; });
  ASSERT_NE(last, alerts_.end());
  EXPECT_EQ(last->alerts.front().id, alert.id);
  EXPECT_EQ(last->alerts.front().text, "look-out by the second lidar again");
  EXPECT_EQ(service_.Report().reason.find("look-out"), std::string::npos) << service_.Report().reason;
}

TEST_F(TrackerServiceZone, TellsTheSecondLidarBesideAPartOfTheZone) {
  Scans(45, 20.3, 359.5, kSecondSilent);
  ASSERT_EQ(alerts_.back().num_alerts, 2);
  const auto has = [this](const std::string& text) {
    return std::ranges::any_of(alerts_.back().alerts, [&text](const alert_t& alert) { return alert.text == text; });
  };
  EXPECT_TRUE(has("no look-out by the second lidar"));
  EXPECT_TRUE(has("no look-out in part of the guard zone: 0 to 20 deg (the lidar does not fire there)"));
}

TEST_F(TrackerServiceZone, SaysNothingOfAHoleOfTheSecondLidar) {
  Scans(60, 0.0, 360.0, obstacles_t::FLAG_SECOND_HOLE);
  for (const auto& message : alerts_) EXPECT_TRUE(message.alerts.empty());
}

TEST(ZoneText, NamesThreePartsAndHowManyMore) {
  const auto part = [](Unseen why, double from_deg, double width_deg) {
    return UnseenPart{.why = why, .bearing = {DegToRad(from_deg), DegToRad(width_deg)}, .from_m = 3.0, .to_m = 10.0, .is_wide = true};
  };
  auto parts = std::vector{part(Unseen::kHidden, 320.0, 80.0)};
  EXPECT_EQ(TextOf(parts, false), "no look-out in part of the guard zone: 320 to 40 deg (the own boat or something at the lidar hides it)");
  parts[0].begins_with_zone = false;
  EXPECT_EQ(TextOf(parts, false),
            "no look-out in part of the guard zone: 320 to 40 deg, from 3.0 m on (the own boat or something at the lidar hides it)");
  parts = {part(Unseen::kBeyondMax, 0.0, 360.0)};
  parts[0].ends_with_zone = false;
  EXPECT_EQ(TextOf(parts, true), "no look-out in the whole guard zone: all round, up to 10.0 m (beyond max_range_m of the segmenter)");
  parts.assign(5, part(Unseen::kNoBeams, 0.0, 10.0));
  EXPECT_NE(TextOf(parts, false).find("; and 2 more"), std::string::npos);
}

}  // namespace
}  // namespace lookout::tracker
