#include "lab/eval/table.hpp"

#include <gtest/gtest.h>
#include <limits>
#include <sstream>

namespace lookout::eval {
namespace {

TEST(Table, NumbersStandToTheRightAndWordsToTheLeft) {
  Table table({"name", "range_m"});
  table.Add({"a", "7.5"});
  table.Add({"buoy", "-"});
  table.Add({"boat", "112.0"});
  std::ostringstream text;
  table.Print(text);
  EXPECT_EQ(text.str(), "name  range_m\na         7.5\nbuoy        -\nboat    112.0\n");
}

TEST(Table, CsvQuotesWhatWouldBreakItsCells) {
  Table table({"name", "note"});
  table.Add({"a, b", "say \"hi\""});
  std::ostringstream text;
  table.PrintCsv(text);
  EXPECT_EQ(text.str(), "name,note\n\"a, b\",\"say \"\"hi\"\"\"\n");
}

// Names of objects come from files of others.
TEST(Table, CsvHoldsNoFormulaAndNumbersStay) {
  Table table({"name", "value"});
  table.Add({"=cmd|' /C calc'!A1", "-7.5"});
  table.Add({"-2+3+cmd|' /C calc'!A1", "+12%"});
  table.Add({"\033[2J", "-"});
  std::ostringstream text;
  table.PrintCsv(text);
  EXPECT_EQ(text.str(), "name,value\n'=cmd|' /C calc'!A1,-7.5\n'-2+3+cmd|' /C calc'!A1,+12%\n?[2J,-\n");
  std::ostringstream printed;
  table.Print(printed);
  EXPECT_EQ(printed.str().find('\033'), std::string::npos);
}

TEST(Table, WhatIsNotKnownIsADash) {
  EXPECT_EQ(Number(std::numeric_limits<double>::quiet_NaN(), 2), "-");
  EXPECT_EQ(Number(1.005, 1), "1.0");
  EXPECT_EQ(Number(std::int64_t{-7}), "-7");
}

}  // namespace
}  // namespace lookout::eval
