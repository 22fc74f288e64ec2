// What Decoder makes of the stream of packets: which sensor it is, what is refused, whose time a scan carries, where a run begins.
#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "services/lidar/core/vlp16/decoder.hpp"
#include "tests/unit/lidar/decoder_bench.hpp"
#include "tests/unit/lidar/packet_maker.hpp"

namespace lookout::vlp16 {

using namespace lidar;
namespace {

using namespace test;

TEST(Decoder, HoldsPacketsOfTheSharedProductByteUntilItKnowsTheModel) {
  DecoderBench bench;
  SpinningSensor sensor;
  sensor.product = format::kProductHdl32e;
  bench.Send(sensor, 10);
  bench.decoder.Flush();
  ASSERT_EQ(bench.scans.size(), 1U);
  EXPECT_EQ(bench.scans[0].num_columns(), 10 * 24);
  EXPECT_EQ(bench.CountOf("data_model_undecided"), 0);
}

TEST(Decoder, RefusesAnHdl32eByName) {
  DecoderBench bench;
  for (int i = 0; i < 10; ++i) {
    bench.decoder.OnDataPayload(kDecoderTime, MakeDataPacket(Azimuths(100 + i * 240, 20), static_cast<std::uint32_t>(i * 553), 0x37, 0x21));
  }
  bench.decoder.Flush();
  EXPECT_TRUE(bench.scans.empty());
  EXPECT_EQ(bench.CountOf("data_hdl32e"), 10);
  EXPECT_NE(bench.decoder.last_refusal().find("HDL-32E"), std::string_view::npos);
}

TEST(Decoder, RefusesALonePacketOfTheSharedProductByte) {
  DecoderBench bench;
  bench.decoder.OnDataPayload(kDecoderTime, MakeDataPacket(Azimuths(100, 40), 5, 0x37, 0x21));
  bench.decoder.Flush();
  EXPECT_TRUE(bench.scans.empty());
  EXPECT_EQ(bench.CountOf("data_model_undecided"), 1);
}

TEST(Decoder, CountsEachKindOfBadPacketUnderItsOwnName) {
  DecoderBench bench;
  auto bad_flag = MakeDataPacket(Azimuths(0, 40), 0);
  bad_flag[0] = 0;
  bench.decoder.OnDataPayload(kDecoderTime, bad_flag);
  bench.decoder.OnDataPayload(kDecoderTime, MakeDataPacket(Azimuths(0, 40), 0, 0x37, 0x55));
  bench.decoder.OnDataPayload(kDecoderTime, MakeDataPacket(Azimuths(0, 40), 0, 0x12));
  bench.decoder.OnDataPayload(kDecoderTime, {});
  bench.decoder.OnPositionPayload(kDecoderTime, {});
  bench.decoder.OnPositionPayload(kDecoderTime, test::MakePositionPacket(0, 9, ""));
  for (const auto* name :
       {"data_bad_flag", "data_unknown_product", "data_bad_return_mode", "data_bad_size", "position_bad_size", "position_bad_pps"}) {
    EXPECT_EQ(bench.CountOf(name), 1) << name;
  }
}

TEST(Decoder, StampsAScanByTheSensorFromTheFirstScanThatBeginsLocked) {
  constexpr std::string_view kRmc = "$GPRMC,000000.00,A,,,,,,,041024,,";  // kDecoderTime
  DecoderBench bench;
  SpinningSensor sensor;
  sensor.azimuth_deg = 350.0;
  sensor.time_ns = 7'000'000;  // the host is 7 ms behind: both at kDecoderTime past the hour
  const Utime behind = kDecoderTime;
  const auto send = [&](int num_packets) {
    for (int i = 0; i < num_packets; ++i) {
      const auto payload = sensor.Next();
      bench.decoder.OnDataPayload(behind + std::chrono::microseconds(sensor.time_ns / 1000 - 7000), payload);
    }
  };
  send(1);
  bench.decoder.OnPositionPayload(behind, test::MakePositionPacket(8'000, format::kPpsLocked, kRmc));
  send(100);
  bench.decoder.Flush();
  ASSERT_EQ(bench.scans.size(), 3U);
  EXPECT_EQ(bench.scans[0].clock.source, TimeSource::kHost);
  EXPECT_EQ(bench.scans[1].clock.source, TimeSource::kSensor);
  EXPECT_EQ(bench.scans[1].clock.state, ClockState::kLocked);
  EXPECT_NEAR(ToSeconds(*bench.scans[1].clock.host_minus_sensor), -0.007, 1e-5);
  ASSERT_EQ(bench.sentences.size(), 1U);
  EXPECT_EQ(bench.sentences[0].text, kRmc);
  EXPECT_EQ(bench.sentences[0].stamp_us, 8'000U);
  EXPECT_NEAR(ToSeconds(bench.sentences[0].time - (behind + std::chrono::microseconds(1'000))), 0.0, 2e-6);  // by the host, as its scan
}

TEST(Decoder, BeginsAnewAfterAStartMark) {
  DecoderBench bench;
  SpinningSensor sensor;
  bench.Send(sensor, 200);
  const auto scans = bench.scans;
  bench.decoder.Reset();
  bench.scans.clear();
  sensor = SpinningSensor();
  bench.Send(sensor, 200);
  ASSERT_EQ(bench.scans.size(), scans.size());
  for (std::size_t i = 0; i < scans.size(); ++i) {
    EXPECT_EQ(bench.scans[i].number, scans[i].number);
    EXPECT_EQ(bench.scans[i].time, scans[i].time);
    EXPECT_EQ(bench.scans[i].time_ns, scans[i].time_ns);
    EXPECT_EQ(bench.scans[i].counts.num_packets, scans[i].counts.num_packets);
  }
}

}  // namespace
}  // namespace lookout::vlp16
