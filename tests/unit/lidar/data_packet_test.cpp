#include "services/lidar/core/vlp16/data_packet.hpp"

#include <gtest/gtest.h>

#include "tests/unit/lidar/packet_maker.hpp"

namespace lookout::vlp16 {

using namespace lidar;
namespace {

using test::Azimuths;
using test::MakeDataPacket;

TEST(DataPacket, IsReadWithAzimuthsStampModeAndProduct) {
  const auto payload = MakeDataPacket(Azimuths(35900, 40), 3'599'999'999U, format::kModeLast, format::kProductPuckHiRes);
  const auto result = ParseDataPacket(payload);
  ASSERT_EQ(result.fault, DataFault::kNone);
  EXPECT_EQ(result.packet.num_steps, 12);
  EXPECT_EQ(result.packet.azimuth_cdeg[0], 35900);
  EXPECT_EQ(result.packet.azimuth_cdeg[11], 340);
  EXPECT_EQ(result.packet.stamp_us, 3'599'999'999U);
  EXPECT_EQ(result.packet.mode, ReturnMode::kLast);
  EXPECT_EQ(result.packet.product, format::kProductPuckHiRes);
  EXPECT_EQ(result.packet.period(), format::kPacketPeriodSingle);
}

TEST(DataPacket, HasHalfTheStepsInDualReturn) {
  const auto payload = MakeDataPacket(Azimuths(100, 40, true), 0, format::kModeDual);
  const auto result = ParseDataPacket(payload);
  ASSERT_EQ(result.fault, DataFault::kNone);
  EXPECT_EQ(result.packet.num_steps, 6);
  EXPECT_EQ(result.packet.num_returns(), 2);
  EXPECT_EQ(result.packet.azimuth_cdeg[5], 300);
  EXPECT_EQ(result.packet.period(), format::kPacketPeriodDual);
}

TEST(DataPacket, IsRefusedForAnyOtherSize) {
  auto payload = MakeDataPacket(Azimuths(0, 40), 0);
  EXPECT_EQ(ParseDataPacket({}).fault, DataFault::kSize);
  EXPECT_EQ(ParseDataPacket(Bytes(payload).first(1205)).fault, DataFault::kSize);
  payload.push_back(0);
  EXPECT_EQ(ParseDataPacket(payload).fault, DataFault::kSize);
}

TEST(DataPacket, IsRefusedWhenTheFlagOfAnyBlockIsWrong) {
  for (std::size_t block = 0; block < format::kNumBlocks; ++block) {
    auto payload = MakeDataPacket(Azimuths(0, 40), 0);
    payload[block * format::kBlockSizeBytes] = 0xDD;
    EXPECT_EQ(ParseDataPacket(payload).fault, DataFault::kFlag) << block;
  }
}

TEST(DataPacket, IsRefusedWhenAnAzimuthIsNoAngle) {
  auto azimuth_cdeg = Azimuths(0, 40);
  azimuth_cdeg[11] = 35999;
  azimuth_cdeg[10] = 35990;
  EXPECT_EQ(ParseDataPacket(MakeDataPacket(azimuth_cdeg, 0)).fault, DataFault::kNone);
  for (const int azimuth : {36100, 36400, 65535}) {
    azimuth_cdeg[11] = azimuth;
    EXPECT_EQ(ParseDataPacket(MakeDataPacket(azimuth_cdeg, 0)).fault, DataFault::kAzimuth) << azimuth;
  }
}

TEST(DataPacket, WrapsAnAzimuthThatWasRoundedUpToAFullRevolution) {
  // As a real head sent it.
  const auto result = ParseDataPacket(MakeDataPacket({35921, 35941, 35960, 35979, 36000, 18, 38, 57, 77, 95, 116, 135}, 0));
  ASSERT_EQ(result.fault, DataFault::kNone);
  EXPECT_TRUE(result.packet.has_wrapped_azimuth);
  EXPECT_EQ(result.packet.azimuth_cdeg[4], 0);
  EXPECT_EQ(result.packet.azimuth_cdeg[5], 18);
  // The most that rounding can be.
  EXPECT_EQ(ParseDataPacket(MakeDataPacket({35921, 35941, 35960, 35979, 36000, 36099, 138, 157, 177, 195, 216, 235}, 0)).packet.azimuth_cdeg[5], 99);
  EXPECT_FALSE(ParseDataPacket(MakeDataPacket(Azimuths(0, 40), 0)).packet.has_wrapped_azimuth);
  // Not where its neighbours are elsewhere: the blocks would go round more than once.
  EXPECT_EQ(ParseDataPacket(MakeDataPacket({100, 140, 180, 220, 36000, 300, 340, 380, 420, 460, 500, 540}, 0)).fault, DataFault::kAzimuthOrder);
}

TEST(DataPacket, IsRefusedForAnUnknownReturnMode) {
  for (const std::uint8_t mode : {0x00, 0x36, 0x3A, 0xFF}) {
    EXPECT_EQ(ParseDataPacket(MakeDataPacket(Azimuths(0, 40), 0, mode)).fault, DataFault::kReturnMode);
  }
}

TEST(DataPacket, MayHaveAnyStamp) {
  for (const std::uint32_t stamp_us : {3'600'999'999U, 3'601'000'000U, 4'294'967'295U}) {
    const auto result = ParseDataPacket(MakeDataPacket(Azimuths(0, 40), stamp_us));
    EXPECT_EQ(result.fault, DataFault::kNone);
    EXPECT_EQ(result.packet.stamp_us, stamp_us);
  }
}

TEST(DataPacket, IsRefusedWhenItsBlocksGoRoundMoreThanOnce) {
  auto azimuth_cdeg = Azimuths(20000, 40);
  azimuth_cdeg[5] = 12345;  // back by more than noise, so nearly once round, and then round again
  EXPECT_EQ(ParseDataPacket(MakeDataPacket(azimuth_cdeg, 0)).fault, DataFault::kAzimuthOrder);
  azimuth_cdeg[5] = azimuth_cdeg[4] - 3;  // noise
  EXPECT_EQ(ParseDataPacket(MakeDataPacket(azimuth_cdeg, 0)).fault, DataFault::kNone);
}

TEST(DataPacket, IsRefusedWhenDualBlocksDoNotPair) {
  auto azimuth_cdeg = Azimuths(100, 40, true);
  azimuth_cdeg[7] += 1;
  EXPECT_EQ(ParseDataPacket(MakeDataPacket(azimuth_cdeg, 0, format::kModeDual)).fault, DataFault::kDualPair);
}

Steps StepsOf(const std::array<int, format::kNumBlocks>& azimuth_cdeg, int fallback_cdeg, std::uint8_t mode = format::kModeStrongest) {
  const auto payload = MakeDataPacket(azimuth_cdeg, 0, mode);
  return MeasureSteps(ParseDataPacket(payload).packet, fallback_cdeg);
}

TEST(Steps, AreTheGapsBetweenBlocksAndTheLastRepeatsTheOneBefore) {
  const auto steps = StepsOf({35960, 35999, 39, 80, 120, 160, 199, 239, 280, 320, 361, 400}, 0);
  EXPECT_EQ(steps.gap_cdeg, (std::array<int, 12>{39, 40, 41, 40, 40, 39, 40, 41, 40, 41, 39, 39}));
  EXPECT_EQ(steps.duration, format::kPacketPeriodSingle);
}

TEST(Steps, AreBetweenPairsInDualReturn) {
  const auto steps = StepsOf(Azimuths(35950, 41, true), 0, format::kModeDual);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(steps.gap_cdeg[static_cast<std::size_t>(i)], 41);
  EXPECT_EQ(steps.duration, format::kPacketPeriodDual);
}

TEST(Steps, TakeTheMedianWhereTheFieldOfViewJumps) {
  // 90 degrees are left out after the sixth block: the head took 9000/40 steps for them.
  const auto steps = StepsOf({0, 40, 80, 120, 160, 200, 9240, 9280, 9321, 9360, 9400, 9440}, 0);
  EXPECT_EQ(steps.gap_cdeg[5], 40);
  EXPECT_EQ(steps.time[5], 5 * format::kBlockPeriod);
  EXPECT_EQ(steps.time[6], (6 + 225) * format::kBlockPeriod);
  EXPECT_EQ(steps.duration, format::kPacketPeriodSingle + 225 * format::kBlockPeriod);
  ASSERT_TRUE(steps.jump);
  EXPECT_EQ(steps.jump->from_cdeg, 240);
  EXPECT_EQ(steps.jump->to_cdeg, 9240);
  EXPECT_EQ(steps.end_cdeg, 9480);
}

TEST(Steps, TakeTheLastUsableGapForTheLastBlock) {
  const auto steps = StepsOf({0, 40, 80, 120, 160, 200, 240, 280, 320, 360, 401, 9000}, 0);
  EXPECT_EQ(steps.gap_cdeg[10], 40);
  EXPECT_EQ(steps.gap_cdeg[11], 41);
}

TEST(Steps, FallBackWhenNoGapIsARate) {
  const auto steps = StepsOf({0, 1000, 2000, 3000, 4000, 5000, 6000, 7000, 8000, 9000, 10000, 11000}, 37);
  for (const int gap_cdeg : steps.gap_cdeg) EXPECT_EQ(gap_cdeg, 37);
}

TEST(Steps, AcceptTheFastestHeadButNotMore) {
  EXPECT_EQ(StepsOf(Azimuths(0, 80), 0).gap_cdeg[0], 80);  // 1200 rpm
  EXPECT_EQ(StepsOf(Azimuths(0, 100), 7).gap_cdeg[0], 7);
}

}  // namespace
}  // namespace lookout::vlp16
