#include "services/plotter/core/nmea2000.hpp"

#include <fmt/format.h>

#include <gtest/gtest.h>

#include "tests/unit/plotter/made_up.hpp"

namespace lookout::plotter {
namespace {

using test::Deg;
using test::MakeOwnShip;
using test::MakeTarget;

std::string Hex(const N2kMessage& message) {
  std::string text;
  for (const auto byte : message.payload) text += fmt::format("{:02X}", byte);
  return text;
}

// Payloads as canboatjs 3.20 packs the same values, but for the sid, which is "not available" here.
TEST(PlotterN2k, SaysTheOwnShip) {
  OwnShip own{.time = test::kTime, .position = {54.1234567, -10.9876543}, .speed_mps = 2.34, .course_rad = 1.2345};
  EXPECT_EQ(Hex(PositionMessage(own)), "87954220C16A73F9");
  EXPECT_EQ(Hex(CourseMessage(own)), "FFFC3930EA00FFFF");
  own.course_rad = kNan;
  own.speed_mps = kNan;
  EXPECT_EQ(Hex(CourseMessage(own)), "FFFCFFFFFFFFFFFF");
}

// 17:33:21.107 UTC; range and bearing are those of the position, to a unit.
Target TargetAt(const OwnShip& own, double range_m, double bearing_rad) {
  Target target;
  target.position = Propagated(own.position, range_m * std::sin(bearing_rad), range_m * std::cos(bearing_rad), 1.0);
  target.name = "L17";
  target.speed_mps = 2.34;
  target.course_rad = 3.1416;
  target.cpa_m = 5.67;
  target.tcpa_s = 21.5;
  return target;
}

OwnShip OwnShipAt173321() {
  auto own = MakeOwnShip();
  own.time = Utime(std::chrono::sys_days(std::chrono::year(2026) / 7 / 1)) + std::chrono::milliseconds(63'201'107);
  return own;
}

TEST(PlotterN2k, SaysATarget) {
  const auto own = OwnShipAt173321();
  const auto message = TargetMessage(own, TargetAt(own, 60.12, 1.2345), 17);
  EXPECT_EQ(message.pgn, 128520U);
  EXPECT_EQ(Hex(message), "FF1100CA39307C170000B87AEA0037020000FC5300003EB9AB2505014C3137FC");
}

// A frame of a Raymarine display: target 1, acquired by hand, at 1.3788 rad and 53.00 m, closest approach 52.04 m in 2 s, at 19:42:54.407 UTC. It
// differs from ours in the bit of how the target was acquired, and in the two bits of its last byte that say what kind of target it refers to.
TEST(PlotterN2k, SaysATargetAsARaymarineDisplayDoes) {
  auto own = MakeOwnShip();
  own.time = Utime(std::chrono::sys_days(std::chrono::year(2026) / 7 / 1)) + std::chrono::microseconds(70'974'407'000);
  auto target = TargetAt(own, 53.0, 1.3788);
  target.state = TargetState::kAcquiring;
  target.name = "TGT 01";
  target.course_rad = 0.0;
  target.speed_mps = 0.0;
  target.cpa_m = 52.04;
  target.tcpa_s = 2.0;
  auto message = TargetMessage(own, target, 1);
  message.payload.at(3) &= 0b1111'0111U;
  message.payload.back() |= 0b11U;
  EXPECT_EQ(Hex(message), "FF0100C1DC35B41400000000000054140000D0070000C6D54D2A0801544754203031FF");
}

TEST(PlotterN2k, SaysWhatIsNotKnown) {
  const auto own = OwnShipAt173321();
  auto target = TargetAt(own, 60.12, 1.2345);
  target.course_rad = kNan;
  target.speed_mps = kNan;
  target.cpa_m = kNan;
  target.tcpa_s = -3.5;
  target.name = "";
  target.state = TargetState::kLost;
  EXPECT_EQ(Hex(TargetMessage(own, target, 17)), "FF1100CB39307C170000FFFFFFFFFFFFFF7F54F2FFFF3EB9AB250201FC");
}

TEST(PlotterN2k, WrapsAnglesThatRoundToTheWholeCircle) {
  auto own = MakeOwnShip();
  own.course_rad = 6.28318;
  EXPECT_EQ(Hex(CourseMessage(own)).substr(4, 4), "0000");
  own.course_rad = 6.28312;
  EXPECT_EQ(Hex(CourseMessage(own)).substr(4, 4), "6FF5");  // 62831
}

TEST(PlotterN2k, WritesOneLineForActisense) {
  const auto own = OwnShipAt173321();
  EXPECT_EQ(ActisenseLine(TargetMessage(own, TargetAt(own, 60.12, 1.2345), 17), own.time),
            "A173321.107 23FF2 1F608 FF1100CA39307C170000B87AEA0037020000FC5300003EB9AB2505014C3137FC\r\n");
}

TEST(PlotterN2k, CutsAFastPacketIntoFramesForYden) {
  const auto own = OwnShipAt173321();
  EXPECT_EQ(YdenLines(TargetMessage(own, TargetAt(own, 60.12, 1.2345), 17), own.time, 3),
            "17:33:21.107 R 09F60823 60 20 FF 11 00 CA 39 30\r\n"
            "17:33:21.107 R 09F60823 61 7C 17 00 00 B8 7A EA\r\n"
            "17:33:21.107 R 09F60823 62 00 37 02 00 00 FC 53\r\n"
            "17:33:21.107 R 09F60823 63 00 00 3E B9 AB 25 05\r\n"
            "17:33:21.107 R 09F60823 64 01 4C 31 37 FC FF FF\r\n");
  EXPECT_EQ(YdenLines(CourseMessage({.speed_mps = 2.34, .course_rad = 1.2345}), own.time, 0), "17:33:21.107 R 09F80223 FF FC 39 30 EA 00 FF FF\r\n");
}

}  // namespace
}  // namespace lookout::plotter
