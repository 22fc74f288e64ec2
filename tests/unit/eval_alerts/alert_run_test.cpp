// From the messages of a run to verdicts.
#include "lab/eval/tracks/alert_run.hpp"

#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>
#include <gtest/gtest.h>
#include <optional>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/core/angles.hpp"
#include "lab/eval/tracks/track_sources.hpp"
#include "lab/sim/scene_file.hpp"
#include "tests/support/files.hpp"
#include "tests/support/messages.hpp"
#include "tests/unit/eval_tracks/track_cases.hpp"
#include "tools/replay/chain.hpp"

namespace lookout::eval {
namespace {

using Eigen::Vector2d;

constexpr MapOrigin kOrigin{46.0, 8.0, 0.0};
constexpr std::int64_t kStartUs = 1'000'000;
// 4 m x 2 m, the reference point 1 m before its middle.
const Polygon kHullM{{-3.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-3.0, 1.0}};

std::vector<Geodetic> OnEarth(const Polygon& corners_m) {
  const GeographicLib::LocalCartesian map(kOrigin[0], kOrigin[1], kOrigin[2]);
  std::vector<Geodetic> corners;
  for (const auto& corner_m : corners_m) {
    Geodetic place{};
    double height_m = 0.0;
    map.Reverse(corner_m.x(), corner_m.y(), 0.0, place.latitude_deg, place.longitude_deg, height_m);
    corners.push_back(place);
  }
  return corners;
}

// The own boat goes east at 2 m/s from the origin; a boat lies 30 m ahead.
Truth TruthOfOneBoat() {
  Truth truth(1);
  truth.AddObject(data::kOwnVesselObject, {"own_vessel", "own_vessel", true, true});
  truth.AddObject(1, {"boat", "motor_boat", false, true});
  truth.AddOutline(1, kStartUs, OnEarth(SquareAt({30.0, 0.0})));
  for (int i = -10; i <= 60; ++i) {
    Polygon hull_m = kHullM;
    for (auto& corner_m : hull_m) corner_m.x() += 0.2 * i;
    truth.AddOutline(data::kOwnVesselObject, kStartUs + i * kScanUs, OnEarth(hull_m));
  }
  return truth;
}

tracks_t Tracks(std::int64_t utime_us, const Vector2d& position_m) {
  auto message = support::OfScan<tracks_t>(utime_us, 0, kScanUs);
  support::SetDatum(message, {kOrigin[0], kOrigin[1], kOrigin[2]});
  track_t track{};
  track.id = 7;
  track.status = track_t::STATUS_CONFIRMED;
  track.position_map_m[0] = position_m.x();
  track.position_map_m[1] = position_m.y();
  support::Fill(message, {track});
  return message;
}

alerts_t Alerts(std::int64_t utime_us, std::vector<alert_t> alerts) {
  auto message = support::OfScan<alerts_t>(utime_us, 0, kScanUs);
  support::Fill(message, std::move(alerts));
  return message;
}

alert_t AlertOf(std::int64_t id, std::int32_t cause, std::int64_t track_id) {
  alert_t alert{};
  alert.id = id;
  alert.cause = cause;
  alert.is_in_zone = cause == alert_t::CAUSE_GUARD_ZONE ? 1 : 0;
  alert.comes_near = cause == alert_t::CAUSE_CLOSEST_APPROACH ? 1 : 0;
  alert.level = alert_t::LEVEL_CAUTION;
  alert.state = alert_t::STATE_ACTIVE;
  alert.track_id = track_id;
  alert.distance_m = 28.0F;
  return alert;
}

TEST(AlertTruth, KnowsReferencePointHeadingAndCourse) {
  const auto truth = TruthOfOneBoat();
  const AlertTruth alert_truth(truth, kOrigin, kHullM);
  const auto scan = alert_truth.At(kStartUs + 10 * kScanUs, {{1, 9}});
  ASSERT_TRUE(scan);
  EXPECT_NEAR(scan->own.reference_m.x(), 2.0, 1e-6);
  EXPECT_NEAR(scan->own.reference_m.y(), 0.0, 1e-6);
  EXPECT_NEAR(scan->own.heading_rad, DegToRad(90.0), 1e-6);
  EXPECT_NEAR(scan->own.motion.velocity_mps.x(), 2.0, 1e-6);
  EXPECT_NEAR(scan->own.motion.turn_radps, 0.0, 1e-6);
  ASSERT_EQ(scan->things.size(), 1U);
  EXPECT_EQ(scan->things[0].num_returns, 9);
  EXPECT_TRUE(scan->things[0].motion.velocity_mps.isZero());
}

TEST(AlertTruth, PiecesOfLandThatHangTogetherAreOne) {
  auto truth = TruthOfOneBoat();
  for (const int id : {3, 4, 5, 6}) truth.AddObject(id, {"wall_" + std::to_string(id), "wall", false, false});
  truth.AddOutline(6, kStartUs, OnEarth(SquareAt({0.0, 50.0})));
  truth.AddOutline(4, kStartUs, OnEarth(SquareAt({4.0, 50.0})));
  truth.AddOutline(3, kStartUs, OnEarth(SquareAt({8.5, 50.0})));
  truth.AddOutline(5, kStartUs, OnEarth(SquareAt({14.0, 50.0})));  // 3.5 m on
  const auto scan = AlertTruth(truth, kOrigin, kHullM).At(kStartUs, {});
  ASSERT_EQ(scan->things.size(), 5U);
  EXPECT_EQ(scan->things[0].group, 1);  // a boat
  EXPECT_EQ(scan->things[1].group, 3);
  EXPECT_EQ(scan->things[2].group, 3);
  EXPECT_EQ(scan->things[3].group, 5);
  EXPECT_EQ(scan->things[4].group, 3);
}

TEST(AlertRun, JudgesAlertsOfTheBusByThePlaceOfTheirTrack) {
  const auto truth = TruthOfOneBoat();
  for (const double north_m : {0.0, 20.0}) {
    AlertRun run(truth, kHullM, {}, [](const TruthSpan&) { return std::map<int, int>{{1, 9}}; });
    // Before TRACKS of a known place.
    EXPECT_TRUE(run.Add(bus::kAlerts.name, bus::Encode(Alerts(kStartUs, {AlertOf(1, alert_t::CAUSE_CLOSEST_APPROACH, 5)}))));
    for (int i = 1; i < 40; ++i) {
      const std::int64_t utime_us = kStartUs + i * kScanUs;
      EXPECT_TRUE(run.Add(bus::kTracks.name, bus::Encode(Tracks(utime_us, {30.0, north_m}))));
      EXPECT_TRUE(run.Add(bus::kAlerts.name,
                          bus::Encode(Alerts(utime_us, {AlertOf(2, alert_t::CAUSE_CLOSEST_APPROACH, 7), AlertOf(3, alert_t::CAUSE_WATCH, 0)}))));
    }
    run.Finish();
    EXPECT_EQ(run.scores().NumAlerts(), 1);
    EXPECT_EQ(run.scores().Num(AlertVerdict::kRight), north_m == 0.0 ? 1 : 0);
    EXPECT_EQ(run.scores().Num(AlertVerdict::kNothing), north_m == 0.0 ? 0 : 1);
    EXPECT_EQ(run.scores().Num(DangerVerdict::kInTime), north_m == 0.0 ? 1 : 0);
    EXPECT_EQ(run.scores().Num(DangerVerdict::kMissed), north_m == 0.0 ? 0 : 1);
    EXPECT_EQ(run.scores().num_watch_alerts, 1);
    EXPECT_EQ(run.scores().num_early_alerts, 1);
  }
}

// A boat that lies under a pier is within its outline from the first scan on: nothing is judged, and that is no fault of the run.
TEST(AlertRun, WithinAThingHasAPositionAndNoScanThatIsJudged) {
  auto truth = TruthOfOneBoat();
  truth.AddObject(2, {"pier", "pier", false, false});
  truth.AddOutline(2, kStartUs, OnEarth(SquareAt({0.0, 0.0})));
  AlertRun run(truth, kHullM, {}, [](const TruthSpan&) { return std::map<int, int>(); });
  EXPECT_FALSE(run.has_position());
  EXPECT_TRUE(run.Add(bus::kTracks.name, bus::Encode(Tracks(kStartUs, {30.0, 0.0}))));
  EXPECT_TRUE(run.Add(bus::kAlerts.name, bus::Encode(Alerts(kStartUs, {}))));
  run.Finish();
  EXPECT_TRUE(run.has_position());
  EXPECT_EQ(run.scores().num_scans, 0);
}

TEST(AlertRun, WhatCannotBeDecodedIsRefused) {
  const auto truth = TruthOfOneBoat();
  AlertRun run(truth, kHullM, {}, [](const TruthSpan&) { return std::map<int, int>(); });
  const std::vector<std::uint8_t> bytes(50, 7);
  EXPECT_FALSE(run.Add(bus::kTracks.name, bytes));
  EXPECT_FALSE(run.Add(bus::kAlerts.name, bytes));
  EXPECT_TRUE(run.Add("POSE", bytes));  // none of its channels
}

// The whole boat in a berth: nothing approaches, nothing is told.
TEST(AlertRun, OfASimulatedBerthHasNoAlert) {
  const auto boat = config::LoadBoat(support::kCatabotConfig);
  Truth truth(1);
  std::optional<AlertRun> run;
  replay::Chain chain(support::kCatabotConfig, {}, [&](Utime, std::string_view channel, Bytes bytes) { EXPECT_TRUE(run->Add(channel, bytes)); });
  SimulateRun(support::kCatabotConfig, support::kSources / "config/scenes/encounters/moored_dense.txtpb", 1, 4.0, truth,
              [&](const replay::Datagram& datagram) {
                if (!run) run.emplace(truth, OwnHullOf(boat), AlertRules{}, [&](const TruthSpan& scan) { return truth.CountReturns(scan); });
                chain.OnDatagram(datagram);
              });
  chain.Finish();
  run->Finish();
  EXPECT_NEAR(static_cast<double>(run->scores().num_scans), 39.0, 2.0);
  EXPECT_EQ(run->scores().NumAlerts(), 0);
  EXPECT_EQ(run->scores().NumDangers(), 0);
}

}  // namespace
}  // namespace lookout::eval
