#include "services/tracker/service.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/bus/memory_bus.hpp"
#include "tests/unit/tracker_shell/messages.hpp"
#include "tests/unit/tracker_shell/service_fixture.hpp"

namespace lookout::tracker {
namespace {

using std::chrono::milliseconds;

class TrackerService : public test::ServiceFixture {
 protected:
  // A boat that lies still.
  void SendPoses(std::int64_t first_us, std::int64_t last_us, std::int64_t first_seq = 0) {
    for (auto offset_us = first_us; offset_us <= last_us; offset_us += 20'000) Send(bus::kPose, test::MakePose(offset_us, first_seq++));
  }
  // One thing, 20 m to the north, and so far to the east.
  static obstacles_t Obstacles(std::int64_t number, std::int64_t seq, double east_m = 0.0) {
    const auto offset_us = test::kScanUs * number;
    return test::MakeObstacles(offset_us, seq, {test::MakeObstacle(1, test::kStartUs + offset_us + 50'000, {east_m, 20.0})});
  }
  void SendScan(std::int64_t number, std::int64_t seq) {
    SendSight(number, seq);
    Send(bus::kObstacles, Obstacles(number, seq));
  }
};

TEST_F(TrackerService, SendsTracksAndAlertsOfEachScan) {
  SendPoses(0, 1'000'000);
  for (int i = 0; i < 8; ++i) SendScan(i, i);
  ASSERT_EQ(tracks_.size(), 8U);
  ASSERT_EQ(alerts_.size(), 8U);
  for (int i = 0; i < 8; ++i) {
    const auto expected = Obstacles(i, i);
    for (const auto& [utime_us, seq, raw_seq, end_utime_us, begin_seq, begin_utime_us] :
         {std::tuple(tracks_[i].utime_us, tracks_[i].seq, tracks_[i].raw_seq, tracks_[i].end_utime_us, tracks_[i].begin_seq,
                     tracks_[i].begin_utime_us),
          std::tuple(alerts_[i].utime_us, alerts_[i].seq, alerts_[i].raw_seq, alerts_[i].end_utime_us, alerts_[i].begin_seq,
                     alerts_[i].begin_utime_us)}) {
      EXPECT_EQ(utime_us, expected.utime_us);
      EXPECT_EQ(seq, i);
      EXPECT_EQ(raw_seq, expected.raw_seq);
      EXPECT_EQ(end_utime_us, expected.end_utime_us);
      EXPECT_EQ(begin_seq, 0);
      EXPECT_EQ(begin_utime_us, test::kStartUs);
    }
    EXPECT_EQ(tracks_[i].sight, tracks_t::SIGHT_KNOWN);
    EXPECT_EQ(tracks_[i].scan_flags, 0);
    EXPECT_EQ(tracks_[i].datum_latitude_deg, 43.7);
  }
  const auto& last = tracks_.back();
  ASSERT_EQ(last.num_tracks, 1);
  EXPECT_NEAR(last.tracks[0].position_map_m[1], 20.0, 1.0);
  EXPECT_NEAR(last.tracks[0].latitude_deg, 43.7 + 20.0 / 111'110.0, 1e-5);
  EXPECT_EQ(last.tracks[0].segment_ids, (std::vector<std::int32_t>{1}));
}

// Cell k is of segment k and piece k + 10: the last is 29. A scan without SEGMENTS has no pieces.
TEST_F(TrackerService, SaysWhatEachPieceIsOf) {
  SendPoses(0, 1'000'000);
  for (int i = 0; i < 6; ++i) {
    Send(bus::kLidarScan, test::MakeScan(test::kScanUs * i, i));
    auto segments = test::MakeSegments(test::kScanUs * i, i);
    for (const auto label : segments.label) {
      if (label > 0) segments.piece.push_back(static_cast<std::int16_t>(label + 10));
    }
    segments.num_labelled = messages::CountOf(segments.piece);
    if (i != 4) Send(bus::kSegments, segments);
    Send(bus::kObstacles, Obstacles(i, i));
  }
  ASSERT_EQ(tracks_.size(), 6U);
  for (const std::size_t i : {3U, 5U}) {
    EXPECT_EQ(tracks_[i].first_piece, 1);
    EXPECT_GE(tracks_[i].num_pieces, 11);
    EXPECT_LE(tracks_[i].num_pieces, 29);
  }
  EXPECT_EQ(tracks_[4].num_pieces, 0);
}

TEST_F(TrackerService, ReportsEachCounterOnceAndHowMuchItFollows) {
  SendPoses(0, 1'000'000);
  for (int i = 0; i < 8; ++i) SendScan(i, i);
  std::set<std::string> names;
  for (const auto& counter : service_.Report().counters) EXPECT_TRUE(names.emplace(counter.name).second) << counter.name;
  for (const auto* name : {"tracks", "tracks_confirmed", "clutter_per_scan", "alerts"}) EXPECT_TRUE(names.contains(name)) << name;
  EXPECT_EQ(Count("tracks"), 1);
}

TEST_F(TrackerService, WaitsForPoseForTheBeamsAndForTheLabels) {
  SendPoses(0, 80'000);
  Send(bus::kObstacles, Obstacles(0, 0));
  EXPECT_EQ(service_.num_waiting(), 1);
  Send(bus::kSegments, test::MakeSegments(0, 0));
  Send(bus::kPose, test::MakePose(100'000, 5));
  EXPECT_EQ(tracks_.size(), 0U);
  Send(bus::kLidarScan, test::MakeScan(0, 0));
  EXPECT_EQ(tracks_.size(), 1U);
  EXPECT_EQ(service_.num_waiting(), 0);
}

TEST_F(TrackerService, GoesOnWithoutWhatCannotComeAnyMore) {
  SendPoses(0, 1'000'000);
  SendScan(0, 0);
  Send(bus::kObstacles, Obstacles(1, 1));
  Send(bus::kSegments, test::MakeSegments(test::kScanUs, 1));
  EXPECT_EQ(tracks_.size(), 1U);
  SendSight(2, 2);
  ASSERT_EQ(tracks_.size(), 2U) << "the beams of a later scan have come";
  EXPECT_EQ(tracks_[1].sight, tracks_t::SIGHT_UNKNOWN);
  Send(bus::kObstacles, Obstacles(2, 2));
  EXPECT_EQ(tracks_.at(2).sight, tracks_t::SIGHT_KNOWN);
  EXPECT_EQ(Count("scans_without_sight"), 1);
}

// Else the replay, which has all of it, would know more of the first scans than the live run did.
TEST_F(TrackerService, BeginsWithTheFirstScanOfWhichItHeardEverything) {
  SendPoses(140'000, 1'000'000, 7);
  Send(bus::kObstacles, Obstacles(1, 41));  // POSE begins within it
  Send(bus::kSegments, test::MakeSegments(2 * test::kScanUs, 42));
  Send(bus::kObstacles, Obstacles(2, 42));
  SendScan(3, 43);  // of 42 the beams have been before
  SendScan(4, 44);
  ASSERT_EQ(tracks_.size(), 2U);
  EXPECT_EQ(tracks_[0].seq, 43);
  for (const auto& message : tracks_) EXPECT_EQ(message.begin_seq, 43);
  for (const auto& message : alerts_) EXPECT_EQ(message.begin_utime_us, test::kStartUs + 3 * test::kScanUs);
  EXPECT_EQ(Count("scans_before_begin"), 2);
}

TEST_F(TrackerService, UsesWhatIsThereOfAScanThatLostAPart) {
  SendPoses(0, 1'000'000);
  SendScan(0, 0);
  SendSight(1, 1);
  auto half = Obstacles(1, 1);
  half.num_parts = 2;
  Send(bus::kObstacles, half);
  EXPECT_EQ(tracks_.size(), 1U);
  SendScan(2, 2);
  ASSERT_EQ(tracks_.size(), 3U);
  EXPECT_EQ(tracks_[1].seq, 1);
  EXPECT_EQ(tracks_[1].scan_flags, lidar_scan_t::FLAG_HOLE);
  EXPECT_EQ(tracks_[1].sight, tracks_t::SIGHT_UNKNOWN) << "what stood in the lost part was not missed";
  EXPECT_EQ(tracks_[2].sight, tracks_t::SIGHT_KNOWN);
  EXPECT_EQ(Count("scans_incomplete"), 1);
}

TEST_F(TrackerService, LeavesOutScansThatCameTwiceOrTooLate) {
  SendPoses(0, 1'000'000);
  for (const int i : {0, 1, 1, 3, 2, 4}) SendScan(i, i);
  std::vector<std::int64_t> seqs;
  for (const auto& message : tracks_) seqs.push_back(message.seq);
  EXPECT_EQ(seqs, (std::vector<std::int64_t>{0, 1, 3, 4}));
  EXPECT_EQ(Count("scans_doubled"), 1);
  EXPECT_EQ(Count("scans_late"), 1);
  EXPECT_EQ(Count("runs_begun"), 0);
}

TEST_F(TrackerService, ForgetsItsTracksButNotTheirIdsWhenTheLidarBeginsAnew) {
  SendPoses(0, 3'000'000);
  for (int i = 0; i < 5; ++i) SendScan(i, 100 + i);
  ASSERT_EQ(tracks_.back().num_tracks, 1);
  const auto id = tracks_.back().tracks[0].id;
  for (int i = 0; i < 8; ++i) SendScan(7 + i, i);
  ASSERT_EQ(tracks_.back().num_tracks, 1);
  EXPECT_GT(tracks_.back().tracks[0].id, id);
  EXPECT_EQ(tracks_.back().begin_seq, 100) << "the process is the same";
  EXPECT_EQ(Count("runs_begun"), 1);
}

// By the time of its first pose: that behind the last of the one before, or, of a process that is back within a period of POSE, that one once more.
class ANavigatorThatBeginsAnew : public TrackerService, public ::testing::WithParamInterface<std::int64_t> {};

TEST_P(ANavigatorThatBeginsAnew, MakesTheTrackerForgetItsTracks) {
  const auto last_us = 580'000;
  SendPoses(0, last_us, 200);
  for (int i = 0; i < 5; ++i) SendScan(i, i);
  const auto id = tracks_.back().tracks.at(0).id;
  SendPoses(GetParam(), 3'000'000);
  for (int i = 5; i < 15; ++i) SendScan(i, i);
  EXPECT_EQ(tracks_.size(), 15U);
  EXPECT_GT(tracks_.back().tracks.at(0).id, id);
  EXPECT_EQ(Count("poses_duplicate"), GetParam() == last_us ? 1 : 0);
  EXPECT_EQ(Count("runs_begun"), 1);
}

INSTANTIATE_TEST_SUITE_P(TrackerService, ANavigatorThatBeginsAnew, ::testing::Values(600'000, 580'000));

TEST_F(TrackerService, GoesOnInThePast) {
  SendPoses(10'000'000, 11'000'000, 500);
  for (int i = 100; i < 105; ++i) SendScan(i, i);
  EXPECT_EQ(tracks_.size(), 5U);
  SendPoses(0, 1'000'000);
  for (int i = 0; i < 5; ++i) SendScan(i, i);
  ASSERT_EQ(tracks_.size(), 10U);
  EXPECT_EQ(tracks_.back().sight, tracks_t::SIGHT_KNOWN);
  EXPECT_EQ(tracks_.back().begin_seq, 100);
  EXPECT_EQ(Count("pose_restarts"), 1);
  EXPECT_EQ(Count("runs_begun"), 1);
}

TEST_F(TrackerService, TracksNothingWithoutAPlaceOrACovariance) {
  SendPoses(0, 1'000'000);
  for (int i = 0; i < 5; ++i) {
    SendSight(i, i);
    auto message = test::InTheVesselFrame(Obstacles(i, i));
    message.obstacles.push_back(test::MakeObstacle(2, message.utime_us, {50.0, 50.0}));
    for (auto& number : message.obstacles[1].covariance_relative_m2) number = kNan;
    message.num_obstacles = 2;
    Send(bus::kObstacles, message);
  }
  ASSERT_EQ(tracks_.size(), 5U);
  for (const auto& message : tracks_) EXPECT_EQ(message.num_scan_tracks, 0);
  EXPECT_EQ(Count("obstacles_not_placed"), 5);
  EXPECT_EQ(Count("obstacles_without_covariance"), 5);
}

TEST_F(TrackerService, SplitsTracksThatDoNotFitIntoOneMessage) {
  SendPoses(0, 1'000'000);
  constexpr int kNumThings = 1000;
  for (int i = 0; i < 5; ++i) {
    SendSight(i, i);
    const auto offset_us = test::kScanUs * i;
    constexpr int kNumParts = 4;
    for (int part = 0; part < kNumParts; ++part) {
      std::vector<obstacle_t> obstacles;
      for (int k = part * kNumThings / kNumParts; k < (part + 1) * kNumThings / kNumParts; ++k) {
        obstacles.push_back(test::MakeObstacle(k + 1, test::kStartUs + offset_us, {10.0 * (k % 40), 10.0 * static_cast<double>(k) / 40.0}));
      }
      auto message = test::MakeObstacles(offset_us, i, std::move(obstacles));
      message.part_index = part;
      message.num_parts = kNumParts;
      Send(bus::kObstacles, message);
    }
  }
  const auto& last = tracks_.back();
  ASSERT_GT(last.num_parts, 1);
  std::int32_t num_tracks = 0;
  std::int64_t last_id = 0;
  for (auto message = tracks_.end() - last.num_parts; message != tracks_.end(); ++message) {
    EXPECT_EQ(message->part_index, message - (tracks_.end() - last.num_parts));
    EXPECT_EQ(message->num_scan_tracks, last.num_scan_tracks);
    EXPECT_LE(message->getEncodedSize(), bus::kMaxMessageBytes);
    num_tracks += message->num_tracks;
    for (const auto& track : message->tracks) EXPECT_GT(track.id, std::exchange(last_id, track.id));
  }
  EXPECT_EQ(num_tracks, last.num_scan_tracks);
  EXPECT_GT(num_tracks, 500);
}

// Of obstacles from elsewhere.
TEST(TrackerServiceWithoutALidar, UsesEachScanAsSoonAsPoseIsThere) {
  bus::MemoryBus bus;
  const Service service(bus, test::MakeParams(), Given{.sources = {.has_beams = false, .has_labels = false}, .script = {}});
  int num_unknown = 0;
  bus::Subscribe<tracks_t>(bus, bus::kTracks, [&](const tracks_t& message) { num_unknown += message.sight == tracks_t::SIGHT_UNKNOWN ? 1 : 0; });
  for (int i = 0; i < 30; ++i) bus::Publish(bus, bus::kPose, test::MakePose(20'000 * i, i));
  for (int i = 0; i < 5; ++i) bus::Publish(bus, bus::kObstacles, test::MakeObstacles(test::kScanUs * i, i, {}));
  while (bus.HandleOnce()) {
  }
  EXPECT_EQ(num_unknown, 5);
}

Utime Host(milliseconds time) { return Utime(std::chrono::microseconds(1'000'000'000'000'000)) + time; }

TEST_F(TrackerService, GivesUpAWaitByTheHostsClock) {
  SendPoses(0, 1'000'000);
  SendScan(0, 0);
  service_.AdvanceTo(Host(milliseconds(0)));
  Send(bus::kObstacles, Obstacles(1, 1));
  service_.AdvanceTo(Host(milliseconds(490)));
  HandleAll();
  EXPECT_EQ(tracks_.size(), 1U);
  service_.AdvanceTo(Host(milliseconds(510)));
  HandleAll();
  ASSERT_EQ(tracks_.size(), 2U);
  EXPECT_EQ(tracks_[1].sight, tracks_t::SIGHT_UNKNOWN);
  EXPECT_EQ(Count("scans_timed_out"), 1);
  EXPECT_NE(service_.Report().reason.find("do not come with OBSTACLES"), std::string::npos) << service_.Report().reason;
}

TEST_F(TrackerService, SaysWhichInputsAreSilent) {
  service_.AdvanceTo(Host(milliseconds(0)));
  service_.AdvanceTo(Host(milliseconds(1500)));
  SendSight(0, 0);
  service_.AdvanceTo(Host(milliseconds(2000)));
  EXPECT_TRUE(service_.Report().reason.ends_with("no OBSTACLES for 2 s; no POSE for 2 s")) << service_.Report().reason;
}

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
  const auto handle_all = [&bus] {
    while (bus.HandleOnce()) {
    }
  };
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
    while (bus.HandleOnce()) {
    }
    service.AdvanceTo(Host(milliseconds(1010 + 100 * i)));
    while (bus.HandleOnce()) {
    }
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

TEST_F(TrackerService, NeverDiesOfBytes) {
  std::mt19937 random(1);
  const std::vector<std::pair<const bus::Channel*, std::vector<std::uint8_t>>> good{{&bus::kObstacles, bus::Encode(Obstacles(1, 1))},
                                                                                    {&bus::kLidarScan, bus::Encode(test::MakeScan(100'000, 1))},
                                                                                    {&bus::kSegments, bus::Encode(test::MakeSegments(100'000, 1))},
                                                                                    {&bus::kPose, bus::Encode(test::MakePose(100'000, 1))},
                                                                                    {&bus::kAlertAck, bus::Encode(alert_ack_t{})}};
  for (int i = 0; i < 20'000; ++i) {
    const auto& [channel, bytes] = good[static_cast<std::size_t>(i) % good.size()];
    auto spoiled = bytes;
    for (int k = 0; k < 3; ++k) spoiled[8 + random() % (spoiled.size() - 8)] = static_cast<std::uint8_t>(random());
    bus_.Publish(*channel, spoiled);
    HandleAll();
    if (i % 100 == 0) service_.AdvanceTo(Host(milliseconds(i)));
  }
  service_.Finish();
  HandleAll();
  EXPECT_GT(Count("obstacles_refused_time"), 100);
}

}  // namespace
}  // namespace lookout::tracker
