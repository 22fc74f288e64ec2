#include "tools/sim/scene.hpp"

#include <gtest/gtest.h>
#include <set>

namespace lookout::sim {
namespace {

TEST(Scene, UnknownNameGivesNone) { EXPECT_FALSE(MakeScene("nowhere", 1)); }

TEST(Scene, NumbersItsObjectsFromOneAndNamesEachOnce) {
  for (const auto scene_name : SceneNames()) {
    const auto scene = MakeScene(scene_name, 1);
    ASSERT_TRUE(scene);
    std::set<std::string> names;
    int id = 0;
    for (const auto& object : scene->objects) {
      EXPECT_EQ(object.id, ++id);
      EXPECT_TRUE(names.insert(object.name).second) << object.name;
      EXPECT_GE(object.outline_m.size(), 3U) << object.name;
      EXPECT_FALSE(object.parts.empty()) << object.name;
    }
  }
}

bool IsInside(const Eigen::Vector2d& p_m, const std::vector<Eigen::Vector2d>& outline_m) {
  bool is_inside = false;
  for (std::size_t i = 0, j = outline_m.size() - 1; i < outline_m.size(); j = i++) {
    const auto& a = outline_m[i];
    const auto& b = outline_m[j];
    if ((a.y() > p_m.y()) != (b.y() > p_m.y()) && p_m.x() < a.x() + (p_m.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) is_inside = !is_inside;
  }
  return is_inside;
}

TEST(Scene, OutlinesHoldAllPartsOfTheirObjects) {
  for (const auto scene_name : SceneNames()) {
    const auto scene = MakeScene(scene_name, 3);
    for (const auto& object : scene->objects) {
      for (const auto& part : object.parts) {
        const auto bounds = BoundsOf(part.solid);
        Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
        for (const auto& p_m : bounds.points_m) middle_m += p_m / static_cast<double>(bounds.points_m.size());
        EXPECT_TRUE(IsInside(middle_m, object.outline_m)) << scene_name << ' ' << object.name;
      }
    }
  }
}

TEST(Scene, BoatsNeverMeetTheOwnBoat) {
  for (const auto scene_name : SceneNames()) {
    const auto scene = MakeScene(scene_name, 1);
    for (double time_s = 0.0; time_s < 600.0; time_s += 0.5) {
      const Eigen::Vector2d own_m = StateAt(scene->own_motion, 0.5, time_s).position_map_m.head<2>();
      for (const auto& object : scene->objects) {
        const Placement placement = object.track.At(time_s);
        for (const auto& vertex_m : object.outline_m) {
          ASSERT_GT((placement.ToMap(vertex_m) - own_m).norm(), 4.0) << scene_name << ' ' << object.name << " at " << time_s << " s";
        }
      }
    }
  }
}

TEST(OwnHull, LiesInsideOfTheBoxOfTheOwnVessel) {
  const Eigen::AlignedBox3d box_m(Eigen::Vector3d(-1.4, -0.9, -1.0), Eigen::Vector3d(1.4, 0.9, 2.0));
  const auto parts = MakeOwnHull(box_m, 1.1, {-0.8, 0.4, 0.9});
  EXPECT_EQ(parts.size(), 3U);
  for (const auto& part : parts) {
    const auto bounds = BoundsOf(part.solid);
    for (const auto& p_m : bounds.points_m) {
      EXPECT_LE(p_m.x() + bounds.radius_m, 1.21);
      EXPECT_GE(p_m.x() - bounds.radius_m, -1.21);
      EXPECT_LE(std::abs(p_m.y()) + bounds.radius_m, 0.71);
    }
  }
}

TEST(OwnHull, HasNoPostForAnAntennaOutsideOfTheBox) {
  const Eigen::AlignedBox3d box_m(Eigen::Vector3d(-1.4, -0.9, -1.0), Eigen::Vector3d(1.4, 0.9, 2.0));
  EXPECT_EQ(MakeOwnHull(box_m, 1.1, {-3.0, 0.0, 0.9}).size(), 2U);
}

}  // namespace
}  // namespace lookout::sim
