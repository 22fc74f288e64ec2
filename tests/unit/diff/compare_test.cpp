#include "tools/diff/compare.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/bus/schema.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "lookout/nav_raw_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/run_info_t.hpp"
#include "lookout/segments_t.hpp"
#include "tests/unit/wire/filled_messages.hpp"

namespace lookout::diff {
namespace {

class Compare : public ::testing::Test {
 protected:
  Tolerances tolerances_;

  std::optional<Difference> Differ(Bytes a, Bytes b) const { return CompareMessages(tolerances_, a, b); }
  template <typename T>
  std::optional<Difference> Differ(const T& a, const T& b) const {
    return Differ(Bytes(bus::Encode(a)), Bytes(bus::Encode(b)));
  }
  // "field: a | b"
  template <typename T>
  std::string Text(const T& a, const T& b) const {
    const auto difference = Differ(a, b);
    return difference ? difference->field + ": " + difference->a + " | " + difference->b : "equal";
  }
};

segments_t TwoSegments() {
  segments_t message{};
  message.segments.resize(2);
  for (auto& segment : message.segments) {
    segment = segment_t{};
    segment.centroid_m[0] = 1.5F;
  }
  message.num_segments = 2;
  return message;
}

TEST_F(Compare, NamesTheFieldByItsPath) {
  const auto a = TwoSegments();
  auto b = a;
  EXPECT_EQ(Text(a, b), "equal");
  b.segments[1].centroid_m[2] = -0.25F;
  EXPECT_EQ(Text(a, b), "segments[1].centroid_m[2]: 0 | -0.25");
  b.segments.resize(1);
  b.num_segments = 1;
  EXPECT_EQ(Text(a, b), "num_segments: 2 | 1");
  b.seq = -7;
  EXPECT_EQ(Text(a, b), "seq: 0 | -7") << "the first";
}

TEST_F(Compare, ShowsEachKindOfValue) {
  pose_t pose{};
  auto other_pose = pose;
  other_pose.covariance[8][3] = 1e-300;
  EXPECT_EQ(Text(pose, other_pose), "covariance[8][3]: 0 | 1e-300");
  other_pose = pose;
  other_pose.has_attitude = 1;
  EXPECT_EQ(Text(pose, other_pose), "has_attitude: 0 | 1");

  nav_raw_t raw{};
  auto other_raw = raw;
  raw.sentence = "$GPRMC\x01";
  other_raw.sentence = std::string(70, 'x');
  EXPECT_EQ(Text(raw, other_raw), "sentence: \"$GPRMC?\" | \"" + std::string(60, 'x') + "...\"");

  lidar_scan_t scan{};
  scan.num_cells = 2;
  scan.range = {-1, 5};
  scan.reflectivity = {200, 7};
  auto other_scan = scan;
  other_scan.reflectivity[0] = 201;
  EXPECT_EQ(Text(scan, other_scan), "reflectivity[0]: 200 | 201");
  other_scan.range[0] = 1;
  EXPECT_EQ(Text(scan, other_scan), "range[0]: -1 | 1");

  run_info_t info{};
  info.num_files = 1;
  info.file_name = {"a"};
  info.file_text = {""};
  auto other_info = info;
  other_info.file_text = {"b"};
  EXPECT_EQ(Text(info, other_info), "file_text[0]: \"\" | \"b\"");
}

TEST_F(Compare, WithoutToleranceIsBitForBit) {
  pose_t a{};
  auto b = a;
  a.heading_rad = 0.0;
  b.heading_rad = -0.0;
  EXPECT_EQ(Text(a, b), "heading_rad: 0 | -0");
  a.heading_rad = std::numeric_limits<double>::quiet_NaN();
  b.heading_rad = a.heading_rad;
  EXPECT_EQ(Text(a, b), "equal");
  b.heading_rad = std::nan("7");
  EXPECT_EQ(Text(a, b), "heading_rad: nan (0x7ff8000000000000) | nan (0x7ff8000000000007)");
}

// LCM ends a string that it encodes at its first zero: such a message cannot be encoded again.
TEST_F(Compare, AStringWithAZeroInsideIsComparedByteByByte) {
  nav_raw_t raw{};
  raw.sentence = "$GPHDT,1.0,T";
  const auto original = bus::Encode(raw);
  auto spoiled = original;
  spoiled[spoiled.size() - 4 - 1 - 5] = 0;  // behind the sentence stand its closing zero and num_imu
  ASSERT_TRUE(bus::Decode<nav_raw_t>(spoiled));
  const auto difference = Differ(Bytes(original), Bytes(spoiled));
  ASSERT_TRUE(difference);
  EXPECT_TRUE(difference->field.starts_with("byte ")) << difference->field;
  EXPECT_EQ(difference->b, "0x00");
}

TEST_F(Compare, AToleranceHoldsForItsFieldAlone) {
  auto a = TwoSegments();
  auto b = a;
  b.segments[1].centroid_m[0] = 1.51F;
  tolerances_.Set("centroid_m", 0.005);
  EXPECT_EQ(Text(a, b), "segments[1].centroid_m[0]: 1.5 | 1.51");
  tolerances_.Set("segments.centroid_m", 0.02);  // the longer name wins
  EXPECT_EQ(Text(a, b), "equal");
  b.segments[1].centroid_m[1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(Text(a, b), "segments[1].centroid_m[1]: 0 | nan");
  a.segments[1].centroid_m[1] = std::nanf("3");
  EXPECT_EQ(Text(a, b), "equal") << "both are not known";
  b.segments[0].num_points = 3;
  EXPECT_EQ(Text(a, b), "segments[0].num_points: 0 | 3");
  tolerances_.Set("num_points", 3);
  EXPECT_EQ(Text(a, b), "equal");
  tolerances_.Set("oid_m", 100);
  b.segments[0].centroid_m[0] = 9;
  EXPECT_NE(Text(a, b), "equal") << "part of a name is no name";
}

TEST_F(Compare, ACountOfAnArrayHasNoTolerance) {
  const auto a = TwoSegments();
  auto b = a;
  b.segments.resize(1);
  b.num_segments = 1;
  tolerances_.Set("num_segments", 5);
  EXPECT_EQ(Text(a, b), "num_segments: 2 | 1");
}

TEST_F(Compare, IntegersAtTheirEndsDoNotOverflow) {
  pose_t a{};
  pose_t b{};
  a.utime_us = std::numeric_limits<std::int64_t>::min();
  b.utime_us = std::numeric_limits<std::int64_t>::max();
  tolerances_.Set("utime_us", 1000);
  EXPECT_EQ(Text(a, b), "utime_us: -9223372036854775808 | 9223372036854775807");
}

TEST_F(Compare, KnowsNamesThatFitNothing) {
  tolerances_.Set("centroid_m", 1);
  tolerances_.Set("segments.centroid_m", 1);
  tolerances_.Set("segments.nowhere_m", 1);
  tolerances_.Set("num_segments", 1);  // a count of an array
  tolerances_.Set("sentence", 1);      // no number
  EXPECT_EQ(tolerances_.Unknown(), (std::vector<std::string>{"num_segments", "segments.nowhere_m", "sentence"}));
}

TEST_F(Compare, OfTwoTypesNamesBoth) {
  const auto difference = Differ(Bytes(bus::Encode(pose_t{})), Bytes(bus::Encode(segments_t{})));
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->field, "type");
  EXPECT_EQ(difference->a, "pose_t (0xca8b57b621cb2643)");
  EXPECT_EQ(difference->b, "segments_t (0xd04dd7c76291c9dc)");
}

TEST_F(Compare, WhatIsNoMessageIsComparedByteByByte) {
  const std::vector<std::uint8_t> unknown{1, 2, 3, 4, 5, 6, 7, 8, 9};
  auto other = unknown;
  EXPECT_FALSE(Differ(Bytes(unknown), Bytes(other)));
  other[8] = 10;
  EXPECT_EQ(Differ(Bytes(unknown), Bytes(other))->field, "byte 8");
  EXPECT_EQ(Differ(Bytes(unknown), Bytes(other))->b, "0x0a");
  other = unknown;
  other.push_back(0);
  EXPECT_EQ(Differ(Bytes(unknown), Bytes(other))->field, "size");
  EXPECT_EQ(Differ(Bytes(unknown), Bytes())->field, "size");

  auto torn = bus::Encode(pose_t{});
  const auto whole = torn;
  torn.resize(100);
  EXPECT_EQ(Differ(Bytes(whole), Bytes(torn))->field, "size");
  auto longer = whole;
  longer.push_back(0);
  EXPECT_EQ(Differ(Bytes(whole), Bytes(longer))->field, "size");
}

// The fields are those of lcmtypes/*.lcm: what differs in any byte of any type is named by its field, unless the bytes are no message any more.
TEST_F(Compare, NamesAFieldForEachByteOfEachType) {
  int num_named = 0;
  ForEachFilledMessage([&]<typename T>(const T& message) {
    const auto original = bus::Encode(message);
    for (std::size_t place = 8; place < original.size(); ++place) {
      auto other = original;
      other[place] ^= 1;
      const auto difference = Differ(Bytes(original), Bytes(other));
      ASSERT_TRUE(difference) << T::getTypeName() << " byte " << place;
      const auto decoded = bus::Decode<T>(other);
      const bool is_message = decoded && bus::Encode(*decoded) == other;
      EXPECT_EQ(difference->field.starts_with("byte ") || difference->field == "size", !is_message) << T::getTypeName() << " byte " << place;
      num_named += is_message ? 1 : 0;
    }
  });
  EXPECT_GT(num_named, 2000);
}

// Nobody reads the closing zero of a string: it used to make messages equal whose bytes are not.
TEST_F(Compare, AStringThatIsNotClosedIsADifference) {
  const auto a = bus::Encode(nav_raw_t{});
  auto b = a;
  b[8 + 8 + 8 + 4 + 4] = 1;  // of `source`, behind utime_us, seq, kind and its length
  EXPECT_EQ(Differ(Bytes(a), Bytes(b))->field, "byte 32");
}

// Counts of -1 and 2^31 - 1, strings without end, cuts anywhere: an answer, in no time, with no more memory than there are bytes.
TEST_F(Compare, HostileMessagesGetAnAnswer) {
  std::mt19937 random(1);
  const auto original = bus::Encode(TwoSegments());
  for (int round = 0; round < 20'000; ++round) {
    auto a = original;
    auto b = original;
    for (auto* message : {&a, &b}) {
      const auto place = 8 + random() % (message->size() - 8);
      const std::uint8_t value = round % 3 == 0 ? 0xFF : static_cast<std::uint8_t>(random());
      for (std::size_t i = place; i < std::min(place + round % 5, message->size()); ++i) (*message)[i] = value;
      if (round % 7 == 0) message->resize(random() % message->size());
    }
    EXPECT_EQ(Differ(Bytes(a), Bytes(b)).has_value(), a != b);
  }
}

}  // namespace
}  // namespace lookout::diff
