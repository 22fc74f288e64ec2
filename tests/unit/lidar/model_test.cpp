#include "services/lidar/core/vlp16/model.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "tests/unit/lidar/packet_maker.hpp"

namespace lookout::vlp16 {

using namespace lidar;
namespace {

DataPacket PacketOf(std::uint8_t product, std::uint32_t stamp_us = 0, ReturnMode mode = ReturnMode::kStrongest) {
  DataPacket packet;
  packet.product = product;
  packet.stamp_us = stamp_us;
  packet.mode = mode;
  packet.num_steps = mode == ReturnMode::kDual ? 6 : 12;
  return packet;
}

TEST(Beams, GoFromTheLowestUp) {
  for (const auto model : {Model::kVlp16, Model::kPuckHiRes}) {
    const auto& beams = BeamsOf(model);
    EXPECT_TRUE(std::ranges::is_sorted(beams.elevation_rad));
    for (int ring = 0; ring < format::kNumLasers; ++ring) {
      EXPECT_EQ(beams.ring_of_laser[static_cast<std::size_t>(beams.laser_of_ring[static_cast<std::size_t>(ring)])], ring);
    }
  }
}

TEST(Beams, OfTheVlp16AreTwoDegreesApart) {
  const auto& beams = BeamsOf(Model::kVlp16);
  EXPECT_EQ(beams.name, "VLP-16");
  EXPECT_EQ(beams.laser_of_ring, (std::array<int, 16>{0, 2, 4, 6, 8, 10, 12, 14, 1, 3, 5, 7, 9, 11, 13, 15}));
  EXPECT_DOUBLE_EQ(beams.elevation_rad[0], DegToRad(-15.0));
  EXPECT_DOUBLE_EQ(beams.elevation_rad[15], DegToRad(15.0));
  EXPECT_DOUBLE_EQ(beams.origin_height_m[0], 0.0112);
  EXPECT_DOUBLE_EQ(beams.origin_height_m[15], -0.0112);
}

TEST(Beams, OfThePuckHiResAreOneAndAThirdDegreesApart) {
  const auto& beams = BeamsOf(Model::kPuckHiRes);
  EXPECT_EQ(beams.name, "Puck Hi-Res");
  EXPECT_DOUBLE_EQ(beams.elevation_rad[0], DegToRad(-10.0));
  EXPECT_DOUBLE_EQ(beams.elevation_rad[1], DegToRad(-8.67));
  EXPECT_DOUBLE_EQ(beams.elevation_rad[15], DegToRad(10.0));
  EXPECT_DOUBLE_EQ(beams.origin_height_m[0], 0.0074);
  for (std::size_t ring = 1; ring < 16; ++ring)
    EXPECT_NEAR(beams.elevation_rad[ring] - beams.elevation_rad[ring - 1], DegToRad(20.0 / 15), DegToRad(0.011));
}

// By laws in place of the tables: simulator and decoder share the beams, so that neither would notice those of another laser.
TEST(Beams, OfEachLaserFollowTheirLaws) {
  for (const auto model : {Model::kVlp16, Model::kPuckHiRes}) {
    const auto& beams = BeamsOf(model);
    const double step_deg = model == Model::kVlp16 ? 2.0 : 20.0 / 15.0;
    for (int laser = 0; laser < format::kNumLasers; ++laser) {
      SCOPED_TRACE(testing::Message() << beams.name << " laser " << laser);
      // Lasers take turns below and above the level, upwards in each half.
      const auto ring = static_cast<std::size_t>(beams.ring_of_laser[static_cast<std::size_t>(laser)]);
      EXPECT_EQ(static_cast<int>(ring), laser / 2 + (laser % 2) * 8);
      const double elevation_rad = DegToRad((static_cast<double>(ring) - 7.5) * step_deg);
      EXPECT_NEAR(beams.elevation_rad[ring], elevation_rad, DegToRad(0.006));
      // Beams cross: what looks down starts above. At one point in the VLP-16, 42 mm from the axis.
      EXPECT_NEAR(beams.origin_height_m[ring], -0.042 * std::tan(elevation_rad), model == Model::kVlp16 ? 0.0001 : 0.0005);
    }
  }
}

TEST(ModelDetector, GoesByTheProductByte) {
  ModelDetector detector(ModelChoice::kAuto);
  EXPECT_EQ(detector.Detect(PacketOf(0x22)), ModelVerdict::kVlp16);
  EXPECT_EQ(detector.Detect(PacketOf(0x24)), ModelVerdict::kPuckHiRes);
  EXPECT_EQ(detector.Detect(PacketOf(0x28)), ModelVerdict::kUnknown);
  EXPECT_EQ(detector.Detect(PacketOf(0x21)), ModelVerdict::kUndecided);
}

TEST(ModelDetector, DecidesNothingByPauses) {
  ModelDetector detector(ModelChoice::kAuto);
  for (std::uint32_t i = 0; i < 10; ++i) EXPECT_EQ(detector.Detect(PacketOf(0x21, 100'000 * i)), ModelVerdict::kUndecided);
}

TEST(ModelDetector, ObeysConfigForTheFamilyAndForUnknownBytes) {
  for (const std::uint8_t product : {0x21, 0x22, 0x24, 0x99}) {
    EXPECT_EQ(ModelDetector(ModelChoice::kVlp16).Detect(PacketOf(product)), ModelVerdict::kVlp16);
    EXPECT_EQ(ModelDetector(ModelChoice::kPuckHiRes).Detect(PacketOf(product)), ModelVerdict::kPuckHiRes);
  }
}

TEST(ModelDetector, TakesNoOtherSensorForAVlp16WhateverConfigSays) {
  EXPECT_EQ(ModelDetector(ModelChoice::kVlp16).Detect(PacketOf(0x28)), ModelVerdict::kUnknown);  // VLP-32C
  ModelDetector detector(ModelChoice::kVlp16);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(detector.Detect(PacketOf(0x21, static_cast<std::uint32_t>(i * 553))), ModelVerdict::kVlp16);
  EXPECT_EQ(detector.Detect(PacketOf(0x21, 3 * 553)), ModelVerdict::kHdl32e);
}

ModelVerdict DetectStream(double interval_us, ReturnMode mode, int skip_every = 0) {
  ModelDetector detector(ModelChoice::kAuto);
  ModelVerdict verdict = ModelVerdict::kUndecided;
  for (int i = 0, sent = 0; sent < 8; ++i) {
    if (skip_every > 0 && i % skip_every == 1) continue;
    // Over the hour on the way.
    const auto stamp_us =
        static_cast<std::uint32_t>((3'599'999'000.0 + i * interval_us) - (3'599'999'000.0 + i * interval_us >= 3.6e9 ? 3.6e9 : 0.0));
    verdict = detector.Detect(PacketOf(0x21, stamp_us, mode));
    ++sent;
    EXPECT_EQ(verdict == ModelVerdict::kUndecided, sent <= 3);
  }
  return verdict;
}

TEST(ModelDetector, TellsTheSharedByteByTheIntervalBetweenPackets) {
  EXPECT_EQ(DetectStream(1327.104, ReturnMode::kStrongest), ModelVerdict::kVlp16);
  EXPECT_EQ(DetectStream(552.96, ReturnMode::kStrongest), ModelVerdict::kHdl32e);
  EXPECT_EQ(DetectStream(663.552, ReturnMode::kDual), ModelVerdict::kVlp16);
  EXPECT_EQ(DetectStream(276.48, ReturnMode::kDual), ModelVerdict::kHdl32e);
}

TEST(ModelDetector, IsNotMisledByALostPacket) { EXPECT_EQ(DetectStream(552.96, ReturnMode::kStrongest, 4), ModelVerdict::kHdl32e); }

TEST(ModelDetector, CanDecideEarlyOnlyWithAnInterval) {
  ModelDetector detector(ModelChoice::kAuto);
  EXPECT_EQ(detector.Decide(), ModelVerdict::kUndecided);
  detector.Detect(PacketOf(0x21, 1000));
  detector.Detect(PacketOf(0x21, 1000));  // the same again is no interval
  EXPECT_EQ(detector.Decide(), ModelVerdict::kUndecided);
  detector.Detect(PacketOf(0x21, 2327));
  EXPECT_EQ(detector.Decide(), ModelVerdict::kVlp16);
}

}  // namespace
}  // namespace lookout::vlp16
