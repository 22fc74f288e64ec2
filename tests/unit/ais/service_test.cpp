// The process without its shell: what it waits for, what it tells, and that neither the order of channels nor a replay changes it.
#include "services/ais/service.hpp"

#include <functional>
#include <gtest/gtest.h>
#include <numeric>
#include <random>

#include "common/messages/checks.hpp"
#include "tests/support/bus_fixture.hpp"
#include "tests/unit/ais/encoder.hpp"

namespace lookout::ais {
namespace {

using support::CountOf;

constexpr std::int64_t kStartUs = 1'782'900'000'000'000;  // a whole minute of UTC
constexpr std::int64_t kScanUs = 100'000;
const Datum kDatum{54.3, 10.1, 0.0};

nav_raw_t MakeRaw(std::int64_t utime_us, std::int32_t kind, const std::string& sentence = {}) {
  nav_raw_t message{};
  message.utime_us = utime_us;
  message.kind = kind;
  message.source = sentence.empty() ? "" : "udp";
  message.sentence = sentence;
  return message;
}

pose_t MakePose(std::int64_t utime_us) {
  pose_t message{};
  message.utime_us = utime_us;
  message.datum_latitude_deg = kDatum.latitude_deg;
  message.datum_longitude_deg = kDatum.longitude_deg;
  message.latitude_deg = kDatum.latitude_deg;
  message.longitude_deg = kDatum.longitude_deg;
  for (int i = 0; i < 9; ++i) message.covariance[i][i] = 0.01;
  return message;
}

track_t MakeTrack(std::int64_t id, double east_m, double north_m) {
  track_t track{};
  track.id = id;
  track.status = track_t::STATUS_CONFIRMED;
  track.position_map_m[0] = east_m;
  track.position_map_m[1] = north_m;
  for (int i = 0; i < 4; ++i) track.covariance[i][i] = 0.04;
  track.length_m = 9.0F;
  track.width_m = 3.0F;
  track.length_bearing_rad = 0.1F;
  track.seen_share = 0.6F;
  for (const auto& [a, b] : {std::pair(1, 1), std::pair(-1, 1), std::pair(-1, -1), std::pair(1, -1)}) {
    track.outline_east_m.push_back(static_cast<float>(east_m + 1.5 * a));
    track.outline_north_m.push_back(static_cast<float>(north_m + 4.5 * b));
  }
  track.num_outline = messages::CountOf(track.outline_east_m);
  return track;
}

tracks_t MakeTracks(int number, std::vector<track_t> tracks) {
  tracks_t message{};
  message.utime_us = kStartUs + number * kScanUs;
  message.seq = number;
  message.raw_seq = 10 * number;
  message.end_utime_us = message.utime_us + kScanUs;
  message.num_parts = 1;
  message.begin_utime_us = kStartUs;
  message.datum_latitude_deg = kDatum.latitude_deg;
  message.datum_longitude_deg = kDatum.longitude_deg;
  message.tracks = std::move(tracks);
  message.num_tracks = message.num_scan_tracks = messages::CountOf(message.tracks);
  return message;
}

std::string ShipLine(std::uint32_t mmsi, double east_m, double north_m, int second, std::string_view address = "AIVDM") {
  const auto place = kDatum.Map().Reverse({east_m, north_m, 0.0});
  const test::Position position{.latitude_deg = place.latitude_deg,
                                .longitude_deg = place.longitude_deg,
                                .speed_kn = 0.0,
                                .course_deg = 0.0,
                                .second = second,
                                .is_accurate = true};
  return test::Lines(test::ClassA(mmsi, position), address)[0];
}

class AisService : public support::BusTest {
 protected:
  AisService() { Make(bus_); }

  void Make(bus::Bus& bus) {
    Params params;
    params.wait_timeout = std::chrono::seconds(1);
    service_ = std::make_unique<Service>(bus, params);
  }
  // NAV_RAW and POSE to the end of a scan.
  void Navigate(int number, const std::vector<std::string>& lines = {}, std::int32_t status = pose_t::STATUS_OK) {
    auto utime_us = kStartUs + number * kScanUs;
    for (const auto& line : lines) Send(bus::kNavRaw, MakeRaw(++utime_us, nav_raw_t::KIND_SENTENCE, line));
    for (int i = 1; i <= 5; ++i) {
      auto pose = MakePose(kStartUs + number * kScanUs + i * 20'000);
      pose.status = status;
      Send(bus::kPose, pose);
    }
    Send(bus::kNavRaw, MakeRaw(kStartUs + (number + 1) * kScanUs, nav_raw_t::KIND_TICK));
  }

  support::Kept<ais_t> told_{bus_, bus::kAis};
  std::unique_ptr<Service> service_;
};

TEST_F(AisService, WithoutAisNothingIsSaid) {
  for (int i = 0; i < 50; ++i) {
    Navigate(i, {"$GPHDT,1.0,T*00"});
    Send(bus::kTracks, MakeTracks(i, {MakeTrack(1, 10.0, 20.0)}));
  }
  EXPECT_TRUE(told_.empty());
  EXPECT_EQ(service_->Report().state, HealthState::kOk);
  EXPECT_EQ(CountOf(*service_, "scans_released"), 50);
}

TEST_F(AisService, TellsWhichTrackAShipIsOnceAScan) {
  for (int i = 0; i < 100; ++i) {
    std::vector<std::string> lines;
    if (i == 5) lines = test::Lines(test::StaticA(211000001, "EVEREST", "DH1", 36, {5, 4, 1, 2}));
    if (i % 20 == 6) lines.push_back(ShipLine(211000001, 31.0, 41.0, i / 10));
    if (i == 7) lines.push_back(ShipLine(211000099, 0.0, 0.0, 0, "AIVDO"));
    if (i == 8) lines.push_back(ShipLine(211000099, 0.0, 0.0, 0));
    Navigate(i, lines);
    Send(bus::kTracks, MakeTracks(i, {MakeTrack(3, 30.0, 40.0), MakeTrack(8, -60.0, 10.0)}));
  }
  ASSERT_EQ(told_.size(), 95U);  // from the first message of AIS on
  const auto& last = told_.back();
  EXPECT_EQ(last.seq, 94);
  EXPECT_EQ(last.scan_seq, 99);
  EXPECT_EQ(last.utime_us, kStartUs + 99 * kScanUs);
  EXPECT_EQ(last.own_mmsi, 211000099);
  EXPECT_EQ(last.status, std::int32_t{ais_t::STATUS_OK});
  ASSERT_EQ(last.num_ships, 1);
  const auto& ship = last.ships[0];
  EXPECT_EQ(ship.mmsi, 211000001);
  EXPECT_EQ(ship.name, "EVEREST");
  EXPECT_EQ(ship.state, std::int32_t{ais_ship_t::STATE_TRACKED});
  EXPECT_EQ(ship.track_id, 3);
  EXPECT_GT(ship.track_probability, 0.99F);
  EXPECT_NEAR(ship.position_map_m[0], 31.0, 0.2);
  EXPECT_NEAR(ship.range_m, 51.4, 0.3);
  EXPECT_NEAR(ship.bearing_rad, 0.647, 0.01);
  EXPECT_EQ(CountOf(*service_, "ships_tracked"), 1);
}

TEST_F(AisService, AShipThatTheLidarShouldSeeAndDoesNotIsAisOnly) {
  const auto run = [this](int first, const std::vector<track_t>& tracks, double north_m) {
    for (int i = first; i < first + 100; ++i) {
      std::vector<std::string> lines;
      if (i % 10 == 0) lines.push_back(ShipLine(211000001, 0.0, north_m, i / 10 % 60));
      Navigate(i, lines);
      Send(bus::kTracks, MakeTracks(i, tracks));
    }
    return told_.back().ships[0].state;
  };
  EXPECT_EQ(run(0, {}, 40.0), std::int32_t{ais_ship_t::STATE_AIS_ONLY});
  // Behind a wall nobody sees her.
  auto wall = MakeTrack(5, -60.0, 15.0);
  wall.outline_east_m = {-150, 30, 30, -150};
  wall.outline_north_m = {14, 14, 16, 16};
  EXPECT_EQ(run(100, {wall}, 40.0), std::int32_t{ais_ship_t::STATE_NOT_IN_SIGHT});
  // Nor beyond the range.
  EXPECT_EQ(run(200, {}, 80.0), std::int32_t{ais_ship_t::STATE_NOT_IN_SIGHT});
}

TEST_F(AisService, WithoutAPlaceOnTheEarthItSaysWhyNothingIsCompared) {
  for (int i = 0; i < 20; ++i) {
    Send(bus::kNavRaw, MakeRaw(kStartUs + i * kScanUs + 1, nav_raw_t::KIND_SENTENCE, ShipLine(211000001, 31.0, 41.0, 0)));
    for (int k = 1; k <= 5; ++k) {
      auto pose = MakePose(kStartUs + i * kScanUs + k * 20'000);
      pose.status = pose_t::STATUS_RELATIVE;
      pose.datum_latitude_deg = pose.datum_longitude_deg = pose.latitude_deg = pose.longitude_deg = kNan;
      pose.datum_ellipsoid_height_m = 1.7e12;
      Send(bus::kPose, pose);
    }
    Send(bus::kNavRaw, MakeRaw(kStartUs + (i + 1) * kScanUs, nav_raw_t::KIND_TICK));
    auto tracks = MakeTracks(i, {MakeTrack(3, 30.0, 40.0)});
    tracks.datum_latitude_deg = tracks.datum_longitude_deg = kNan;
    tracks.datum_ellipsoid_height_m = 1.7e12;
    Send(bus::kTracks, tracks);
  }
  ASSERT_EQ(told_.size(), 20U);
  EXPECT_EQ(told_.back().status, std::int32_t{ais_t::STATUS_NO_POSITION});
  ASSERT_EQ(told_.back().num_ships, 1);
  EXPECT_EQ(told_.back().ships[0].state, std::int32_t{ais_ship_t::STATE_NOT_IN_SIGHT});
  EXPECT_TRUE(std::isnan(told_.back().ships[0].range_m));
  EXPECT_EQ(service_->Report().reason, "position or heading are not known: no track can be told by AIS");
}

TEST_F(AisService, APairIsToldOnForASecondWithoutAPosition) {
  for (int i = 0; i < 140; ++i) {
    std::vector<std::string> lines;
    if (i % 20 == 6) lines.push_back(ShipLine(211000001, 31.0, 41.0, i / 10));
    const bool has_position = i != 95 && i < 100;
    const std::int32_t status = has_position ? std::int32_t{pose_t::STATUS_OK} : std::int32_t{pose_t::STATUS_NO_POSITION};
    Navigate(i, lines, status);
    // The track is missing in one of the scans without a position.
    Send(bus::kTracks, MakeTracks(i, i == 104 ? std::vector<track_t>{} : std::vector{MakeTrack(3, 30.0, 40.0)}));
  }
  const auto state_of = [this](int number) {
    for (const auto& told : told_) {
      if (told.scan_seq == number) return told.ships.at(0).state;
    }
    return std::int32_t{-1};
  };
  for (const int number : {94, 95, 96, 99, 100, 103, 105, 109}) EXPECT_EQ(state_of(number), std::int32_t{ais_ship_t::STATE_TRACKED}) << number;
  for (const int number : {104, 110, 139}) EXPECT_EQ(state_of(number), std::int32_t{ais_ship_t::STATE_NOT_IN_SIGHT}) << number;
}

TEST_F(AisService, AScanWaitsForSentencesOfBeforeItsEnd) {
  Send(bus::kTracks, MakeTracks(0, {MakeTrack(3, 30.0, 40.0)}));
  for (int i = 1; i <= 5; ++i) Send(bus::kPose, MakePose(kStartUs + i * 20'000));
  Send(bus::kNavRaw, MakeRaw(kStartUs + 99'999, nav_raw_t::KIND_SENTENCE, ShipLine(211000001, 31.0, 41.0, 0)));
  EXPECT_TRUE(told_.empty());
  EXPECT_EQ(service_->num_waiting(), 1);
  // This one arrived at its end: it is of the next.
  Send(bus::kNavRaw, MakeRaw(kStartUs + 100'000, nav_raw_t::KIND_SENTENCE, ShipLine(211000002, 31.0, 41.0, 0)));
  ASSERT_EQ(told_.size(), 1U);
  EXPECT_EQ(told_[0].num_ships, 1);
}

TEST_F(AisService, LiveAWaitEnds) {
  service_->AdvanceTo(Utime(std::chrono::microseconds(kStartUs)));
  Send(bus::kNavRaw, MakeRaw(kStartUs, nav_raw_t::KIND_SENTENCE, ShipLine(211000001, 31.0, 41.0, 0)));
  Send(bus::kTracks, MakeTracks(0, {}));
  service_->AdvanceTo(Utime(std::chrono::microseconds(kStartUs + 900'000)));
  HandleAll();
  EXPECT_TRUE(told_.empty());
  service_->AdvanceTo(Utime(std::chrono::microseconds(kStartUs + 1'100'000)));
  HandleAll();
  ASSERT_EQ(told_.size(), 1U);
  EXPECT_EQ(told_[0].status, std::int32_t{ais_t::STATUS_NO_POSE});
  EXPECT_EQ(CountOf(*service_, "scans_timed_out"), 1);
}

TEST_F(AisService, AStartMarkVoidsWhatWasHeard) {
  Navigate(0, {ShipLine(211000001, 31.0, 41.0, 0)});
  Send(bus::kTracks, MakeTracks(0, {}));
  Send(bus::kNavRaw, MakeRaw(kStartUs + kScanUs, nav_raw_t::KIND_START));
  Navigate(1);
  Send(bus::kTracks, MakeTracks(1, {}));
  EXPECT_EQ(told_.size(), 1U);
  Navigate(2, {ShipLine(211000002, 31.0, 41.0, 0)});
  Send(bus::kTracks, MakeTracks(2, {}));
  ASSERT_EQ(told_.size(), 2U);
  EXPECT_EQ(told_[1].seq, 0);
  ASSERT_EQ(told_[1].num_ships, 1);
  EXPECT_EQ(told_[1].ships[0].mmsi, 211000002);
}

TEST_F(AisService, RefusesTracksThatCannotBe) {
  auto twice = MakeTracks(0, {MakeTrack(3, 0, 0), MakeTrack(3, 0, 0)});
  Send(bus::kTracks, twice);
  auto far = MakeTracks(1, {MakeTrack(3, kNan, 0)});
  Send(bus::kTracks, far);
  auto negative = MakeTracks(2, {MakeTrack(3, 0, 0)});
  negative.tracks[0].covariance[0][0] = -1.0;
  Send(bus::kTracks, negative);
  auto late = MakeTracks(3, {});
  late.end_utime_us = late.utime_us - 1;
  Send(bus::kTracks, late);
  auto part = MakeTracks(4, {});
  part.part_index = 1;
  Send(bus::kTracks, part);
  EXPECT_EQ(CountOf(*service_, "tracks_refused_id"), 1);
  EXPECT_EQ(CountOf(*service_, "tracks_refused_number"), 2);
  EXPECT_EQ(CountOf(*service_, "tracks_refused_time"), 1);
  EXPECT_EQ(CountOf(*service_, "tracks_refused_parts"), 1);
  EXPECT_EQ(service_->num_waiting(), 0);
}

// Whatever the order of the channels, the messages are the same to the byte.
TEST(AisInterleaving, OrderOfChannelsDecidesNothing) {
  constexpr int kNumScans = 60;
  const auto run = [](unsigned seed) {
    support::KeepingBus keeping;
    Params params;
    Service service(keeping.bus, params);
    std::vector<std::function<void()>> channels[3];
    for (int i = 0; i < kNumScans; ++i) {
      const auto begin_us = kStartUs + i * kScanUs;
      for (int k = 0; k < 2; ++k) {
        const auto line = ShipLine(211000001 + static_cast<std::uint32_t>((i + k) % 7), 30.0 * ((i + k) % 7) - 90.0, 41.0, i / 10);
        channels[0].emplace_back(
            [=, &keeping] { support::Send(keeping.bus, bus::kNavRaw, MakeRaw(begin_us + 40'000 * k, nav_raw_t::KIND_SENTENCE, line)); });
      }
      channels[0].emplace_back([=, &keeping] { support::Send(keeping.bus, bus::kNavRaw, MakeRaw(begin_us + kScanUs, nav_raw_t::KIND_TICK)); });
      for (int k = 1; k <= 5; ++k) {
        channels[1].emplace_back([=, &keeping] { support::Send(keeping.bus, bus::kPose, MakePose(begin_us + 20'000 * k)); });
      }
      channels[2].emplace_back([=, &keeping] {
        support::Send(keeping.bus, bus::kTracks, MakeTracks(i, {MakeTrack(3, 30.0, 40.0), MakeTrack(4, -30.0, 43.0), MakeTrack(9, 0.0, 20.0)}));
      });
    }
    std::mt19937 random(seed);
    std::size_t next[3] = {0, 0, 0};
    while (true) {
      std::vector<int> open;
      for (int i = 0; i < 3; ++i) {
        if (next[i] < channels[i].size()) open.push_back(i);
      }
      if (open.empty()) break;
      // One channel runs ahead for a while, then another.
      const int channel = open[random() % open.size()];
      for (auto steps = 1 + random() % 40; steps > 0 && next[channel] < channels[channel].size(); --steps) channels[channel][next[channel]++]();
    }
    std::vector<std::vector<std::uint8_t>> told;
    for (const auto& [name, bytes] : keeping.sent) {
      if (name == bus::kAis.name) told.push_back(bytes);
    }
    return told;
  };
  const auto expected = run(1);
  ASSERT_EQ(expected.size(), static_cast<std::size_t>(kNumScans));
  for (unsigned seed = 2; seed < 20; ++seed) EXPECT_TRUE(run(seed) == expected) << "seed " << seed;
}

}  // namespace
}  // namespace lookout::ais
