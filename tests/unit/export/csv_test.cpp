#include "tools/export/csv.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace lookout::exporter {
namespace {

std::string Cell(const auto& cell) {
  std::string text;
  AppendCell(cell, text);
  return text;
}

TEST(Csv, KeepsLeadingZerosOfTheFraction) {
  EXPECT_EQ(Cell(Fixed{0.0, 3}), "0.000");
  EXPECT_EQ(Cell(Fixed{0.002, 3}), "0.002");
  EXPECT_EQ(Cell(Fixed{-0.05, 2}), "-0.05");
  EXPECT_EQ(Cell(Fixed{12.5, 0}), "13");
  EXPECT_EQ(Cell(Fixed{131.07, 3}), "131.070");
  EXPECT_EQ(Cell(Fixed{-122.419415512, 9}), "-122.419415512");
}

TEST(Csv, WritesNoMinusBeforeZero) {
  EXPECT_EQ(Cell(Fixed{-0.0, 2}), "0.00");
  EXPECT_EQ(Cell(Fixed{-0.001, 2}), "0.00");
  EXPECT_EQ(Cell(Shortest{-0.0}), "0");
}

TEST(Csv, LeavesWhatIsNotFiniteEmpty) {
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(Cell(Fixed{value, 3}), "");
    EXPECT_EQ(Cell(Shortest{value}), "");
    EXPECT_EQ(Cell(Direction{value}), "");
  }
}

TEST(Csv, WritesTheLargestAndSmallestNumbersInFull) {
  EXPECT_EQ(std::stod(Cell(Fixed{std::numeric_limits<double>::max(), 9})), std::numeric_limits<double>::max());
  EXPECT_EQ(std::stod(Cell(Shortest{std::numeric_limits<double>::max()})), std::numeric_limits<double>::max());
  EXPECT_EQ(std::strtod(Cell(Shortest{std::numeric_limits<double>::denorm_min()}).c_str(), nullptr), std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(Cell(Shortest{std::numeric_limits<double>::min()}).find('e'), std::string::npos);
}

TEST(Csv, ReadsBackWithinHalfAStepForRandomNumbers) {
  const std::uint64_t seed = 20261121;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> number(-1e5, 1e5);
  for (int i = 0; i < 20'000; ++i) {
    const double value = number(random);
    ASSERT_NEAR(std::stod(Cell(Fixed{value, 4})), value, 0.5e-4 + 1e-10) << value;
    ASSERT_EQ(std::stod(Cell(Shortest{value})), value);
  }
}

TEST(Csv, WrapsDirectionsToBelow360AlsoByRounding) {
  EXPECT_EQ(Cell(Direction{0.0}), "0.0000");
  EXPECT_EQ(Cell(Direction{-1e-9}), "0.0000");  // 359.99999994 would be printed as 360.0000
  EXPECT_EQ(Cell(Direction{3.0 * std::acos(-1.0)}), "180.0000");
  EXPECT_EQ(Cell(Direction{-0.5 * std::acos(-1.0)}), "270.0000");
}

TEST(Csv, QuotesTextThatHoldsSeparatorsOrQuotes) {
  EXPECT_EQ(Cell(std::string_view("plain words")), "plain words");
  EXPECT_EQ(Cell(std::string_view("a,b")), "\"a,b\"");
  EXPECT_EQ(Cell(std::string_view("say \"no\"")), "\"say \"\"no\"\"\"");
  EXPECT_EQ(Cell(std::string_view("two\nlines")), "\"two\nlines\"");
}

// HEALTH and fixes of a log from elsewhere hold what their makers wrote.
TEST(Csv, WritesNoFormulaAndNoEscapeSequenceButNegativeNumbers) {
  std::string text;
  AppendRow(text, "=1+1", "-1", "@A1\033[2J", -1, Fixed{-1.5, 2}, Shortest{-0.25});
  EXPECT_EQ(text, "'=1+1,'-1,'@A1?[2J,-1,-1.50,-0.25\n");
}

TEST(Csv, SeparatesCellsAndEndsRows) {
  std::string text;
  AppendRow(text, Empty{}, std::numeric_limits<std::int64_t>::min(), CountOrEmpty{-1});
  AppendRow(text, CountOrEmpty{1});
  EXPECT_EQ(text, ",-9223372036854775808,\n1\n");
}

}  // namespace
}  // namespace lookout::exporter
