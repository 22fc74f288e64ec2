// What becomes of things: answers worked out by hand, and the law that ids of segments are names only.
#include "lab/eval/methods/outcome.hpp"

#include <gtest/gtest.h>

#include "tests/unit/eval/scoring_case.hpp"

namespace lookout::eval {
namespace {

// Kayaks 1, 3, ... and docks 2, 4, ... are things; object 8 is land.
constexpr std::int32_t kLand = 8;

Case CaseWithLand(const std::vector<Cell>& cells) {
  auto one = MakeCase(cells);
  one.truth.objects[kLand] = {"shore_8", "shore", false};
  return one;
}

Fate FateOfKayak(const std::vector<Cell>& cells) {
  const auto one = CaseWithLand(cells);
  return FateOf(1, MatchScan(one.truth, one.labelling.label), one.truth.objects);
}

Score ScoreWithLand(const std::vector<Cell>& cells, const std::set<std::int32_t>& near_land = {}) {
  const auto one = CaseWithLand(cells);
  return ScoreScan(one.truth, one.labelling, near_land);
}

TEST(Land, IsWhatIsNotInTheWaterButForWhatIsBuiltIntoIt) {
  for (const auto* kind : {"shore", "island", "wall", "quay", "cliff", "tree"}) EXPECT_TRUE(IsLand({"", kind, false})) << kind;
  for (const auto* kind : {"dock", "dock_bays", "pile_pier", "jetty", "pontoon"}) EXPECT_FALSE(IsLand({"", kind, false})) << kind;
  EXPECT_FALSE(IsLand({"", "kayak", true}));
}

TEST(Fate, OfAThingWithItsOwnSegmentIsFound) {
  std::vector<Cell> cells;
  AddCells(cells, 5, {1, 1});
  AddCells(cells, 5, {1, 0});
  EXPECT_EQ(FateOfKayak(cells).outcome, Outcome::kFound);
}

TEST(Fate, IsIntoLandWhereMostOfTheSegmentIsLand) {
  std::vector<Cell> cells;
  AddCells(cells, 6, {1, 1});
  AddCells(cells, 40, {kLand, 1});
  AddCells(cells, 4, {1, 2});  // a piece of its own does not change it
  const auto fate = FateOfKayak(cells);
  EXPECT_EQ(fate.outcome, Outcome::kIntoLand);
  EXPECT_EQ(fate.segment, 1);
  EXPECT_EQ(fate.held_by, kLand);
}

TEST(Fate, IsIntoAThingWhereMostOfTheSegmentIsADockOrAnotherBoat) {
  std::vector<Cell> cells;
  AddCells(cells, 6, {1, 1});
  AddCells(cells, 20, {2, 1});
  EXPECT_EQ(FateOfKayak(cells).outcome, Outcome::kIntoThing);
  cells.back().object = 3;
  EXPECT_EQ(FateOfKayak(cells).held_by, 2);
}

TEST(Fate, IsCutWhereItsOwnSegmentsAreEachTooSmall) {
  std::vector<Cell> cells;
  AddCells(cells, 4, {1, 1});
  AddCells(cells, 3, {1, 2});
  AddCells(cells, 3, {1, 3});
  const auto fate = FateOfKayak(cells);
  EXPECT_EQ(fate.outcome, Outcome::kCut);
  EXPECT_EQ(fate.segment, 1);
  EXPECT_EQ(fate.held_by, 1);
}

TEST(Fate, IsWithClutterWhereMostOfTheSegmentIsOfNoObject) {
  std::vector<Cell> cells;
  AddCells(cells, 6, {1, 1});
  AddCells(cells, 9, {kNoTrueObject, 1});
  EXPECT_EQ(FateOfKayak(cells).outcome, Outcome::kWithClutter);
}

TEST(Fate, IsDecidedByTheLargestForeignShareWhereItIsTheFirstOfMany) {
  // 5 of 14 returns are its own: more than of any other kind, and an IoU of 5 / 14.
  std::vector<Cell> cells;
  AddCells(cells, 5, {1, 1});
  AddCells(cells, 4, {kLand, 1});
  AddCells(cells, 3, {2, 1});
  AddCells(cells, 2, {kNoTrueObject, 1});
  EXPECT_EQ(FateOfKayak(cells).outcome, Outcome::kIntoLand);
}

TEST(Fate, IsMissedWhereMoreReturnsAreInNoSegmentThanInAnyOne) {
  std::vector<Cell> cells;
  AddCells(cells, 6, {1, 0});
  EXPECT_EQ(FateOfKayak(cells).outcome, Outcome::kMissed);
  EXPECT_EQ(FateOfKayak(cells).segment, 0);
  AddCells(cells, 5, {1, 1});
  EXPECT_EQ(FateOfKayak(cells).outcome, Outcome::kMissed);
}

TEST(Outcomes, AreOfThingsOfFiveReturnsOrMoreAndNotOfLand) {
  std::vector<Cell> cells;
  AddCells(cells, 5, {1, 1});
  AddCells(cells, 6, {2, 0});
  AddCells(cells, 4, {3, 0});
  AddCells(cells, 20, {kLand, 0});
  auto score = ScoreWithLand(cells);
  score.Add(ScoreWithLand(cells));
  ASSERT_EQ(score.outcomes_by_kind.size(), 2U);
  const auto& kayaks = score.outcomes_by_kind.at("kayak");
  EXPECT_EQ(kayaks.num_things(), 2);
  EXPECT_EQ(kayaks.ShareLost(), 0.0);
  EXPECT_EQ(score.outcomes_by_kind.at("dock").Share(Outcome::kMissed), 1.0);
}

TEST(LostThings, AreListedWithRangeAndFate) {
  std::vector<Cell> cells;
  AddCells(cells, 5, {1, 1});
  AddCells(cells, 6, {3, 2, 30.0});
  AddCells(cells, 1, {3, 2, 12.0});
  AddCells(cells, 90, {kLand, 2});
  const auto one = CaseWithLand(cells);
  const auto lost = LostThingsOf(one.truth, one.labelling.label);
  ASSERT_EQ(lost.size(), 1U);
  EXPECT_EQ(lost[0].object, 3);
  EXPECT_EQ(lost[0].num_returns, 7);
  EXPECT_DOUBLE_EQ(lost[0].range_m, 12.0);
  EXPECT_DOUBLE_EQ(lost[0].iou, 7.0 / 97.0);
  EXPECT_EQ(lost[0].fate.outcome, Outcome::kIntoLand);
}

TEST(NearLand, CountsThingsInTheWaterAlone) {
  std::vector<Cell> cells;
  AddCells(cells, 5, {1, 1});
  AddCells(cells, 5, {2, 2});
  AddCells(cells, 5, {3, 0});
  AddCells(cells, 5, {5, 3});
  const auto score = ScoreWithLand(cells, {1, 2, 3});
  EXPECT_EQ(score.near_land_found, (Mean{2, 1.0})) << "kayaks 1 and 3; kayak 5 is far from land, 2 is a dock";
}

TEST(LandSegments, AreThoseMoreThanHalfOfLand) {
  std::vector<Cell> cells;
  AddCells(cells, 5, {kLand, 1});
  AddCells(cells, 5, {kLand, 2});
  AddCells(cells, 4, {1, 2});
  AddCells(cells, 5, {kLand, 3});
  AddCells(cells, 5, {1, 3});  // half
  const auto score = ScoreWithLand(cells);
  EXPECT_EQ(score.land_segments, (Mean{1, 2.0}));
  EXPECT_EQ(score.segments_of_land_object, (Mean{1, 2.0}));
  EXPECT_EQ(ScoreWithLand({{1, 1}}).land_segments.count, 0) << "no land is seen";
}

}  // namespace
}  // namespace lookout::eval
