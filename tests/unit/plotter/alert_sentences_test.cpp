#include "services/plotter/core/alert_sentences.hpp"

#include <gtest/gtest.h>

#include "services/plotter/core/nmea0183.hpp"
#include "tests/unit/plotter/made_up.hpp"

namespace lookout::plotter {
namespace {

using namespace std::chrono_literals;
using test::Line;
using test::MakeNotice;

TEST(PlotterAlertSentences, KeepWithin82CharactersAndLetNoReservedCharacterThrough) {
  auto notice = MakeNotice();
  notice.text = std::string(500, 'x');
  EXPECT_EQ(Alr("RA", notice, test::kTime).size(), kMaxSentenceBytes);
  const auto alf = Alf("RA", notice, test::kTime, 9, 99);
  const auto second = alf.find('$', 1);
  EXPECT_LE(second, kMaxSentenceBytes);
  EXPECT_EQ(alf.size() - second, kMaxSentenceBytes);
  notice.text = "two\r\n$lines, \xC3\xA9!\x7F~^\\";
  EXPECT_NE(Alr("RA", notice, test::kTime).find(",two   lines         *"), std::string::npos);
}

// Cases written by hand after IEC 61162-1.
TEST(PlotterAlertSentences, SaysAnAlertAsAlr) {
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
TEST(PlotterAlertSentences, SaysAnAlertInShortWordsAndCutsNone) {
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

TEST(PlotterAlertSentences, SaysAnAlertAsAlf) {
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

TEST(PlotterAlertSentences, ReadsWhatIsAskedOfWhichAlert) {
  const auto read = [](const std::string& body) {
    AlertCommand command;
    const auto sentence = Sentence(body);
    const auto kind = ReadLine(sentence.substr(0, sentence.size() - 2), command);
    return std::pair(kind, command);
  };
  const auto notice = MakeNotice();
  const auto [ack_kind, ack] = read("IIACK,003");
  EXPECT_EQ(ack_kind, LineKind::kCommand);
  EXPECT_TRUE(Means(ack, notice));
  EXPECT_FALSE(Means(ack, MakeNotice(4)));
  const auto [acn_kind, acn] = read("IIACN,102031.00,LKO,10002,3,A,C");
  EXPECT_EQ(acn_kind, LineKind::kCommand);
  EXPECT_TRUE(Means(acn, notice));
  auto other_cause = notice;
  other_cause.cause = Cause::kGuardZone;
  EXPECT_TRUE(Means(acn, other_cause)) << "one danger is one alert, whichever cause weighs most now";
  other_cause.cause = Cause::kWatch;
  EXPECT_FALSE(Means(acn, other_cause));

  EXPECT_EQ(acn.kind, AlertCommand::Kind::kAcknowledge);
  EXPECT_EQ(read("IIACN,102031.00,LKO,10002,3,S,C").second.kind, AlertCommand::Kind::kSilence);
  EXPECT_EQ(read("IIACN,102031.00,LKO,10002,3,Q,C").second.kind, AlertCommand::Kind::kTellAgain);
  EXPECT_EQ(read("IIACN,102031.00,LKO,10002,3,O,C").second.kind, AlertCommand::Kind::kHandOver);
  EXPECT_EQ(read("IIACN,102031.00,LKO,10002,3,,C").first, LineKind::kWrong);
  EXPECT_EQ(read("IIACN,102031.00,LKO,10002,3,X,C").first, LineKind::kWrong);
  EXPECT_EQ(read("IIACN,102031.00,LKO,10002,3,A,R").first, LineKind::kWrong) << "no command";
  EXPECT_EQ(read("IIACN,102031.00,XYZ,10002,3,A,C").first, LineKind::kOther);  // of another maker
  EXPECT_EQ(read("GPGGA,1,2,3").first, LineKind::kOther);
  EXPECT_EQ(read("IIACK,").first, LineKind::kWrong);
  EXPECT_EQ(read("IIACK,abc").first, LineKind::kWrong);
  EXPECT_EQ(read("IIACN,102031.00,LKO").first, LineKind::kWrong);
  AlertCommand command;
  EXPECT_EQ(ReadLine("$IIACK,003*00", command), LineKind::kWrong);
  EXPECT_EQ(ReadLine("", command), LineKind::kWrong);
  EXPECT_EQ(ReadLine("\x01\x02{}", command), LineKind::kWrong);
}

TEST(PlotterAlertSentences, NumbersAlertsFrom1To997AndKeepsThreeForItsOwn) {
  EXPECT_EQ(AlarmNumber(MakeNotice(1)), 1);
  EXPECT_EQ(AlarmNumber(MakeNotice(997)), 997);
  EXPECT_EQ(AlarmNumber(MakeNotice(998)), 1);
  EXPECT_EQ(AlarmNumber(MakeNotice(-5)), 0);
  auto own = MakeNotice(0);
  own.cause = Cause::kWatch;
  EXPECT_EQ(AlarmNumber(own), 998);
  own.cause = Cause::kPosition;
  EXPECT_EQ(AlarmNumber(own), 999);
  EXPECT_NE(Alf("RA", own, test::kTime, 0, 1).find(",10004,999999,1,0,NO OWN POSITION*"), std::string::npos);
  auto gap = MakeNotice(5);
  gap.cause = Cause::kPartUnseen;
  EXPECT_NE(Alf("RA", gap, test::kTime, 0, 1).find(",10005,5,1,0,LOOK-OUT GAP*"), std::string::npos);
}

TEST(PlotterAlertSentences, ListAllThatStandInAsManySentencesAsItTakes) {
  EXPECT_EQ(Line(Alc("RA", {}, 0)), "$RAALC,01,01,00,0");
  EXPECT_EQ(Line(Alc("RA", std::vector<ToldNotice>{{MakeNotice(3), 2}, {MakeNotice(4), 99}}, 7)), "$RAALC,01,01,07,2,LKO,10002,3,2,LKO,10002,4,99");
  std::vector<ToldNotice> many;
  for (int id = 999'001; id <= 999'400; ++id) many.push_back({MakeNotice(id), 99});
  const auto lines = Alc("RA", many, 99);
  EXPECT_EQ(lines.find("$RAALC,99,01,99,3,LKO,10002,999001,99,LKO,10002,999002,99,LKO,10002,999003,99*"), 0U)
      << "what is beyond 99 sentences is left out";
  std::size_t num_lines = 0;
  for (std::size_t at = 0; at < lines.size(); ++num_lines) {
    const auto end = lines.find("\r\n", at) + 2;
    EXPECT_LE(end - at, kMaxSentenceBytes);
    Line(lines.substr(at, end - at));
    at = end;
  }
  EXPECT_EQ(num_lines, 99U);
}

TEST(PlotterAlertSentences, SayThatTheProcessLivesAndWhatItRefuses) {
  EXPECT_EQ(Line(Hbt("RA", 30s, true, 4)), "$RAHBT,30,A,4");
  EXPECT_EQ(Line(Hbt("RA", 30s, false, 5)), "$RAHBT,30,V,5");
  const AlertCommand command{.kind = AlertCommand::Kind::kHandOver, .number = 3, .identifier = 10002};
  EXPECT_EQ(Line(Arc("RA", command, test::kTime)), "$RAARC,102030.45,LKO,10002,3,O");
}

}  // namespace
}  // namespace lookout::plotter
