#include "tools/eval/html.hpp"

#include <gtest/gtest.h>

#include "tests/unit/eval_report/markup.hpp"

namespace lookout::eval {
namespace {

TEST(Markup, CheckOfTheTestsItselfFindsFaults) {
  EXPECT_EQ(FaultOf("<a><b c=\"x>y\"/>1 &lt; 2</a>"), "");
  EXPECT_NE(FaultOf("<a><b></a></b>"), "");
  EXPECT_NE(FaultOf("<a>"), "");
  EXPECT_NE(FaultOf("</a>"), "");
  EXPECT_NE(FaultOf("<a>1 < 2</a>"), "");
  EXPECT_NE(FaultOf("<a>this & that</a>"), "");
  EXPECT_NE(FaultOf("<a b=\"c>"), "");
}

TEST(Html, EscapesWhatMarkupIsMadeOf) {
  EXPECT_EQ(Escape("<a href=\"x\" title='y'>&amp;"), "&lt;a href=&quot;x&quot; title=&#39;y&#39;&gt;&amp;amp;");
}

TEST(Html, ReplacesControlCharactersButKeepsOtherLetters) {
  EXPECT_EQ(Escape(std::string_view("a\0b\x1b\x7f", 5)), "a&#xFFFD;b&#xFFFD;&#xFFFD;");
  EXPECT_EQ(Escape("sj\xc3\xb6\n\t"), "sj\xc3\xb6\n\t");
}

TEST(Html, ElementEscapesItsText) { EXPECT_EQ(Element("p", "<script>"), "<p>&lt;script&gt;</p>\n"); }

TEST(HtmlTable, HasACaptionAndHeadingsForColumnsAndRows) {
  HtmlTable table("Times & names", {{"method"}, {"ms", true}});
  table.Add({{"<ours>"}, {"1.5", "best"}});
  const auto markup = table.Markup();
  EXPECT_EQ(FaultOf(markup), "");
  EXPECT_TRUE(Holds(markup, "<caption>Times &amp; names</caption>"));
  EXPECT_TRUE(Holds(markup, "<th scope=\"col\" class=\"upright\"><span>ms</span></th>"));
  EXPECT_TRUE(Holds(markup, "<th scope=\"row\">&lt;ours&gt;</th><td class=\"best\">1.5</td>"));
}

TEST(HtmlTable, ColumnWithAWordStandsToTheLeftAsAWhole) {
  HtmlTable table("t", {{"scene"}, {"best"}, {"mIoU"}});
  table.Add({{"a"}, {"ours"}, {"90.1"}});
  table.Add({{"b"}, {"-"}, {"-"}});
  const auto markup = table.Markup();
  EXPECT_TRUE(Holds(markup, "<td class=\"words\">-</td><td>-</td>"));
  EXPECT_TRUE(Holds(markup, "<th scope=\"col\" class=\"words\"><span>best</span></th>"));
}

TEST(HtmlTable, WithoutRowsIsStillWellFormed) {
  const HtmlTable table("nothing", {{"a"}});
  EXPECT_TRUE(table.empty());
  EXPECT_EQ(FaultOf(table.Markup()), "");
}

}  // namespace
}  // namespace lookout::eval
