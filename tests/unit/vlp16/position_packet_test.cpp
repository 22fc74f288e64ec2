#include "services/vlp16/core/position_packet.hpp"

#include <gtest/gtest.h>

#include "tests/unit/vlp16/packet_maker.hpp"

namespace lookout::vlp16 {
namespace {

using test::kValidRmc;
using test::MakePositionPacket;
using namespace std::string_view_literals;

TEST(PositionPacket, IsReadWithStampPpsAndSentence) {
  const auto result = ParsePositionPacket(MakePositionPacket(1'082'342'001U, format::kPpsLocked, kValidRmc));
  ASSERT_EQ(result.fault, PositionFault::kNone);
  EXPECT_EQ(result.packet.stamp_us, 1'082'342'001U);
  EXPECT_EQ(result.packet.pps, 2);
  EXPECT_EQ(result.packet.sentence, kValidRmc);
  EXPECT_TRUE(result.packet.has_valid_rmc);
}

TEST(PositionPacket, MayHoldNoSentence) {
  const auto result = ParsePositionPacket(MakePositionPacket(0, format::kPpsAbsent, "", ""));
  ASSERT_EQ(result.fault, PositionFault::kNone);
  EXPECT_TRUE(result.packet.sentence.empty());
  EXPECT_FALSE(result.packet.has_valid_rmc);
}

TEST(PositionPacket, IsRefusedForAnyOtherSize) {
  const auto payload = MakePositionPacket(0, 0, "");
  EXPECT_EQ(ParsePositionPacket(Bytes(payload).first(511)).fault, PositionFault::kSize);
  EXPECT_EQ(ParsePositionPacket({}).fault, PositionFault::kSize);
}

TEST(PositionPacket, IsRefusedForAStampBeyondTheHour) {
  EXPECT_EQ(ParsePositionPacket(MakePositionPacket(4'294'967'295U, 0, "")).fault, PositionFault::kStamp);
}

TEST(PositionPacket, IsRefusedForAnUnknownPpsState) { EXPECT_EQ(ParsePositionPacket(MakePositionPacket(0, 4, "")).fault, PositionFault::kPps); }

TEST(PositionPacket, IsRefusedWhenTheSentenceIsNotText) {
  for (const auto sentence : {"$GPRMC,\x01,A"sv, "$GPRMC,\xC3\xA4"sv, "GPRMC,1"sv, "$GP\tRMC"sv, "\x7F"sv}) {
    EXPECT_EQ(ParsePositionPacket(MakePositionPacket(0, 0, sentence)).fault, PositionFault::kSentence) << sentence;
  }
}

TEST(PositionPacket, IsRefusedWhenTheSentenceHasNoEnd) {
  const std::string endless = "$" + std::string(format::kPositionPacketSizeBytes - format::kSentenceOffset - 1, 'A');
  EXPECT_EQ(ParsePositionPacket(MakePositionPacket(0, 0, endless, "")).fault, PositionFault::kSentence);
}

TEST(Rmc, IsValidWithStatusAAndARightChecksum) {
  EXPECT_TRUE(IsValidRmc(kValidRmc));
  EXPECT_TRUE(IsValidRmc("$GNRMC,081802,A,"));  // older receivers send no checksum
  EXPECT_FALSE(IsValidRmc("$GPRMC,081802.00,V,,,,,,,210116,,,N*7B"));
  EXPECT_FALSE(IsValidRmc("$GPRMC,081802.00,A,3649.7478558,N,00224.4542928,W,0.034,212.5,210116,0.0,E,A*2F"));
  EXPECT_FALSE(IsValidRmc("$GPRMC,081802,A,*"));
  EXPECT_FALSE(IsValidRmc("$GPGGA,081802,A,"));
  EXPECT_FALSE(IsValidRmc("$GPRMC,081802"));
  EXPECT_FALSE(IsValidRmc(""));
}

}  // namespace
}  // namespace lookout::vlp16
