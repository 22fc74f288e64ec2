// Which part of the guard zone nobody looks into: geometry, limits of the config, and what the beams of the scans tell.
#include "services/tracker/core/zone_sight.hpp"

#include <algorithm>
#include <functional>
#include <gtest/gtest.h>
#include <string>

#include "common/core/frames.hpp"

namespace lookout::tracker {
namespace {

constexpr double kHeightM = 1.0;  // of the lidar over the water

std::vector<float> Elevations(double most_deg = 15.0) {
  std::vector<float> elevation_rad;
  for (int i = 0; i < 16; ++i) elevation_rad.push_back(static_cast<float>(DegToRad(most_deg * (2.0 * i / 15.0 - 1.0))));
  return elevation_rad;
}

// A boat of 2.4 m x 1.4 m with its lidar amidships, the vessel's origin at the water, and a zone of 10 m, 60 deg to each side of the bow.
ZoneSightParams MakeParams(double from_deg = 300.0, double width_deg = 120.0) {
  ZoneSightParams params;
  params.zone.range_m = 10.0;
  params.zone.bearing = {DegToRad(from_deg), width_deg >= 360.0 ? kTwoPi : DegToRad(width_deg)};
  params.min_range_m = 0.5;
  params.T_vessel_lidar = TransformVesselSensor({.p_vessel_m = {0.0, 0.0, kHeightM}});
  params.own_vessel_box_m = {Eigen::Vector3d(-1.4, -0.9, -1.0), Eigen::Vector3d(1.4, 0.9, 2.0)};
  params.own_hull_m = {Eigen::Vector2d(-1.2, -0.7), Eigen::Vector2d(1.2, 0.7)};
  return params;
}

std::string InWords(const std::vector<UnseenPart>& parts) {
  std::string text;
  for (const auto& part : parts) {
    text += (text.empty() ? "" : "; ") + std::to_string(std::lround(RadToDeg(part.bearing.start_rad)) % 360) + " to " +
            std::to_string(std::lround(RadToDeg(part.bearing.start_rad + part.bearing.width_rad)) % 360) + " why " +
            std::to_string(static_cast<int>(part.why));
    if (!part.begins_with_zone) text += " from " + std::to_string(std::lround(10.0 * part.from_m)) + " dm";
    if (!part.ends_with_zone) text += " up to " + std::to_string(std::lround(10.0 * part.to_m)) + " dm";
    if (!part.is_wide) text += " narrow";
  }
  return text;
}

std::string ByConfig(const ZoneSightParams& params) { return InWords(ZoneGrid(params, Elevations(), ZoneSight::kPostM).PartsByConfig()); }

TEST(ZoneByConfig, IsLookedIntoByALidarThatStandsUpright) {
  EXPECT_EQ(ByConfig(MakeParams()), "");
  EXPECT_EQ(ByConfig(MakeParams(0.0, 360.0)), "");
  auto params = MakeParams();
  params.zone.range_m = 2.0;
  EXPECT_EQ(ByConfig(params), "");
  params.zone.range_m = 100.0;
  EXPECT_EQ(ByConfig(params), "");
  // A large boat with its lidar at the bow.
  params = MakeParams(0.0, 360.0);
  params.zone.range_m = 30.0;
  params.own_vessel_box_m = {Eigen::Vector3d(-8.0, -2.5, -1.0), Eigen::Vector3d(8.0, 2.5, 4.0)};
  params.own_hull_m = {Eigen::Vector2d(-8.0, -2.5), Eigen::Vector2d(8.0, 2.5)};
  params.T_vessel_lidar.translation() << 7.0, 0.5, 3.5;
  EXPECT_EQ(ByConfig(params), "") << "what lies below its lowest beam was seen before it came so near";
}

// min_range_m: 20 against a zone of 10 m was taken, and nothing was ever seen in the zone.
TEST(ZoneByConfig, IsCutByTheRangesOfTheSegmenter) {
  auto params = MakeParams();
  params.min_range_m = 20.0;
  EXPECT_EQ(ByConfig(params), "300 to 60 why 2");
  params.min_range_m = 0.5;
  params.max_range_m = 5.0;
  EXPECT_EQ(ByConfig(params), "300 to 60 why 3 from 50 dm");
  params.min_range_m = 3.0;
  params.max_range_m = 7.0;
  EXPECT_EQ(ByConfig(params), "300 to 60 why 3 from 70 dm; 300 to 60 why 2 up to 30 dm");
  params.min_range_m = 1.5;
  params.max_range_m = 120.0;
  EXPECT_EQ(ByConfig(params), "") << "that is all but inside of the hull";
}

TEST(ZoneByConfig, IsCutByTheFieldOfViewHoweverTheLidarIsTurned) {
  const Sector astern{DegToRad(90.0), DegToRad(180.0)};
  auto params = MakeParams();
  params.field_of_view = astern;
  EXPECT_EQ(ByConfig(params), "300 to 60 why 4");
  params = MakeParams(0.0, 360.0);
  params.field_of_view = astern;
  EXPECT_EQ(ByConfig(params), "270 to 90 why 4") << "across the seam over the bow";
  // Yaw is counter-clockwise: azimuth 90 of a lidar that is turned by 90 deg points ahead.
  params.T_vessel_lidar = TransformVesselSensor({.p_vessel_m = {0.0, 0.0, kHeightM}, .yaw_rad = kPi / 2.0});
  EXPECT_EQ(ByConfig(params), "180 to 0 why 4");
  params.T_vessel_lidar = TransformVesselSensor({.p_vessel_m = {0.0, 0.0, kHeightM}, .yaw_rad = kPi});
  EXPECT_EQ(ByConfig(params), "90 to 270 why 4");
  // Upside down: azimuths run the other way round.
  params.field_of_view = {DegToRad(0.0), DegToRad(90.0)};
  params.T_vessel_lidar = TransformVesselSensor({.p_vessel_m = {0.0, 0.0, kHeightM}, .roll_rad = kPi});
  EXPECT_EQ(ByConfig(params), "0 to 270 why 4");
  params.field_of_view = {DegToRad(0.0), DegToRad(358.0)};
  EXPECT_EQ(ByConfig(params), "0 to 2 why 4 narrow");
}

TEST(ZoneByConfig, NeedsABeamNearTheWater) {
  auto params = MakeParams();
  params.T_vessel_lidar.translation().z() = 6.0;
  EXPECT_EQ(ByConfig(params), "300 to 60 why 1") << "at 10 m the lowest beam is 3.3 m above the water";
  params.T_vessel_lidar.translation().z() = 3.5;
  EXPECT_EQ(ByConfig(params), "") << "at 10 m it is 0.8 m above it";
  params.T_vessel_lidar = TransformVesselSensor({.p_vessel_m = {0.0, 0.0, kHeightM}, .pitch_rad = DegToRad(30.0)});
  EXPECT_NE(ByConfig(params).find("why 1 from"), std::string::npos) << ByConfig(params);
}

TEST(ZoneByConfig, HoldsNotWhatTheBoxOfTheOwnVesselHidesFarFromTheHull) {
  auto params = MakeParams();
  params.own_vessel_box_m = {Eigen::Vector3d(-1.4, -0.9, -1.0), Eigen::Vector3d(8.0, 0.9, 2.0)};
  EXPECT_EQ(ByConfig(params), "344 to 16 why 5 up to 80 dm");
  params.own_hull_m = {Eigen::Vector2d(-1.4, -0.9), Eigen::Vector2d(8.0, 0.9)};
  EXPECT_EQ(ByConfig(params), "") << "a hull so long";
}

// Scans of 0.1 s, 0.4 deg from column to column.
class TheZone : public ::testing::Test {
 protected:
  using Fires = std::function<bool(double azimuth_deg)>;
  using RangeAt = std::function<double(double azimuth_deg, std::size_t ring)>;

  void Scans(ZoneSight& sight, int count, const Fires& fires, const RangeAt& range_at = Nothing) {
    for (int i = 0; i < count; ++i) {
      Sweep sweep;
      sweep.elevation_rad = Elevations();
      sweep.azimuth_offset_rad.assign(sweep.elevation_rad.size(), 0.001F);
      for (int column = 0; column < 900; ++column) {
        const double azimuth_deg = 0.4 * column;
        if (!fires(azimuth_deg)) continue;
        sweep.azimuth_rad.push_back(static_cast<float>(DegToRad(azimuth_deg)));
        sweep.time.push_back(time_);
        for (std::size_t ring = 0; ring < sweep.elevation_rad.size(); ++ring) {
          sweep.range_m.push_back(static_cast<float>(range_at(azimuth_deg, ring)));
        }
      }
      sight.Update(time_ += std::chrono::milliseconds(100), sweep);
    }
  }
  static double Nothing(double, std::size_t) { return 0.0; }
  static bool Always(double) { return true; }
  static bool Astern(double azimuth_deg) { return azimuth_deg > 90.2 && azimuth_deg < 269.8; }

  Utime time_{std::chrono::seconds(1'700'000'000)};
};

TEST_F(TheZone, IsLookedIntoOverEmptyWater) {
  for (const double width_deg : {120.0, 360.0}) {
    ZoneSight sight(MakeParams(300.0, width_deg));
    Scans(sight, 100, Always);
    EXPECT_EQ(InWords(sight.parts()), "");
    EXPECT_EQ(sight.unseen_deg(), 0);
    EXPECT_FALSE(sight.danger());
  }
}

// The field of view is set on the lidar's own web page: it sends nothing of the rest, and no config knows.
TEST_F(TheZone, IsNotLookedIntoWhereTheLidarDoesNotFire) {
  ZoneSight sight(MakeParams());
  Scans(sight, 20, Astern);
  EXPECT_FALSE(sight.danger()) << "not yet";
  Scans(sight, 15, Astern);
  EXPECT_EQ(InWords(sight.parts()), "300 to 60 why 6");
  EXPECT_TRUE(sight.is_whole());
  ASSERT_TRUE(sight.danger());
  EXPECT_EQ(sight.danger()->cause, AlertCause::kWatch);
  EXPECT_TRUE(sight.danger()->is_grave);
  EXPECT_NEAR(WrapToPi(sight.danger()->bearing_rad), 0.0, 0.02);

  ZoneSight all_round(MakeParams(0.0, 360.0));
  Scans(all_round, 35, Astern);
  EXPECT_EQ(InWords(all_round.parts()), "270 to 90 why 6");
  EXPECT_FALSE(all_round.is_whole());
  EXPECT_FALSE(all_round.danger()->is_grave) << "a caution";
  EXPECT_EQ(all_round.unseen_deg(), 180);

  Scans(all_round, 35, Astern);
  Scans(all_round, 15, Always);
  EXPECT_EQ(InWords(all_round.parts()), "270 to 90 why 6") << "not for long enough";
  Scans(all_round, 10, Always);
  EXPECT_FALSE(all_round.danger());
  EXPECT_EQ(all_round.unseen_deg(), 0);
}

// Packets that are lost leave holes, each time elsewhere; and where two scans of three look an alert can be raised.
TEST_F(TheZone, IsLookedIntoWhereMostScansLook) {
  ZoneSight sight(MakeParams(0.0, 360.0));
  for (int i = 0; i < 100; ++i) {
    Scans(sight, 1, [i](double azimuth_deg) { return (static_cast<int>(azimuth_deg) + 40 * i) % 360 >= 120; });
    ASSERT_EQ(InWords(sight.parts()), "") << i;
  }
}

// A mast of 0.2 m, 0.9 m from the lidar, is 13 deg wide: each beam of 13 deg ends on it.
TEST_F(TheZone, IsHiddenByTheOwnMast) {
  const auto mast = [](double from_deg, double to_deg) {
    return [=](double azimuth_deg, std::size_t) { return azimuth_deg >= from_deg && azimuth_deg <= to_deg ? 0.9 : 0.0; };
  };
  ZoneSight sight(MakeParams());
  Scans(sight, 50, Always, mast(10.0, 23.2));
  EXPECT_EQ(InWords(sight.parts()), "10 to 23 why 7");
  // Dirt on the lidar: nearer than min_range_m.
  ZoneSight dirty(MakeParams());
  Scans(dirty, 50, Always, [](double azimuth_deg, std::size_t) { return azimuth_deg <= 20.0 || azimuth_deg >= 340.0 ? 0.3 : 0.0; });
  EXPECT_EQ(InWords(dirty.parts()), "340 to 20 why 7");
  // A thin one is counted and raises no alert.
  ZoneSight thin(MakeParams());
  Scans(thin, 50, Always, mast(10.0, 13.2));
  EXPECT_EQ(InWords(thin.parts()), "");
  EXPECT_EQ(thin.unseen_deg(), 3);
  EXPECT_FALSE(thin.danger());
}

TEST_F(TheZone, IsNotHiddenByTheDeckNorByWhatLiesInTheZone) {
  ZoneSight sight(MakeParams(0.0, 360.0));
  // The lowest four rings end on the own deck; a quay stands 3 m off to starboard.
  Scans(sight, 50, Always, [](double azimuth_deg, std::size_t ring) {
    if (ring < 4) return 1.2;
    return azimuth_deg > 30.0 && azimuth_deg < 150.0 ? 3.0 / std::sin(DegToRad(azimuth_deg)) : 0.0;
  });
  EXPECT_EQ(InWords(sight.parts()), "");
}

// Else one acknowledgement would hide whatever is lost later.
TEST_F(TheZone, TellsAnewWhatWasNotTold) {
  ZoneSight sight(MakeParams(0.0, 360.0));
  const auto without = [](double from_deg, double to_deg) {
    return [=](double azimuth_deg) { return azimuth_deg < from_deg || azimuth_deg >= to_deg; };
  };
  Scans(sight, 40, without(30.0, 60.0));
  const auto first = sight.danger()->thing;
  Scans(sight, 40, without(28.0, 62.0));
  EXPECT_EQ(sight.danger()->thing, first) << "as good as the same";
  Scans(sight, 40, without(28.0, 100.0));
  const auto second = sight.danger()->thing;
  EXPECT_NE(second, first);
  Scans(sight, 40, without(28.0, 60.0));
  EXPECT_EQ(sight.danger()->thing, second);
  Scans(sight, 40, without(28.0, 100.0));
  EXPECT_NE(sight.danger()->thing, second) << "it was seen meanwhile";
}

TEST_F(TheZone, IsNothingWithoutARangeOrBeams) {
  auto params = MakeParams();
  params.zone.range_m = 0.0;
  ZoneSight none(params);
  Scans(none, 50, Astern);
  EXPECT_FALSE(none.danger());
  ZoneSight sight(MakeParams());
  for (int i = 0; i < 50; ++i) sight.Update(time_ += std::chrono::milliseconds(100), Sweep{});
  EXPECT_FALSE(sight.danger());
}

// Offsets of a whole circle are valid: azimuths wrap.
TEST_F(TheZone, TakesAzimuthsBeyondTheCircle) {
  for (const float offset_rad : {-6.283F, 6.283F}) {
    ZoneSight sight(MakeParams(0.0, 360.0));
    for (int i = 0; i < 50; ++i) {
      Sweep sweep;
      sweep.elevation_rad = Elevations();
      sweep.azimuth_offset_rad.assign(sweep.elevation_rad.size(), offset_rad);
      for (int column = 0; column <= 360; ++column) sweep.azimuth_rad.push_back(static_cast<float>(DegToRad(column)));
      sweep.range_m.assign(sweep.azimuth_rad.size() * sweep.elevation_rad.size(), 0.0F);
      sight.Update(time_ += std::chrono::milliseconds(100), sweep);
    }
    EXPECT_EQ(InWords(sight.parts()), "");
  }
}

// Time that goes back or stands still between scans gives nothing away.
TEST_F(TheZone, TakesItsTimeFromScansAlone) {
  ZoneSight sight(MakeParams());
  Scans(sight, 2, Astern);
  time_ += std::chrono::hours(1);
  Scans(sight, 1, Astern);
  EXPECT_FALSE(sight.danger()) << "one scan in an hour";
  time_ -= std::chrono::hours(2);
  Scans(sight, 1, Astern);
  EXPECT_FALSE(sight.danger());
  Scans(sight, 30, Astern);
  EXPECT_TRUE(sight.danger());
}

}  // namespace
}  // namespace lookout::tracker
