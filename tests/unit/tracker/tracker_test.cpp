#include "services/tracker/core/tracker.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>
#include <set>
#include <vector>

#include "common/core/angles.hpp"
#include "tests/unit/tracker/scans.hpp"

namespace lookout::tracker::sea {
namespace {

struct Thing {
  Eigen::Vector2d middle_m;
  double length_m = 2.0;  // east
  double width_m = 1.0;   // north
  double thing_probability = 0.95;
  int num_returns = 10;
};

// Scans of obstacles from elsewhere: what could have been seen is not known.
class Sea {
 public:
  explicit Sea(const TrackerParams& params = {}) : tracker_(params) {}

  const Picture& Scan(const std::vector<Thing>& things, const Eigen::Vector2d& own_m = Eigen::Vector2d::Zero(),
                      const Eigen::Vector2d& own_mps = Eigen::Vector2d::Zero()) {
    ScanInput input = test::MakeScan(num_scans_++, own_m, own_mps);
    input.own->covariance(0, 0) = input.own->covariance(1, 1) = own_sd_m * own_sd_m;
    int id = 1;
    for (const auto& thing : things) {
      Seen seen;
      seen.segment_id = id++;
      seen.time = input.time;
      seen.thing_probability = thing.thing_probability;
      seen.is_sure = thing.thing_probability >= 0.5;
      seen.num_returns = thing.num_returns;
      seen.position_m = thing.middle_m;
      seen.covariance_relative_m2 = Eigen::Matrix2d::Identity() * 0.0025;
      seen.covariance_m2 = seen.covariance_relative_m2 + Eigen::Matrix2d::Identity() * own_sd_m * own_sd_m;
      seen.top_above_water_m = 1.0;
      const Eigen::Vector2d half(0.5 * thing.length_m, 0.5 * thing.width_m);
      seen.outline_m = {thing.middle_m - half, thing.middle_m + Eigen::Vector2d(half.x(), -half.y()), thing.middle_m + half,
                        thing.middle_m + Eigen::Vector2d(-half.x(), half.y())};
      input.seen.push_back(seen);
    }
    return tracker_.Update(input);
  }

  double own_sd_m = 0.0;  // of the own position, in the scans to come

 private:
  Tracker tracker_;
  int num_scans_ = 0;
};

std::vector<const Track*> Confirmed(const Picture& picture) {
  std::vector<const Track*> found;
  for (const auto& track : picture.tracks) {
    if (track.status == TrackStatus::kConfirmed) found.push_back(&track);
  }
  return found;
}

TEST(Tracks, OfABuoyThatLooksLittleLikeAThingAreConfirmedSinceItStaysWhereItIs) {
  Sea sea;
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise_m(0.0, 0.03);
  std::set<std::int64_t> ids;
  double confirmed_s = -1.0;
  for (int scan = 0; scan < 60; ++scan) {
    const auto& picture = sea.Scan({{{20.0 + noise_m(random), 5.0 + noise_m(random)}, 0.2, 0.1, 0.25}});
    const auto confirmed = Confirmed(picture);
    if (!confirmed.empty() && confirmed_s < 0.0) confirmed_s = test::kScanS * scan;
    for (const auto* track : confirmed) ids.insert(track->id);
  }
  EXPECT_GE(confirmed_s, 0.2);
  EXPECT_LE(confirmed_s, 3.0);
  EXPECT_EQ(ids.size(), 1U);
}

TEST(Tracks, OfAClearThingByItselfAreConfirmedAtOnce) {
  const Thing clear{{20.0, 5.0}, 4.0, 2.0, 0.99, 40};
  EXPECT_EQ(Confirmed(Sea().Scan({clear})).size(), 1U);
  // It could be a part of the other.
  const Thing beside{{23.5, 5.0}, 2.0, 2.0, 0.99, 40};
  EXPECT_TRUE(Confirmed(Sea().Scan({clear, beside})).empty());
  const Thing small{{20.0, 5.0}, 0.5, 0.5, 0.99, 5};
  EXPECT_TRUE(Confirmed(Sea().Scan({small})).empty());
}

TEST(Tracks, OfACrestAreNotConfirmed) {
  for (int length = 1; length <= 8; ++length) {
    Sea sea;
    for (int scan = 0; scan < 30; ++scan) {
      const Thing crest{{12.0 + 0.08 * scan, -4.0}, 1.0, 0.5, scan % 2 == 0 ? 0.9 : 0.7, 20};
      const auto& picture = sea.Scan(scan < length ? std::vector{crest} : std::vector<Thing>{});
      EXPECT_TRUE(Confirmed(picture).empty()) << "of " << length << " scans, in scan " << scan;
    }
  }
}

// A buoy goes down in a trough, or the boat rolls.
TEST(Tracks, OfWhatWasLongSeenOutlastTwoSecondsWithoutIt) {
  Sea sea;
  const std::vector<Thing> buoy{{{20.0, 5.0}, 0.5, 0.5, 0.95, 6}};
  for (int scan = 0; scan < 40; ++scan) sea.Scan(buoy);
  const auto before = Confirmed(sea.Scan(buoy));
  ASSERT_EQ(before.size(), 1U);
  const auto id = before.front()->id;
  for (int scan = 0; scan < 20; ++scan) sea.Scan({});
  const auto after = Confirmed(sea.Scan(buoy));
  ASSERT_EQ(after.size(), 1U);
  EXPECT_EQ(after.front()->id, id);
}

// The first fix is metres off, and the next one is not.
TEST(Tracks, MoveAlongWhenTheOwnPositionSettles) {
  Sea sea;
  std::vector<Thing> things;
  for (int i = 0; i < 6; ++i) things.push_back({{8.0 * i - 20.0, 15.0 + 3.0 * (i % 3)}, 1.0, 1.0, 0.95, 10});
  auto shifted = things;
  for (auto& thing : shifted) thing.middle_m += Eigen::Vector2d(2.2, -1.7);
  sea.own_sd_m = 2.0;
  sea.Scan(shifted);
  std::set<std::int64_t> ids;
  for (const auto& track : sea.Scan(shifted).tracks) ids.insert(track.id);
  ASSERT_EQ(ids.size(), things.size());
  sea.own_sd_m = 0.05;
  for (int scan = 0; scan < 30; ++scan) {
    const auto& picture = sea.Scan(things);
    EXPECT_EQ(picture.tracks.size(), things.size()) << "scan " << scan;
    for (const auto& track : picture.tracks) {
      EXPECT_TRUE(ids.contains(track.id)) << "scan " << scan << ", track " << track.id;
      EXPECT_TRUE(track.velocity_mps.isZero(0.0)) << "scan " << scan << ", track " << track.id;
      const auto nearest = std::ranges::min(things, {}, [&](const Thing& thing) { return (thing.middle_m - track.position_m).norm(); });
      EXPECT_LT((nearest.middle_m - track.position_m).norm(), 0.5) << "scan " << scan << ", track " << track.id;
    }
  }
}

TEST(Tracks, OfDropsAreNotConfirmed) {
  Sea sea;
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> place_m(-12.0, 12.0);
  for (int scan = 0; scan < 300; ++scan) {
    std::vector<Thing> drops;
    for (int i = 0; i < 40; ++i) drops.push_back({{place_m(random), place_m(random)}, 0.02, 0.02, 0.03});
    EXPECT_TRUE(Confirmed(sea.Scan(drops)).empty()) << "scan " << scan;
  }
}

TEST(Tracks, OfACrestThatRunsAndLooksLikeClutterAreNotConfirmed) {
  Sea sea;
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise_m(0.0, 0.4);
  for (int scan = 0; scan < 30; ++scan) {
    const double way_m = 2.5 * test::kScanS * scan;
    EXPECT_TRUE(Confirmed(sea.Scan({{{-10.0 + way_m + noise_m(random), 8.0 + noise_m(random)}, 2.0, 0.5, 0.06}})).empty()) << "scan " << scan;
  }
}

TEST(Tracks, OfABoatAndItsMastBecomeOne) {
  Sea sea;
  for (int scan = 0; scan < 60; ++scan) {
    const auto& picture = sea.Scan({{{15.0, 0.0}, 6.0, 2.0}, {{15.5, 1.6}, 0.3, 0.3}});
    if (scan < 5) continue;
    ASSERT_EQ(Confirmed(picture).size(), 1U) << "scan " << scan;
    if (scan <= 40) continue;
    EXPECT_EQ(Confirmed(picture).front()->segment_ids, (std::vector<std::int32_t>{1, 2}));
  }
}

TEST(Tracks, OfTwoPartsThatMoveTogetherBecomeOneOfTheOlderName) {
  Sea sea;
  std::int64_t id = 0;
  for (int scan = 0; scan < 100; ++scan) {
    const double way_m = 2.0 * test::kScanS * scan;
    std::vector<Thing> parts{{{30.0 - way_m, 10.0}, 3.0, 1.0}};
    if (scan > 3) parts.push_back({{34.0 - way_m, 10.0}, 2.5, 1.0});
    const auto confirmed = Confirmed(sea.Scan(parts));
    if (scan == 3) {
      ASSERT_EQ(confirmed.size(), 1U);
      id = confirmed.front()->id;
    }
    if (scan < 60) continue;
    ASSERT_EQ(confirmed.size(), 1U) << "scan " << scan;
    EXPECT_EQ(confirmed.front()->id, id);
    EXPECT_NEAR(confirmed.front()->velocity_mps.x(), -2.0, 0.1);
  }
}

TEST(Tracks, OfTwoBoatsSideBySideStayTwo) {
  Sea sea;
  for (int scan = 0; scan < 300; ++scan) {
    const auto& picture = sea.Scan({{{15.0, 0.0}, 6.0, 2.0}, {{15.0, 3.0}, 6.0, 2.0}});
    if (scan <= 3) continue;
    EXPECT_EQ(Confirmed(picture).size(), 2U) << "scan " << scan;
  }
}

TEST(Tracks, OfBoatsThatPartKeepTheirIds) {
  Sea sea;
  std::set<std::int64_t> ids;
  for (int scan = 0; scan < 150; ++scan) {
    const double way_m = 1.0 * test::kScanS * scan;
    for (const auto* track : Confirmed(sea.Scan({{{15.0 - way_m, 0.0}, 4.0, 1.5}, {{15.0 + way_m, 4.0}, 4.0, 1.5}}))) ids.insert(track->id);
  }
  EXPECT_EQ(ids.size(), 2U);
}

TEST(Tracks, OfWhatIsGoneEndAndTheirIdsAreNotUsedAgain) {
  Sea sea;
  for (int scan = 0; scan < 20; ++scan) sea.Scan({{{15.0, 0.0}}});
  const auto id = Confirmed(sea.Scan({{{15.0, 0.0}}})).front()->id;
  bool is_lost = false;
  std::size_t num_left = 1;
  for (int scan = 0; scan < 40; ++scan) {
    const auto& picture = sea.Scan({});
    num_left = picture.tracks.size();
    is_lost =
        is_lost || std::ranges::any_of(picture.tracks, [&](const Track& track) { return track.id == id && track.status == TrackStatus::kLost; });
  }
  EXPECT_TRUE(is_lost);
  EXPECT_EQ(num_left, 0U);
  for (int scan = 0; scan < 20; ++scan) {
    for (const auto& track : sea.Scan({{{15.0, 0.0}}}).tracks) EXPECT_TRUE(track.id == id + 1 || track.status == TrackStatus::kTentative);
  }
}

TEST(Tracks, AreNumberedFromOneUpWhenTheyAreConfirmed) {
  Sea sea;
  std::vector<std::int64_t> ids;
  for (int scan = 0; scan < 20; ++scan) {
    for (const auto& track : sea.Scan({{{15.0, 0.0}}, {{0.0, 15.0}}}).tracks) {
      EXPECT_EQ(track.status == TrackStatus::kTentative, track.id < kNoTrack);
      if (track.status == TrackStatus::kConfirmed && std::ranges::find(ids, track.id) == ids.end()) ids.push_back(track.id);
    }
  }
  EXPECT_EQ(ids, (std::vector<std::int64_t>{1, 2}));
}

TEST(Tracks, DoNotOutliveAJumpOfThePosition) {
  Sea sea;
  for (int scan = 0; scan < 20; ++scan) sea.Scan({{{15.0, 0.0}}});
  const auto id = Confirmed(sea.Scan({{{15.0, 0.0}}})).front()->id;
  const Eigen::Vector2d jump_m(10'000.0, 0.0);
  for (int scan = 0; scan < 20; ++scan) {
    for (const auto& track : sea.Scan({{jump_m + Eigen::Vector2d(15.0, 0.0)}}, jump_m).tracks) {
      EXPECT_TRUE(track.id > id || track.status == TrackStatus::kTentative);
      EXPECT_TRUE(track.velocity_mps.isZero(0.0));
    }
  }
}

// Rule 13 d: who comes up from abaft the beam stays the one that overtakes while the bearing changes.
TEST(Tracks, OfWhoOvertakesStaySoUntilPastAndClear) {
  TrackerParams params;
  params.encounter = {50.0, 60.0};
  Sea sea(params);
  std::set<Encounter> seen;
  Encounter last = Encounter::kNone;
  for (int scan = 0; scan < 400; ++scan) {
    const double time_s = test::kScanS * scan;
    const auto confirmed = Confirmed(sea.Scan({{{4.0, -40.0 + 5.0 * time_s}, 2.0, 4.0}}, {0.0, 2.0 * time_s}, {0.0, 2.0}));
    if (confirmed.empty() || confirmed.front()->velocity_mps.isZero(0.0)) continue;
    last = confirmed.front()->encounter;
    seen.insert(last);
  }
  EXPECT_EQ(last, Encounter::kNone);
  EXPECT_EQ(seen, (std::set{Encounter::kNone, Encounter::kOvertaken}));
}

}  // namespace
}  // namespace lookout::tracker::sea
