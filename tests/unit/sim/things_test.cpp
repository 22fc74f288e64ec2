#include "lab/sim/things.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <set>
#include <sstream>

#include "common/core/angles.hpp"
#include "lab/sim/model.hpp"
#include "lab/sim/traffic.hpp"

namespace lookout::sim {
namespace {

constexpr std::uint64_t kNumSeeds = 60;

SceneObject Drawn(const KindOfObject& kind, std::uint64_t seed, const Size& size = {}) {
  Random random(seed, 5);
  return MakeObject(kind, size, random);
}

std::vector<KindOfObject> DrawnKinds() {
  std::vector<KindOfObject> kinds;
  for (const auto& kind : Kinds()) {
    if (kind.is_drawn()) kinds.push_back(kind);
  }
  return kinds;
}

std::string TextOf(const SceneObject& object) {
  std::ostringstream text;
  text << std::hexfloat << object.kind << ' ' << object.waterline_m.transpose();
  for (const auto& part : object.parts) {
    const Bounds bounds = BoundsOf(part.solid);
    text << ' ' << part.material.reflectance << ' ' << bounds.low_m << ' ' << bounds.high_m << ' ' << bounds.radius_m;
    for (const auto& p_m : bounds.points_m) text << ' ' << p_m.transpose();
  }
  return text.str();
}

TEST(DrawnKinds, AreTheSameWithTheSameSeedAndOthersWithOthers) {
  for (const auto& kind : DrawnKinds()) {
    std::set<std::string> texts;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      EXPECT_EQ(TextOf(Drawn(kind, seed)), TextOf(Drawn(kind, seed))) << kind.name;
      texts.insert(TextOf(Drawn(kind, seed)));
    }
    EXPECT_EQ(texts.size(), 10U) << kind.name;
  }
}

TEST(DrawnKinds, OutlinesHoldAllPartsOfTheirObjects) {
  for (const auto& kind : DrawnKinds()) {
    for (std::uint64_t seed = 1; seed <= kNumSeeds; ++seed) {
      const SceneObject object = Drawn(kind, seed);
      ASSERT_GE(object.outline_m.size(), 3U) << kind.name << ' ' << seed;
      for (const auto& part : object.parts) {
        const Bounds bounds = BoundsOf(part.solid);
        for (const auto& p_m : bounds.points_m) {
          // What hangs from a dock may stand out of it by as much as a fender, a ladder or a foot.
          const double out_m = Contains(object.outline_m, p_m) ? 0.0 : GapBetween(object.outline_m, {p_m, p_m, p_m});
          EXPECT_LE(out_m, kind.is_in_water ? 0.01 : 0.75) << kind.name << ' ' << seed;
        }
      }
    }
  }
}

TEST(DrawnKinds, StayWithinTheSizesOfTheirKind) {
  for (const auto& kind : DrawnKinds()) {
    for (std::uint64_t seed = 1; seed <= kNumSeeds; ++seed) {
      const SceneObject object = Drawn(kind, seed);
      if (kind.usual.length_m > 0.0 && kind.is_afloat) {
        EXPECT_LE(object.waterline_m.x(), kind.usual.length_m + 1e-9) << kind.name << ' ' << seed;
      }
      if (kind.usual.width_m > 0.0 && kind.is_afloat) {
        EXPECT_LE(object.waterline_m.y(), std::max(kind.usual.width_m, 0.4) + 1e-9) << kind.name << ' ' << seed;
      }
      EXPECT_EQ(object.is_afloat(), kind.is_afloat && object.kind != "stake") << kind.name;
      double highest_m = 0.0;
      for (const auto& part : object.parts) {
        EXPECT_GT(part.material.reflectance, 0.005) << kind.name << ' ' << seed;
        EXPECT_LE(part.material.reflectance, 2.55) << kind.name << ' ' << seed;
        highest_m = std::max(highest_m, BoundsOf(part.solid).high_m);
      }
      EXPECT_GT(highest_m, 0.03) << kind.name << ' ' << seed << ": it is above the water";
      EXPECT_LT(highest_m, 27.0) << kind.name << ' ' << seed;
    }
  }
}

TEST(DrawnKinds, TakeTheSizesThatAreGiven) {
  for (const auto& kind : DrawnKinds()) {
    if (!kind.is_afloat || kind.usual.length_m == 0.0) continue;
    const double length_m = 0.8 * kind.usual.length_m;
    EXPECT_DOUBLE_EQ(Drawn(kind, 3, Size{length_m}).waterline_m.x(), length_m) << kind.name;
  }
}

TEST(DrawnKinds, AreMetByRaysFromAllSidesWithinTheirBounds) {
  for (const auto& kind : DrawnKinds()) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const SceneObject object = Drawn(kind, seed);
      for (const auto& part : object.parts) {
        const Bounds bounds = BoundsOf(part.solid);
        Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
        for (const auto& p_m : bounds.points_m) middle_m += p_m / static_cast<double>(bounds.points_m.size());
        for (int side = 0; side < 8; ++side) {
          const double angle_rad = kTwoPi * side / 8 + 0.1;
          const Eigen::Vector3d eye_m(middle_m.x() + 60.0 * std::cos(angle_rad), middle_m.y() + 60.0 * std::sin(angle_rad), bounds.high_m + 3.0);
          const Eigen::Vector3d at_m(middle_m.x(), middle_m.y(), (bounds.low_m + bounds.high_m) / 2.0);
          const Ray ray{eye_m, (at_m - eye_m).normalized()};
          const auto hit = Intersect(part.solid, ray);
          if (!hit) continue;  // past a thin sheet
          const Eigen::Vector3d met_m = ray.origin_m + hit->range_m * ray.direction;
          EXPECT_GE(met_m.z(), bounds.low_m - 1e-6) << kind.name << ' ' << seed;
          EXPECT_LE(met_m.z(), bounds.high_m + 1e-6) << kind.name << ' ' << seed;
          const Eigen::Vector2d plan_m = met_m.head<2>();
          const double out_m = Contains(bounds.points_m, plan_m) ? 0.0 : GapBetween(bounds.points_m, {plan_m, plan_m, plan_m});
          EXPECT_LE(out_m, bounds.radius_m + 1e-6) << kind.name << ' ' << seed;
          EXPECT_GE(hit->incidence_cosine, 0.0);
          EXPECT_LE(hit->incidence_cosine, 1.0 + 1e-9);
        }
      }
    }
  }
}

TEST(DrawnKinds, OneOfSeveralHasTheKindThatWasDrawn) {
  std::set<std::string> kinds;
  for (const auto& kind : DrawnKinds()) {
    if (!kind.name.starts_with("any_")) continue;
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
      const SceneObject object = Drawn(kind, seed);
      EXPECT_FALSE(object.kind.starts_with("any_"));
      EXPECT_EQ(object.is_in_water, kind.is_in_water) << object.kind;
      kinds.insert(object.kind);
    }
  }
  EXPECT_EQ(kinds.size(), 13U + 4U + 3U);
}

TEST(DrawnKinds, DocksRunOutFromTheirLandwardEnd) {
  for (const auto& kind : DrawnKinds()) {
    if (kind.is_in_water) continue;
    for (std::uint64_t seed = 1; seed <= kNumSeeds; ++seed) {
      const SceneObject dock = Drawn(kind, seed);
      double least_m = 1e9;
      double greatest_m = -1e9;
      for (const auto& p_m : dock.outline_m) {
        least_m = std::min(least_m, p_m.x());
        greatest_m = std::max(greatest_m, p_m.x());
      }
      EXPECT_NEAR(least_m, 0.0, 1e-9);
      EXPECT_GE(greatest_m, 4.0);
      EXPECT_FALSE(dock.is_afloat());
    }
  }
}

}  // namespace
}  // namespace lookout::sim
