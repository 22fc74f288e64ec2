#include "services/tracker/core/sightings.hpp"

#include <algorithm>
#include <chrono>
#include <deque>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "tests/unit/tracker/walls.hpp"

namespace lookout::tracker::sightings {
namespace {

using Numbers = std::vector<std::int32_t>;
using test::Called;

constexpr int kBow = 1;
constexpr int kStern = 2;

// A boat of 8 m abeam, its bow 1.2 m high and its stern 2 m, and a buoy, which the segmenter tells apart from it.
const test::Walls kScene =
    test::Box({-1.5, 12.0}, 5.0, 2.0, 1.2, kBow) + test::Box({2.5, 12.0}, 3.0, 2.0, 2.0, kStern) + test::Box({12.0, 6.0}, 0.6, 0.6, 1.5, 3);

test::Segmenter Cuts(bool is_cut) {
  return [is_cut](int thing, const Eigen::Vector2d&) {
    return Called{thing == kStern && !is_cut ? kBow : thing, false, thing, thing == kStern ? 0.6 : 0.9};
  };
}

// Scans of one look-out, with its ledger.
class Lookout {
 public:
  Sightings Ask(const ScanInput& scan, const std::deque<Followed>& tracks = {}) {
    sight_.Begin(scan);
    return SightingsOf(scan, sight_, tracks, &ledger_);
  }
  ScanInput Next(const test::Segmenter& segmenter, const test::Walls& walls = kScene) {
    return test::Look(num_scans_++, Eigen::Vector2d::Zero(), walls, segmenter, random_);
  }
  std::vector<Sight::Return> ReturnsOf(const ScanInput& scan) {
    sight_.Begin(scan);
    return sight_.Returns();
  }

 private:
  Sight sight_{Eigen::Isometry3d::Identity(), test::kLidarM, 100.0};
  Ledger ledger_;
  std::mt19937_64 random_{1};
  int num_scans_ = 0;
};

// From west to east.
double LengthOf(const Seen& seen) {
  const auto support = SupportOf(seen.outline_m);
  return support[0] + support[Opposite(0)];
}

void ExpectSame(const Seen& one, const Seen& other) {
  EXPECT_EQ(one.time, other.time);
  EXPECT_EQ(one.is_sure, other.is_sure);
  EXPECT_EQ(one.is_land, other.is_land);
  EXPECT_EQ(one.thing_probability, other.thing_probability);
  EXPECT_EQ(one.num_returns, other.num_returns);
  EXPECT_EQ(one.position_m, other.position_m);
  EXPECT_EQ(one.covariance_m2, other.covariance_m2);
  EXPECT_EQ(one.covariance_relative_m2, other.covariance_relative_m2);
  EXPECT_EQ(one.top_above_water_m, other.top_above_water_m);
  EXPECT_EQ(one.outline_m, other.outline_m);
  EXPECT_EQ(one.waterline_m, other.waterline_m);
}

TEST(Sightings, OfSegmentsAsTheyAreEqualThemToTheBit) {
  Lookout lookout;
  for (int scan = 0; scan < 5; ++scan) {
    auto input = lookout.Next(Cuts(true));
    for (auto& seen : input.seen) seen.time -= std::chrono::milliseconds(10 * seen.segment_id);
    input.seen[1].is_sure = false;
    const auto all = lookout.Ask(input);
    ASSERT_EQ(all.all.size(), 3U);
    // Pieces come in the order of their first return, clockwise from the bow: so does what is seen.
    for (int thing = 1; thing <= 3; ++thing) {
      const auto index = static_cast<std::size_t>(all.of_segment.at(static_cast<std::size_t>(thing - 1)));
      ExpectSame(all.all.at(index).seen, input.seen[static_cast<std::size_t>(thing - 1)]);
      EXPECT_EQ(all.all.at(index).seen.segment_id, static_cast<int>(index) + 1);
      EXPECT_EQ(static_cast<int>(all.all[index].places_m.size()), all.all[index].seen.num_returns);
    }
    EXPECT_EQ(all.of_piece, all.of_segment);  // as they are numbered here
  }
}

TEST(Sightings, PiecesOfTwoSegmentsBecomeOne) {
  Lookout lookout;
  for (int scan = 0; scan < 20; ++scan) lookout.Ask(lookout.Next(Cuts(false)));
  auto input = lookout.Next(Cuts(true));
  ASSERT_EQ(input.seen.size(), 3U);
  auto& bow = input.seen[0];
  auto& stern = input.seen[1];
  bow.time = input.time + std::chrono::milliseconds(20);
  stern.time = input.time + std::chrono::milliseconds(60);
  const auto all = lookout.Ask(input);
  ASSERT_EQ(all.all.size(), 2U);
  const auto boat = static_cast<std::size_t>(all.of_piece.at(0));
  EXPECT_EQ(all.of_piece[1], all.of_piece[0]);
  EXPECT_NE(all.of_piece[2], all.of_piece[0]);
  EXPECT_EQ(all.of_segment, all.of_piece);
  const auto& whole = all.all[boat].seen;
  EXPECT_EQ(whole.num_returns, bow.num_returns + stern.num_returns);
  EXPECT_EQ(static_cast<int>(all.all[boat].places_m.size()), whole.num_returns);
  EXPECT_EQ(all.all[boat].heights_m.size(), all.all[boat].places_m.size());
  for (const auto& place_m : all.all[boat].places_m) EXPECT_TRUE(Contains(whole.outline_m, place_m));
  EXPECT_NEAR(LengthOf(whole), 8.0, 0.3);
  EXPECT_NEAR(whole.top_above_water_m, std::max(bow.top_above_water_m, stern.top_above_water_m), 0.01);
  const double share = static_cast<double>(bow.num_returns) / whole.num_returns;
  EXPECT_NEAR(ToSeconds(whole.time - input.time), share * 0.02 + (1.0 - share) * 0.06, 2e-6);
  EXPECT_NEAR(Logit(whole.thing_probability), share * Logit(0.9) + (1.0 - share) * Logit(0.6), 1e-9);
  EXPECT_TRUE(whole.is_sure);
  EXPECT_FALSE(whole.is_land);
}

TEST(Sightings, OneSegmentBecomesTwo) {
  Lookout lookout;
  for (int scan = 0; scan < 20; ++scan) lookout.Ask(lookout.Next(Cuts(true)));
  const auto input = lookout.Next(Cuts(false));
  ASSERT_EQ(input.seen.size(), 2U);
  const auto all = lookout.Ask(input);
  ASSERT_EQ(all.all.size(), 3U);
  ASSERT_NE(all.of_piece.at(0), all.of_piece.at(1));
  const auto& bow = all.all[static_cast<std::size_t>(all.of_piece[0])].seen;
  const auto& stern = all.all[static_cast<std::size_t>(all.of_piece[1])].seen;
  EXPECT_EQ(bow.num_returns + stern.num_returns, input.seen[0].num_returns);
  EXPECT_NEAR(LengthOf(bow), 5.0, 0.3);
  EXPECT_NEAR(LengthOf(stern), 3.0, 0.3);
  EXPECT_LT(bow.top_above_water_m, 1.3);
  EXPECT_GT(stern.top_above_water_m, 1.3);
  EXPECT_NEAR(bow.thing_probability, input.seen[0].thing_probability, 1e-9);
  // The segment is what has most of its returns.
  const bool is_bow_larger = bow.num_returns >= stern.num_returns;
  EXPECT_EQ(all.of_segment.at(0), is_bow_larger ? all.of_piece[0] : all.of_piece[1]);
}

TEST(Sightings, WithoutLabelsOrBeamsAreTheSegments) {
  for (const bool has_beams : {false, true}) {
    Lookout lookout;
    auto input = lookout.Next(Cuts(true));
    if (has_beams) {
      input.sweep->label.clear();
      input.sweep->piece.clear();
    } else {
      input.sweep.reset();
    }
    std::ranges::rotate(input.seen, input.seen.begin() + 1);
    const auto all = lookout.Ask(input);
    ASSERT_EQ(all.all.size(), input.seen.size());
    EXPECT_TRUE(all.of_piece.empty());
    EXPECT_EQ(all.of_segment, (Numbers{2, 0, 1}));
    for (std::size_t i = 0; i < all.all.size(); ++i) {
      ExpectSame(all.all[i].seen, input.seen[i]);
      EXPECT_EQ(all.all[i].seen.segment_id, static_cast<int>(i) + 1);
      EXPECT_EQ(all.all[i].places_m, input.seen[i].outline_m);
      EXPECT_TRUE(all.all[i].heights_m.empty());
    }
  }
}

TEST(Sightings, WithoutPiecesASegmentIsOne) {
  Lookout lookout;
  Sightings last;
  for (int scan = 0; scan < 20; ++scan) {
    // By the votes of the scans before its two segments become one, too.
    auto input = lookout.Next(Cuts(scan == 19));
    input.sweep->piece.clear();
    last = lookout.Ask(input);
    EXPECT_EQ(last.all.size(), 2U) << "scan " << scan;
    EXPECT_EQ(last.of_piece, last.of_segment) << "scan " << scan;
  }
}

TEST(Sightings, ASegmentWithoutReturnsStaysAsItIs) {
  Lookout lookout;
  auto input = lookout.Next(Cuts(true));
  auto hidden = input.seen.front();
  hidden.segment_id = 9;
  hidden.num_returns = 4;
  input.seen.insert(input.seen.begin(), hidden);
  const auto all = lookout.Ask(input);
  ASSERT_EQ(all.all.size(), 4U);
  ExpectSame(all.all.back().seen, hidden);
  EXPECT_EQ(all.all.back().seen.segment_id, 4);
  EXPECT_EQ(all.of_segment.at(8), 3);
  EXPECT_EQ(all.of_segment.at(5), -1);
}

TEST(Sightings, ReturnsOfWhatIsNoObstacleAreOfNothing) {
  Lookout lookout;
  auto input = lookout.Next(Cuts(true));
  std::erase_if(input.seen, [](const Seen& seen) { return seen.segment_id == kStern; });
  const auto all = lookout.Ask(input);
  EXPECT_EQ(all.all.size(), 2U);
  ASSERT_GE(all.of_piece.size(), 3U);
  EXPECT_EQ(all.of_piece[kStern - 1], -1);
  EXPECT_EQ(all.of_segment[kStern - 1], -1);
  input.seen.clear();
  EXPECT_TRUE(lookout.Ask(input).all.empty());
}

TEST(Sightings, EachReturnIsInOneOfThem) {
  Lookout lookout;
  std::mt19937 random(2);
  for (int scan = 0; scan < 30; ++scan) {
    const auto input = lookout.Next(Cuts(random() % 2 == 0));
    const auto all = lookout.Ask(input);
    std::vector<std::size_t> num_returns(all.all.size(), 0);
    for (const auto& one : lookout.ReturnsOf(input)) {
      const auto index = static_cast<std::size_t>(all.of_piece.at(static_cast<std::size_t>(one.piece - 1)));
      ++num_returns[index];
      EXPECT_NE(std::ranges::find(all.all[index].places_m, one.place_m), all.all[index].places_m.end());
    }
    for (std::size_t i = 0; i < all.all.size(); ++i) {
      EXPECT_EQ(static_cast<int>(num_returns[i]), all.all[i].seen.num_returns);
      EXPECT_EQ(all.all[i].places_m.size(), num_returns[i]);
    }
  }
}

TEST(Sightings, LandIsWhatMostScansCallSo) {
  for (const int num_land : {3, 1}) {
    Lookout lookout;
    Sightings last;
    for (int scan = 0; scan < 40; ++scan) {
      const bool says_land = scan % 4 < num_land;
      last = lookout.Ask(lookout.Next([says_land](int thing, const Eigen::Vector2d&) { return Called{thing, says_land && thing != 3, thing}; }));
    }
    EXPECT_EQ(last.all[static_cast<std::size_t>(last.of_piece.at(kBow - 1))].seen.is_land, num_land == 3);
    EXPECT_FALSE(last.all[static_cast<std::size_t>(last.of_piece.at(2))].seen.is_land);
  }
}

// Two that move together, mostly told apart. On the earth each lies where the other was.
TEST(Sightings, OfWhatMovesAreRememberedWhereItIsNow) {
  for (const bool has_frame : {false, true}) {
    Lookout lookout;
    std::deque<Followed> tracks(1);
    auto& track = tracks.front();
    track.frame = has_frame ? 1 : 0;
    int num_whole = 0;
    for (int scan = 0; scan < 30; ++scan) {
      const Eigen::Vector2d at_m(0.8 * scan - 12.0, 12.0);
      const auto walls = test::Box(at_m, 4.0, 2.0, 1.5, kBow) + test::Box(at_m - Eigen::Vector2d(3.5, 0.0), 3.0, 2.0, 1.5, kStern);
      track.outline_m = {at_m + Eigen::Vector2d(-5.0, -1.0), at_m + Eigen::Vector2d(2.0, -1.0), at_m + Eigen::Vector2d(2.0, 1.0),
                         at_m + Eigen::Vector2d(-5.0, 1.0)};
      track.middle_m = at_m + Eigen::Vector2d(-1.5, 0.0);
      track.radius_m = 3.7;
      track.body.emplace(track.outline_m, Sides{}, 0.0004 * Eigen::Matrix2d::Identity(), 12.0);
      num_whole += lookout.Ask(lookout.Next(Cuts(scan % 3 != 2), walls), tracks).all.size() == 1 ? 1 : 0;
    }
    if (has_frame) {
      EXPECT_EQ(num_whole, 0);
    } else {
      EXPECT_GT(num_whole, 0);
    }
  }
}

}  // namespace
}  // namespace lookout::tracker::sightings
