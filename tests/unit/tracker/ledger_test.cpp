#include "services/tracker/core/ledger.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <iterator>
#include <numeric>
#include <random>
#include <vector>

namespace lookout::tracker::decisions {
namespace {

using Numbers = std::vector<std::int32_t>;
using Places = std::vector<Eigen::Vector2d>;

struct Drawn {
  Places places_m;
  std::int32_t segment = 0;
  bool is_land = false;
  std::int32_t frame = 0;
};

const std::vector<Ledger::Frame> kEarth{{}};

Ledger::Groups Divide(Ledger& ledger, const std::vector<Drawn>& drawn, const std::vector<Ledger::Frame>& frames = kEarth) {
  std::vector<Ledger::Piece> pieces;
  pieces.reserve(drawn.size());
  for (const auto& one : drawn) pieces.push_back({one.segment, one.is_land, one.frame, one.places_m});
  return ledger.Divide(pieces, frames);
}

// Returns along a line, 0.2 m apart, in so many rings.
Places Line(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m, int num_rings = 2) {
  constexpr double kApartM = 0.2;
  const int count = 1 + static_cast<int>(std::lround((to_m - from_m).norm() / kApartM));
  Places places_m;
  for (int i = 0; i < count * num_rings; ++i) places_m.emplace_back(from_m + (to_m - from_m) * (i % count) / std::max(1, count - 1));
  return places_m;
}

Places Moved(Places places_m, const Eigen::Vector2d& by_m) {
  for (auto& place_m : places_m) place_m += by_m;
  return places_m;
}

// A boat of 5 m whose stern the segmenter may cut off.
std::vector<Drawn> Boat(bool is_cut, const Eigen::Vector2d& at_m = Eigen::Vector2d::Zero(), std::int32_t frame = 0) {
  return {{Moved(Line({0.1, 0.1}, {3.1, 0.1}), at_m), 1, false, frame}, {Moved(Line({3.6, 0.1}, {5.1, 0.1}), at_m), is_cut ? 2 : 1, false, frame}};
}

// A long dock, and a thing 0.6 m before it.
std::vector<Drawn> Dock(bool is_cut) { return {{Line({0.1, 0.1}, {20.1, 0.1}, 5), 1}, {Line({9.9, -0.5}, {10.3, -0.5}), is_cut ? 2 : 1}}; }

const Numbers kOne{0, 0};
const Numbers kTwo{0, 1};

TEST(Ledger, OfNothingIsNothing) {
  Ledger ledger;
  EXPECT_TRUE(Divide(ledger, {}).of_piece.empty());
  EXPECT_TRUE(Divide(ledger, {}).land.empty());
}

TEST(Ledger, TheFirstScanIsAsTheSegmenterSaysIt) {
  for (const bool is_cut : {false, true}) {
    Ledger ledger;
    EXPECT_EQ(Divide(ledger, Boat(is_cut)).of_piece, is_cut ? kTwo : kOne);
  }
}

TEST(Ledger, WhatIsCutInOneScanOfTenStaysOne) {
  Ledger ledger;
  for (int scan = 0; scan < 300; ++scan) EXPECT_EQ(Divide(ledger, Boat(scan % 10 == 9)).of_piece, kOne) << "scan " << scan;
}

TEST(Ledger, WhatIsMergedInOneScanOfTenStaysTwo) {
  Ledger ledger;
  for (int scan = 0; scan < 300; ++scan) EXPECT_EQ(Divide(ledger, Boat(scan % 10 != 9)).of_piece, kTwo) << "scan " << scan;
}

TEST(Ledger, WhatIsAlwaysCutStaysTwo) {
  Ledger ledger;
  for (int scan = 0; scan < 300; ++scan) EXPECT_EQ(Divide(ledger, Boat(true)).of_piece, kTwo) << "scan " << scan;
}

// Between a bow and a stern nothing is seen, and the cells of half a metre are too far apart.
TEST(Ledger, PiecesFourMetresApartAreAsMostScansSay) {
  for (const bool is_mostly_cut : {false, true}) {
    Ledger ledger;
    for (int scan = 0; scan < 100; ++scan) {
      const bool is_cut = is_mostly_cut == (scan % 5 != 4);
      const auto groups = Divide(ledger, {{Line({0.1, 0.1}, {3.1, 0.1}), 1}, {Line({7.1, 0.1}, {10.1, 0.1}), is_cut ? 2 : 1}});
      EXPECT_EQ(groups.of_piece, is_mostly_cut ? kTwo : kOne) << "scan " << scan;
    }
  }
}

// It learns what has changed: a boat comes alongside another, or leaves it.
TEST(Ledger, FollowsADecisionThatHasChangedForGood) {
  Ledger ledger;
  for (int scan = 0; scan < 100; ++scan) Divide(ledger, Boat(false));
  int num_late = 0;
  while (num_late < 200 && Divide(ledger, Boat(true)).of_piece == kOne) ++num_late;
  EXPECT_GT(num_late, 20);
  EXPECT_LT(num_late, 60);  // the votes of 50 scans are as many as those of all before
}

TEST(Ledger, ASmallThingBesideADockThatIsMostlyCalledTwoStaysTwo) {
  Ledger ledger;
  std::mt19937 random(1);
  Divide(ledger, Dock(true));
  for (int scan = 0; scan < 300; ++scan) {
    const bool is_cut = random() % 10 < 7;
    const auto groups = Divide(ledger, Dock(is_cut)).of_piece;
    if (scan > 30) {
      EXPECT_EQ(groups, kTwo) << "scan " << scan;
    }
  }
}

// A shore in pieces 2 m apart, that the segmenter puts together as it likes, and a boat 1 m before it that it never takes for a part of it.
TEST(Ledger, LandInPiecesBecomesOneAndABoatBeforeItDoesNot) {
  Ledger ledger;
  std::mt19937 random(2);
  constexpr int kPieces = 6;
  for (int scan = 0; scan < 100; ++scan) {
    std::vector<Drawn> drawn;
    std::int32_t segment = 1;
    for (int i = 0; i < kPieces; ++i) {
      const double from_m = 8.0 * i + 0.1;
      if (random() % 2 == 0) ++segment;
      drawn.push_back({Line({from_m, 0.1}, {from_m + 6.0, 0.1}), segment, true});
    }
    drawn.push_back({Line({18.1, -0.9}, {22.1, -0.9}), 100});
    const auto groups = Divide(ledger, drawn);
    if (scan < 10) continue;  // as the segmenter says it
    ASSERT_EQ(groups.of_piece, (Numbers{0, 0, 0, 0, 0, 0, 1})) << "scan " << scan;
    EXPECT_NEAR(groups.land[0], 1.0, 1e-6);
    EXPECT_LT(groups.land[1], -0.9);
  }
}

// Beyond what neighbours are: an island of which boats before it leave parts.
TEST(Ledger, PiecesOfOneSegmentOfLandAreOneAtAnyDistance) {
  for (const bool is_land : {false, true}) {
    Ledger ledger;
    const std::vector<Drawn> far{{Line({0.1, 0.1}, {4.1, 0.1}), 1, is_land}, {Line({30.1, 0.1}, {34.1, 0.1}), 1, is_land}};
    EXPECT_EQ(Divide(ledger, far).of_piece, is_land ? kOne : kTwo);
  }
}

TEST(Ledger, LandIsTheMeanOfWhatTheScansSay) {
  Ledger ledger;
  std::vector<double> land;
  for (int scan = 0; scan < 40; ++scan) land.push_back(Divide(ledger, {{Line({0.1, 0.1}, {4.1, 0.1}), 1, scan % 4 != 3}}).land.at(0));
  EXPECT_NEAR(land.front(), 1.0, 1e-6);
  EXPECT_NEAR(land.back(), 0.5, 0.05);
}

Ledger::Frame FrameAt(std::int64_t id, const Eigen::Vector2d& at_m, double course_rad = 0.0) {
  Eigen::Isometry2d T_map_frame = Eigen::Isometry2d::Identity();
  T_map_frame.translate(at_m).rotate(course_rad);
  return {id, T_map_frame.inverse()};
}

TEST(Ledger, WhatMovesInAFrameOfItsOwnKeepsItsMemory) {
  for (const bool has_frame : {false, true}) {
    Ledger ledger;
    int num_cut = 0;
    for (int scan = 0; scan < 60; ++scan) {
      const Eigen::Vector2d at_m(0.7 * scan, 0.3 * scan);
      const auto groups = Divide(ledger, Boat(scan % 3 == 2, at_m, has_frame ? 1 : 0), {{}, FrameAt(5, at_m)});
      num_cut += groups.of_piece == kTwo ? 1 : 0;
    }
    if (has_frame) {
      EXPECT_EQ(num_cut, 0);
    } else {
      EXPECT_GT(num_cut, 0);
    }
  }
}

TEST(Ledger, WhatTurnsInAFrameOfItsOwnKeepsItsMemory) {
  Ledger ledger;
  for (int scan = 0; scan < 60; ++scan) {
    const auto frame = FrameAt(5, {20.0 + 0.5 * scan, -3.0}, 0.05 * scan);
    auto boat = Boat(scan % 3 == 2, Eigen::Vector2d::Zero(), 1);
    for (auto& piece : boat) {
      for (auto& place_m : piece.places_m) place_m = frame.T_frame_map.inverse() * place_m;
    }
    EXPECT_EQ(Divide(ledger, boat, {{}, frame}).of_piece, kOne) << "scan " << scan;
  }
}

// A boat with a frame of its own comes so near to a pile that the segmenter takes both for one.
TEST(Ledger, WhatStoodBeforeIsNoPartOfWhatMovesPastIt) {
  Ledger ledger;
  const Drawn pile{Line({0.1, 0.1}, {0.5, 0.1}), 1};
  for (int scan = 0; scan < 20; ++scan) Divide(ledger, {pile});
  for (int scan = 0; scan < 40; ++scan) {
    const Eigen::Vector2d at_m(-10.0 + 0.5 * scan, -0.5);
    const auto groups = Divide(ledger, {pile, {Moved(Line({0.0, 0.0}, {4.0, 0.0}), at_m), 1, false, 1}}, {{}, FrameAt(1, at_m)});
    EXPECT_EQ(groups.of_piece, kTwo) << "scan " << scan;
  }
}

TEST(Ledger, ABowThatComesOutOfTheOutlineBelongsToItsBoat) {
  for (const bool is_cut : {false, true}) {
    Ledger ledger;
    for (int scan = 0; scan < 20; ++scan) {
      const Eigen::Vector2d at_m(1.0 * scan, 0.0);
      auto boat = Boat(is_cut, at_m, 1);
      boat[1].frame = 0;
      EXPECT_EQ(Divide(ledger, boat, {{}, FrameAt(1, at_m)}).of_piece, is_cut ? kTwo : kOne) << "scan " << scan;
    }
  }
}

TEST(Ledger, TwoThatMoveAndWereSeenForAWhileStayTwo) {
  constexpr int kAWhile = 10;
  for (const bool is_cut : {false, true}) {
    Ledger ledger;
    for (int scan = 0; scan < 30; ++scan) {
      const Eigen::Vector2d at_m(1.0 * scan, 0.0);
      auto boats = Boat(is_cut, at_m, 1);
      boats[1].frame = 2;
      const auto groups = Divide(ledger, boats, {{}, FrameAt(1, at_m), FrameAt(2, at_m)});
      EXPECT_EQ(groups.of_piece, !is_cut && scan < kAWhile ? kOne : kTwo) << "scan " << scan;
    }
  }
}

TEST(Ledger, ForgetsWhatItHasNotSeenForLong) {
  for (const int num_without : {150, 260}) {
    Ledger ledger;
    for (int scan = 0; scan < 20; ++scan) Divide(ledger, Boat(false));
    for (int scan = 0; scan < num_without; ++scan) Divide(ledger, {});
    EXPECT_EQ(Divide(ledger, Boat(true)).of_piece, num_without < 200 ? kOne : kTwo);
  }
  Ledger ledger;
  for (int scan = 0; scan < 20; ++scan) Divide(ledger, Boat(false));
  ledger.Clear();
  EXPECT_EQ(Divide(ledger, Boat(true)).of_piece, kTwo);
}

TEST(Ledger, GroupsAreNumberedInTheOrderOfTheirFirstPiece) {
  Ledger ledger;
  std::vector<Drawn> drawn = Boat(false, {40.0, 0.0});
  drawn.insert(drawn.begin() + 1, {Line({0.1, 0.1}, {3.1, 0.1}), 7});
  drawn.push_back({Line({80.1, 0.1}, {83.1, 0.1}), 3});
  EXPECT_EQ(Divide(ledger, drawn).of_piece, (Numbers{0, 1, 0, 2}));
}

// Pieces anywhere, put together anew in each scan, with things that move among them.
std::vector<Drawn> RandomScan(const std::vector<Drawn>& pieces, std::mt19937& random) {
  auto scan = pieces;
  std::uniform_real_distribution<double> noise_m(-0.1, 0.1);
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const bool joins = i > 0 && scan[i].is_land == scan[i - 1].is_land && random() % 3 != 0;
    scan[i].segment = joins ? scan[i - 1].segment : static_cast<std::int32_t>(i);
    for (auto& place_m : scan[i].places_m) place_m += Eigen::Vector2d(noise_m(random), noise_m(random));
  }
  return scan;
}

TEST(Ledger, TheOrderOfPiecesChangesNothingButNumbers) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place_m(0.0, 12.0);
  std::uniform_real_distribution<double> off_m(-1.5, 1.5);
  for (int round = 0; round < 20; ++round) {
    std::vector<Drawn> pieces;
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector2d from_m(place_m(random), place_m(random));
      const std::int32_t frame = i > 16 ? 1 : 0;
      pieces.push_back({Line(from_m, from_m + Eigen::Vector2d(off_m(random), off_m(random))), 0, false, frame});
    }
    Ledger ledger;
    Ledger shuffled_ledger;
    for (int scan = 0; scan < 15; ++scan) {
      const auto drawn = RandomScan(pieces, random);
      const std::vector<Ledger::Frame> frames{{}, FrameAt(1, {0.2 * scan, 0.0})};
      std::vector<std::size_t> order(drawn.size());
      std::iota(order.begin(), order.end(), 0U);
      std::ranges::shuffle(order, random);
      std::vector<Drawn> shuffled;
      shuffled.reserve(drawn.size());
      for (const auto i : order) shuffled.push_back(drawn[i]);
      const auto groups = Divide(ledger, drawn, frames);
      const auto others = Divide(shuffled_ledger, shuffled, frames);
      for (std::size_t a = 0; a < order.size(); ++a) {
        for (std::size_t b = 0; b < a; ++b) {
          ASSERT_EQ(groups.of_piece[order[a]] == groups.of_piece[order[b]], others.of_piece[a] == others.of_piece[b])
              << "round " << round << ", scan " << scan << ", pieces " << order[a] << " and " << order[b];
        }
      }
    }
  }
}

// Ids of segments and frames are names.
TEST(Ledger, TheNumbersOfSegmentsChangeNothing) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place_m(0.0, 10.0);
  for (int round = 0; round < 20; ++round) {
    std::vector<Drawn> pieces;
    for (int i = 0; i < 16; ++i) {
      const Eigen::Vector2d from_m(place_m(random), place_m(random));
      pieces.push_back({Line(from_m, from_m + Eigen::Vector2d(1.0, 0.4)), 0, i < 4});
    }
    Ledger ledger;
    Ledger renamed_ledger;
    for (int scan = 0; scan < 15; ++scan) {
      const auto drawn = RandomScan(pieces, random);
      auto renamed = drawn;
      for (auto& piece : renamed) piece.segment = 1000 - 7 * piece.segment;
      ASSERT_EQ(Divide(ledger, drawn).of_piece, Divide(renamed_ledger, renamed).of_piece) << "round " << round << ", scan " << scan;
    }
  }
}

}  // namespace
}  // namespace lookout::tracker::decisions
