// What a text log of sentences is told by, and the times at which its lines are taken.
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "services/navigator/io/text_log_player.hpp"
#include "services/navigator/io/text_log_reader.hpp"
#include "tests/support/files.hpp"

namespace lookout::navigator {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using std::chrono::sys_days;

class TextLog : public ::testing::Test {
 protected:
  support::TempDir folder_;
  const fs::path file_ = folder_ / "log";
  static constexpr sys_days kDay = std::chrono::year(2014) / 4 / 3;

  void Write(const std::string& text) const { std::ofstream(file_, std::ios::binary) << text; }
  static std::string Gga(const std::string& time) { return "$GPGGA," + time + ",5222.3215,N,00454.5778,E,1,4,2.95,16.0,M,47.0,M,,\n"; }
  static std::string Rmc(const std::string& time, const std::string& date) {
    return "$GPRMC," + time + ",A,5222.3215,N,00454.5778,E,0.58,251.34," + date + ",,,A\n";
  }
  std::vector<Utime> Times(std::optional<sys_days> day = {}) const {
    TextLogReader reader(file_, day);
    std::vector<Utime> times;
    while (const auto line = reader.Next()) times.push_back(line->time);
    return times;
  }
};

TEST_F(TextLog, TakesTheDateFromLaterInTheFile) {
  Write("junk\n" + Gga("085411.000") + "$GPGSA,A,3,16\n" + Gga("085411.500") + Rmc("085412.000", "030414") + "$HEHDT,12.0,T\n");
  const Utime start = kDay + 8h + 54min + 11s;
  EXPECT_EQ(Times(), (std::vector<Utime>{start, start, start, start + 500ms, start + 1s, start + 1s}));
}

TEST_F(TextLog, GoesOverMidnight) {
  const Utime midnight = kDay + 24h;
  Write(Gga("235959.000") + Rmc("235959.000", "030414") + Gga("000000.000") + Gga("235959.500") + Rmc("000000.000", "040414") + Gga("000001.000"));
  EXPECT_EQ(Times(), (std::vector<Utime>{midnight - 1s, midnight - 1s, midnight, midnight, midnight, midnight + 1s}));
}

TEST_F(TextLog, FindsTheDayOfWhatStandsBeforeMidnightAndItsFirstDate) {
  Write(Gga("235959.000") + Gga("000001.000") + Rmc("000002.000", "040414"));
  const Utime midnight = kDay + 24h;
  EXPECT_EQ(Times(), (std::vector<Utime>{midnight - 1s, midnight + 1s, midnight + 2s}));
}

TEST_F(TextLog, TakesALateSentenceAtTheTimeOfTheOneBefore) {
  Write(Rmc("120005.000", "030414") + Gga("120001.000") + Gga("120006.000"));
  const Utime start = kDay + 12h + 5s;
  EXPECT_EQ(Times(), (std::vector<Utime>{start, start, start + 1s}));
}

TEST_F(TextLog, TakesDatesForwardOnly) {
  Write(Rmc("120000.000", "030414") + Rmc("120001.000", "180894") + Rmc("120002.000", "030414") + Rmc("080000.000", "050414"));
  const Utime start = kDay + 12h;
  EXPECT_EQ(Times(), (std::vector<Utime>{start, start + 1s, start + 2s, kDay + 48h + 8h}));
}

TEST_F(TextLog, BeginsAnewWhereItRunsBack) {
  Write(Rmc("120000.000", "030414") + Gga("110000.000"));
  EXPECT_EQ(Times(), (std::vector<Utime>{kDay + 12h, kDay + 11h}));
}

TEST_F(TextLog, PassesOverTimesOfDamagedSentences) {
  Write(Rmc("120000.000", "030414") + "$GPGGA,130000.000,5222.3215,N,00454.5778,E,1,4,2.95,16.0,M,47.0,M,,*00\n");
  EXPECT_EQ(Times().back(), Utime(kDay + 12h));
}

TEST_F(TextLog, WithoutADateIsOf1970AndWithoutATimeIsRefused) {
  Write(Gga("000001.000"));
  EXPECT_FALSE(TextLogReader(file_).has_date());
  EXPECT_EQ(Times().front(), Utime(1s));
  Write("$HEHDT,12.0,T\n");
  EXPECT_THROW(TextLogReader{file_}, std::runtime_error);
  EXPECT_THROW(TextLogReader{file_ / "none"}, std::runtime_error);
}

TEST_F(TextLog, IsToldFromOtherFiles) {
  Write("# a note\r\n\\s:1*2A\\!AIVDM,1,1,,A,1,0*26\r\n");
  EXPECT_TRUE(IsTextLog(file_));
  Write("no sentence\n");
  EXPECT_FALSE(IsTextLog(file_));
  Write(std::string("$GPRMC\0", 7));
  EXPECT_FALSE(IsTextLog(file_));
  Write("");
  EXPECT_FALSE(IsTextLog(file_));
}

// Of each some logs exist: they were refused as captures of an unknown format.
TEST_F(TextLog, IsToldWhateverStandsBetweenItsSentences) {
  const std::string sentence = "$GPHDT,12.0,T*06\r\n";
  const std::string ubx("\xB5\x62\x01\x07\x5C\x00\x24\n\x0D\x00\xFF\x80\x81\x82\x83\x84\x85\x86\x87\x88", 20);
  std::string binary;
  for (int i = 0; i < 200; ++i) binary += ubx;
  const auto expect_text_log = [this](const std::string& text, const std::string& what) {
    Write(text);
    EXPECT_TRUE(IsTextLog(file_)) << what;
  };
  expect_text_log("# Ger\xE4t\n" + sentence, "one byte that is not ASCII");
  expect_text_log("\xEF\xBB\xBF" + sentence, "byte order mark");
  expect_text_log(std::string(100'000, '\0') + sentence, "zero bytes");
  expect_text_log(std::string(100, '\0') + "$GPHDT,12.0,T\n", "zero bytes, and no checksum");
  expect_text_log("$GPGSV,1,1,00\r$GPHDT,12.0,T*06\r", "CR alone");
  expect_text_log(binary + sentence + binary, "UBX");
  expect_text_log("\x10\x8F\x20" + std::string(60, '\x11') + "\x10\x03" + sentence, "TSIP");
}

TEST_F(TextLog, IsNotToldByADollarInSomethingElse) {
  std::string noise;
  for (int i = 0; i < 20'000; ++i) noise += static_cast<char>((i * 7919 + i / 256) & 0xFF);
  for (const std::string text : {"$ price,1\n", "cost: $5,00 each!\n", "$GPHDT\n"}) {
    Write(text);
    EXPECT_FALSE(IsTextLog(file_)) << text;
  }
  Write(noise + "$GPHDT,12.0,T\n" + noise);
  EXPECT_FALSE(IsTextLog(file_)) << "in binary only a right checksum counts";
}

TEST_F(TextLog, TakesEachLineOfAFileWithCarriageReturnsAlone) {
  std::string text = Rmc("120000.000", "030414") + Gga("120001.000") + Gga("120002.000");
  std::ranges::replace(text, '\n', '\r');
  Write(text);
  const Utime start = kDay + 12h;
  EXPECT_EQ(Times(), (std::vector<Utime>{start, start + 1s, start + 2s}));
}

TEST_F(TextLog, FindsSentencesBehindBinaryWithoutAnEndOfLine) {
  Write(std::string(1'000'000, '\x80') + Rmc("120000.000", "030414") + std::string(5000, '\x81') + Gga("120001.000"));
  const Utime start = kDay + 12h;
  EXPECT_EQ(Times(), (std::vector<Utime>{start, start + 1s}));
}

TEST_F(TextLog, TakesTheGivenDayOnlyWhereNoSentenceTellsADate) {
  const sys_days given = std::chrono::year(2020) / 2 / 29;
  Write(Gga("235959.000") + Gga("000001.000"));
  EXPECT_EQ(Times(given), (std::vector<Utime>{given + 24h - 1s, given + 24h + 1s}));
  Write(Gga("120000.000") + Rmc("120001.000", "030414"));
  EXPECT_EQ(Times(given).front(), Utime(kDay + 12h));
}

// What a player gives, one call each 10 ms.
class Playing : public TextLog {
 protected:
  struct Given {
    Utime time;
    std::string line;
  };
  using Clock = std::chrono::steady_clock;

  std::vector<Given> PlayFor(TextLogPlayer& player, std::chrono::milliseconds duration) {
    std::vector<Given> given;
    const auto end = now_ + duration;
    for (; now_ <= end; now_ += 10ms) {
      player.Play(now_, {[&](Utime time) {
                           EXPECT_GE(time, advanced_);
                           advanced_ = time;
                         },
                         [&](Utime time, Bytes line, const std::string& name) {
                           given.push_back({time, name + " " + std::string(line.begin(), line.end())});
                         }});
    }
    return given;
  }

  Clock::time_point now_ = Clock::time_point(1000h);
  Utime advanced_ = kDay;
};

TEST_F(Playing, IsAtThePaceAndTheTimesOfTheSentences) {
  Write("# a note\r\n" + Rmc("120000.000", "030414") + "$HEHDT,1.0,T\n" + Gga("120001.000") + Gga("123000.000"));
  TextLogPlayer player({{"day", file_, {}}}, 2.0);
  EXPECT_EQ(player.start(), Utime(kDay + 12h));
  EXPECT_EQ(PlayFor(player, 490ms).size(), 3U);
  EXPECT_EQ(advanced_, Utime(kDay + 12h + 980ms)) << "time goes on between the lines";
  const auto rest = PlayFor(player, 20ms);
  ASSERT_EQ(rest.size(), 2U) << "a long silence is not waited for";
  EXPECT_EQ(rest[0].time, Utime(kDay + 12h + 1s));
  EXPECT_EQ(rest[1].time, Utime(kDay + 12h + 30min));
  EXPECT_TRUE(player.is_finished());
  ASSERT_EQ(player.counters().size(), 1U);
  EXPECT_EQ(player.counters()[0].name, "day_lines");
  EXPECT_EQ(player.counters()[0].count, 5);
}

TEST_F(Playing, OfSeveralIsInTheOrderOfTheirTimes) {
  Write(Rmc("120000.000", "030414") + Gga("120002.000"));
  const auto second = fs::path(file_.string() + "_2");
  std::ofstream(second) << Rmc("120001.000", "030414") << Gga("120002.000");
  TextLogPlayer player({{"a", file_, {}}, {"b", second, {}}}, 0.0);
  std::string order;
  for (const auto& given : PlayFor(player, 100ms)) order += given.line.substr(0, 8) + " ";
  EXPECT_EQ(order, "a $GPRMC b $GPRMC a $GPGGA b $GPGGA ");
  fs::remove(second);
}

TEST_F(Playing, SaysWhichLogTellsNoDate) {
  Write(Gga("120000.000"));
  EXPECT_EQ(TextLogPlayer({{"day", file_, {}}}, 1.0).dateless(), std::vector<std::string>{"day"});
  const TextLogPlayer player({{"day", file_, kDay}}, 1.0);
  EXPECT_TRUE(player.dateless().empty());
  EXPECT_EQ(player.start(), Utime(kDay + 12h));
}

}  // namespace
}  // namespace lookout::navigator
