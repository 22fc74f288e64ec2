// Rows of recordings as CSV, in the forms that OpenCPN's recorder writes and its specification allows.
#include "services/navigator/core/csv_recording.hpp"

#include <gtest/gtest.h>

namespace lookout::navigator {
namespace {

using namespace std::chrono_literals;

constexpr Utime kRowTime = std::chrono::sys_days(std::chrono::year(2026) / 8 / 29) + 10h;
const std::string kHeadingLine = "$HEHDT,90.0,T*16";

TEST(IsoTime, IsUtcInAllItsForms) {
  for (const char* text : {"2026-08-29T10:00:00.5Z", "2026-08-29T10:00:00.500Z", "2026-08-29 10:00:00.500", "2026-08-29T12:00:00.5+02:00",
                           "2026-08-29T12:00:00.500000+0200", "2026-08-29T04:30:00,5-05:30", " 2026-08-29T10:00:00.500000999z "}) {
    EXPECT_EQ(ParseIsoTime(text), kRowTime + 500ms) << text;
  }
  EXPECT_EQ(ParseIsoTime("2026-08-29T12:00:00+02"), kRowTime);
  for (const char* text :
       {"", "2026-08-29", "2026-08-29T10:00", "29.08.2026 10:00:00", "2026-02-30T10:00:00Z", "2026-08-29T24:00:00Z", "2026-08-29T10:60:00Z",
        "2026-08-29T10:00:00.500ZZ", "2026-08-29T10:00:00+2", "2026-08-29T10:00:00+99:00", "1776-07-04T10:00:00Z", "2026-08-29T10:00:0xZ"}) {
    EXPECT_FALSE(ParseIsoTime(text)) << text;
  }
}

TEST(CsvColumns, AreNamedByTheHead) {
  const auto columns = FindCsvColumns("timestamp,protocol,msg_type,source,raw_data");
  ASSERT_TRUE(columns);
  EXPECT_EQ(columns->time, 0U);
  EXPECT_EQ(columns->message, 4U);
  EXPECT_EQ(FindCsvColumns("\"id\", \"Message\" ,Timestamp")->time, 2U);
  EXPECT_EQ(FindCsvColumns("\"id\", \"Message\" ,Timestamp")->message, 1U);
  EXPECT_EQ(FindCsvColumns("source_timestamp,timestamp,type,id,message")->time, 1U);
  for (const std::string& line : {std::string(), std::string("# timestamp,message"), std::string("timestamp"), std::string("utime_us,latitude_deg"),
                                  kHeadingLine, std::string("2026-08-29T10:00:00Z,3.5"), "2026-08-29T10:00:00," + kHeadingLine}) {
    EXPECT_FALSE(FindCsvColumns(line)) << line;
  }
}

TEST(CsvColumns, OfARecordingWithoutAHeadAreThoseOfItsFirstRow) {
  const auto columns = FindCsvColumns("2026-08-29T10:00:00.000Z,NMEA0183,," + kHeadingLine);
  ASSERT_TRUE(columns);
  EXPECT_FALSE(columns->message);
  EXPECT_EQ(ReadCsvRow("2026-08-29T10:00:00.000Z,AIS,\"!AIVDM,1\"", *columns).message, "!AIVDM,1");
}

TEST(CsvRow, HasTheSentenceWithAndWithoutQuotes) {
  const CsvColumns columns{0, 3};
  for (const std::string& message : {"\"" + kHeadingLine + "\"", kHeadingLine, " \"" + kHeadingLine + " \" ", "\"" + kHeadingLine}) {
    const auto row = ReadCsvRow("2026-08-29T10:00:00.000Z,NMEA0183,\"a, \"\"b\"\"\"," + message, columns);
    EXPECT_EQ(row.time, kRowTime) << message;
    EXPECT_EQ(row.message, kHeadingLine) << message;
    EXPECT_TRUE(row.is_sentence);
  }
}

TEST(CsvRow, HasOtherColumnsBehindASentenceWithoutQuotes) {
  const auto row = ReadCsvRow(kHeadingLine + ",NMEA0183,2026-08-29T10:00:00Z", {2, 0});
  EXPECT_EQ(row.time, kRowTime);
  EXPECT_EQ(row.message, kHeadingLine);
  EXPECT_EQ(ReadCsvRow("2026-08-29T10:00:00Z,$HEHDT,90.0,T", {0, 1}).message, "$HEHDT,90.0,T") << "without a checksum to the end";
}

TEST(CsvRow, OfOtherProtocolsHoldsNoSentence) {
  const CsvColumns columns{0, 3};
  EXPECT_FALSE(ReadCsvRow("2026-08-29T10:00:00Z,NMEA2000,129026,18EF0003FF0300DD", columns).is_sentence);
  EXPECT_FALSE(ReadCsvRow(R"(2026-08-29T10:00:00Z,SignalK,,"{""updates"":[{""$source"":""a""}]}")", columns).is_sentence);
  EXPECT_FALSE(ReadCsvRow("2026-08-29T10:00:00Z,NMEA0183", columns).is_sentence);
  EXPECT_FALSE(ReadCsvRow("", columns).time);
  EXPECT_FALSE(ReadCsvRow("yesterday,NMEA0183,," + kHeadingLine, columns).time);
}

}  // namespace
}  // namespace lookout::navigator
