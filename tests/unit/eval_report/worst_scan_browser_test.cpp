// Pictures of the worst scans, as a browser shows them.
#include <cstdint>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "tests/unit/eval_report/made_up.hpp"
#include "tests/unit/eval_report/page_in_browser.hpp"

namespace lookout::eval {
namespace {

std::string WorstOf(const WorstScan& worst) {
  auto results = MadeUpResults();
  results.methods[0].worst = {worst};
  return SectionOf(PageOf(results), "worst");
}

// The markup of the second plan.
std::string PredictionOf(const std::string& figure) { return figure.substr(figure.find("<p>Prediction</p>")); }

enum class Strokes { kDots, kOutlines, kDashed };

// Data of the paths of a colour in a plan.
std::vector<std::string> PathsOf(const std::string& markup, const std::string& colour, Strokes strokes) {
  std::vector<std::string> paths;
  const auto head = "<g aria-label=\"geo\" fill=\"none\" stroke=\"var(--" + colour + ")\"";
  const std::string data = "d=\"";
  for (auto at = markup.find(head); at != std::string::npos; at = markup.find(head, at + 1)) {
    const auto attributes = markup.substr(at, markup.find('>', at) - at);
    const auto kind = Holds(attributes, "stroke-width=\"3\"")       ? Strokes::kDots
                      : Holds(attributes, "stroke-dasharray=\"3.5") ? Strokes::kDashed
                                                                    : Strokes::kOutlines;
    const auto begin = markup.find(data, at) + data.size();
    if (kind == strokes) paths.push_back(markup.substr(begin, markup.find('"', begin) - begin));
  }
  return paths;
}

TEST(WorstScan, SaysWhatIsSeen) {
  const auto section = WorstOf(MadeUpScan({1, 1, 1, 2, 0, 0, -1}, {1, 1, 2, 0, 3, 0, 0}));
  EXPECT_TRUE(Holds(section, "ours: rain, seed 7, scan 3, mIoU 12.5 %; 2 objects, 3 segments, of these 1 false"));
  EXPECT_TRUE(Holds(section, "&lt;Anna&gt;"));
  EXPECT_EQ(CountOf(section, " plan\""), 2);
}

TEST(WorstScan, TableHoldsTheIouOfEachObjectWorstFirst) {
  const auto section = WorstOf(MadeUpScan({1, 1, 1, 2, 2}, {1, 1, 2, 0, 0}));
  const auto shore = section.find("<td class=\"words\">shore</td><td>2</td><td>0</td><td>0.0</td>");
  const auto kayak = section.find("<td class=\"words\">kayak</td><td>3</td><td>2</td><td>66.7</td>");
  ASSERT_NE(shore, std::string::npos);
  ASSERT_NE(kayak, std::string::npos);
  EXPECT_LT(shore, kayak);
}

TEST(WorstScan, RightIsRightAndForwardIsUp) {
  // Ahead, and to the right of it.
  const auto section = WorstOf(MadeUpScan({1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2}, std::vector<std::int32_t>(21, 0)));
  const auto ahead = PathsOf(section, "s0", Strokes::kDots);
  const auto aside = PathsOf(section, "s1", Strokes::kDots);
  ASSERT_EQ(ahead.size(), 1U);
  ASSERT_EQ(aside.size(), 1U);
  const auto x = [](const std::string& path) { return std::stod(path.substr(1)); };
  const auto y = [](const std::string& path) { return std::stod(path.substr(path.find(',') + 1)); };
  EXPECT_LT(x(ahead[0]), x(aside[0]));
  EXPECT_LT(y(ahead[0]), y(aside[0])) << "y of the screen grows downwards";
}

TEST(WorstScan, SameObjectHasTheSameColourInBothPlansWhateverTheLabelsAre) {
  for (const std::int32_t label : {1, 17}) {
    const auto section = WorstOf(MadeUpScan({2, 2, 2, 0, 1, 1, 1}, {label, label, label, 0, 5, 5, 5}));
    // The object of the lesser bearing is the first.
    for (const auto* colour : {"s0", "s1"}) {
      const auto paths = PathsOf(section, colour, Strokes::kDots);
      ASSERT_EQ(paths.size(), 2U) << colour;
      EXPECT_EQ(paths[0], paths[1]);
      EXPECT_TRUE(PathsOf(section, colour, Strokes::kDashed).empty());
    }
  }
}

TEST(WorstScan, PieceOfAnObjectIsDashedAndFalseSegmentIsOutlined) {
  const auto prediction = PredictionOf(WorstOf(MadeUpScan({1, 1, 1, 0, 0, 0}, {1, 1, 2, 0, 3, 3})));
  const auto dashed = PathsOf(prediction, "s0", Strokes::kDashed);
  ASSERT_EQ(dashed.size(), 1U);
  EXPECT_EQ(CountOf(dashed[0], "L"), 4) << "one return: a square";
  const auto outline = PathsOf(prediction, "text", Strokes::kOutlines);
  ASSERT_EQ(outline.size(), 1U);
  EXPECT_EQ(CountOf(outline[0], "M"), 1);
}

TEST(WorstScan, OfHundredsOfPiecesTheLargestAreOutlined) {
  // 5 pieces of 20 returns, then 260 of one.
  std::vector<std::int32_t> label;
  for (int i = 0; i < 100; ++i) label.push_back(1 + i / 20);
  for (int i = 0; i < 260; ++i) label.push_back(6 + i);
  const auto dashed = PathsOf(PredictionOf(WorstOf(MadeUpScan(std::vector<std::int32_t>(label.size(), 1), label))), "s0", Strokes::kDashed);
  ASSERT_EQ(dashed.size(), 1U);
  EXPECT_EQ(CountOf(dashed[0], "M"), 4) << "the fifth of 20 is the object's best";
}

TEST(WorstScan, OneSegmentOverTwoObjectsBearsBothNumbers) {
  const auto prediction = PredictionOf(WorstOf(MadeUpScan({1, 1, 1, 2, 2}, {1, 1, 1, 1, 1})));
  EXPECT_TRUE(Holds(prediction, ">1+2</text>"));
  EXPECT_TRUE(PathsOf(prediction, "s1", Strokes::kDots).empty());
}

TEST(WorstScan, WhatIsNotScoredBelongsToNoObject) {
  const auto section = WorstOf(MadeUpScan({1, 1, 2, 2}, {1, 1, kNotScored, kNotScored}));
  EXPECT_TRUE(Holds(section, "; 1 objects, 1 segments, of these 0 false"));
  EXPECT_FALSE(Holds(section, "<td class=\"words\">shore</td>"));
}

TEST(WorstScan, EmptyScanIsDrawnAndOneWhoseArraysDifferInSizeIsNot) {
  auto results = MadeUpResults();
  results.methods[0].worst = {MadeUpScan({}, {}), MadeUpScan({0, 0}, {0, 0}), WorstScan{}, MadeUpScan({1, 1}, {1, 1})};
  results.methods[0].worst[3].label.pop_back();
  const auto section = SectionOf(PageOf(results), "worst");
  EXPECT_FALSE(Holds(section, "NaN"));
  EXPECT_EQ(CountOf(section, " plan\""), 6);
  EXPECT_EQ(CountOf(section, "Not drawn: the scan, its truth and its labels differ in size."), 1);
}

}  // namespace
}  // namespace lookout::eval
