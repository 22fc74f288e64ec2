// What a text log of sentences is told by, and the times at which its lines are taken.
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
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

// One RMC of a log had the date of the next day, with a right checksum: all behind it were a day late.
class WrongDate : public TextLog {
 protected:
  // One a second from noon, `dates` in their order, and then those of the day.
  void Expect(int num_lines, const std::map<int, std::string>& wrong, bool is_zda = false) {
    std::string text;
    std::vector<Utime> expected;
    for (int i = 0; i < num_lines; ++i) {
      const auto time = "12" + std::to_string(100 + i / 60).substr(1) + std::to_string(100 + i % 60).substr(1);
      const auto date = wrong.contains(i) ? wrong.at(i) : "030414";
      const auto zda = "$GPZDA," + time + "," + date.substr(0, 2) + "," + date.substr(2, 2) + ",20" + date.substr(4) + ",00,00\n";
      text += is_zda ? zda : Rmc(time, date);
      expected.push_back(kDay + 12h + std::chrono::seconds(i));
    }
    Write(text);
    EXPECT_EQ(Times(), expected);
  }
};

TEST_F(WrongDate, OfOneSentenceIsLeftOut) {
  for (const std::string date : {"040414", "020414", "030415", "030413", "030514", "230414", "030464"}) {
    SCOPED_TRACE(date);
    for (const int index : {0, 1, 12, 28, 29}) {
      SCOPED_TRACE(index);
      Expect(30, {{index, date}});
      Expect(30, {{index, date}}, true);
    }
  }
}

TEST_F(WrongDate, OfSomeInARowIsLeftOut) {
  Expect(30, {{12, "040414"}, {13, "040414"}});
  Expect(30, {{0, "040414"}, {1, "040414"}, {2, "040414"}});
  Expect(30, {{0, "030413"}, {1, "030413"}});
  Expect(60, {{12, "040414"}, {13, "050414"}, {14, "040415"}, {15, "040414"}, {40, "040414"}});
}

TEST_F(WrongDate, BesideARightOneOfTheSameSecondIsLeftOut) {
  std::string text;
  for (int i = 10; i < 40; ++i) {
    const auto time = "1200" + std::to_string(i);
    text += "$GPZDA," + time + ",03,04,2014,00,00\n" + Rmc(time, i == 20 ? "040414" : "030414") + Gga(time);
  }
  Write(text);
  EXPECT_EQ(Times().back(), Utime(kDay + 12h + 39s));
}

TEST_F(TextLog, GoesToTheNextDayWhereTheLogPaused) {
  std::string text = Rmc("120000.000", "030414") + Rmc("120001.000", "030414");
  for (int i = 10; i < 40; ++i) text += Rmc("1500" + std::to_string(i), "070414");
  Write(text);
  const auto times = Times();
  EXPECT_EQ(times[1], Utime(kDay + 12h + 1s));
  EXPECT_EQ(times[2], Utime(kDay + std::chrono::days(4) + 15h + 10s)) << "the first behind the pause too";
}

TEST_F(TextLog, TakesTheDateOfAReceiverThatHasFoundIt) {
  std::string text;
  for (int i = 10; i < 40; ++i) text += Rmc("1200" + std::to_string(i), "060180");
  for (int i = 10; i < 40; ++i) text += Rmc("1201" + std::to_string(i), "030414");
  Write(text);
  EXPECT_EQ(Times()[30], Utime(kDay + 12h + 1min + 10s));
}

TEST_F(TextLog, GoesOnBehindJanuary2038) {
  Write(Rmc("235959.000", "180138") + Rmc("000000.000", "190138") + Rmc("031408.000", "190138") + Rmc("100000.000", "010139"));
  const sys_days day = std::chrono::year(2038) / 1 / 19;
  EXPECT_EQ(Times(), (std::vector<Utime>{day - 1s, day, day + 3h + 14min + 8s, sys_days(std::chrono::year(2039) / 1 / 1) + 10h}));
}

// GLL in local time beside RMC in UTC: the log leapt to and fro, and began anew at each GLL.
TEST_F(TextLog, PassesOverLocalTimes) {
  const auto gll = [](const std::string& time) { return "$GPGLL,5222.3215,N,00454.5778,E," + time + ",A\n"; };
  for (const std::string hour : {"14", "10", "02", "22"}) {
    SCOPED_TRACE(hour);
    for (const bool is_gll_first : {false, true}) {
      std::string text;
      std::vector<Utime> expected;
      for (int i = 10; i < 40; ++i) {
        const auto second = "00" + std::to_string(i);
        const auto local = gll(hour + second + ".020");
        text += is_gll_first ? local + Rmc("12" + second, "030414") : Rmc("12" + second, "030414") + local;
        const Utime time = kDay + 12h + std::chrono::seconds(i);
        const Utime before = i == 10 ? time : time - 1s;
        expected.insert(expected.end(), {is_gll_first ? before : time, time});
      }
      Write(text);
      EXPECT_EQ(Times(), expected) << is_gll_first;
    }
  }
}

TEST_F(TextLog, TakesLocalTimesWhereNothingElseIsLeft) {
  std::string text;
  for (int i = 10; i < 20; ++i)
    text += Rmc("1200" + std::to_string(i), "030414") + "$GPGLL,5222.3215,N,00454.5778,E,1400" + std::to_string(i) + ",A\n";
  for (int i = 100; i < 300; ++i) {
    text += "$GPGLL,5222.3215,N,00454.5778,E,14" + std::to_string(100 + i / 60).substr(1) + std::to_string(100 + i % 60).substr(1) + ",A\n";
  }
  Write(text);
  EXPECT_EQ(Times().back(), Utime(kDay + 14h + 299s));
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

// Made of lines that end in spaces, tabs or nothing at all.
TEST_F(TextLog, TakesSentencesWithBlanksBehindThemAndWithoutEndsOfLines) {
  const std::string first = "$GPRMC,120000.000,A,5222.3215,N,00454.5778,E,0.58,251.34,030414,,,A*69";
  const std::string second = "$GPRMC,120001.000,A,5222.3215,N,00454.5778,E,0.58,251.34,030414,,,A*68";
  const Utime start = kDay + 12h;
  for (const std::string end : {" \r\n", "\t\n", " \t\r", ""}) {
    Write(first + end + second + end);
    EXPECT_TRUE(IsTextLog(file_));
    EXPECT_EQ(Times(), (std::vector<Utime>{start, start + 1s}));
  }
}

std::string Utf16(const std::string& text, bool is_little_endian) {
  std::string wide;
  for (const char letter : text) wide += is_little_endian ? std::string({letter, '\0'}) : std::string({'\0', letter});
  return wide;
}

// A shell of Windows writes UTF-16: "unknown file format".
TEST_F(TextLog, MayBeInUtf16) {
  const auto text = Rmc("120000.000", "030414") + "# \xE4\r\n" + Gga("120001.000");
  const Utime start = kDay + 12h;
  for (const bool is_little_endian : {true, false}) {
    for (const bool has_mark : {true, false}) {
      Write((has_mark ? (is_little_endian ? "\xFF\xFE" : "\xFE\xFF") : "") + Utf16(text, is_little_endian) + "x");
      EXPECT_TRUE(IsTextLog(file_)) << is_little_endian << has_mark;
      EXPECT_EQ(Times(), (std::vector<Utime>{start, start, start + 1s})) << is_little_endian << has_mark;
    }
  }
}

class Packed : public TextLog {
 protected:
  // By gzip, as two files that were put one behind the other.
  void Pack(const std::string& text) const {
    fs::remove(file_);
    for (const auto& part : {text.substr(0, text.size() / 2), text.substr(text.size() / 2)}) {
      const gzFile out = gzopen(file_.c_str(), "ab");
      gzwrite(out, part.data(), static_cast<unsigned>(part.size()));
      gzclose(out);
    }
  }
};

TEST_F(Packed, ByGzipIsReadAsItWas) {
  const Utime start = kDay + 12h;
  Pack(Rmc("120000.000", "030414") + Gga("120001.000"));
  EXPECT_TRUE(IsTextLog(file_));
  EXPECT_EQ(Times(), (std::vector<Utime>{start, start + 1s}));
  Pack("\xFF\xFE" + Utf16(Rmc("120000.000", "030414"), true));
  EXPECT_EQ(Times(), std::vector<Utime>{start});
}

TEST_F(Packed, AndCutShortIsReadAsFarAsItGoesAndSaysSo) {
  std::string text;
  for (int second = 0; second < 60; ++second) text += Rmc("1200" + std::to_string(100 + second).substr(1), "030414");
  Pack(text);
  fs::resize_file(file_, fs::file_size(file_) - 20);
  TextLogReader reader(file_);
  int num_lines = 0;
  while (reader.Next()) ++num_lines;
  EXPECT_GE(num_lines, 29);
  EXPECT_LT(num_lines, 60);
  EXPECT_EQ(reader.fault(), "what gzip packed is cut short");
}

// Sentences with right checksums stand in captures and logs, too.
TEST_F(Packed, ByGzipIsNoTextLogWhereItIsACaptureOrALog) {
  for (const std::string magic : {"\xD4\xC3\xB2\xA1", "\xED\xA1\xDA\x01", "\x0A\x0D\x0D\x0A"}) {
    Pack(magic + "$GPHDT,12.0,T*06\r\n");
    EXPECT_FALSE(IsTextLog(file_));
  }
}

class Csv : public TextLog {
 protected:
  static constexpr Utime kTen = std::chrono::sys_days(std::chrono::year(2026) / 8 / 29) + 10h;
  static constexpr char kHead[] = "timestamp,type,id,message\r\n";
  std::vector<std::string> Lines() const {
    TextLogReader reader(file_);
    std::vector<std::string> lines;
    while (const auto line = reader.Next()) lines.emplace_back(line->bytes.begin(), line->bytes.end());
    return lines;
  }
};

// Was refused: no sentence in it tells a time. The quotes made each checksum wrong.
TEST_F(Csv, OfOpenCpnIsReadAtTheTimesOfItsRows) {
  Write(std::string("\xEF\xBB\xBF# a note\r\n") + kHead + "2026-08-29T10:00:00.250Z,NMEA0183,,\"$HEHDT,90.0,T*16\"\r\n# a note\r\n\r\n" +
        "2026-08-29T10:00:01.000Z,AIS,,\"!AIVDM,1,1,,A,1,0*26\"\r\n2026-08-29T10:00:00.900Z,NMEA0183,,$HEHDT,91.0,T*17\r\n");
  EXPECT_TRUE(IsTextLog(file_));
  EXPECT_EQ(Lines(), (std::vector<std::string>{"$HEHDT,90.0,T*16", "!AIVDM,1,1,,A,1,0*26", "$HEHDT,91.0,T*17"}));
  EXPECT_EQ(Times(), (std::vector<Utime>{kTen + 250ms, kTen + 1s, kTen + 1s})) << "a row that is a little late takes the time before it";
  EXPECT_TRUE(TextLogReader(file_).has_date());
}

TEST_F(Csv, CountsRowsThatItDoesNotRead) {
  Write(kHead + std::string("2026-08-29T10:00:00Z,NMEA2000,129026,18EF0003FF0300DD\n2026-08-29T10:00:01Z,NMEA0183,,\"$HEHDT,90.0,T*16\"\n") +
        "2026-08-29T10:00:02Z,SignalK,,\"{\"\"updates\"\":[" + std::string(10'000, 'x') + "]}\"\n?,NMEA0183,,\"$HEHDT,91.0,T*17\r\n\"\n" + kHead +
        "2026-08-29T10:00:03Z,NMEA0183,,\"$HEHDT,92.0,T*14\"\n");
  EXPECT_EQ(Times(), (std::vector<Utime>{kTen + 1s, kTen + 1s, kTen + 3s}));
  TextLogPlayer player({{"day", file_, {}}}, 0.0);
  while (!player.is_finished()) player.Play(std::chrono::steady_clock::time_point(), {[](Utime) {}, [](Utime, Bytes, const std::string&) {}});
  std::map<std::string, std::int64_t> counts;
  for (const auto& counter : player.counters()) counts[std::string(counter.name)] = counter.count;
  EXPECT_EQ(counts, (std::map<std::string, std::int64_t>{{"day_lines", 3}, {"day_other_rows", 2}, {"day_rows_without_time", 1}}));
}

TEST_F(Csv, WithoutASentenceSaysWhatItIs) {
  Write(kHead + std::string("2026-08-29T10:00:00Z,NMEA2000,129026,18EF0003FF0300DD\n"));
  EXPECT_TRUE(IsTextLog(file_));
  try {
    TextLogReader reader(file_);
    FAIL() << "was read";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("no row in it holds a sentence of NMEA 0183; rows of NMEA 2000 and Signal K are not read"),
              std::string::npos)
        << error.what();
  }
}

// Seconds since 1970 or a local time: the sentences say it, as they did before rows were read.
TEST_F(Csv, WhoseTimesCannotBeReadHasThoseOfItsSentences) {
  Write("time,sentence\n1396526400.5," + Rmc("120000.000", "030414") + "1396526401.5," + Gga("120001.000"));
  const Utime start = kDay + 12h;
  EXPECT_EQ(Times(), (std::vector<Utime>{start, start, start + 1s}));
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
