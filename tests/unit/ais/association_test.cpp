// Pairs of ships and tracks: exclusive, sticky, unsure where AIS cannot tell.
#include "services/ais/core/association.hpp"

#include <deque>
#include <gtest/gtest.h>

#include "tests/support/counters.hpp"

namespace lookout::ais {
namespace {

using namespace std::chrono_literals;

struct Water {
  std::deque<Ship> ships;
  std::vector<ShipInReach> in_reach;
  std::vector<TrackedThing> tracks;
  Association association{AssociationParams{}};
  Utime time{1'800'000'000s};

  ShipInReach& AddShip(std::int32_t mmsi, const Eigen::Vector2d& p_m, double sd_m = 5.0) {
    auto& ship = ships.emplace_back();
    ship.mmsi = mmsi;
    auto& one = in_reach.emplace_back();
    one.ship = &ship;
    one.predicted.center_map_m = one.predicted.antenna_map_m = p_m;
    one.predicted.covariance_m2 = Eigen::Matrix2d::Identity() * (sd_m * sd_m);
    one.predicted.velocity_map_mps = Eigen::Vector2d::Zero();
    one.predicted.velocity_sd_mps = 0.2;
    return one;
  }
  TrackedThing& AddTrack(std::int64_t id, const Eigen::Vector2d& p_m) {
    auto& track = tracks.emplace_back();
    track.id = id;
    track.center_map_m = p_m;
    track.covariance_m2 = Eigen::Matrix2d::Identity();
    track.velocity_covariance = Eigen::Matrix2d::Identity() * 0.04;
    return track;
  }
  std::vector<Identity> Run(int num_scans) {
    std::vector<Identity> identities;
    for (int i = 0; i < num_scans; ++i) {
      time += 100ms;
      identities = association.Update(time, in_reach, tracks);
    }
    return identities;
  }
};

TEST(AisAssociation, PairProbabilitiesAreExactForTwoAndTwo) {
  // All four ways: both straight, both crossed, one or none.
  const double a = 3.0;
  const double b = 0.5;
  const double c = 0.25;
  const double d = 4.0;
  Eigen::MatrixXd weight(2, 2);
  weight << a, b, c, d;
  const auto probability = PairProbabilities(weight, Eigen::VectorXd::Constant(2, 0.1));
  const double none = 0.1;
  const double all = a * d + b * c + (a + b) * none + (c + d) * none + none * none;
  EXPECT_NEAR(probability(0, 0), (a * d + a * none) / all, 0.02);
  EXPECT_NEAR(probability(1, 1), (a * d + d * none) / all, 0.02);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(probability.row(i).sum(), 1.0, 1e-9);
}

TEST(AisAssociation, ALoneShipIsTheLoneTrackAfterSomeSeconds) {
  Water water;
  water.AddShip(211000001, {100.0, 4.0});
  water.AddTrack(7, {103.0, 0.0});
  EXPECT_FALSE(water.Run(5)[0].is_sure);
  const auto identity = water.Run(100)[0];
  EXPECT_TRUE(identity.is_sure);
  EXPECT_EQ(identity.track_id, 7);
  EXPECT_GT(identity.probability, 0.99);
}

TEST(AisAssociation, ATrackFarFromTheShipIsAnother) {
  Water water;
  water.AddShip(211000001, {100.0, 0.0});
  water.AddTrack(7, {160.0, 0.0});
  const auto identity = water.Run(200)[0];
  EXPECT_FALSE(identity.is_sure);
  EXPECT_EQ(identity.track_id, 0);
  EXPECT_EQ(identity.none_probability, 1.0);
}

TEST(AisAssociation, OneShipBetweenTwoTracksStaysUnsure) {
  Water water;
  water.AddShip(211000001, {100.0, 0.0});
  water.AddTrack(7, {94.0, 0.0});
  water.AddTrack(8, {107.0, 0.0});
  const auto identity = water.Run(3000)[0];
  EXPECT_FALSE(identity.is_sure);
  EXPECT_LT(identity.probability, 0.9);
}

TEST(AisAssociation, TwoShipsFifteenMetresApartAreTheirTracksInAccurateFixesAlone) {
  for (const double sd_m : {2.5, 12.0}) {
    Water water;
    water.AddShip(211000001, {100.0, 1.0}, sd_m);
    water.AddShip(211000002, {116.0, 1.0}, sd_m);
    water.AddTrack(7, {101.0, 0.0});
    water.AddTrack(8, {116.0, 0.0});
    const auto identities = water.Run(300);
    EXPECT_EQ(identities[0].is_sure, sd_m < 5.0) << sd_m;
    EXPECT_EQ(identities[1].is_sure, sd_m < 5.0) << sd_m;
    EXPECT_EQ(identities[0].track_id, 7) << sd_m;
    EXPECT_EQ(identities[1].track_id, 8) << sd_m;
  }
}

TEST(AisAssociation, AWrongLengthSpeaksAgainstAPair) {
  Water water;
  water.AddShip(211000001, {100.0, 0.0});
  water.ships[0].dimensions = {40.0, 40.0, 6.0, 6.0, true};
  auto& track = water.AddTrack(7, {100.0, 2.0});
  track.length_m = 8.0;
  track.width_m = 3.0;
  track.seen_share = 0.8;
  EXPECT_LT(water.Run(300)[0].probability, 0.9);
  track.length_m = 78.0;
  track.width_m = 12.0;
  EXPECT_TRUE(water.Run(300)[0].is_sure);
}

TEST(AisAssociation, AMovingTrackIsNoShipThatLiesStill) {
  Water water;
  water.AddShip(211000001, {100.0, 0.0});
  auto& track = water.AddTrack(7, {100.0, 2.0});
  track.velocity_map_mps = {4.0, 0.0};
  EXPECT_FALSE(water.Run(30)[0].is_sure);
  EXPECT_LT(VelocityLogOdds(water.in_reach[0].predicted, track), -2.0);
  water.in_reach[0].predicted.velocity_map_mps = {4.2, 0.1};
  EXPECT_GT(VelocityLogOdds(water.in_reach[0].predicted, track), 2.0);
}

TEST(AisAssociation, ASurePairOutlivesADoubtfulReportAndNotALastingOne) {
  Water water;
  auto& ship = water.AddShip(211000001, {100.0, 0.0});
  water.AddTrack(7, {101.0, 0.0});
  ASSERT_TRUE(water.Run(200)[0].is_sure);
  ship.predicted.center_map_m.x() += 40.0;
  EXPECT_TRUE(water.Run(20)[0].is_sure) << "two seconds of a bad fix";
  ship.predicted.center_map_m.x() -= 40.0;
  EXPECT_TRUE(water.Run(100)[0].is_sure);
  ship.predicted.center_map_m.x() += 100.0;
  EXPECT_FALSE(water.Run(300)[0].is_sure);
  EXPECT_EQ(support::CountOf(water.association, "pairs_given_up"), 1);
}

TEST(AisAssociation, APairEndsWithItsTrack) {
  Water water;
  water.AddShip(211000001, {100.0, 0.0});
  water.AddTrack(7, {101.0, 0.0});
  ASSERT_TRUE(water.Run(200)[0].is_sure);
  water.tracks.clear();
  water.AddTrack(9, {101.0, 0.0});
  EXPECT_FALSE(water.Run(1)[0].is_sure);
  EXPECT_EQ(support::CountOf(water.association, "pairs_ended"), 1);
  const auto again = water.Run(200)[0];
  EXPECT_TRUE(again.is_sure);
  EXPECT_EQ(again.track_id, 9);
}

TEST(AisAssociation, OneTrackIsOneShip) {
  Water water;
  water.AddShip(211000001, {100.0, 0.0}, 3.0);
  water.AddShip(211000002, {100.5, 0.0}, 3.0);
  water.AddTrack(7, {100.0, 1.0});
  const auto identities = water.Run(1000);
  EXPECT_FALSE(identities[0].is_sure && identities[1].is_sure);
  EXPECT_LE(identities[0].probability + identities[1].probability, 1.05);
}

}  // namespace
}  // namespace lookout::ais
