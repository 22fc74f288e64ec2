// Situations as a crew meets them, by hand-drawn scans: what is one thing has one name all the time.
#include <algorithm>
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "services/tracker/core/proof.hpp"
#include "services/tracker/core/tracker.hpp"
#include "tests/unit/tracker/walls.hpp"

namespace lookout::tracker::situations {
namespace {

using test::Box;
using test::Called;
using test::Walls;

using Labels = std::set<std::int64_t>;

constexpr int kAllScans = 1'000'000;

// A scan of a situation. Each thing is one piece, with its number.
struct Moment {
  Walls walls;
  test::Segmenter segmenter;
  Eigen::Vector2d own_m = Eigen::Vector2d::Zero();
  int num_drops = 0;  // of rain, 2 to 9 m away
};
using Situation = std::function<Moment(int scan)>;

// What the tracker makes of it.
struct Story {
  std::map<int, std::map<int, std::int64_t>> label_of;  // by thing and scan, where it was seen: the track of its piece
  std::vector<Picture> pictures;                        // by scan

  // Of a thing in [from, end), each once.
  Labels LabelsOf(int thing, int from, int end = kAllScans) const {
    Labels labels;
    for (const auto& [scan, label] : label_of.at(thing)) {
      if (scan >= from && scan < end) labels.insert(label);
    }
    return labels;
  }
  // Where it has one name from a scan on, once it has a number; kNoTrack where it has more, or none.
  std::int64_t NameOf(int thing, int from) const {
    auto labels = LabelsOf(thing, from);
    labels.erase(labels.begin(), labels.lower_bound(kNoTrack));
    return labels.size() == 1 ? *labels.begin() : kNoTrack;
  }
  Labels Reported() const {
    Labels ids;
    for (const auto& picture : pictures) {
      for (const auto& track : picture.tracks) {
        if (test::IsReported(track)) ids.insert(track.id);
      }
    }
    return ids;
  }
  // Scans from one on in which a track is not reported.
  int NumWithout(std::int64_t id, std::size_t from) const {
    return static_cast<int>(std::count_if(pictures.begin() + static_cast<std::ptrdiff_t>(from), pictures.end(), [id](const Picture& picture) {
      return std::ranges::none_of(picture.tracks, [id](const Track& track) { return track.id == id && test::IsReported(track); });
    }));
  }
  // Of the last scan.
  Eigen::Vector2d VelocityOf(std::int64_t id) const {
    for (const auto& track : pictures.back().tracks) {
      if (track.id == id) return track.velocity_mps;
    }
    return Eigen::Vector2d::Constant(kNan);
  }
};

// Segments of one return each, of which nothing is sure.
void AddRain(int num_drops, const Eigen::Vector2d& own_m, std::mt19937_64& random, ScanInput& input) {
  constexpr int kFirstSegment = 1000;
  std::uniform_real_distribution<double> range_m(2.0, 9.0);
  std::uniform_real_distribution<double> bearing_rad(0.0, kTwoPi);
  for (int i = 0; i < num_drops; ++i) {
    const double bearing = bearing_rad(random);
    Seen drop;
    drop.segment_id = kFirstSegment + i;
    drop.time = input.end_time;
    drop.is_sure = false;
    drop.thing_probability = 0.01;
    drop.num_returns = 1;
    drop.position_m = own_m + range_m(random) * Eigen::Vector2d(std::sin(bearing), std::cos(bearing));
    drop.outline_m = {drop.position_m};
    drop.covariance_relative_m2 = 0.0004 * Eigen::Matrix2d::Identity();
    drop.covariance_m2 = 0.01 * Eigen::Matrix2d::Identity();
    drop.top_above_water_m = 1.0;
    input.seen.push_back(drop);
  }
}

Story Follow(int num_scans, const Situation& situation) {
  Story story;
  Tracker tracker(test::WallParams());
  std::mt19937_64 random(1);
  for (int scan = 0; scan < num_scans; ++scan) {
    const auto moment = situation(scan);
    auto input = test::Look(scan, moment.own_m, moment.walls, moment.segmenter, random);
    AddRain(moment.num_drops, moment.own_m, random, input);
    const auto& picture = tracker.Update(input);
    for (const std::int16_t piece : std::set(input.sweep->piece.begin(), input.sweep->piece.end())) {
      const auto at = static_cast<std::size_t>(piece - 1);
      if (piece > 0) story.label_of[piece][scan] = at < picture.track_of_piece.size() ? picture.track_of_piece[at] : kNoTrack;
    }
    story.pictures.push_back(picture);
  }
  return story;
}

// Things 1 and 2: each a segment, or both the segment of the first.
test::Segmenter AsOne(bool is_one) {
  return [is_one](int thing, const Eigen::Vector2d&) { return Called{is_one && thing == 2 ? 1 : thing, false, thing}; };
}
// The same, where the first is land.
test::Segmenter AsOneWithLand(bool is_one) {
  return [is_one](int thing, const Eigen::Vector2d&) { return Called{is_one ? 1 : thing, is_one || thing == 1, thing}; };
}

void ExpectSpeed(const Story& story, std::int64_t id, const Eigen::Vector2d& velocity_mps) {
  EXPECT_LT((story.VelocityOf(id) - velocity_mps).norm(), 0.15) << "is " << story.VelocityOf(id).transpose();
}

// It lies 0.4 m before the dock until scan 120.
constexpr int kLeaves = 120;
Walls DockAndBoat(int scan) {
  const double way_m = test::kScanS * std::max(0, scan - kLeaves);
  return Box({0.0, 17.0}, 24.0, 3.0, 1.2, 1) + Box({2.0 + 0.6 * way_m, 14.2 - 0.8 * way_m}, 6.0, 2.2, 1.3, 2);
}
bool IsBeside(int scan) { return scan < kLeaves + 8; }

TEST(Situation, ABoatLeavesADockWithWhichItIsOneInThreeScansOfTen) {
  for (const bool is_land : {false, true}) {
    SCOPED_TRACE(is_land ? "land" : "no land");
    const auto story = Follow(300, [is_land](int scan) {
      const bool is_one = IsBeside(scan) && scan * 7 % 10 < 3;
      return Moment{DockAndBoat(scan), is_land ? AsOneWithLand(is_one) : AsOne(is_one)};
    });
    const auto dock = story.NameOf(1, 10);
    const auto boat = story.NameOf(2, 10);
    EXPECT_GT(boat, 0);
    EXPECT_TRUE(is_land ? dock == 0 : dock > 0 && dock != boat) << dock;
    EXPECT_EQ(story.Reported().size(), is_land ? 1U : 2U);
    EXPECT_EQ(story.NumWithout(boat, 20), 0);
    ExpectSpeed(story, boat, {0.6, -0.8});
  }
}

TEST(Situation, ABoatLeavesAQuayOfWhichItWasAlwaysAPart) {
  const auto story = Follow(300, [](int scan) { return Moment{DockAndBoat(scan), AsOneWithLand(IsBeside(scan))}; });
  EXPECT_EQ(story.NameOf(1, 0), 0);
  EXPECT_EQ(story.LabelsOf(2, 0, kLeaves), Labels{0});
  const auto boat = story.NameOf(2, kLeaves + 30);
  EXPECT_GT(boat, 0);
  EXPECT_EQ(story.Reported(), Labels{boat});
  EXPECT_EQ(story.NumWithout(boat, kLeaves + 35), 0);
  ExpectSpeed(story, boat, {0.6, -0.8});
}

// The segmenter takes both for one while they are abreast: never, always, in each second scan.
TEST(Situation, TwoBoatsPassWithinAMetre) {
  for (const double speed_mps : {1.0, 2.0}) {
    for (const int every : {0, 1, 2}) {
      SCOPED_TRACE(std::to_string(speed_mps) + " m/s, one in each scan of " + std::to_string(every));
      const auto story = Follow(static_cast<int>(400 / speed_mps), [=](int scan) {
        const double way_m = test::kScanS * speed_mps * scan;
        const bool is_abreast = std::abs(2.0 * way_m - 40.0) < 6.0;
        return Moment{Box({-20.0 + way_m, 12.0}, 5.0, 2.0, 1.0, 1) + Box({20.0 - way_m, 15.0}, 5.0, 2.0, 1.8, 2),
                      AsOne(is_abreast && every > 0 && scan % every == 0)};
      });
      const auto one = story.NameOf(1, 0);
      const auto other = story.NameOf(2, 0);
      EXPECT_GT(one, 0);
      EXPECT_GT(other, 0);
      EXPECT_EQ(story.Reported(), (Labels{one, other}));
      EXPECT_EQ(story.Reported().size(), 2U);
      ExpectSpeed(story, one, {speed_mps, 0.0});
      ExpectSpeed(story, other, {-speed_mps, 0.0});
    }
  }
}

TEST(Situation, ABoatPassesAPile) {
  for (const int every : {1, 2, 3}) {
    SCOPED_TRACE(every);
    const auto story = Follow(250, [every](int scan) {
      const double way_m = 0.2 * scan;
      const bool is_beside = std::abs(way_m - 22.0) < 3.5;
      return Moment{Box({-22.0 + way_m, 14.0}, 5.0, 2.0, 1.4, 1) + Box({0.0, 12.3}, 0.4, 0.4, 2.0, 2), AsOne(is_beside && scan % every == 0)};
    });
    const auto boat = story.NameOf(1, 0);
    const auto pile = story.NameOf(2, 0);
    EXPECT_EQ(story.Reported(), (Labels{boat, pile}));
    EXPECT_EQ(story.Reported().size(), 2U);
    ExpectSpeed(story, boat, {2.0, 0.0});
    ExpectSpeed(story, pile, {0.0, 0.0});
  }
}

TEST(Situation, ADinghyLiesBeforeAShoreThatItIsAPartOfInOneScanOfThree) {
  for (const double gap_m : {1.0, 2.0}) {
    SCOPED_TRACE(gap_m);
    const auto story = Follow(300, [gap_m](int scan) {
      return Moment{Walls{{{-60.0, 20.0}, {60.0, 20.0}, 2.0, 1}} + Box({3.0, 19.25 - gap_m}, 3.0, 1.5, 1.0, 2), AsOneWithLand(scan % 3 == 2)};
    });
    const auto dinghy = story.NameOf(2, 0);
    EXPECT_GT(dinghy, 0);
    EXPECT_EQ(story.NameOf(1, 0), 0);
    EXPECT_EQ(story.Reported(), Labels{dinghy});
    EXPECT_EQ(story.NumWithout(dinghy, 15), 0);
    ExpectSpeed(story, dinghy, {0.0, 0.0});
  }
}

// Waves hide it after the first second.
TEST(Situation, ABuoyIsSeenInOneScanOfFive) {
  for (const double reflects : {1.0, 0.3}) {
    SCOPED_TRACE(reflects);
    const auto story = Follow(400, [reflects](int scan) {
      return Moment{scan < 10 || scan % 5 == 0 ? Box({4.0, 15.0}, 0.6, 0.6, 1.0, 1, reflects) : Walls{}, AsOne(false)};
    });
    EXPECT_EQ(story.Reported().size(), 1U);
    EXPECT_EQ(story.NumWithout(*story.Reported().begin(), 1), 0);
  }
}

// At first the boat sees the end of it only.
TEST(Situation, ADockComesIntoViewAsTheBoatPassesIt) {
  for (const double speed_mps : {1.0, 3.0}) {
    SCOPED_TRACE(speed_mps);
    const auto story = Follow(200, [speed_mps](int scan) {
      const double way_m = test::kScanS * speed_mps * scan;
      return Moment{Box({10.0, 15.0}, 20.0, 2.0, 1.2, 1), AsOne(false), Eigen::Vector2d(-12.0 + 0.5 * way_m, 15.0 - way_m)};
    });
    const auto dock = story.NameOf(1, 0);
    EXPECT_EQ(story.Reported(), Labels{dock});
    for (const auto& picture : story.pictures) {
      for (const auto& track : picture.tracks) EXPECT_TRUE(track.velocity_mps.isZero(0.0));
    }
    EXPECT_NEAR(story.pictures.back().tracks.front().rectangle.length_m, 20.0, 1.0);
  }
}

// It lies at its mooring for ten seconds.
TEST(Situation, AFastBoatLeavesItsMooringAndIsSaidToMoveWithinFiveSeconds) {
  constexpr double kMps2 = 1.5;
  for (const double speed_mps : {5.0, 8.0}) {
    SCOPED_TRACE(speed_mps);
    const auto story = Follow(160, [speed_mps](int scan) {
      const double under_way_s = test::kScanS * std::max(0, scan - 100);
      const double until_s = std::min(under_way_s, speed_mps / kMps2);
      const double way_m = 0.5 * kMps2 * until_s * until_s + speed_mps * (under_way_s - until_s);
      return Moment{Box({-25.0 + way_m, 16.0}, 6.0, 2.2, 1.2, 1), AsOne(false)};
    });
    const auto boat = story.NameOf(1, 10);
    EXPECT_EQ(story.Reported(), Labels{boat});
    for (std::size_t scan = 150; scan < story.pictures.size(); ++scan) {
      for (const auto& track : story.pictures[scan].tracks) {
        if (track.id == boat) {
          EXPECT_GT(track.velocity_mps.x(), 0.6 * speed_mps) << "in scan " << scan;
        }
      }
    }
  }
}

// It leaves nothing of itself behind where it was.
TEST(Situation, ABoatThatRunsAwayFastIsNoLongerThanItIs) {
  const auto story = Follow(190, [](int scan) {
    const double s = test::kScanS * scan;
    const double gains_s = std::clamp(s - 11.0, 0.0, 4.9 / 3.0);
    const double way_m = 1.1 * std::max(0.0, s - 6.0) + 1.5 * gains_s * gains_s + 4.9 * std::max(0.0, s - 11.0 - gains_s);
    return Moment{Box({-28.0 + way_m, 16.0}, 5.0, 2.0, 1.2, 1), AsOne(false)};
  });
  for (std::size_t scan = 130; scan < story.pictures.size(); ++scan) {
    for (const auto& track : story.pictures[scan].tracks) {
      if (!test::IsReported(track)) continue;
      EXPECT_LT(track.rectangle.length_m, 7.5) << "in scan " << scan;
      EXPECT_GT(track.velocity_mps.x(), 1.0) << "in scan " << scan;
    }
  }
}

// Of a kayak that comes head-on, waves show the bow for a second and the paddler for the next. That which is seen jumps by 0.9 m, the kayak does not.
TEST(Situation, AKayakOfWhichBowAndPaddlerAreSeenByTurnsMovesAllTheTime) {
  constexpr double kSpeedMps = 1.0;
  constexpr int kKnownAfter = 40;
  const auto story = Follow(250, [](int scan) {
    const Eigen::Vector2d middle_m(4.0, 34.0 - kSpeedMps * test::kScanS * scan);
    const bool is_bow = scan / 10 % 2 == 1;
    return Moment{is_bow ? Box({middle_m.x(), middle_m.y() - 0.4}, 0.8, 0.8, 1.3, 1) : Box({middle_m.x(), middle_m.y() + 0.5}, 0.8, 0.4, 1.4, 1),
                  AsOne(false)};
  });
  const auto kayak = story.NameOf(1, 10);
  EXPECT_EQ(story.Reported(), Labels{kayak});
  int num_standing = 0;
  for (std::size_t scan = kKnownAfter; scan < story.pictures.size(); ++scan) {
    for (const auto& track : story.pictures[scan].tracks) {
      if (track.id == kayak && track.velocity_mps.norm() < 0.5 * kSpeedMps) ++num_standing;
    }
  }
  EXPECT_LE(num_standing, 10);
  ExpectSpeed(story, kayak, {0.0, -kSpeedMps});
}

// 7 m long; the segmenter cuts off the stern.
Walls BowAndStern(double way_m) { return Box({-18.0 + way_m, 12.0}, 4.0, 2.0, 1.0, 1) + Box({-21.5 + way_m, 12.0}, 3.0, 2.0, 1.6, 2); }

// A drop in the outline of a boat is no boat, and in rain it is no surprise. A wave hides the kayak in one scan of four.
TEST(Situation, AKayakAndABuoyStandOutOfHeavyRain) {
  const auto story = Follow(250, [](int scan) {
    const auto buoy = Box({4.0, -5.0}, 0.6, 0.6, 0.6, 2);
    return Moment{.walls = scan % 4 == 3 ? buoy : Box({-8.0 + 0.08 * scan, 6.5}, 4.5, 0.6, 0.9, 1) + buoy,
                  .segmenter =
                      [](int thing, const Eigen::Vector2d&) {
                        return Called{thing, false, thing, 0.6};
                      },
                  .num_drops = 1500};
  });
  const auto kayak = story.NameOf(1, 0);
  const auto buoy = story.NameOf(2, 0);
  EXPECT_GT(kayak, 0);
  EXPECT_GT(buoy, 0);
  EXPECT_EQ(story.Reported(), (Labels{kayak, buoy}));
  EXPECT_EQ(story.NumWithout(kayak, 40), 0);
  EXPECT_EQ(story.NumWithout(buoy, 30), 0);
  ExpectSpeed(story, kayak, {0.8, 0.0});
}

TEST(Situation, ABoatLosesItsSternInEachThirdScan) {
  for (const int every : {3, 2}) {
    SCOPED_TRACE(every);
    const auto story = Follow(200, [every](int scan) { return Moment{BowAndStern(0.2 * scan), AsOne(scan % every != every - 1)}; });
    const auto boat = story.NameOf(1, 0);
    EXPECT_GT(boat, 0);
    EXPECT_EQ(story.NameOf(2, 0), boat);
    EXPECT_EQ(story.Reported(), Labels{boat});
    EXPECT_EQ(story.NumWithout(boat, 5), 0);
    ExpectSpeed(story, boat, {2.0, 0.0});
  }
}

TEST(Situation, ABoatThatLosesItsSternStopsAndGoesOn) {
  const auto story = Follow(500, [](int scan) {
    const double way_m = 0.2 * std::min(scan, 100) + 0.2 * std::max(0, scan - 300);
    return Moment{BowAndStern(way_m), AsOne(scan % 3 != 2)};
  });
  const auto boat = story.NameOf(1, 0);
  EXPECT_EQ(story.NameOf(2, 0), boat);
  EXPECT_EQ(story.Reported(), Labels{boat});
  ExpectSpeed(story, boat, {2.0, 0.0});
}

TEST(Situation, ABoatComesOutFromBehindAHouse) {
  const auto story = Follow(200, [](int scan) {
    return Moment{Box({-12.0, 8.0}, 12.0, 2.0, 3.0, 1) + Box({-14.0 + 0.2 * scan, 14.0}, 8.0, 2.4, 1.6, 2), AsOneWithLand(false)};
  });
  const auto boat = story.NameOf(2, 1);
  EXPECT_GT(boat, 0);
  EXPECT_EQ(story.NameOf(1, 0), 0);
  EXPECT_EQ(story.Reported(), Labels{boat});
  ExpectSpeed(story, boat, {2.0, 0.0});
}

TEST(Situation, MooredBoatsAreOneInEachThirdScan) {
  const auto story = Follow(300, [](int scan) {
    return Moment{Box({6.0, 10.0}, 2.4, 7.0, 1.4, 1) + Box({9.6, 10.0}, 2.4, 7.0, 2.0, 2), AsOne(scan % 3 == 0), {0.0, -15.0 + 0.15 * scan}};
  });
  const auto one = story.NameOf(1, 0);
  const auto other = story.NameOf(2, 10);
  EXPECT_EQ(story.Reported(), (Labels{one, other}));
  EXPECT_EQ(story.Reported().size(), 2U);
  ExpectSpeed(story, one, {0.0, 0.0});
  ExpectSpeed(story, other, {0.0, 0.0});
}

// What is believed of the courses of a story.
Proof ProofOf(const Story& story) {
  Proof proof;
  for (const auto& picture : story.pictures) {
    for (const auto& [from, to] : picture.merged) proof.Rename(from, to);
    proof.Update(picture.tracks);
  }
  return proof;
}

// A quay is seen for three seconds, a third of it at a time. Then 4 m of it are a segment, and the rest is none: the part farther on, by and by.
TEST(Situation, APieceOfAQuayThatSeemsToRunIsNotBelieved) {
  constexpr double kSeemsMps = 1.5;
  constexpr int kRuns = 30;
  const auto story = Follow(120, [](int scan) {
    const double from_m = -9.0 + kSeemsMps * test::kScanS * (scan - kRuns);
    return Moment{Box({0.0, 17.0}, 24.0, 3.0, 1.2, 1), [=](int, const Eigen::Vector2d& place_m) {
                    const int third = static_cast<int>((place_m.x() + 12.0) / 8.0);
                    if (scan < kRuns) return third == scan % 3 ? Called{third + 2, false, third + 2} : Called{};
                    const bool is_in = place_m.x() >= from_m && place_m.x() <= from_m + 4.0;
                    return Called{is_in ? 1 : 0, false, is_in ? 1 : 0};
                  }};
  });
  const auto piece = story.NameOf(1, kRuns + 10);
  ASSERT_GT(piece, 0);
  EXPECT_GT(story.VelocityOf(piece).norm(), 1.0) << "it seems to run: else this asks nothing";
  EXPECT_TRUE(ProofOf(story).MayBePiece(piece));
}

TEST(Situation, ABoatThatRunsAlongAQuayIsBelieved) {
  const auto story = Follow(90, [](int scan) {
    const double at_m = -7.0 + 1.5 * test::kScanS * scan;
    return Moment{Box({0.0, 17.0}, 24.0, 3.0, 1.2, 1) + Box({at_m, 13.7}, 4.0, 2.0, 1.3, 2), AsOneWithLand(false)};
  });
  const auto boat = story.NameOf(2, 10);
  ASSERT_GT(boat, 0);
  const auto proof = ProofOf(story);
  EXPECT_FALSE(proof.MayBePiece(boat));
  const auto track = std::ranges::find(story.pictures.back().tracks, boat, &Track::id);
  ASSERT_NE(track, story.pictures.back().tracks.end());
  EXPECT_TRUE(proof.IsProven(*track));
}

// Each comes to where the one before it was a second ago.
TEST(Situation, BoatsThatAreTowedInARowAreBelieved) {
  const auto story = Follow(90, [](int scan) {
    Moment moment;
    for (int i = 0; i < 3; ++i) {
      const double at_m = -5.0 + 2.0 * test::kScanS * scan - 5.0 * i;
      moment.walls = moment.walls + Box({at_m, 12.0}, 3.0, 1.6, 1.3, i + 1);
    }
    moment.segmenter = AsOne(false);
    return moment;
  });
  const auto proof = ProofOf(story);
  for (int thing = 1; thing <= 3; ++thing) {
    SCOPED_TRACE(thing);
    const auto boat = story.NameOf(thing, 10);
    ASSERT_GT(boat, 0);
    EXPECT_FALSE(proof.MayBePiece(boat));
  }
}

}  // namespace
}  // namespace lookout::tracker::situations
