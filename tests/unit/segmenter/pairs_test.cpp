#include "services/segmenter/core/lookout/pairs.hpp"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <optional>
#include <random>

#include "common/core/angles.hpp"
#include "tests/unit/segmenter/piece_scene.hpp"

namespace lookout::segmenter {
namespace {

using test::PieceScene;

constexpr double kRounding = 0.005;  // ranges are multiples of 2 mm
constexpr double kLidarAboveWaterM = 1.0;
constexpr Reach kReach{3.0, 0.0};

std::optional<PiecePair> FindPair(const PieceScene& scene, std::int32_t one, std::int32_t other, const Reach& reach = kReach,
                                  bool reaches_behind = false) {
  PairFinder finder(kLidarAboveWaterM);
  for (const PiecePair& pair : finder.Find(scene.grid, scene.pieces, reach, reaches_behind)) {
    EXPECT_LT(pair.one, pair.other);
    if (pair.one == one && pair.other == other) return pair;
  }
  return std::nullopt;
}

double Of(const PiecePair& pair, PairFeature feature) { return pair.features[static_cast<std::size_t>(feature)]; }

// The distance of returns so many columns apart at 10 m.
double ChordM(int columns) { return 20.0 * std::sin(DegToRad(columns / 2.0)); }

TEST(PairFinder, MeasuresTheGapBetweenPiecesBesideEachOther) {
  for (const int first : {10, 350}) {  // the second over the seam
    PieceScene scene;
    scene.AddRow(0, first, 4, 1, 10.0);
    scene.AddRow(1, first + 7, 5, 1, 10.0);
    scene.Build();
    const auto pair = FindPair(scene, 0, 1);
    ASSERT_TRUE(pair);
    EXPECT_NEAR(pair->gap_m, ChordM(4), kRounding);
    EXPECT_NEAR(Of(*pair, PairFeature::kRange), 10.0, kRounding);
    EXPECT_NEAR(Of(*pair, PairFeature::kGap), ChordM(4), kRounding);
    EXPECT_NEAR(Of(*pair, PairFeature::kFreeGap), ChordM(4), kRounding);
    EXPECT_NEAR(Of(*pair, PairFeature::kGapAngle), 4.0, kRounding);
    EXPECT_EQ(Of(*pair, PairFeature::kRadialGap), 0.0);
    EXPECT_EQ(Of(*pair, PairFeature::kRiseGap), 0.0);
    EXPECT_EQ(Of(*pair, PairFeature::kOverlap), 0.0);
    EXPECT_EQ(Of(*pair, PairFeature::kFaced), 0.0);
    EXPECT_NEAR(Of(*pair, PairFeature::kSmallAngle), 4.0 * 2.0, kRounding);  // beams of 1 by 2 degrees
    EXPECT_NEAR(Of(*pair, PairFeature::kLargeAngle), 5.0 * 2.0, kRounding);
    EXPECT_NEAR(Of(*pair, PairFeature::kSmallWidth), 40.0 * DegToRad(1.0), kRounding);
    EXPECT_NEAR(Of(*pair, PairFeature::kLargeWidth), 50.0 * DegToRad(1.0), kRounding);
    EXPECT_NEAR(Of(*pair, PairFeature::kSmallLength), ChordM(3), kRounding);
    EXPECT_NEAR(Of(*pair, PairFeature::kLargeLength), ChordM(4), kRounding);
    EXPECT_NEAR(Of(*pair, PairFeature::kUnionLength), ChordM(11), 0.03);
    EXPECT_NEAR(Of(*pair, PairFeature::kParallel), std::cos(DegToRad(7.5)), kRounding);
    EXPECT_NEAR(Of(*pair, PairFeature::kSmallTop), kLidarAboveWaterM, kRounding);
    EXPECT_EQ(Of(*pair, PairFeature::kSmallFill), 1.0);
  }
}

// Three beams between them: one meets something farther, one something nearer, one nothing.
TEST(PairFinder, SaysWhatTheBeamsBetweenThemMeet) {
  PieceScene scene;
  scene.AddRow(0, 10, 4, 1, 10.0);
  scene.AddRow(1, 17, 5, 1, 10.0);
  scene.Add(2, 15, 1, 30.0);
  scene.Add(3, 16, 1, 5.0);
  scene.AddRow(4, 14, 3, 2, 40.0);  // of a ring in which neither shows
  scene.Build();
  const auto pair = FindPair(scene, 0, 1);
  ASSERT_TRUE(pair);
  EXPECT_NEAR(Of(*pair, PairFeature::kSeenThrough), 1.0 / 3.0, kRounding);
  EXPECT_NEAR(Of(*pair, PairFeature::kHidden), 1.0 / 3.0, kRounding);
  EXPECT_NEAR(Of(*pair, PairFeature::kFreeGap), ChordM(4) * 2.0 / 3.0, kRounding);
}

TEST(PairFinder, MeasuresTheGapBetweenPiecesOneBehindTheOther) {
  const double upper = std::cos(DegToRad(2.0));
  for (const auto& [behind_m, faced] : {std::pair{0.8, 0.5}, {1.5, 0.0}}) {
    PieceScene scene;
    scene.AddRow(0, 10, 4, 0, 10.0 / upper);
    scene.AddRow(1, 12, 6, 2, (10.0 + behind_m) / upper);
    scene.Build();
    const auto pair = FindPair(scene, 0, 1);
    ASSERT_TRUE(pair);
    EXPECT_NEAR(pair->gap_m, behind_m, kRounding);
    EXPECT_EQ(Of(*pair, PairFeature::kGapAngle), 0.0);
    EXPECT_NEAR(Of(*pair, PairFeature::kRadialGap), behind_m, kRounding);
    EXPECT_NEAR(Of(*pair, PairFeature::kRadialGapRings), behind_m * kLidarAboveWaterM / (100.0 * DegToRad(2.0)), kRounding);
    EXPECT_NEAR(Of(*pair, PairFeature::kRiseGap), 4.0, kRounding);  // two rings
    EXPECT_NEAR(Of(*pair, PairFeature::kStepUp), (20.0 + behind_m) * std::tan(DegToRad(2.0)), kRounding);
    EXPECT_NEAR(Of(*pair, PairFeature::kTopStep), (20.0 + behind_m) * std::tan(DegToRad(2.0)), kRounding);
    EXPECT_EQ(Of(*pair, PairFeature::kOverlap), 0.5);
    EXPECT_EQ(Of(*pair, PairFeature::kFaced), faced);
    EXPECT_EQ(Of(*pair, PairFeature::kSeenThrough), 0.0);
    EXPECT_EQ(Of(*pair, PairFeature::kHidden), 0.0);
  }
}

TEST(PairFinder, FindsNoneBeyondTheReach) {
  for (const auto& [behind_m, is_pair] : {std::pair{2.9, true}, {3.1, false}}) {
    PieceScene scene;
    scene.AddRow(0, 10, 4, 1, 10.0);
    scene.AddRow(1, 10, 4, 2, (10.0 + behind_m) / std::cos(DegToRad(2.0)));
    scene.Build();
    EXPECT_EQ(FindPair(scene, 0, 1).has_value(), is_pair) << behind_m;
  }
  for (const auto& [columns, is_pair] : {std::pair{17, true}, {18, false}}) {  // 2.96 m and 3.13 m
    PieceScene scene;
    scene.AddRow(0, 10, 4, 1, 10.0);
    scene.AddRow(1, 13 + columns, 4, 1, 10.0);
    scene.Build();
    EXPECT_EQ(FindPair(scene, 0, 1).has_value(), is_pair) << columns;
  }
}

// Drops of rain: none near the lidar, and at 20 m up to a metre: 0.70 m and 1.40 m.
TEST(PairFinder, FindsPiecesOfFewReturnsOnlyFarOffAndNearEachOther) {
  for (const auto& [range_m, columns, is_pair] : {std::tuple{8.0, 1, false}, {20.0, 2, true}, {20.0, 4, false}}) {
    PieceScene scene;
    scene.AddRow(0, 10, 2, 1, range_m);
    scene.AddRow(1, 11 + columns, 2, 1, range_m);
    scene.Build();
    EXPECT_EQ(FindPair(scene, 0, 1).has_value(), is_pair) << range_m << " m, " << columns << " columns";
  }
}

// Up to 0.5 + 0.08 x 10 = 1.3 m.
TEST(PairFinder, FindsAPieceOfFewReturnsNearALargerOne) {
  for (const auto& [behind_m, is_pair] : {std::pair{1.2, true}, {1.4, false}}) {
    for (const bool is_few_behind : {false, true}) {
      PieceScene scene;
      const double larger_m = is_few_behind ? 10.0 : 10.0 + behind_m;
      scene.AddRow(0, 10, 6, 1, larger_m);
      scene.Add(1, 12, 2, (is_few_behind ? 10.0 + behind_m : 10.0) / std::cos(DegToRad(2.0)));
      scene.Build();
      EXPECT_EQ(FindPair(scene, 0, 1).has_value(), is_pair) << behind_m;
    }
  }
  for (const auto& [columns, is_pair] : {std::pair{7, true}, {8, false}}) {  // 1.22 m and 1.40 m
    PieceScene scene;
    scene.AddRow(0, 10, 6, 1, 10.0);
    scene.Add(1, 15 + columns, 1, 10.0);
    scene.Build();
    EXPECT_EQ(FindPair(scene, 0, 1).has_value(), is_pair) << columns;
  }
}

// 13 columns at 20 m are 4.5 m; something near hides 12 of them.
TEST(PairFinder, ReachesBehindWhatIsNearer) {
  for (const bool is_hidden : {false, true}) {
    PieceScene scene;
    for (int ring = 0; ring < 3; ++ring) {
      scene.AddRow(0, 10, 4, ring, 20.0);
      scene.AddRow(1, 26, 4, ring, 20.0);
      if (is_hidden) scene.AddRow(2, 14, 12, ring, 8.0);
    }
    scene.Build();
    EXPECT_FALSE(FindPair(scene, 0, 1, kReach, false));
    const auto pair = FindPair(scene, 0, 1, kReach, true);
    EXPECT_EQ(pair.has_value(), is_hidden);
    if (!pair) continue;
    EXPECT_EQ(Of(*pair, PairFeature::kHidden), 1.0);
    EXPECT_NEAR(Of(*pair, PairFeature::kFreeGap), 0.0, kRounding);
  }
}

// In a column of each something nearer and something farther shows: every two ends of the two columns may be the closest.
TEST(PairFinder, MeasuresFromTheEndsOfTwoColumnsThatAreClosest) {
  const double upper = std::cos(DegToRad(2.0));
  for (const auto& [one_m, other_m, closest_m] : {std::tuple{std::pair{10.0, 11.0}, std::pair{10.8, 12.0}, std::pair{11.0, 10.8}},
                                                  {std::pair{10.8, 12.0}, std::pair{10.0, 11.0}, std::pair{10.8, 11.0}},
                                                  {std::pair{10.0, 12.0}, std::pair{8.0, 12.1}, std::pair{12.0, 12.1}},
                                                  {std::pair{10.0, 12.0}, std::pair{10.1, 14.0}, std::pair{10.0, 10.1}}}) {
    PieceScene scene;
    for (const int ring : {0, 1, 2}) {
      const auto range_of = [&](const std::pair<double, double>& near_and_far_m) {
        return ring == 0   ? near_and_far_m.first / upper
               : ring == 1 ? (near_and_far_m.first + near_and_far_m.second) / 2.0
                           : near_and_far_m.second / upper;
      };
      scene.Add(0, 10, ring, range_of(one_m));
      scene.Add(1, 14, ring, range_of(other_m));
    }
    scene.Build();
    const auto pair = FindPair(scene, 0, 1);
    ASSERT_TRUE(pair);
    const auto [a_m, b_m] = closest_m;
    EXPECT_NEAR(pair->gap_m, std::sqrt(a_m * a_m + b_m * b_m - 2.0 * a_m * b_m * std::cos(DegToRad(4.0))), kRounding) << a_m << " and " << b_m;
    EXPECT_NEAR(Of(*pair, PairFeature::kRange), std::min(a_m, b_m), kRounding);
    EXPECT_NEAR(Of(*pair, PairFeature::kRadialGap), std::abs(a_m - b_m), kRounding);
  }
}

// More drops than are looked at: what is larger is looked at as ever, with all of the reach.
TEST(PairFinder, LeavesOutDropsAloneWhereThereAreTooMany) {
  for (const auto& [num_rings, has_drops] : {std::pair{45, true}, {46, false}}) {  // 16 200 and 16 560 drops
    PieceScene scene(num_rings + 2);
    scene.AddRow(0, 10, 4, num_rings + 1, 10.0);
    scene.AddRow(1, 27, 4, num_rings + 1, 10.0);  // 2.43 m
    std::int32_t piece = 2;
    for (int ring = 0; ring < num_rings; ++ring) {
      for (int column = 0; column < PieceScene::kColumns; ++column) scene.Add(piece++, column, ring, 9.0);  // too near to be pairs
    }
    scene.Add(piece++, 100, num_rings, 60.0);
    scene.Add(piece++, 101, num_rings, 60.0);
    scene.Build();
    EXPECT_TRUE(FindPair(scene, 0, 1)) << num_rings;
    PairFinder finder(kLidarAboveWaterM);
    const auto pairs = finder.Find(scene.grid, scene.pieces, kReach, false);
    EXPECT_EQ(std::ranges::any_of(pairs, [](const PiecePair& pair) { return pair.one > 1; }), has_drops) << num_rings;
  }
}

// Four pieces that wind about each other.
void AddWinding(PieceScene& scene, std::uint64_t seed, const std::function<std::int32_t(std::int32_t)>& piece_of, bool is_mirrored, int turn) {
  std::mt19937_64 random(seed);
  const auto uniform = [&random](double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); };
  for (std::int32_t piece = 0; piece < 4; ++piece) {
    const int first = 100 + static_cast<int>(random() % 20);
    const int num = 3 + static_cast<int>(random() % 12);
    const double from_m = uniform(9.0, 12.0);
    const double to_m = uniform(9.0, 12.0);
    for (int i = 0; i < num; ++i) {
      for (int ring = piece; ring < piece + 2; ++ring) {
        const double range_m = from_m + (to_m - from_m) * i / num + uniform(0.0, 0.2);
        const int column = first + i + turn;
        scene.Add(piece_of(piece), is_mirrored ? PieceScene::kColumns - 1 - column % PieceScene::kColumns : column, ring, range_m);
      }
    }
  }
  scene.Build();
}

void ExpectSamePairs(const PieceScene& scene, const PieceScene& other, const std::function<std::int32_t(std::int32_t)>& piece_of) {
  for (std::int32_t a = 0; a < 4; ++a) {
    for (std::int32_t b = a + 1; b < 4; ++b) {
      const auto pair = FindPair(scene, a, b);
      const auto same = FindPair(other, std::min(piece_of(a), piece_of(b)), std::max(piece_of(a), piece_of(b)));
      ASSERT_EQ(pair.has_value(), same.has_value()) << a << " and " << b;
      if (!pair) continue;
      for (std::size_t i = 0; i < kNumPairFeatures; ++i) {
        EXPECT_NEAR(pair->features[i], same->features[i], 1e-3) << kPairFeatureNames[i] << " of " << a << " and " << b;
      }
    }
  }
}

TEST(PairFinder, MeasuresTheSameInAnyOrderMirroredAndTurned) {
  const auto as_it_is = [](std::int32_t piece) { return piece; };
  const auto reversed = [](std::int32_t piece) { return 3 - piece; };
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    PieceScene scene(5);
    AddWinding(scene, seed, as_it_is, false, 0);
    PieceScene other_order(5);
    AddWinding(other_order, seed, reversed, false, 0);
    ExpectSamePairs(scene, other_order, reversed);
    PieceScene mirrored(5);
    AddWinding(mirrored, seed, as_it_is, true, 0);
    ExpectSamePairs(scene, mirrored, as_it_is);
    PieceScene turned(5);
    AddWinding(turned, seed, as_it_is, false, 245);
    ExpectSamePairs(scene, turned, as_it_is);
    ASSERT_FALSE(HasFailure()) << "seed " << seed;
  }
}

}  // namespace
}  // namespace lookout::segmenter
