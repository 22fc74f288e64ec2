#include "services/navigator/service.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <map>

#include "common/bus/decode.hpp"
#include "lookout/attitude_t.hpp"
#include "lookout/gnss_fix_t.hpp"
#include "lookout/pose_t.hpp"
#include "tests/support/counters.hpp"
#include "tests/support/files.hpp"
#include "tests/support/memory_bus.hpp"
#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::navigator {
namespace {

constexpr bool kFromSources = false;
constexpr bool kFromNavRaw = true;

Params TestParams(bool reads_nav_raw) {
  auto params = LoadParams(support::kDemoConfig.string());
  params.reads_nav_raw = reads_nav_raw;
  return params;
}

// A service on a bus of its own, and all that it sent.
struct Rig {
  bus::MemoryBus bus;
  Service service;
  std::map<std::string, std::vector<std::vector<std::uint8_t>>> sent;

  explicit Rig(const Params& params) : service(bus, params) {
    bus.SubscribeAll([this](std::string_view channel, Bytes bytes) { sent[std::string(channel)].emplace_back(bytes.begin(), bytes.end()); });
  }
  void Drain() { support::HandleAll(bus); }
  template <typename T>
  void Send(const bus::Channel& channel, const T& message) {
    bus::Publish(bus, channel, message);
    Drain();
  }
  void Datagram(double time_s, const std::string& text) {
    service.OnDatagram(NoonPlus(time_s), ToBytes(text));
    Drain();
  }
  template <typename T>
  std::vector<T> Messages(const bus::Channel& channel) {
    std::vector<T> messages;
    for (const auto& bytes : sent[std::string(channel.name)]) messages.push_back(bus::Decode<T>(bytes).value());
    return messages;
  }
  std::int64_t Count(std::string_view name) const { return support::CountOf(service, name); }
};

nav_raw_t RawMessage(double time_s, std::int32_t kind, const std::string& sentence = {}) {
  nav_raw_t message{};
  message.utime_us = ToUtimeUs(NoonPlus(time_s));
  message.kind = kind;
  message.source = sentence.empty() ? "" : "udp";
  message.sentence = sentence;
  return message;
}

lidar_nmea_t LidarMessage(double time_s, const std::string& sentence) {
  lidar_nmea_t message{};
  message.host_utime_us = ToUtimeUs(NoonPlus(time_s));
  message.sentence = sentence;
  return message;
}

TEST(Service, PublishesEachRawItemBeforeWhatComesOfIt) {
  Rig rig(TestParams(kFromSources));
  std::vector<std::string> order;
  rig.bus.SubscribeAll([&order](std::string_view channel, Bytes) { order.emplace_back(channel); });
  rig.Datagram(0.02, RmcLine(NoonPlus(0.0), 43.63, -72.15, 2.0, 10.0) + "\r\n" + HdtLine(10.0) + "\r\n");
  EXPECT_EQ(order, (std::vector<std::string>{"NAV_RAW", "POSE", "NAV_RAW", "GNSS_FIX", "NAV_RAW", "ATTITUDE"}));
  const auto raw = rig.Messages<nav_raw_t>(bus::kNavRaw);
  EXPECT_EQ(raw[0].kind, nav_raw_t::KIND_START);
  EXPECT_EQ(raw[1].kind, nav_raw_t::KIND_SENTENCE);
  EXPECT_EQ(raw[1].source, "udp");
  EXPECT_EQ(raw[2].sentence, HdtLine(10.0));
  EXPECT_EQ(raw[2].seq, 2);
  EXPECT_EQ(rig.Messages<gnss_fix_t>(bus::kGnssFix)[0].raw_seq, 1);
  EXPECT_EQ(rig.Messages<attitude_t>(bus::kAttitude)[0].raw_seq, 2);
}

// Latitude and longitude changed places in config: positions came out wrong, or none, with nothing but ok in HEALTH.
TEST(Service, NamesADatumThatIsFarFromTheFirstFixAndIsRightAllTheSame) {
  auto params = TestParams(kFromSources);
  params.navigator.filter.datum = GeodeticPlace{-72.15, 43.63, 0.0};
  Rig rig(params);
  rig.service.AdvanceTo(NoonPlus(0));
  EXPECT_EQ(rig.service.Report().reason.find("datum"), std::string::npos) << "before the first fix nothing can be said";
  rig.Datagram(0.05, GgaLine(NoonPlus(0.0), 43.63, -72.15, 4, 0.7, 201.0, -28.0) + "\r\n" + PashrLine(NoonPlus(0.0), 0.0, 0.0, 0.0, 0.0) + "\r\n");
  rig.service.AdvanceTo(NoonPlus(0.1));
  rig.Drain();
  const auto report = rig.service.Report();
  EXPECT_EQ(report.state, HealthState::kDegraded);
  EXPECT_NE(report.reason.find("datum 72.15000 S 43.63000 E of boat.txtpb is 11910 km from the first fix at 43.63000 N 72.15000 W: swapped latitude "
                               "and longitude?"),
            std::string::npos)
      << report.reason;
  const auto pose = rig.Messages<pose_t>(bus::kPose).back();
  EXPECT_EQ(pose.status, pose_t::STATUS_OK);
  EXPECT_NEAR(pose.latitude_deg, 43.63 + 0.8 / 111'100.0, 1e-8);
  EXPECT_NEAR(pose.ellipsoid_height_m, 173.0 - 0.9, 1e-6);
}

TEST(Service, PutsLinesWithWrongChecksumsIntoTheRawLogToo) {
  Rig rig(TestParams(kFromSources));
  rig.Datagram(0.0, "$GPHDT,1.0,T*00\r\n$GPHDT,1.0,T\r\n$\x80\r\nnothing\r\n");
  EXPECT_EQ(rig.Messages<nav_raw_t>(bus::kNavRaw).size(), 3U) << "the start mark and two lines";
  EXPECT_EQ(rig.Count("bad_checksum"), 1);
  EXPECT_EQ(rig.Count("no_checksum"), 1);
  EXPECT_EQ(rig.Count("not_printable"), 1);
  EXPECT_EQ(rig.Count("no_start"), 1);
}

// Without a sender each datagram stands for itself, as the lines of a text log do.
TEST(Service, JoinsLinesThatASenderCutsOverDatagrams) {
  Rig rig(TestParams(kFromSources));
  const auto add = [&rig](double time_s, const std::string& text, const std::string& sender) {
    rig.service.AdvanceTo(NoonPlus(time_s));
    rig.service.OnDatagram(NoonPlus(time_s), ToBytes(text), kUdpSource, sender);
    rig.Drain();
  };
  const auto line = HdtLine(10.0);
  add(0.01, line.substr(0, 5), "10.0.0.1 4000");
  add(0.02, line.substr(0, 8), "10.0.0.1 4001");
  add(0.03, line.substr(5), "10.0.0.1 4000");
  add(0.04, line.substr(8), "10.0.0.1 4001");
  EXPECT_EQ(rig.Count("understood_sentence"), 2);
  add(0.05, line.substr(0, 5), "10.0.0.1 4000");
  rig.service.AdvanceTo(NoonPlus(2.5));
  rig.Drain();
  EXPECT_EQ(rig.Count("no_checksum"), 1) << "its rest did not come";
  add(2.6, line.substr(0, 5), "10.0.0.1 4000");
  rig.service.Finish(NoonPlus(2.7));
  rig.Drain();
  EXPECT_EQ(rig.Count("no_checksum"), 2);
  EXPECT_EQ(rig.Messages<nav_raw_t>(bus::kNavRaw).back().kind, nav_raw_t::KIND_END);
}

TEST(Service, CountsSentencesThatAreCutOff) {
  Rig rig(TestParams(kFromSources));
  rig.Datagram(0.0, "$GPRMC,1200" + HdtLine(10.0));
  EXPECT_EQ(rig.Count("cut_off"), 1);
  EXPECT_EQ(rig.Count("understood_sentence"), 1);
}

TEST(Service, SendsPosesOfTheDemoBoat) {
  Rig rig(TestParams(kFromSources));
  rig.service.AdvanceTo(NoonPlus(0));
  rig.Datagram(0.05, GgaLine(NoonPlus(0.0), 43.63, -72.15, 4, 0.7, 201.0, -28.0) + "\r\n" + PashrLine(NoonPlus(0.0), 0.0, 0.0, 0.0, 0.0) + "\r\n");
  rig.service.AdvanceTo(NoonPlus(0.1));
  rig.Drain();
  const auto poses = rig.Messages<pose_t>(bus::kPose);
  ASSERT_EQ(poses.size(), 6U);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(poses[i].seq, static_cast<std::int64_t>(i));
    EXPECT_EQ(poses[i].utime_us, ToUtimeUs(NoonPlus(0.02 * static_cast<double>(i))));
  }
  const auto& pose = poses.back();
  EXPECT_EQ(pose.status, pose_t::STATUS_OK);
  EXPECT_EQ(pose.heading_source, pose_t::HEADING_PASHR);
  EXPECT_EQ(pose.has_attitude, 1);
  // Antenna at (-0.8, 0.4, 0.9), bow north.
  EXPECT_NEAR(pose.position_map_m[0], 0.4, 1e-6);
  EXPECT_NEAR(pose.position_map_m[1], 0.8, 1e-6);
  EXPECT_NEAR(pose.ellipsoid_height_m, 173.0 - 0.9, 1e-6);
  EXPECT_GT(pose.covariance[8][8], 0.0);
}

TEST(Service, UsesLidarSentencesOnlyWhereConfigSaysSo) {
  auto params = TestParams(kFromSources);
  for (const bool use_lidar_nmea : {true, false}) {
    params.use_lidar_nmea = use_lidar_nmea;
    Rig rig(params);
    rig.service.AdvanceTo(NoonPlus(0));
    rig.Send(bus::kLidarNmea, LidarMessage(0.0, RmcLine(NoonPlus(0.0), 43.63, -72.15, 2.0, 10.0)));
    EXPECT_EQ(rig.Messages<gnss_fix_t>(bus::kGnssFix).size(), use_lidar_nmea ? 1U : 0U);
  }
}

TEST(Service, CountsTheSeqOfItsOutputsFromAStartMark) {
  Rig rig(TestParams(kFromNavRaw));
  rig.Send(bus::kNavRaw, RawMessage(0.0, nav_raw_t::KIND_START));
  rig.Send(bus::kNavRaw, RawMessage(0.1, nav_raw_t::KIND_SENTENCE, HdtLine(1.0)));
  rig.Send(bus::kNavRaw, RawMessage(-5.0, nav_raw_t::KIND_START));
  rig.Send(bus::kNavRaw, RawMessage(-4.9, nav_raw_t::KIND_SENTENCE, HdtLine(1.0)));
  const auto attitudes = rig.Messages<attitude_t>(bus::kAttitude);
  ASSERT_EQ(attitudes.size(), 2U);
  EXPECT_EQ(attitudes[1].seq, 0);
  const auto poses = rig.Messages<pose_t>(bus::kPose);
  ASSERT_EQ(poses.size(), 12U);
  EXPECT_EQ(poses[6].seq, 0);
  EXPECT_EQ(poses[6].utime_us, ToUtimeUs(NoonPlus(-5.0)));
}

TEST(Service, FromALogReadsNothingElseAndSendsNoRaw) {
  Rig rig(TestParams(kFromNavRaw));
  rig.Datagram(0.0, HdtLine(1.0));
  rig.service.AdvanceTo(NoonPlus(1.0));
  rig.Send(bus::kLidarNmea, LidarMessage(0.0, HdtLine(1.0)));
  EXPECT_EQ(rig.sent.size(), 1U) << "what the test sent itself";
  rig.Send(bus::kNavRaw, RawMessage(0.0, nav_raw_t::KIND_SENTENCE, HdtLine(1.0)));
  EXPECT_EQ(rig.sent["NAV_RAW"].size(), 1U);
  EXPECT_EQ(rig.sent["ATTITUDE"].size(), 1U);
}

TEST(Service, TakesRawMessagesOutOfRecordingsOfOthers) {
  Rig rig(TestParams(kFromNavRaw));
  rig.Send(bus::kNavRaw, RawMessage(0.0, nav_raw_t::KIND_START));
  for (const char* source : {"imported:/gps/fix", "imported:", "imported:/a b", "other:/fix"}) {
    auto message = RawMessage(0.1, nav_raw_t::KIND_SENTENCE, HdtLine(1.0));
    message.source = source;
    rig.Send(bus::kNavRaw, message);
  }
  EXPECT_EQ(rig.Count("nav_raw_bad_text"), 3);
  EXPECT_EQ(rig.sent["ATTITUDE"].size(), 1U);
}

TEST(Service, RefusesRawMessagesThatCannotBe) {
  Rig rig(TestParams(kFromNavRaw));
  rig.Send(bus::kNavRaw, RawMessage(0.0, nav_raw_t::KIND_START));
  const auto sent_before = rig.sent["POSE"].size();
  for (const std::int64_t utime_us : {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max(), kMaxUtimeUs + 1}) {
    auto message = RawMessage(0.0, nav_raw_t::KIND_TICK);
    message.utime_us = utime_us;
    rig.Send(bus::kNavRaw, message);
  }
  EXPECT_EQ(rig.Count("nav_raw_bad_time"), 3);
  for (const std::int32_t kind : {-1, 5, std::numeric_limits<std::int32_t>::min()}) rig.Send(bus::kNavRaw, RawMessage(0.1, kind));
  EXPECT_EQ(rig.Count("nav_raw_bad_kind"), 3);
  auto with_text = RawMessage(0.1, nav_raw_t::KIND_TICK);
  with_text.source = "udp";
  rig.Send(bus::kNavRaw, with_text);
  auto without_source = RawMessage(0.1, nav_raw_t::KIND_SENTENCE, HdtLine(1.0));
  without_source.source = "";
  rig.Send(bus::kNavRaw, without_source);
  auto odd_source = RawMessage(0.1, nav_raw_t::KIND_SENTENCE, HdtLine(1.0));
  odd_source.source = "\x01";
  rig.Send(bus::kNavRaw, odd_source);
  for (const char* sentence : {"", "GPHDT", "$\t", "$\xFF"}) {
    auto message = RawMessage(0.1, nav_raw_t::KIND_SENTENCE, sentence);
    message.source = "udp";
    rig.Send(bus::kNavRaw, message);
  }
  EXPECT_EQ(rig.Count("nav_raw_bad_text"), 7);
  auto imu = RawMessage(0.1, nav_raw_t::KIND_IMU);
  imu.source = "imu";
  rig.Send(bus::kNavRaw, imu);
  EXPECT_EQ(rig.Count("nav_raw_bad_imu"), 1);
  rig.Send(bus::kNavRaw, RawMessage(-0.1, nav_raw_t::KIND_TICK));
  EXPECT_EQ(rig.Count("nav_raw_backwards"), 1);
  EXPECT_EQ(rig.sent["POSE"].size(), sent_before) << "none moved time";
}

TEST(Service, LivesOnAfterBytesThatAreNoMessage) {
  Rig rig(TestParams(kFromNavRaw));
  auto bytes = bus::Encode(RawMessage(0.0, nav_raw_t::KIND_SENTENCE, HdtLine(1.0)));
  const auto whole = bytes;
  for (auto end = whole.begin(); end != whole.end(); ++end) rig.bus.Publish(bus::kNavRaw, {whole.begin(), end});
  for (std::size_t place = 0; place < whole.size(); ++place) {
    bytes = whole;
    bytes[place] ^= 0x80;
    rig.bus.Publish(bus::kNavRaw, bytes);
  }
  rig.Drain();
  rig.Send(bus::kNavRaw, RawMessage(0.0, nav_raw_t::KIND_START));
  rig.Send(bus::kNavRaw, RawMessage(0.1, nav_raw_t::KIND_SENTENCE, HdtLine(1.0)));
  EXPECT_GE(rig.Messages<pose_t>(bus::kPose).size(), 5U);
}

TEST(Service, RefusesLidarSentencesThatCannotBe) {
  Rig rig(TestParams(kFromSources));
  rig.service.AdvanceTo(NoonPlus(0));
  auto bad_time = LidarMessage(0.0, HdtLine(1.0));
  bad_time.host_utime_us = std::numeric_limits<std::int64_t>::max();
  rig.Send(bus::kLidarNmea, bad_time);
  rig.Send(bus::kLidarNmea, LidarMessage(0.0, ""));
  rig.Send(bus::kLidarNmea, LidarMessage(0.0, "no start"));
  EXPECT_EQ(rig.Count("lidar_nmea_bad"), 3);
  rig.Send(bus::kLidarNmea, LidarMessage(-1000.0, HdtLine(1.0)));
  EXPECT_EQ(rig.Count("stale_sentence"), 1);
  EXPECT_EQ(rig.sent["ATTITUDE"].size(), 0U);
}

TEST(Service, RefusesHostTimesThatCannotBe) {
  Rig rig(TestParams(kFromSources));
  const Utime never{std::chrono::microseconds(std::numeric_limits<std::int64_t>::max())};
  rig.service.AdvanceTo(never);
  rig.service.OnDatagram(never, ToBytes(HdtLine(1.0)));
  rig.service.Finish(never);
  rig.Drain();
  EXPECT_TRUE(rig.sent.empty());
  EXPECT_EQ(rig.Count("bad_host_time"), 3);
}

TEST(Service, StandsTheBoundsOfTime) {
  Rig rig(TestParams(kFromSources));
  rig.service.AdvanceTo(Utime(std::chrono::microseconds(kMinUtimeUs)));
  rig.Datagram(0.0, RmcLine(NoonPlus(0.0), 43.63, -72.15, 2.0, 10.0) + "\r\n" + HdtLine(1.0));
  rig.service.AdvanceTo(Utime(std::chrono::microseconds(kMaxUtimeUs)));
  rig.service.Finish(Utime(std::chrono::microseconds(kMaxUtimeUs)));
  rig.Drain();
  EXPECT_EQ(rig.Count("time_jump"), 2);
  EXPECT_EQ(rig.Messages<pose_t>(bus::kPose).back().status, pose_t::STATUS_UNKNOWN);
}

TEST(Service, SaysWhyItIsDegraded) {
  Rig rig(TestParams(kFromSources));
  EXPECT_EQ(rig.service.Report().reason, "no position fix yet, no heading");
  rig.service.AdvanceTo(NoonPlus(0));
  rig.Datagram(0.1, RmcLine(NoonPlus(0.0), 43.63, -72.15, 0.0, 10.0));
  EXPECT_EQ(rig.service.Report().state, HealthState::kDegraded);
  EXPECT_EQ(rig.service.Report().reason, "no heading");
  rig.Datagram(0.2, HdtLine(1.0));
  EXPECT_EQ(rig.service.Report().state, HealthState::kOk);
  EXPECT_EQ(rig.service.Report().reason, "");
  rig.service.AdvanceTo(NoonPlus(5.0));
  rig.Drain();
  EXPECT_EQ(rig.service.Report().reason,
            "no position fix for 5 s, no heading for 4 s, POSE is relative to the boat: no position or no heading, and no LIDAR_ODOMETRY comes");
}

// A heading that is only the course over ground looked like a compass.
TEST(Service, SaysThatTheHeadingIsOnlyTheCourse) {
  Rig rig(TestParams(kFromSources));
  rig.service.AdvanceTo(NoonPlus(0));
  rig.Datagram(0.1, RmcLine(NoonPlus(0.0), 43.63, -72.15, 3.0, 10.0));
  rig.service.AdvanceTo(NoonPlus(0.2));
  rig.Drain();
  EXPECT_EQ(rig.Messages<pose_t>(bus::kPose).back().heading_source, pose_t::HEADING_COURSE);
  EXPECT_EQ(rig.service.Report().state, HealthState::kDegraded);
  EXPECT_EQ(rig.service.Report().reason, "heading is only the course over ground: no compass or attitude sensor");
  rig.Datagram(0.2, HdtLine(1.0));
  rig.service.AdvanceTo(NoonPlus(0.3));
  EXPECT_EQ(rig.service.Report().reason, "");
}

TEST(Service, SaysWhichFixesNoBoatCanHaveReached) {
  Rig rig(TestParams(kFromSources));
  rig.service.AdvanceTo(NoonPlus(0));
  for (int i = 0; i < 20; ++i) rig.Datagram(i + 0.1, RmcLine(NoonPlus(i), 43.63, -72.15, 0.0, 10.0) + "\r\n" + HdtLine(1.0));
  rig.Datagram(20.1, RmcLine(NoonPlus(20.0), 43.63, 7.2, 0.0, 10.0) + "\r\n" + HdtLine(1.0));
  rig.service.AdvanceTo(NoonPlus(20.2));
  EXPECT_EQ(
      rig.service.Report().reason,
      "fixes of input 'udp' are 5904 km from the last that was believed, 1 s before: no boat gets so far; not used, unless they stay there for 19 s");
  EXPECT_EQ(rig.Count("unreachable_fix"), 1);
}

// Stamps and dates behind January 2038.
TEST(Service, GoesOnIn2039) {
  Rig rig(TestParams(kFromSources));
  const auto start = std::chrono::sys_days(std::chrono::year(2039) / 1 / 1) + std::chrono::hours(10);
  for (int i = 0; i < 5; ++i) {
    const Utime time = start + std::chrono::seconds(i);
    rig.service.OnDatagram(time + std::chrono::milliseconds(200), ToBytes(RmcLine(time, 54.5, 10.2, 0.0, 90.0) + "\r\n" + HdtLine(90.0)));
    rig.Drain();
  }
  const auto pose = rig.Messages<pose_t>(bus::kPose).back();
  EXPECT_EQ(pose.utime_us, ToUtimeUs(start) + 4'200'000);
  EXPECT_EQ(pose.status, pose_t::STATUS_OK);
  EXPECT_EQ(rig.Messages<gnss_fix_t>(bus::kGnssFix).back().utime_us, ToUtimeUs(start) + 4'000'000);
  EXPECT_EQ(rig.Count("date_unusable"), 0);
}

// Of the bytes of POSE, raw_seq aside, which counts the lines of AIS, too.
std::vector<pose_t> PosesWithAis(bool has_ais) {
  Rig rig(TestParams(kFromSources));
  for (int i = 0; i < 450; ++i) {
    const double time_s = 0.1 * i;
    // The antenna is lost after 5 s. The transponder has a receiver of its own, and goes on.
    const bool has_fix = time_s < 5.0;
    if (has_fix) rig.Datagram(time_s, RmcLine(NoonPlus(time_s), 43.63 + 2e-6 * i, -72.15, 2.0, 10.0) + "\r\n");
    rig.Datagram(time_s + 0.01, HdtLine(10.0) + "\r\n");
    // At 43.7 N 72.0 W, not where the boat is.
    if (has_ais) rig.Datagram(time_s + 0.02, Line("AIVDO,1,1,,,13P88;@P00rMAAfE;iP00?v00000,0", '!') + "\r\n");
    if (has_ais) rig.Datagram(time_s + 0.03, Line("AIVDM,1,1,,A,13u?etPv2;0n:dDPwUM1U1Cb069D,0", '!') + "\r\n");
    rig.service.AdvanceTo(NoonPlus(time_s + 0.05));
    rig.Drain();
  }
  // Of both the same times, whichever line came last.
  rig.service.AdvanceTo(NoonPlus(46.0));
  rig.Drain();
  auto poses = rig.Messages<pose_t>(bus::kPose);
  for (auto& pose : poses) pose.raw_seq = 0;
  return poses;
}

// A transponder's positions are no fixes: they would hide that there are none.
TEST(Service, LosesThePositionThoughAisGoesOn) {
  const auto poses = PosesWithAis(true);
  const auto alone = PosesWithAis(false);
  ASSERT_EQ(poses.size(), alone.size());
  for (std::size_t i = 0; i < poses.size(); ++i) ASSERT_EQ(bus::Encode(poses[i]), bus::Encode(alone[i])) << i;
  std::vector<std::int32_t> statuses;
  for (const auto& pose : poses) {
    if (statuses.empty() || statuses.back() != pose.status) statuses.push_back(pose.status);
  }
  statuses.erase(statuses.begin(), std::ranges::find(statuses, std::int32_t{pose_t::STATUS_OK}));
  // The earth is not known then: a frame of its own follows.
  EXPECT_EQ(statuses,
            (std::vector<std::int32_t>{pose_t::STATUS_OK, pose_t::STATUS_COASTING, pose_t::STATUS_NO_POSITION, pose_t::STATUS_RELATIVE_TO_BOAT}));
}

}  // namespace
}  // namespace lookout::navigator
