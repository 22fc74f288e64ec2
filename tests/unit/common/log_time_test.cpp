#include "common/core/log_time.hpp"

#include <gtest/gtest.h>

namespace lookout {
namespace {

using namespace std::chrono_literals;

// 2026-08-29T10:00:00.25Z, for 90 s.
const Utime kBegin = std::chrono::sys_days(std::chrono::year(2026) / 8 / 29) + 10h + 250ms;
const LogSpan kLog{kBegin, kBegin + 90s};

std::optional<Utime> Found(std::string_view text, const LogSpan& log = kLog) { return FindTime("--from", text, log).time; }
std::string FaultOf(std::string_view text, const LogSpan& log = kLog) { return FindTime("--from", text, log).fault; }

TEST(LogTime, IsSecondsFromTheStartOrUtcOrMicroseconds) {
  for (const auto* text : {"10", "+10", "10.0", "010", "0:10", "+0:10", "0:00:10", "2026-08-29T10:00:10.25Z", "10:00:10.25Z", "1787997610250000"}) {
    EXPECT_EQ(Found(text), kBegin + 10s) << text << ": " << FaultOf(text);
  }
  EXPECT_EQ(Found("0"), kBegin);
  EXPECT_EQ(Found("1:30"), kBegin + 90s);
  EXPECT_EQ(Found("1:29.5"), kBegin + 89500ms);
  EXPECT_EQ(Found("90"), kBegin + 90s);
  EXPECT_EQ(Found("2026-08-29T10:01Z"), kBegin + 59750ms);
}

// "--from 10" of an export once was 10 microseconds after 1970, and gave the whole table.
TEST(LogTime, IsRefusedWhereItIsUnclear) {
  for (const auto* wrong : {"",
                            "-5",
                            "1e3",
                            "soon",
                            "1.",
                            ".5",
                            "1.1234567",
                            "10s",
                            " 10",
                            "1:60",
                            "1:2:60",
                            "1:61:00",
                            "0:0:0:1",
                            ":10",
                            "1:",
                            "++10",
                            "+2026-08-29T10:00:00Z",
                            "2026-08-29",
                            "2026-08-29T10:00:00",
                            "2026-13-29T10:00:00Z",
                            "2026-02-30T10:00:00Z",
                            "2026-08-29T24:00:00Z",
                            "2026-08-29T10:00:60Z",
                            "2026-08-29T1:00:00Z",
                            "26-08-29T10:00:00Z",
                            "10:00:5Z",
                            "10Z",
                            "Z",
                            "24:00:00Z",
                            "10:00.5Z",
                            "2026-08-29T10:00:00+02:00",
                            "99999999999999999999",
                            "1787997610250",
                            "9999999999999999",
                            "1787997610250000.5"}) {
    EXPECT_FALSE(Found(wrong)) << wrong;
    EXPECT_TRUE(FaultOf(wrong).starts_with("--from " + std::string(wrong) + ": ")) << FaultOf(wrong);
    EXPECT_NE(FaultOf(wrong).find("2026-08-29T10:00:00.250000Z to 2026-08-29T10:01:30.250000Z, 90.000000 s"), std::string::npos) << FaultOf(wrong);
  }
}

TEST(LogTime, IsRefusedOutsideOfTheLog) {
  for (const auto* outside :
       {"92", "1:32", "2:00:00", "2026-08-29T09:59:58Z", "2026-08-28T10:00:10Z", "11:00:00Z", "1787997610", "1788083000000000"}) {
    EXPECT_FALSE(Found(outside)) << outside;
    EXPECT_NE(FaultOf(outside).find("lies outside of the log, which goes from 2026-08-29T10:00:00.250000Z"), std::string::npos) << FaultOf(outside);
  }
  EXPECT_EQ(Found("91"), kBegin + 91s) << "a log is said to be of so many whole seconds";
  EXPECT_EQ(Found("10:00:00Z"), kBegin - 250ms);
}

TEST(LogTime, OfDayIsOnTheDayThatIsInTheLog) {
  const Utime midnight = std::chrono::sys_days(std::chrono::year(2026) / 8 / 30);
  const LogSpan night{midnight - 10min, midnight + 10min};
  EXPECT_EQ(Found("23:55:00Z", night), midnight - 5min);
  EXPECT_EQ(Found("00:05Z", night), midnight + 5min);
  EXPECT_NE(FaultOf("12:00:00Z", night).find("lies outside of the log"), std::string::npos);
  const LogSpan days{midnight - 1h, midnight + 48h};
  EXPECT_FALSE(Found("12:00:00Z", days));
  EXPECT_NE(FaultOf("12:00:00Z", days).find("give the day too, 2026-08-30T12:00:00.000000Z or 2026-08-31T12:00:00.000000Z"), std::string::npos)
      << FaultOf("12:00:00Z", days);
  EXPECT_EQ(Found("23:30:00Z", {midnight - 1h, midnight + 1h}), midnight - 30min);
}

// A host whose clock was set back while it recorded.
TEST(LogTime, OfALogThatEndsBeforeItBeginsMayBeAny) { EXPECT_EQ(Found("10", {kBegin, kBegin - 1h}), kBegin + 10s); }

TEST(LogTime, IsWrittenAsItIsRead) {
  EXPECT_EQ(TimeText(kBegin), "2026-08-29T10:00:00.250000Z");
  EXPECT_EQ(Found(TimeText(kBegin + 1234567us)), kBegin + 1234567us);
  EXPECT_EQ(SecondsText(-1500ms), "-1.500000 s");
  EXPECT_EQ(TimeText(Utime(std::chrono::microseconds(kMinUtimeUs))), "1900-01-01T00:00:00.000000Z");
  EXPECT_EQ(SpanText(kLog), "from 2026-08-29T10:00:00.250000Z to 2026-08-29T10:01:30.250000Z, 90.000000 s");
}

}  // namespace
}  // namespace lookout
