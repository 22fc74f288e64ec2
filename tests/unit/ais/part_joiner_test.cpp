// From sentences to messages: parts, channels, time-outs, bad armour.
#include "services/ais/core/part_joiner.hpp"

#include <gtest/gtest.h>

#include "tests/support/counters.hpp"
#include "tests/unit/ais/encoder.hpp"

namespace lookout::ais {
namespace {

using support::CountOf;
using namespace std::chrono_literals;

constexpr Utime kBegin{1'800'000'000s};

std::vector<std::string> Big(std::uint32_t mmsi, int sequence, char channel = 'A') {
  return test::Lines(test::StaticA(mmsi, "NAME", "CALL", 70, {10, 10, 2, 2}), "AIVDM", sequence, channel);
}

TEST(AisParts, OneSentenceIsAMessage) {
  PartJoiner joiner;
  const auto whole = joiner.Add(kBegin, "udp", test::Lines(test::ClassB(211000001, {}))[0]);
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->payload.num_bits(), 168U);
  EXPECT_FALSE(whole->is_own);
  EXPECT_TRUE(joiner.Add(kBegin, "udp", test::Lines(test::ClassB(211000001, {}), "AIVDO")[0])->is_own);
  EXPECT_TRUE(joiner.Add(kBegin, "udp", test::Lines(test::ClassB(211000001, {}), "BSVDM")[0]));
}

TEST(AisParts, OtherSentencesAreNotCounted) {
  PartJoiner joiner;
  for (const char* line : {"$GPRMC,1*00", "!", "!AIVDM", "!AIABM,1*00", "", "!AITXT,01,01,70,x*00"}) EXPECT_FALSE(joiner.Add(kBegin, "udp", line));
  EXPECT_EQ(CountOf(joiner, "ais_sentences"), 0);
}

TEST(AisParts, PartsOfTwoMessagesMayInterleaveByNumberChannelAndSource) {
  PartJoiner joiner;
  const auto one = Big(1, 1);
  const auto two = Big(2, 2);
  const auto three = Big(3, 1, 'B');
  const auto four = Big(4, 1);
  ASSERT_EQ(one.size(), 2U);
  EXPECT_FALSE(joiner.Add(kBegin, "udp", one[0]));
  EXPECT_FALSE(joiner.Add(kBegin, "udp", two[0]));
  EXPECT_FALSE(joiner.Add(kBegin, "udp", three[0]));
  EXPECT_FALSE(joiner.Add(kBegin, "ais", four[0]));
  EXPECT_EQ(joiner.num_open(), 4U);
  EXPECT_EQ(joiner.Add(kBegin, "ais", four[1])->payload.Unsigned(8, 30), 4U);
  EXPECT_EQ(joiner.Add(kBegin, "udp", two[1])->payload.Unsigned(8, 30), 2U);
  EXPECT_EQ(joiner.Add(kBegin, "udp", three[1])->payload.Unsigned(8, 30), 3U);
  const auto whole = joiner.Add(kBegin, "udp", one[1]);
  EXPECT_EQ(whole->payload.Unsigned(8, 30), 1U);
  EXPECT_EQ(whole->payload.num_bits(), 424U);
  EXPECT_EQ(joiner.num_open(), 0U);
}

TEST(AisParts, PartsOutOfOrderAreRefusedAndCounted) {
  PartJoiner joiner;
  const auto lines = Big(1, 1);
  EXPECT_FALSE(joiner.Add(kBegin, "udp", lines[1]));
  EXPECT_EQ(CountOf(joiner, "ais_parts_out_of_order"), 1);
  EXPECT_FALSE(joiner.Add(kBegin, "udp", lines[0]));
  EXPECT_FALSE(joiner.Add(kBegin, "udp", lines[0]));  // began anew
  EXPECT_EQ(CountOf(joiner, "ais_parts_out_of_order"), 2);
  EXPECT_TRUE(joiner.Add(kBegin, "udp", lines[1]));
  // Another number of parts than the first said.
  EXPECT_FALSE(joiner.Add(kBegin, "udp", lines[0]));
  EXPECT_FALSE(joiner.Add(kBegin, "udp", test::Sentence("AIVDM,3,2,1,A,88888888880,2")));
  EXPECT_FALSE(joiner.Add(kBegin, "udp", lines[1]));
  EXPECT_EQ(CountOf(joiner, "ais_parts_out_of_order"), 4);
}

// Two receivers broadcast to one UDP port: the head of one took the tail of the other, and a ship had the size of another.
TEST(AisParts, PartsOfTwoReceiversUnderOneNumberAreNotMixed) {
  const auto one = Big(1, 4);
  const auto two = Big(2, 4);
  for (const auto& order : {std::vector{one[0], two[0], one[1], two[1]}, std::vector{one[0], two[0], two[1], one[1]},
                            std::vector{one[0], two[0], one[0], two[1], one[1]}}) {
    PartJoiner joiner;
    auto time = kBegin;
    for (const auto& line : order) EXPECT_FALSE(joiner.Add(time += 5ms, "udp", line));
    EXPECT_EQ(CountOf(joiner, "ais_parts_mixed"), static_cast<std::int64_t>(order.size()) - 1);
    // The next message under that number comes whole.
    EXPECT_FALSE(joiner.Add(time += 400ms, "udp", one[0]));
    EXPECT_EQ(joiner.Add(time += 5ms, "udp", one[1])->payload.Unsigned(8, 30), 1U);
  }
  // One transmission that both heard.
  PartJoiner joiner;
  EXPECT_FALSE(joiner.Add(kBegin, "udp", one[0]));
  EXPECT_FALSE(joiner.Add(kBegin + 1ms, "udp", one[0]));
  EXPECT_EQ(joiner.Add(kBegin + 2ms, "udp", one[1])->payload.Unsigned(8, 30), 1U);
}

TEST(AisParts, APartThatComesTooLateEndsTheWait) {
  PartJoiner joiner;
  const auto lines = Big(1, 1);
  joiner.Add(kBegin, "udp", lines[0]);
  EXPECT_FALSE(joiner.Add(kBegin + 3001ms, "udp", lines[1]));
  EXPECT_EQ(CountOf(joiner, "ais_parts_timed_out"), 1);
  joiner.Add(kBegin + 4s, "udp", lines[0]);
  EXPECT_TRUE(joiner.Add(kBegin + 7s, "udp", lines[1]));
}

TEST(AisParts, ManyOpenMessagesTakeBoundedMemory) {
  PartJoiner joiner;
  for (int i = 0; i < 1000; ++i) {
    EXPECT_FALSE(joiner.Add(kBegin + std::chrono::milliseconds(i), "source " + std::to_string(i), Big(1, i % 10)[0]));
    EXPECT_LE(joiner.num_open(), PartJoiner::kMostOpen);
  }
  EXPECT_EQ(CountOf(joiner, "ais_parts_dropped"), 1000 - static_cast<std::int64_t>(PartJoiner::kMostOpen));
  EXPECT_TRUE(joiner.Add(kBegin + 1s, "source 999", Big(1, 9)[1]));
}

TEST(AisParts, WrongSentencesAreCounted) {
  PartJoiner joiner;
  EXPECT_FALSE(joiner.Add(kBegin, "udp", "!AIVDM,1,1,,A,1,0*00"));
  EXPECT_FALSE(joiner.Add(kBegin, "udp", "!AIVDM,1,1,,A,1,0"));
  EXPECT_EQ(CountOf(joiner, "ais_bad_checksum"), 2);
  const char* const bad_fields[] = {"AIVDM,0,1,,A,1,0", "AIVDM,1,2,,A,1,0",  "AIVDM,10,1,1,A,1,0", "AIVDM,2,0,1,A,1,0",
                                    "AIVDM,2,1,,A,1,0", "AIVDM,1,1,,A,,0",   "AIVDM,1,1,,A,1,6",   "AIVDM,1,1,,A",
                                    "AIVDM,x,1,,A,1,0", "AIVDM,1,1,,AB,1,0", "AIVDM,-1,1,,A,1,0"};
  for (const char* body : bad_fields) EXPECT_FALSE(joiner.Add(kBegin, "udp", test::Sentence(body))) << body;
  EXPECT_EQ(CountOf(joiner, "ais_bad_field"), static_cast<std::int64_t>(std::size(bad_fields)));
  for (const char* body : {"AIVDM,1,1,,A,1X1,0", "AIVDM,1,1,,A,1~1,0", "AIVDM,1,1,,A,1 1,0", "AIVDM,1,1,,A,1x,0"}) {
    EXPECT_FALSE(joiner.Add(kBegin, "udp", test::Sentence(body))) << body;
  }
  EXPECT_EQ(CountOf(joiner, "ais_bad_armour"), 4);
  // Fill bits in the middle of a message.
  joiner.Add(kBegin, "udp", test::Sentence("AIVDM,2,1,5,A,111,2"));
  EXPECT_FALSE(joiner.Add(kBegin, "udp", test::Sentence("AIVDM,2,2,5,A,111,0")));
  EXPECT_EQ(CountOf(joiner, "ais_bad_armour"), 5);
}

}  // namespace
}  // namespace lookout::ais
