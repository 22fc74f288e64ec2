#include "tools/eval/plot.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <limits>

#include "tests/unit/eval_report/markup.hpp"

namespace lookout::eval {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool HasLabel(const std::string& svg, const std::string& label) { return Holds(svg, ">" + label + "</text>"); }

TEST(DrawLines, AxesHaveRoundNumbersAroundThePoints) {
  const auto svg = DrawLines({"t", "x", "y", {{"a", {{0.6, 3.0}, {0.95, 11.0}}}}});
  EXPECT_EQ(FaultOf(svg), "");
  for (const auto* label : {"0.6", "0.7", "1.0", "0", "2", "12"}) EXPECT_TRUE(HasLabel(svg, label)) << label;
  EXPECT_FALSE(HasLabel(svg, "14"));
}

TEST(DrawLines, PercentAxisDoesNotDependOnThePoints) {
  const auto svg = DrawLines({"t", "x", "y", {{"a", {{0.0, 50.0}, {1.0, 51.0}}}}, true});
  for (const auto* label : {"0", "20", "100"}) EXPECT_TRUE(HasLabel(svg, label)) << label;
}

TEST(DrawLines, NumberThatIsNoneBreaksTheLine) {
  const auto path_of = [](const std::string& svg) {
    const auto at = svg.find("<path class=\"line");
    return svg.substr(at, svg.find("/>", at) - at);
  };
  const auto whole = path_of(DrawLines({"t", "x", "y", {{"a", {{0.0, 1.0}, {1.0, 2.0}, {2.0, 3.0}}}}}));
  EXPECT_EQ(CountOf(whole, "M"), 1);
  EXPECT_EQ(CountOf(whole, "L"), 2);
  const auto broken = path_of(DrawLines({"t", "x", "y", {{"a", {{0.0, 1.0}, {1.0, kNan}, {2.0, 3.0}}}}}));
  EXPECT_EQ(CountOf(broken, "M"), 2);
  EXPECT_EQ(CountOf(broken, "L"), 0);
}

TEST(DrawLines, OnePointOrAllTheSameOrHugeOrNoneIsDrawnWithoutNan) {
  for (const double value : {0.0, -3.0, 7.25, 9e11, -9e11, 1e-9, 1e300, kNan, kInfinity, -kInfinity}) {
    const auto svg = DrawLines({"t", "x", "y", {{"a", {{value, value}}}, {"empty", {}}}});
    EXPECT_EQ(FaultOf(svg), "") << value;
    EXPECT_FALSE(Holds(svg, "nan")) << value;
    EXPECT_FALSE(Holds(svg, "inf")) << value;
    EXPECT_LT(svg.size(), 10000U) << value;
  }
  EXPECT_TRUE(Holds(DrawLines({}), "no numbers"));
}

TEST(DrawLines, ThirtyFiveSeriesLookDifferent) {
  std::vector<LineChart::Line> lines(35, {"a", {}});
  const auto legend = LegendOfLines(lines);
  EXPECT_EQ(FaultOf(legend), "");
  std::vector<std::string> keys;
  for (auto at = legend.find("class=\"marker"); at != std::string::npos; at = legend.find("class=\"marker", at + 1)) {
    keys.push_back(legend.substr(at, legend.find("/>", at) - at));
  }
  ASSERT_EQ(keys.size(), 35U);
  std::ranges::sort(keys);
  EXPECT_EQ(std::unique(keys.begin(), keys.end()), keys.end());
}

TEST(DrawBars, BarsAreAsLongAsTheirNumbers) {
  const auto svg = DrawBars({"t", "ms", {"median"}, {{"a", {10.0}}, {"b", {20.0}}, {"c", {kNan}}}, 1});
  EXPECT_EQ(FaultOf(svg), "");
  std::vector<double> widths;
  for (auto at = svg.find("width=\""); at != std::string::npos; at = svg.find("width=\"", at + 1)) widths.push_back(std::stod(svg.substr(at + 7)));
  ASSERT_EQ(widths.size(), 2U);
  EXPECT_NEAR(widths[1], 2.0 * widths[0], 0.2);
  EXPECT_TRUE(HasLabel(svg, "-"));
  EXPECT_TRUE(HasLabel(svg, "20.0"));
}

TEST(DrawBars, LongNamesAreCutAndTextIsEscaped) {
  const auto svg = DrawBars({"<t>", "&", {"s"}, {{std::string(200, 'x'), {1.0}}, {"<b>", {0.0}}}, 1});
  EXPECT_EQ(FaultOf(svg), "");
  EXPECT_FALSE(Holds(svg, std::string(50, 'x')));
  EXPECT_TRUE(Holds(svg, "xxx..."));
  EXPECT_TRUE(Holds(svg, "&lt;b&gt;"));
}

TEST(DrawBars, WithoutNumbersSaysSo) {
  EXPECT_TRUE(Holds(DrawBars({}), "no numbers"));
  EXPECT_TRUE(Holds(DrawBars({"t", "x", {"s"}, {{"a", {kNan}}}, 1}), "no numbers"));
}

TEST(DrawFromAbove, RightIsRightAndForwardIsUp) {
  const auto svg = DrawFromAbove({"t", {{"s0", {{5.0, 8.0}}}}, {}, {}, {-10.0, -10.0}, {10.0, 10.0}});
  EXPECT_EQ(FaultOf(svg), "");
  EXPECT_TRUE(Holds(svg, "d=\"M344 46h0\""));  // of 460, in steps of two: three quarters to the right, a tenth from the top
}

TEST(DrawFromAbove, DotsOnOnePlaceAreDrawnOnceAndThoseOutsideNotAtAll) {
  const auto svg = DrawFromAbove({"t", {{"s0", {{1.0, 1.0}, {1.001, 1.0}, {50.0, 0.0}, {kNan, 0.0}}}}, {}, {}, {-10.0, -10.0}, {10.0, 10.0}});
  EXPECT_EQ(CountOf(svg, "h0"), 1);
}

TEST(DrawFromAbove, NeighboursBecomeOneStroke) {
  // A step of dots is 2 of 460 for 20 m. One stroke down, one aside, and a dot by itself, from the end of the stroke before.
  constexpr double kStepM = 20.0 / 230.0;
  std::vector<ScatterFromAbove::Spot> spots;
  for (int i = 0; i < 4; ++i) spots.emplace_back(0.001, -0.001 - i * kStepM);
  for (int i = 0; i < 3; ++i) spots.emplace_back(5.001 + i * kStepM, -0.001);
  spots.emplace_back(8.001, -0.001);
  const auto svg = DrawFromAbove({"t", {{"s0", spots}}, {}, {}, {-10.0, -10.0}, {10.0, 10.0}});
  EXPECT_TRUE(Holds(svg, "d=\"M230 230v6m114-6h4m66 0h0\"")) << svg;
}

TEST(DrawFromAbove, OutlineOfOneCornerIsASquare) {
  const auto svg = DrawFromAbove({"t",
                                  {},
                                  {{"false", false, {{{1.0, 1.0}}, {{2.0, 2.0}}}}, {"s1", true, {{{1.0, 1.0}, {2.0, 2.0}}}}, {"s2", false, {{}}}},
                                  {{"<1>", {0.0, 0.0}}}});
  EXPECT_EQ(FaultOf(svg), "");
  EXPECT_EQ(CountOf(svg, "<path class=\"outline false\""), 1) << "all of one colour are one path";
  EXPECT_EQ(CountOf(svg, "h8v8h-8z"), 2);
  EXPECT_TRUE(Holds(svg, "<path class=\"outline s1 dashed\" d=\"M253 207l23-23z\"/>")) << svg;
  EXPECT_FALSE(Holds(svg, "outline s2"));
  EXPECT_TRUE(HasLabel(svg, "&lt;1&gt;"));
}

}  // namespace
}  // namespace lookout::eval
