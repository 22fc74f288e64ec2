// Places and times that cannot be true: zero north zero east, other time zones, a UTC that stands.

#include <cmath>
#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "tests/unit/navigator/interpreter_fixture.hpp"
#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::navigator {
namespace {

// 0 N 0 E with a valid status was a fix: POSE was ok, 6100 km from the boat.
TEST_F(InterpreterTest, TakesNoFixAtZeroNorthZeroEast) {
  int num_null = 0;
  for (const char* const body :
       {"GPRMC,120000.00,A,0000.00000,N,00000.00000,E,0.0,0.0,010626,,,A", "GPRMC,120000.00,A,0000.0000,S,00000.0000,W,0.0,,010626,,",
        "GNGGA,120000.00,0000.00000,N,00000.00000,E,1,12,0.8,3.0,M,40.0,M,,", "GPGLL,0000.00000,N,00000.00000,E,120000.00,A,A",
        "GPGLL,0000.00,N,00000.00,E", "GNGNS,120000.00,0000.00000,N,00000.00000,E,AA,12,0.8,3.0,40.0,,"}) {
    interpreter_.Reset();
    const auto fix = Read(0.1, Line(body)).fix;
    ASSERT_TRUE(fix) << body;
    EXPECT_FALSE(fix->position) << body;
    EXPECT_EQ(fix->quality, FixQuality::kNone) << body;
    EXPECT_TRUE(std::isnan(fix->speed_mps)) << body;
    EXPECT_EQ(Count("null_fix"), ++num_null) << body;
  }
  const auto ins =
      Read(1.0, Line("VNINS,475234.000000,2421,0002,+090.000,+000.000,+000.000,+00.00000000,+000.00000000,+00000.000,+000.000,+000.000,+000.000,"
                     "00.1,00.1,00.10"));
  ASSERT_TRUE(ins.fix && ins.attitude) << "VectorNav's knows its attitude before its place";
  EXPECT_FALSE(ins.fix->position);
  EXPECT_EQ(Count("null_fix"), ++num_null);
}

TEST_F(InterpreterTest, TakesPlacesOnTheEquatorAndOnTheMeridianOfGreenwich) {
  EXPECT_TRUE(Read(0.1, RmcLine(NoonPlus(0), 0.0, 8.0, 2.0, 30.0)).fix->position);
  EXPECT_TRUE(Read(1.1, RmcLine(NoonPlus(1), 50.0, 0.0, 2.0, 30.0)).fix->position);
  EXPECT_TRUE(Read(2.1, RmcLine(NoonPlus(2), 0.0, 0.001, 2.0, 30.0)).fix->position);
  EXPECT_EQ(Count("null_fix"), 0);
}

// What the receiver says beside 0 N 0 E is no more true.
TEST_F(InterpreterTest, TakesNoSpeedBesideZeroNorthZeroEast) {
  Read(0.1, RmcLine(NoonPlus(0), 0.0, 0.0, 0.0, 0.0));
  EXPECT_FALSE(Read(0.12, Line("GPVTG,30.0,T,,M,4.0,N,,K")).velocity);
  Read(1.1, RmcLine(NoonPlus(1), 50.0, 8.0, 2.0, 30.0));
  Read(1.3, GgaLine(NoonPlus(1.2), 50.0, 8.0, 1, 0.8, 3.0, 40.0));
  EXPECT_TRUE(Read(1.32, Line("GPVTG,30.0,T,,M,4.0,N,,K")).velocity);
}

TEST_F(InterpreterTest, AFixIsOfItsEpochBesideASentenceAtZeroNorthZeroEast) {
  const auto null = GgaLine(NoonPlus(0), 0.0, 0.0, 1, 0.8, 3.0, 40.0);
  const auto rmc = RmcLine(NoonPlus(0), 50.0, 8.0, 2.0, 30.0);
  Read(0.1, null);
  EXPECT_NEAR(Read(0.12, rmc).fix->position->latitude_deg, 50.0, 1e-9);
  EXPECT_NEAR(Read(0.14, null).fix->position->latitude_deg, 50.0, 1e-9);
}

// A plotter put its local time into GLL: neither the fixes of GLL nor those of RMC counted.
TEST_F(InterpreterTest, RefusesTheTimeOfAnotherZoneBesideUtc) {
  for (const double zone_s : {7200.0, -4.5 * 3600.0, 5.75 * 3600.0, 13.0 * 3600.0, -11.0 * 3600.0}) {
    SCOPED_TRACE(zone_s);
    interpreter_ = Interpreter(TestParams());
    for (int i = 0; i < 20; ++i) {
      const auto rmc = Read(i + 0.2, RmcLine(NoonPlus(i), 50.0, 8.0, 2.0, 30.0)).fix;
      ASSERT_TRUE(rmc && rmc->when.is_from_sentence) << i;
      EXPECT_EQ(rmc->when.utc, NoonPlus(i));
      const auto gll = Read(i + 0.5, Line("GPGLL,5000.0000,N,00800.0000,E," + TimeOfDay(NoonPlus(i + zone_s + 3.3)) + ",A")).fix;
      EXPECT_FALSE(gll) << "it tells the place of 0.3 s ago, which would draw a fast boat back";
    }
    EXPECT_EQ(Count("local_time"), 20);
    EXPECT_EQ(Count("time_backwards"), 0);
  }
}

// The receiver with the right time is gone: better a place of some seconds than none.
TEST_F(InterpreterTest, UsesAPlaceInAnotherZoneAtItsArrivalWhereNoOtherComes) {
  for (int i = 0; i < 20; ++i) Read(i + 0.2, RmcLine(NoonPlus(i), 50.0, 8.0, 2.0, 30.0));
  const auto gll = Read(23.5, Line("GPGLL,5000.0000,N,00800.0000,E," + TimeOfDay(NoonPlus(7223.3)) + ",A")).fix;
  ASSERT_TRUE(gll);
  EXPECT_EQ(gll->when.time, NoonPlus(23.5)) << "at its arrival";
  EXPECT_FALSE(gll->when.has_sentence_utc);
}

TEST_F(InterpreterTest, WhatIsRightBehindAFixIsOfItsInstantInWhateverZone) {
  Read(0.2, RmcLine(NoonPlus(0), 50.0, 8.0, 2.0, 30.0));
  EXPECT_EQ(Read(0.21, Line("GPGLL,5000.0000,N,00800.0000,E," + TimeOfDay(NoonPlus(7200)) + ",A")).fix->when.time, NoonPlus(0));
}

TEST_F(InterpreterTest, KnowsUtcByGgaBesideGllWhereNothingTellsADate) {
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(Read(i + 0.2, GgaLine(NoonPlus(i), 50.0, 8.0, 1, 0.8, 3.0, 40.0)).fix->when.time, NoonPlus(i));
    Read(i + 0.5, Line("GPGLL,5000.0000,N,00800.0000,E," + TimeOfDay(NoonPlus(i + 3600)) + ",A"));
  }
  EXPECT_EQ(Count("local_time"), 20);
  EXPECT_EQ(Count("time_backwards"), 0);
}

TEST_F(InterpreterTest, RefusesZdaInLocalTimeBesideRmc) {
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(Read(i + 0.2, RmcLine(NoonPlus(i), 50.0, 8.0, 2.0, 30.0)).fix->when.time, NoonPlus(i));
    Read(i + 0.3, Line("GPZDA," + TimeOfDay(NoonPlus(i + 7200)) + ",01,06,2026,-02,00"));
    EXPECT_EQ(Read(i + 0.4, GgaLine(NoonPlus(i), 50.0, 8.0, 1, 0.8, 3.0, 40.0)).fix->when.time, NoonPlus(i));
  }
  EXPECT_EQ(Count("local_time"), 20);
  EXPECT_EQ(Count("date_unusable"), 0);
}

TEST_F(InterpreterTest, TimesOfOneZoneOverMidnightAreOfOneZone) {
  for (int i = 43'190; i < 43'210; ++i) {
    Read(i + 0.2, RmcLine(NoonPlus(i), 50.0, 8.0, 2.0, 30.0));
    EXPECT_EQ(Read(i + 0.7, GgaLine(NoonPlus(i + 0.5), 50.0, 8.0, 1, 0.8, 3.0, 40.0)).fix->when.time, NoonPlus(i + 0.5));
  }
  EXPECT_EQ(Count("local_time"), 0);
}

// A plotter sets its UTC every ten seconds: all places between were of one epoch, and four of five late.
TEST_F(InterpreterTest, APlaceThatMovesOnUnderAStandingUtcIsOfItsArrival) {
  for (int i = 0; i < 40; i += 2) {
    const auto utc = NoonPlus(i / 10 * 10);
    const double latitude_deg = 50.0 + 1e-5 * i;
    const bool is_first = i % 10 == 0;
    const auto gga = Read(i + 0.2, GgaLine(utc, latitude_deg, 8.0, 1, 2.0, 3.0, 40.0)).fix;
    const auto rmc = Read(i + 0.2, RmcLine(utc, latitude_deg, 8.0, 1.0, 0.0)).fix;
    ASSERT_TRUE(gga && rmc);
    EXPECT_EQ(gga->when.time, is_first ? utc : NoonPlus(i + 0.2)) << i;
    EXPECT_EQ(rmc->when.time, gga->when.time);
    EXPECT_NEAR(rmc->position->latitude_deg, latitude_deg, 1e-9);
  }
  EXPECT_EQ(Count("standing_utc"), 32);
}

// A plotter tells the fixes of a slow receiver again, later and with fewer digits.
TEST_F(InterpreterTest, APlaceThatIsToldAgainWithFewerDigitsIsOld) {
  for (int i = 0; i < 20; i += 2) {
    Read(i + 0.2, RmcLine(NoonPlus(i), 50.0 + 1e-5 * i, 8.0, 1.0, 0.0));
    const auto again = Read(i + 1.8, RmcLine(NoonPlus(i), 50.0 + 1e-5 * i + 4e-6, 8.0, 1.0, 0.0)).fix;
    EXPECT_EQ(again->when.time, NoonPlus(i));
  }
  EXPECT_EQ(Count("standing_utc"), 0);
}

TEST_F(InterpreterTest, EachPlaceOfASecondCountsOnceAUtcHasStood) {
  int num_arrivals = 0;
  for (int i = 0; i < 30; ++i) {
    const auto fix = Read(i + 0.2, RmcLine(NoonPlus(i / 5 * 5), 50.0 + 1e-5 * i, 8.0, 1.0, 0.0)).fix;
    num_arrivals += fix->when.time == NoonPlus(i + 0.2) ? 1 : 0;
  }
  EXPECT_EQ(num_arrivals, 3 + 5 * 4) << "all but the first of each UTC, and the second of the first";
  EXPECT_EQ(Count("sentence_time_unusable"), 1) << "the second of the first";
}

// A receiver that has gone is repeated, and its place is as old as its UTC says.
TEST_F(InterpreterTest, APlaceThatStandsUnderAStandingUtcIsOld) {
  for (int i = 0; i < 20; i += 2) EXPECT_EQ(Read(i + 0.2, RmcLine(NoonPlus(0), 50.0, 8.0, 1.0, 0.0)).fix->when.time, NoonPlus(0)) << i;
  EXPECT_EQ(Count("standing_utc"), 0);
}

TEST_F(InterpreterTest, ABoatAtRestIsNowForAsLongAsItsUtcHasStoodBefore) {
  for (int i = 0; i < 20; i += 2) Read(i + 0.2, RmcLine(NoonPlus(i / 10 * 10), 50.0 + 1e-5 * i, 8.0, 1.0, 0.0));
  const auto rest = [this](int i) { return Read(i + 0.2, RmcLine(NoonPlus(20), 50.001, 8.0, 0.0, 0.0)).fix->when.time; };
  EXPECT_EQ(rest(20), NoonPlus(20));
  for (int i = 22; i < 30; i += 2) EXPECT_EQ(rest(i), NoonPlus(i + 0.2));
  for (int i = 30; i < 40; i += 2) EXPECT_EQ(rest(i), NoonPlus(20)) << "it has gone";
}

// Ten places of one second whose parts are left out are as before: the first counts.
TEST_F(InterpreterTest, PlacesOfOneSecondAreOneEpoch) {
  for (int i = 0; i < 50; ++i) Read(0.1 * i + 0.05, RmcLine(NoonPlus(i / 10), 50.0 + 1e-6 * i, 8.0, 1.0, 0.0));
  EXPECT_EQ(Count("standing_utc"), 0);
}

}  // namespace
}  // namespace lookout::navigator
