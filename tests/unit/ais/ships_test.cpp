// The table of ships: latency, propagation, antenna offset, the own ship, jumps, silence.
#include "services/ais/core/ships.hpp"

#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "tests/support/counters.hpp"

namespace lookout::ais {
namespace {

using support::CountOf;
using namespace std::chrono_literals;

// 12:00:20 UTC of some day.
constexpr Utime kNoon = std::chrono::sys_days(std::chrono::year(2026) / 7 / 1) + 12h + 20s;
const GeodeticPlace kHarbour{54.0, 10.0, 0.0};

Message At(double east_m, double north_m, int second, double speed_mps = 0.0, double course_deg = 0.0) {
  const auto place = LocalFrame(kHarbour).Reverse({east_m, north_m, 0.0});
  Message message;
  message.type = 1;
  message.mmsi = 211000001;
  message.sender = Sender::kClassA;
  PositionReport report;
  report.latitude_deg = place.latitude_deg;
  report.longitude_deg = place.longitude_deg;
  report.second = second;
  report.speed_mps = speed_mps;
  report.course_rad = DegToRad(course_deg);
  message.position = report;
  return message;
}

TEST(AisShips, TheSecondOfAReportTellsItsLatency) {
  Ships ships(0);
  ships.Add(At(0, 0, 15), false, kNoon);
  const auto& fix = *ships.ships().at(211000001).fix;
  EXPECT_EQ(fix.time, kNoon - 5s);
  EXPECT_TRUE(fix.is_time_known);
  // Of the minute before.
  ships.Add(At(0, 0, 58), false, kNoon + 43s);
  EXPECT_EQ(ships.ships().at(211000001).fix->time, kNoon + 38s);
  // A second ahead is the rounding of two clocks.
  ships.Add(At(0, 0, 21), false, kNoon + 60s);
  EXPECT_EQ(ships.ships().at(211000001).fix->time, kNoon + 60s);
  // The same over the full minute.
  ships.Add(At(0, 0, 1), false, kNoon + 99s + 500ms);
  EXPECT_EQ(ships.ships().at(211000001).fix->time, kNoon + 99s + 500ms);
}

TEST(AisShips, WithoutASecondTheUsualLatencyCounts) {
  for (const int second : {60, 62, 45, 59}) {  // 45: 35 s ago, rather a clock that is off
    Ships ships(0);
    ships.Add(At(0, 0, second), false, kNoon);
    EXPECT_EQ(ships.ships().at(211000001).fix->time, kNoon - Ships::kUsualLatency) << second;
    EXPECT_FALSE(ships.ships().at(211000001).fix->is_time_known);
  }
}

TEST(AisShips, AShipGoesOnByHerCourseAndSpeed) {
  Ships ships(0);
  ships.Add(At(100, 50, 15, 5.0, 90.0), false, kNoon);
  const auto predicted = Predict(ships.ships().at(211000001), LocalFrame(kHarbour), kNoon + 5s).value();
  EXPECT_NEAR(predicted.antenna_map_m.x(), 150.0, 0.01);
  EXPECT_NEAR(predicted.antenna_map_m.y(), 50.0, 0.01);
  EXPECT_NEAR(predicted.age_s, 10.0, 1e-9);
  // Half a second of its clock along her way, next to nothing across.
  EXPECT_GT(predicted.covariance_m2(0, 0), predicted.covariance_m2(1, 1) + 6.0);
  const auto place = PropagatedPlace(*ships.ships().at(211000001).fix, kNoon + 5s);
  EXPECT_NEAR((LocalFrame(kHarbour).Forward(place) - Eigen::Vector3d(150.0, 50.0, 0.0)).head<2>().norm(), 0.0, 0.01);
}

TEST(AisShips, TheMiddleOfTheHullLiesBesideTheAntenna) {
  Ships ships(0);
  auto message = At(0, 0, 20);
  message.position->heading_rad = DegToRad(90.0);
  message.facts.dimensions = Dimensions{30.0, 10.0, 2.0, 6.0, true};
  ships.Add(message, false, kNoon);
  const auto& ship = ships.ships().at(211000001);
  auto predicted = Predict(ship, LocalFrame(kHarbour), kNoon).value();
  // Ten metres ahead (east), two to starboard (south).
  EXPECT_NEAR(predicted.center_map_m.x(), 10.0, 1e-3);
  EXPECT_NEAR(predicted.center_map_m.y(), -2.0, 1e-3);
  // Without a heading the middle may be anywhere around.
  message.position->heading_rad = kNan;
  Ships other(0);
  other.Add(message, false, kNoon);
  const auto unturned = Predict(other.ships().at(211000001), LocalFrame(kHarbour), kNoon).value();
  EXPECT_NEAR(unturned.center_map_m.norm(), 0.0, 1e-3);
  EXPECT_GT(unturned.covariance_m2(0, 0), predicted.covariance_m2(0, 0) + 90.0);
}

TEST(AisShips, TheOwnShipIsNoTarget) {
  Ships ships(0);
  ships.Add(At(0, 0, 20), false, kNoon);
  ASSERT_EQ(ships.ships().size(), 1U);
  ships.Add(At(0, 0, 20), true, kNoon);
  EXPECT_TRUE(ships.ships().empty());
  EXPECT_EQ(ships.own_mmsi(), 211000001);
  ships.Add(At(0, 0, 21), false, kNoon + 1s);
  EXPECT_TRUE(ships.ships().empty());

  Ships configured(211000001);
  configured.Add(At(0, 0, 20), false, kNoon);
  EXPECT_TRUE(configured.ships().empty());
  EXPECT_EQ(CountOf(configured, "reports_own"), 1);
}

TEST(AisShips, APlaceThatNoShipReachesIsBelievedWhenThreeReportsAgree) {
  Ships ships(0);
  ships.Add(At(0, 0, 20), false, kNoon);
  ships.Add(At(5000, 0, 30), false, kNoon + 10s);
  EXPECT_EQ(CountOf(ships, "reports_jumped"), 1);
  EXPECT_EQ(ships.ships().at(211000001).fix->time, kNoon);
  ships.Add(At(0, 0, 40), false, kNoon + 20s);  // where it was: the jump is forgotten
  ships.Add(At(5000, 0, 50), false, kNoon + 30s);
  ships.Add(At(-5000, 0, 0), false, kNoon + 40s);  // elsewhere again
  ships.Add(At(-5000, 0, 10), false, kNoon + 50s);
  EXPECT_EQ(CountOf(ships, "ships_moved"), 0);
  ships.Add(At(-5000, 0, 20), false, kNoon + 60s);
  EXPECT_EQ(CountOf(ships, "ships_moved"), 1);
  EXPECT_EQ(ships.ships().at(211000001).fix->arrival, kNoon + 60s);
}

TEST(AisShips, RelayedAndRepeatedReportsAreNotUsedAgain) {
  Ships ships(0);
  ships.Add(At(10, 0, 20), false, kNoon);
  ships.Add(At(10, 0, 20), false, kNoon + 1s);
  ships.Add(At(0, 0, 15), false, kNoon + 2s);
  EXPECT_EQ(CountOf(ships, "reports_old"), 2);
  EXPECT_EQ(ships.ships().at(211000001).fix->arrival, kNoon);
}

TEST(AisShips, SilentShipsGoAfterTheTimeOfTheirClass) {
  Ships ships(0);
  ships.Add(At(0, 0, 20), false, kNoon);
  auto moving = At(0, 0, 20, 5.0);
  moving.mmsi = 2;
  ships.Add(moving, false, kNoon);
  ships.AdvanceTo(kNoon + 121s);
  EXPECT_EQ(ships.ships().size(), 1U);
  ships.AdvanceTo(kNoon + 600s);
  EXPECT_EQ(ships.ships().size(), 1U);
  ships.AdvanceTo(kNoon + 601s);
  EXPECT_TRUE(ships.ships().empty());
}

TEST(AisShips, TheTableHasAnEnd) {
  Ships ships(0);
  for (std::size_t i = 0; i < Ships::kMostShips + 10; ++i) {
    auto message = At(0, 0, 20);
    message.mmsi = static_cast<std::int32_t>(900'000'000 - i);
    ships.Add(message, false, kNoon + std::chrono::milliseconds(i));
  }
  EXPECT_EQ(ships.ships().size(), Ships::kMostShips);
  EXPECT_FALSE(ships.ships().contains(900'000'000));  // the first that was heard
  EXPECT_EQ(CountOf(ships, "ships_over_limit"), 10);
}

TEST(AisShips, PositionsPutInByHandSayNothing) {
  for (const int second : {61, 63}) {
    Ships ships(0);
    ships.Add(At(0, 0, second), false, kNoon);
    EXPECT_FALSE(Predict(ships.ships().at(211000001), LocalFrame(kHarbour), kNoon));
  }
}

TEST(AisShips, NotAvailableTakesNothingBack) {
  Ships ships(0);
  auto message = At(0, 0, 20);
  message.facts = {"NAME", "CALL", 70, Dimensions{10, 10, 2, 2, true}};
  ships.Add(message, false, kNoon);
  message.facts = {"", "", 0, Dimensions{}};
  message.position.reset();
  ships.Add(message, false, kNoon + 1s);
  const auto& ship = ships.ships().at(211000001);
  EXPECT_EQ(ship.name, "NAME");
  EXPECT_EQ(ship.call_sign, "CALL");
  EXPECT_EQ(ship.ship_type, 70);
  EXPECT_EQ(ship.dimensions.length_m(), 20.0);
  EXPECT_TRUE(ship.fix);
}

// Who goes on sending her name, or that her receiver has no fix, was shown where she had been for hours.
TEST(AisShips, AnOldPlaceIsNotKeptByWhatElseIsSaid) {
  for (const bool tells_no_fix : {false, true}) {
    Ships ships(0);
    ships.Add(At(0, 0, 20, 10.0), false, kNoon);
    for (int minute = 1; minute <= 5; ++minute) {
      auto message = At(0, 0, 60);
      if (tells_no_fix) message.position->latitude_deg = message.position->longitude_deg = kNan;
      if (!tells_no_fix) message.position.reset();
      ships.AdvanceTo(kNoon + std::chrono::minutes(minute));
      ships.Add(message, false, kNoon + std::chrono::minutes(minute));
    }
    EXPECT_FALSE(ships.ships().at(211000001).fix) << tells_no_fix;
    EXPECT_EQ(CountOf(ships, "positions_silent"), 1);
  }
}

TEST(AisShips, AStrayVdoHidesNobodyForLongAndABaseStationIsNotTheOwnShip) {
  Ships ships(0);
  ships.Add(At(0, 0, 20), true, kNoon);
  ships.Add(At(0, 0, 21), false, kNoon + 1s);
  EXPECT_TRUE(ships.ships().empty());
  ships.AdvanceTo(kNoon + 11min);
  ships.Add(At(0, 0, 20), false, kNoon + 11min);
  EXPECT_EQ(ships.ships().size(), 1U);
  auto base = At(0, 0, 20);
  base.sender = Sender::kBase;
  ships.Add(base, true, kNoon + 12min);
  EXPECT_EQ(ships.own_mmsi(), 0);
}

TEST(AisShips, AMessageOfAnotherKindMakesNoBaseStationOfAShip) {
  Ships ships(0);
  ships.Add(At(0, 0, 20), false, kNoon);
  auto other = At(0, 0, 25);
  other.sender = Sender::kBase;
  ships.Add(other, false, kNoon + 5s);
  EXPECT_EQ(ships.ships().at(211000001).sender, Sender::kClassA);
  auto name = At(0, 0, 60);
  name.sender = Sender::kClassB;
  name.position.reset();
  ships.Add(name, false, kNoon + 6s);
  EXPECT_EQ(ships.ships().at(211000001).sender, Sender::kClassA);
}

TEST(AisShips, ACoarsePlaceDoesNotReplaceThatOfAShipAtRest) {
  Ships ships(0);
  ships.Add(At(0, 0, 20), false, kNoon);
  auto coarse = At(100, 0, 60);
  coarse.position->resolution_m = 185.0;
  ships.Add(coarse, false, kNoon + 149s);
  EXPECT_LT(ships.ships().at(211000001).fix->report.resolution_m, 1.0);
  ships.Add(coarse, false, kNoon + 11min);
  EXPECT_EQ(ships.ships().at(211000001).fix->report.resolution_m, 185.0);
}

}  // namespace
}  // namespace lookout::ais
