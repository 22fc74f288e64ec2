#include "services/lidar/core/vlp16/position_packet.hpp"

#include <gtest/gtest.h>

#include "tests/unit/lidar/packet_maker.hpp"

namespace lookout::vlp16 {

using namespace lidar;
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
  ASSERT_TRUE(result.packet.time);
  EXPECT_EQ(result.packet.time->time_of_day, std::chrono::seconds(8 * 3600 + 18 * 60 + 2));
  EXPECT_EQ(result.packet.time->date, std::chrono::sys_days(std::chrono::year(2016) / 1 / 21));
}

TEST(PositionPacket, MayHoldNoSentence) {
  const auto result = ParsePositionPacket(MakePositionPacket(0, format::kPpsAbsent, "", ""));
  ASSERT_EQ(result.fault, PositionFault::kNone);
  EXPECT_TRUE(result.packet.sentence.empty());
  EXPECT_FALSE(result.packet.time);
  EXPECT_FALSE(result.packet.telemetry);
}

TEST(PositionPacket, IsRefusedForAnyOtherSize) {
  const auto payload = MakePositionPacket(0, 0, "");
  EXPECT_EQ(ParsePositionPacket(Bytes(payload).first(511)).fault, PositionFault::kSize);
  EXPECT_EQ(ParsePositionPacket({}).fault, PositionFault::kSize);
}

TEST(PositionPacket, MayHaveAnyStamp) { EXPECT_EQ(ParsePositionPacket(MakePositionPacket(4'294'967'295U, 0, "")).packet.stamp_us, 4'294'967'295U); }

TEST(PositionPacket, IsRefusedForAnUnknownPpsState) { EXPECT_EQ(ParsePositionPacket(MakePositionPacket(0, 4, "")).fault, PositionFault::kPps); }

TEST(PositionPacket, LosesOnlyItsSentenceWhenThatIsNotText) {
  for (const auto sentence : {"$GPRMC,\x01,A"sv, "$GPRMC,\xC3\xA4"sv, "GPRMC,1"sv, "$GP\tRMC"sv, "\x7F"sv}) {
    const auto result = ParsePositionPacket(MakePositionPacket(5, 2, sentence));
    EXPECT_EQ(result.fault, PositionFault::kSentence) << sentence;
    EXPECT_EQ(result.packet.pps, 2);
    EXPECT_EQ(result.packet.stamp_us, 5U);
    EXPECT_TRUE(result.packet.sentence.empty());
  }
}

// With a tab the packet lost its sentence, with a space the navigator refused it.
TEST(PositionPacket, HasItsSentenceWithoutBlanksBehind) {
  for (const auto end : {" \r\n"sv, "\t\n"sv, " \t \0"sv}) {
    const auto result = ParsePositionPacket(MakePositionPacket(0, 0, kValidRmc, end));
    EXPECT_EQ(result.fault, PositionFault::kNone);
    EXPECT_EQ(result.packet.sentence, kValidRmc);
    EXPECT_TRUE(result.packet.time);
  }
}

TEST(PositionPacket, LosesASentenceThatHasNoEnd) {
  const std::string endless = "$" + std::string(format::kPositionPacketSizeBytes - format::kSentenceOffset - 1, 'A');
  const auto result = ParsePositionPacket(MakePositionPacket(0, 0, endless, ""));
  EXPECT_EQ(result.fault, PositionFault::kSentence);
  EXPECT_TRUE(result.packet.sentence.empty());
}

TEST(PositionPacket, TellsTemperaturesWhereTheFirmwareDoes) {
  auto payload = MakePositionPacket(0, 0, "");
  payload[187] = 45;
  payload[188] = 200;  // not signed
  payload[203] = 1;
  payload[204] = 91;
  payload[205] = 21;
  const auto result = ParsePositionPacket(payload);
  ASSERT_TRUE(result.packet.telemetry);
  EXPECT_EQ(*result.packet.telemetry, (Telemetry{45, 200, true, 91, 21}));
}

TEST(TimeOfSentence, IsThatOfAnRmcOfStatusAWithARightChecksum) {
  const auto is_valid = [](std::string_view sentence) { return TimeOfSentence(sentence).has_value(); };
  EXPECT_TRUE(is_valid(kValidRmc));
  EXPECT_TRUE(is_valid("$GNRMC,081802,A,"));  // older receivers send no checksum
  EXPECT_FALSE(is_valid("$GPRMC,081802.00,V,,,,,,,210116,,,N*7B"));
  EXPECT_FALSE(is_valid("$GPRMC,081802.00,A,3649.7478558,N,00224.4542928,W,0.034,212.5,210116,0.0,E,A*2F"));
  EXPECT_FALSE(is_valid("$GPRMC,081802,A,*"));
  EXPECT_FALSE(is_valid("$GPRMC,081802"));
  EXPECT_FALSE(is_valid("$GPRMC,246000,A,"));
  EXPECT_FALSE(is_valid("$GPRMC,0818x2,A,"));
  EXPECT_FALSE(is_valid("$GPRMC,08180,A,"));
  EXPECT_FALSE(is_valid("$GPRMC,081802.x,A,"));
  EXPECT_FALSE(is_valid("$GPRMC,,A,"));
  EXPECT_FALSE(is_valid("$GPVTG,1,2,3,4,5,6,7"));
  EXPECT_FALSE(is_valid("$"));
  EXPECT_FALSE(is_valid(""));
}

TEST(TimeOfSentence, MayBeThatOfAGgaWithAFix) {
  const auto time = TimeOfSentence("$GPGGA,235959.25,4338.00,N,07209.00,W,4,12,0.8,200.0,M,-30.0,M,,");
  ASSERT_TRUE(time);
  EXPECT_EQ(time->time_of_day, std::chrono::microseconds(86'399'250'000));
  EXPECT_FALSE(time->date);
  EXPECT_FALSE(TimeOfSentence("$GPGGA,235959.25,4338.00,N,07209.00,W,0,00,,,M,,M,,"));
  EXPECT_FALSE(TimeOfSentence("$GPGGA,235959.25,,,,,,00,,,M,,M,,"));
}

TEST(TimeOfSentence, KnowsLeapSecondsFractionsAndCenturies) {
  EXPECT_EQ(TimeOfSentence("$GPRMC,235960,A,,,,,,,311216")->time_of_day, std::chrono::seconds(86'400));
  EXPECT_FALSE(TimeOfSentence("$GPRMC,120060,A,,,,,,,311216")) << "a leap second comes at the end of a day";
  EXPECT_EQ(TimeOfSentence("$GPRMC,000000.1234567,A,,,,,,,010100")->time_of_day, std::chrono::microseconds(123'456));
  using std::chrono::year;
  EXPECT_EQ(TimeOfSentence("$GPRMC,000000,A,,,,,,,010100")->date, std::chrono::sys_days(year(2000) / 1 / 1));
  EXPECT_EQ(TimeOfSentence("$GPRMC,000000,A,,,,,,,060180")->date, std::chrono::sys_days(year(1980) / 1 / 6));
  EXPECT_EQ(TimeOfSentence("$GPRMC,000000,A,,,,,,,290224")->date, std::chrono::sys_days(year(2024) / 2 / 29));
  EXPECT_FALSE(TimeOfSentence("$GPRMC,000000,A,,,,,,,290223")->date);
  EXPECT_FALSE(TimeOfSentence("$GPRMC,000000,A,,,,,,,000000")->date);
}

}  // namespace
}  // namespace lookout::vlp16
