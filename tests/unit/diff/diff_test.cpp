#include "tools/diff/diff.hpp"

#include <sstream>

#include "lookout/alerts_t.hpp"
#include "tests/unit/log/small_log.hpp"

namespace lookout::diff {
namespace {

class Diff : public log_test::SmallLog {
 protected:
  std::ostringstream out_;
  std::ostringstream errors_;
  Request request_;

  int Compare(const std::vector<bus::LogEvent>& a, const std::vector<bus::LogEvent>& b) {
    request_.a = Write("a", a);
    request_.b = Write("b", b);
    out_.str("");
    return diff::Run(request_, out_, errors_);
  }
  bool Said(const std::string& text) const { return out_.str().find(text) != std::string::npos; }
};

TEST_F(Diff, EqualLogsAreEqualWhateverTheirTimesOrderOfChannelsAndRunInfo) {
  const auto noise = Event(start_, "NOISE", {1, 2});
  EXPECT_EQ(Compare({RunInfo(0), Pose(1, 0), noise, Pose(2, 1)}, {RunInfo(5, "0.2.0"), Pose(7, 0), Pose(8, 1), noise}), kExitEqual);
  EXPECT_TRUE(Said("equal: 2 channels, 3 messages\n")) << out_.str();
  EXPECT_TRUE(Said("left out: RUN_INFO\n"));
  EXPECT_EQ(Compare({}, {}), kExitEqual);
}

// They come by the host's clock: a live run has them, its replay has not.
TEST_F(Diff, AlertsThatComeWithoutAScanAreNotCompared) {
  alerts_t message{};
  const auto scan = Event(start_, "ALERTS", bus::Encode(message));
  message.is_watch = true;
  const auto watch = Event(start_, "ALERTS", bus::Encode(message));
  EXPECT_EQ(Compare({scan, watch, watch}, {scan}), kExitEqual) << out_.str();
  EXPECT_TRUE(Said("left out: 2 of ALERTS, which came without a scan\n")) << out_.str();
  EXPECT_EQ(Compare({scan, watch}, {}), kExitDifferent);
}

TEST_F(Diff, TellsTheFirstDifferenceByChannelTimeAndField) {
  EXPECT_EQ(Compare({Pose(1, 0), Pose(2, 1, 0.5), Pose(3, 2, 0.5)}, {Pose(1, 0), Pose(2, 1, 0.75), Pose(3, 2, 0.75)}), kExitDifferent);
  EXPECT_TRUE(Said(
      "POSE                         3         3         2         0         0  message 1 at 2027-01-15T08:00:02.000000Z: heading_rad: 0.5 | 0.75\n"))
      << out_.str();
  EXPECT_TRUE(Said("different: 1 of 1 channels\n"));
}

TEST_F(Diff, AMessageMoreIsADifference) {
  EXPECT_EQ(Compare({Pose(1, 0)}, {Pose(1, 0), Pose(2, 1)}), kExitDifferent);
  EXPECT_TRUE(Said("POSE                         1         2         0         0         1  message 1 at 2027-01-15T08:00:02.000000Z: only in B\n"))
      << out_.str();
  EXPECT_EQ(Compare({Pose(1, 0), Event(start_, "EXTRA", {1})}, {Pose(1, 0)}), kExitDifferent);
  EXPECT_TRUE(Said("different: 1 of 2 channels\n"));
}

TEST_F(Diff, NamesACutLogAsTheReasonOfWhatItLacksAtItsEnd) {
  const auto start = Packets(0, 0, lidar_packets_t::MARK_START);
  const auto end = Packets(3, 2, lidar_packets_t::MARK_END);
  EXPECT_EQ(Compare({start, Packets(1, 1), Pose(1, 0)}, {start, Packets(1, 1), Pose(1, 0), Pose(2, 1), end}), kExitDifferent);
  EXPECT_TRUE(Said("reason: A ends without an end mark of LIDAR_PACKETS: it was cut there, and lacks what was under way\n")) << out_.str();
  EXPECT_TRUE(Said("behind the last message of the other log B has: LIDAR_PACKETS 1, POSE 1\n")) << out_.str();
  EXPECT_FALSE(Said("reason: B")) << out_.str();
  // A cut log that holds more than a whole one has another reason.
  EXPECT_EQ(Compare({start, Packets(1, 1), Pose(1, 0), Pose(2, 1)}, {start, Packets(1, 1, lidar_packets_t::MARK_END), Pose(1, 0)}), kExitDifferent);
  EXPECT_FALSE(Said("reason")) << out_.str();
  EXPECT_EQ(Compare({start, Pose(1, 0)}, {start, Pose(1, 0)}), kExitEqual);
  EXPECT_FALSE(Said("reason")) << out_.str();
}

// A reason that is no reason sends people the wrong way.
TEST_F(Diff, NamesACutLogOnlyForWhatIsBehindItsEnd) {
  const auto start = Packets(0, 0, lidar_packets_t::MARK_START);
  // A channel that the cut log lacks altogether.
  EXPECT_EQ(Compare({start, Packets(1, 1)}, {start, Packets(1, 1), Pose(1, 0)}), kExitDifferent);
  EXPECT_FALSE(Said("reason")) << out_.str();
  EXPECT_FALSE(Said("behind")) << out_.str();
  // Logs that do not fit together: what is left over by number is not behind by time.
  std::vector<bus::LogEvent> a{start};
  std::vector<bus::LogEvent> b{start};
  for (int i = 0; i < 6; ++i) a.push_back(Pose(100 + i, 100 + i));
  for (int i = 0; i < 20; ++i) b.push_back(Pose(i, i));
  EXPECT_EQ(Compare(a, b), kExitDifferent);
  EXPECT_FALSE(Said("reason")) << out_.str();
  EXPECT_FALSE(Said("behind")) << out_.str();
  // Both were cut, one of them earlier.
  EXPECT_EQ(Compare({start, Packets(1, 1), Pose(1, 0)}, {start, Packets(1, 1), Pose(1, 0), Pose(2, 1)}), kExitDifferent);
  EXPECT_TRUE(Said("reason: A ends without an end mark")) << out_.str();
  EXPECT_FALSE(Said("reason: B")) << out_.str();
  // A difference that no cut explains.
  EXPECT_EQ(Compare({start, Packets(1, 1), Pose(1, 0, 0.5)}, {start, Packets(1, 1), Pose(1, 0, 0.75), Pose(2, 1)}), kExitDifferent);
  EXPECT_TRUE(Said("reason, perhaps: A ends without an end mark")) << out_.str();
  EXPECT_FALSE(Said("reason: ")) << out_.str();
}

TEST_F(Diff, NamesALogThatBeginsInTheMiddleOfARunAsTheReasonOfEarlyDifferences) {
  const auto start = NavRaw(0, 0, nav_raw_t::KIND_START);
  EXPECT_EQ(Compare({start, Pose(1, 0, 0.5), Pose(60, 1)}, {NavRaw(0, 7), Pose(1, 0, 0.75), Pose(60, 1)}), kExitDifferent);
  EXPECT_TRUE(Said("reason, perhaps: B begins without a start mark of NAV_RAW")) << out_.str();
  EXPECT_FALSE(Said("A begins")) << out_.str();
  EXPECT_EQ(Compare({NavRaw(0, 7), Pose(1, 0), Pose(60, 1, 0.5)}, {NavRaw(0, 7), Pose(1, 0), Pose(60, 1, 0.75)}), kExitDifferent);
  EXPECT_FALSE(Said("reason")) << "the clock fit has settled by then: " << out_.str();
}

TEST_F(Diff, SaysWhichLogHoldsTwoPublishersAndFromWhere) {
  std::vector<bus::LogEvent> one;
  std::vector<bus::LogEvent> two;
  const auto at = [&](int num_tenths, bus::LogEvent event) {
    event.time = start_ + std::chrono::milliseconds(100 * num_tenths);
    return event;
  };
  for (int i = 0; i < 10; ++i) {
    one.push_back(at(i, NavRaw(0, 100 + i)));
    two.push_back(at(i, NavRaw(0, 100 + i)));
    if (i > 4) two.push_back(at(i, NavRaw(0, i)));
  }
  EXPECT_EQ(Compare(one, two), kExitDifferent);
  EXPECT_TRUE(Said("B holds two publishers of NAV_RAW from event 6 on, 2027-01-15T08:00:00.500000Z: 4 messages are of the second\n")) << out_.str();
  EXPECT_TRUE(Said("from there on the log stands outside the proof"));
  EXPECT_FALSE(Said("A holds"));
  Compare(one, one);
  EXPECT_FALSE(Said("outside the proof"));
}

TEST_F(Diff, MessagesThatOneLogLacksAreSteppedOver) {
  std::vector<bus::LogEvent> a;
  std::vector<bus::LogEvent> b;
  for (int i = 0; i < 50; ++i) {
    if (i != 10 && i != 11) a.push_back(Pose(i, i));
    if (i != 20 && i < 48) b.push_back(Pose(i, i, i == 30 ? 0.0 : 1.0));
  }
  EXPECT_EQ(Compare(a, b), kExitDifferent);
  EXPECT_TRUE(Said("POSE                        48        47         1         3         2  message 10 at 2027-01-15T08:00:10.000000Z: only in B\n"))
      << out_.str();
}

TEST_F(Diff, LogsWithNothingInCommonAreComparedPairByPair) {
  std::vector<bus::LogEvent> a;
  std::vector<bus::LogEvent> b;
  for (int i = 0; i < 50; ++i) {
    a.push_back(Pose(i, i));
    b.push_back(Pose(i, 1000 + i));
  }
  EXPECT_EQ(Compare(a, b), kExitDifferent);
  EXPECT_TRUE(
      Said("POSE                        50        50        50         0         0  message 0 at 2027-01-15T08:00:00.000000Z: seq: 0 | 1000\n"))
      << out_.str();
}

TEST_F(Diff, ChannelsAreThoseAskedFor) {
  request_.channels = {"RUN_INFO"};
  EXPECT_EQ(Compare({RunInfo(0), Pose(0, 0)}, {RunInfo(0, "0.2.0"), Pose(0, 1)}), kExitDifferent);
  EXPECT_TRUE(Said(": version: \"0.1.0\" | \"0.2.0\"\n")) << out_.str();
  EXPECT_FALSE(Said("POSE"));
  request_.channels = {"NOSUCH"};
  EXPECT_EQ(Compare({Pose(0, 0)}, {Pose(0, 0)}), kExitUnreadable);
}

TEST_F(Diff, TolerancesOfAChannelComeOnTopOfThoseOfAll) {
  const std::vector<bus::LogEvent> a{Pose(0, 0, 1.0)};
  const std::vector<bus::LogEvent> b{Pose(0, 0, 1.01)};
  AddTolerance("heading_rad=0.001", request_);
  EXPECT_EQ(Compare(a, b), kExitDifferent);
  AddTolerance("POSE:heading_rad=0.1", request_);
  EXPECT_EQ(Compare(a, b), kExitEqual);
  AddTolerance("NOSUCH:heading_rad=0.1", request_);
  EXPECT_EQ(Compare(a, b), kExitUnreadable);
}

TEST_F(Diff, ATolerancesNameMustBeThatOfANumber) {
  AddTolerance("heding_rad=0.001", request_);
  EXPECT_EQ(Compare({Pose(0, 0)}, {Pose(0, 0)}), kExitUnreadable);
  EXPECT_NE(errors_.str().find("heding_rad"), std::string::npos);
  for (const char* wrong :
       {"", "heading_rad", "=1", "heading_rad=", "heading_rad=-1", "heading_rad=nan", "heading_rad=inf", "heading_rad=1 m", ":x=1", "POSE:=1"}) {
    EXPECT_THROW(AddTolerance(wrong, request_), std::runtime_error) << wrong;
  }
}

TEST_F(Diff, ALogThatCannotBeReadIsNeitherEqualNorDifferent) {
  SetContent(folder_ / "text", "this is no log");
  request_.a = request_.b = folder_ / "text";
  EXPECT_EQ(diff::Run(request_, out_, errors_), kExitUnreadable);
  request_.a = folder_ / "nowhere";
  EXPECT_EQ(diff::Run(request_, out_, errors_), kExitUnreadable);
  EXPECT_NE(errors_.str().find("nowhere"), std::string::npos);
}

TEST_F(Diff, DamageIsSaid) {
  request_.a = request_.b = Write("a", {Pose(1, 0), Pose(2, 1)});
  SetContent(folder_ / "a", Content(folder_ / "a") + "junk");
  EXPECT_EQ(diff::Run(request_, out_, errors_), kExitEqual);
  EXPECT_NE(errors_.str().find("1 damaged stretches"), std::string::npos);
}

// A log of a later version, or of somebody else.
TEST_F(Diff, ATypeThatThisVersionDoesNotKnowIsComparedByteByByte) {
  std::vector<std::uint8_t> message = log_test::kUnknownFingerprint;
  message.resize(24);
  auto other = message;
  other[23] = 9;
  EXPECT_EQ(Compare({Event(start_, "LATER", message)}, {Event(start_, "LATER", other)}), kExitDifferent);
  EXPECT_TRUE(Said("byte 23: 0x00 | 0x09\n")) << out_.str();
  EXPECT_EQ(Compare({Event(start_, "LATER", message)}, {Event(start_, "LATER", message)}), kExitEqual);
}

}  // namespace
}  // namespace lookout::diff
