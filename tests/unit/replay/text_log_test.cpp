// The times that a text log of sentences is replayed at.
#include "tools/replay/text_log.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace lookout::replay {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using std::chrono::sys_days;

class TextLog : public ::testing::Test {
 protected:
  const fs::path file_ = fs::temp_directory_path() / ("lookout_replay_text_log_" + std::to_string(getpid()));
  static constexpr sys_days kDay = std::chrono::year(2014) / 4 / 3;

  void TearDown() override { fs::remove(file_); }

  void Write(const std::string& text) const { std::ofstream(file_, std::ios::binary) << text; }
  static std::string Gga(const std::string& time) { return "$GPGGA," + time + ",5222.3215,N,00454.5778,E,1,4,2.95,16.0,M,47.0,M,,\n"; }
  static std::string Rmc(const std::string& time, const std::string& date) {
    return "$GPRMC," + time + ",A,5222.3215,N,00454.5778,E,0.58,251.34," + date + ",,,A\n";
  }
  std::vector<Utime> Times() const {
    TextLogReader reader(file_);
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

}  // namespace
}  // namespace lookout::replay
