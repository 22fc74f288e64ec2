// What is told of things that have just come up: in the guard zone, and on a fast course.
#include "services/tracker/core/newcomers.hpp"

#include <chrono>
#include <gtest/gtest.h>
#include <vector>

#include "common/core/angles.hpp"
#include "services/tracker/core/look_out.hpp"

namespace lookout::tracker {
namespace {

constexpr Utime kBegin{std::chrono::seconds(1'700'000'000)};

DangerPlace Ahead(double range_m, double bearing_deg = 0.0) { return {range_m, WrapTo2Pi(DegToRad(bearing_deg))}; }

TEST(Newcomers, AreAsOldAsTheyHaveBeenAtTheirPlace) {
  Newcomers newcomers;
  auto time = kBegin;
  std::vector<double> ages_s;
  for (int i = 0; i <= 10; ++i) {
    // The second is here now and there now; the first is not seen in two scans.
    std::vector<DangerPlace> places{Ahead(9.0, i % 2 == 0 ? 40.0 : -40.0)};
    if (i != 4 && i != 5) places.push_back(Ahead(8.0 - 0.1 * i));
    ages_s = newcomers.Update(time += std::chrono::milliseconds(100), places);
  }
  ASSERT_EQ(ages_s.size(), 2U);
  EXPECT_NEAR(ages_s[0], 1.0, 1e-9) << "every other scan is within 0.4 s";
  EXPECT_NEAR(ages_s[1], 1.0, 1e-9);
  time += std::chrono::milliseconds(500);
  EXPECT_EQ(newcomers.Update(time, std::vector{Ahead(7.0)}).front(), 0.0) << "that may be another one";
}

// In a downpour: 4000 drops anew in each scan made 16 million pairs. The nearest are followed, whatever their order.
TEST(Newcomers, OfTooManyTheNearestAreFollowed) {
  Newcomers newcomers;
  auto time = kBegin;
  std::vector<double> ages_s;
  for (int scan = 0; scan <= 10; ++scan) {
    std::vector<DangerPlace> places{Ahead(90.0, 40.0)};
    for (int drop = 0; drop < 3000; ++drop) places.push_back(Ahead(20.0 + 0.02 * drop, 37.0 * scan + 0.1 * drop));
    places.push_back(Ahead(8.0 - 0.1 * scan));
    ages_s = newcomers.Update(time += std::chrono::milliseconds(100), places);
  }
  EXPECT_NEAR(ages_s.back(), 1.0, 1e-9);
  EXPECT_EQ(ages_s.front(), 0.0) << "it is not followed so far behind";
  EXPECT_GE(newcomers.num_over_limit(), 11 * 2802);
}

// A boat that goes north at 1 m/s with a guard zone of 10 m, and what its tracker makes of the water.
class LookOutTest : public ::testing::Test {
 protected:
  static LookOutParams Params() {
    LookOutParams params;
    params.limits.guard_zone = {.range_m = 10.0, .bearing = {DegToRad(300.0), DegToRad(120.0)}};
    params.limits.cpa_limit_m = 5.0;
    return params;
  }
  LookOutTest() {
    own_.is_placed = true;
    own_.velocity_map_mps = {0.0, 1.0};
  }
  // A square of half a metre.
  Track At(std::int64_t id, double east_m, double north_m, TrackStatus status = TrackStatus::kConfirmed) const {
    Track track;
    track.id = id;
    track.status = status;
    track.first = kBegin - std::chrono::seconds(10);
    track.seen = time_ + std::chrono::milliseconds(100);
    track.position_m = track.rectangle.center_m = {east_m, north_m};
    track.rectangle.length_m = track.rectangle.width_m = 0.5;
    for (const auto& [x, y] : {std::pair(-0.25, -0.25), std::pair(0.25, -0.25), std::pair(0.25, 0.25), std::pair(-0.25, 0.25)}) {
      track.outline_m.emplace_back(east_m + x, north_m + y);
    }
    track.existence_probability = 0.99;
    track.range_m = track.position_m.norm() - 0.3;
    track.approach.distance_m = track.range_m;
    track.approach.cpa_m = track.range_m;
    return track;
  }
  const std::vector<Alert>& Scan(const std::vector<Track>& tracks, const std::vector<VesselOutline>& outlines = {}) {
    time_ += std::chrono::milliseconds(100);
    picture_.tracks = tracks;
    look_out_.Begin(own_);
    look_out_.Rename(picture_, time_);
    return look_out_.Update(time_, true, picture_, outlines, own_, {});
  }
  static VesselOutline Sure(double ahead_m, std::int32_t id = 1) {
    VesselOutline outline;
    outline.segment_id = id;
    outline.is_sure = true;
    outline.corners_m = {{ahead_m, -0.2}, {ahead_m + 0.3, -0.2}, {ahead_m, 0.2}};
    outline.nearest_m = {ahead_m, 0.0};
    return outline;
  }

  Pose own_;
  Utime time_ = kBegin;
  Picture picture_;
  LookOut look_out_{Params()};
};

// Crests are sure in single scans, for half a second.
TEST_F(LookOutTest, SaysNothingOfACrestInTheZone) {
  for (int crest = 0; crest < 5; ++crest) {
    for (int i = 0; i < 7; ++i) ASSERT_TRUE(Scan({}, {Sure(3.0 + crest)}).empty()) << crest << " " << i;
    for (int i = 0; i < 5; ++i) Scan({});
  }
  // One that became a tentative track, which is likely a crest.
  for (int i = 0; i < 20; ++i) {
    auto track = At(-7, 0.0, 6.0, TrackStatus::kTentative);
    track.segment_ids = {1};
    track.existence_probability = 0.4;
    track.first = time_ - std::chrono::seconds(1);
    ASSERT_TRUE(Scan({track}, {Sure(6.0)}).empty()) << i;
  }
}

TEST_F(LookOutTest, TellsOfASwimmerWhoComesUpWithinASecondAndAHalf) {
  int scans = 0;
  while (scans < 30 && Scan({}, {Sure(6.0)}).empty()) ++scans;
  EXPECT_LE(scans, 12);
  ASSERT_EQ(look_out_.alerts().size(), 1U);
  EXPECT_EQ(look_out_.alerts()[0].level, AlertLevel::kCaution);
  EXPECT_EQ(look_out_.alerts()[0].sight, AlertSight::kJustSeen);
  EXPECT_EQ(look_out_.sounding(), look_out_.alerts()[0].id);
  // He stays: a track, and the boat comes nearer.
  auto swimmer = At(4, 0.0, 6.0);
  swimmer.segment_ids = {1};
  swimmer.first = kBegin;
  swimmer.approach = {.distance_m = 4.5, .cpa_m = 0.0, .tcpa_s = 4.5, .probability = 1.0};
  for (int i = 0; i < 5; ++i) Scan({swimmer}, {Sure(6.0)});
  ASSERT_EQ(look_out_.alerts().size(), 1U) << "the same alert";
  EXPECT_EQ(look_out_.alerts()[0].level, AlertLevel::kWarning);
  EXPECT_EQ(look_out_.alerts()[0].sight, AlertSight::kSeen);
  EXPECT_EQ(look_out_.alerts()[0].nearest_track, 4);
}

// A piece of the yacht that is told already.
TEST_F(LookOutTest, SaysNothingOfAPieceBesideAKnownThing) {
  auto yacht = At(3, 0.0, 8.0);
  yacht.segment_ids = {2};
  for (int i = 0; i < 40; ++i) Scan({yacht}, {Sure(7.8, 2), Sure(6.5, 1)});
  ASSERT_EQ(look_out_.alerts().size(), 1U);
  EXPECT_EQ(look_out_.alerts()[0].thing, 3);
  EXPECT_NEAR(look_out_.alerts()[0].distance_m, 6.5, 1e-9) << "it is as near as the piece";
}

// "boat 3208, 11.9 kn, head-on, 1 m in 3 s": a piece of the pier that was taken for another.
TEST_F(LookOutTest, TakesAFastCourseForAGhostUntilItIsProven) {
  const auto ghost = [this](std::int64_t id, double north_m) {
    auto track = At(id, 5.0, north_m);
    track.first = time_ - std::chrono::milliseconds(1500);
    track.velocity_mps = {0.0, -6.0};
    track.approach = {.distance_m = north_m - 2.0, .cpa_m = 1.0, .tcpa_s = north_m / 7.0, .probability = 0.95};
    return track;
  };
  // It runs on the spot: nothing while there is time to wait.
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(Scan({ghost(9, 80.0)}).empty()) << i;
  // Too near to wait: a caution that says so.
  for (int i = 0; i < 5; ++i) Scan({ghost(10, 20.0)});
  ASSERT_EQ(look_out_.alerts().size(), 1U);
  EXPECT_EQ(look_out_.alerts()[0].level, AlertLevel::kCaution);
  EXPECT_EQ(look_out_.alerts()[0].sight, AlertSight::kJustSeen);
}

TEST_F(LookOutTest, WarnsOfABoatThatHasGoneWhereItsCourseLed) {
  double north_m = 90.0;
  const auto boat = [&] {
    auto track = At(9, 1.0, north_m);
    track.velocity_mps = {0.0, -6.0};
    track.approach = {.distance_m = north_m, .cpa_m = 1.0, .tcpa_s = north_m / 7.0, .probability = 0.95};
    return track;
  };
  for (; north_m > 40.0; north_m -= 0.6) Scan({boat()});
  ASSERT_EQ(look_out_.alerts().size(), 1U);
  EXPECT_EQ(look_out_.alerts()[0].level, AlertLevel::kWarning) << "5.7 s are left, and 6 needed";
  EXPECT_EQ(look_out_.alerts()[0].sight, AlertSight::kSeen);
}

// A boat that swung at its mooring for two minutes casts off: its way was measured from the first swing, and for two minutes more it was a ghost.
TEST_F(LookOutTest, WarnsOfABoatThatSwungForLongBefore) {
  double north_m = 90.0;
  double north_mps = 0.3;
  const auto boat = [&] {
    auto track = At(9, 1.0, north_m);
    track.velocity_mps = {0.0, -north_mps};
    track.approach = {.distance_m = north_m, .cpa_m = 1.0, .tcpa_s = north_m / north_mps, .probability = 0.95};
    return track;
  };
  for (int scan = 0; scan < 1200; ++scan) Scan({boat()});
  north_mps = 6.0;
  for (; north_m > 35.0; north_m -= 0.6) Scan({boat()});
  ASSERT_EQ(look_out_.alerts().size(), 1U);
  EXPECT_EQ(look_out_.alerts()[0].level, AlertLevel::kWarning);
}

// An island 60 m ahead at 1.2 kn is neither a warning nor a caution: it is 100 s off. Nor is a quay that the boat goes along.
TEST_F(LookOutTest, LeavesWhatIsFarInTimeOrBesideTheBoatAtACautionAtMost) {
  auto pile = At(3, 3.0, 3.0);
  pile.approach = {.distance_m = 2.9, .cpa_m = 2.8, .tcpa_s = 6.0, .probability = 1.0};
  for (int i = 0; i < 50; ++i) Scan({pile});
  ASSERT_EQ(look_out_.alerts().size(), 1U);
  EXPECT_EQ(look_out_.alerts()[0].level, AlertLevel::kCaution);
}

TEST_F(LookOutTest, GoesByWhatASkipperSets) {
  Order order;
  order.kind = OrderKind::kSettings;
  order.settings = {.mode = Mode::kHarbour};
  auto buoy = At(3, 0.0, 9.0);
  for (int i = 0; i < 5; ++i) Scan({buoy});
  EXPECT_EQ(look_out_.alerts().size(), 1U);
  look_out_.Take(order, time_);
  Scan({buoy});
  EXPECT_EQ(look_out_.limits().mode, Mode::kHarbour);
  EXPECT_NEAR(look_out_.limits().guard_zone.range_m, 1.0 * TimeToAct(1.0, {}) + 2.0, 1e-9);
  EXPECT_EQ(look_out_.WholeZone().range_m, 10.0);
  order.settings = {.mode = Mode::kOpenWater, .guard_zone_range_m = 5.0};
  look_out_.Take(order, time_);
  for (int i = 0; i < 40; ++i) Scan({buoy});
  EXPECT_TRUE(look_out_.alerts().empty()) << "9 m off";
}

}  // namespace
}  // namespace lookout::tracker
