#include "tools/eval/report_html.hpp"

#include <gtest/gtest.h>
#include <sstream>

#include "tests/unit/eval_report/made_up.hpp"
#include "tests/unit/eval_report/markup.hpp"

namespace lookout::eval {
namespace {

std::string PageOf(const Results& results) {
  std::ostringstream out;
  WriteHtml(results, out);
  return out.str();
}

std::string SectionOf(const std::string& page, const std::string& id) {
  const auto at = page.find("<section id=\"" + id + "\">");
  return at == std::string::npos ? "" : page.substr(at, page.find("</section>", at) - at);
}

TEST(WriteHtml, PageIsWellFormedAndEscaped) {
  const auto page = PageOf(MadeUpResults());
  EXPECT_EQ(FaultOf(page), "");
  EXPECT_TRUE(Holds(page, "lookout-eval --scenes &#39;dense&#39; &lt;&amp;&gt;"));
  EXPECT_FALSE(Holds(page, "<b>computer"));
  EXPECT_FALSE(Holds(page, "open<water>"));
}

TEST(WriteHtml, PageStandsAlone) {
  const auto page = PageOf(MadeUpResults());
  for (const auto* word : {"http", "//", "<script", "<link", "<img", "<iframe", "url(", "@import", "src=", "xlink"})
    EXPECT_FALSE(Holds(page, word)) << word;
}

TEST(WriteHtml, SameResultsGiveTheSameBytes) { EXPECT_EQ(PageOf(MadeUpResults()), PageOf(MadeUpResults())); }

TEST(WriteHtml, EveryLinkOfTheContentsHasItsSection) {
  const auto page = PageOf(MadeUpResults());
  int num_links = 0;
  for (auto at = page.find("href=\"#"); at != std::string::npos; at = page.find("href=\"#", at + 1)) {
    const auto id = page.substr(at + 7, page.find('"', at + 7) - at - 7);
    EXPECT_NE(SectionOf(page, id), "") << id;
    ++num_links;
  }
  EXPECT_EQ(num_links, 12);
  EXPECT_EQ(CountOf(page, "<section "), 12);
}

TEST(WriteHtml, SaysWhatWasRun) {
  const auto section = SectionOf(PageOf(MadeUpResults()), "run");
  EXPECT_TRUE(Holds(section, "3 a scene (5 to 7), 2.0 s each"));
  EXPECT_TRUE(Holds(section, "<dt>turns a method</dt><dd>12</dd>"));
}

// Sweeps run on other seeds than tables.
TEST(WriteHtml, ASweepSaysWhichSeedsItRanOn) {
  auto results = MadeUpResults();
  results.curves[0].scans_from = "seeds 1 to 4, 0.6 s each";
  EXPECT_TRUE(Holds(SectionOf(PageOf(results), "curves"), "seeds 1 to 4, 0.6 s each"));
  EXPECT_FALSE(Holds(SectionOf(PageOf(MadeUpResults()), "curves"), "seeds"));
}

TEST(WriteHtml, SummaryNamesTheWinnerOfEachScene) {
  const auto section = SectionOf(PageOf(MadeUpResults()), "summary");
  EXPECT_TRUE(Holds(section, "Highest mean mIoU over the scenes: ours with 85.2 %, before paper W=512 with 55.5 %."));
  EXPECT_TRUE(Holds(section, "Scenes won: ours 1, paper W=512 1."));
  EXPECT_TRUE(
      Holds(section,
            "<th scope=\"row\">dense</th><td class=\"words\">ours</td><td>90.2</td><td class=\"words\">paper W=512</td><td>30.7</td><td>59.5</td>"));
  EXPECT_TRUE(Holds(section, "<th scope=\"row\">rain</th><td class=\"words\">paper W=512</td><td>80.3</td>"));
  EXPECT_TRUE(Holds(section, "<th scope=\"row\">open&lt;water&gt;</th><td class=\"words\">-</td><td>-</td>"));
}

TEST(WriteHtml, MethodsThatArePrintedTheSameWinTogether) {
  auto results = MadeUpResults();
  results.methods[1].by_scene["rain"].sum_iou = 4 * 0.80199;
  const auto section = SectionOf(PageOf(results), "summary");
  EXPECT_TRUE(Holds(
      section, "<th scope=\"row\">rain</th><td class=\"words\">ours, paper W=512</td><td>80.2</td><td class=\"words\">paper W=512 without BFS</td>"));
  EXPECT_TRUE(Holds(section, "Scenes won: ours 2, paper W=512 1."));
}

TEST(WriteHtml, TableOneHoldsIouAndTimesAndADashWhereThereIsNoObject) {
  const auto section = SectionOf(PageOf(MadeUpResults()), "table-1");
  // Mean over the two scenes with objects, then by scene; the best of the column is marked.
  EXPECT_TRUE(Holds(section,
                    "<th scope=\"row\" class=\"ours\">ours</th><td class=\"h8 best\">85.2</td><td class=\"h9 best\">90.2</td><td>-</td><td "
                    "class=\"h8\">80.2</td>"));
  // Nearest rank of 12 turns, four of them over open water; of four turns in each scene.
  EXPECT_TRUE(Holds(section, "<td class=\"two\">1.25\n2.50</td><td class=\"two\">1.25\n2.50</td><td class=\"two\">0.50\n0.50</td>"));
}

TEST(WriteHtml, OtherTablesHoldTheirNumbers) {
  const auto page = PageOf(MadeUpResults());
  const auto water = SectionOf(page, "water");
  EXPECT_TRUE(Holds(water, "<td class=\"h8 best\">80.2</td><td class=\"h8 best\">85.2</td>"));            // in the water alone
  EXPECT_TRUE(Holds(water, "<td class=\"h8 best\">87.5</td><td class=\"h8 best\">87.5</td><td>-</td>"));  // things with a segment
  EXPECT_TRUE(Holds(water, "<td class=\"h8\">80.2</td><td class=\"h9\">90.2</td>"));                      // buoy, shore
  const auto segments = SectionOf(page, "segments");
  EXPECT_TRUE(Holds(segments, "<td>0.50</td><td>0.75</td><td>0.00</td><td>0.75</td>"));
  EXPECT_TRUE(Holds(segments, "<td>2.0</td><td>12.5</td><td>25.0</td><td>93.7</td>"));
  EXPECT_TRUE(Holds(SectionOf(page, "table-2"), "<th scope=\"row\">512</th><td>90.2</td><td>1563</td><td>5580</td><td>0.079</td><td>-</td>"));
  EXPECT_TRUE(Holds(SectionOf(page, "ablation"), "<th scope=\"row\">paper W=512 without BFS</th><td>15.0</td>"));
  EXPECT_TRUE(Holds(SectionOf(page, "ablation"), "<th scope=\"row\">paper W=512</th><td>55.5</td><td>461.0</td>")) << "components, mean over scenes";
  EXPECT_TRUE(Holds(SectionOf(page, "ablation"), "<th scope=\"row\">paper W=512 without BFS</th><td>15.0</td><td>-</td>"));
  EXPECT_FALSE(Holds(SectionOf(page, "ablation"), ">ours</th>"));
  const auto curves = SectionOf(page, "curves");
  for (const auto* text : {"Test &lt;1&gt;", "own &amp; sure from 6.3 m", "<td>3.25</td>"}) EXPECT_TRUE(Holds(curves, text)) << text;
  EXPECT_TRUE(Holds(SectionOf(page, "range"), "<th scope=\"row\">5.00</th><td>62.50</td>"));
  EXPECT_TRUE(Holds(SectionOf(page, "range"), "<th scope=\"row\">25.00</th><td>25.00</td>"));
  EXPECT_TRUE(Holds(SectionOf(page, "range"), "<th scope=\"row\">dense: buoy</th><td class=\"h7\">75</td>"));
  EXPECT_TRUE(Holds(SectionOf(page, "range"), "<th scope=\"row\">dense: shore</th><td class=\"h9\">100</td>"));
}

TEST(WriteHtml, OursIsHeldAgainstTheBestPeerOfEachScene) {
  auto results = MadeUpResults();
  EXPECT_FALSE(Holds(PageOf(results), "best tuned peer")) << "there is none";
  results.methods[1].method = "Euclidean (tuned)";
  results.methods[2].method = "F3D";
  const auto section = SectionOf(PageOf(results), "summary");
  // 9.8 of 69.3, 19.8 of 19.7; the mean: 14.8 of 44.5.
  EXPECT_TRUE(Holds(
      section,
      "<th scope=\"row\">dense</th><td>90.2</td><td>0.75</td><td class=\"words\">Euclidean (tuned)</td><td>30.7</td><td>0.75</td><td>14.1</td>"));
  EXPECT_TRUE(Holds(
      section,
      "<th scope=\"row\">rain</th><td>80.2</td><td>0.75</td><td class=\"words\">Euclidean (tuned)</td><td>80.3</td><td>0.75</td><td>100.5</td>"));
  EXPECT_TRUE(Holds(section, "<td class=\"total\">33.3</td>"));
}

TEST(WriteHtml, AnotherWorldStandsBesideOursOrSaysThatItIsNotHere) {
  auto results = MadeUpResults();
  auto other = MadeUpResults();
  other.world = "second world";
  other.methods[0].by_scene["dense"] = MadeUpScore(0.602, 1.0);
  results.other_worlds = {other};
  const auto page = PageOf(results);
  EXPECT_EQ(FaultOf(page), "");
  // Mean and scenes of ours, then those of the other.
  EXPECT_TRUE(Holds(SectionOf(page, "table-1"), "<td class=\"h8\">80.2</td><td class=\"h7 best\">70.2</td><td class=\"h6 best\">60.2</td>"));
  for (const auto* section : {"summary", "range", "table-2", "table-3", "ablation", "worst"}) {
    EXPECT_TRUE(Holds(SectionOf(page, section), "<h3>second world</h3>")) << section;
  }
  results.other_worlds[0] = {};
  results.other_worlds[0].world = "second world";
  results.other_worlds[0].is_here = false;
  const auto without = PageOf(results);
  EXPECT_EQ(FaultOf(without), "");
  EXPECT_TRUE(Holds(SectionOf(without, "run"), "<dt>second world</dt><dd>not here</dd>"));
}

TEST(WriteHtml, MethodsThatLookAheadOnlyDoNotWin) {
  auto results = MadeUpResults();
  results.methods[0].by_scene["dense"].num_not_scored = 1;
  const auto section = SectionOf(PageOf(results), "summary");
  EXPECT_TRUE(Holds(section, "Highest mean mIoU over the scenes: paper W=512 with 55.5 %"));
  EXPECT_TRUE(Holds(section, "<th scope=\"row\">dense</th><td class=\"words\">paper W=512</td>"));
  const auto table = SectionOf(PageOf(results), "table-1");
  EXPECT_TRUE(Holds(table, "ours</th><td class=\"h8\">85.2</td><td class=\"h9\">90.2</td>"));
  EXPECT_TRUE(Holds(table, "<td class=\"h5 best\">55.5</td><td class=\"h3 best\">30.7</td>"));
}

TEST(WriteHtml, SeldomBinsAreNotDrawnButListed) {
  auto results = MadeUpResults();
  results.methods[0].by_scene["dense"].iou_by_range = {{0, {1000, 900.0}}};
  results.methods[0].by_scene["rain"].iou_by_range.clear();
  const auto without = SectionOf(PageOf(results), "range");
  results.methods[0].by_scene["dense"].iou_by_range[9] = {1, 0.25};
  const auto section = SectionOf(PageOf(results), "range");
  EXPECT_EQ(section.substr(0, section.find("<details>")), without.substr(0, without.find("<details>")));
  EXPECT_FALSE(Holds(without, "<th scope=\"row\">95.00</th>"));
  EXPECT_TRUE(Holds(section, "<th scope=\"row\">95.00</th><td>25.00</td>"));
}

TEST(WriteHtml, StagesStandInTheOrderOfTheWork) {
  const auto section = SectionOf(PageOf(MadeUpResults()), "table-3");
  const auto project = section.find("<td class=\"words\">project</td><td>0.125</td>");
  const auto cluster = section.find("<td class=\"words\">cluster</td><td>0.250</td><td>0.500</td><td>0.375</td><td>0.125</td>");
  ASSERT_NE(project, std::string::npos);
  ASSERT_NE(cluster, std::string::npos);
  EXPECT_LT(project, cluster);
  EXPECT_LT(cluster, section.find("zeal"));
}

TEST(WriteHtml, EmptyResultsGiveAPageThatSaysSo) {
  const auto page = PageOf(Results{});
  EXPECT_EQ(FaultOf(page), "");
  EXPECT_TRUE(Holds(page, "No method was judged"));
  EXPECT_EQ(SectionOf(page, "table-1"), "");
  EXPECT_NE(SectionOf(page, "definitions"), "");
}

TEST(WriteHtml, WhatIsNotANumberIsADash) {
  auto results = MadeUpResults();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (auto& method : results.methods) {
    for (auto& [scene, score] : method.by_scene) {
      score.sum_iou = score.sum_water_iou = nan;
      score.time_ms = {nan};
    }
    method.worst.clear();
  }
  results.methods.push_back({"method without scenes", {}, {}, {}});
  results.curves.push_back({"nothing", "x", "y", {{"a", {{nan, nan}}}, {"b", {}}}, ""});
  const auto page = PageOf(results);
  EXPECT_EQ(FaultOf(page), "");
  EXPECT_FALSE(Holds(page, "nan"));
  EXPECT_TRUE(Holds(SectionOf(page, "table-1"), "<td>-</td>"));
}

}  // namespace
}  // namespace lookout::eval
