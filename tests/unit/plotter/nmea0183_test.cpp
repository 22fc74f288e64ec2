#include "services/plotter/core/nmea0183.hpp"

#include <gtest/gtest.h>

#include "common/core/sentence.hpp"
#include "tests/unit/plotter/made_up.hpp"

namespace lookout::plotter {
namespace {

using test::Deg;
using test::MakeNotice;
using test::MakeOwnShip;
using test::MakeTarget;

// Without checksum and CR LF, which must be right.
std::string Line(const std::string& sentence) {
  EXPECT_TRUE(sentence.ends_with("\r\n"));
  EXPECT_EQ(Frame(std::string_view(sentence).substr(0, sentence.size() - 2)).fault, SentenceFault::kNone);
  return sentence.substr(0, sentence.size() - 5);
}

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
  auto notice = MakeNotice();
  notice.text = std::string(500, 'x');
  for (const auto unit : {Unit::kKilometres, Unit::kNauticalMiles}) EXPECT_LE(Ttm("RA", own, target, 99, unit).size(), kMaxSentenceBytes);
  EXPECT_LE(Tll("RA", target, 99, test::kTime).size(), kMaxSentenceBytes);
  EXPECT_LE(Rmc("II", own).size(), kMaxSentenceBytes);
  EXPECT_EQ(Alr("RA", notice, test::kTime).size(), kMaxSentenceBytes);
  const auto alf = Alf("RA", notice, test::kTime, 9, 99);
  const auto second = alf.find('$', 1);
  EXPECT_LE(second, kMaxSentenceBytes);
  EXPECT_EQ(alf.size() - second, kMaxSentenceBytes);
}

TEST(PlotterNmea, LetsNoReservedCharacterThrough) {
  auto target = MakeTarget();
  target.name = "a,b$c*";
  const auto sentence = Ttm("RA", MakeOwnShip(), target, 5, Unit::kKilometres);
  EXPECT_FALSE(Line(sentence).empty());
  EXPECT_NE(sentence.find(",a b c ,T,"), std::string::npos);
  auto notice = MakeNotice();
  notice.text = "two\r\n$lines, \xC3\xA9!\x7F~^\\";
  EXPECT_NE(Alr("RA", notice, test::kTime).find(",two   lines         *"), std::string::npos);
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

// Cases written by hand after IEC 61162-1.
TEST(PlotterNmea, SaysAnAlertAsAlr) {
  auto notice = MakeNotice();
  EXPECT_EQ(Line(Alr("RA", notice, test::kTime)), "$RAALR,102030.45,003,A,V,boat 17: CPA 3 m in 21 s  40 deg to starboard");
  notice.state = NoticeState::kAcknowledged;
  EXPECT_NE(Alr("RA", notice, test::kTime).find(",003,A,A,"), std::string::npos);
  notice.state = NoticeState::kRectified;
  EXPECT_NE(Alr("RA", notice, test::kTime).find(",003,V,V,"), std::string::npos);
  notice.state = NoticeState::kCleared;
  EXPECT_NE(Alr("RA", notice, test::kTime).find(",003,V,A,"), std::string::npos);
}

// A plotter once showed "40 deg to sta": the text was cut in the middle of its most useful word.
TEST(PlotterNmea, SaysAnAlertInShortWordsAndCutsNone) {
  auto notice = MakeNotice();
  const auto said = [&notice](const std::string& text) {
    notice.text = text;
    const auto alr = Line(Alr("RA", notice, test::kTime));
    return alr.substr(alr.rfind(',') + 1);
  };
  EXPECT_EQ(said("structure 123 in the guard zone: 12.3 m, 123 deg to starboard"), "structure 123 in zone: 12.3 m  123 deg to starboard");
  EXPECT_EQ(said("structure 1234567 in the guard zone: 12.3 m, 123 deg to starboard"), "structure 1234567 in zone: 12.3 m  123 deg stbd");
  EXPECT_EQ(said("obstacle 123456: closest approach 12 m in 120 s, 123 deg to port"), "obstacle 123456: CPA 12 m in 120 s  123 deg to port");
  EXPECT_EQ(said("land in the guard zone: 2.7 m, 10 deg to port"), "land in the guard zone: 2.7 m  10 deg to port");
  EXPECT_EQ(said("no look-out: less than three of the whole scans came, within a time of 0.5 s"),
            "no look-out: less than three of the whole scans came");
  EXPECT_EQ(said(std::string(40, 'x') + " " + std::string(40, 'y')), std::string(40, 'x'));
}

TEST(PlotterNmea, SaysAnAlertAsAlf) {
  auto notice = MakeNotice();
  notice.text = "boat 17: closest approach 3 m";
  const auto text = Alf("RA", notice, test::kTime, 4, 2);
  EXPECT_EQ(text,
            Sentence("RAALF,2,1,4,102030.45,B,W,V,LKO,10002,3,2,0,CLOSE APPROACH") + Sentence("RAALF,2,2,4,,,,,,,,,,boat 17: closest approach 3 m"));
  notice.sound = Sound::kSilenced;
  EXPECT_NE(Alf("RA", notice, test::kTime, 4, 2).find(",B,W,S,LKO,"), std::string::npos);
  notice.sound = Sound::kSounds;
  // A receiver that was told of it by one identifier is told of its end by the same.
  notice.cause = Cause::kGuardZone;
  EXPECT_EQ(Alf("RA", notice, test::kTime, 4, 2), text);
  notice.level = Level::kCaution;
  EXPECT_NE(Alf("RA", notice, test::kTime, 4, 2).find(",B,C,A,LKO,"), std::string::npos);
  notice.state = NoticeState::kCleared;
  EXPECT_NE(Alf("RA", notice, test::kTime, 4, 2).find(",B,C,N,LKO,"), std::string::npos);
}

TEST(PlotterNmea, ReadsWhichAlertIsAcknowledged) {
  const auto read = [](const std::string& body) {
    AcknowledgedNumber acknowledged;
    const auto sentence = Sentence(body);
    const auto kind = ReadLine(sentence.substr(0, sentence.size() - 2), acknowledged);
    return std::pair(kind, acknowledged);
  };
  const auto notice = MakeNotice();
  const auto [ack_kind, ack] = read("IIACK,003");
  EXPECT_EQ(ack_kind, LineKind::kAcknowledgement);
  EXPECT_TRUE(Means(ack, notice));
  EXPECT_FALSE(Means(ack, MakeNotice(4)));
  const auto [acn_kind, acn] = read("IIACN,102031.00,LKO,10002,3,A,C");
  EXPECT_EQ(acn_kind, LineKind::kAcknowledgement);
  EXPECT_TRUE(Means(acn, notice));
  auto other_cause = notice;
  other_cause.cause = Cause::kGuardZone;
  EXPECT_TRUE(Means(acn, other_cause)) << "one danger is one alert, whichever cause weighs most now";
  other_cause.cause = Cause::kWatch;
  EXPECT_FALSE(Means(acn, other_cause));

  EXPECT_EQ(read("IIACN,102031.00,LKO,10002,3,S,C").first, LineKind::kOther);  // silenced only
  EXPECT_EQ(read("IIACN,102031.00,XYZ,10002,3,A,C").first, LineKind::kOther);  // of another maker
  EXPECT_EQ(read("GPGGA,1,2,3").first, LineKind::kOther);
  EXPECT_EQ(read("IIACK,").first, LineKind::kWrong);
  EXPECT_EQ(read("IIACK,abc").first, LineKind::kWrong);
  EXPECT_EQ(read("IIACN,102031.00,LKO").first, LineKind::kWrong);
  AcknowledgedNumber acknowledged;
  EXPECT_EQ(ReadLine("$IIACK,003*00", acknowledged), LineKind::kWrong);
  EXPECT_EQ(ReadLine("", acknowledged), LineKind::kWrong);
  EXPECT_EQ(ReadLine("\x01\x02{}", acknowledged), LineKind::kWrong);
}

TEST(PlotterNmea, NumbersAlertsFrom1To997AndKeepsThreeForItsOwn) {
  EXPECT_EQ(AlarmNumber(MakeNotice(1)), 1);
  EXPECT_EQ(AlarmNumber(MakeNotice(997)), 997);
  EXPECT_EQ(AlarmNumber(MakeNotice(998)), 1);
  EXPECT_EQ(AlarmNumber(MakeNotice(-5)), 0);
  auto own = MakeNotice(0);
  own.cause = Cause::kWatch;
  EXPECT_EQ(AlarmNumber(own), 998);
  own.cause = Cause::kPosition;
  EXPECT_EQ(AlarmNumber(own), 999);
  EXPECT_NE(Alf("RA", own, test::kTime, 0, 1).find(",10004,1,1,0,NO OWN POSITION*"), std::string::npos);
  auto gap = MakeNotice(5);
  gap.cause = Cause::kPartUnseen;
  EXPECT_NE(Alf("RA", gap, test::kTime, 0, 1).find(",10005,5,1,0,LOOK-OUT GAP*"), std::string::npos);
}

}  // namespace
}  // namespace lookout::plotter
