// What messages of AIS say, and which are refused.
#include "services/ais/core/message.hpp"

#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "tests/unit/ais/encoder.hpp"

namespace lookout::ais {
namespace {

MessageResult DecodeBits(const test::Bits& bits) {
  const auto payload = ToPayload(bits.Armour(), static_cast<std::size_t>(bits.num_fill()));
  return payload ? Decode(*payload) : MessageResult{MessageFault::kTooShort, {}};
}

const test::Position kSomewhere{.latitude_deg = 54.3217,
                                .longitude_deg = -10.1234,
                                .speed_kn = 7.3,
                                .course_deg = 359.9,
                                .heading_deg = 358,
                                .second = 59,
                                .is_accurate = true,
                                .status = 5,
                                .turn = -20};

TEST(AisMessage, PositionOfClassAHasAllItsValues) {
  for (const int type : {1, 2, 3}) {
    const auto result = DecodeBits(test::ClassA(211234567, kSomewhere, type));
    ASSERT_EQ(result.fault, MessageFault::kNone);
    EXPECT_EQ(result.message.type, type);
    EXPECT_EQ(result.message.mmsi, 211234567);
    EXPECT_EQ(result.message.sender, Sender::kClassA);
    const auto& report = result.message.position.value();
    EXPECT_NEAR(report.latitude_deg, 54.3217, 1e-6);
    EXPECT_NEAR(report.longitude_deg, -10.1234, 1e-6);
    EXPECT_NEAR(report.speed_mps, 7.3 * 1852 / 3600, 1e-9);
    EXPECT_NEAR(report.course_rad, DegToRad(359.9), 1e-9);
    EXPECT_NEAR(report.heading_rad, DegToRad(358), 1e-9);
    EXPECT_EQ(report.second, 59);
    EXPECT_TRUE(report.is_accurate);
    EXPECT_EQ(report.navigational_status, 5);
    EXPECT_NEAR(RadToDeg(report.turn_radps) * 60.0, -17.86, 0.01);
  }
}

TEST(AisMessage, WhatIsNotAvailableIsNotANumber) {
  for (const auto& bits : {test::ClassA(1, {}), test::ClassB(1, {}), test::Base(1, {}), test::Aircraft(1, {}, 4095, 1023)}) {
    const auto result = DecodeBits(bits);
    ASSERT_EQ(result.fault, MessageFault::kNone) << result.message.type;
    const auto& report = result.message.position.value();
    EXPECT_FALSE(report.has_position());
    EXPECT_TRUE(std::isnan(report.speed_mps));
    EXPECT_TRUE(std::isnan(report.course_rad));
    EXPECT_TRUE(std::isnan(report.heading_rad));
    EXPECT_TRUE(std::isnan(report.turn_radps));
    EXPECT_EQ(report.second, kSecondUnknown);
  }
  const auto far = DecodeBits(test::LongRange(1, {}, 63, 511));
  ASSERT_EQ(far.fault, MessageFault::kNone);
  EXPECT_FALSE(far.message.position->has_position());
  EXPECT_TRUE(std::isnan(far.message.position->speed_mps));
  EXPECT_TRUE(std::isnan(far.message.position->course_rad));
}

TEST(AisMessage, NamesEndAtTheFirstAtSignWithoutSpaces) {
  const auto result = DecodeBits(test::StaticA(211234567, "MS EVEREST  @GARBAGE", "DH1234", 70, {10, 20, 3, 4}));
  ASSERT_EQ(result.fault, MessageFault::kNone);
  EXPECT_EQ(result.message.facts.name, "MS EVEREST");
  EXPECT_EQ(result.message.facts.call_sign, "DH1234");
  EXPECT_EQ(result.message.facts.ship_type, 70);
  EXPECT_EQ(result.message.facts.dimensions->length_m(), 30.0);
  EXPECT_EQ(result.message.facts.dimensions->beam_m(), 7.0);
  EXPECT_FALSE(result.message.position);
}

TEST(AisMessage, DimensionsWithoutBowAndPortSayNoPlaceOfTheAntenna) {
  const auto only_size = DecodeBits(test::StaticBHull(211234567, "AB", 37, {0, 12, 0, 4})).message.facts.dimensions.value();
  EXPECT_EQ(only_size.length_m(), 12.0);
  EXPECT_FALSE(only_size.has_reference);
  const auto nothing = DecodeBits(test::StaticBHull(211234567, "AB", 37, {})).message.facts.dimensions.value();
  EXPECT_TRUE(std::isnan(nothing.length_m()));
  // Of a boat that belongs to a ship there stands the MMSI of the ship.
  EXPECT_FALSE(DecodeBits(test::StaticBHull(982112345, "AB", 37, {1, 2, 3, 4})).message.facts.dimensions);
}

TEST(AisMessage, BothPartsOfClassB) {
  const auto extended = DecodeBits(test::ExtendedB(338000001, kSomewhere, "DINGHY", 36, {2, 3, 1, 1}));
  ASSERT_EQ(extended.fault, MessageFault::kNone);
  EXPECT_EQ(extended.message.facts.name, "DINGHY");
  EXPECT_EQ(extended.message.facts.dimensions->length_m(), 5.0);
  EXPECT_NEAR(extended.message.position->latitude_deg, 54.3217, 1e-6);
  EXPECT_EQ(DecodeBits(test::StaticBName(338000001, "DINGHY 2")).message.facts.name, "DINGHY 2");
  EXPECT_EQ(DecodeBits(test::Bits().U(24, 6).U(0, 2).U(1, 30).U(2, 2).Cut(168)).fault, MessageFault::kBadPart);
}

TEST(AisMessage, AidsHaveLongNamesAndMayBeVirtual) {
  const auto result = DecodeBits(test::Aid(992111111, kSomewhere, "FAIRWAY BUOY NUMBER 1234", true, {1, 1, 1, 1}));
  ASSERT_EQ(result.fault, MessageFault::kNone);
  EXPECT_EQ(result.message.facts.name, "FAIRWAY BUOY NUMBER 1234");
  EXPECT_TRUE(result.message.is_virtual);
  EXPECT_EQ(result.message.sender, Sender::kAid);
}

TEST(AisMessage, LongRangePlacesAreCoarse) {
  const auto result = DecodeBits(test::LongRange(211234567, kSomewhere, 12, 270));
  ASSERT_EQ(result.fault, MessageFault::kNone);
  EXPECT_NEAR(result.message.position->latitude_deg, 54.3217, 1.0 / 1200);
  EXPECT_NEAR(result.message.position->longitude_deg, -10.1234, 1.0 / 1200);
  EXPECT_NEAR(result.message.position->speed_mps, 12 * 1852.0 / 3600, 1e-9);
  EXPECT_GT(result.message.position->resolution_m, 100.0);
}

TEST(AisMessage, TruncatedMessagesAreTakenAsFarAsGpsdTakesThem) {
  EXPECT_EQ(DecodeBits(test::ClassA(1, kSomewhere).Cut(163)).fault, MessageFault::kNone);
  EXPECT_EQ(DecodeBits(test::ClassA(1, kSomewhere).Cut(162)).fault, MessageFault::kTooShort);
  EXPECT_EQ(DecodeBits(test::StaticA(1, "A", "B", 1, {}).Cut(420)).fault, MessageFault::kNone);
  EXPECT_EQ(DecodeBits(test::StaticA(1, "A", "B", 1, {}).Cut(419)).fault, MessageFault::kTooShort);
  EXPECT_EQ(DecodeBits(test::ClassB(1, kSomewhere).Cut(167)).fault, MessageFault::kTooShort);
  EXPECT_EQ(DecodeBits(test::StaticBName(1, "A")).fault, MessageFault::kNone);
  EXPECT_EQ(DecodeBits(test::LongRange(1, kSomewhere, 1, 1).Cut(168)).fault, MessageFault::kNone);
  EXPECT_EQ(DecodeBits(test::Bits().U(1, 6)).fault, MessageFault::kTooShort);
  EXPECT_EQ(DecodeBits(test::Bits().Cut(37)).fault, MessageFault::kTooShort);
}

TEST(AisMessage, WhatCannotBeIsRefused) {
  EXPECT_EQ(DecodeBits(test::ClassA(0, kSomewhere)).fault, MessageFault::kBadMmsi);
  EXPECT_EQ(DecodeBits(test::ClassA(1'000'000'000, kSomewhere)).fault, MessageFault::kBadMmsi);
  auto place = kSomewhere;
  place.latitude_deg = 91.5;
  EXPECT_EQ(DecodeBits(test::ClassA(1, place)).fault, MessageFault::kBadPlace);
  place.latitude_deg = -110.0;
  EXPECT_EQ(DecodeBits(test::ClassB(1, place)).fault, MessageFault::kBadPlace);
  place = kSomewhere;
  place.longitude_deg = 200.0;
  EXPECT_EQ(DecodeBits(test::Aid(1, place, "A", false, {})).fault, MessageFault::kBadPlace);
  EXPECT_EQ(DecodeBits(test::Bits().U(6, 6).Cut(200)).fault, MessageFault::kOtherType);
}

}  // namespace
}  // namespace lookout::ais
