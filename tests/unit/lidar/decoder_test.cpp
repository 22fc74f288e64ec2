// Decoder and ScanCutter together: packets in, scans out.
#include "services/lidar/core/vlp16/decoder.hpp"

#include <algorithm>
#include <cstdlib>
#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "tests/unit/lidar/decoder_bench.hpp"
#include "tests/unit/lidar/packet_maker.hpp"

namespace lookout::vlp16 {

using namespace lidar;
namespace {

using namespace test;

TEST(Decoder, GivesNoScanWithoutPackets) {
  DecoderBench bench;
  bench.decoder.Flush();
  EXPECT_TRUE(bench.scans.empty());
}

TEST(Decoder, GivesOnePartialScanForOnePacket) {
  DecoderBench bench;
  auto payload = MakeDataPacket(Azimuths(1000, 40), 1'000'000, format::kModeStrongest, format::kProductVlp16, {});
  test::SetReturn(payload, 0, 0, 0, {700, 11});  // lowest beam
  test::SetReturn(payload, 0, 1, 1, {800, 12});  // laser 1 is ring 8
  test::SetReturn(payload, 11, 1, 15, {65535, 255});
  test::SetReturn(payload, 3, 0, 4, {0, 99});  // no return has no reflectivity
  bench.decoder.OnDataPayload(kDecoderTime, payload);
  bench.decoder.Flush();
  ASSERT_EQ(bench.scans.size(), 1U);
  const auto& scan = bench.scans[0];
  ASSERT_EQ(scan.num_columns(), 24);
  EXPECT_TRUE(scan.is_partial_start);
  EXPECT_TRUE(scan.is_partial_end);
  EXPECT_FALSE(scan.has_hole);
  EXPECT_EQ(scan.range.size(), 24U * 16U);
  EXPECT_EQ(scan.range[0], 700);
  EXPECT_EQ(scan.reflectivity[0], 11);
  EXPECT_EQ(scan.range[16 + 8], 800);
  EXPECT_EQ(scan.range[23 * 16 + 15], 65535);
  EXPECT_EQ(scan.reflectivity[23 * 16 + 15], 255);
  EXPECT_EQ(std::ranges::count_if(scan.range, [](std::uint16_t range) { return range != 0; }), 3);
  EXPECT_EQ(std::ranges::count_if(scan.reflectivity, [](std::uint8_t value) { return value != 0; }), 3);
  EXPECT_NEAR(scan.azimuth_rad[0], DegToRad(10.0), 1e-6);
  EXPECT_NEAR(scan.azimuth_rad[1], DegToRad(10.2), 1e-6);
  EXPECT_NEAR(scan.azimuth_rad[23], DegToRad(14.6), 1e-6);
  EXPECT_EQ(scan.time_ns[0], 0);
  EXPECT_EQ(scan.time_ns[1], 55296);
  EXPECT_EQ(scan.time_ns[23], 23 * 55296);
  EXPECT_EQ(scan.time, kDecoderTime - std::chrono::microseconds(1327));  // the host took it after its last shot
  EXPECT_EQ(scan.end_time - scan.time, std::chrono::microseconds((23 * 55296 + 15 * 2304) / 1000));
  EXPECT_NEAR(scan.rate_radps, kTwoPi * 10.0, kTwoPi * 0.05);
}

TEST(Decoder, CutsInsideAPacketAtTheFirstColumnAtTheCut) {
  DecoderBench bench;
  auto sensor = SpinningSensor();
  sensor.azimuth_deg = 355.0;
  bench.Send(sensor, 4);
  bench.decoder.Flush();
  ASSERT_EQ(bench.scans.size(), 2U);
  EXPECT_TRUE(bench.scans[0].is_partial_start);
  EXPECT_FALSE(bench.scans[0].is_partial_end);
  EXPECT_FALSE(bench.scans[1].is_partial_start);
  EXPECT_TRUE(bench.scans[1].is_partial_end);
  EXPECT_EQ(bench.scans[0].num_columns() + bench.scans[1].num_columns(), 4 * 24);
  EXPECT_GT(bench.scans[0].azimuth_rad.back(), DegToRad(359.7));
  EXPECT_LT(bench.scans[1].azimuth_rad.front(), DegToRad(0.2));
  EXPECT_EQ(bench.scans[1].number, 1);
}

TEST(Decoder, PutsAColumnExactlyAtTheCutIntoTheNewScan) {
  DecoderBench bench(Cut(120.0));
  bench.decoder.OnDataPayload(kDecoderTime, MakeDataPacket(Azimuths(11780, 40), 0));  // second firing of block 5: 119.80 + 0.20
  bench.decoder.Flush();
  ASSERT_EQ(bench.scans.size(), 2U);
  EXPECT_EQ(bench.scans[0].num_columns(), 11);
  EXPECT_FLOAT_EQ(bench.scans[1].azimuth_rad.front(), static_cast<float>(DegToRad(120.0)));
}

TEST(Decoder, EndsTheScanWhereTheSensorPausedForMoreThanASecond) {
  DecoderBench bench(Cut(180.0));
  SpinningSensor sensor;
  bench.Send(sensor, 10);
  sensor.time_ns += 1'500'000'000;
  sensor.azimuth_deg += 30.0;
  bench.Send(sensor, 10);
  bench.decoder.Flush();
  ASSERT_EQ(bench.scans.size(), 2U);
  EXPECT_TRUE(bench.scans[0].is_partial_end);
  EXPECT_TRUE(bench.scans[1].is_partial_start);
  EXPECT_EQ(bench.CountOf("sensor_restarts"), 1);
}

TEST(Decoder, KeepsWhatIsHeldOfProduct0x21FromTheVerdictAboutAnotherByte) {
  DecoderBench bench;
  SpinningSensor sensor;
  sensor.product = format::kProductHdl32e;
  bench.Send(sensor);
  sensor.product = format::kProductVlp16;
  bench.Send(sensor);
  bench.decoder.Flush();
  EXPECT_EQ(bench.CountOf("data_model_undecided"), 1);
  ASSERT_EQ(bench.scans.size(), 1U);
  EXPECT_EQ(bench.scans[0].num_columns(), 24);
}

TEST(Decoder, TakesAScanForPartialThatBeginsOneColumnBehindTheCut) {
  for (const double cut_deg : {9.80, 9.81}) {
    DecoderBench bench(Cut(cut_deg));
    bench.decoder.OnDataPayload(kDecoderTime, MakeDataPacket(Azimuths(1000, 40), 0));
    bench.decoder.Flush();
    ASSERT_EQ(bench.scans.size(), 1U);
    EXPECT_EQ(bench.scans[0].is_partial_start, cut_deg < 9.81);
  }
}

TEST(Decoder, TakesAScanForWholeWhoseNextColumnWouldBeExactlyAtTheCut) {
  for (const double cut_deg : {14.80, 14.81}) {
    DecoderBench bench(Cut(cut_deg));
    bench.decoder.OnDataPayload(kDecoderTime, MakeDataPacket(Azimuths(1000, 40), 0));  // the last column: 14.40 + 0.20
    bench.decoder.Flush();
    ASSERT_EQ(bench.scans.size(), 1U);
    EXPECT_EQ(bench.scans[0].is_partial_end, cut_deg > 14.80);
  }
}

TEST(Decoder, InterpolatesAcrossTheSeam) {
  DecoderBench bench(Cut(180.0));
  bench.decoder.OnDataPayload(kDecoderTime, MakeDataPacket(Azimuths(35990, 40), 0));
  bench.decoder.Flush();
  ASSERT_EQ(bench.scans.size(), 1U);
  EXPECT_NEAR(bench.scans[0].azimuth_rad[0], DegToRad(359.9), 1e-6);
  EXPECT_NEAR(bench.scans[0].azimuth_rad[1], DegToRad(0.1), 1e-6);
  EXPECT_NEAR(bench.scans[0].azimuth_rad[2], DegToRad(0.3), 1e-6);
}

TEST(Decoder, CountsAScanFromCutToCutAsWhole) {
  for (const double rpm : {300.0, 600.0, 1200.0}) {
    DecoderBench bench;
    SpinningSensor sensor;
    sensor.rpm = rpm;
    const int packets_per_revolution = static_cast<int>(60e9 / rpm / 1327104.0);
    bench.Send(sensor, 3 * packets_per_revolution + 5);  // begins at the cut: nothing of its first scan is missing
    bench.decoder.Flush();
    ASSERT_GE(bench.scans.size(), 3U) << rpm;
    for (std::size_t i = 0; i + 1 < bench.scans.size(); ++i) {
      EXPECT_FALSE(bench.scans[i].is_partial_start) << rpm;
      EXPECT_FALSE(bench.scans[i].is_partial_end) << rpm;
      EXPECT_NEAR(bench.scans[i].num_columns(), 60e9 / rpm / 55296, 1.0);
      EXPECT_NEAR(bench.scans[i].rate_radps, rpm / 60.0 * kTwoPi, 0.002 * rpm / 60.0 * kTwoPi);
    }
    EXPECT_TRUE(bench.scans.back().is_partial_end);
  }
}

TEST(Decoder, TakesTwoReturnsPerShotInDualMode) {
  DecoderBench bench;
  auto payload = MakeDataPacket(Azimuths(1000, 40, true), 0, format::kModeDual, format::kProductVlp16, {});
  test::SetReturn(payload, 2, 1, 15, {900, 1});  // last
  test::SetReturn(payload, 3, 1, 15, {800, 2});  // strongest, of the same shot
  bench.decoder.OnDataPayload(kDecoderTime, payload);
  bench.decoder.Flush();
  ASSERT_EQ(bench.scans.size(), 1U);
  const auto& scan = bench.scans[0];
  EXPECT_EQ(scan.num_columns(), 12);
  EXPECT_EQ(scan.num_returns(), 2);
  ASSERT_EQ(scan.range.size(), 12U * 16U * 2U);
  const std::size_t cell = (3 * 16 + 15) * 2;
  EXPECT_EQ(scan.range[cell], 900);
  EXPECT_EQ(scan.range[cell + 1], 800);
  EXPECT_EQ(scan.reflectivity[cell + 1], 2);
  EXPECT_NEAR(scan.azimuth_rad[3], DegToRad(10.6), 1e-6);
  EXPECT_EQ(scan.time_ns[11], 11 * 55296);
}

TEST(Decoder, EndsTheScanWhenTheReturnModeChanges) {
  DecoderBench bench;
  SpinningSensor sensor;
  sensor.azimuth_deg = 10.0;
  bench.Send(sensor, 3);
  sensor.mode = format::kModeDual;
  bench.Send(sensor, 3);
  sensor.mode = format::kModeLast;
  bench.Send(sensor, 3);
  sensor.product = format::kProductPuckHiRes;
  bench.Send(sensor, 3);
  bench.decoder.Flush();
  ASSERT_EQ(bench.scans.size(), 4U);
  EXPECT_TRUE(bench.scans[0].is_partial_end);
  EXPECT_TRUE(bench.scans[1].is_partial_start);
  EXPECT_EQ(bench.scans[1].num_returns(), 2);
  EXPECT_EQ(bench.scans[1].num_columns(), 36);
  EXPECT_EQ(bench.scans[2].head->returns, std::vector{lidar::ReturnKind::kLast});
  EXPECT_EQ(bench.scans[3].head->model, "Puck Hi-Res");
  EXPECT_EQ(bench.scans[3].counts.num_lost, 0);
}

TEST(Decoder, MarksAHoleInsideAScan) {
  DecoderBench bench;
  SpinningSensor sensor;
  sensor.azimuth_deg = 10.0;
  bench.Send(sensor, 3);
  sensor.Skip(5);
  bench.Send(sensor, 3);
  bench.decoder.Flush();
  ASSERT_EQ(bench.scans.size(), 1U);
  EXPECT_TRUE(bench.scans[0].has_hole);
  EXPECT_EQ(bench.scans[0].num_lost_packets, 5);
  EXPECT_EQ(bench.scans[0].counts.num_lost, 5);
  EXPECT_EQ(bench.scans[0].num_columns(), 6 * 24);
  EXPECT_NEAR(bench.scans[0].time_ns[72], 8 * 1327104, 1000);
}

TEST(Decoder, SharesALossAcrossTheCutBetweenBothScans) {
  DecoderBench bench;
  SpinningSensor sensor;
  sensor.azimuth_deg = 345.0;
  bench.Send(sensor, 2);  // to 354.55
  sensor.Skip(2);         // to 4.1
  bench.Send(sensor, 2);
  bench.decoder.Flush();
  ASSERT_EQ(bench.scans.size(), 2U);
  EXPECT_TRUE(bench.scans[0].has_hole);
  EXPECT_TRUE(bench.scans[1].has_hole);
  EXPECT_FALSE(bench.scans[0].is_partial_end);
  EXPECT_FALSE(bench.scans[1].is_partial_start);
  EXPECT_EQ(bench.scans[0].num_lost_packets, 2);  // one before the cut, one across it
  EXPECT_EQ(bench.scans[1].num_lost_packets, 1);  // the one across it
  EXPECT_EQ(bench.scans[1].counts.num_lost, 2);
}

TEST(Decoder, DoesNotJoinWhatLiesMoreThanARevolutionApart) {
  DecoderBench bench;
  SpinningSensor sensor;
  sensor.azimuth_deg = 10.0;
  bench.Send(sensor, 2);
  sensor.Skip(76);
  bench.Send(sensor, 2);
  bench.decoder.Flush();
  ASSERT_EQ(bench.scans.size(), 2U);
  EXPECT_TRUE(bench.scans[0].is_partial_end);
  EXPECT_TRUE(bench.scans[0].has_hole);
  EXPECT_TRUE(bench.scans[1].is_partial_start);
  EXPECT_TRUE(bench.scans[1].has_hole);
  EXPECT_EQ(bench.CountOf("data_lost"), 76);
}

TEST(Decoder, DropsCopiesAndPutsLatePacketsRight) {
  DecoderBench bench;
  SpinningSensor sensor;
  sensor.azimuth_deg = 10.0;
  const auto first = sensor.Next();
  const auto second = sensor.Next();
  const auto third = sensor.Next();
  for (const auto* payload : {&first, &third, &third, &second}) bench.decoder.OnDataPayload(kDecoderTime, *payload);
  bench.decoder.Flush();
  ASSERT_EQ(bench.scans.size(), 1U);
  const auto& scan = bench.scans[0];
  EXPECT_EQ(scan.num_columns(), 72);
  EXPECT_TRUE(std::ranges::is_sorted(scan.time_ns));
  EXPECT_FALSE(scan.has_hole);
  EXPECT_EQ(scan.counts.num_packets, 4);
  EXPECT_EQ(scan.counts.num_duplicates, 1);
  EXPECT_EQ(scan.counts.num_reordered, 1);
  EXPECT_EQ(scan.counts.num_lost, 0);
}

TEST(Decoder, KeepsAScanWholeWhenTheSensorsClockIsSet) {
  DecoderBench bench;
  SpinningSensor sensor;
  sensor.time_ns = 100'000'000'000;
  Utime host = kDecoderTime;
  const auto send = [&](int num_packets) {
    for (int i = 0; i < num_packets; ++i) bench.decoder.OnDataPayload(host += std::chrono::microseconds(1327), sensor.Next());
  };
  send(100);
  sensor.time_ns += 700'000'000'000;
  send(100);
  ASSERT_EQ(bench.scans.size(), 2U);
  EXPECT_FALSE(bench.scans[1].is_partial_start);
  EXPECT_FALSE(bench.scans[1].is_partial_end);
  EXPECT_FALSE(bench.scans[1].has_hole);
  EXPECT_NEAR(bench.scans[1].time_ns.back(), 100'000'000, 100'000);
  EXPECT_EQ(bench.CountOf("sensor_clock_steps"), 1);
}

TEST(Decoder, TellsTimesBehindAJumpOfALimitedFieldOfView) {
  DecoderBench bench;
  bench.decoder.OnDataPayload(kDecoderTime, MakeDataPacket({1000, 1040, 1080, 1120, 1160, 1200, 10200, 10240, 10280, 10320, 10360, 10400}, 0));
  bench.decoder.Flush();
  ASSERT_EQ(bench.scans.size(), 1U);
  EXPECT_EQ(bench.scans[0].time_ns[11], 11 * 55296);
  EXPECT_EQ(bench.scans[0].time_ns[12], (6 + 224) * 110592);
  EXPECT_EQ(bench.scans[0].time_ns[23], (11 + 224) * 110592 + 55296);
}

TEST(Decoder, DoesNotTakeAHeadThatCreepsBackForOneThatRotates) {
  DecoderBench bench;
  int azimuth_cdeg = 18000;
  for (int packet = 0; packet < 1600; ++packet) {
    std::array<int, format::kNumBlocks> azimuths{};
    for (auto& azimuth : azimuths) {
      azimuth = azimuth_cdeg;
      azimuth_cdeg = (azimuth_cdeg + format::kAzimuthsPerRevolution - 2) % format::kAzimuthsPerRevolution;
    }
    bench.decoder.OnDataPayload(kDecoderTime + packet * std::chrono::microseconds(1327),
                                MakeDataPacket(azimuths, static_cast<std::uint32_t>(packet * 1327)));
  }
  bench.decoder.Flush();
  for (const auto& scan : bench.scans) {
    EXPECT_TRUE(scan.is_partial_start || scan.is_partial_end);
    EXPECT_LT(scan.rate_radps, 1.0);
  }
  EXPECT_LE(bench.scans.size(), 3U);
}

TEST(Decoder, EndsTheScanWhereTheHeadIsNotWhereItShouldBe) {
  DecoderBench bench;
  SpinningSensor sensor;
  bench.Send(sensor, 100);
  sensor.azimuth_deg += 200.0;  // and no time has passed
  bench.Send(sensor, 100);
  bench.decoder.Flush();
  EXPECT_EQ(bench.CountOf("data_azimuth_disagrees"), 1);
  for (const auto& scan : bench.scans) {
    if (!scan.is_partial_start && !scan.is_partial_end) {
      EXPECT_NEAR(scan.num_columns(), 1808, 2);
    }
  }
}

TEST(Decoder, DoesNotJoinScansWhenALittleLessThanARevolutionIsMissing) {
  for (const int lost : {74, 75, 76}) {
    DecoderBench bench;
    SpinningSensor sensor;
    sensor.rpm = 601.0;
    bench.Send(sensor, 110);
    sensor.Skip(lost);
    bench.Send(sensor, 110);
    bench.decoder.Flush();
    EXPECT_EQ(bench.CountOf("data_lost"), lost);
    for (const auto& scan : bench.scans) EXPECT_LT(scan.time_ns.back(), 101'000'000) << lost;
  }
}

TEST(Decoder, StampsASentenceByTheHostWhenNoDataCome) {
  DecoderParams params;
  params.time = TimeChoice::kHost;
  DecoderBench bench(params);
  SpinningSensor sensor;
  bench.Send(sensor, 100);
  const Utime later = kDecoderTime + std::chrono::minutes(40);
  bench.decoder.OnPositionPayload(later, test::MakePositionPacket(2'400'000'000U, format::kPpsAbsent, "$GPRMC,004000,A"));
  ASSERT_EQ(bench.sentences.size(), 1U);
  EXPECT_EQ(bench.sentences[0].time, later);
}

TEST(Decoder, TellsThePhaseOfTheHead) {
  DecoderBench bench;
  SpinningSensor sensor;
  sensor.time_ns = 999'000'000;
  sensor.azimuth_deg = 100.0;
  bench.Send(sensor, 1);
  ASSERT_TRUE(bench.decoder.phase_cdeg());
  EXPECT_NEAR(*bench.decoder.phase_cdeg(), 10360, 2);  // 1 ms at 3.6 deg per ms behind 100 deg
  bench.Send(sensor, 100);
  EXPECT_NEAR(*bench.decoder.phase_cdeg(), 10360, 2);
}

TEST(Decoder, NamesASensorThatIsNotOfTheFamily) {
  DecoderBench bench;
  EXPECT_FALSE(bench.decoder.OnDataPayload(kDecoderTime, MakeDataPacket(Azimuths(0, 40), 0, 0x37, 0x28)));
  EXPECT_NE(bench.decoder.last_refusal().find("VLP-32C"), std::string::npos);
  EXPECT_EQ(bench.CountOf("data_unknown_product"), 1);
}

TEST(Decoder, EndsTheScanWhenTheSensorRestarts) {
  DecoderBench bench;
  SpinningSensor sensor;
  sensor.azimuth_deg = 10.0;
  sensor.time_ns = 100'000'000'000;
  bench.Send(sensor, 2);
  sensor.time_ns = 0;
  bench.Send(sensor, 2);
  bench.decoder.Flush();
  ASSERT_EQ(bench.scans.size(), 2U);
  EXPECT_TRUE(bench.scans[0].is_partial_end);
  EXPECT_TRUE(bench.scans[1].is_partial_start);
  EXPECT_FALSE(bench.scans[1].has_hole);
  EXPECT_EQ(bench.CountOf("sensor_restarts"), 1);
  EXPECT_EQ(bench.scans[1].time, kDecoderTime);  // its own offset, not that of the time before
}

TEST(Decoder, CapsAScanThatDoesNotEnd) {
  DecoderBench bench;
  SpinningSensor sensor;
  sensor.azimuth_deg = 10.0;
  sensor.rpm = 0.0;
  bench.Send(sensor, 1600);  // 2.1 s
  bench.decoder.Flush();
  ASSERT_EQ(bench.scans.size(), 2U);
  EXPECT_EQ(bench.CountOf("scans_capped"), 1);
  EXPECT_TRUE(bench.scans[0].is_partial_end);
  EXPECT_LE(bench.scans[0].time_ns.back(), 2'000'000'000);
  EXPECT_EQ(bench.scans[0].rate_radps, 0.0);
}

TEST(Decoder, DoesNotCutTwiceWhenTheEncoderTremblesAtTheCut) {
  DecoderBench bench;
  SpinningSensor sensor;
  sensor.azimuth_deg = 354.2;
  bench.Send(sensor, 1);
  bench.decoder.OnDataPayload(kDecoderTime, MakeDataPacket({35900, 35940, 35980, 20, 35999, 10, 35998, 30, 60, 100, 140, 180}, 1327));
  bench.decoder.Flush();
  EXPECT_EQ(bench.scans.size(), 2U);
}

TEST(Decoder, CutsWhereALimitedFieldOfViewJumpsOverTheCut) {
  DecoderBench bench;
  bench.decoder.OnDataPayload(kDecoderTime, MakeDataPacket({9000, 9040, 9080, 9120, 9160, 9200, 4500, 4540, 4580, 4620, 4660, 4700}, 0));
  bench.decoder.Flush();
  ASSERT_EQ(bench.scans.size(), 2U);
  EXPECT_EQ(bench.scans[0].num_columns(), 12);
  EXPECT_FALSE(bench.scans[0].is_partial_end);
  EXPECT_NEAR(bench.scans[0].azimuth_rad[11], DegToRad(92.2), 1e-6);
}

}  // namespace
}  // namespace lookout::vlp16
