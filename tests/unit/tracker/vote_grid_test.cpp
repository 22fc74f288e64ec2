#include "services/tracker/core/vote_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <optional>
#include <random>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

namespace lookout::tracker::votes {
namespace {

constexpr double kCellM = 0.5;
constexpr float kFade = 0.9F;
constexpr std::int64_t kMemoryScans = 8;
constexpr std::array<std::int64_t, 1> kEarth{0};

// One return, in the middle of a cell.
struct Return {
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::int32_t piece = 0;
  std::int32_t segment = 0;
  std::int32_t frame = 0;
};

std::vector<std::int32_t> SegmentsOf(const std::vector<Return>& returns) {
  std::vector<std::int32_t> segments;
  for (const auto& one : returns) {
    segments.resize(std::max(segments.size(), static_cast<std::size_t>(one.piece) + 1), 0);
    segments[static_cast<std::size_t>(one.piece)] = one.segment;
  }
  return segments;
}

void AddTo(VoteGrid& grid, const std::vector<Return>& returns) {
  for (const auto& one : returns) grid.Add(one.frame, kCellM * Eigen::Vector2d(one.x + 0.5, one.y + 0.5), one.piece);
}

void Scan(VoteGrid& grid, const std::vector<Return>& returns, VoteGrid::Weight weight = VoteGrid::Weight::kOne,
          std::span<const std::int64_t> frames = kEarth) {
  const auto segments = SegmentsOf(returns);
  grid.Begin(frames, segments, kMemoryScans);
  AddTo(grid, returns);
  grid.Vote(kFade, weight);
}

// Of two cells of the first frame; nullopt where they are no pair.
std::optional<float> MeanOf(const VoteGrid& grid, const std::pair<int, int>& one, const std::pair<int, int>& other) {
  const auto is = [&grid](std::int32_t index, const std::pair<int, int>& place) {
    const auto& cell = grid.held()[static_cast<std::size_t>(index)];
    return cell.frame == 0 && std::pair(cell.x, cell.y) == place;
  };
  for (const auto& pair : grid.pairs()) {
    if ((is(pair.one, one) && is(pair.other, other)) || (is(pair.one, other) && is(pair.other, one))) return pair.mean;
  }
  return std::nullopt;
}

const std::vector<Return> kOneThing{{0, 0, 0, 1}, {1, 0, 1, 1}};
const std::vector<Return> kTwoThings{{0, 0, 0, 1}, {1, 0, 1, 2}};

TEST(MeanVote, OfTheLastOnesCountsMost) {
  MeanVote vote;
  EXPECT_EQ(vote.mean(), 0.0F);
  vote.Add(1.0F, 1.0F, 0.5F);
  EXPECT_FLOAT_EQ(vote.mean(), 1.0F);
  vote.Add(-1.0F, 1.0F, 0.5F);
  EXPECT_FLOAT_EQ(vote.mean(), (0.5F - 1.0F) / 1.5F);
  EXPECT_FLOAT_EQ(vote.weight(), 1.5F);
  vote.Add(1.0F, 2.0F, 0.5F);
  EXPECT_FLOAT_EQ(vote.mean(), (0.25F - 0.5F + 2.0F) / 2.75F);
}

TEST(MeanVote, OfNoWeightSaysNothing) {
  MeanVote vote;
  vote.Add(1.0F, 0.0F, 0.5F);
  EXPECT_EQ(vote.mean(), 0.0F);
}

TEST(VoteGrid, HoldsNothingOfNothing) {
  VoteGrid grid(kCellM, VoteGrid::Content::kAll);
  Scan(grid, {});
  EXPECT_TRUE(grid.held().empty());
  EXPECT_TRUE(grid.pairs().empty());
  EXPECT_EQ(grid.num_cells(), 0U);
}

TEST(VoteGrid, CellsAreHalfOpenAlsoBelowZero) {
  VoteGrid grid(kCellM, VoteGrid::Content::kAll);
  constexpr std::array<std::int32_t, 1> kSegments{0};
  grid.Begin(kEarth, kSegments, kMemoryScans);
  for (const double place_m : {-0.5, -0.01, 0.0, 0.49, 0.5}) grid.Add(0, {place_m, place_m}, 0);
  grid.Vote(kFade, VoteGrid::Weight::kOne);
  std::vector<std::tuple<int, int, int>> cells;
  for (const auto& cell : grid.held()) cells.emplace_back(cell.x, cell.y, cell.count);
  EXPECT_EQ(cells, (std::vector<std::tuple<int, int, int>>{{-1, -1, 2}, {0, 0, 2}, {1, 1, 1}}));
}

TEST(VoteGrid, WhatIsTooFarFromTheFirstReturnOfItsFrameCountsAsSoFar) {
  constexpr std::int32_t kFarthest = 32'767;
  VoteGrid grid(kCellM, VoteGrid::Content::kAll);
  Scan(grid, {{100, -7, 0, 0}, {100 + kFarthest, -7, 0, 0}, {500'000, -500'000, 0, 0}, {-500'000, 0, 0, 0}});
  std::vector<std::pair<int, int>> cells;
  for (const auto& cell : grid.held()) cells.emplace_back(cell.x, cell.y);
  EXPECT_EQ(cells, (std::vector<std::pair<int, int>>{{100 - kFarthest, 0}, {100, -7}, {100 + kFarthest, -7 - kFarthest}, {100 + kFarthest, -7}}));
}

TEST(VoteGrid, VotesAreTheMeanOfTheScansThatSawBoth) {
  VoteGrid grid(kCellM, VoteGrid::Content::kAll);
  Scan(grid, kOneThing);
  EXPECT_FLOAT_EQ(MeanOf(grid, {0, 0}, {1, 0}).value_or(9.0F), 1.0F);
  Scan(grid, {kTwoThings.front()});  // of one of the two it says nothing
  EXPECT_FALSE(MeanOf(grid, {0, 0}, {1, 0}).has_value());
  Scan(grid, kTwoThings);
  EXPECT_NEAR(MeanOf(grid, {0, 0}, {1, 0}).value_or(9.0F), (kFade - 1.0F) / (kFade + 1.0F), 1e-6F);
  EXPECT_FLOAT_EQ(MeanOf(grid, {0, 0}, {0, 0}).value_or(9.0F), 1.0F);
}

TEST(VoteGrid, OfCellsWithSeveralSegmentsTheVoteIsHowLikelyTwoReturnsAreOfOne) {
  VoteGrid grid(kCellM, VoteGrid::Content::kAll);
  // Three returns of segment 1 and one of 2 beside one of each: 4 pairs of 8 are of one segment.
  Scan(grid, {{0, 0, 0, 1}, {0, 0, 0, 1}, {0, 0, 2, 1}, {0, 0, 1, 2}, {1, 0, 0, 1}, {1, 0, 1, 2}});
  EXPECT_FLOAT_EQ(MeanOf(grid, {0, 0}, {1, 0}).value_or(9.0F), 0.0F);
  // Of itself: 3 x 3 and 1 x 1 of 16.
  EXPECT_FLOAT_EQ(MeanOf(grid, {0, 0}, {0, 0}).value_or(9.0F), 2.0F * 10.0F / 16.0F - 1.0F);
  const auto entries = grid.EntriesOf(grid.held().front());
  ASSERT_EQ(entries.size(), 3U);
  EXPECT_EQ(entries[0].count, 2);
  EXPECT_EQ(grid.held().front().count, 4);
}

TEST(VoteGrid, OfMostHoldsTheSegmentWithMostReturnsOnly) {
  VoteGrid grid(kCellM, VoteGrid::Content::kMostOf);
  // Pieces 0 and 2 are of segment 1.
  Scan(grid, {{0, 0, 0, 1}, {0, 0, 1, 2}, {0, 0, 1, 2}, {0, 0, 2, 1}, {0, 0, 2, 1}, {1, 0, 1, 2}});
  ASSERT_EQ(grid.held().size(), 2U);
  EXPECT_EQ(grid.held()[0].count, 3);
  std::vector<std::int32_t> pieces;
  for (const auto& entry : grid.EntriesOf(grid.held()[0])) pieces.push_back(entry.piece);
  EXPECT_EQ(pieces, (std::vector<std::int32_t>{0, 2}));
  EXPECT_FLOAT_EQ(MeanOf(grid, {0, 0}, {1, 0}).value_or(9.0F), -1.0F);
}

TEST(VoteGrid, VotesByReturnsCountMoreWithMoreOfThem) {
  const auto of = [](int count, std::int32_t segment) {
    std::vector<Return> returns;
    for (int i = 0; i < count; ++i) returns.push_back({0, 0, 0, 1});
    for (int i = 0; i < count; ++i) returns.push_back({1, 0, 1, segment});
    return returns;
  };
  VoteGrid grid(kCellM, VoteGrid::Content::kAll);
  Scan(grid, of(2, 1), VoteGrid::Weight::kByReturns);
  Scan(grid, of(30, 2), VoteGrid::Weight::kByReturns);  // ten of each are enough
  EXPECT_FLOAT_EQ(MeanOf(grid, {0, 0}, {1, 0}).value_or(9.0F), (kFade * 0.2F - 1.0F) / (kFade * 0.2F + 1.0F));
}

TEST(VoteGrid, PairsAreThoseWithinReachInTheSameFrame) {
  std::mt19937 random(1);
  VoteGrid grid(kCellM, VoteGrid::Content::kAll);
  constexpr std::array<std::int64_t, 3> kFrames{0, 4, 2};
  for (int round = 0; round < 100; ++round) {
    std::uniform_int_distribution<std::int32_t> place(-round % 10, round % 10);
    std::vector<Return> returns(1 + random() % 120);
    for (auto& one : returns)
      one = {place(random), place(random), static_cast<std::int32_t>(random() % 4), 0, static_cast<std::int32_t>(random() % 3)};
    const bool votes = round % 2 == 0;
    const auto segments = SegmentsOf(returns);
    grid.Begin(kFrames, segments, kMemoryScans);
    AddTo(grid, returns);
    if (votes) {
      grid.Vote(kFade, VoteGrid::Weight::kOne);
    } else {
      grid.FindPairs();
    }
    using Cell = std::tuple<std::int32_t, std::int32_t, std::int32_t>;
    std::set<Cell> cells;
    for (const auto& one : returns) cells.emplace(one.frame, one.x, one.y);
    std::set<std::tuple<Cell, Cell, int>> expected;
    for (const auto& one : cells) {
      for (const auto& other : cells) {
        const int dx = std::get<1>(other) - std::get<1>(one);
        const int dy = std::get<2>(other) - std::get<2>(one);
        const int distance2 = dx * dx + dy * dy;
        if (std::get<0>(one) == std::get<0>(other) && one <= other && distance2 <= VoteGrid::kReach * VoteGrid::kReach)
          expected.emplace(one, other, distance2);
      }
    }
    std::set<std::tuple<Cell, Cell, int>> found;
    const auto cell_of = [&grid](std::int32_t index) {
      const auto& cell = grid.held()[static_cast<std::size_t>(index)];
      return Cell(cell.frame, cell.x, cell.y);
    };
    for (const auto& pair : grid.pairs()) found.emplace(cell_of(pair.one), cell_of(pair.other), pair.distance2);
    ASSERT_EQ(grid.held().size(), cells.size()) << "round " << round;
    ASSERT_EQ(grid.pairs().size(), expected.size()) << "round " << round;  // each once
    ASSERT_EQ(found, expected) << "round " << round;
  }
}

TEST(VoteGrid, FramesRememberByTheirIdAndApart) {
  VoteGrid grid(kCellM, VoteGrid::Content::kAll);
  Scan(grid, kTwoThings);
  constexpr std::array<std::int64_t, 2> kWithBoat{7, 0};
  std::vector<Return> returns = kOneThing;
  for (const auto& one : kOneThing) returns.push_back({one.x, one.y, one.piece, one.segment, 1});
  Scan(grid, returns, VoteGrid::Weight::kOne, kWithBoat);
  EXPECT_FLOAT_EQ(MeanOf(grid, {0, 0}, {1, 0}).value_or(9.0F), 1.0F);  // of frame 7
  EXPECT_EQ(grid.num_cells(), 4U);
  Scan(grid, kOneThing);  // of the earth
  EXPECT_NEAR(MeanOf(grid, {0, 0}, {1, 0}).value_or(9.0F), (-kFade * kFade + kFade + 1.0F) / (kFade * kFade + kFade + 1.0F), 1e-6F);
}

TEST(VoteGrid, AgeIsTheNumberOfScansBefore) {
  VoteGrid grid(kCellM, VoteGrid::Content::kAll);
  for (int scan = 0; scan < 5; ++scan) {
    Scan(grid, scan == 2 ? std::vector<Return>{} : kOneThing);
    for (const auto& cell : grid.held()) EXPECT_EQ(cell.age, scan < 2 ? scan : scan - 1);
  }
}

TEST(VoteGrid, ForgetsWhatWasNotSeenForAsManyScans) {
  VoteGrid grid(kCellM, VoteGrid::Content::kAll);
  Scan(grid, kTwoThings);
  // Begin, too, is a scan: it looks now and then, so some scans later at most.
  for (int scan = 0; scan < kMemoryScans - 1; ++scan) Scan(grid, {{50, 50, 0, 1}});
  EXPECT_EQ(grid.num_cells(), 3U);
  for (int scan = 0; scan < 1 + kMemoryScans / 4; ++scan) Scan(grid, {{50, 50, 0, 1}});
  EXPECT_EQ(grid.num_cells(), 1U);
  Scan(grid, kOneThing);
  EXPECT_FLOAT_EQ(MeanOf(grid, {0, 0}, {1, 0}).value_or(9.0F), 1.0F);
  for (const auto& cell : grid.held()) EXPECT_EQ(cell.age, 0);
}

TEST(VoteGrid, OwnVotesAreOfTheirCellAndForgottenWithIt) {
  VoteGrid grid(kCellM, VoteGrid::Content::kAll);
  Scan(grid, kOneThing);
  grid.OwnVote(grid.held()[0]).Add(1.0F, 1.0F, kFade);
  Scan(grid, kOneThing);
  EXPECT_FLOAT_EQ(grid.OwnVote(grid.held()[0]).mean(), 1.0F);
  EXPECT_EQ(grid.OwnVote(grid.held()[1]).mean(), 0.0F);
  grid.Clear();
  EXPECT_EQ(grid.num_cells(), 0U);
  Scan(grid, kOneThing);
  EXPECT_EQ(grid.OwnVote(grid.held()[0]).mean(), 0.0F);
  EXPECT_EQ(grid.held()[0].age, 0);
}

// A boat sails along a shore: each scan sees other cells.
TEST(VoteGrid, StaysNearItsBoundAlongAShore) {
  constexpr std::int64_t kLongMemory = 200;
  constexpr std::int32_t kCellsPerScan = 300;
  VoteGrid grid(kCellM, VoteGrid::Content::kAll);
  std::size_t most = 0;
  for (std::int32_t scan = 0; scan < 400; ++scan) {
    std::vector<Return> returns;
    for (std::int32_t i = 0; i < kCellsPerScan; ++i) returns.push_back({7 * scan, 7 * i, 0, 0});
    const auto segments = SegmentsOf(returns);
    grid.Begin(kEarth, segments, kLongMemory);
    AddTo(grid, returns);
    grid.Vote(kFade, VoteGrid::Weight::kOne);
    most = std::max(most, grid.num_cells());
  }
  EXPECT_GT(most, VoteGrid::kMostCells / 2);
  EXPECT_LE(most, VoteGrid::kMostCells + kCellsPerScan);
}

}  // namespace
}  // namespace lookout::tracker::votes
