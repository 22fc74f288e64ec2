// The page as a browser shows it.
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "tests/unit/eval_report/made_up.hpp"
#include "tests/unit/eval_report/page_in_browser.hpp"

namespace lookout::eval {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// The figure of a curve of its own.
std::string CurveOf(const std::vector<Curve::Line>& lines) {
  Results results;
  results.curves = {{"t", "x", "y", lines, ""}};
  return SectionOf(PageOf(results), "curves");
}

bool HasLabel(const std::string& svg, const std::string& label) { return Holds(svg, ">" + label + "</text>"); }

TEST(Page, HasItsSectionsAndALinkToEach) {
  const auto page = PageOf(MadeUpResults());
  int num_links = 0;
  for (auto at = page.find("href=\"#"); at != std::string::npos; at = page.find("href=\"#", at + 1)) {
    const auto id = page.substr(at + 7, page.find('"', at + 7) - at - 7);
    EXPECT_NE(SectionOf(page, id), "") << id;
    ++num_links;
  }
  EXPECT_EQ(num_links, 14);
  EXPECT_EQ(CountOf(page, "<section "), 14);
  EXPECT_FALSE(Holds(page, "NaN"));
  EXPECT_TRUE(Holds(SectionOf(page, "run"), "lookout-eval --scenes 'dense' &lt;&amp;&gt;"));
  EXPECT_TRUE(Holds(SectionOf(page, "run"), "3 a scene (5 to 7), 2.0 s each"));
  EXPECT_TRUE(Holds(SectionOf(page, "run"), "<dt>scans a method</dt><dd>12</dd>"));
}

TEST(Page, HostileTextStaysText) {
  auto results = MadeUpResults();
  const std::string hostile =
      "</script><script>document.body.textContent = \"taken\"</script><img src=x onerror=\"document.body.textContent = 1\"><!--";
  results.command = results.version = results.computer = results.scenes[1] = results.methods[1].method = hostile;
  results.methods[0].stage_ms[hostile] = {1.0};
  results.methods[0].worst[0].scene = hostile;
  results.methods[0].by_scene["dense"].outcomes_by_kind[hostile].count = {1, 1, 0, 0, 0, 0};
  results.methods[0].worst[0].truth.objects[1] = {hostile, hostile, true};
  results.curves[0].title = results.curves[0].note = results.curves[0].lines[0].name = hostile;
  results.other_worlds = {MadeUpResults()};
  results.other_worlds[0].world = hostile;
  results.other_worlds[0].notes = {hostile};
  const auto page = PageOf(results);
  EXPECT_EQ(CountOf(page, "<section "), 14);
  EXPECT_FALSE(Holds(page, "<script"));
  EXPECT_FALSE(Holds(page, "<img"));
  EXPECT_GT(CountOf(page, "&lt;/script&gt;&lt;script&gt;"), 20);
}

// Sweeps run on other seeds than tables.
TEST(Page, ASweepSaysWhichSeedsItRanOn) {
  auto results = MadeUpResults();
  results.curves[0].scans_from = "seeds 1 to 4, 0.6 s each";
  EXPECT_TRUE(Holds(SectionOf(PageOf(results), "curves"), "seeds 1 to 4, 0.6 s each"));
  EXPECT_FALSE(Holds(SectionOf(PageOf(MadeUpResults()), "curves"), "seeds"));
}

TEST(Page, SummaryNamesTheWinnerOfEachScene) {
  const auto section = SectionOf(PageOf(MadeUpResults()), "summary");
  EXPECT_TRUE(Holds(section, "Highest mean mIoU over the scenes: ours with 85.2 %, before paper W=512 with 55.5 %."));
  EXPECT_TRUE(Holds(section, "Scenes won: ours 1, paper W=512 1."));
  EXPECT_TRUE(
      Holds(section,
            "<th scope=\"row\">dense</th><td class=\"words\">ours</td><td>90.2</td><td class=\"words\">paper W=512</td><td>30.7</td><td>59.5</td>"));
  EXPECT_TRUE(Holds(section, "<th scope=\"row\">rain</th><td class=\"words\">paper W=512</td><td>80.3</td>"));
  EXPECT_TRUE(Holds(section, "<th scope=\"row\">open&lt;water&gt;</th><td class=\"words\">-</td><td>-</td>"));
}

TEST(Page, MethodsThatArePrintedTheSameWinTogether) {
  auto results = MadeUpResults();
  results.methods[1].by_scene["rain"].iou.sum = 4 * 0.80199;
  const auto section = SectionOf(PageOf(results), "summary");
  EXPECT_TRUE(Holds(
      section, "<th scope=\"row\">rain</th><td class=\"words\">ours, paper W=512</td><td>80.2</td><td class=\"words\">paper W=512 without BFS</td>"));
  EXPECT_TRUE(Holds(section, "Scenes won: ours 2, paper W=512 1."));
}

TEST(Page, TableOneHoldsIouAndTimesAndADashWhereThereIsNoObject) {
  const auto section = SectionOf(PageOf(MadeUpResults()), "table-1");
  // Mean over the two scenes with objects, then by scene; the best of the column is marked.
  EXPECT_TRUE(Holds(section,
                    "<th scope=\"row\" class=\"ours\">ours</th><td class=\"h8 best\">85.2</td><td class=\"h9 best\">90.2</td><td>-</td><td "
                    "class=\"h8\">80.2</td>"));
  EXPECT_TRUE(Holds(section, "<th scope=\"col\" class=\"upright\"><span>open&lt;water&gt;</span></th>"));
  // Nearest rank of 12 scans, four of them over open water; of four scans in each scene.
  EXPECT_TRUE(Holds(section, "<td class=\"two\">1.25\n2.50</td><td class=\"two\">1.25\n2.50</td><td class=\"two\">0.50\n0.50</td>"));
}

TEST(Page, OtherTablesHoldTheirNumbers) {
  const auto page = PageOf(MadeUpResults());
  const auto water = SectionOf(page, "water");
  EXPECT_TRUE(Holds(water, "<td class=\"h8 best\">80.2</td><td class=\"h8 best\">85.2</td>"));            // in the water alone
  EXPECT_TRUE(Holds(water, "<td class=\"h8 best\">87.5</td><td class=\"h8 best\">87.5</td><td>-</td>"));  // things with a segment
  EXPECT_TRUE(Holds(water, "<td class=\"h8\">80.2</td><td class=\"h9\">90.2</td>"));                      // buoy, shore
  const auto segments = SectionOf(page, "segments");
  EXPECT_TRUE(Holds(segments, "<td>0.50</td><td>0.75</td><td>0.00</td><td>0.75</td>"));
  EXPECT_TRUE(Holds(segments, "<td>2.0</td><td>12.5</td><td>25.0</td><td>93.7</td>"));
  EXPECT_TRUE(Holds(SectionOf(page, "table-2"), "<th scope=\"row\">512</th><td>90.2</td><td>1563</td><td>5580</td><td>0.079</td><td>-</td>"));
  const auto ablation = SectionOf(page, "ablation");
  EXPECT_TRUE(Holds(ablation, "<th scope=\"row\">paper W=512 without BFS</th><td>15.0</td><td>-</td>"));
  EXPECT_TRUE(Holds(ablation, "<th scope=\"row\">paper W=512</th><td>55.5</td><td>461.0</td>")) << "components, mean over scenes";
  EXPECT_FALSE(Holds(ablation, ">ours</th>"));
  const auto curves = SectionOf(page, "curves");
  for (const auto* text : {"Test &lt;1&gt;", "own &amp; sure from 6.3 m", "<td>3.25</td>"}) EXPECT_TRUE(Holds(curves, text)) << text;
  const auto range = SectionOf(page, "range");
  EXPECT_TRUE(Holds(range, "<th scope=\"row\">5.00</th><td>62.50</td>"));
  EXPECT_TRUE(Holds(range, "<th scope=\"row\">25.00</th><td>25.00</td>"));
  EXPECT_TRUE(Holds(range, "<th scope=\"row\">dense: buoy</th><td class=\"h7\">75</td>"));
  EXPECT_TRUE(Holds(range, "<th scope=\"row\">dense: shore</th><td class=\"h9\">100</td>"));
}

TEST(Page, StagesStandInTheOrderOfTheWork) {
  const auto section = SectionOf(PageOf(MadeUpResults()), "table-3");
  const auto project = section.find("<td class=\"words\">project</td><td>0.125</td>");
  const auto cluster = section.find("<td class=\"words\">cluster</td><td>0.250</td><td>0.500</td><td>0.375</td><td>0.125</td>");
  ASSERT_NE(project, std::string::npos);
  ASSERT_NE(cluster, std::string::npos);
  EXPECT_LT(project, cluster);
  EXPECT_LT(cluster, section.find("zeal"));
}

TEST(Page, OurErrorStandsBesideThePeers) {
  auto results = MadeUpResults();
  results.methods[1].method = "Euclidean (tuned)";
  results.methods[2].method = "F3D";
  const auto section = SectionOf(PageOf(results), "summary");
  EXPECT_TRUE(Holds(
      section,
      "<th scope=\"row\">dense</th><td>90.2</td><td>0.75</td><td class=\"words\">Euclidean (tuned)</td><td>30.7</td><td>0.75</td><td>14.1</td>"));
  EXPECT_TRUE(Holds(
      section,
      "<th scope=\"row\">rain</th><td>80.2</td><td>0.75</td><td class=\"words\">Euclidean (tuned)</td><td>80.3</td><td>0.75</td><td>100.5</td>"));
  EXPECT_TRUE(Holds(section, "<td class=\"total\">33.3</td>"));
}

TEST(Page, AnotherWorldStandsBesideOursOrSaysThatItIsNotHere) {
  auto results = MadeUpResults();
  auto other = MadeUpResults();
  other.world = "second world";
  other.methods[0].by_scene["dense"] = MadeUpScore(0.602, 1.0);
  results.other_worlds = {other};
  const auto page = PageOf(results);
  // Mean and scenes of ours, then those of the other.
  EXPECT_TRUE(Holds(SectionOf(page, "table-1"), "<td class=\"h8\">80.2</td><td class=\"h7 best\">70.2</td><td class=\"h6 best\">60.2</td>"));
  for (const auto* section : {"summary", "range", "table-2", "table-3", "ablation", "worst"}) {
    EXPECT_TRUE(Holds(SectionOf(page, section), "<h3>second world</h3>")) << section;
  }
  results.other_worlds[0] = {};
  results.other_worlds[0].world = "second world";
  results.other_worlds[0].is_here = false;
  EXPECT_TRUE(Holds(SectionOf(PageOf(results), "run"), "<dt>second world</dt><dd>not here</dd>"));
}

TEST(Page, MethodsThatLookAheadOnlyDoNotWin) {
  auto results = MadeUpResults();
  results.methods[0].by_scene["dense"].num_not_scored = 1;
  const auto page = PageOf(results);
  EXPECT_TRUE(Holds(SectionOf(page, "summary"), "Highest mean mIoU over the scenes: paper W=512 with 55.5 %"));
  EXPECT_TRUE(Holds(SectionOf(page, "summary"), "<th scope=\"row\">dense</th><td class=\"words\">paper W=512</td>"));
  const auto table = SectionOf(page, "table-1");
  EXPECT_TRUE(Holds(table, "ours</th><td class=\"h8\">85.2</td><td class=\"h9\">90.2</td>"));
  EXPECT_TRUE(Holds(table, "<td class=\"h5 best\">55.5</td><td class=\"h3 best\">30.7</td>"));
}

TEST(Page, SeldomBinsAreNotDrawnButListed) {
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

TEST(Page, EmptyResultsGiveAPageThatSaysSo) {
  const auto page = PageOf(Results{});
  EXPECT_TRUE(Holds(page, "No method was evaluated"));
  EXPECT_EQ(SectionOf(page, "table-1"), "");
  EXPECT_NE(SectionOf(page, "definitions"), "");
}

TEST(Page, WhatIsNotANumberIsADash) {
  auto results = MadeUpResults();
  for (auto& method : results.methods) {
    for (auto& [scene, score] : method.by_scene) {
      score.iou.sum = score.water_iou.sum = kNan;
      score.time_ms = {kNan};
    }
    method.worst.clear();
  }
  results.methods.push_back({"method without scenes", {}, {}, {}});
  results.curves.push_back({"nothing", "x", "y", {{"a", {{kNan, kNan}}}, {"b", {}}}, ""});
  const auto page = PageOf(results);
  EXPECT_FALSE(Holds(page, "NaN"));
  EXPECT_TRUE(Holds(SectionOf(page, "table-1"), "<td>-</td>"));
  EXPECT_TRUE(Holds(SectionOf(page, "curves"), "<p>no numbers</p>"));
}

// printf rounds an exact half to even; so do the tables on the terminal and in CSV files.
TEST(Page, NumbersAreRoundedAsInTheTables) {
  const auto figure = CurveOf({{"a", {{0.125, 0.375}, {1.0, 1.005}, {2.0, -2.675}, {3.0, 0.5}}}});
  EXPECT_TRUE(Holds(figure, "<th scope=\"row\">0.12</th><td>0.38</td>"));
  EXPECT_TRUE(Holds(figure, "<th scope=\"row\">1.00</th><td>1.00</td>"));
  EXPECT_TRUE(Holds(figure, "<th scope=\"row\">2.00</th><td>-2.67</td>"));
}

// Of the markup from a label on: an attribute of each of the elements within the group of that label.
std::vector<double> NumbersOf(const std::string& figure, const std::string& label, const std::string& attribute) {
  std::vector<double> numbers;
  const auto begin = figure.find("<g aria-label=\"" + label + "\"");
  if (begin == std::string::npos) return numbers;
  const auto group = figure.substr(begin, figure.find("</g>", begin) - begin);
  const auto name = " " + attribute + "=\"";
  for (auto at = group.find(name, group.find('>')); at != std::string::npos; at = group.find(name, at + 1)) {
    numbers.push_back(std::stod(group.substr(at + name.size())));
  }
  return numbers;
}

TEST(Reliability, DotsAndBarsAreWhereTheNumbersOfTheTableSay) {
  const auto section = SectionOf(PageOf(MadeUpResults()), "reliability");
  EXPECT_EQ(CountOf(section, "<figure"), 1) << "the others state no probability";
  EXPECT_TRUE(Holds(section, "<th scope=\"row\">0.0 to 0.1</th><td>2</td><td>0.050</td><td>0.000</td>"));
  EXPECT_TRUE(Holds(section, "<th scope=\"row\">0.3 to 0.4</th><td>0</td><td>-</td><td>-</td>"));
  EXPECT_TRUE(Holds(section, "<th scope=\"row\">0.8 to 0.9</th><td>100</td><td>0.850</td><td>0.800</td>"));
  EXPECT_TRUE(Holds(section, "<th scope=\"row\">0.9 to 1.0</th><td>1</td><td>1.000</td><td>1.000</td>"));

  // The line from (0, 0) to (1, 1) is the scale.
  const auto diagonal = section.substr(section.find(" d=\"M", section.find("<g aria-label=\"line\"")) + 4);
  double left = 0.0;
  double bottom = 0.0;
  double right = 0.0;
  double top = 0.0;
  ASSERT_EQ(std::sscanf(diagonal.c_str(), "M%lf,%lfL%lf,%lf", &left, &bottom, &right, &top), 4) << diagonal.substr(0, 80);
  const auto x = NumbersOf(section, "dot", "cx");
  const auto y = NumbersOf(section, "dot", "cy");
  const std::vector<std::pair<double, double>> expected{{0.05, 0.0}, {0.85, 0.8}, {1.0, 1.0}};
  ASSERT_EQ(x.size(), expected.size()) << "an empty bin has no dot";
  ASSERT_EQ(y.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR((x[i] - left) / (right - left), expected[i].first, 1e-3);
    EXPECT_NEAR((y[i] - bottom) / (top - bottom), expected[i].second, 1e-3);
  }

  const auto heights = NumbersOf(section, "rect", "height");
  ASSERT_EQ(heights.size(), 3U) << "an empty bin has no bar";
  EXPECT_NEAR((heights[0] + 4.0) / (heights[1] + 4.0), std::log1p(2.0) / std::log1p(100.0), 0.01) << "4 pixels are the space around a bar";
  EXPECT_NEAR((heights[2] + 4.0) / (heights[1] + 4.0), std::log1p(1.0) / std::log1p(100.0), 0.01);
  for (const auto* count : {"2", "100", "1"}) EXPECT_TRUE(HasLabel(section, count)) << count;
}

TEST(Reliability, OfScenesIsFoldedAway) {
  auto results = MadeUpResults();
  auto& scenes = results.methods[0].by_scene;
  scenes["rain"].confidence.segments = {{300, {900, 30, 270.0}}};
  scenes["rain"].confidence.num_scans = 4;
  const auto section = SectionOf(PageOf(results), "reliability");
  EXPECT_EQ(CountOf(section, "<figure"), 3);
  const auto folded = section.substr(section.find("<summary>By scene</summary>"));
  EXPECT_EQ(CountOf(folded, "<figure"), 2);
  EXPECT_TRUE(Holds(folded, "<figcaption>rain</figcaption>"));
  EXPECT_TRUE(HasLabel(folded, "900"));
  EXPECT_TRUE(Holds(folded, "<th scope=\"row\">0.8 to 0.9</th><td>100</td>"));
}

TEST(Reliability, WithoutSegmentsIsDrawnWithoutNan) {
  auto results = MadeUpResults();
  auto& confidence = results.methods[0].by_scene["dense"].confidence;
  confidence.segments.clear();
  const auto empty = SectionOf(PageOf(results), "reliability");
  EXPECT_FALSE(Holds(empty, "NaN"));
  EXPECT_FALSE(Holds(empty, "Infinity"));
  EXPECT_TRUE(NumbersOf(empty, "dot", "cx").empty());
  EXPECT_TRUE(NumbersOf(empty, "rect", "height").empty());
  confidence.num_scans = 0;
  EXPECT_EQ(SectionOf(PageOf(results), "reliability"), "") << "no method states a probability";
}

TEST(Page, SaysWhatBecameOfThingsThatWereLost) {
  const auto section = SectionOf(PageOf(MadeUpResults()), "lost");
  EXPECT_TRUE(Holds(section, "ours</th><td>18</td><td>33.33</td><td>5.56</td><td>5.56</td><td>22.22</td><td>0.00</td><td>0.00</td>"));
  EXPECT_TRUE(Holds(section, "dock</th><td>10</td><td>50.00</td><td>10.00</td><td>0.00</td><td>40.00</td><td>0.00</td><td>0.00</td>"));
}

TEST(Lines, AxesHaveRoundNumbersAroundThePoints) {
  const auto figure = CurveOf({{"a", {{0.6, 3.0}, {0.95, 11.0}}}});
  for (const auto* label : {"0.60", "0.70", "0.95", "0", "2", "12"}) EXPECT_TRUE(HasLabel(figure, label)) << label;
  EXPECT_FALSE(HasLabel(figure, "14"));
}

TEST(Lines, NumberThatIsNoneBreaksTheLine) {
  const auto path_of = [](const std::string& figure) {
    const auto at = figure.find("<path d=\"", figure.find("aria-label=\"line\""));
    return figure.substr(at, figure.find("\"></path>", at) - at);
  };
  const auto whole = path_of(CurveOf({{"a", {{0.0, 1.0}, {1.0, 2.0}, {2.0, 3.0}}}}));
  EXPECT_EQ(CountOf(whole, "M"), 1) << whole;
  EXPECT_EQ(CountOf(whole, "L"), 2) << whole;
  const auto broken = path_of(CurveOf({{"a", {{0.0, 1.0}, {1.0, kNan}, {2.0, 3.0}}}}));
  EXPECT_EQ(CountOf(broken, "M"), 2) << broken;
  EXPECT_EQ(CountOf(broken, "L"), 0) << broken;
}

TEST(Lines, OnePointOrAllTheSameOrHugeOrNoneIsDrawnWithoutNan) {
  Results results;
  for (const double value : {0.0, -3.0, 7.25, 9e11, -9e11, 1e-9, 1e300, kNan, std::numeric_limits<double>::infinity()}) {
    results.curves.push_back({"t", "x", "y", {{"a", {{value, value}}}, {"empty", {}}}, ""});
  }
  results.curves.push_back({});
  const auto section = SectionOf(PageOf(results), "curves");
  EXPECT_FALSE(Holds(section, "NaN"));
  EXPECT_FALSE(Holds(section, "Infinity"));
  EXPECT_EQ(CountOf(section, "<figure>"), 10);
  EXPECT_EQ(CountOf(section, "<p>no numbers</p>"), 4);
}

TEST(Lines, ThirtyFiveSeriesLookDifferent) {
  const auto figure = CurveOf(std::vector<Curve::Line>(35, {"a", {{0.0, 1.0}}}));
  std::set<std::string> keys;
  int count = 0;
  for (auto at = figure.find("<li>"); at != std::string::npos; at = figure.find("<li>", at + 1), ++count) {
    const auto key = figure.substr(at, figure.find("</li>", at) - at);
    keys.insert(key.substr(key.find("aria-label=\"line\"")));
  }
  EXPECT_EQ(count, 35);
  EXPECT_EQ(keys.size(), 35U);
}

TEST(Bars, AreAsLongAsTheirNumbersAndLongNamesAreCut) {
  Results results;
  results.scenes = {"s"};
  for (const auto& [name, components] : {std::pair{std::string("<b> without BFS"), 10}, {"<b>", 20}, {std::string(200, 'x') + " without y", 0}}) {
    MethodResult method;
    method.method = name;
    auto& score = method.by_scene["s"];
    score.segments.count = 1;
    if (components > 0) score.components.Add(components);
    results.methods.push_back(method);
  }
  const auto section = SectionOf(PageOf(results), "ablation");
  EXPECT_TRUE(Holds(section, "<p>no numbers</p>")) << "there are no times";
  const auto figure = section.substr(section.find("Components of a scan"));
  std::vector<double> widths;
  for (auto at = figure.find("<rect "); at != std::string::npos; at = figure.find("<rect ", at + 1)) {
    widths.push_back(std::stod(figure.substr(figure.find("width=\"", at) + 7)));
  }
  ASSERT_EQ(widths.size(), 2U);
  EXPECT_NEAR(widths[1], 2.0 * widths[0], 0.2);
  EXPECT_TRUE(HasLabel(figure, "-"));
  EXPECT_TRUE(HasLabel(figure, "20"));
  EXPECT_TRUE(HasLabel(figure, "&lt;b&gt;"));
  EXPECT_TRUE(HasLabel(figure, std::string(44, 'x') + "..."));
}

}  // namespace
}  // namespace lookout::eval
