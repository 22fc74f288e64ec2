// Times in lists and names of files.
#include "tools/import/stamps.hpp"

#include <gtest/gtest.h>
#include <string>

namespace lookout::importer {
namespace {

constexpr std::int64_t kNs = 1'000'000'000;

std::int64_t NsOf(const std::string& text) {
  const auto stamp = ParseStamp(text);
  return stamp ? stamp->time_ns : -1;
}

TEST(Stamps, AreReadToTheNanosecondInEachForm) {
  EXPECT_EQ(NsOf("2011-09-26 13:02:25.964389445"), 1'317'042'145 * kNs + 964'389'445);
  EXPECT_EQ(NsOf("2011-09-26T13:02:25Z"), 1'317'042'145 * kNs);
  EXPECT_EQ(NsOf("2011-09-26_13-02-25.5"), 1'317'042'145 * kNs + 500'000'000);
  EXPECT_EQ(NsOf("1621234567.123456789"), 1'621'234'567 * kNs + 123'456'789);
  EXPECT_EQ(NsOf("1621234567123456789"), 1'621'234'567 * kNs + 123'456'789);
  EXPECT_EQ(NsOf("1621234567123456"), 1'621'234'567 * kNs + 123'456'000);
  EXPECT_EQ(NsOf("1621234567123"), 1'621'234'567 * kNs + 123'000'000);
  EXPECT_EQ(NsOf(" 1621234567\r"), 1'621'234'567 * kNs);
  EXPECT_EQ(NsOf("1.037360e-01"), 103'736'000);
  EXPECT_EQ(NsOf("0.000000e+00"), 0);
  EXPECT_TRUE(ParseStamp("2011-09-26 13:02:25")->is_zoneless);
  EXPECT_FALSE(ParseStamp("2011-09-26 13:02:25Z")->is_zoneless);
  EXPECT_TRUE(ParseStamp("1621234567")->is_dated);
  EXPECT_FALSE(ParseStamp("12.5")->is_dated);
}

TEST(Stamps, OfOtherWordsAreNone) {
  for (const std::string text :
       {"", " ", "nan", "inf", "-1", "-0.5", "1e999", "1.5x", "99999999999999999999", "9223372036854775807", "2011-13-26 13:02:25",
        "2011-02-30 13:02:25", "2011-09-26 25:02:25", "1066-09-26 13:02:25", "2011-09-26 13:02:25.", "2011-09-26", "word", "1.2.3"}) {
    EXPECT_EQ(NsOf(text), -1) << text;
  }
}

TEST(Stamps, StandInNamesWhereTheyAreDated) {
  const auto of = [](const std::string& stem) {
    const auto stamp = StampOfName(stem);
    return stamp ? stamp->time_ns : -1;
  };
  EXPECT_EQ(of("1621234567.25"), 1'621'234'567 * kNs + 250'000'000);
  EXPECT_EQ(of("cloud_1621234567250000000"), 1'621'234'567 * kNs + 250'000'000);
  EXPECT_EQ(of("scan-1621234567-000000250"), 1'621'234'567 * kNs + 250);
  EXPECT_EQ(of("1621234567_123456789"), 1'621'234'567 * kNs + 123'456'789);
  EXPECT_EQ(of("000123"), -1);  // a number of a frame
  EXPECT_EQ(of("frame_000123"), -1);
  EXPECT_EQ(of("frame_1_123456789"), -1);
}

TEST(TimeList, GoesByPlaceByNumberOrByName) {
  const TimeList by_place("1.0\n2.0\n3.0\n");
  EXPECT_EQ(by_place.Of("b", 1, 3)->time_ns, 2 * kNs);
  EXPECT_FALSE(by_place.Of("b", 1, 2));  // of another number of files, with names that are none
  // As KITTI has it where scans are missing.
  EXPECT_EQ(by_place.Of("0000000002", 1, 2)->time_ns, 3 * kNs);
  EXPECT_FALSE(by_place.Of("0000000003", 1, 2));
  const TimeList with_hole("1.0\n\n3.0\n\n");
  EXPECT_EQ(with_hole.size(), 3U);
  EXPECT_FALSE(with_hole.Of("1", 1, 9));
  const TimeList by_name("file,time\na.pcd,1621234567.5\n velodyne/b.bin 2011-09-26 13:02:25\n1621234569.5 c.pcd\n");
  EXPECT_EQ(by_name.Of("a", 7, 9)->time_ns, 1'621'234'567 * kNs + 500'000'000);
  EXPECT_EQ(by_name.Of("b", 7, 9)->time_ns, 1'317'042'145 * kNs);
  EXPECT_EQ(by_name.Of("c", 7, 9)->time_ns, 1'621'234'569 * kNs + 500'000'000);
  EXPECT_EQ(TimeList("1\nword\n# note\n3\n").num_bad(), 1U);
}

}  // namespace
}  // namespace lookout::importer
