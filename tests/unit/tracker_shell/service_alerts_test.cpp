// Alerts, acknowledgements and orders of the tracker as a process.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/decode.hpp"
#include "services/tracker/service.hpp"
#include "tests/support/memory_bus.hpp"
#include "tests/unit/tracker_shell/messages.hpp"
#include "tests/unit/tracker_shell/service_fixture.hpp"
#include "tests/unit/tracker_shell/still_boat_fixture.hpp"

namespace lookout::tracker {
namespace {

using std::chrono::milliseconds;

TEST_F(TrackerService, SaysWhenNobodyLooksAndTakesNoteOfIt) {
  SendPoses(0, 10'000'000);
  std::int64_t host_ms = 0;
  const auto pass = [&](int ms) {
    for (const auto end_ms = host_ms + ms; host_ms < end_ms; host_ms += 10) service_.AdvanceTo(Host(milliseconds(host_ms)));
    HandleAll();
  };
  pass(2000);
  EXPECT_TRUE(alerts_.empty()) << "before the first scan there is nothing to repeat";
  EXPECT_NE(service_.Report().reason.find("no look-out: no whole scan yet"), std::string::npos) << service_.Report().reason;
  for (int i = 0; i < 5; ++i) {
    SendScan(i, i);
    pass(100);
  }
  const auto before = alerts_.size();
  EXPECT_EQ(before, 5U);
  EXPECT_EQ(service_.Report().reason.find("no look-out"), std::string::npos);
  EXPECT_FALSE(service_.TakeWatchChange());
  pass(1500);
  EXPECT_TRUE(service_.TakeWatchChange());
  ASSERT_EQ(alerts_.size(), before + 3) << "at once, and every half second";
  const auto watch = alerts_.back();
  EXPECT_TRUE(watch.is_watch);
  EXPECT_EQ(watch.seq, 4);
  ASSERT_GE(watch.num_alerts, 1);
  EXPECT_EQ(watch.alerts[0].cause, alert_t::CAUSE_WATCH);
  EXPECT_EQ(watch.alerts[0].level, alert_t::LEVEL_WARNING);
  EXPECT_EQ(watch.alerts[0].state, alert_t::STATE_ACTIVE);
  EXPECT_EQ(watch.alerts[0].id, -1);
  EXPECT_NE(watch.alerts[0].text.find("no look-out: no whole scan for 1."), std::string::npos) << watch.alerts[0].text;
  EXPECT_NE(service_.Report().reason.find("no look-out"), std::string::npos);

  alert_ack_t acknowledgement{};
  acknowledgement.source = "page";
  acknowledgement.alert_id = -1;
  acknowledgement.alert_raised_utime_us = watch.alerts[0].raised_utime_us;
  Send(bus::kAlertAck, acknowledgement);
  pass(20);
  EXPECT_EQ(alerts_.back().alerts.at(0).state, alert_t::STATE_ACKNOWLEDGED);

  // A scan that lost packets is no look-out.
  auto holed = Obstacles(30, 30);
  holed.scan_flags = lidar_scan_t::FLAG_HOLE;
  SendSight(30, 30);
  Send(bus::kObstacles, holed);
  pass(100);
  EXPECT_FALSE(service_.TakeWatchChange());
  // Nor are two: an alert takes three.
  for (int i = 31; i < 33; ++i) {
    SendScan(i, i);
    pass(20);
    EXPECT_FALSE(service_.TakeWatchChange());
  }
  EXPECT_NE(service_.Report().reason.find("no look-out: less than 3 whole scans within 1.0 s"), std::string::npos) << service_.Report().reason;
  SendScan(33, 33);
  pass(20);
  EXPECT_TRUE(service_.TakeWatchChange());
  EXPECT_TRUE(alerts_.back().is_watch);
  EXPECT_EQ(alerts_.back().alerts.at(0).state, alert_t::STATE_CLEARED);
  const auto after = alerts_.size();
  pass(300);
  EXPECT_EQ(alerts_.size(), after);
  EXPECT_EQ(Count("times_unwatched"), 1);
  for (const auto& message : alerts_) {
    if (message.is_watch) continue;
    EXPECT_TRUE(std::ranges::none_of(message.alerts, [](const alert_t& alert) { return alert.cause == alert_t::CAUSE_WATCH; }))
        << "the proof knows no clock";
  }
}

// The navigator is gone: obstacles come in the vessel frame only, 8 m ahead, and nothing waits.
TEST(TrackerServiceWithAGuardZone, WarnsWithoutPose) {
  auto params = test::MakeParams();
  params.look_out.limits.guard_zone = {.range_m = 10.0, .bearing = {DegToRad(300.0), DegToRad(120.0)}};
  bus::MemoryBus bus;
  Service service(bus, params);
  std::vector<alerts_t> alerts;
  bus::Subscribe<alerts_t>(bus, bus::kAlerts, [&](const alerts_t& message) { alerts.push_back(message); });
  const auto handle_all = [&bus] { support::HandleAll(bus); };
  service.AdvanceTo(Host(milliseconds(0)));
  service.AdvanceTo(Host(milliseconds(1000)));
  for (int i = 0; i < 50; ++i) {
    service.AdvanceTo(Host(milliseconds(1000 + 100 * i)));
    bus::Publish(bus, bus::kLidarScan, test::MakeScan(test::kScanUs * i, i));
    bus::Publish(bus, bus::kSegments, test::MakeSegments(test::kScanUs * i, i));
    const auto obstacle = test::MakeObstacle(1, test::kStartUs + test::kScanUs * i, {i < 5 ? 8.0 : 30.0, 0.0});
    const auto message = test::MakeObstacles(test::kScanUs * i, i, {obstacle});
    bus::Publish(bus, bus::kObstacles, test::InTheVesselFrame(message, obstacle_t::STATUS_POSE_TIMEOUT));
    handle_all();
    service.AdvanceTo(Host(milliseconds(1010 + 100 * i)));
    handle_all();
    ASSERT_EQ(alerts.size(), static_cast<std::size_t>(i) + 1) << "without delay";
    ASSERT_EQ(alerts.back().num_alerts, i < 2 ? 0 : 1) << i;
  }
  EXPECT_EQ(alerts.at(2).alerts[0].text, "obstacle in the guard zone: 8.0 m, 0 deg to starboard");
  EXPECT_EQ(alerts.at(2).alerts[0].level, alert_t::LEVEL_WARNING);
  EXPECT_EQ(alerts.at(2).alerts[0].track_id, 0);
  EXPECT_EQ(alerts.back().alerts[0].state, alert_t::STATE_RECTIFIED) << "nobody took note";
}

// The thing astern, which the second lidar saw, is not gone because that lidar is dead. The first looks, and the watch is content.
TEST(TrackerServiceWithAGuardZone, EndsNoAlertByScansWithoutTheSecondLidar) {
  for (const std::int32_t flags : {0, int{obstacles_t::FLAG_SECOND_HOLE}, int{obstacles_t::FLAG_SECOND_SILENT}}) {
    auto params = test::MakeParams();
    params.look_out.limits.guard_zone = {.range_m = 10.0, .bearing = {DegToRad(300.0), DegToRad(120.0)}};
    bus::MemoryBus bus;
    Service service(bus, params);
    std::vector<alerts_t> alerts;
    bus::Subscribe<alerts_t>(bus, bus::kAlerts, [&](const alerts_t& message) { alerts.push_back(message); });
    service.AdvanceTo(Host(milliseconds(0)));
    for (int i = 0; i < 60; ++i) {
      service.AdvanceTo(Host(milliseconds(1000 + 100 * i)));
      bus::Publish(bus, bus::kLidarScan, test::MakeScan(test::kScanUs * i, i));
      bus::Publish(bus, bus::kSegments, test::MakeSegments(test::kScanUs * i, i));
      const auto obstacle = test::MakeObstacle(1, test::kStartUs + test::kScanUs * i, {i < 10 ? 8.0 : 30.0, 0.0});
      auto message = test::MakeObstacles(test::kScanUs * i, i, {obstacle});
      if (i >= 10) message.scan_flags = flags;
      bus::Publish(bus, bus::kObstacles, test::InTheVesselFrame(message, obstacle_t::STATUS_POSE_TIMEOUT));
      support::HandleAll(bus);
      service.AdvanceTo(Host(milliseconds(1010 + 100 * i)));
      support::HandleAll(bus);
      ASSERT_FALSE(alerts.back().is_watch) << flags;
    }
    const auto of_zone = std::ranges::find(alerts.back().alerts, std::int32_t{alert_t::CAUSE_GUARD_ZONE}, &alert_t::cause);
    ASSERT_NE(of_zone, alerts.back().alerts.end());
    EXPECT_EQ(of_zone->state == alert_t::STATE_ACTIVE, flags != 0) << flags;
  }
}

// Without position or heading all that is in the zone shares one alert: a buoy was acknowledged, a motor boat crossed 8 m ahead, and nothing rang.
TEST(TrackerServiceWithAGuardZone, RingsWithoutPoseForABoatBesideABuoyThatWasAcknowledged) {
  auto params = test::MakeParams();
  params.look_out.limits.guard_zone = {.range_m = 10.0, .bearing = {DegToRad(300.0), DegToRad(120.0)}};
  bus::MemoryBus bus;
  Service service(bus, params);
  std::vector<alerts_t> alerts;
  bus::Subscribe<alerts_t>(bus, bus::kAlerts, [&](const alerts_t& message) { alerts.push_back(message); });
  const auto send = [&](int i, const std::vector<std::pair<double, double>>& places_m) {
    service.AdvanceTo(Host(milliseconds(1000 + 100 * i)));
    bus::Publish(bus, bus::kLidarScan, test::MakeScan(test::kScanUs * i, i));
    bus::Publish(bus, bus::kSegments, test::MakeSegments(test::kScanUs * i, i));
    std::vector<obstacle_t> obstacles;
    for (const auto& place_m : places_m) {
      const auto id = static_cast<std::int32_t>(obstacles.size()) + 1;
      obstacles.push_back(test::MakeObstacle(id, test::kStartUs + test::kScanUs * i, place_m));
    }
    bus::Publish(bus, bus::kObstacles, test::InTheVesselFrame(test::MakeObstacles(test::kScanUs * i, i, obstacles)));
    support::HandleAll(bus);
    service.AdvanceTo(Host(milliseconds(1010 + 100 * i)));
    support::HandleAll(bus);
  };
  const std::pair<double, double> buoy_m{5.0, -4.0};
  service.AdvanceTo(Host(milliseconds(0)));
  for (int i = 0; i < 10; ++i) send(i, {buoy_m});
  ASSERT_EQ(alerts.back().num_alerts, 1);
  alert_ack_t acknowledgement{};
  acknowledgement.source = "page";
  acknowledgement.alert_id = alerts.back().alerts[0].id;
  acknowledgement.alert_raised_utime_us = alerts.back().alerts[0].raised_utime_us;
  bus::Publish(bus, bus::kAlertAck, acknowledgement);
  for (int i = 10; i < 40; ++i) send(i, {buoy_m});
  ASSERT_EQ(alerts.back().alerts.at(0).state, alert_t::STATE_ACKNOWLEDGED);
  for (int i = 40; i < 43; ++i) send(i, {buoy_m, {8.0, 4.0 - 0.5 * (i - 40)}});
  ASSERT_EQ(alerts.back().num_alerts, 1);
  EXPECT_EQ(alerts.back().alerts[0].state, alert_t::STATE_ACTIVE) << "in the third scan that shows the boat";
  EXPECT_EQ(alerts.back().alerts[0].text, "obstacle in the guard zone: 8.5 m, 21 deg to port") << "it tells of the boat, not of the buoy";
}

TEST_F(TrackerService, DropsAcknowledgementsOfNoAlertAndOfAnotherRun) {
  SendPoses(0, 1'000'000);
  SendScan(0, 0);
  alert_ack_t acknowledgement{};
  acknowledgement.source = "page";
  acknowledgement.alert_id = 77;
  Send(bus::kAlertAck, acknowledgement);
  acknowledgement.alert_id = 0;
  Send(bus::kAlertAck, acknowledgement);
  SendScan(1, 1);
  EXPECT_TRUE(alerts_.at(1).acknowledged.empty());
  EXPECT_EQ(Count("acks_of_no_alert"), 1);
  EXPECT_EQ(Count("acks_refused_id"), 1);
  acknowledgement.alert_id = 78;
  for (int i = 0; i < 150; ++i) Send(bus::kAlertAck, acknowledgement);
  EXPECT_EQ(Count("acks_dropped"), 50);
}

TEST_F(TrackerService, TakesOrdersWithTheNextScanAndRepeatsThem) {
  SendPoses(0, 1'000'000);
  SendScan(0, 0);
  order_t order{};
  order.source = "page";
  order.kind = order_t::KIND_SETTINGS;
  order.mode = order_t::MODE_OPEN_WATER;
  order.guard_zone_range_m = 12.0F;
  order.guard_zone_from_rad = order.guard_zone_to_rad = std::numeric_limits<float>::quiet_NaN();
  order.cpa_limit_m = 3.0F;
  Send(bus::kOrders, order);
  order.mode = 7;
  Send(bus::kOrders, order);
  order.kind = order_t::KIND_SILENCE;
  Send(bus::kOrders, order);
  SendScan(1, 1);
  SendScan(2, 2);
  EXPECT_EQ(alerts_.at(0).cpa_limit_m, 5.0F);
  EXPECT_EQ(alerts_.at(0).silenced_until_utime_us, 0);
  ASSERT_EQ(alerts_.at(1).num_orders, 2);
  EXPECT_EQ(alerts_.at(1).orders[0].cpa_limit_m, 3.0F);
  EXPECT_EQ(alerts_.at(1).cpa_limit_m, 3.0F);
  EXPECT_EQ(alerts_.at(1).guard_zone_range_m, 12.0F);
  EXPECT_EQ(alerts_.at(1).silenced_until_utime_us, alerts_.at(1).end_utime_us + 30'000'000);
  EXPECT_EQ(alerts_.at(2).num_orders, 0);
  EXPECT_EQ(alerts_.at(2).cpa_limit_m, 3.0F) << "until the next order";
  EXPECT_EQ(Count("orders_taken"), 2);
  EXPECT_EQ(Count("orders_refused_kind"), 1);
}

// Lidar begins anew: the buoy ahead gets another track and another alert, of which nobody has to take note again.
TEST_F(TrackerService, TakesAnAcknowledgementOverWhereTheLidarBeginsAnew) {
  // At 3 m/s towards a thing that stands 60 m ahead.
  const auto send_scan = [&](int number, std::int64_t seq) {
    const auto offset_us = test::kScanUs * number;
    for (auto pose_us = offset_us; pose_us < offset_us + test::kScanUs; pose_us += 20'000) {
      auto pose = test::MakePose(pose_us, pose_us / 20'000);
      pose.position_map_m[1] = 3e-6 * static_cast<double>(pose_us);
      pose.velocity_map_mps[1] = 3.0;
      Send(bus::kPose, pose);
    }
    SendSight(number, seq);
    Send(bus::kObstacles, test::MakeObstacles(offset_us, seq, {test::MakeObstacle(1, test::kStartUs + offset_us + 50'000, {0.0, 60.0})}));
  };
  const auto active = [&]() -> std::optional<alert_t> {
    if (alerts_.empty()) return std::nullopt;
    const auto found = std::ranges::find(alerts_.back().alerts, static_cast<std::int32_t>(alert_t::STATE_ACTIVE), &alert_t::state);
    return found == alerts_.back().alerts.end() ? std::nullopt : std::optional(*found);
  };
  int number = 0;
  // A warning, so that the next is no graver.
  while (number < 170 && !(active() && active()->level == alert_t::LEVEL_WARNING)) send_scan(number, number), ++number;
  if (!active()) GTEST_FAIL() << "no alert";
  const auto before = *active();
  alert_ack_t acknowledgement{};
  acknowledgement.source = "page";
  acknowledgement.alert_id = before.id;
  acknowledgement.alert_raised_utime_us = before.raised_utime_us;
  Send(bus::kAlertAck, acknowledgement);
  for (int i = 0; i < 5; ++i, ++number) send_scan(number, number);
  EXPECT_FALSE(active());

  int num_active = 0;
  for (int seq = 0; seq < 20; ++seq, ++number) {
    send_scan(number, seq);
    num_active += active() ? 1 : 0;
  }
  EXPECT_EQ(Count("runs_begun"), 1);
  const auto& last = alerts_.back().alerts;
  const auto again = std::ranges::find_if(last, [&before](const alert_t& alert) { return alert.track_id != before.track_id; });
  ASSERT_NE(again, last.end()) << "what still holds is raised again within 2 s";
  EXPECT_EQ(again->state, alert_t::STATE_ACKNOWLEDGED);
  EXPECT_LE(num_active, 2);
}

// A thing ahead that comes nearer in a frame that is not on the earth.
class RelativeToTheBoat : public TrackerService {
 protected:
  static constexpr double kFrame = 1.8e12;

  static void Move(pose_t& pose, double number) {
    pose.status = pose_t::STATUS_RELATIVE_TO_BOAT;
    pose.datum_latitude_deg = pose.datum_longitude_deg = pose.latitude_deg = pose.longitude_deg = pose.ellipsoid_height_m = kNan;
    pose.datum_ellipsoid_height_m = number;
    for (int i = 0; i < 9; ++i) {
      for (int k = 0; k < 9; ++k) {
        const bool is_unknown = (i >= 2 && i <= 5) || (k >= 2 && k <= 5);
        pose.covariance[i][k] = is_unknown ? kNan : i == k ? 1e-6 : 0.0;
      }
    }
    for (double& part : pose.velocity_map_mps) part = kNan;
  }
  // @param frame  its number; NaN: on the earth, the boat lies still
  void SendScanOf(int number, double north_m, double frame, double east_m = 0.0) {
    const auto offset_us = test::kScanUs * number;
    auto message = test::MakeObstacles(offset_us, number, {test::MakeObstacle(1, test::kStartUs + offset_us + 50'000, {east_m, north_m})});
    for (auto pose_us = offset_us; pose_us < offset_us + test::kScanUs; pose_us += 20'000) {
      auto pose = test::MakePose(pose_us, pose_us / 20'000);
      if (std::isfinite(frame)) Move(pose, frame);
      Send(bus::kPose, pose);
    }
    if (std::isfinite(frame)) {
      message.datum_latitude_deg = message.datum_longitude_deg = kNan;
      message.datum_ellipsoid_height_m = frame;
      message.obstacles[0].latitude_deg = message.obstacles[0].longitude_deg = kNan;
    }
    SendSight(number, number);
    Send(bus::kObstacles, message);
  }
  const alert_t* Told(std::int32_t state) const {
    if (alerts_.empty()) return nullptr;
    const auto found = std::ranges::find(alerts_.back().alerts, state, &alert_t::state);
    return found == alerts_.back().alerts.end() ? nullptr : &*found;
  }
  // At 3 m/s, until the warning comes and is acknowledged.
  // @return the number of the next scan; 0: no warning came
  int AcknowledgeTheWarning(double frame) {
    for (int i = 0; i < 200; ++i) {
      SendScanOf(i, 60.0 - 0.3 * i, frame);
      const auto* const alert = Told(alert_t::STATE_ACTIVE);
      if (alert == nullptr || alert->level != alert_t::LEVEL_WARNING) continue;
      alert_ack_t acknowledgement{};
      acknowledgement.source = "page";
      acknowledgement.alert_id = alert->id;
      acknowledgement.alert_raised_utime_us = alert->raised_utime_us;
      Send(bus::kAlertAck, acknowledgement);
      SendScanOf(i + 1, 60.0 - 0.3 * (i + 1), frame);
      return i + 2;
    }
    return 0;
  }
};

// An own velocity of 0 was taken for a boat in her berth, and there alerts are muted.
TEST_F(RelativeToTheBoat, AWarningComesOfWhatComesNearer) {
  const int next = AcknowledgeTheWarning(kFrame);
  ASSERT_GT(next, 0) << "no warning";
  EXPECT_LT(next, 185) << "before it is within 5 m";
  const auto* const alert = Told(alert_t::STATE_ACKNOWLEDGED);
  ASSERT_NE(alert, nullptr);
  EXPECT_EQ(alert->cause, alert_t::CAUSE_CLOSEST_APPROACH);
  EXPECT_TRUE(std::isnan(alert->latitude_deg));
  ASSERT_EQ(tracks_.back().num_tracks, 1);
  EXPECT_NEAR(tracks_.back().tracks[0].velocity_map_mps[1], -3.0, 0.5);
  EXPECT_LT(tracks_.back().tracks[0].cpa_m, 2.0F);
}

// Each scan places it up to 0.4 m off in both directions. The alert comes once, grows once and does not waver.
TEST_F(RelativeToTheBoat, AnAlertIsSteadyWhilePlacesAreNoisy) {
  std::mt19937 generator(7);
  const auto noise_m = [&generator] { return static_cast<double>(generator() % 801) * 0.001 - 0.4; };
  std::set<std::int64_t> ids;
  std::int32_t level = 0;
  int num_scans_with = 0;
  for (int i = 0; i < 190; ++i) {
    const double north_m = 60.0 - 0.3 * i + noise_m();
    SendScanOf(i, north_m, kFrame, noise_m());
    if (alerts_.empty() || alerts_.back().alerts.empty()) {
      ASSERT_TRUE(ids.empty()) << i << ": it is gone";
      continue;
    }
    ASSERT_EQ(alerts_.back().num_alerts, 1) << i;
    const auto& alert = alerts_.back().alerts[0];
    ids.insert(alert.id);
    EXPECT_EQ(alert.state, alert_t::STATE_ACTIVE) << i;
    EXPECT_GE(alert.level, level) << i;
    level = alert.level;
    ++num_scans_with;
  }
  EXPECT_EQ(ids.size(), 1U);
  EXPECT_EQ(level, alert_t::LEVEL_WARNING);
  EXPECT_GT(num_scans_with, 60);
}

TEST_F(RelativeToTheBoat, AThingThatKeepsItsPlaceBesideTheBoatIsATrack) {
  for (int i = 0; i < 40; ++i) SendScanOf(i, 30.0, kFrame);
  ASSERT_EQ(tracks_.back().num_tracks, 1);
  EXPECT_EQ(tracks_.back().tracks[0].status, track_t::STATUS_CONFIRMED);
  EXPECT_EQ(Told(alert_t::STATE_ACTIVE), nullptr);
}

class ANewFrame : public RelativeToTheBoat, public ::testing::WithParamInterface<std::pair<double, double>> {};

// The axes of two frames differ: another thing may lie where the acknowledged one would be.
TEST_P(ANewFrame, TakesNoAcknowledgementOver) {
  const auto& [before, after] = GetParam();
  const int first = AcknowledgeTheWarning(before);
  ASSERT_GT(first, 0);
  const auto id = Told(alert_t::STATE_ACKNOWLEDGED)->id;
  bool is_asked_again = false;
  for (int i = first; i < first + 80; ++i) {
    SendScanOf(i, 60.0 - 0.3 * i, after);
    for (const auto& alert : alerts_.back().alerts) is_asked_again = is_asked_again || (alert.id != id && alert.state == alert_t::STATE_ACTIVE);
    for (const auto& acknowledged : alerts_.back().acknowledged) EXPECT_NE(acknowledged.source, "tracker") << i;
  }
  EXPECT_EQ(Count("restarts_by_datum"), 1);
  EXPECT_TRUE(is_asked_again);
}

INSTANTIATE_TEST_SUITE_P(RelativeToTheBoat, ANewFrame,
                         ::testing::Values(std::pair(1.8e12, kNan), std::pair(kNan, 1.8e12), std::pair(1.8e12, 1.9e12)));

}  // namespace
}  // namespace lookout::tracker
