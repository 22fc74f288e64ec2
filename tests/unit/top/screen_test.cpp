#include "tools/top/screen.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <limits>
#include <sstream>

#include "common/core/angles.hpp"
#include "tests/unit/top/bus_talk.hpp"
#include "tools/top/format.hpp"

namespace lookout::top {
namespace {

// All channels of a boat, five processes and twelve obstacles, after two seconds.
Board BusyBoard() {
  Board board(kStart);
  for (const auto& channel : bus::kChannels) {
    if (channel.name != "SIM_TRUTH" && channel.name != "HEALTH") board.Take(channel.name, {}, At(1.9));
  }
  Say(board, bus::kPose, PoseAt(1'000'000, DegToRad(90.0)), 1.9);
  std::vector<obstacle_t> obstacles;
  for (int i = 0; i < 12; ++i) obstacles.push_back(ObstacleAt(i + 1, 4.5F + static_cast<float>(i), static_cast<float>(DegToRad(30.0 * i))));
  obstacles[1].confidence = obstacle_t::CONFIDENCE_TENTATIVE;
  obstacles[2].kind = obstacle_t::KIND_LAND;
  Say(board, bus::kObstacles, TurnOf(1, obstacles), 1.9);
  for (const std::string process : {"vlp16", "segmenter", "navigator", "georeferencer", "recorder"}) {
    Say(board, bus::kHealth,
        HealthOf(process, 0, process == "navigator" ? 1 : 0,
                 process == "navigator" ? "no heading: neither HDT nor PASHR for 12 s, course is too slow to tell" : ""),
        1.9);
  }
  return board;
}

Board AlarmedBoard() {
  Board board = BusyBoard();
  auto health = HealthOf("georeferencer", 1, health_t::STATE_DEGRADED, "obstacle within 10.0 m: 4.5 m, 12 deg to port");
  AddCounter(health, "alarm_active", 1);
  AddCounter(health, "nearest_cm", 450);
  Say(board, bus::kHealth, health, 1.95);
  return board;
}

std::vector<std::string> Lines(const std::vector<Row>& rows) {
  std::vector<std::string> lines;
  std::istringstream text(PlainText(rows));
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

bool Has(const std::vector<std::string>& lines, const std::string& piece) {
  return std::ranges::any_of(lines, [&](const std::string& line) { return line.find(piece) != std::string::npos; });
}

TEST(Screen, ShowsTenObstaclesWithAllNumbersOnEightyByTwentyFour) {
  const auto rows = DrawScreen(BusyBoard(), "title", At(2.0), {80, 24});
  const auto lines = Lines(rows);
  ASSERT_EQ(lines.size(), 24U);
  EXPECT_EQ(lines[0], "channel           Hz   kB/s lost bad  age process       state    cpu%   MB p99ms");
  EXPECT_EQ(lines[13], "of 12  id range m  rel true    latitude    longitude  size m        confidence");
  EXPECT_EQ(lines[14], "  1     1     4.5  000  090   43.500000   -72.250000  6.0x2.5x1.5   sure");
  EXPECT_EQ(lines[15], "  2     2     5.5  030  120   43.500000   -72.250000  6.0x2.5x1.5   tentative");
  EXPECT_EQ(lines[16], "  3     3     6.5  060  150   43.500000   -72.250000  6.0x2.5x1.5   land");
  EXPECT_EQ(lines[23], " 10    10    13.5  270  000   43.500000   -72.250000  6.0x2.5x1.5   sure");
  EXPECT_TRUE(Has(lines, "navigator     degraded 12.5   14     -"));
  EXPECT_TRUE(Has(lines, " no heading: neither HDT nor PASHR for"));
  EXPECT_TRUE(Has(lines, "POSE             1.0"));
}

TEST(Screen, MayLeaveOutWhatIsNotSure) {
  const auto lines = Lines(DrawScreen(BusyBoard(), "title", At(2.0), {80, 24, true}));
  EXPECT_EQ(lines[13], "of 11  id range m  rel true    latitude    longitude  size m        sure only");
  EXPECT_FALSE(Has(lines, "tentative"));
  EXPECT_TRUE(Has(lines, " 10    11    14.5"));
}

TEST(Screen, AlarmStandsOnTopInReverse) {
  for (const int height : {0, 24, 8, 1}) {
    const auto rows = DrawScreen(AlarmedBoard(), "title", At(2.0), {80, height});
    ASSERT_FALSE(rows.empty());
    EXPECT_EQ(rows[0][0].style, Style::kAlarm);
    EXPECT_EQ(Lines(rows)[0], "ALARM: obstacle within 10.0 m: 4.5 m, 12 deg to port") << height;
  }
  EXPECT_TRUE(Has(Lines(DrawScreen(AlarmedBoard(), "title", At(2.0), {80, 24})), " 10    10    13.5"));  // the ten have room beside it
  const auto calm = DrawScreen(BusyBoard(), "title", At(2.0), {80, 24});
  EXPECT_FALSE(Has(Lines(calm), "ALARM"));
}

TEST(Screen, AnAlarmOfAProcessThatFellSilentStaysAndSaysSo) {
  EXPECT_TRUE(Has(Lines(DrawScreen(AlarmedBoard(), "title", At(10.0), {80, 24})), "4.5 m, 12 deg to port (8 s ago, silent since)"));
}

TEST(Screen, FitsAnySize) {
  for (int width = 1; width <= 200; width += 3) {
    for (int height = 1; height <= 60; ++height) {
      const auto rows = DrawScreen(AlarmedBoard(), "lookout-top", At(2.0), {width, height});
      EXPECT_LE(rows.size(), static_cast<std::size_t>(height));
      for (const auto& line : Lines(rows)) EXPECT_LE(line.size(), static_cast<std::size_t>(width));
    }
  }
}

TEST(Screen, AnEmptyBusIsSaid) {
  const auto lines = Lines(DrawScreen(Board(kStart), "title", At(2.0), {80, 24}));
  EXPECT_TRUE(Has(lines, "nothing on the bus"));
  EXPECT_TRUE(Has(lines, "no process sends HEALTH"));
  EXPECT_TRUE(Has(lines, "no OBSTACLES"));
}

TEST(Screen, SilenceIsSaid) {
  const auto lines = Lines(DrawScreen(BusyBoard(), "title", At(14.0), {80, 40}));
  EXPECT_TRUE(Has(lines, "vlp16         silent"));
  EXPECT_TRUE(Has(lines, " no HEALTH for 12 s"));
  EXPECT_TRUE(Has(lines, "no OBSTACLES"));
}

TEST(Screen, TextFromOutsideSendsNoControlSequence) {
  Board board(kStart);
  Say(board, bus::kHealth, HealthOf("evil\x1b[2J", 0, health_t::STATE_FAILED, "\x1b]0;title\x07 and \xff"), 0.1);
  board.Take("BAD\x1b[31mNAME\n", {}, At(0.1));
  const auto rows = DrawScreen(board, "title", At(0.2), {80, 24});
  for (const auto& row : rows) {
    for (const auto& span : row) EXPECT_EQ(span.text, Printable(span.text));
  }
  EXPECT_TRUE(Has(Lines(rows), "evil?[2J"));
}

TEST(Format, NumbersKeepTheirWidth) {
  EXPECT_EQ(Number(3.14159, 6, 2), "  3.14");
  EXPECT_EQ(Number(-0.001, 6, 1), "   0.0");
  EXPECT_EQ(Number(1234.567, 6, 2), "1234.6");
  EXPECT_EQ(Number(123456.7, 6, 2), "123457");
  EXPECT_EQ(Number(1e9, 6, 2), "######");
  EXPECT_EQ(Number(1e300, 6, 2), "######");
  EXPECT_EQ(Number(std::numeric_limits<double>::quiet_NaN(), 6, 2), "     -");
  EXPECT_EQ(Number(std::numeric_limits<double>::infinity(), 6, 2), "     -");
  EXPECT_EQ(Count(12345, 5), "12345");
  EXPECT_EQ(Count(123456, 5), " 123k");
  EXPECT_EQ(Count(std::numeric_limits<std::int64_t>::max(), 4), "####");
  EXPECT_EQ(Count(-5, 4), "  -5");
}

TEST(Format, DegreesWrapToThreeDigits) {
  EXPECT_EQ(Degrees(0.0), "000");
  EXPECT_EQ(Degrees(DegToRad(359.7)), "000");
  EXPECT_EQ(Degrees(DegToRad(-1.0)), "359");
  EXPECT_EQ(Degrees(std::numeric_limits<double>::quiet_NaN()), "-");
}

TEST(Format, WrapsAtWordsAndBreaksLongOnes) {
  EXPECT_EQ(Wrapped("one two three", 7, 9), (std::vector<std::string>{"one two", "three"}));
  EXPECT_EQ(Wrapped("abcdefghij", 4, 9), (std::vector<std::string>{"abcd", "efgh", "ij"}));
  EXPECT_EQ(Wrapped("one two three four", 5, 2), (std::vector<std::string>{"one", "two.."}));
  EXPECT_TRUE(Wrapped("", 5, 2).empty());
}

}  // namespace
}  // namespace lookout::top
