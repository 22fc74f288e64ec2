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

TEST(IsName, TakesWhatCanBeReadInAnyScript) {
  // The last two: Persian with a joiner within a word, an anchor with its variation selector.
  for (const auto* good : {"Kiosk pier", "7", "Sj\xC3\xB6str\xC3\xB6m", "\xE6\xB0\xB4 \xF0\x9F\x9A\xA4",
                           "\xD9\x85\xDB\x8C\xE2\x80\x8C\xD8\xB1\xD9\x88\xD9\x85", "\xE2\x9A\x93\xEF\xB8\x8F"}) {
    EXPECT_TRUE(IsName(good)) << good;
  }
  EXPECT_TRUE(IsName(std::string(kMostNameBytes, 'a')));
}

TEST(IsName, TakesNothingInvisible) {
  struct Bad {
    const char* what;
    const char* name;
  };
  for (const auto& [what, name] : {Bad{"nothing", ""},
                                   {"space", "  "},
                                   {"no-break space", "\xC2\xA0"},
                                   {"wide space", "\xE3\x80\x80"},
                                   {"empty braille", "\xE2\xA0\x80"},
                                   {"Hangul filler", "\xE3\x85\xA4"},
                                   {"joiners alone", "\xE2\x80\x8D\xEF\xB8\x8F"},
                                   {"zero width space", "pier\xE2\x80\x8B"},
                                   {"byte order mark", "\xEF\xBB\xBFpier"},
                                   {"soft hyphen",
                                    "pi\xC2\xAD"
                                    "er"},
                                   {"right-to-left override", "\xE2\x80\xAEreip"},
                                   {"right-to-left mark", "pier\xE2\x80\x8F"},
                                   {"word joiner", "\xE2\x81\xA0pier"},
                                   {"tag", "pier\xF3\xA0\x81\xA1"},
                                   {"no character", "pier\xEF\xBF\xBF"},
                                   {"two lines", "two\nlines"},
                                   {"no UTF-8", "\xC3"}}) {
    EXPECT_FALSE(IsName(name)) << what;
  }
  EXPECT_FALSE(IsName(std::string(kMostNameBytes + 1, 'a')));
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
