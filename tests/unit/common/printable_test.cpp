#include "common/core/printable.hpp"

#include <gtest/gtest.h>

namespace lookout {
namespace {

using namespace std::string_literals;

TEST(Printable, LetsNoByteOfAnEscapeSequencePass) {
  EXPECT_EQ(Printable("a\033[31mb\x9B"
                      "c\n"),
            "a?[31mb?c?");
  EXPECT_EQ(Printable(""), "");
}

TEST(PrintableLines, KeepsOtherScriptsAndNoControlCharacter) {
  EXPECT_EQ(PrintableLines("boje \xC3\xBC \xE6\xB0\xB4 \xF0\x9F\x9A\xA4"), "boje \xC3\xBC \xE6\xB0\xB4 \xF0\x9F\x9A\xA4");
  EXPECT_EQ(PrintableLines("\033]0;title\a\x7F\t\r\0"s), "?]0;title?????");
  EXPECT_EQ(PrintableLines("\xC2\x9B"
                           "31m"),
            "?31m")
      << "the one character that is ESC and [";
  EXPECT_EQ(PrintableLines("log\xE2\x80\xAEgpj.exe"), "log?gpj.exe") << "written from right to left";
}

TEST(PrintableLines, ReplacesWhatIsNoUtf8) {
  EXPECT_EQ(PrintableLines("\x9B"
                           "31m \xE4 \xC3"),
            "?31m ? ?");
  EXPECT_EQ(PrintableLines("\xC0\x9B \xE0\x82\x9B"), "?? ???") << "longer than it must be";
  EXPECT_EQ(PrintableLines("\xED\xA0\x80\xF4\x90\x80\x80\xFF"), "????????") << "surrogate, beyond the last, never a byte";
}

TEST(PrintableLines, SetsOffLinesThatComeFromOutside) {
  EXPECT_EQ(PrintableLines("a\n2026-01-01 critical: sinking"), "a\n  2026-01-01 critical: sinking");
}

TEST(CsvText, IsNoFormula) {
  EXPECT_EQ(CsvText("=cmd|'/c calc'!A1"), "'=cmd|'/c calc'!A1");
  EXPECT_EQ(CsvText("+1"), "'+1");
  EXPECT_EQ(CsvText("-1"), "'-1");
  EXPECT_EQ(CsvText("@SUM(A1)"), "'@SUM(A1)");
  EXPECT_EQ(CsvText("  =1"), "'  =1");
  EXPECT_EQ(CsvText("\t=1"), "?=1");
  EXPECT_EQ(CsvText("\r=1"), "?=1");
  EXPECT_EQ(CsvText("=\"a\",1"), "\"'=\"\"a\"\",1\"");
  EXPECT_EQ(CsvText("no-formula = this"), "no-formula = this");
}

TEST(CsvText, IsQuotedWhereItHasToBe) {
  EXPECT_EQ(CsvText(""), "");
  EXPECT_EQ(CsvText("a,b"), "\"a,b\"");
  EXPECT_EQ(CsvText("say \"no\""), "\"say \"\"no\"\"\"");
  EXPECT_EQ(CsvText("two\nlines"), "\"two\nlines\"");
  EXPECT_EQ(CsvText("\033[2J"), "?[2J");
}

}  // namespace
}  // namespace lookout
