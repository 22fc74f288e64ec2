#include "tools/sim/ray_caster.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "tools/sim/random.hpp"

namespace lookout::sim {
namespace {

// Every part of every object, without sectors.
std::optional<double> NearestByForce(const Scene& scene, const Ray& ray, double time_s, double max_range_m) {
  std::optional<double> nearest_m;
  for (const auto& object : scene.objects) {
    const Placement placement = object.track.At(time_s);
    // Origin and direction in the frame of the object, by two points.
    const double sine = std::sin(placement.heading_rad);
    const double cosine = std::cos(placement.heading_rad);
    const auto to_object = [&](const Eigen::Vector3d& v) {
      return Eigen::Vector3d(sine * v.x() + cosine * v.y(), -cosine * v.x() + sine * v.y(), v.z());
    };
    const Eigen::Vector3d origin_m(placement.position_map_m.x(), placement.position_map_m.y(), 0.0);
    const Ray own{to_object(ray.origin_m - origin_m), to_object(ray.direction)};
    for (const auto& part : object.parts) {
      const auto hit = Intersect(part.solid, own);
      if (hit && hit->range_m < nearest_m.value_or(max_range_m)) nearest_m = hit->range_m;
    }
  }
  return nearest_m;
}

TEST(RayCaster, FindsWhatASearchThroughEverythingFinds) {
  const std::uint64_t seed = 20261121;
  SCOPED_TRACE(seed);
  Random random(seed, 99);
  for (const auto name : SceneNames()) {
    const auto scene = MakeScene(name, seed);
    ASSERT_TRUE(scene);
    std::vector<RayCaster::Body> bodies;
    for (const auto& object : scene->objects) bodies.push_back({object.id, object.track, &object.parts});
    RayCaster caster(bodies);
    int num_hits = 0;
    for (int i = 0; i < 20000; ++i) {
      // Within the period of a sorting, so that rays start a little beside the eye that was sorted for.
      const double time_s = 0.0011 * i;
      const auto state = StateAt(scene->own_motion, 0.5, time_s);
      const Eigen::Vector3d eye_m = state.position_map_m + Eigen::Vector3d(0.0, 0.0, 1.0);
      caster.MoveTo(time_s, eye_m.head<2>());
      const double azimuth_rad = random.Uniform(0.0, kTwoPi);
      const double elevation_rad = random.Uniform(-0.2, 0.25);
      const Ray ray{eye_m,
                    {std::cos(elevation_rad) * std::cos(azimuth_rad), std::cos(elevation_rad) * std::sin(azimuth_rad), std::sin(elevation_rad)}};
      const auto expected_m = NearestByForce(*scene, ray, time_s, 110.0);
      const auto echoes = caster.Cast(ray, 110.0, false);
      ASSERT_EQ(echoes.count == 1, expected_m.has_value()) << name << " ray " << i;
      if (expected_m) {
        ++num_hits;
        ASSERT_NEAR(echoes.echo[0].hit.range_m, *expected_m, 1e-9) << name << " ray " << i;
      }
    }
    EXPECT_GT(num_hits, name == "open_water" ? 20 : 1000) << name;
  }
}

TEST(RayCaster, SeesBehindFoliageOnly) {
  const std::vector<Part> tree_and_wall{{Ellipsoid{{10.0, 0.0, 2.0}, {1.0, 1.0, 2.0}}, {0.35, true}},
                                        {Prism{Rectangle(20.0, 21.0, -5.0, 5.0), 0.0, 5.0}, {0.3}},
                                        {Prism{Rectangle(30.0, 31.0, -5.0, 5.0), 0.0, 5.0}, {0.3}}};
  RayCaster caster({{1, Track{{Eigen::Vector2d::Zero(), kPi / 2.0}}, &tree_and_wall}});
  caster.MoveTo(0.0, {0.0, 0.0});
  const auto through = caster.Cast({{0.0, 0.0, 2.0}, {1.0, 0.0, 0.0}}, 100.0, true);
  ASSERT_EQ(through.count, 2);
  EXPECT_NEAR(through.echo[0].hit.range_m, 9.0, 1e-9);
  EXPECT_NEAR(through.echo[1].hit.range_m, 20.0, 1e-9);
  EXPECT_EQ(caster.Cast({{0.0, 3.0, 2.0}, {1.0, 0.0, 0.0}}, 100.0, true).count, 1);
}

TEST(RayCaster, FindsWhatLiesAcrossTheSeamOfItsSectors) {
  const std::vector<Part> post{{Cylinder{{-10.0, 0.0}, 0.5, 0.0, 3.0}, {0.5}}};
  RayCaster caster({{1, Track{{Eigen::Vector2d::Zero(), kPi / 2.0}}, &post}});
  caster.MoveTo(0.0, {0.0, 0.0});
  for (const double offset_rad : {-0.03, -1e-9, 0.0, 1e-9, 0.03}) {
    EXPECT_EQ(caster.Cast({{0.0, 0.0, 1.0}, {std::cos(kPi + offset_rad), std::sin(kPi + offset_rad), 0.0}}, 100.0, false).count, 1) << offset_rad;
  }
}

}  // namespace
}  // namespace lookout::sim
