// What a browser may ask for, and what is refused.
#include "services/page/core/request.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <string>

#include "services/page/core/frame.hpp"
#include "services/page/core/replies.hpp"

namespace {

using namespace lookout;
using namespace lookout::page;

std::string FaultOf(const std::string& text) {
  RequestFault fault;
  return ParseRequest(text, fault) ? "" : fault.reason;
}

template <class Kind>
Kind Read(const std::string& text) {
  RequestFault fault;
  const auto request = ParseRequest(text, fault);
  EXPECT_TRUE(request) << text << ": " << fault.reason;
  if (!request || !std::holds_alternative<Kind>(*request)) return {};
  return std::get<Kind>(*request);
}

ChannelIndex IndexOf(std::string_view name) {
  const auto& names = ChannelNames();
  return static_cast<ChannelIndex>(std::find(names.begin(), names.end(), name) - names.begin());
}

TEST(Request, WatchNamesChannelsInAnyOrder) {
  const auto watch = Read<Watch>(R"({"op":"watch","channels":["TRACKS","LIDAR_SCAN"]})");
  EXPECT_EQ(watch.channels, (std::vector<ChannelIndex>{IndexOf("LIDAR_SCAN"), IndexOf("TRACKS")}));
  EXPECT_TRUE(Read<Watch>(R"({"op":"watch","channels":[]})").channels.empty());
}

TEST(Request, GotCountsFrames) { EXPECT_EQ(Read<Got>(R"({"op":"got","frames":12})").num_frames, 12U); }

TEST(Request, AtNamesOneOfTwoTimes) {
  const auto at = Read<At>(R"({"op":"at","id":7,"source":1,"utime_us":5,"channels":["TRACKS"]})");
  EXPECT_EQ(at.id, 7U);
  EXPECT_EQ(at.source, 1);
  EXPECT_EQ(at.time, Utime(std::chrono::microseconds(5)));
  EXPECT_FALSE(at.scan_time);
  const auto scan = Read<At>(R"({"op":"at","id":7,"source":1,"scan_utime_us":6,"channels":["TRACKS"]})");
  EXPECT_EQ(scan.scan_time, Utime(std::chrono::microseconds(6)));
  EXPECT_FALSE(scan.time);
  EXPECT_NE(FaultOf(R"({"op":"at","id":7,"source":1,"utime_us":5,"scan_utime_us":6,"channels":[]})"), "");
  EXPECT_NE(FaultOf(R"({"op":"at","id":7,"source":1,"channels":[]})"), "");
}

TEST(Request, StepGoesBothWays) { EXPECT_EQ(Read<At>(R"({"op":"step","id":1,"source":0,"utime_us":5,"scans":-3,"channels":[]})").num_scans_on, -3); }

TEST(Request, RangeAndStripHaveAnEndAfterTheBegin) {
  const auto range = Read<Range>(R"({"op":"range","id":1,"source":0,"channel":"POSE","from_utime_us":5,"to_utime_us":5,"max_messages":9})");
  EXPECT_EQ(range.channel, IndexOf("POSE"));
  EXPECT_EQ(range.max_messages, 9);
  EXPECT_NE(FaultOf(R"({"op":"range","id":1,"source":0,"channel":"POSE","from_utime_us":5,"to_utime_us":4,"max_messages":9})"), "");
  EXPECT_EQ(Read<StripRequest>(R"({"op":"strip","id":1,"source":0,"from_utime_us":5,"to_utime_us":6,"buckets":4000})").num_buckets, 4000);
  EXPECT_NE(FaultOf(R"({"op":"strip","id":1,"source":0,"from_utime_us":5,"to_utime_us":5,"buckets":4000})"), "");
  EXPECT_NE(FaultOf(R"({"op":"strip","id":1,"source":0,"from_utime_us":5,"to_utime_us":6,"buckets":4001})"), "");
}

TEST(Request, WhatIsNoFlatObjectIsRefused) {
  for (const std::string text : {"",
                                 "{",
                                 "[]",
                                 "null",
                                 "7",
                                 "\"watch\"",
                                 "{}",
                                 R"({"op":7})",
                                 R"({"op":"watch"})",
                                 R"({"op":"watch","channels":"TRACKS"})",
                                 R"({"op":"watch","channels":[["TRACKS"]]})",
                                 R"({"op":"watch","channels":[7]})",
                                 R"({"op":{"op":"watch"},"channels":[]})",
                                 R"({"op":"watch","channels":[],"op":"watch"})",
                                 R"({"op":"watch","channels":[]} x)",
                                 R"({"op":"watch","channels":[],"more":1})",
                                 R"({"op":"watch","channels":["TRACKS","TRACKS"]})",
                                 R"({"op":"watch","channels":["NONE"]})",
                                 R"({"op":"sail"})",
                                 "{\"op\":\"watch\",\"channels\":[\"\xff\"]}"})
    EXPECT_NE(FaultOf(text), "") << text;
  EXPECT_NE(FaultOf(std::string(4000, '[')), "");
  EXPECT_NE(FaultOf(R"({"op":"watch","channels":[)" + std::string(3000, '[')), "");
  EXPECT_NE(FaultOf(R"({"op":"got","frames":1)" + std::string(kMaxRequestBytes, ' ') + "}"), "");
}

TEST(Request, NumbersAreWholeAndWithinBounds) {
  for (const std::string number :
       {"-1", "1.0", "1e3", "NaN", "Infinity", "\"1\"", "true", "null", "18446744073709551616", "9223372036854775808", "01"})
    EXPECT_NE(FaultOf(R"({"op":"got","frames":)" + number + "}"), "") << number;
  for (const std::string id : {"0", "-1", "4294967296"})
    EXPECT_NE(FaultOf(R"({"op":"at","id":)" + id + R"(,"source":0,"utime_us":5,"channels":[]})"), "") << id;
  for (const std::string source : {"-1", "4"})
    EXPECT_NE(FaultOf(R"({"op":"at","id":1,"source":)" + source + R"(,"utime_us":5,"channels":[]})"), "") << source;
  EXPECT_NE(FaultOf(R"({"op":"at","id":1,"source":0,"utime_us":9007199254740993,"channels":[]})"), "");
}

TEST(Request, AFaultNamesTheRequest) {
  RequestFault fault;
  EXPECT_FALSE(ParseRequest(R"({"op":"at","id":31,"source":9,"utime_us":5,"channels":[]})", fault));
  EXPECT_EQ(fault.id, 31U);
  EXPECT_EQ(fault.reason, "source is not a whole number from 0 to 3");
  EXPECT_FALSE(ParseRequest("x", fault));
  EXPECT_EQ(fault.id, 0U);
}

TEST(Acknowledgement, NamesAnAlertOfTheTrackerOrOfItsWatch) {
  const auto read = ParseAcknowledgement(R"({"alert_id":-1,"raised_utime_us":1700000000000000})");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->alert_id, -1);
  EXPECT_EQ(ToUtimeUs(read->raised), 1'700'000'000'000'000);
  for (const std::string text : {"", "{}", R"({"alert_id":0,"raised_utime_us":1})", R"({"alert_id":1})", R"({"alert_id":1.5,"raised_utime_us":1})",
                                 R"({"alert_id":1,"raised_utime_us":1,"x":1})", R"({"alert_id":1,"raised_utime_us":9000000000000000})"})
    EXPECT_FALSE(ParseAcknowledgement(text)) << text;
}

TEST(Order, IsSilenceOrLimitsWithinBounds) {
  const auto silence = ParseOrder(R"({"kind":"silence"})");
  ASSERT_TRUE(silence);
  EXPECT_EQ(silence->kind, Order::Kind::kSilence);
  const auto naming = ParseOrder(R"({"kind":"name","track_id":7,"name":"Kiosk pier"})");
  ASSERT_TRUE(naming);
  EXPECT_EQ(naming->track_id, 7);
  EXPECT_EQ(naming->name, "Kiosk pier");
  const auto settings = ParseOrder(R"({"kind":"settings","mode":"harbour","guard_zone_range_m":7.5,"guard_zone_to_deg":60})");
  ASSERT_TRUE(settings);
  EXPECT_EQ(*settings, (Order{.kind = Order::Kind::kSettings, .mode = Order::Mode::kHarbour, .guard_zone_range_m = 7.5, .guard_zone_to_deg = 60.0}));
  for (const std::string text :
       {"", "{}", R"({"kind":"loud"})", R"({"kind":"silence","mode":"harbour"})", R"({"kind":"settings"})", R"({"kind":"settings","mode":"sea"})",
        R"({"kind":"settings","mode":"harbour","cpa_limit_m":-1})", R"({"kind":"settings","mode":"harbour","cpa_limit_m":"3"})",
        R"({"kind":"settings","mode":"harbour","cpa_limit_m":1e300})", R"({"kind":"settings","mode":"harbour","guard_zone_from_deg":361})",
        R"({"kind":"name","track_id":0,"name":"a"})", R"({"kind":"name","track_id":7})", R"({"kind":"name","track_id":7,"name":" "})",
        R"({"kind":"name","track_id":7,"name":"a\nb"})", R"({"kind":"name","track_id":7,"name":"\u200b"})",
        R"({"kind":"name","track_id":7,"name":"01234567890123456789012345678901234567890"})"})
    EXPECT_FALSE(ParseOrder(text)) << text;
}

TEST(Frame, HasItsHeadInFront) {
  const std::vector<std::uint8_t> message{0xAA, 0xBB};
  const auto frame = ToFrame({2, 0x0103, 0x04050607, Utime(std::chrono::microseconds(-2))}, message);
  EXPECT_EQ(frame, (std::vector<std::uint8_t>{1, 2, 3, 1, 7, 6, 5, 4, 0xFE, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xAA, 0xBB}));
}

TEST(Replies, AreJsonAlsoWhereANameIsNoText) {
  EXPECT_EQ(RefusedText(3, "a \"b\" \xff"), "{\"id\":3,\"reason\":\"a \\\"b\\\" \xEF\xBF\xBD\",\"type\":\"refused\"}");
  EXPECT_EQ(SourcesMessage("[{}]"), R"({"type":"sources","sources":[{}]})");
}

}  // namespace
