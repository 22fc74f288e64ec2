#include "services/tracker/service.hpp"

#include <gtest/gtest.h>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "common/bus/decode.hpp"
#include "tests/support/memory_bus.hpp"
#include "tests/unit/tracker_shell/messages.hpp"
#include "tests/unit/tracker_shell/service_fixture.hpp"
#include "tests/unit/tracker_shell/still_boat_fixture.hpp"

namespace lookout::tracker {
namespace {

using std::chrono::milliseconds;

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
  const Service service(bus, test::MakeParams(), RunContext{.sources = {.has_beams = false, .has_labels = false}, .script = {}});
  int num_unknown = 0;
  bus::Subscribe<tracks_t>(bus, bus::kTracks, [&](const tracks_t& message) { num_unknown += message.sight == tracks_t::SIGHT_UNKNOWN ? 1 : 0; });
  for (int i = 0; i < 30; ++i) bus::Publish(bus, bus::kPose, test::MakePose(20'000 * i, i));
  for (int i = 0; i < 5; ++i) bus::Publish(bus, bus::kObstacles, test::MakeObstacles(test::kScanUs * i, i, {}));
  support::HandleAll(bus);
  EXPECT_EQ(num_unknown, 5);
}

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
