#include <gtest/gtest.h>

#include "tests/unit/eval_report/made_up.hpp"
#include "tests/unit/eval_report/markup.hpp"
#include "tools/eval/html_worst_turn.hpp"
#include "tools/eval/method.hpp"

namespace lookout::eval {
namespace {

// The markup of the second plan.
std::string PredictionOf(const std::string& figure) { return figure.substr(figure.find("<p>Prediction</p>")); }

TEST(FigureOfWorstTurn, SaysWhatIsSeen) {
  const auto figure = FigureOfWorstTurn(MadeUpTurn({1, 1, 1, 2, 0, 0, -1}, {1, 1, 2, 0, 3, 0, 0}), "<ours>");
  EXPECT_EQ(FaultOf(figure), "");
  EXPECT_TRUE(Holds(figure, "&lt;ours&gt;: rain, seed 7, turn 3, mIoU 12.5 %; 2 objects, 3 segments, of these 1 false"));
  EXPECT_TRUE(Holds(figure, "&lt;Anna&gt;"));
  EXPECT_EQ(CountOf(figure, "<svg class=\"plan\""), 2);
}

TEST(FigureOfWorstTurn, TableHoldsTheIouOfEachObjectWorstFirst) {
  const auto figure = FigureOfWorstTurn(MadeUpTurn({1, 1, 1, 2, 2}, {1, 1, 2, 0, 0}), "m");
  const auto shore = figure.find("<td class=\"words\">shore</td><td>2</td><td>0</td><td>0.0</td>");
  const auto kayak = figure.find("<td class=\"words\">kayak</td><td>3</td><td>2</td><td>66.7</td>");
  ASSERT_NE(shore, std::string::npos);
  ASSERT_NE(kayak, std::string::npos);
  EXPECT_LT(shore, kayak);
}

TEST(FigureOfWorstTurn, SameObjectHasTheSameColourInBothPlansWhateverTheLabelsAre) {
  for (const std::int32_t label : {1, 17}) {
    const auto figure = FigureOfWorstTurn(MadeUpTurn({2, 2, 2, 0, 1, 1, 1}, {label, label, label, 0, 5, 5, 5}), "m");
    // The object of the lesser bearing is the first.
    EXPECT_EQ(CountOf(figure, "class=\"dots s0\" d=\"M"), 2);
    EXPECT_EQ(CountOf(figure, "class=\"dots s1\" d=\"M"), 2);
    const auto dots = [](const std::string& markup, const char* css_class) {
      const auto at = markup.find(css_class);
      return markup.substr(at, markup.find("/>", at) - at);
    };
    EXPECT_EQ(dots(figure, "dots s0"), dots(PredictionOf(figure), "dots s0"));
    EXPECT_EQ(CountOf(figure, "dashed"), 0);
  }
}

TEST(FigureOfWorstTurn, PieceOfAnObjectIsDashedAndFalseSegmentIsOutlined) {
  const auto figure = PredictionOf(FigureOfWorstTurn(MadeUpTurn({1, 1, 1, 0, 0, 0}, {1, 1, 2, 0, 3, 3}), "m"));
  EXPECT_EQ(CountOf(figure, "class=\"outline s0 dashed\""), 1);
  EXPECT_EQ(CountOf(figure, "class=\"outline false\""), 1);
}

TEST(FigureOfWorstTurn, OfHundredsOfPiecesTheLargestAreOutlined) {
  // 5 pieces of 20 returns, then 260 of one.
  std::vector<std::int32_t> label;
  for (int i = 0; i < 100; ++i) label.push_back(1 + i / 20);
  for (int i = 0; i < 260; ++i) label.push_back(6 + i);
  const auto figure = PredictionOf(FigureOfWorstTurn(MadeUpTurn(std::vector<std::int32_t>(label.size(), 1), label), "m"));
  const auto at = figure.find("class=\"outline s0 dashed\"");
  ASSERT_NE(at, std::string::npos);
  EXPECT_EQ(CountOf(figure.substr(at, figure.find("/>", at) - at), "z"), 4) << "the fifth of 20 is the object's best";
}

TEST(FigureOfWorstTurn, FullTurnTakesAFewKilobytes) {
  // 16 rings and 1800 columns of a ragged shore all round, cut into 300 pieces.
  constexpr int kNumColumns = 1800;
  constexpr int kNumRings = 16;
  auto turn = MadeUpTurn(std::vector<std::int32_t>(kNumColumns, 2), std::vector<std::int32_t>(kNumColumns, 1));
  auto& scan = turn.truth.scan;
  scan.head.rings.resize(kNumRings);
  scan.columns.range.clear();
  turn.truth.object.clear();
  turn.label.clear();
  for (int column = 0; column < kNumColumns; ++column) {
    scan.columns.azimuth_rad[static_cast<std::size_t>(column)] = static_cast<float>(column * 2.0 * std::numbers::pi / kNumColumns);
    for (int ring = 0; ring < kNumRings; ++ring) {
      scan.columns.range.push_back(static_cast<std::uint16_t>(20'000 + 200 * ring + 97 * column % 400));
      turn.truth.object.push_back(2);
      turn.label.push_back(1 + column / 6);
    }
  }
  scan.columns.reflectivity.assign(scan.columns.range.size(), 0);
  const auto figure = FigureOfWorstTurn(turn, "m");
  EXPECT_EQ(FaultOf(figure), "");
  EXPECT_LT(figure.size(), 40'000U) << "28 800 returns, more than any turn of a lake";
}

TEST(FigureOfWorstTurn, OneSegmentOverTwoObjectsBearsBothNumbers) {
  const auto figure = PredictionOf(FigureOfWorstTurn(MadeUpTurn({1, 1, 1, 2, 2}, {1, 1, 1, 1, 1}), "m"));
  EXPECT_TRUE(Holds(figure, ">1+2</text>"));
  EXPECT_FALSE(Holds(figure, "dots s1"));
}

TEST(FigureOfWorstTurn, WhatIsNotScoredBelongsToNoObject) {
  const auto figure = FigureOfWorstTurn(MadeUpTurn({1, 1, 2, 2}, {1, 1, kNotScored, kNotScored}), "m");
  EXPECT_TRUE(Holds(figure, "; 1 objects, 1 segments, of these 0 false"));
  EXPECT_FALSE(Holds(figure, "<td class=\"words\">shore</td>"));
}

TEST(FigureOfWorstTurn, EmptyTurnIsDrawn) {
  for (const auto& turn : {MadeUpTurn({}, {}), MadeUpTurn({0, 0}, {0, 0}), WorstScan{}}) {
    const auto figure = FigureOfWorstTurn(turn, "m");
    EXPECT_EQ(FaultOf(figure), "");
    EXPECT_FALSE(Holds(figure, "nan"));
    EXPECT_EQ(CountOf(figure, "<svg class=\"plan\""), 2);
  }
}

TEST(FigureOfWorstTurn, TurnWhoseArraysDifferInSizeIsNotDrawn) {
  auto turn = MadeUpTurn({1, 1}, {1, 1});
  turn.label.pop_back();
  const auto figure = FigureOfWorstTurn(turn, "m");
  EXPECT_EQ(FaultOf(figure), "");
  EXPECT_FALSE(Holds(figure, "<svg"));
}

}  // namespace
}  // namespace lookout::eval
