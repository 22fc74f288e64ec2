// An autopilot as a source: from its messages to measurements and poses.
#include <cmath>
#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "lookout/attitude_t.hpp"
#include "lookout/gnss_fix_t.hpp"
#include "services/navigator/core/mavlink_lines.hpp"
#include "services/navigator/core/navigator.hpp"
#include "services/navigator/service.hpp"
#include "tests/support/files.hpp"
#include "tests/support/memory_bus.hpp"
#include "tests/unit/navigator/filter_params.hpp"
#include "tests/unit/navigator/interpreter_fixture.hpp"
#include "tests/unit/navigator/mavlink_frames.hpp"

namespace lookout::navigator {
namespace {

using std::chrono::milliseconds;

SourceParams Pilot() {
  SourceParams source;
  source.name = "pilot";
  source.protocol = Protocol::kMavlink;
  source.latency = milliseconds(30);
  return source;
}

class AutopilotTest : public InterpreterTest {
 protected:
  AutopilotTest() { Configure(Pilot()); }
  Reading ReadFrame(double time_s, const std::string& frame) { return Read(time_s, ToMavlinkLine(frame), "pilot"); }
  void ConfigureRole(Role role) {
    auto source = Pilot();
    source.role = role;
    Configure(source);
  }
};

TEST_F(AutopilotTest, GivesAnAttitudeOfItsArrivalLessTheLatency) {
  const auto reading = ReadFrame(1.0, golden::kAttitude);
  ASSERT_TRUE(reading.attitude && reading.turn_rate && !reading.fix);
  EXPECT_EQ(reading.attitude->when.time, NoonPlus(0.97));
  EXPECT_EQ(reading.attitude->source, "pilot");
  EXPECT_EQ(reading.attitude->sentence_type, "PLKMAV");
  EXPECT_NEAR(reading.attitude->heading_rad, WrapTo2Pi(-0.25), 1e-8);
  EXPECT_NEAR(reading.attitude->roll_rad, 0.05, 1e-8);
  EXPECT_NEAR(reading.attitude->pitch_rad, 0.02, 1e-8);
  EXPECT_TRUE(std::isnan(reading.attitude->heading_sd_rad)) << "that of config counts";
  EXPECT_EQ(reading.turn_rate->rate_radps, 0.125);
  EXPECT_EQ(Count("pilot_understood"), 1);
}

// An estimate that goes on without a fix looked like a fix.
TEST_F(AutopilotTest, HasAPlaceOnlyWhileItsReceiverHasAFix) {
  EXPECT_EQ(ReadFrame(0.0, PositionFrame(1000, 54.0, 10.0)).fix->quality, FixQuality::kNone) << "before a word of the receiver";
  ReadFrame(0.1, GpsFrame(3));
  const auto fix = ReadFrame(0.2, golden::kPosition).fix;
  EXPECT_EQ(fix->quality, FixQuality::kGnss);
  EXPECT_EQ(fix->when.time, NoonPlus(0.17));
  EXPECT_NEAR(fix->position->latitude_deg, 54.1234567, 1e-12);
  EXPECT_NEAR(fix->speed_mps, 5.0, 1e-12);
  EXPECT_NEAR(fix->course_rad, WrapTo2Pi(-std::atan2(4.0, 3.0)), 1e-12);
  EXPECT_EQ(fix->num_satellites, 12);
  EXPECT_EQ(ReadFrame(2.1, PositionFrame(124'000, 54.0, 10.0)).fix->quality, FixQuality::kGnss) << "2 s old";
  EXPECT_EQ(ReadFrame(2.2, PositionFrame(124'100, 54.0, 10.0)).fix->quality, FixQuality::kNone);
  for (const int fix_type : {0, 1, 2, 7, 9, 255}) {
    ReadFrame(3.0, GpsFrame(3));
    ReadFrame(3.0, GpsFrame(fix_type));
    EXPECT_EQ(ReadFrame(3.0, PositionFrame(130'000U + static_cast<unsigned>(fix_type), 54.0, 10.0)).fix->quality, FixQuality::kNone) << fix_type;
  }
  EXPECT_EQ(Count("unmeasured_mavlink"), 8);
  ReadFrame(4.0, GpsFrame(6));
  EXPECT_EQ(ReadFrame(4.0, PositionFrame(140'000, 54.0, 10.0)).fix->quality, FixQuality::kRtkFixed);
  interpreter_.Reset();
  EXPECT_EQ(ReadFrame(4.1, PositionFrame(140'100, 54.0, 10.0)).fix->quality, FixQuality::kNone) << "a start mark";
}

TEST_F(AutopilotTest, StatesWhatItsReceiverStatesAndNoLessThanAnEstimateCanBe) {
  ReadFrame(0.0, golden::kGps);
  auto fix = *ReadFrame(0.0, golden::kPosition).fix;
  EXPECT_NEAR(fix.horizontal_sd_m, 0.8, 1e-12);
  EXPECT_NEAR(fix.vertical_sd_m, 1.5, 1e-12);
  EXPECT_NEAR(fix.velocity_sd_mps, 0.12, 1e-12);
  EXPECT_NEAR(fix.EllipsoidHeightM(), 12.345 + 43.0, 1e-9);
  EXPECT_NEAR(ReadFrame(0.0, golden::kAttitude).attitude->heading_sd_rad, DegToRad(2.5), 1e-9);
  // RTK: the estimate's errors last, and so it must not count as a phase solution or as two antennas.
  ReadFrame(1.0, GpsFrame(6, 14, 20'000, 4500));
  EXPECT_EQ(ReadFrame(1.0, PositionFrame(125'000, 54.0, 10.0)).fix->horizontal_sd_m, 0.2);
  EXPECT_NEAR(ReadFrame(1.0, AttitudeFrame(125'000, 0.0F, 0.0F, 0.0F)).attitude->heading_sd_rad, DegToRad(1.0), 1e-12);
  // Without accuracies one without correction, whatever the solution.
  ReadFrame(2.0, GpsFrame(6, 0, 0, 0, false));
  EXPECT_EQ(ReadFrame(2.0, PositionFrame(126'000, 54.0, 10.0)).fix->horizontal_sd_m, 2.5);
}

TEST_F(AutopilotTest, CountsWhatComesByTwoWaysOnce) {
  EXPECT_TRUE(ReadFrame(0.0, AttitudeFrame(10'000, 0.0F, 0.0F, 0.0F)).attitude);
  EXPECT_TRUE(ReadFrame(0.1, AttitudeFrame(10'100, 0.0F, 0.0F, 0.0F)).attitude);
  EXPECT_FALSE(ReadFrame(0.1, AttitudeFrame(10'100, 0.0F, 0.0F, 0.0F)).attitude);
  EXPECT_FALSE(ReadFrame(0.1, AttitudeFrame(10'000, 0.0F, 0.0F, 0.0F)).attitude) << "by the slower way";
  ReadFrame(0.1, GpsFrame(3));
  EXPECT_TRUE(ReadFrame(0.1, PositionFrame(10'100, 54.0, 10.0)).fix);
  EXPECT_FALSE(ReadFrame(0.1, PositionFrame(10'100, 54.0, 10.0)).fix);
  EXPECT_EQ(Count("repeated_mavlink"), 3);
  EXPECT_TRUE(ReadFrame(0.2, AttitudeFrame(200, 0.0F, 0.0F, 0.0F)).attitude) << "it was switched off and on";
}

// Copies made each new message look like one that had waited in a queue, for ever.
TEST_F(AutopilotTest, HasEachPlaceThatComesByTwoWaysSlowly) {
  int num_fixes = 0;
  for (int i = 0; i < 40; ++i) {
    const auto boot_ms = static_cast<std::uint32_t>(10'000 + 500 * i);
    ReadFrame(0.5 * i, GpsFrame(3));
    num_fixes += ReadFrame(0.5 * i, PositionFrame(boot_ms, 54.0, 10.0)).fix ? 1 : 0;
    EXPECT_FALSE(ReadFrame(0.5 * i + 0.01, PositionFrame(boot_ms, 54.0, 10.0)).fix);
  }
  EXPECT_EQ(num_fixes, 40);
}

TEST_F(AutopilotTest, ThatKnowsNoPlaceHasNone) {
  ReadFrame(0.0, GpsFrame(3));
  EXPECT_FALSE(ReadFrame(0.0, PositionFrame(1000, 0.0, 0.0)).fix);
  EXPECT_EQ(Count("null_fix"), 1);
  EXPECT_TRUE(std::isnan(ReadFrame(0.1, PositionFrame(1100, 54.0, 10.0, 0.1, 0.1)).fix->course_rad)) << "at rest there is no course";
}

TEST_F(AutopilotTest, KeepsToItsRole) {
  ConfigureRole(Role::kAttitude);
  ReadFrame(0.0, GpsFrame(3));
  EXPECT_FALSE(ReadFrame(0.0, PositionFrame(1000, 54.0, 10.0)).fix);
  EXPECT_TRUE(ReadFrame(0.0, golden::kAttitude).attitude);
  ConfigureRole(Role::kGnss);
  ReadFrame(0.0, GpsFrame(3));
  EXPECT_TRUE(ReadFrame(0.0, PositionFrame(1000, 54.0, 10.0)).fix);
  EXPECT_FALSE(ReadFrame(0.0, golden::kAttitude).attitude);
  ConfigureRole(Role::kHeading);
  EXPECT_TRUE(std::isnan(ReadFrame(0.0, golden::kAttitude).attitude->roll_rad));
}

TEST_F(AutopilotTest, IsNotBelievedFromAnotherInput) {
  const auto line = ToMavlinkLine(golden::kAttitude);
  EXPECT_FALSE(Read(0.0, line, "udp").attitude);
  EXPECT_EQ(Count("unexpected_mavlink"), 1);
  EXPECT_EQ(Count("udp_refused"), 1);
  EXPECT_FALSE(Read(0.0, HdtLine(10.0), "pilot").attitude) << "nor does its own speak NMEA 0183";
  EXPECT_EQ(Count("pilot_refused"), 1);
}

Navigator MakeNavigator(bool is_autopilot) {
  NavigatorParams params;
  params.max_sentence_latency = milliseconds(500);
  params.position_sd_m = 2.5;
  params.filter = TestFilterParams();
  if (is_autopilot) {
    params.sources.push_back(Pilot());
    params.sources.back().latency.reset();
  }
  return Navigator(params);
}

Pose LastPoseOf(Navigator& navigator, const std::vector<std::string>& lines) {
  std::int64_t seq = 0;
  std::optional<Pose> last;
  const auto consume = [&](const Item& item) {
    for (const auto& pose : navigator.Consume(item).poses) last = pose;
  };
  consume({NoonPlus(0), seq++, ItemKind::kStart, {}, {}});
  for (const auto& line : lines) consume({NoonPlus(0.001), seq++, ItemKind::kSentence, "pilot", line});
  consume({NoonPlus(0.1), seq++, ItemKind::kTick, {}, {}});
  return *last;
}

// Starboard rail down by 5 deg, bow up by 3 deg, heading 100 deg: PASHR says the same with the signs that are held elsewhere. Any sign that is turned
// moves the pose by degrees.
TEST(Autopilot, MeansTheSameAsAnAttitudeSensor) {
  auto pilot = MakeNavigator(true);
  auto sensor = MakeNavigator(false);
  const auto rad = [](double angle_deg) { return static_cast<float>(DegToRad(angle_deg)); };
  const auto by_pilot = LastPoseOf(pilot, {ToMavlinkLine(GpsFrame(3)), ToMavlinkLine(PositionFrame(1000, 54.0, 10.0, -2.0, 3.0)),
                                           ToMavlinkLine(AttitudeFrame(1000, rad(5.0), rad(3.0), rad(100.0)))});
  const double course_deg = RadToDeg(std::atan2(3.0, -2.0));
  const auto by_sensor =
      LastPoseOf(sensor, {RmcLine(NoonPlus(0.001), 54.0, 10.0, std::hypot(2.0, 3.0), course_deg), PashrLine(NoonPlus(0.001), 100.0, 5.0, 3.0, 0.0)});
  EXPECT_EQ(by_pilot.status, PoseStatus::kOk);
  EXPECT_EQ(by_pilot.heading_source, HeadingSource::kPashr);
  EXPECT_NEAR(RadToDeg(by_pilot.heading_rad), RadToDeg(by_sensor.heading_rad), 0.02);
  EXPECT_NEAR(RadToDeg(by_pilot.roll_rad), RadToDeg(by_sensor.roll_rad), 0.02);
  EXPECT_NEAR(RadToDeg(by_pilot.pitch_rad), RadToDeg(by_sensor.pitch_rad), 0.02);
  EXPECT_NEAR(RadToDeg(by_pilot.roll_rad), 5.0, 0.1);
  EXPECT_NEAR(RadToDeg(by_pilot.pitch_rad), 3.0, 0.1);
  EXPECT_LT((by_pilot.velocity_map_mps - by_sensor.velocity_map_mps).head<2>().norm(), 0.05);
  EXPECT_NEAR(by_pilot.velocity_map_mps.x(), 3.0, 0.1) << "east";
  EXPECT_NEAR(by_pilot.velocity_map_mps.y(), -2.0, 0.1) << "north";
}

TEST(Autopilot, WhoseReceiverHasNoFixGivesAHeadingAndNoPosition) {
  auto navigator = MakeNavigator(true);
  const auto pose = LastPoseOf(navigator, {ToMavlinkLine(golden::kNoFix), ToMavlinkLine(PositionFrame(1000, 54.0, 10.0)),
                                           ToMavlinkLine(AttitudeFrame(1000, 0.0F, 0.0F, 1.0F))});
  EXPECT_EQ(pose.status, PoseStatus::kNoPosition);
  EXPECT_NEAR(pose.heading_rad, 1.0, 0.01);
}

// Through the process: bytes go into NAV_RAW as lines, and what is no frame of this autopilot is counted.
TEST(Autopilot, EntersNavRawByItsOwnInput) {
  auto params = LoadParams(support::kDemoConfig.string());
  params.navigator.sources.push_back(Pilot());
  bus::MemoryBus bus;
  Service service(bus, params);
  std::vector<nav_raw_t> raw;
  std::vector<attitude_t> attitudes;
  std::vector<gnss_fix_t> fixes;
  bus::Subscribe<nav_raw_t>(bus, bus::kNavRaw, [&raw](const nav_raw_t& message) { raw.push_back(message); });
  bus::Subscribe<attitude_t>(bus, bus::kAttitude, [&attitudes](const attitude_t& message) { attitudes.push_back(message); });
  bus::Subscribe<gnss_fix_t>(bus, bus::kGnssFix, [&fixes](const gnss_fix_t& message) { fixes.push_back(message); });
  service.OnDatagram(NoonPlus(0.0), ToBytes(golden::kGps + golden::kPosition.substr(0, 15)), "pilot", "10.0.0.5 14550");
  service.OnDatagram(NoonPlus(0.01), ToBytes(golden::kPosition.substr(15)), "pilot", "10.0.0.5 14550");
  service.OnStream(NoonPlus(0.02), ToBytes("noise" + golden::kAttitude + golden::kAttitudeOfSystem42), "pilot");
  service.OnStream(NoonPlus(0.03), ToBytes(golden::kAttitude1.substr(0, 10)), "pilot");
  service.OnStreamEnd("pilot");
  service.OnStream(NoonPlus(0.04), ToBytes(golden::kAttitude1.substr(10)), "pilot");
  // The text of a frame on an input of NMEA 0183, and a sentence on that of the autopilot.
  service.OnDatagram(NoonPlus(0.05), ToBytes(ToMavlinkLine(AttitudeFrame(200'000, 0.0F, 0.0F, 0.0F))), "udp");
  service.OnDatagram(NoonPlus(0.06), ToBytes(HdtLine(10.0) + "\r\n"), "pilot");
  support::HandleAll(bus);
  ASSERT_EQ(raw.size(), 5U) << "START, three messages of the autopilot, the line by UDP";
  EXPECT_EQ(raw[1].sentence, ToMavlinkLine(golden::kGps));
  EXPECT_EQ(raw[2].sentence, ToMavlinkLine(golden::kPosition));
  EXPECT_EQ(raw[2].utime_us, ToUtimeUs(NoonPlus(0.01)));
  EXPECT_EQ(raw[3].sentence, ToMavlinkLine(golden::kAttitude));
  EXPECT_EQ(raw[3].source, "pilot");
  ASSERT_EQ(attitudes.size(), 1U);
  EXPECT_EQ(attitudes[0].source, "pilot");
  ASSERT_EQ(fixes.size(), 1U);
  EXPECT_EQ(fixes[0].quality, gnss_fix_t::QUALITY_DIFFERENTIAL);
  EXPECT_EQ(support::CountOf(service, "mavlink_other_sender"), 1);
  EXPECT_EQ(support::CountOf(service, "mavlink_bad_checksum"), 0);
  EXPECT_EQ(support::CountOf(service, "unexpected_mavlink"), 1);
  EXPECT_GT(support::CountOf(service, "mavlink_skipped_bytes"), 30);
}

}  // namespace
}  // namespace lookout::navigator
