// What the lidar meets besides clean surfaces: each effect with its reason, its strength and its absence.
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <numeric>
#include <set>
#include <vector>

#include "common/core/angles.hpp"
#include "common/core/bytes.hpp"
#include "common/core/frames.hpp"
#include "lab/sim/scene.hpp"
#include "tests/unit/sim/effects_fixture.hpp"

namespace lookout::sim {
namespace {

namespace format = vlp16::format;
using Eigen::Vector3d;

// x, y, z of a return by the manual's formulas, with nothing of the decoder: by slot. Azimuths between two blocks are interpolated.
std::map<int, Vector3d> Positions(const LidarPacket& packet, bool is_dual) {
  const std::size_t step = is_dual ? 2 : 1;
  std::array<double, 12> azimuth_deg{};
  for (std::size_t block = 0; block < 12; ++block) azimuth_deg[block] = ReadU16LittleEndian(packet.payload, block * 100 + 2) / 100.0;
  std::map<int, Vector3d> positions;
  for (std::size_t block = 0; block < 12; ++block) {
    const std::size_t pair = block - block % step;
    const std::size_t from = pair + step < 12 ? pair : pair - step;
    double turned_deg = azimuth_deg[from + step] - azimuth_deg[from];
    if (turned_deg < 0.0) turned_deg += 360.0;
    for (std::size_t k = 0; k < 32; ++k) {
      const std::size_t at = block * 100 + 4 + k * 3;
      const int count = packet.payload[at] + 256 * packet.payload[at + 1];
      if (count == 0) continue;
      const std::size_t laser = k % 16;
      const double since_us = 55.296 * static_cast<double>(k / 16) + 2.304 * static_cast<double>(laser);
      const double alpha = (azimuth_deg[block] + turned_deg * since_us / 110.592) * kPi / 180.0;
      const double omega = (laser % 2 == 0 ? -15.0 + static_cast<double>(laser) : static_cast<double>(laser)) * kPi / 180.0;
      const double range_m = count * 0.002;
      positions[static_cast<int>(block * 32 + k)] = {range_m * std::cos(omega) * std::cos(alpha), -range_m * std::cos(omega) * std::sin(alpha),
                                                     range_m * std::sin(omega)};
    }
  }
  return positions;
}

// The nearest surface along a ray, by all parts of all objects.
std::optional<Hit> NearestByForce(const Scene& scene, const Ray& ray, double time_s) {
  std::optional<Hit> nearest;
  for (const auto& object : scene.objects) {
    const Eigen::Isometry3d T_object_map = PoseAt(object, scene.sea, time_s).inverse();
    const Ray own{T_object_map * ray.origin_m, T_object_map.linear() * ray.direction};
    for (const auto& part : object.parts) {
      const auto hit = Intersect(part.solid, own);
      if (hit && hit->range_m < (nearest ? nearest->range_m : 110.0)) nearest = hit;
    }
  }
  return nearest;
}

Scene BusyScene(const Effects& effects, const Sea& sea) {
  Scene scene;
  scene.own_motion = {.semi_axes_m = {12.0, 8.0}, .period_s = 30.0};
  scene.own_motion.roll_rad = {{DegToRad(5.0), 3.0, 0.0}};
  scene.own_motion.pitch_rad = {{DegToRad(3.0), 2.5, 1.0}};
  scene.own_motion.heave_m = {{0.2, 2.8, 2.0}};
  scene.effects = effects;
  scene.sea = sea;
  int id = 0;
  for (const double bearing_rad : {0.3, 1.7, 2.9, 4.1, 5.5}) {
    Track track{{{(20.0 + 4.0 * id) * std::sin(bearing_rad), (20.0 + 4.0 * id) * std::cos(bearing_rad)}, bearing_rad + 1.0}, 3.0, 0.1};
    std::vector<Part> parts{{Prism{Rectangle(-2.5, 2.5, -1.0, 1.0), -0.3, 0.8}, {0.5}},
                            {Cylinder{{0.5, 0.0}, 0.1, 0.8, 6.0}, {0.6}},
                            {Ellipsoid{{-1.0, 0.0, 1.2}, {0.4, 0.4, 0.6}}, {0.4}}};
    scene.objects.push_back({++id, "boat", "boat", track, std::move(parts), Rectangle(-2.5, 2.5, -1.0, 1.0), true, {5.0, 2.0}});
  }
  return scene;
}

TEST(Effects, PacketsSayWhereTheRaysMetTheirObjectsToACentimetre) {
  for (const auto& sea : {Sea(), ChoppySea()}) {
    const auto scene = BusyScene(QuietEffects(), sea);
    const auto boat = SmallBoat();
    Lidar lidar(scene, boat, LidarParams{}, kEffectsStart, 3);
    int num_checked = 0;
    for (int i = 0; i < 4 * kPacketsPerTurn; ++i) {
      const auto packet = lidar.Next();
      const auto positions = Positions(packet, false);
      ASSERT_EQ(positions.size(), packet.returns.size());
      for (const auto& made : packet.returns) {
        if (made.reason != ReturnReason::kObject) continue;
        const double time_s =
            ToSeconds(packet.stamp - kEffectsStart) + 110.592e-6 * (made.slot / 32) + 55.296e-6 * (made.slot / 16 % 2) + 2.304e-6 * (made.slot % 16);
        const double elevation_rad = DegToRad(format::kElevationDegVlp16[static_cast<std::size_t>(made.slot % 16)]);
        const Vector3d direction = BeamDirection(lidar.AzimuthAt(time_s), elevation_rad);
        const Eigen::Isometry3d T_map_lidar =
            StateAt(scene.own_motion, boat.reference_point_above_water_m, time_s).T_map_vessel() * boat.T_vessel_lidar;
        const auto hit = NearestByForce(scene, {T_map_lidar.translation(), T_map_lidar.linear() * direction}, time_s);
        if (!hit) continue;  // the edge of a thing, met some micrometres beside it
        // Along a surface that is hardly met at all, the half millisecond between two places of a rider is more than a centimetre.
        if (hit->incidence_cosine < 0.25) continue;
        const Vector3d truth_m = hit->range_m * direction;
        if ((truth_m - made.p_lidar_m).norm() > 0.05) continue;  // likewise, with another surface behind
        EXPECT_LT((positions.at(made.slot) - truth_m).norm(), 0.01) << "slot " << made.slot << " at " << hit->range_m << " m";
        ++num_checked;
      }
    }
    EXPECT_GT(num_checked, 500);
  }
}

TEST(Effects, PacketsSayWhereEveryReturnOfEveryEffectIsToACentimetre) {
  Effects effects = QuietEffects();
  effects.set_horizontal_divergence_mrad(3.0);
  effects.set_vertical_divergence_mrad(1.5);
  effects.set_glint_probability(0.2);
  effects.set_crest_probability(0.5);
  effects.set_wake_probability(0.8);
  effects.set_spray_probability(0.1);
  effects.set_rain_probability_per_m(0.004);
  effects.set_mirror_strength(1.0);
  effects.set_flying_birds(50);
  effects.set_fog_probability(0.02);
  std::set<ReturnReason> reasons;
  for (const auto mode : {config::Scene::STRONGEST, config::Scene::DUAL}) {
    for (const auto& sea : {Sea(), ChoppySea()}) {
      effects.set_return_mode(mode);
      const auto scene = BusyScene(effects, sea);
      Lidar lidar(scene, SmallBoat(), LidarParams{}, kEffectsStart, 3);
      for (int i = 0; i < 8 * kPacketsPerTurn; ++i) {
        const auto packet = lidar.Next();
        const auto positions = Positions(packet, mode == config::Scene::DUAL);
        ASSERT_EQ(positions.size(), packet.returns.size());
        for (const auto& made : packet.returns) {
          reasons.insert(made.reason);
          // Azimuths are rounded to 0.01 deg, and two of them give the rotation of the head: 0.01 deg are a centimetre at 57 m.
          const double limit_m = std::max(0.01, made.p_lidar_m.norm() * DegToRad(0.0105));
          ASSERT_LT((positions.at(made.slot) - made.p_lidar_m).norm(), limit_m) << NameOf(made.reason);
          const bool is_of_object = made.reason == ReturnReason::kObject || made.reason == ReturnReason::kMixedEdge;
          EXPECT_EQ(made.object_id > 0, is_of_object) << NameOf(made.reason);
          EXPECT_EQ(made.object_id == kOwnVessel, made.reason == ReturnReason::kOwnVessel);
        }
      }
    }
  }
  for (std::size_t reason = 0; reason < kReasonNames.size(); ++reason) {
    if (reason == static_cast<std::size_t>(ReturnReason::kStray)) continue;
    EXPECT_TRUE(reasons.contains(static_cast<ReturnReason>(reason))) << kReasonNames[reason];
  }
}

TEST(Effects, AreAbsentAtStrengthZero) {
  for (const auto& sea : {Sea(), ChoppySea()}) {
    for (const auto& [reason, count] : CountReasons(BusyScene(QuietEffects(), sea), 4 * kPacketsPerTurn)) {
      EXPECT_TRUE(reason == ReturnReason::kObject || reason == ReturnReason::kOwnVessel) << NameOf(reason) << ' ' << count;
    }
  }
}

TEST(Effects, StraysComeAsOftenAsTheySay) {
  Effects effects = QuietEffects();
  effects.set_stray_probability(0.01);
  auto scene = OpenWater(effects);
  const int num_shots = 4 * kPacketsPerTurn * kShotsPerPacket;
  auto counts = CountReasons(scene, 4 * kPacketsPerTurn);
  const int num_free = num_shots - counts[ReturnReason::kOwnVessel];
  // Strays that would be under water are not.
  EXPECT_NEAR(counts[ReturnReason::kStray], 0.01 * num_free, 5.0 * std::sqrt(0.01 * num_free));
}

// A seed gives the same data in each release: also where the noise of range leaves nothing of a drop.
TEST(Effects, DropsDrawTheSameNumbersAtAnyRange) {
  Effects effects = QuietEffects();
  effects.set_rain_probability_per_m(0.01);
  effects.set_range_sd_m(0.7);
  const auto scene = OpenWater(effects);
  Lidar lidar(scene, SmallBoat(), LidarParams{}, kEffectsStart, 9);
  std::int64_t sum_of_bytes = 0;
  for (int i = 0; i < kPacketsPerTurn; ++i) {
    const auto packet = lidar.Next();
    sum_of_bytes = std::accumulate(packet.payload.begin(), packet.payload.end(), sum_of_bytes);
  }
  EXPECT_EQ(sum_of_bytes, 1018689);
}

TEST(Effects, RainComesAsOftenAsItSaysAndMostlyNear) {
  for (const double per_m : {0.001, 0.01}) {
    Effects effects = QuietEffects();
    effects.set_rain_probability_per_m(per_m);
    double sum_expected = 0.0;
    int count = 0;
    int num_near = 0;
    const auto scene = OpenWater(effects);
    Lidar lidar(scene, SmallBoat(), LidarParams{}, kEffectsStart, 9);
    for (int i = 0; i < 4 * kPacketsPerTurn; ++i) {
      for (const auto& made : lidar.Next().returns) {
        if (made.reason != ReturnReason::kRain) continue;
        ++count;
        num_near += made.p_lidar_m.norm() < 5.0 ? 1 : 0;
        EXPECT_EQ(made.object_id, kNoObject);
      }
    }
    // A beam is 2 m above the water: 15 deg below level it ends after 7.7 m, 1 deg after 115 m.
    for (const double elevation_deg : format::kElevationDegVlp16) {
      const double end_m = elevation_deg < 0.0 ? std::min(110.0, 2.0 / std::sin(DegToRad(-elevation_deg))) : 110.0;
      const double drops = per_m * 5.0 * (std::atan(end_m / 5.0) - std::atan(0.1));
      sum_expected += 4.0 * kPacketsPerTurn * kShotsPerPacket / 16.0 * (1.0 - std::exp(-drops));
    }
    // The own boat hides 2 of 100 shots or so.
    EXPECT_NEAR(count, sum_expected, 5.0 * std::sqrt(sum_expected) + 0.03 * sum_expected) << per_m;
    EXPECT_GT(num_near, count / 3);
  }
}

TEST(Effects, GlintsLieOnTheWaterNearTheBoatAndFollowTheirStrength) {
  Effects effects = QuietEffects();
  std::map<double, int> counts;
  for (const double probability : {0.02, 0.08}) {
    effects.set_glint_probability(probability);
    for (const auto& made : Look(OpenWater(effects), 8 * kPacketsPerTurn)) {
      if (made.reason != ReturnReason::kGlint) continue;
      ++counts[probability];
      EXPECT_NEAR(made.p_lidar_m.z(), -2.0, 1e-9);
      EXPECT_LT(made.p_lidar_m.norm(), 40.0);
    }
  }
  EXPECT_GT(counts[0.02], 200);
  EXPECT_NEAR(counts[0.08], 4.0 * counts[0.02], 20.0 * std::sqrt(counts[0.02]));
}

TEST(Effects, CrestsNeedWavesAndLieOnTheirUpperHalf) {
  Effects effects = QuietEffects();
  effects.set_crest_probability(0.3);
  EXPECT_EQ(CountReasons(OpenWater(effects), 4 * kPacketsPerTurn)[ReturnReason::kCrest], 0);
  auto scene = OpenWater(effects);
  scene.sea = ChoppySea();
  int count = 0;
  for (const auto& made : Look(scene, 4 * kPacketsPerTurn)) {
    if (made.reason != ReturnReason::kCrest) continue;
    ++count;
    // The boat lies level at the origin, its bow to the north; the lidar is 2 m above the water.
    const Eigen::Vector2d p_map_m(-made.p_lidar_m.y(), made.p_lidar_m.x());
    const double height_m = made.p_lidar_m.z() + 2.0;
    EXPECT_GT(height_m, -0.01);
    EXPECT_NEAR(height_m, scene.sea.HeightM(p_map_m, ToSeconds(made.time - kEffectsStart)), 0.02);
  }
  EXPECT_GT(count, 300);
}

TEST(Effects, CrestsHideWhatLiesBehindThem) {
  // The beam at -3 deg meets the wall 0.43 m above the water.
  auto scene = StillScene(0.0, {{Prism{Rectangle(30.0, 31.0, -5.0, 5.0), -2.0, 0.6}, {0.6}}});
  scene.effects = QuietEffects();
  const int num_calm = CountReasons(scene, 28 * kPacketsPerTurn)[ReturnReason::kObject];
  scene.sea = Sea({{0.8, 12.0, 0.0, 0.0}});  // its period: 28 turns
  const int num_behind_waves = CountReasons(scene, 28 * kPacketsPerTurn)[ReturnReason::kObject];
  EXPECT_GT(num_calm, 1000);
  EXPECT_LT(num_behind_waves, 0.8 * num_calm);
  EXPECT_GT(num_behind_waves, 0.2 * num_calm);
}

TEST(Effects, WakesLieBehindBoatsThatMove) {
  Effects effects = QuietEffects();
  effects.set_wake_probability(0.8);
  auto scene = OpenWater(effects);
  scene.objects[0].track = {{{15.0, -10.0}, 0.0}, 3.0};  // northward, abeam
  scene.objects[0].parts = {{Prism{Rectangle(-3.0, 3.0, -1.0, 1.0), 0.0, 1.0}, {0.5}}};
  scene.objects[0].outline_m = Rectangle(-3.0, 3.0, -1.0, 1.0);
  EXPECT_EQ(CountReasons(scene, 20 * kPacketsPerTurn)[ReturnReason::kWake], 0) << "nothing that stands on the ground has a wake";
  scene.objects[0].is_in_water = true;
  int count = 0;
  for (const auto& made : Look(scene, 20 * kPacketsPerTurn)) {
    if (made.reason != ReturnReason::kWake) continue;
    ++count;
    const double stern_north_m = -10.0 + 3.0 * ToSeconds(made.time - kEffectsStart) - 3.0;
    EXPECT_LT(made.p_lidar_m.x(), stern_north_m + 0.05);
    const double behind_m = stern_north_m - made.p_lidar_m.x();
    EXPECT_LT(std::abs(-made.p_lidar_m.y() - 15.0), 1.0 + 0.3536 * behind_m + 0.36);  // Kelvin's wedge
  }
  EXPECT_GT(count, 50);
  scene.objects[0].track = {};
  EXPECT_EQ(CountReasons(scene, 4 * kPacketsPerTurn)[ReturnReason::kWake], 0);
}

TEST(Effects, SprayIsAtTheBowAndOnlyWhereTheBoatPitches) {
  Effects effects = QuietEffects();
  effects.set_spray_probability(0.5);
  auto scene = OpenWater(effects);
  EXPECT_EQ(CountReasons(scene, 10 * kPacketsPerTurn)[ReturnReason::kSpray], 0);
  scene.own_motion.heave_m = {{0.3, 2.0, 0.0}};
  int count = 0;
  for (const auto& made : Look(scene, 20 * kPacketsPerTurn)) {
    if (made.reason != ReturnReason::kSpray) continue;
    ++count;
    EXPECT_GT(made.p_lidar_m.x(), 0.5);
    EXPECT_LT(made.p_lidar_m.norm(), 5.0);
  }
  EXPECT_GT(count, 100);
}

TEST(Effects, StillWaterMirrorsAWallBelowTheWater) {
  auto scene = StillScene(0.0, {{Prism{Rectangle(20.0, 21.0, -30.0, 30.0), 0.0, 4.0}, {0.8}}});
  scene.effects = QuietEffects();
  scene.effects.set_mirror_strength(1.0);
  int count = 0;
  for (const auto& made : Look(scene, 4 * kPacketsPerTurn)) {
    if (made.reason != ReturnReason::kMirror) continue;
    ++count;
    EXPECT_NEAR(made.p_lidar_m.x(), 20.0, 1e-6) << "below the foot of the wall";
    EXPECT_LT(made.p_lidar_m.z(), -2.0);
    EXPECT_GT(made.p_lidar_m.z(), -6.0);
  }
  EXPECT_GT(count, 100);
  scene.effects.set_mirror_strength(0.0);
  EXPECT_EQ(CountReasons(scene, 4 * kPacketsPerTurn)[ReturnReason::kMirror], 0);
}

TEST(Effects, EdgesGiveReturnsBetweenSurfacesThatAreClose) {
  // A board before a wall, 0.6 m apart.
  auto scene = StillScene(0.0, {{Prism{Rectangle(30.0, 30.1, -2.0, 2.0), 0.0, 12.0}, {0.5}}});
  scene.objects.push_back({2, "wall", "wall", Track{}, {{Prism{Rectangle(30.7, 31.0, -30.0, 30.0), 0.0, 12.0}, {0.5}}}, {{0.0, 0.0}}});
  scene.effects = QuietEffects();
  EXPECT_EQ(CountReasons(scene, 4 * kPacketsPerTurn)[ReturnReason::kMixedEdge], 0);
  scene.effects.set_horizontal_divergence_mrad(3.0);
  scene.effects.set_vertical_divergence_mrad(1.5);
  int count = 0;
  for (const auto& made : Look(scene, 4 * kPacketsPerTurn)) {
    if (made.reason != ReturnReason::kMixedEdge) continue;
    ++count;
    EXPECT_EQ(made.object_id, 1) << "the nearer one";
    EXPECT_GT(made.p_lidar_m.x(), 29.9);
    EXPECT_LT(made.p_lidar_m.x(), 30.75);
    EXPECT_NEAR(std::atan2(std::abs(made.p_lidar_m.y()), made.p_lidar_m.x()), std::atan2(2.0, 30.05), 0.0015 + 0.0002);
  }
  // Two upright edges, some 10 lasers, 4 turns; the beam fills most of the step from one column to the next.
  EXPECT_GT(count, 40);
  EXPECT_LE(count, 2 * 16 * 8);
}

TEST(Effects, EdgesFarApartGiveTwoReturnsInDualMode) {
  auto scene = StillScene(0.0, {{Prism{Rectangle(20.0, 20.1, -2.0, 2.0), 0.0, 12.0}, {0.5}}});
  scene.objects.push_back({2, "wall", "wall", Track{}, {{Prism{Rectangle(30.0, 31.0, -30.0, 30.0), 0.0, 12.0}, {0.5}}}, {{0.0, 0.0}}});
  scene.effects = QuietEffects();
  scene.effects.set_return_mode(config::Scene::DUAL);
  scene.effects.set_horizontal_divergence_mrad(3.0);
  scene.effects.set_vertical_divergence_mrad(1.5);
  Lidar lidar(scene, SmallBoat(), LidarParams{}, kEffectsStart, 1);
  int num_pairs_apart = 0;
  for (int i = 0; i < 8 * kPacketsPerTurn; ++i) {
    const auto packet = lidar.Next();
    std::map<int, TrueReturn> by_slot;
    for (const auto& made : packet.returns) by_slot[made.slot] = made;
    for (const auto& [slot, last] : by_slot) {
      if (last.return_index != 0 || !by_slot.contains(slot + 32)) continue;
      const auto& strongest = by_slot.at(slot + 32);
      EXPECT_GE(last.p_lidar_m.norm(), strongest.p_lidar_m.norm());
      if (strongest.object_id == 1 && last.object_id == 2) ++num_pairs_apart;
    }
  }
  EXPECT_GT(num_pairs_apart, 30);
}

TEST(Effects, GiveTheSameBytesForTheSameSeedOnly) {
  Effects effects = QuietEffects();
  effects.set_horizontal_divergence_mrad(3.0);
  effects.set_rain_probability_per_m(0.01);
  effects.set_crest_probability(0.3);
  effects.set_wake_probability(0.5);
  const auto scene = BusyScene(effects, ChoppySea());
  const auto bytes = [&scene](std::uint64_t seed) {
    Lidar lidar(scene, SmallBoat(), LidarParams{}, kEffectsStart, seed);
    std::vector<std::uint8_t> all;
    for (int i = 0; i < 100; ++i) {
      const auto packet = lidar.Next();
      all.insert(all.end(), packet.payload.begin(), packet.payload.end());
    }
    return all;
  };
  EXPECT_EQ(bytes(1), bytes(1));
  EXPECT_NE(bytes(1), bytes(2));
}

TEST(Effects, ClutterLeavesTheReturnsOfObjectsWhereTheyAre) {
  // Rain alone does not move what is seen through it.
  Effects effects = QuietEffects();
  const auto dry = Look(BusyScene(effects, Sea()), kPacketsPerTurn);
  effects.set_rain_probability_per_m(0.002);
  std::set<std::pair<Utime, int>> places;
  for (const auto& made : dry) places.insert({made.time, made.ring});
  for (const auto& made : Look(BusyScene(effects, Sea()), kPacketsPerTurn)) {
    if (made.reason != ReturnReason::kObject) continue;
    EXPECT_TRUE(places.contains({made.time, made.ring}));
  }
}

}  // namespace
}  // namespace lookout::sim
