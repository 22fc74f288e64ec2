#include "lab/sim/ray_caster.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "lab/sim/random.hpp"
#include "tests/unit/sim/scenes.hpp"

namespace lookout::sim {
namespace {

// Every part of every object, without sectors.
std::optional<double> NearestByForce(const Scene& scene, const std::vector<Eigen::Isometry3d>& T_object_map, const Ray& ray, double max_range_m) {
  std::optional<double> nearest_m;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const Ray own{T_object_map[i] * ray.origin_m, T_object_map[i].linear() * ray.direction};
    for (const auto& part : scene.objects[i].parts) {
      const auto hit = Intersect(part.solid, own);
      if (hit && hit->range_m < nearest_m.value_or(max_range_m)) nearest_m = hit->range_m;
    }
  }
  return nearest_m;
}

Ray RandomRay(const Eigen::Vector3d& eye_m, Random& random) {
  const double azimuth_rad = random.Uniform(0.0, kTwoPi);
  const double elevation_rad = random.Uniform(-0.2, 0.25);
  return {eye_m, {std::cos(elevation_rad) * std::cos(azimuth_rad), std::cos(elevation_rad) * std::sin(azimuth_rad), std::sin(elevation_rad)}};
}

TEST(RayCaster, FindsWhatASearchThroughEverythingFinds) {
  const std::uint64_t seed = 20261121;
  SCOPED_TRACE(seed);
  Random random(seed, 99);
  for (const auto& name : SceneNames()) {
    const auto scene = MakeScene(name, seed);
    RayCaster caster(scene.objects, BeamWidth{0.0015, 0.00075}, &scene.sea);
    int num_hits = 0;
    for (int i = 0; i < 3000; ++i) {
      // Within the period of a sorting, so that rays start a little beside the eye that was sorted for; riders have been listed anew.
      const double time_s = 0.0031 * i;
      const auto state = StateAt(scene.own_motion, 0.5, time_s);
      const Eigen::Vector3d eye_m = state.position_map_m + Eigen::Vector3d(0.0, 0.0, 1.0);
      caster.MoveTo(time_s, eye_m.head<2>());
      std::vector<Eigen::Isometry3d> T_object_map;
      for (const auto& object : scene.objects) T_object_map.push_back(PoseAt(object, scene.sea, time_s).inverse());
      for (int k = 0; k < 5; ++k) {
        const Ray ray = RandomRay(eye_m, random);
        const auto expected_m = NearestByForce(scene, T_object_map, ray, 110.0);
        const auto echoes = caster.Cast(ray, 110.0, false);
        ASSERT_EQ(echoes.count == 1, expected_m.has_value()) << name << " ray " << i;
        if (expected_m) {
          ++num_hits;
          ASSERT_NEAR(echoes.echo[0].hit.range_m, *expected_m, 1e-6) << name << " ray " << i;
        }
      }
    }
    EXPECT_GE(num_hits, name == "open_water" ? 0 : 20) << name;  // there is nothing
  }
}

// An object whose frame is that of the map.
SceneObject Standing(int id, std::vector<Part> parts) { return {id, "", "", Track{{Eigen::Vector2d::Zero(), kPi / 2.0}}, std::move(parts), {}}; }

TEST(RayCaster, SeesBehindFoliageOnly) {
  const std::vector<Part> tree_and_wall{{Ellipsoid{{10.0, 0.0, 2.0}, {1.0, 1.0, 2.0}}, {0.35, true}},
                                        {Prism{Rectangle(20.0, 21.0, -5.0, 5.0), 0.0, 5.0}, {0.3}},
                                        {Prism{Rectangle(30.0, 31.0, -5.0, 5.0), 0.0, 5.0}, {0.3}}};
  const std::vector objects{Standing(1, tree_and_wall)};
  RayCaster caster(objects, BeamWidth{}, nullptr);
  caster.MoveTo(0.0, {0.0, 0.0});
  const auto through = caster.Cast({{0.0, 0.0, 2.0}, {1.0, 0.0, 0.0}}, 100.0, true);
  ASSERT_EQ(through.count, 2);
  EXPECT_NEAR(through.echo[0].hit.range_m, 9.0, 1e-9);
  EXPECT_NEAR(through.echo[1].hit.range_m, 20.0, 1e-9);
  EXPECT_EQ(caster.Cast({{0.0, 3.0, 2.0}, {1.0, 0.0, 0.0}}, 100.0, true).count, 1);
}

TEST(RayCaster, FindsWhatLiesAcrossTheSeamOfItsSectors) {
  const std::vector objects{Standing(1, {{Cylinder{{-10.0, 0.0}, 0.5, 0.0, 3.0}, {0.5}}})};
  RayCaster caster(objects, BeamWidth{}, nullptr);
  caster.MoveTo(0.0, {0.0, 0.0});
  for (const double offset_rad : {-0.03, -1e-9, 0.0, 1e-9, 0.03}) {
    EXPECT_EQ(caster.Cast({{0.0, 0.0, 1.0}, {std::cos(kPi + offset_rad), std::sin(kPi + offset_rad), 0.0}}, 100.0, false).count, 1) << offset_rad;
  }
}

class Edge : public testing::Test {
 protected:
  // A board at `near_m`, to the left of the x axis, before a wall at `far_m`.
  Echoes CastAt(double near_m, double far_m, double offset_rad) {
    const std::vector<Part> board{{Prism{Rectangle(near_m, near_m + 0.05, 0.0, 2.0), 0.0, 3.0}, {0.5}}};
    const std::vector<Part> wall{{Prism{Rectangle(far_m, far_m + 1.0, -5.0, 5.0), 0.0, 3.0}, {0.5}}};
    const std::vector objects{Standing(1, board), Standing(2, wall)};
    RayCaster caster(objects, BeamWidth{0.0015, 0.00075}, nullptr);
    caster.MoveTo(0.0, {0.0, 0.0});
    return caster.CastBeam({{0.0, 0.0, 1.5}, {std::cos(offset_rad), std::sin(offset_rad), 0.0}}, 100.0, true);
  }
};

TEST_F(Edge, BeamOnOneSurfaceGivesWhatARayGives) {
  const auto on_board = CastAt(20.0, 23.0, 0.01);
  ASSERT_EQ(on_board.count, 1);
  EXPECT_EQ(on_board.echo[0].object_id, 1);
  EXPECT_NEAR(on_board.echo[0].hit.range_m, 20.0 / std::cos(0.01), 1e-9);
  EXPECT_EQ(on_board.echo[0].reason, ReturnReason::kObject);
  EXPECT_EQ(on_board.echo[0].share, 1.0);
  EXPECT_EQ(CastAt(20.0, 23.0, -0.01).echo[0].object_id, 2);
}

TEST_F(Edge, SurfacesFarApartGiveAnEchoEach) {
  const auto echoes = CastAt(20.0, 23.0, 0.0);
  ASSERT_EQ(echoes.count, 2);
  EXPECT_NEAR(echoes.echo[0].hit.range_m, 20.0, 0.001);
  EXPECT_NEAR(echoes.echo[1].hit.range_m, 23.0, 0.001);
  EXPECT_EQ(echoes.echo[1].object_id, 2);
  EXPECT_EQ(echoes.echo[0].reason, ReturnReason::kObject);
  EXPECT_NEAR(echoes.echo[0].share + echoes.echo[1].share, 1.0, 1e-9);
}

TEST_F(Edge, SurfacesCloseTogetherGiveOneEchoBetweenThem) {
  // The more of the beam lies on the board, the nearer.
  double last_m = 20.7;
  for (const double offset_rad : {-0.0010, -0.0004, 0.0, 0.0004, 0.0010}) {
    const auto echoes = CastAt(20.0, 20.6, offset_rad);
    ASSERT_EQ(echoes.count, 1) << offset_rad;
    EXPECT_EQ(echoes.echo[0].object_id, 1);
    EXPECT_EQ(echoes.echo[0].reason, ReturnReason::kMixedEdge);
    EXPECT_GT(echoes.echo[0].hit.range_m, 20.0);
    EXPECT_LT(echoes.echo[0].hit.range_m, last_m);
    last_m = echoes.echo[0].hit.range_m;
  }
}

TEST_F(Edge, SurfacesAPulseApartOrMoreAreNotMerged) {
  EXPECT_EQ(CastAt(20.0, 20.99, 0.0).count, 1);
  EXPECT_EQ(CastAt(20.0, 21.01, 0.0).count, 2);
}

}  // namespace
}  // namespace lookout::sim
