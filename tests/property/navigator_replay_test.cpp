// The replay rule: NAV_RAW of a run from outside, fed into a service that reads logs, gives the same bytes on every other channel.
#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <set>

#include "common/bus/decode.hpp"
#include "common/core/angles.hpp"
#include "lookout/lidar_nmea_t.hpp"
#include "lookout/pose_t.hpp"
#include "services/navigator/service.hpp"
#include "tests/support/counters.hpp"
#include "tests/support/files.hpp"
#include "tests/support/memory_bus.hpp"
#include "tests/unit/navigator/mavlink_frames.hpp"
#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::navigator {
namespace {

using Sent = std::map<std::string, std::vector<std::vector<std::uint8_t>>>;

constexpr double kLatitudeDeg = 43.63;
constexpr double kLongitudeDeg = -72.15;

Params TestParams(bool reads_nav_raw) {
  auto params = LoadParams(support::kDemoConfig.string());
  params.reads_nav_raw = reads_nav_raw;
  // A compass and a strapdown sensor on a serial line, with all that config can say of it.
  SourceParams ahrs;
  ahrs.name = "ahrs";
  ahrs.latency = std::chrono::milliseconds(20);
  ahrs.roll_sign = -1.0;
  ahrs.deviation_rad = 0.01;
  params.navigator.sources.push_back(ahrs);
  SourceParams pilot;
  pilot.name = "pilot";
  pilot.protocol = Protocol::kMavlink;
  params.navigator.sources.push_back(pilot);
  return params;
}

void Collect(bus::MemoryBus& bus, Sent& sent) {
  bus.SubscribeAll([&sent](std::string_view channel, Bytes bytes) { sent[std::string(channel)].emplace_back(bytes.begin(), bytes.end()); });
}

void Drain(bus::MemoryBus& bus) { support::HandleAll(bus); }

// Half a minute of a boat whose sentences come late, twice, out of order and damaged, whose clock is set back, and which sleeps for a while.
Sent RunFromOutside(unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&random](double min, double max) { return std::uniform_real_distribution<double>(min, max)(random); };
  bus::MemoryBus bus;
  Service service(bus, TestParams(false));
  Sent sent;
  Collect(bus, sent);
  double time_s = 0.0;
  std::string lidar_line = RmcLine(NoonPlus(0), kLatitudeDeg, kLongitudeDeg, 1.0, 0.0);
  std::string stream;
  std::string pilot_stream;
  for (int i = 0; i < 3000; ++i) {
    time_s += uniform(0.0, 0.02);
    if (i == 1000) time_s -= 5.0;
    if (i == 2000) time_s += 30.0;
    service.AdvanceTo(NoonPlus(time_s));
    const auto measured = NoonPlus(time_s - uniform(0.0, 0.2));
    const double latitude_deg = kLatitudeDeg + 1e-5 * time_s;
    const double heading_deg = std::fmod(720.0 + 10.0 * time_s, 360.0);
    std::string text;
    switch (random() % 8) {
      case 0:
        text = RmcLine(measured, latitude_deg, kLongitudeDeg, 2.0, heading_deg);
        break;
      case 1:
        text = GgaLine(measured, latitude_deg, kLongitudeDeg, 1 + static_cast<int>(random() % 8), 0.9, 200.0, -28.0);
        break;
      case 2:
        text = PashrLine(measured, heading_deg, 3.0, -2.0, 0.1) + "\r\n" + HdtLine(heading_deg);
        break;
      case 3:
        text = "junk\r\n" + HdtLine(heading_deg) + "\r\n$GPHDT,1*00\r\n\\s:x*00\\" + Line("AIVDM,1", '!');
        break;
      case 4:
        text = Line("GPVTG,10.0,T,,M,3.0,N,,K,A");
        break;
      case 5:
        lidar_line = RmcLine(measured, latitude_deg, kLongitudeDeg, 1.0, 0.0);
        break;
      default:
        break;
    }
    if (!text.empty()) {
      if (random() % 4 == 0) text[random() % text.size()] = static_cast<char>(random());
      service.OnDatagram(NoonPlus(time_s - uniform(-0.01, 0.1)), ToBytes(text));
    }
    // A stream comes in pieces of any size, and breaks off.
    stream += Line(Print("VNYMR,%.3f,2.0,3.0,0,0,0,0.5,0.2,-9.8,0.1,0.2,0.3", heading_deg)) + "\r\n" + Line("HCHDG,10.0,,,3.0,E") + "\r\n";
    stream += Line("GPRMC," + TimeOfDay(measured) + ",A,4337.8,N,07209.0,W,2.0,10.0,010626,5.0,W,A") + "\r\n";
    const auto size = std::min<std::size_t>(stream.size(), random() % 200);
    service.OnStream(NoonPlus(time_s), ToBytes(stream.substr(0, size)), "ahrs");
    stream.erase(0, size);
    // An autopilot by datagrams that a gateway cuts anywhere, damaged at times, and with messages of others between its own.
    const auto boot_ms = static_cast<std::uint32_t>(1000.0 * (time_s + 10.0));
    pilot_stream += AttitudeFrame(boot_ms, 0.05F, -0.03F, static_cast<float>(DegToRad(heading_deg) - kPi), 0.17F);
    if (i % 10 == 0) pilot_stream += PositionFrame(boot_ms, latitude_deg, kLongitudeDeg, 1.0, 0.5, 200'000) + support::AutopilotHeartbeat();
    if (i % 50 == 0) pilot_stream += GpsFrame(static_cast<int>(random() % 7), 800, 250'000, 4500);
    if (random() % 20 == 0) pilot_stream[random() % pilot_stream.size()] = static_cast<char>(random());
    const auto pilot_size = std::min<std::size_t>(pilot_stream.size(), random() % 300);
    service.OnDatagram(NoonPlus(time_s), ToBytes(pilot_stream.substr(0, pilot_size)), "pilot", random() % 50 == 0 ? "b" : "a");
    pilot_stream.erase(0, pilot_size);
    if (random() % 100 == 0) {
      service.OnStreamEnd("ahrs");
      stream.clear();
    }
    lidar_nmea_t message{};
    message.host_utime_us = ToUtimeUs(NoonPlus(time_s - uniform(0.0, 0.1)));
    message.sentence = lidar_line;
    bus::Publish(bus, bus::kLidarNmea, message);
    Drain(bus);
  }
  service.Finish(NoonPlus(time_s + 0.013));
  Drain(bus);
  for (const char* name : {"mavlink_bad_checksum", "mavlink_skipped_bytes", "pilot_understood"})
    EXPECT_GT(support::CountOf(service, name), 0) << name;
  return sent;
}

Sent RunFromLog(const Sent& log) {
  bus::MemoryBus bus;
  Service service(bus, TestParams(true));
  Sent sent;
  Collect(bus, sent);
  for (const auto& bytes : log.at("NAV_RAW")) {
    bus.Publish(bus::kNavRaw, bytes);
    Drain(bus);
  }
  service.Finish(NoonPlus(1e6));
  Drain(bus);
  return sent;
}

class Replay : public ::testing::TestWithParam<unsigned> {};

TEST_P(Replay, GivesTheSameBytes) {
  const auto outside = RunFromOutside(GetParam());
  const auto log = RunFromLog(outside);
  for (const char* channel : {"GNSS_FIX", "ATTITUDE", "POSE"}) {
    ASSERT_TRUE(outside.contains(channel) && log.contains(channel)) << channel;
    EXPECT_GT(outside.at(channel).size(), 100U) << channel;
    EXPECT_TRUE(outside.at(channel) == log.at(channel)) << channel << " differs, seed " << GetParam();
  }
}

TEST_P(Replay, HasAllPosesOnTheGridInOrderAndOfAllKinds) {
  const auto outside = RunFromOutside(GetParam());
  std::set<int> statuses;
  std::int64_t last_utime_us = 0;
  std::int64_t last_seq = -1;
  int num_starts = 0;
  for (const auto& bytes : outside.at("POSE")) {
    const auto pose = bus::Decode<pose_t>(bytes);
    ASSERT_TRUE(pose);
    EXPECT_EQ(pose->utime_us % 20000, 0);
    if (pose->seq == 0) {
      ++num_starts;
    } else {
      EXPECT_EQ(pose->seq, last_seq + 1);
      EXPECT_TRUE(pose->utime_us == last_utime_us + 20000 || pose->utime_us > last_utime_us + 20'000'000) << "a step, or the sleep";
    }
    last_seq = pose->seq;
    last_utime_us = pose->utime_us;
    statuses.insert(pose->status);
  }
  EXPECT_EQ(num_starts, 2);
  EXPECT_TRUE(statuses.contains(pose_t::STATUS_OK));
}

INSTANTIATE_TEST_SUITE_P(Seeds, Replay, ::testing::Values(1U, 2U, 3U, 4U));

}  // namespace
}  // namespace lookout::navigator
