#include "services/tracker/core/standing.hpp"

#include <gtest/gtest.h>
#include <optional>
#include <vector>

#include "common/core/angles.hpp"
#include "tests/unit/tracker/scans.hpp"

namespace lookout::tracker::standing {
namespace {

constexpr double kRangeM = 100.0;

// A lidar of 16 rings whose beams met nothing, or all of them something at the same range.
Sweep MakeSweep(Utime time, float range_m) {
  constexpr int kColumns = 720;
  Sweep sweep;
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
  Sea() {
    T_vessel_lidar_.translation().z() = 1.0;
    sight_.emplace(T_vessel_lidar_, 0.5, kRangeM);
  }

  /// @return the track, if there is one
  const Track& Scan(std::vector<Track> tracks, float met_after_m = 0.0F) {
    auto input = test::MakeScan(number_++, Eigen::Vector2d::Zero());
    input.sweep = MakeSweep(input.time, met_after_m);
    sight_->Begin(input);
    for (auto& track : tracks) track.seen = input.end_time;
    now_ = input.end_time;
    tracks_ = std::move(tracks);
    things.Update(input, &*sight_, kRangeM, tracks_);
    static const Track kNone;
    return tracks_.empty() ? kNone : tracks_.front();
  }
  void Scans(int number, const std::vector<Track>& tracks, float met_after_m = 0.0F) {
    for (int i = 0; i < number; ++i) Scan(tracks, met_after_m);
  }

  // 2 m by 1 m, 1.5 m high.
  static Track Standing(std::int64_t id, const Eigen::Vector2d& place_m) {
    Track track;
    track.id = id;
    track.status = TrackStatus::kConfirmed;
    track.kind = TrackKind::kObstacle;
    track.first = test::MakeScan(0, {0.0, 0.0}).end_time;
    track.position_m = place_m;
    track.covariance(0, 0) = track.covariance(1, 1) = 0.09;
    track.outline_m = {place_m + Eigen::Vector2d(-1.0, -0.5), place_m + Eigen::Vector2d(1.0, -0.5), place_m + Eigen::Vector2d(1.0, 0.5),
                       place_m + Eigen::Vector2d(-1.0, 0.5)};
    track.rectangle = RectangleAround(track.outline_m);
    track.top_above_water_m = 1.5;
    track.segment_ids = {1};
    return track;
  }
  // The same, as a map of `days` days has it.
  static MapThing Given(std::int64_t id, const Eigen::Vector2d& place_m, int days) {
    MapThing thing;
    thing.id = id;
    const auto datum = test::MakeScan(0, {0.0, 0.0}).datum;
    const auto place = datum.Map().Reverse({place_m.x(), place_m.y(), 0.0});
    thing.latitude_deg = place.latitude_deg;
    thing.longitude_deg = place.longitude_deg;
    thing.deviation_m = 0.3;
    thing.length_m = 2.0;
    thing.width_m = 1.0;
    thing.top_above_water_m = 1.5;
    thing.outline_m = {{-1.0, -0.5}, {1.0, -0.5}, {1.0, 0.5}, {-1.0, 0.5}};
    for (int day = 0; day < days; ++day) thing.days.push_back({19'000 + day, 10});
    return thing;
  }

  StandingThings things;
  Utime now_;

 private:
  Eigen::Isometry3d T_vessel_lidar_ = Eigen::Isometry3d::Identity();
  std::optional<Sight> sight_;
  std::vector<Track> tracks_;
  int number_ = 0;
};

TEST(Standing, IsAThingOfTheMapAfterTenSeconds) {
  Sea sea;
  sea.things.Give({});
  const auto track = Sea::Standing(7, {20.0, 5.0});
  sea.Scans(95, {track});
  EXPECT_TRUE(sea.things.TakeChanged().empty());
  sea.Scans(30, {track});
  const auto changed = sea.things.TakeChanged();
  ASSERT_EQ(changed.size(), 1U);
  EXPECT_EQ(changed[0].id, 1);
  EXPECT_EQ(changed[0].state, MapThing::State::kSeen);
  EXPECT_EQ(changed[0].first, track.first);
  EXPECT_EQ(changed[0].seen, sea.now_);
  EXPECT_NEAR(changed[0].deviation_m, 0.3, 1e-9);
  ASSERT_EQ(changed[0].days.size(), 1U);
  EXPECT_GE(changed[0].days[0].num_scans, 20);
  EXPECT_TRUE(sea.things.TakeChanged().empty()) << "nothing has changed since";
  sea.Scan({track});
  EXPECT_EQ(sea.things.TakeChanged().size(), 1U) << "it was seen again";
}

TEST(Standing, IsNotWhatMovesOrIsTentativeOrWhoseThereIsNoPlace) {
  Sea sea;
  sea.things.Give({});
  auto moving = Sea::Standing(1, {20.0, 5.0});
  moving.velocity_mps = {1.0, 0.0};
  auto tentative = Sea::Standing(2, {30.0, 5.0});
  tentative.status = TrackStatus::kTentative;
  auto anywhere = Sea::Standing(3, {40.0, 5.0});
  anywhere.covariance(0, 0) = 200.0;
  auto endless = Sea::Standing(4, {50.0, 5.0});
  endless.top_above_water_m = 5000.0;
  sea.Scans(150, {moving, tentative, anywhere, endless});
  EXPECT_TRUE(sea.things.TakeChanged().empty());
}

TEST(Standing, IsKnownWhereItStoodOnThreeDays) {
  Sea sea;
  sea.things.Give({Sea::Given(1, {20.0, 5.0}, 3), Sea::Given(2, {40.0, 5.0}, 2)});
  sea.Scan({Sea::Standing(7, {20.5, 5.0}), Sea::Standing(8, {40.0, 5.0})});
  EXPECT_EQ(sea.Scan({Sea::Standing(7, {20.5, 5.0}), Sea::Standing(8, {40.0, 5.0})}).known_days, 3);
  EXPECT_EQ(sea.Scan({Sea::Standing(8, {40.0, 5.0})}).known_days, 0) << "two days are not enough";
  EXPECT_EQ(sea.things.num_known_seen(), 1);
}

TEST(Standing, IsNotKnownElsewhereOrOfAnotherSizeOrWhenItMoves) {
  const auto known_days = [](Track track) {
    Sea sea;
    sea.things.Give({Sea::Given(1, {20.0, 5.0}, 5)});
    sea.Scans(15, {track});
    return sea.Scan({track}).known_days;
  };
  EXPECT_EQ(known_days(Sea::Standing(7, {20.0, 5.0})), 5);
  EXPECT_EQ(known_days(Sea::Standing(7, {22.0, 5.0})), 0) << "1 m and two deviations of both are 1.85 m";
  auto large = Sea::Standing(7, {20.0, 5.0});
  large.rectangle.length_m = 6.0;
  EXPECT_EQ(known_days(large), 0);
  auto moving = Sea::Standing(7, {20.0, 5.0});
  moving.velocity_mps = {0.5, 0.0};
  EXPECT_EQ(known_days(moving), 0);
}

TEST(Standing, OfTwoTracksTheNearerIsTheThing) {
  Sea sea;
  sea.things.Give({Sea::Given(1, {20.0, 5.0}, 3)});
  const std::vector<Track> tracks{Sea::Standing(3, {20.9, 5.0}), Sea::Standing(4, {20.1, 5.0})};
  sea.Scan(tracks);
  EXPECT_EQ(sea.Scan(tracks).known_days, 0);
  EXPECT_EQ(sea.Scan({tracks[1]}).known_days, 3);
}

TEST(Standing, IsGoneWhenItsPlaceIsLookedThrough) {
  Sea sea;
  sea.things.Give({Sea::Given(1, {20.0, 5.0}, 3)});
  sea.Scans(100, {});
  EXPECT_EQ(sea.things.num_gone(), 0) << "ten looks";
  sea.Scans(150, {});
  EXPECT_EQ(sea.things.num_gone(), 1);
  const auto changed = sea.things.TakeChanged();
  ASSERT_EQ(changed.size(), 1U);
  EXPECT_EQ(changed[0].state, MapThing::State::kGone);
  EXPECT_TRUE(changed[0].gone);
  EXPECT_TRUE(changed[0].days.empty()) << "not seen by this process";
  // It comes back.
  const auto back = Sea::Standing(9, {20.0, 5.0});
  sea.Scans(15, {back});
  EXPECT_EQ(sea.things.num_gone(), 0);
  EXPECT_EQ(sea.things.TakeChanged().at(0).gone, std::nullopt);
}

TEST(Standing, IsNotGoneWhereNothingCouldBeSeen) {
  Sea sea;
  sea.things.Give({Sea::Given(1, {20.0, 5.0}, 3), Sea::Given(2, {300.0, 5.0}, 3)});
  sea.Scans(400, {}, 8.0F);  // something nearer, all round
  EXPECT_EQ(sea.things.num_gone(), 0);
  sea.Scans(400, {}, 20.5F);  // what stands there is hit, though no track has it
  EXPECT_EQ(sea.things.num_gone(), 0);
  sea.Scans(400, {});
  EXPECT_EQ(sea.things.num_gone(), 1) << "the other is out of reach";
}

TEST(Standing, NamesTheDayOnWhichItWasFoundGoneFirst) {
  Sea sea;
  auto given = Sea::Given(1, {20.0, 5.0}, 3);
  given.gone = Utime(std::chrono::seconds(1'650'000'000));
  sea.things.Give({given});
  sea.Scans(250, {});
  EXPECT_EQ(sea.things.num_gone(), 0) << "that is told already";
  EXPECT_EQ(sea.things.TakeChanged().at(0).gone, given.gone);
}

TEST(Standing, IsNotKeptBeforeAMapWasGiven) {
  Sea sea;
  sea.Scans(150, {Sea::Standing(7, {20.0, 5.0})});
  EXPECT_TRUE(sea.things.TakeChanged().empty());
}

}  // namespace
}  // namespace lookout::tracker::standing
