#include "services/lidar/service.hpp"

#include <algorithm>
#include <functional>
#include <gtest/gtest.h>
#include <map>

#include "common/core/sentence.hpp"
#include "lookout/lidar_clock_t.hpp"
#include "lookout/lidar_nmea_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "services/lidar/core/vlp16/form.hpp"
#include "services/lidar/wire.hpp"
#include "tests/support/counters.hpp"
#include "tests/support/memory_bus.hpp"
#include "tests/unit/lidar/packet_maker.hpp"

namespace lookout::vlp16 {

using namespace lidar;
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using test::SpinningSensor;

const Utime kServiceTime = Utime(std::chrono::hours(24 * 20000));

struct Message {
  std::string channel;
  std::vector<std::uint8_t> bytes;
  bool operator==(const Message&) const = default;
};

// A bus that keeps what was published, in order.
struct Recorded {
  Recorded() {
    bus.SubscribeAll([this](std::string_view channel, Bytes bytes) { messages.push_back({std::string(channel), {bytes.begin(), bytes.end()}}); });
  }
  void Handle() { support::HandleAll(bus); }
  template <typename T>
  std::vector<T> All(const bus::Channel& channel) const {
    std::vector<T> all;
    for (const auto& message : messages) {
      if (message.channel == channel.name) all.push_back(bus::Decode<T>(message.bytes).value());
    }
    return all;
  }
  bus::MemoryBus bus;
  std::vector<Message> messages;
};

// A boat's morning: data with a loss, position packets, garbage.
void Feed(Service& service, SpinningSensor sensor, int num_packets) {
  for (int i = 0; i < num_packets; ++i) {
    if (i == 30) sensor.Skip(2);
    const auto payload = sensor.Next();
    const Utime host_time = kServiceTime + microseconds(sensor.time_ns / 1000 + i % 7 * 50);
    service.OnDatagram(host_time, 2368, payload);
    if (i % 10 == 0) service.OnDatagram(host_time, 8308, test::MakePositionPacket(sensor.stamp_us(), 2, test::kValidRmc));
    if (i % 50 == 0) service.OnDatagram(host_time, 2368, test::Payload(format::kDataPacketSizeBytes, 7));
  }
}

TEST(Service, PublishesNothingWhenNothingCame) {
  Recorded out;
  Service service(out.bus, Params{});
  service.AdvanceTo(kServiceTime);
  service.Finish(kServiceTime);
  out.Handle();
  EXPECT_TRUE(out.messages.empty());
}

TEST(Service, PublishesRawThenClockThenScan) {
  Recorded out;
  Service service(out.bus, Params{});
  Feed(service, SpinningSensor(), 100);
  service.Finish(kServiceTime + milliseconds(200));
  out.Handle();
  const auto first = std::ranges::find(out.messages, "LIDAR_SCAN", &Message::channel);
  ASSERT_NE(first, out.messages.end());
  EXPECT_EQ((first - 1)->channel, "LIDAR_CLOCK");
  const auto scans = out.All<lidar_scan_t>(bus::kLidarScan);
  const auto clocks = out.All<lidar_clock_t>(bus::kLidarClock);
  const auto packets = out.All<lidar_packets_t>(bus::kLidarPackets);
  const auto sentences = out.All<lidar_nmea_t>(bus::kLidarNmea);
  ASSERT_EQ(scans.size(), 2U);
  ASSERT_EQ(clocks.size(), 2U);
  EXPECT_EQ(sentences.size(), 10U);
  EXPECT_EQ(scans[0].utime_us, clocks[0].utime_us);
  EXPECT_EQ(scans[0].num_columns, scans[0].num_turn_columns);
  EXPECT_EQ(scans[0].flags, lidar_scan_t::FLAG_HOLE);
  EXPECT_EQ(scans[0].num_lost_packets, 2);
  EXPECT_EQ(scans[1].flags, lidar_scan_t::FLAG_PARTIAL_END);
  EXPECT_EQ(scans[1].raw_seq, packets.back().seq);
  EXPECT_EQ(packets.front().marks, lidar_packets_t::MARK_START);
  EXPECT_EQ(packets.back().marks, lidar_packets_t::MARK_END);
  // The bundle that completes a scan is the last before it on the bus.
  const auto raw =
      std::find_if(std::make_reverse_iterator(first), out.messages.rend(), [](const Message& m) { return m.channel == "LIDAR_PACKETS"; });
  EXPECT_EQ(bus::Decode<lidar_packets_t>(raw->bytes)->seq, scans[0].raw_seq);
  EXPECT_EQ(support::CountOf(service, "data_bad_flag"), 2);
  EXPECT_EQ(support::CountOf(service, "data_lost"), 2);
}

TEST(Service, GivesTheSameBytesFromItsRawLog) {
  for (const std::uint8_t mode : {format::kModeStrongest, format::kModeDual}) {
    Recorded live;
    Service service(live.bus, Params{});
    SpinningSensor sensor;
    sensor.mode = mode;
    sensor.azimuth_deg = 77.0;
    Feed(service, sensor, 400);
    service.Finish(kServiceTime + milliseconds(600));
    live.Handle();

    Recorded again;
    Params params;
    params.input = Input::kLog;
    Service replayed(again.bus, params);
    for (const auto& message : live.messages) {
      if (message.channel == bus::kLidarPackets.name) again.bus.Publish(bus::kLidarPackets, message.bytes);
    }
    again.Handle();
    replayed.Finish(kServiceTime);
    again.Handle();
    const auto derived = [](const std::vector<Message>& messages) {
      std::vector<Message> some;
      std::ranges::copy_if(messages, std::back_inserter(some), [](const Message& m) { return m.channel != "LIDAR_PACKETS"; });
      return some;
    };
    EXPECT_EQ(derived(live.messages), derived(again.messages));
    EXPECT_EQ(again.messages.size(), live.messages.size());  // and no raw of its own
  }
}

TEST(Service, FlushesALogThatHasNoEndMark) {
  Recorded out;
  Params params;
  params.input = Input::kLog;
  Service service(out.bus, params);
  Bundler bundler(2368, 8308, vlp16::FormOf(0.0));
  bundler.Add(kServiceTime, 2368, SpinningSensor().Next());
  bus::Publish(out.bus, bus::kLidarPackets, ToMessage(bundler.AdvanceTo(kServiceTime + milliseconds(100)).value()));
  out.Handle();
  EXPECT_TRUE(out.All<lidar_scan_t>(bus::kLidarScan).empty());
  service.Finish(kServiceTime);
  out.Handle();
  EXPECT_EQ(out.All<lidar_scan_t>(bus::kLidarScan).size(), 1U);
}

TEST(Service, RefusesABadRawMessageAsAWhole) {
  const std::vector<std::function<void(lidar_packets_t&)>> kFaults{[](auto& message) { message.size_bytes[0] = 1207; },
                                                                   [](auto& message) { message.size_bytes[0] = 1205; },
                                                                   [](auto& message) { message.size_bytes[0] = -1; },
                                                                   [](auto& message) { message.udp_port[0] = -1; },
                                                                   [](auto& message) { message.udp_port[0] = 65536; },
                                                                   [](auto& message) { message.marks = 4; },
                                                                   [](auto& message) { message.seq = -1; },
                                                                   [](auto& message) { message.utime_us = INT64_MIN; },
                                                                   [](auto& message) { message.host_utime_us[0] = INT64_MAX; }};
  Params params;
  params.input = Input::kLog;
  Bundler bundler(2368, 8308, vlp16::FormOf(0.0));
  bundler.Add(kServiceTime, 2368, SpinningSensor().Next());
  const auto good = ToMessage(*bundler.Finish(kServiceTime));
  for (std::size_t i = 0; i < kFaults.size(); ++i) {
    Recorded out;
    Service service(out.bus, params);
    auto message = good;
    kFaults[i](message);
    bus::Publish(out.bus, bus::kLidarPackets, message);
    out.Handle();
    EXPECT_EQ(support::CountOf(service, "messages_refused"), 1) << i;
    EXPECT_EQ(out.messages.size(), 1U) << i;
  }
}

// A log of two runs is computed as each run was, live.
TEST(Service, NumbersSentencesAnewBehindAStartMark) {
  Recorded out;
  Params params;
  params.input = Input::kLog;
  const Service service(out.bus, params);
  Bundler bundler(2368, 8308, vlp16::FormOf(0.0));
  for (int run = 0; run < 2; ++run) {
    for (int i = 0; i < 2; ++i)
      bundler.Add(kServiceTime + milliseconds(i), 8308, test::MakePositionPacket(static_cast<std::uint32_t>(1000 * i), 2, test::kValidRmc));
    bus::Publish(out.bus, bus::kLidarPackets, ToMessage(*bundler.Finish(kServiceTime + milliseconds(10))));
  }
  out.Handle();
  std::vector<std::int64_t> seqs;
  for (const auto& message : out.All<lidar_nmea_t>(bus::kLidarNmea)) seqs.push_back(message.seq);
  EXPECT_EQ(seqs, (std::vector<std::int64_t>{0, 1, 0, 1}));
}

TEST(Service, SplitsAScanThatIsTooLargeByColumns) {
  Recorded out;
  Service service(out.bus, Params{});
  SpinningSensor sensor;
  sensor.mode = format::kModeDual;
  sensor.rpm = 300.0;
  Feed(service, sensor, 302);
  service.Finish(kServiceTime + milliseconds(400));
  out.Handle();
  const auto parts = out.All<lidar_scan_t>(bus::kLidarScan);
  ASSERT_GE(parts.size(), 4U);
  EXPECT_EQ(out.All<lidar_clock_t>(bus::kLidarClock).size(), 2U);  // one per scan, not per part
  int next_column = 0;
  for (int i = 0; i < parts[0].num_parts; ++i) {
    const auto& part = parts[static_cast<std::size_t>(i)];
    EXPECT_EQ(part.part_index, i);
    EXPECT_EQ(part.seq, 0);
    EXPECT_EQ(part.first_column, next_column);
    EXPECT_EQ(part.num_cells, part.num_columns * 32);
    EXPECT_LE(part.getEncodedSize(), bus::kMaxMessageBytes);
    EXPECT_EQ(part.return_kind, (std::vector<std::int32_t>{lidar_scan_t::RETURN_LAST, lidar_scan_t::RETURN_STRONGEST}));
    next_column += part.num_columns;
  }
  EXPECT_EQ(next_column, parts[0].num_turn_columns);
}

TEST(Service, SaysWhenTheLidarIsSilentAndRecovers) {
  Recorded out;
  Service service(out.bus, Params{});
  service.AdvanceTo(kServiceTime);
  EXPECT_EQ(service.Report().state, HealthState::kOk);
  service.AdvanceTo(kServiceTime + milliseconds(3500));
  EXPECT_EQ(service.Report().state, HealthState::kDegraded);
  EXPECT_EQ(service.Report().reason, "no lidar packets for 3 s");
  SpinningSensor sensor;
  service.OnDatagram(kServiceTime + milliseconds(3501), 2368, sensor.Next());
  service.AdvanceTo(kServiceTime + milliseconds(3700));
  EXPECT_EQ(service.Report().state, HealthState::kOk);
}

TEST(Service, SaysThatTheHeadStandsWhilePacketsCome) {
  Recorded out;
  Service service(out.bus, Params{});
  SpinningSensor sensor;
  Utime host = kServiceTime;
  const auto run = [&](double rpm, int num_packets) {
    sensor.rpm = rpm;
    for (int i = 0; i < num_packets; ++i) {
      service.OnDatagram(host += microseconds(1327), 2368, sensor.Next());
      service.AdvanceTo(host);
    }
    return service.Report().reason;
  };
  EXPECT_EQ(run(600.0, 1500), "");
  EXPECT_EQ(run(0.0, 1200), "");
  EXPECT_EQ(run(0.0, 700), "lidar packets come, but no scan has ended for 2 s: the head stands, or turns too slowly");
  EXPECT_EQ(run(600.0, 300), "");
}

TEST(Service, SaysThatTheLidarIsSilentAlsoAfterTheHostsClockWasSetBack) {
  Recorded out;
  Service service(out.bus, Params{});
  service.AdvanceTo(kServiceTime);
  const Utime set_back = kServiceTime - std::chrono::hours(1);
  service.AdvanceTo(set_back);
  EXPECT_EQ(service.Report().reason, "");
  service.AdvanceTo(set_back + milliseconds(2500));
  EXPECT_EQ(service.Report().reason, "no lidar packets for 2 s");
}

TEST(Service, ForgetsASecondLidarWhenTheHostsClockWasSetBack) {
  Recorded out;
  Service service(out.bus, Params{});
  SpinningSensor sensor;
  service.OnDatagram(kServiceTime, 2368, sensor.Next(), {"192.168.1.201", 2368});
  service.OnDatagram(kServiceTime, 2368, sensor.Next(), {"192.168.1.202", 2368});
  service.AdvanceTo(kServiceTime);
  EXPECT_NE(service.Report().reason.find("two lidars on one port"), std::string::npos);
  service.AdvanceTo(kServiceTime - std::chrono::hours(1));
  EXPECT_EQ(service.Report().reason, "");
}

TEST(Service, SaysWhenMoreThanTenPacketsASecondDoNotFollowOneAnother) {
  for (const int num_breaks : {10, 25}) {
    Recorded out;
    Service service(out.bus, Params{});
    SpinningSensor sensor;
    service.AdvanceTo(kServiceTime);
    for (int i = 0; i < 740; ++i) {
      if (i % 28 == 27 && i / 28 < num_breaks) sensor.azimuth_deg += 90.0;
      service.OnDatagram(kServiceTime + microseconds(sensor.time_ns / 1000), 2368, sensor.Next());
    }
    service.AdvanceTo(kServiceTime + milliseconds(1000));
    const auto reason = service.Report().reason;
    EXPECT_EQ(reason.find("(25 breaks in the last second)") != std::string::npos, num_breaks == 25) << reason;
  }
}

TEST(Service, SaysThatTheLidarIsSilentWhileOtherDatagramsNeverEnd) {
  Recorded out;
  Service service(out.bus, Params{});
  SpinningSensor sensor;
  service.AdvanceTo(kServiceTime);
  service.OnDatagram(kServiceTime, 2368, sensor.Next());
  // What came later than 50 ms still waits: the bundle too.
  service.AdvanceTo(kServiceTime + milliseconds(3500), kServiceTime + milliseconds(50));
  out.Handle();
  EXPECT_TRUE(out.messages.empty());
  EXPECT_EQ(service.Report().reason, "no lidar packets for 3 s");
  service.AdvanceTo(kServiceTime + milliseconds(3500), kServiceTime + milliseconds(100));
  out.Handle();
  EXPECT_EQ(out.All<lidar_packets_t>(bus::kLidarPackets).size(), 1U);
}

TEST(Service, SaysWhyTheLidarIsOfNoUse) {
  Recorded out;
  Service service(out.bus, Params{});
  service.AdvanceTo(kServiceTime);
  service.OnDatagram(kServiceTime, 2368, test::Payload(format::kDataPacketSizeBytes, 7));
  service.AdvanceTo(kServiceTime + milliseconds(1500));
  EXPECT_EQ(service.Report().reason, "no usable lidar packets for 1 s; the last was refused: data_bad_flag");
}

TEST(Service, NamesASensorWhosePacketsAreOfAnotherSize) {
  Recorded out;
  Service service(out.bus, Params{});
  service.AdvanceTo(kServiceTime);
  test::Payload robosense(1248);
  const std::string_view header = "\x55\xAA\x05\x0A\x5A\xA5\x50\xA0";
  std::ranges::copy(header, robosense.begin());
  service.OnDatagram(kServiceTime, 2368, robosense);
  service.AdvanceTo(kServiceTime + milliseconds(1500));
  EXPECT_EQ(service.Report().reason, "no usable lidar packets for 1 s; the last was refused: a packet of another sensor: RoboSense");
}

TEST(Service, TellsRateRotationAndPhase) {
  Recorded out;
  Service service(out.bus, Params{});
  SpinningSensor sensor;
  sensor.rpm = 1200.0;
  Utime host = kServiceTime;
  for (int i = 0; i < 1600; ++i) {
    service.OnDatagram(host += microseconds(1327), 2368, sensor.Next());
    service.AdvanceTo(host);
  }
  const auto report = service.Report();
  EXPECT_NEAR(static_cast<double>(support::CountOf(report, "data_packets_per_s")), 754.0, 20.0);  // bundles are counted when they are full
  EXPECT_EQ(support::CountOf(report, "rotation_rpm"), 1200);
  EXPECT_LE(std::min<std::int64_t>(support::CountOf(report, "rotation_phase_cdeg"), 36000 - support::CountOf(report, "rotation_phase_cdeg")), 2);
}

TEST(Service, SaysWhenTwoLidarsSendToOnePort) {
  for (const std::int64_t apart_ns : {663'600LL, 500'000'000'000LL}) {
    Recorded out;
    Service service(out.bus, Params{});
    SpinningSensor one;
    SpinningSensor other;
    other.time_ns = apart_ns;
    other.azimuth_deg = 100.0;
    Utime host = kServiceTime;
    service.AdvanceTo(host);
    for (int i = 0; i < 1600; ++i) {
      service.OnDatagram(host += microseconds(663), 2368, one.Next());
      service.OnDatagram(host += microseconds(664), 2368, other.Next());
      service.AdvanceTo(host);
    }
    EXPECT_EQ(service.Report().state, HealthState::kDegraded);
    EXPECT_NE(service.Report().reason.find("two lidars on one port"), std::string::npos) << service.Report().reason;
  }
}

TEST(Service, TellsTemperaturesAndAThermalShutdown) {
  Recorded out;
  Service service(out.bus, Params{});
  auto position = test::MakePositionPacket(0, format::kPpsLocked, "");
  EXPECT_EQ(std::ranges::count(service.Report().counters, "top_board_celsius", &Counter::name), 0);
  const auto send = [&] {
    service.OnDatagram(kServiceTime, 8308, position);
    service.AdvanceTo(kServiceTime + milliseconds(200));
  };
  position[format::kTopBoardTemperatureOffset] = 61;
  position[format::kBottomBoardTemperatureOffset] = 58;
  send();
  EXPECT_EQ(support::CountOf(service.Report(), "top_board_celsius"), 61);
  EXPECT_EQ(service.Report().state, HealthState::kOk);
  position[format::kThermalStateOffset] = format::kThermalShutdown;
  send();
  EXPECT_EQ(service.Report().state, HealthState::kDegraded);
  EXPECT_EQ(service.Report().reason, "the lidar has shut down for its temperature: 61 degrees C at the top board, 58 at the bottom board");
  service.AdvanceTo(kServiceTime + milliseconds(3500));
  EXPECT_EQ(service.Report().reason,
            "the lidar has shut down for its temperature: 61 degrees C at the top board, 58 at the bottom board; no lidar packets for 3 s");
}

TEST(Service, SaysWhenTheSensorsTimeIsOfAnotherSecond) {
  for (const int off_s : {0, 1, 18}) {
    Recorded out;
    Params params;
    params.decoder.time = TimeChoice::kSensor;
    Service service(out.bus, params);
    SpinningSensor sensor;
    const auto begin = kServiceTime + std::chrono::hours(12) + std::chrono::seconds(off_s);
    Utime host = begin;
    for (int i = 0; i < 3000; ++i) {
      if (i % 100 == 0) {
        const auto second = sensor.stamp_us() / 1'000'000;
        auto sentence = "GPRMC,1200" + std::to_string(100 + second % 60).substr(1) + ",A,5400.000,N,01000.000,E,0.0,0.0,041024,,,A";
        service.OnDatagram(host, 8308, test::MakePositionPacket(sensor.stamp_us(), format::kPpsLocked, WithChecksum(sentence) + "\r\n"));
      }
      service.OnDatagram(host += microseconds(1327), 2368, sensor.Next());
      service.AdvanceTo(host);
    }
    const auto reason = service.Report().reason;
    EXPECT_EQ(reason.starts_with("scans carry the sensor's time as configured, and this computer's clock is "), off_s > 0) << reason;
  }
}

TEST(Service, NoticesEachChangeOfTheClockOnce) {
  Recorded out;
  Service service(out.bus, Params{});
  std::vector<std::string> notices;
  service.OnNotice([&](const std::string& notice) { notices.push_back(notice); });
  SpinningSensor sensor;
  Utime host = kServiceTime;
  const auto send = [&](std::uint8_t pps) {
    for (int i = 0; i < 300; ++i) {
      if (i % 10 == 0) service.OnDatagram(host, 8308, test::MakePositionPacket(sensor.stamp_us(), pps, ""));
      service.OnDatagram(host += microseconds(1327), 2368, sensor.Next());
    }
  };
  send(format::kPpsAbsent);
  send(format::kPpsSynchronising);
  send(format::kPpsLocked);
  ASSERT_EQ(notices.size(), 3U);
  EXPECT_TRUE(notices[0].starts_with("sensor clock: no PPS; scans carry this computer's time")) << notices[0];
  EXPECT_TRUE(notices[1].starts_with("sensor clock: no PPS -> acquiring; scans carry")) << notices[1];
  EXPECT_TRUE(notices[2].starts_with("sensor clock: acquiring -> locked without time; scans carry")) << notices[2];
}

TEST(Service, WorksWithTimesBefore1970) {
  Recorded out;
  Service service(out.bus, Params{});
  SpinningSensor sensor;
  for (int i = 0; i < 4; ++i) {
    const auto payload = sensor.Next();
    service.OnDatagram(Utime(microseconds(sensor.time_ns / 1000 - 5000)), 2368, payload);
  }
  service.Finish(Utime{});
  out.Handle();
  const auto scans = out.All<lidar_scan_t>(bus::kLidarScan);
  ASSERT_EQ(scans.size(), 1U);
  EXPECT_NEAR(static_cast<double>(scans[0].utime_us), -5000.0, 1.0);
  EXPECT_EQ(scans[0].num_columns, 96);
}

TEST(Service, SaysBeamsRingByRing) {
  Recorded out;
  Params params;
  params.decoder.use_vertical_origin_offsets = true;
  Service service(out.bus, params);
  SpinningSensor sensor;
  service.OnDatagram(kServiceTime, 2368, sensor.Next());
  service.Finish(kServiceTime);
  out.Handle();
  const auto scan = out.All<lidar_scan_t>(bus::kLidarScan).at(0);
  ASSERT_EQ(scan.num_rings, 16);
  EXPECT_EQ(scan.model, "VLP-16");
  EXPECT_EQ(scan.range_unit_m, 0.002);
  EXPECT_EQ(scan.time_offset_ns[0], 0);
  EXPECT_EQ(scan.time_offset_ns[8], 2304);  // laser 1
  EXPECT_EQ(scan.time_offset_ns[15], 15 * 2304);
  EXPECT_NEAR(scan.azimuth_offset_rad[15], 10.0 * 6.2831853 * 15 * 2304e-9, 2e-5);
  EXPECT_FLOAT_EQ(scan.origin_height_m[0], 0.0112F);
  EXPECT_EQ(scan.return_kind, (std::vector<std::int32_t>{lidar_scan_t::RETURN_STRONGEST}));
}

}  // namespace
}  // namespace lookout::vlp16
