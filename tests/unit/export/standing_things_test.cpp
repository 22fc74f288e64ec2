#include "tools/export/standing_things.hpp"

#include <gtest/gtest.h>
#include <limits>
#include <optional>
#include <vector>

#include "common/core/angles.hpp"
#include "tests/unit/export/map_tracks.hpp"
#include "tests/unit/tracker/scans.hpp"

namespace lookout::exporter::standing_things {
namespace {

// A lidar of 16 rings whose beams met nothing, or all of them something at the same range.
tracker::Sweep MakeSweep(Utime time, float range_m) {
  constexpr int kColumns = 720;
  tracker::Sweep sweep;
  for (int ring = 0; ring < 16; ++ring) {
    sweep.elevation_rad.push_back(static_cast<float>(DegToRad(-15.0 + 2.0 * ring)));
    sweep.azimuth_offset_rad.push_back(0.0F);
  }
  for (int column = 0; column < kColumns; ++column) {
    sweep.azimuth_rad.push_back(static_cast<float>(kTwoPi * column / kColumns));
    sweep.time.push_back(time);
    sweep.range_m.insert(sweep.range_m.end(), 16, range_m);
  }
  return sweep;
}

class Sea {
 public:
  explicit Sea(const std::map<std::int64_t, MapThing>& given = {}) : things(given) {
    T_vessel_lidar_.translation().z() = 1.0;
    sight_.emplace(T_vessel_lidar_, 0.5, 100.0);
  }

  void Scans(int number, const std::vector<track_t>& tracks, float met_after_m = 0.0F) {
    for (int i = 0; i < number; ++i) {
      auto input = tracker::test::MakeScan(number_++, Eigen::Vector2d::Zero());
      input.sweep = MakeSweep(input.time, met_after_m);
      sight_->Begin(input);
      now_ = input.end_time;
      StandingScan scan{input.time, input.end_time, input.datum, {}};
      for (auto track : tracks) {
        track.seen_utime_us = ToUtimeUs(now_);
        if (auto standing = ToStandingTrack(track)) scan.tracks.push_back(std::move(*standing));
      }
      things.Update(scan, &*sight_);
    }
  }

  // 2 m by 1 m, 1.5 m high.
  static track_t Standing(std::int64_t id, const Eigen::Vector2d& place_m) {
    const auto first = tracker::test::MakeScan(0, {0.0, 0.0});
    return test::StandingTrack(id, first.datum, place_m, first.end_time, first.end_time);
  }
  static MapThing Given(const Eigen::Vector2d& place_m) {
    auto thing = ToStandingTrack(Standing(1, place_m))->look;
    thing.days = {{19'000, 10}};
    return thing;
  }

  StandingThings things;
  Utime now_;

 private:
  Eigen::Isometry3d T_vessel_lidar_ = Eigen::Isometry3d::Identity();
  std::optional<tracker::Sight> sight_;
  int number_ = 0;
};

TEST(StandingThings, AreThingsAfterTenSeconds) {
  Sea sea;
  const auto track = Sea::Standing(7, {20.0, 5.0});
  sea.Scans(95, {track});
  EXPECT_TRUE(sea.things.Seen().empty());
  sea.Scans(30, {track});
  const auto seen = sea.things.Seen();
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_EQ(ToUtimeUs(seen[0].first), track.first_utime_us);
  EXPECT_EQ(seen[0].seen, sea.now_);
  EXPECT_NEAR(seen[0].deviation_m, 0.3, 1e-9);
  EXPECT_EQ(seen[0].outline_m.size(), 4U);
  ASSERT_EQ(seen[0].days.size(), 1U);
  EXPECT_GE(seen[0].days[0].num_scans, 20);
}

TEST(StandingThings, AreNotWhatMovesOrIsTentativeOrWhoseThereIsNoPlace) {
  Sea sea;
  auto moving = Sea::Standing(1, {20.0, 5.0});
  moving.velocity_map_mps[0] = 1.0;
  auto tentative = Sea::Standing(2, {30.0, 5.0});
  tentative.status = track_t::STATUS_TENTATIVE;
  auto anywhere = Sea::Standing(3, {40.0, 5.0});
  anywhere.covariance[0][0] = 200.0;
  auto endless = Sea::Standing(4, {50.0, 5.0});
  endless.top_above_water_m = 5000.0F;
  auto nowhere = Sea::Standing(5, {60.0, 5.0});
  nowhere.outline_east_m[0] = std::numeric_limits<float>::quiet_NaN();
  auto uneven = Sea::Standing(6, {70.0, 5.0});
  uneven.outline_east_m.pop_back();
  sea.Scans(150, {moving, tentative, anywhere, endless, nowhere, uneven});
  EXPECT_TRUE(sea.things.Seen().empty());
}

TEST(StandingThings, AreTheSameWhenTheirTrackIsAnotherOne) {
  Sea sea;
  sea.Scans(120, {Sea::Standing(7, {20.0, 5.0})});
  sea.Scans(20, {});
  sea.Scans(20, {Sea::Standing(8, {20.5, 5.0})});
  EXPECT_EQ(sea.things.Seen().size(), 1U);
  EXPECT_EQ(sea.things.Seen()[0].seen, sea.now_);
  // 1 m and two deviations of both are 1.85 m.
  sea.Scans(120, {Sea::Standing(9, {22.5, 5.0})});
  EXPECT_EQ(sea.things.Seen().size(), 2U);
  auto large = Sea::Standing(10, {20.5, 5.0});
  large.length_m = 7.0F;
  sea.Scans(120, {large});
  EXPECT_EQ(sea.things.Seen().size(), 3U);
}

TEST(StandingThings, OfTwoTracksTheNearerIsTheThing) {
  Sea sea;
  sea.Scans(120, {Sea::Standing(7, {20.0, 5.0})});
  sea.Scans(20, {});
  auto farther = Sea::Standing(8, {20.9, 5.0});
  farther.first_utime_us += 14'000'000;
  sea.Scans(20, {farther, Sea::Standing(9, {20.1, 5.0})});
  const auto seen = sea.things.Seen();
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_NEAR(seen[0].longitude_deg, Sea::Standing(9, {20.1, 5.0}).longitude_deg, 1e-9);
}

TEST(StandingThings, AreGoneWhenTheirPlaceIsLookedThrough) {
  Sea sea({{5, Sea::Given({-20.0, 5.0})}});
  sea.Scans(120, {Sea::Standing(7, {20.0, 5.0})}, 20.5F);
  sea.Scans(100, {});
  EXPECT_EQ(sea.things.Seen().at(0).gone, std::nullopt) << "ten looks";
  sea.Scans(150, {});
  EXPECT_TRUE(sea.things.Seen().at(0).gone);
  ASSERT_EQ(sea.things.GivenGone().size(), 1U);
  EXPECT_EQ(sea.things.GivenGone()[0].first, 5);
  // It comes back.
  sea.Scans(15, {Sea::Standing(9, {20.0, 5.0})});
  EXPECT_EQ(sea.things.Seen().at(0).gone, std::nullopt);
}

TEST(StandingThings, AreNotGoneWhereNothingCouldBeSeen) {
  Sea sea({{1, Sea::Given({20.0, 5.0})}, {2, Sea::Given({300.0, 5.0})}});
  sea.Scans(400, {}, 8.0F);  // something nearer, all round
  EXPECT_TRUE(sea.things.GivenGone().empty());
  sea.Scans(400, {}, 20.5F);  // what stands there is hit, though no track has it
  EXPECT_TRUE(sea.things.GivenGone().empty());
  sea.Scans(400, {});
  ASSERT_EQ(sea.things.GivenGone().size(), 1U) << "the other is out of reach";
  EXPECT_EQ(sea.things.GivenGone()[0].first, 1);
}

}  // namespace
}  // namespace lookout::exporter::standing_things
