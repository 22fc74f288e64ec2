#include "services/plotter/service.hpp"

#include <gtest/gtest.h>

#include "services/plotter/core/nmea0183.hpp"
#include "tests/unit/plotter/fixture.hpp"

namespace lookout::plotter {
namespace {

class PlotterService : public test::ServiceFixture {};

TEST_F(PlotterService, SendsTheOwnShipAndTargets) {
  tracks_ = {MakeTrack(17)};
  Run(5'000'000);
  EXPECT_GE(nmea_->With("IIRMC").size(), 5U);
  EXPECT_EQ(nmea_->With("RATTM,00,").size(), 2U);  // at once and after 2.5 s
  EXPECT_GE(nmea_->With("RAOSD").size(), 5U);
  EXPECT_EQ(signal_k_->With("targets.lidar:gannet-1").size(), 5U);
  EXPECT_EQ(n2k_->With(" 1F608 ").size(), 2U);
  EXPECT_EQ(n2k_->With(" 1F801 ").size(), n2k_->With(" 1F802 ").size());
  EXPECT_EQ(service_->Report().state, HealthState::kOk) << service_->Report().reason;
}

TEST_F(PlotterService, SendsANewTargetWithItsTracks) {
  Run(1'000'000);
  Clear();
  tracks_ = {MakeTrack(17)};
  Wait(20'000);
  SendTracks(Tracks());
  EXPECT_EQ(nmea_->With("RATTM").size(), 1U);
  EXPECT_EQ(signal_k_->With("targets.").size(), 1U);
}

TEST_F(PlotterService, SendsAnOwnPositionOfNowBeforeTargets) {
  Run(1'000'000);
  Clear();
  tracks_ = {MakeTrack(17)};
  Run(100'000);
  std::size_t rmc = 0;
  for (std::size_t i = 0; i < nmea_->sent.size(); ++i) {
    if (nmea_->sent[i].starts_with("$IIRMC")) rmc = i + 1;
    if (nmea_->sent[i].starts_with("$RATTM")) {
      EXPECT_GT(rmc, 0U);
      EXPECT_EQ(nmea_->sent[rmc - 1].substr(7, 9), nmea_->sent[i].substr(nmea_->sent[i].size() - 16, 9));  // the same time
    }
  }
}

TEST_F(PlotterService, TellsALostTargetOnce) {
  tracks_ = {MakeTrack(17), MakeTrack(18)};
  Run(1'000'000);
  Clear();
  tracks_[0].status = track_t::STATUS_LOST;
  Run(100'000);
  tracks_.erase(tracks_.begin());
  Run(8'000'000);
  EXPECT_EQ(nmea_->With(",L,").size(), 1U);
  EXPECT_EQ(nmea_->With("RATTM,00,").size(), 1U);
  EXPECT_EQ(nmea_->With("RATTM,01,").size(), 3U);
  ASSERT_EQ(signal_k_->With("gannet-1").size(), 1U);
  EXPECT_NE(signal_k_->With("gannet-1")[0].find(R"("navigation.position","value":null)"), std::string::npos);
}

TEST_F(PlotterService, SendsTentativeTracksOnlyWhereAsked) {
  tracks_ = {MakeTrack(17, track_t::STATUS_TENTATIVE)};
  Run(1'000'000);
  EXPECT_TRUE(nmea_->With("TTM").empty());
  params_.takes_tentative = true;
  Start();
  Run(1'000'000);
  EXPECT_EQ(nmea_->With(",Q,").size(), 1U);
}

TEST_F(PlotterService, StopsWhenNobodyLooks) {
  tracks_ = {MakeTrack(17)};
  Run(3'000'000);
  Clear();
  // TRACKS and POSE go on, ALERTS do not.
  for (int i = 0; i < 50; ++i) {
    Wait(100'000);
    SendPose();
    SendTracks(Tracks());
  }
  EXPECT_EQ(nmea_->With("TTM").size(), 0U);
  EXPECT_EQ(nmea_->With("RAALR").size(), 1U);
  EXPECT_EQ(nmea_->With(",998,A,V,no look-out").size(), 1U);
  const auto words = signal_k_->With("no look-out");
  ASSERT_EQ(words.size(), 1U);
  EXPECT_NE(words[0].find("\"alarm\""), std::string::npos);
  EXPECT_NE(signal_k_->With("gannet-1").back().find(R"("navigation.position","value":null)"), std::string::npos);
  EXPECT_GE(nmea_->With("RMC").size(), 4U);
  EXPECT_NE(service_->Report().reason.find("no ALERTS for 5 s"), std::string::npos) << service_->Report().reason;
  EXPECT_EQ(Count("times_unwatched"), 1);

  Clear();
  Run(200'000);
  EXPECT_EQ(nmea_->With("TTM").size(), 1U);
  EXPECT_EQ(nmea_->With(",998,V,A,").size(), 1U);
  EXPECT_EQ(signal_k_->With("\"normal\"").size(), 1U);
  EXPECT_EQ(service_->Report().state, HealthState::kOk) << service_->Report().reason;
}

// What the tracker said last is old, but it was not taken back either.
TEST_F(PlotterService, NeitherRepeatsNorClearsAlertsOfASilentTracker) {
  alerts_ = {MakeAlert(3)};
  Run(1'000'000);
  Clear();
  Wait(30'000'000);
  EXPECT_TRUE(nmea_->With(",003,").empty());
  EXPECT_TRUE(signal_k_->With("closestApproach3").empty());
  alerts_.clear();
  Run(200'000);
  EXPECT_EQ(nmea_->With(",003,V,A,").size(), 1U);
}

TEST_F(PlotterService, StopsWithoutAPosition) {
  tracks_ = {MakeTrack(17)};
  Run(1'000'000);
  Clear();
  pose_status_ = pose_t::STATUS_UNKNOWN;
  Run(3'000'000);
  EXPECT_TRUE(nmea_->With("TTM").empty());
  EXPECT_EQ(nmea_->With("RMC").size(), nmea_->With(",V,,,,,,,").size());
  EXPECT_EQ(nmea_->With("no own position").size(), 1U);
  EXPECT_EQ(service_->Report().reason, "the own position is not known: no targets are sent");
  for (const auto& own : signal_k_->With("headingTrue")) EXPECT_NE(own.find(R"("navigation.position","value":null)"), std::string::npos);
}

TEST_F(PlotterService, StopsWhenPoseIsSilent) {
  tracks_ = {MakeTrack(17)};
  Run(1'000'000);
  for (int i = 0; i < 12; ++i) {
    Wait(100'000);
    SendTracks(Tracks());
    SendAlerts();
  }
  Clear();
  for (int i = 0; i < 50; ++i) {
    Wait(100'000);
    SendTracks(Tracks());
    SendAlerts();
  }
  EXPECT_TRUE(nmea_->With("TTM").empty());
  EXPECT_TRUE(nmea_->With("RMC").empty());
  EXPECT_NE(service_->Report().reason.find("no POSE for 6 s: neither own ship nor targets are sent"), std::string::npos) << service_->Report().reason;
}

TEST_F(PlotterService, TellsOfNoTracks) {
  Run(500'000);
  for (int i = 0; i < 30; ++i) {
    Wait(100'000);
    SendPose();
    SendAlerts();
  }
  EXPECT_EQ(service_->Report().reason, "no TRACKS for 3 s: no targets are sent");
}

TEST_F(PlotterService, EndsTheTargetsOfATrackerThatWasRestarted) {
  tracks_ = {MakeTrack(17)};
  Run(1'000'000);
  Clear();
  begin_us_ += 5'000'000;
  Run(100'000);
  EXPECT_EQ(nmea_->With("RATTM,00,").size(), 1U);
  EXPECT_EQ(nmea_->With(",L,").size(), 1U);
  EXPECT_EQ(nmea_->With("RATTM,01,").size(), 1U);
  EXPECT_EQ(Count("runs_begun"), 1);
}

TEST_F(PlotterService, SendsAllToANewReceiver) {
  tracks_ = {MakeTrack(17)};
  alerts_ = {MakeAlert(3)};
  Run(3'000'000);
  Clear();
  ++nmea_->openings;
  ++signal_k_->openings;
  Run(100'000);
  EXPECT_EQ(nmea_->With("RATTM").size(), 1U);
  EXPECT_EQ(nmea_->With("RAALR").size(), 1U);
  EXPECT_EQ(signal_k_->With("closestApproach3").size(), 1U);
  EXPECT_EQ(signal_k_->With("\"subscribe\"").size(), 1U);
}

TEST_F(PlotterService, GetsRoundAllTargetsWhereThereIsLittleRoom) {
  for (int id = 1; id <= 60; ++id) tracks_.push_back(MakeTrack(id));
  alerts_ = {MakeAlert(3)};  // of track 17
  std::set<std::string> numbers;
  int num_dangerous = 0;
  for (int i = 0; i < 250; ++i) {
    nmea_->room = std::min<std::size_t>(nmea_->room + 48, 240);  // 4800 baud
    Run(100'000);
    for (const auto& line : nmea_->With("RATTM")) {
      numbers.insert(line.substr(7, 2));
      num_dangerous += line.find(",boat 17,") != std::string::npos ? 1 : 0;
    }
    Clear();
  }
  EXPECT_EQ(numbers.size(), 60U);
  EXPECT_GE(num_dangerous, 8);  // of 10 in 25 s
}

TEST_F(PlotterService, KeepsAlertsForWhenThereIsRoom) {
  nmea_->room = 10;
  alerts_ = {MakeAlert(3)};
  Run(300'000);
  EXPECT_TRUE(nmea_->sent.empty());
  nmea_->room = 300;
  Run(100'000);
  ASSERT_FALSE(nmea_->sent.empty());
  EXPECT_TRUE(nmea_->sent.front().starts_with("$RAALR")) << nmea_->sent.front();
}

TEST_F(PlotterService, HasRoomForTargetsBesideManyAlerts) {
  tracks_ = {MakeTrack(17)};
  for (int id = 1; id <= 60; ++id) alerts_.push_back(MakeAlert(id));
  std::set<std::string> told;
  int num_targets = 0;
  int num_own = 0;
  for (int i = 0; i < 600; ++i) {
    nmea_->room = std::min<std::size_t>(nmea_->room + 48, 256);  // 4800 baud
    Run(100'000);
    for (const auto& line : nmea_->With("RAALR")) told.insert(line.substr(17, 3));
    num_targets += static_cast<int>(nmea_->With("RATTM").size());
    num_own += static_cast<int>(nmea_->With("IIRMC").size());
    Clear();
  }
  EXPECT_EQ(told.size(), 60U);
  EXPECT_GE(num_targets, 15);  // of 24 in a minute
  EXPECT_GE(num_own, 30);
}

TEST_F(PlotterService, SaysThatThePositionIsOnlyPropagated) {
  tracks_ = {MakeTrack(17)};
  Run(1'000'000);
  Clear();
  pose_status_ = pose_t::STATUS_COASTING;
  Run(3'000'000);
  EXPECT_FALSE(nmea_->With("RMC").empty());
  EXPECT_EQ(nmea_->With("RMC").size(), nmea_->With(",,,E*").size());
  EXPECT_TRUE(nmea_->With("HDT").empty());
  EXPECT_TRUE(signal_k_->With("headingTrue").empty());
  EXPECT_FALSE(nmea_->With("TTM").empty());
}

// Course over ground that stood in for a heading went out as HDT, as if a compass said it.
TEST_F(PlotterService, TellsNoHeadingThatIsOnlyTheCourse) {
  heading_source_ = pose_t::HEADING_COURSE;
  tracks_ = {MakeTrack(17)};
  Run(3'000'000);
  EXPECT_TRUE(nmea_->With("HDT").empty());
  for (const auto& own : signal_k_->With("headingTrue")) EXPECT_NE(own.find(R"("navigation.headingTrue","value":null)"), std::string::npos) << own;
  EXPECT_FALSE(nmea_->With("RMC").empty());
  EXPECT_FALSE(nmea_->With("TTM").empty());
}

// The boat may have other sources of its position.
TEST_F(PlotterService, TakesItsPositionInSignalKBackOnce) {
  Run(2'000'000);
  Clear();
  pose_status_ = pose_t::STATUS_UNKNOWN;
  Run(5'000'000);
  EXPECT_EQ(signal_k_->With("headingTrue").size(), 1U);
}

TEST_F(PlotterService, EndsTargetsOfAServerThatWasAwayWhenTheLookOutFailed) {
  tracks_ = {MakeTrack(17)};
  Run(1'000'000);
  signal_k_->is_there = false;
  Wait(5'000'000);  // nobody looks
  Clear();
  signal_k_->is_there = true;
  ++signal_k_->openings;
  Wait(500'000);
  ASSERT_EQ(signal_k_->With("gannet-1").size(), 1U);
  EXPECT_NE(signal_k_->With("gannet-1")[0].find(R"("navigation.position","value":null)"), std::string::npos);
}

TEST_F(PlotterService, TellsNoTargetThatEndedWhileNobodyListened) {
  tracks_ = {MakeTrack(17)};
  Run(1'000'000);
  nmea_->is_there = false;
  tracks_.clear();
  Run(90'000'000);
  tracks_ = {MakeTrack(18)};
  Clear();
  nmea_->is_there = true;
  ++nmea_->openings;
  Run(1'000'000);
  EXPECT_TRUE(nmea_->With(",L,").empty());
  EXPECT_EQ(nmea_->With("RATTM").size(), 1U);
}

TEST_F(PlotterService, SendsAllAnewAtMostEveryTwoSeconds) {
  tracks_ = {MakeTrack(17)};
  Run(1'000'000);
  Clear();
  for (int i = 0; i < 40; ++i) {
    ++nmea_->openings;
    Run(100'000);
  }
  EXPECT_LE(nmea_->With("RATTM").size(), 4U);
}

TEST_F(PlotterService, TakesNothingForNewThatWasHeldUp) {
  tracks_ = {MakeTrack(17)};
  Run(3'000'000);
  host_us_ += 20'000'000;  // the process was stopped
  service_->AdvanceTo(Now());
  Wait(200'000);
  EXPECT_NE(service_->Report().reason.find("no ALERTS for 1 s"), std::string::npos) << service_->Report().reason;
  Clear();
  // The same POSE and TRACKS again are not of now either.
  const auto tracks = Tracks();
  SendPose();
  SendAlerts();
  SendTracks(tracks);
  EXPECT_EQ(service_->Report().state, HealthState::kOk) << service_->Report().reason;
  Wait(1'500'000);
  SendTracks(tracks);
  SendAlerts();
  EXPECT_NE(service_->Report().reason.find("no TRACKS for 1 s"), std::string::npos) << service_->Report().reason;
}

TEST_F(PlotterService, EndsTargetsWhenItEndsInOrder) {
  tracks_ = {MakeTrack(17)};
  Run(1'000'000);
  Clear();
  service_->Finish();
  EXPECT_EQ(nmea_->With("RATTM,00,").size(), 1U);
  EXPECT_EQ(nmea_->With(",L,").size(), 1U);
  EXPECT_EQ(signal_k_->With("gannet-1").size(), 1U);
}

TEST_F(PlotterService, RefusesWhatCannotBe) {
  Run(300'000);
  Clear();
  auto message = Tracks();
  const auto refused = [&](auto change, const char* counter) {
    tracks_ = {MakeTrack(17), MakeTrack(18)};
    message = Tracks();
    change();
    SendTracks(message);
    return Count(counter);
  };
  EXPECT_EQ(refused([&] { message.tracks[0].latitude_deg = kNan; }, "tracks_refused_number"), 1);
  EXPECT_EQ(refused([&] { message.tracks[0].longitude_deg = 180.001; }, "tracks_refused_number"), 2);
  EXPECT_EQ(refused([&] { message.tracks[0].velocity_map_mps[0] = 1e9; }, "tracks_refused_number"), 3);
  EXPECT_EQ(refused([&] { message.tracks[1].id = 17; }, "tracks_refused_id"), 1);
  EXPECT_EQ(refused([&] { message.tracks[0].id = 0; }, "tracks_refused_id"), 2);
  EXPECT_EQ(refused([&] { message.tracks[0].id = -1; }, "tracks_refused_id"), 3);
  EXPECT_EQ(refused([&] { message.tracks[0].id = -2; }, "tracks_refused_id"), 3);  // a tentative one
  EXPECT_EQ(refused([&] { message.tracks[1].status = 9; }, "tracks_refused_code"), 1);
  EXPECT_EQ(refused([&] { message.end_utime_us = INT64_MAX; }, "tracks_refused_time"), 1);
  EXPECT_EQ(refused([&] { message.num_parts = 2'000; }, "tracks_refused_parts"), 1);
  EXPECT_TRUE(nmea_->With("TTM").empty());
  alerts_ = {MakeAlert(3)};
  alerts_[0].state = 7;
  SendAlerts();
  EXPECT_EQ(Count("alerts_refused_code"), 1);
  alerts_ = {MakeAlert(3), MakeAlert(3)};
  SendAlerts();
  alerts_ = {MakeAlert(INT64_MIN)};
  SendAlerts();
  EXPECT_EQ(Count("alerts_refused_id"), 2);
}

TEST_F(PlotterService, WaitsForAllPartsOfTracks) {
  tracks_ = {MakeTrack(17)};
  Run(300'000);
  Clear();
  tracks_ = {MakeTrack(17), MakeTrack(18)};
  Wait(20'000);
  auto first = Tracks();
  auto second = first;
  first.num_parts = second.num_parts = 2;
  first.num_tracks = second.num_tracks = 1;
  first.tracks.pop_back();
  second.tracks.erase(second.tracks.begin());
  second.part_index = 1;
  SendTracks(first);
  EXPECT_TRUE(nmea_->With("TTM").empty());
  SendTracks(second);
  EXPECT_EQ(nmea_->With("boat 18").size(), 1U);
  first.seq = ++scan_seq_;
  first.utime_us += 100'000;
  SendTracks(first);  // its second part is lost
  Run(300'000);
  EXPECT_TRUE(nmea_->With(",L,").empty());
  EXPECT_EQ(Count("tracks_incomplete"), 1);
}

TEST_F(PlotterService, TellsWhenNumbersAreUsedUp) {
  for (int id = 1; id <= 500; ++id) tracks_.push_back(MakeTrack(id));
  Run(1'000'000);
  EXPECT_EQ(nmea_->With("RATTM").size(), 80U);
  EXPECT_EQ(signal_k_->With("targets.").size(), 500U);
  EXPECT_EQ(Count("targets_without_number"), 420);
  EXPECT_NE(service_->Report().reason.find("420 targets without a number"), std::string::npos);
}

TEST_F(PlotterService, NamesAnOutputThatIsAtFault) {
  Run(300'000);
  nmea_->wrong = "connection refused";
  EXPECT_EQ(service_->Report().reason, "output 'nmea': connection refused");
}

TEST_F(PlotterService, KeepsQuietWithoutOutputs) {
  NewBus();
  service_ = std::make_unique<Service>(*bus_, params_, std::vector<std::unique_ptr<Output>>());
  Wait(10'000'000);
  EXPECT_EQ(service_->Report().state, HealthState::kOk);
}

}  // namespace
}  // namespace lookout::plotter
