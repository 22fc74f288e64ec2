// What the tracker says of a lidar that is covered or dark, and what becomes of the tracks: ALERTS, TRACKS and HEALTH.
#include <algorithm>
#include <cmath>
#include <functional>
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

Params MakeCoverParams() {
  auto params = test::MakeParams();
  params.tracker.T_vessel_lidar.translation().z() = 1.0;
  params.cover.T_vessel_lidar = params.tracker.T_vessel_lidar;
  params.cover.min_range_m = 0.5;
  params.cover.own_vessel_box_m = {Eigen::Vector3d(-1.0, -0.5, -1.0), Eigen::Vector3d(1.0, 0.5, 2.0)};
  params.zone_sight.zone = params.look_out.limits.guard_zone = {.range_m = 15.0, .bearing = {DegToRad(60.0), DegToRad(60.0)}};
  params.zone_sight.min_range_m = params.cover.min_range_m;
  params.zone_sight.T_vessel_lidar = params.cover.T_vessel_lidar;
  params.zone_sight.own_vessel_box_m = params.cover.own_vessel_box_m;
  params.zone_sight.own_hull_m = {Eigen::Vector2d(-1.0, -0.5), Eigen::Vector2d(1.0, 0.5)};
  return params;
}

// The boat lies at the origin of the map, its bow to the north.
class TrackerServiceCover : public support::BusTest {
 protected:
  using Ranges = std::function<double(double azimuth_deg)>;  // of both rings; 0 = no return

  void Scans(double duration_s, const Ranges& range_m, bool has_boat = false) {
    for (int i = 0; i < std::lround(10.0 * duration_s); ++i, ++number_) {
      const auto offset_us = test::kScanUs * number_;
      for (int k = number_ == 0 ? 0 : 1; k <= 5; ++k) Send(bus::kPose, test::MakePose(offset_us + 20'000 * k, 5 * number_ + k));
      auto sweep = test::MakeSweep(offset_us, number_);
      for (std::size_t cell = 0; cell < sweep.range.size(); ++cell) {
        const auto azimuth_deg = RadToDeg(static_cast<double>(sweep.azimuth_rad[cell / test::kNumRings]));
        sweep.range[cell] = static_cast<std::int16_t>(range_m(azimuth_deg) / sweep.range_unit_m);
      }
      Send(bus::kLidarScan, sweep);
      Send(bus::kSegments, test::MakeNoSegments(sweep));
      auto boat = test::MakeObstacle(1, test::kStartUs + offset_us, {10.0, 0.0});
      boat.top_above_water_m = 1.2F;
      Send(bus::kObstacles, test::MakeObstacles(offset_us, number_, has_boat ? std::vector{boat} : std::vector<obstacle_t>{}));
    }
  }
  std::int64_t NumTracks() const {
    return std::ranges::count_if(tracks_.back().tracks, [](const track_t& track) { return track.status != track_t::STATUS_TENTATIVE; });
  }
  const alert_t* Told(const std::string& text) const {
    const auto& told = alerts_.back().alerts;
    const auto found = std::ranges::find(told, text, &alert_t::text);
    return found == told.end() ? nullptr : &*found;
  }
  // A shore to port, and a boat 10 m off on the starboard beam.
  static double Shore(double azimuth_deg) { return azimuth_deg > 200.0 && azimuth_deg < 320.0 ? 30.0 : 0.0; }
  static double ShoreAndBoat(double azimuth_deg) { return azimuth_deg > 87.0 && azimuth_deg < 91.0 ? 10.0 : Shore(azimuth_deg); }
  static double Nothing(double /*azimuth_deg*/) { return 0.0; }

  Service service_{bus_, MakeCoverParams()};
  support::Kept<tracks_t> tracks_{bus_, bus::kTracks};
  support::Kept<alerts_t> alerts_{bus_, bus::kAlerts};
  int number_ = 0;
};

constexpr auto kDarkText = "no look-out: all round (the lidar sees nothing any more: lasers off, or window covered)";

TEST_F(TrackerServiceCover, EndsATrackThatIsLookedForAndNotThere) {
  Scans(10.0, ShoreAndBoat, true);
  ASSERT_EQ(NumTracks(), 1);
  Scans(5.0, Shore);
  EXPECT_EQ(NumTracks(), 0);
  for (const auto& message : alerts_) {
    for (const auto& alert : message.alerts) EXPECT_NE(alert.cause, alert_t::CAUSE_WATCH) << alert.text;
  }
}

// The lasers failed, the packets went on: the boat was "gone: nothing is there any more", and all was well.
TEST_F(TrackerServiceCover, KeepsATrackAndSaysThatTheLidarIsDark) {
  Scans(10.0, ShoreAndBoat, true);
  ASSERT_EQ(NumTracks(), 1);
  Scans(5.0, Nothing);
  EXPECT_EQ(NumTracks(), 1) << "nobody looked";
  const auto* alert = Told(kDarkText);
  ASSERT_NE(alert, nullptr);
  EXPECT_EQ(alert->cause, alert_t::CAUSE_WATCH);
  EXPECT_EQ(alert->level, alert_t::LEVEL_WARNING);
  EXPECT_GT(alert->id, 0) << "by the scans, so that replay tells the same";
  EXPECT_NE(Told("no look-out in the whole guard zone: 60 to 120 deg (the own boat or something at the lidar hides it)"), nullptr);
  EXPECT_EQ(service_.Report().state, HealthState::kDegraded);
  EXPECT_NE(service_.Report().reason.find(kDarkText), std::string::npos) << service_.Report().reason;
  EXPECT_EQ(support::CountOf(service_, "lidar_covered_deg"), 360);
  Scans(10.0, Nothing);
  for (const auto& message : alerts_) {
    for (const auto& one : message.alerts) EXPECT_NE(one.end, alert_t::END_GONE) << one.text;
  }

  Scans(10.0, ShoreAndBoat, true);
  EXPECT_EQ(NumTracks(), 1);
  ASSERT_NE(Told("nothing covers the lidar any more"), nullptr) << "nobody took note of a warning: it stays, and says that it is over";
  EXPECT_EQ(support::CountOf(service_, "lidar_covered_deg"), 0);
  EXPECT_EQ(service_.Report().reason.find("look-out"), std::string::npos) << service_.Report().reason;
}

TEST_F(TrackerServiceCover, SaysWhichSectorIsCoveredAndKeepsItsTrack) {
  Scans(10.0, ShoreAndBoat, true);
  Scans(5.0, [](double azimuth_deg) { return azimuth_deg >= 70.0 && azimuth_deg < 110.0 ? 0.4 : Shore(azimuth_deg); });
  EXPECT_EQ(NumTracks(), 1);
  const auto* alert = Told("no look-out: 70 to 110 deg (something nearer than 1 m covers the lidar)");
  ASSERT_NE(alert, nullptr);
  EXPECT_EQ(alert->level, alert_t::LEVEL_CAUTION);
  EXPECT_NEAR(RadToDeg(alert->bearing_rad), 90.0, 1.0);
  EXPECT_NE(Told("no look-out in part of the guard zone: 71 to 110 deg (the own boat or something at the lidar hides it)"), nullptr)
      << "the zone is told in whole degrees that nothing looks into";
}

// Acknowledged once, it is quiet; more of it is told anew.
TEST_F(TrackerServiceCover, RaisesAnewWhatWasNotTold) {
  const auto covered = [](double to_deg) {
    return [to_deg](double azimuth_deg) { return azimuth_deg >= 200.0 && azimuth_deg < to_deg ? 0.4 : Shore(azimuth_deg); };
  };
  Scans(5.0, covered(240.0));
  const auto* first = Told("no look-out: 200 to 240 deg (something nearer than 1 m covers the lidar)");
  ASSERT_NE(first, nullptr);
  alert_ack_t acknowledgement{};
  acknowledgement.source = "page";
  acknowledgement.alert_id = first->id;
  acknowledgement.alert_raised_utime_us = first->raised_utime_us;
  Send(bus::kAlertAck, acknowledgement);
  Scans(60.0, covered(240.0));
  ASSERT_EQ(alerts_.back().alerts.size(), 1U);
  EXPECT_EQ(alerts_.back().alerts.front().state, alert_t::STATE_ACKNOWLEDGED);
  EXPECT_EQ(alerts_.back().alerts.front().id, acknowledgement.alert_id);
  Scans(5.0, covered(280.0));
  const auto* second = Told("no look-out: 200 to 280 deg (something nearer than 1 m covers the lidar)");
  ASSERT_NE(second, nullptr);
  EXPECT_GT(second->id, acknowledgement.alert_id);
  EXPECT_EQ(second->state, alert_t::STATE_ACTIVE);
}

// Flat water and a covered lidar look alike where nothing was seen before.
TEST_F(TrackerServiceCover, SaysOnceThatItHasSeenNothing) {
  Scans(29.0, Nothing);
  EXPECT_TRUE(alerts_.back().alerts.empty());
  Scans(300.0, Nothing);
  const auto* alert =
      Told("perhaps no look-out: the lidar has seen nothing at all for 30 s (lasers off, window covered, or flat water and nothing near)");
  ASSERT_NE(alert, nullptr);
  EXPECT_EQ(alert->cause, alert_t::CAUSE_WATCH);
  EXPECT_EQ(alert->level, alert_t::LEVEL_CAUTION);
  EXPECT_EQ(alert->id, 1) << "once";
  EXPECT_NE(service_.Report().reason.find("the lidar has seen nothing at all for 30 s"), std::string::npos) << service_.Report().reason;
  Scans(15.0, Shore);
  EXPECT_TRUE(alerts_.back().alerts.empty());
  EXPECT_TRUE(std::ranges::any_of(
      alerts_, [](const alerts_t& message) { return !message.alerts.empty() && message.alerts.front().text == "the lidar sees something again"; }));
}

TEST(CoverText, NamesThreePartsAndHowManyMore) {
  const CoveredPart part{Cover::kOwnGone, {DegToRad(340.0), DegToRad(50.0)}};
  EXPECT_EQ(TextOf(std::vector{part}),
            "no look-out: 340 to 30 deg (the lidar saw the own boat there, and sees nothing any more: window covered, or a part of the boat gone)");
  EXPECT_NE(TextOf(std::vector(5, part)).find("; and 2 more"), std::string::npos);
}

}  // namespace
}  // namespace lookout::tracker
