#include "services/segmenter/core/lookout/pieces.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "common/core/angles.hpp"
#include "services/segmenter/core/lookout/piece_features.hpp"
#include "tests/unit/segmenter/piece_scene.hpp"

namespace lookout::segmenter {
namespace {

using test::PieceScene;

constexpr double kRoundingM = 0.003;  // ranges are multiples of 2 mm
const double kStepRad = DegToRad(1.0);

TEST(SharedColumns, AreThoseThatAreInBothArcs) {
  constexpr int kNum = 12;
  const auto is_in = [](const Arc& arc, int column) { return (column - arc.first + kNum) % kNum < arc.num; };
  for (int one_first = 0; one_first < kNum; ++one_first) {
    for (int other_first = 0; other_first < kNum; ++other_first) {
      for (int one_num = 1; one_num <= kNum; ++one_num) {
        for (int other_num = 1; other_num <= kNum; ++other_num) {
          const Arc one{one_first, one_num};
          const Arc other{other_first, other_num};
          int expected = 0;
          for (int column = 0; column < kNum; ++column) expected += is_in(one, column) && is_in(other, column) ? 1 : 0;
          ASSERT_EQ(SharedColumns(one, other, kNum), expected) << one_first << "+" << one_num << " and " << other_first << "+" << other_num;
        }
      }
    }
  }
}

// Four columns over the seam, and one return above them that is farther.
TEST(PieceTable, HasTheFactsOfAPieceOverTheSeam) {
  PieceScene scene;
  scene.AddRow(0, 358, 4, 1, 10.0);
  scene.Add(0, 0, 2, 12.0);
  scene.Build();
  ASSERT_EQ(scene.pieces.size(), 1);
  const auto& facts = scene.pieces[0];
  EXPECT_EQ(facts.num_returns, 5);
  EXPECT_EQ(facts.num_columns, 4);
  EXPECT_EQ(facts.num_beams, 5);
  EXPECT_EQ(facts.min_ring, 1);
  EXPECT_EQ(facts.max_ring, 2);
  EXPECT_NEAR(facts.min_range_m, 10.0, kRoundingM);
  EXPECT_NEAR(facts.max_range_m, 12.0 * std::cos(DegToRad(2.0)), kRoundingM);
  EXPECT_NEAR(facts.min_height_m, 0.0, kRoundingM);
  EXPECT_NEAR(facts.max_height_m, 12.0 * std::sin(DegToRad(2.0)), kRoundingM);
  EXPECT_NEAR(facts.mean_height_m, 12.0 * std::sin(DegToRad(2.0)) / 5.0, kRoundingM);
  EXPECT_EQ(facts.arc.first, 358);
  EXPECT_EQ(facts.arc.num, 4);
  EXPECT_NEAR(facts.width_m, 4.0 * kStepRad * 10.0, kRoundingM);
}

TEST(PieceTable, CountsBeamsBetweenTheEndsOfEachLine) {
  PieceScene scene;
  for (const int column : {-2, 0, 5}) scene.Add(0, column, 1, 10.0);
  for (const int column : {1, 4}) scene.Add(0, column, 2, 10.0);
  scene.Build();
  EXPECT_EQ(scene.pieces[0].num_columns, 5);
  EXPECT_EQ(scene.pieces[0].num_beams, 8 + 4);
  EXPECT_EQ(scene.pieces[0].arc.first, 358);
  EXPECT_EQ(scene.pieces[0].arc.num, 8);
}

// A wall all round with something on it: nothing depends on the column with which the scan begins.
TEST(PieceTable, OfAPieceAllRoundDoesNotDependOnWhereTheScanBegins) {
  const auto direction = [](double azimuth_deg) { return Eigen::Vector2d(std::cos(DegToRad(azimuth_deg)), std::sin(DegToRad(azimuth_deg))); };
  const double mean_m = 20.0 / 363.0 * (direction(0.0) + direction(10.0) + direction(50.0)).norm();
  for (int turn = 0; turn < PieceScene::kColumns; ++turn) {
    PieceScene scene;
    scene.AddRow(0, 0, PieceScene::kColumns, 1, 20.0);
    for (const int column : {0, 10, 50}) scene.Add(0, turn + column, 2, 20.0);
    scene.Build();
    const auto& facts = scene.pieces[0];
    ASSERT_EQ(facts.arc.num, PieceScene::kColumns);
    ASSERT_EQ(facts.num_columns, PieceScene::kColumns);
    ASSERT_EQ(facts.num_beams, PieceScene::kColumns + 51) << turn;
    ASSERT_NEAR(facts.length_m, 40.0, 0.01) << turn;
    ASSERT_NEAR(facts.mean_m.norm(), mean_m, kRoundingM) << turn;
  }
}

// The seam of the scan decided which of two equal gaps is left out.
TEST(PieceTable, TheArcOfAPieceWithTwoEqualGapsDoesNotDependOnWhereTheScanBegins) {
  constexpr int kHalf = PieceScene::kColumns / 2;
  constexpr int kNum = kHalf - 20;
  for (int turn = 0; turn < PieceScene::kColumns; ++turn) {
    PieceScene scene;
    for (const int first : {turn, turn + kHalf}) scene.AddRow(0, first, kNum, 1, 20.0);
    scene.Add(0, turn + kNum - 1, 2, 15.0);
    scene.Add(0, turn + kHalf + kNum - 1, 2, 18.0);
    scene.Build();
    const Arc& arc = scene.pieces[0].arc;
    ASSERT_EQ(arc.num, kHalf + kNum);
    ASSERT_EQ(arc.first, turn) << "the gap between 18 and 20 m is left out, not that between 15 and 20 m";
  }
}

TEST(PieceTable, FitsTheLineThroughAPiece) {
  for (const int first : {345, 30, 75, 100, 200}) {
    for (const double off_m : {0.0, 0.2}) {
      PieceScene scene(2);  // a degree below and above the horizon
      // Square to the middle of 30 columns, 10 m off; the upper ring is farther.
      double least_m = 0.0;
      double greatest_m = 0.0;
      for (int i = 0; i < 30; ++i) {
        const double aside_rad = (i - 14.5) * kStepRad;
        for (const int ring : {0, 1}) {
          const double distance_m = 10.0 + (ring == 0 ? -off_m : off_m);
          scene.Add(0, first + i, ring, distance_m / std::cos(aside_rad) / std::cos(DegToRad(1.0)));
          least_m = std::min(least_m, distance_m * std::tan(aside_rad));
          greatest_m = std::max(greatest_m, distance_m * std::tan(aside_rad));
        }
      }
      scene.Build();
      const auto& facts = scene.pieces[0];
      const double middle_rad = (first + 15) * kStepRad;
      EXPECT_NEAR(facts.mean_m.x(), 10.0 * std::cos(middle_rad), kRoundingM) << first;
      EXPECT_NEAR(facts.mean_m.y(), -10.0 * std::sin(middle_rad), kRoundingM) << first;
      EXPECT_NEAR(std::abs(facts.direction.dot(Eigen::Vector2d(std::sin(middle_rad), std::cos(middle_rad)))), 1.0, 1e-4) << first;
      EXPECT_NEAR(facts.off_m, off_m, kRoundingM) << first;
      EXPECT_NEAR(facts.length_m, greatest_m - least_m, 2.0 * kRoundingM) << first;
      EXPECT_NEAR(facts.radius_m, std::hypot(greatest_m, off_m), 2.0 * kRoundingM) << first;
    }
  }
}

TEST(PieceTable, OfOneReturnHasNoLength) {
  PieceScene scene;
  scene.Add(0, 100, 1, 10.0);
  scene.Build();
  EXPECT_EQ(scene.pieces[0].length_m, 0.0);
  EXPECT_EQ(scene.pieces[0].radius_m, 0.0);
  EXPECT_EQ(scene.pieces[0].num_beams, 1);
}

TEST(PieceTable, OutlinesOfAColumnAreSortedByRange) {
  PieceScene scene(4);
  scene.Add(0, 7, 0, 20.0);
  scene.Add(1, 7, 1, 10.0);
  scene.Add(1, 7, 2, 10.5);
  scene.Add(2, 7, 3, 15.0);
  scene.Add(2, 8, 3, 15.0);
  scene.Build();
  EXPECT_TRUE(scene.pieces.InColumn(6).empty());
  const auto seen = scene.pieces.InColumn(7);
  ASSERT_EQ(seen.size(), 3U);
  EXPECT_EQ(seen[0].piece, 1);
  EXPECT_EQ(seen[1].piece, 2);
  EXPECT_EQ(seen[2].piece, 0);
  EXPECT_EQ(seen[0].min_ring, 1);
  EXPECT_EQ(seen[0].max_ring, 2);
  EXPECT_NEAR(seen[0].near_point.range_m, 10.0, 0.01);
  EXPECT_NEAR(seen[0].far_point.range_m, 10.5, 0.01);
  EXPECT_LT(seen[0].min_height_m, 0.0F);
  EXPECT_GT(seen[0].max_height_m, 0.0F);
  EXPECT_EQ(scene.returns[static_cast<std::size_t>(seen[0].nearest)].ring, 1);
  EXPECT_EQ(scene.pieces.InColumn(8).size(), 1U);
  EXPECT_EQ(scene.pieces.entries().size(), 4U);
}

// Eight pieces that wind about each other, two of them over the seam, in three groups and two that stay alone.
TEST(PieceTable, MergedIsAsBuiltFromTheGroups) {
  const std::vector<std::int32_t> group_of_piece{0, 1, 0, 2, 3, 1, 2, 4};
  std::mt19937_64 random(5);
  PieceScene scene(16);
  for (std::int32_t piece = 0; piece < 8; ++piece) {
    const int first = static_cast<int>(350 + random() % 20);
    for (int column = first; column < first + 12; ++column) {
      for (int ring = 2 * piece; ring < 2 * piece + 2; ++ring) {
        if (random() % 4 != 0) scene.Add(piece, column, ring, 10.0 + 0.25 * static_cast<double>(random() % 8));
      }
    }
  }
  scene.Build();
  std::vector<std::int32_t> group_of_return;
  for (const std::int32_t piece : scene.pieces.of_returns()) group_of_return.push_back(group_of_piece.at(static_cast<std::size_t>(piece)));
  PieceTable merged = scene.pieces;
  merged.Merge(scene.grid, group_of_piece, 5);
  PieceTable built;
  built.Build(scene.grid, group_of_return, 5);

  EXPECT_TRUE(std::ranges::equal(merged.of_returns(), built.of_returns()));
  ASSERT_EQ(merged.size(), built.size());
  for (std::int32_t piece = 0; piece < built.size(); ++piece) {
    const PieceFacts& one = merged[piece];
    const PieceFacts& other = built[piece];
    EXPECT_EQ(std::tuple(one.num_returns, one.num_columns, one.num_beams, one.min_ring, one.max_ring, one.arc.first, one.arc.num),
              std::tuple(other.num_returns, other.num_columns, other.num_beams, other.min_ring, other.max_ring, other.arc.first, other.arc.num));
    EXPECT_EQ(std::tuple(one.min_range_m, one.max_range_m, one.min_height_m, one.max_height_m, one.width_m),
              std::tuple(other.min_range_m, other.max_range_m, other.min_height_m, other.max_height_m, other.width_m));
    for (const auto& [is, expected] : {std::pair{one.length_m, other.length_m},
                                       {one.off_m, other.off_m},
                                       {one.radius_m, other.radius_m},
                                       {one.mean_height_m, other.mean_height_m},
                                       {one.mean_m.x(), other.mean_m.x()}}) {
      EXPECT_EQ(FeatureOf(is), FeatureOf(expected)) << piece;
    }
  }
  ASSERT_EQ(merged.entries().size(), built.entries().size());
  for (std::size_t i = 0; i < built.entries().size(); ++i) {
    const OutlineEntry& one = merged.entries()[i];
    const OutlineEntry& other = built.entries()[i];
    EXPECT_EQ(
        std::tuple(one.piece, one.column, one.nearest, one.farthest, one.min_ring, one.max_ring, one.min_height_m, one.max_height_m),
        std::tuple(other.piece, other.column, other.nearest, other.farthest, other.min_ring, other.max_ring, other.min_height_m, other.max_height_m))
        << i;
  }
}

float Of(const PieceFeatures& features, PieceFeature feature) { return features[static_cast<std::size_t>(feature)]; }

// A row before another that is 2 m behind, and a drop between them.
TEST(MeasurePieces, SaysWhatStandsBeforeBehindAndAround) {
  PieceScene scene;
  scene.AddRow(0, 10, 4, 1, 10.0);
  scene.AddRow(1, 12, 6, 2, 12.0);
  scene.Add(2, 11, 0, 11.0);
  scene.Build();
  PieceMeasurer measurer;
  const auto features = measurer.Measure(scene.grid, scene.pieces, 1.0);
  ASSERT_EQ(features.size(), 3U);
  EXPECT_FLOAT_EQ(Of(features[0], PieceFeature::kBackdrop), 3.0F / 4.0F);
  EXPECT_FLOAT_EQ(Of(features[0], PieceFeature::kCovered), 0.0F);
  EXPECT_FLOAT_EQ(Of(features[1], PieceFeature::kBackdrop), 0.0F);
  EXPECT_NEAR(Of(features[1], PieceFeature::kCovered), 2.0 / 6.0, kRoundingM);
  EXPECT_FLOAT_EQ(Of(features[2], PieceFeature::kCovered), 1.0F);
  constexpr double kBeamsAround = 5.0 * 3.0;  // two columns to each side, three rings
  EXPECT_NEAR(Of(features[0], PieceFeature::kCrowd), 272.0 / kBeamsAround, kRoundingM);
  EXPECT_FLOAT_EQ(Of(features[2], PieceFeature::kCrowd), 0.0F);
}

TEST(MeasurePieces, SaysHowDenseAndHowHighAPieceIs) {
  PieceScene scene;
  scene.AddRow(0, 20, 2, 1, 10.0);
  scene.AddRow(0, 24, 4, 1, 10.0);
  scene.AddRow(0, 24, 2, 2, 12.0);
  scene.Build();
  PieceMeasurer measurer;
  const auto features = measurer.Measure(scene.grid, scene.pieces, 1.5);
  const double top_m = 12.0 * std::sin(DegToRad(2.0));
  const double depth_m = 12.0 * std::cos(DegToRad(2.0)) - 10.0;
  EXPECT_NEAR(Of(features[0], PieceFeature::kRange), 10.0, kRoundingM);
  EXPECT_EQ(Of(features[0], PieceFeature::kReturns), 8.0F);
  EXPECT_NEAR(Of(features[0], PieceFeature::kAngle), 8.0 * RadToDeg(kStepRad) * 2.0, kRoundingM);
  EXPECT_NEAR(Of(features[0], PieceFeature::kRise), 4.0, kRoundingM);
  EXPECT_NEAR(Of(features[0], PieceFeature::kWidth), 8.0 * kStepRad * 10.0, kRoundingM);
  EXPECT_NEAR(Of(features[0], PieceFeature::kDepth), depth_m, kRoundingM);
  EXPECT_NEAR(Of(features[0], PieceFeature::kTop), 1.5 + top_m, kRoundingM);
  EXPECT_NEAR(Of(features[0], PieceFeature::kBottom), 1.5, kRoundingM);
  EXPECT_NEAR(Of(features[0], PieceFeature::kMiddle), 1.5 + top_m / 4.0, kRoundingM);
  EXPECT_NEAR(Of(features[0], PieceFeature::kSlope), top_m / depth_m, kRoundingM);
  EXPECT_NEAR(Of(features[0], PieceFeature::kFill), 0.8, kRoundingM);
  EXPECT_FLOAT_EQ(Of(features[0], PieceFeature::kBoxFill), 0.5F);
  EXPECT_FLOAT_EQ(Of(features[0], PieceFeature::kGaps), 0.25F);
}

// A hull is smooth, foam is rough and full of holes.
TEST(MeasurePieces, SaysHowRoughAPieceIsAlongItsRings) {
  PieceScene scene;
  for (int column = -2; column < 2; ++column) scene.Add(0, column, 1, column % 2 == 0 ? 10.0 : 10.1);  // over the seam
  scene.AddRow(1, 50, 5, 1, 10.0);
  for (int column = 100; column < 106; column += 2) scene.Add(2, column, 1, 10.0);
  scene.AddRow(2, 106, 2, 2, 10.0);
  scene.Build();
  PieceMeasurer measurer;
  const auto features = measurer.Measure(scene.grid, scene.pieces, 1.5);
  EXPECT_NEAR(Of(features[0], PieceFeature::kRough), 0.2, kRoundingM);
  EXPECT_FLOAT_EQ(Of(features[0], PieceFeature::kLone), 0.0F);
  EXPECT_FLOAT_EQ(Of(features[1], PieceFeature::kRough), 0.0F);
  EXPECT_FLOAT_EQ(Of(features[2], PieceFeature::kRough), -1.0F);
  EXPECT_NEAR(Of(features[2], PieceFeature::kLone), 3.0 / 5.0, kRoundingM);
}

// A net before a wall: partly hit shots have it as the first of two returns, whole ones as the only one.
TEST(MeasurePieces, OfShotsOfTwoReturnsTheNeighbourIsTheNearerOne) {
  auto scan = EmptyScan({.num_columns = 360, .num_rings = 3, .num_returns = 2});
  for (int column = 100; column < 104; ++column) {
    SetReturn(scan, column, 1, column % 2 == 0 ? 10.0 : 15.0, 0);
    SetReturn(scan, column, 1, column % 2 == 0 ? 15.0 : 10.0, 1);
  }
  const auto returns = ClassifyReturns(scan, {}).returns;
  ScanGrid grid;
  grid.Fill(scan, returns, Eigen::Matrix3d::Identity());
  std::vector<std::int32_t> piece_of_return;
  piece_of_return.reserve(returns.size());
  for (const auto& one : returns) piece_of_return.push_back(one.range_m < 12.0F ? 0 : 1);
  PieceTable pieces;
  pieces.Build(grid, piece_of_return, 2);
  PieceMeasurer measurer;
  const auto features = measurer.Measure(grid, pieces, 1.5);
  EXPECT_FLOAT_EQ(Of(features[0], PieceFeature::kLone), 0.0F);
  EXPECT_FLOAT_EQ(Of(features[0], PieceFeature::kRough), 0.0F);
}

// What floats is met by the lowest beam that passes over the water before it.
TEST(MeasurePieces, SaysWhatTheBeamBelowMet) {
  PieceScene scene;
  scene.AddRow(0, 200, 4, 2, 20.0);
  scene.Add(1, 201, 1, 10.0);
  scene.Add(2, 202, 1, 30.0);
  scene.Build();
  PieceMeasurer measurer;
  const auto features = measurer.Measure(scene.grid, scene.pieces, 1.5);
  EXPECT_FLOAT_EQ(Of(features[0], PieceFeature::kWaterBefore), 0.25F);
  EXPECT_FLOAT_EQ(Of(features[1], PieceFeature::kWaterBefore), 0.0F);
  EXPECT_NEAR(Of(features[1], PieceFeature::kBottomRings), 1.5 / (DegToRad(2.0) * 10.0), kRoundingM);
}

}  // namespace
}  // namespace lookout::segmenter
