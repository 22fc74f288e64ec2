#include "services/plotter/core/nmea0183.hpp"

#include <gtest/gtest.h>

#include "tests/unit/plotter/made_up.hpp"

namespace lookout::plotter {
namespace {

using test::Deg;
using test::Line;
using test::MakeOwnShip;
using test::MakeTarget;

TEST(PlotterNmea, SaysTheOwnShip) {
  const auto own = MakeOwnShip();
  EXPECT_EQ(Line(Rmc("II", own)), "$IIRMC,102030.45,A,5318.000000,N,00606.000000,W,3.89,90.00,010726,,,A");
  EXPECT_EQ(Line(Hdt("II", own).value()), "$IIHDT,45.00,T");
  EXPECT_EQ(Line(Osd("RA", own, Unit::kKilometres)), "$RAOSD,45.00,A,90.00,P,7.20,P,,,K");
}

TEST(PlotterNmea, SaysThatThePositionIsNotKnown) {
  OwnShip own{.time = test::kTime, .position = {}};
  EXPECT_EQ(Line(Rmc("II", own)), "$IIRMC,102030.45,V,,,,,,,010726,,,N");
  EXPECT_FALSE(Hdt("II", own).has_value());
}

TEST(PlotterNmea, SaysThatThePositionIsOnlyEstimated) {
  auto own = MakeOwnShip();
  own.is_estimated = true;
  EXPECT_EQ(Line(Rmc("II", own)), "$IIRMC,102030.45,V,5318.000000,N,00606.000000,W,3.89,90.00,010726,,,E");
  EXPECT_FALSE(Hdt("II", own).has_value());
  EXPECT_EQ(Line(Osd("RA", own, Unit::kKilometres)), "$RAOSD,45.00,V,90.00,P,7.20,P,,,K");
}

TEST(PlotterNmea, SaysATargetByRangeAndBearing) {
  const auto sentence = Ttm("RA", MakeOwnShip(), MakeTarget(), 5, Unit::kKilometres);
  EXPECT_EQ(Line(sentence), "$RATTM,05,0.1000,45.00,T,3.60,180.00,T,0.0125,0.550,K,boat 17,T,,102030.45,A");
  const auto miles = Ttm("RA", MakeOwnShip(), MakeTarget(), 5, Unit::kNauticalMiles);
  EXPECT_EQ(Line(miles).substr(0, 53), "$RATTM,05,0.0540,45.00,T,1.94,180.00,T,0.0067,0.550,N");
}

TEST(PlotterNmea, SaysNoCourseOfWhatStands) {
  auto target = MakeTarget();
  target.speed_mps = 0.0;
  target.course_rad = kNan;
  target.tcpa_s = kNan;
  target.cpa_m = kNan;
  target.state = TargetState::kLost;
  EXPECT_NE(Ttm("RA", MakeOwnShip(), target, 99, Unit::kKilometres).find("RATTM,99,0.1000,45.00,T,0.00,,,,,K,boat 17,L,"), std::string::npos);
}

TEST(PlotterNmea, SaysATargetByLatitudeAndLongitude) {
  auto target = MakeTarget();
  target.position = {-53.3000001, 179.99999999};
  target.state = TargetState::kAcquiring;
  // 59.9999999 minutes are 180 degrees: never 60 minutes.
  EXPECT_EQ(Line(Tll("RA", target, 7, test::kTime)), "$RATLL,07,5318.000006,S,17959.999999,E,boat 17,102030.45,Q,");
  target.position.longitude_deg = 179.9999999999;
  EXPECT_NE(Tll("RA", target, 7, test::kTime).find(",18000.000000,E,"), std::string::npos);
}

TEST(PlotterNmea, FindsTheBearingAcrossTheDateLineAndBesideThePole) {
  auto own = MakeOwnShip();
  auto target = MakeTarget();
  own.position = {10.0, 179.9995};
  target.position = {10.0, -179.9995};
  EXPECT_NE(Ttm("RA", own, target, 1, Unit::kKilometres).find(",0.1096,90.00,T,"), std::string::npos);
  own.position = {89.9995, 0.0};
  target.position = {89.9995, 180.0};  // over the pole
  EXPECT_NE(Ttm("RA", own, target, 1, Unit::kKilometres).find(",0.1117,0.00,T,"), std::string::npos);
}

TEST(PlotterNmea, KeepsEverySentenceWithin82Characters) {
  auto target = MakeTarget(1'234'567'890'123);
  target.name = "structure 1234567890123";
  target.speed_mps = 1000.0;
  target.cpa_m = 99'999.0;
  target.tcpa_s = -999'999.0;
  auto own = MakeOwnShip();
  own.position.longitude_deg = -179.999;
  for (const auto unit : {Unit::kKilometres, Unit::kNauticalMiles}) EXPECT_LE(Ttm("RA", own, target, 99, unit).size(), kMaxSentenceBytes);
  EXPECT_LE(Tll("RA", target, 99, test::kTime).size(), kMaxSentenceBytes);
  EXPECT_LE(Rmc("II", own).size(), kMaxSentenceBytes);
}

TEST(PlotterNmea, LetsNoReservedCharacterThrough) {
  auto target = MakeTarget();
  target.name = "a,b$c*";
  const auto sentence = Ttm("RA", MakeOwnShip(), target, 5, Unit::kKilometres);
  EXPECT_FALSE(Line(sentence).empty());
  EXPECT_NE(sentence.find(",a b c ,T,"), std::string::npos);
}

TEST(PlotterNmea, NamesATargetByItsNumberWhereThereIsNoRoom) {
  auto target = MakeTarget(123'456);
  target.name = "structure 123456";
  EXPECT_NE(Ttm("RA", MakeOwnShip(), target, 5, Unit::kKilometres).find(",K,123456,T,"), std::string::npos);
}

TEST(PlotterNmea, CallsATargetAsPeopleDo) {
  auto target = MakeTarget();
  target.given_name = "Kiosk pier";
  EXPECT_NE(Ttm("RA", MakeOwnShip(), target, 5, Unit::kKilometres).find(",K,Kiosk pier,T,"), std::string::npos);
  EXPECT_NE(Tll("RA", target, 5, test::kTime).find(",Kiosk pier,"), std::string::npos);
  target.given_name = "Kj\xc3\xb8kken";  // no ASCII
  EXPECT_NE(Ttm("RA", MakeOwnShip(), target, 5, Unit::kKilometres).find(",K,boat 17,T,"), std::string::npos);
  target.given_name = "The buoy of Anna at the western channel";  // no room for all of it
  EXPECT_NE(Ttm("RA", MakeOwnShip(), target, 5, Unit::kKilometres).find(",K,boat 17,T,"), std::string::npos);
}

}  // namespace
}  // namespace lookout::plotter
