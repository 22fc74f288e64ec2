#include "tools/sim/scene.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <set>
#include <sstream>

#include "common/core/angles.hpp"
#include "tools/sim/outline.hpp"
#include "tools/sim/scene_file.hpp"

namespace lookout::sim {
namespace {

constexpr std::uint64_t kNumSeeds = 20;

// All that a seed may change, to the last bit.
std::string TextOf(const Scene& scene) {
  std::ostringstream text;
  text << std::hexfloat;
  const auto own = StateAt(scene.own_motion, 0.5, 12.3);
  text << own.position_map_m.transpose() << ' ' << own.heading_rad << ' ' << own.roll_rad << ' ' << scene.sea.HeightM({3.0, 4.0}, 5.0) << '\n';
  for (const auto& object : scene.objects) {
    const auto T_map_object = PoseAt(object, scene.sea, 7.7);
    text << object.id << ' ' << object.name << ' ' << object.kind << ' ' << T_map_object.matrix();
    for (const auto& p_m : object.outline_m) text << ' ' << p_m.transpose();
    for (const auto& part : object.parts) {
      text << ' ' << part.material.reflectance;
      for (const auto& p_m : BoundsOf(part.solid).points_m) text << ' ' << p_m.transpose();
    }
  }
  return text.str();
}

Outline OutlineAt(const SceneObject& object, double time_s) {
  Outline outline_m;
  for (const auto& p_m : object.outline_m) outline_m.push_back(object.track.At(time_s).ToMap(p_m));
  return outline_m;
}

TEST(Scenes, AllThatAreAskedForAreThere) {
  const auto names = SceneNames();
  const std::set<std::string> found(names.begin(), names.end());
  for (const auto* name : {"sparse", "dense", "marina", "kayak_shore", "shore_20m", "motorboat_6m", "eight_objects", "islands", "canal", "rain",
                           "waves", "crossing", "turning", "black_buoys", "open_water", "dual", "lake"}) {
    EXPECT_TRUE(found.contains(name)) << name;
  }
}

TEST(Scenes, LoadWithEverySeedAndAreTheSameAgain) {
  for (const auto& name : SceneNames()) {
    std::set<std::string> lakes;
    for (std::uint64_t seed = 1; seed <= kNumSeeds; ++seed) {
      SCOPED_TRACE(name + " seed " + std::to_string(seed));
      std::optional<Scene> scene;
      ASSERT_NO_THROW(scene = MakeScene(name, seed));
      ASSERT_TRUE(scene);
      const std::string text = TextOf(*scene);
      EXPECT_EQ(text, TextOf(*MakeScene(name, seed)));
      lakes.insert(text);
    }
    EXPECT_EQ(lakes.size(), kNumSeeds) << name << ": seeds are to make different scenes";
  }
}

TEST(Scenes, NumberTheirObjectsFromOneAndNameEachOnce) {
  for (const auto& scene_name : SceneNames()) {
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

TEST(Scenes, KeepIdsNamesAndKindsWithEverySeed) {
  for (const auto& name : SceneNames()) {
    const auto list = [&name](std::uint64_t seed) {
      const auto scene = MakeScene(name, seed);
      std::string text;
      for (const auto& object : scene->objects) text += object.name + ' ' + object.kind + (object.is_in_water ? " in water\n" : "\n");
      return text;
    };
    EXPECT_EQ(list(1), list(2)) << name;
  }
}

TEST(Scenes, OutlinesHoldAllPartsOfTheirObjects) {
  for (const auto& scene_name : SceneNames()) {
    const auto scene = MakeScene(scene_name, 3);
    for (const auto& object : scene->objects) {
      for (const auto& part : object.parts) {
        const auto bounds = BoundsOf(part.solid);
        Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
        for (const auto& p_m : bounds.points_m) middle_m += p_m / static_cast<double>(bounds.points_m.size());
        EXPECT_TRUE(Contains(object.outline_m, middle_m)) << scene_name << ' ' << object.name;
      }
    }
  }
}

TEST(Scenes, NothingComesWithinAMetreAndAHalfOfTheOwnBoat) {
  for (const auto& scene_name : SceneNames()) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const auto scene = MakeScene(scene_name, seed);
      for (double time_s = 0.0; time_s <= 60.0; time_s += 1.0) {
        const auto state = StateAt(scene->own_motion, 0.5, time_s);
        const Placement own{state.position_map_m.head<2>(), state.heading_rad};
        Outline hull_m;
        for (const auto& p_m : Rectangle(-1.2, 1.2, -0.7, 0.7)) hull_m.push_back(own.ToMap(p_m));
        for (const auto& object : scene->objects) {
          ASSERT_GE(DistanceM(OutlineAt(object, time_s), hull_m), 1.5 - 1e-9) << scene_name << ' ' << object.name << " at " << time_s << " s";
        }
      }
    }
  }
}

TEST(Scenes, DrawnObjectsKeepTheirDistances) {
  // Objects in dense are 3 m apart unless their file says otherwise.
  for (std::uint64_t seed = 1; seed <= kNumSeeds; ++seed) {
    const auto scene = MakeScene("dense", seed);
    for (double time_s = 0.0; time_s <= 60.0; time_s += 4.0) {
      for (const auto& a : scene->objects) {
        for (const auto& b : scene->objects) {
          if (a.id < b.id) {
            ASSERT_GE(DistanceM(OutlineAt(a, time_s), OutlineAt(b, time_s)), 2.9) << a.name << ' ' << b.name << " seed " << seed;
          }
        }
      }
    }
  }
}

TEST(Scenes, LakeKeepsItsBoatsApartForTenMinutes) {
  const auto scene = MakeScene("lake", 1);
  for (double time_s = 0.0; time_s < 600.0; time_s += 0.5) {
    const Eigen::Vector2d own_m = StateAt(scene->own_motion, 0.5, time_s).position_map_m.head<2>();
    for (const auto& object : scene->objects) {
      for (const auto& vertex_m : OutlineAt(object, time_s)) ASSERT_GT((vertex_m - own_m).norm(), 4.0) << object.name << " at " << time_s << " s";
    }
  }
}

TEST(Scenes, EightObjectsHasItsPairFourMetresApart) {
  const auto scene = MakeScene("eight_objects", 1);
  ASSERT_EQ(scene->objects.size(), 8U);
  EXPECT_NEAR(DistanceM(OutlineAt(scene->objects[0], 0.0), OutlineAt(scene->objects[1], 0.0)), 4.0, 1e-9);
}

TEST(PoseAt, FloatsUpWithTheWaterAndLeansWithIt) {
  // One long wave that runs north; the boat heads north, 10 times shorter.
  const Sea sea({{1.0, 40.0, 0.0, 0.0}});
  SceneObject boat{1, "boat", "motor_boat", Track{}, {}, {}};
  boat.waterline_m = {4.0, 2.0};
  const auto on_slope = PoseAt(boat, sea, 0.0);
  EXPECT_NEAR(on_slope.translation().z(), 0.0, 1e-9);
  const Eigen::Vector3d bow = on_slope.linear() * Eigen::Vector3d::UnitX();
  EXPECT_NEAR(bow.z() / bow.y(), sea.Slope({0.0, 0.0}, 0.0).y(), 0.01) << "the bow points up the slope";
  boat.track.start.position_map_m = {0.0, 10.0};
  EXPECT_NEAR(PoseAt(boat, sea, 0.0).translation().z(), 1.0, 0.03) << "on the crest";
  boat.track.start = {{0.0, 0.0}, kPi / 2.0};
  const Eigen::Vector3d port = PoseAt(boat, sea, 0.0).linear() * Eigen::Vector3d::UnitY();
  EXPECT_GT(port.z(), 0.1) << "heading east, port is up the slope";
}

TEST(PoseAt, LeavesWhatStandsOnTheGroundAlone) {
  const Sea sea({{1.0, 40.0, 0.0, 1.0}});
  const SceneObject dock{1, "dock", "dock", Track{{{3.0, 4.0}, 0.7}}, {}, {}};
  const auto T_map_object = PoseAt(dock, sea, 3.0);
  EXPECT_EQ(T_map_object.translation(), Eigen::Vector3d(3.0, 4.0, 0.0));
  EXPECT_DOUBLE_EQ((T_map_object.linear() * Eigen::Vector3d::UnitZ()).z(), 1.0);
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
