// Fast code against obvious code.
#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <random>

#include "services/segmenter/core/footprint.hpp"
#include "services/segmenter/core/paper/component_clustering.hpp"
#include "services/segmenter/core/paper/component_labelling.hpp"
#include "services/segmenter/core/union_find.hpp"
#include "tests/unit/segmenter/scan_maker.hpp"

namespace lookout::segmenter {
namespace {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double Uniform(double from, double to) { return std::uniform_real_distribution<double>(from, to)(engine_); }
  int Integer(int from, int to) { return std::uniform_int_distribution<int>(from, to)(engine_); }

 private:
  std::mt19937_64 engine_;
};

// Sets numbered in the order of their first member.
std::vector<std::int32_t> Numbered(UnionFind& sets, std::size_t size) {
  std::map<std::int32_t, std::int32_t> number_of;
  std::vector<std::int32_t> numbers;
  for (std::size_t i = 0; i < size; ++i) {
    numbers.push_back(number_of.try_emplace(sets.Find(static_cast<std::int32_t>(i)), static_cast<std::int32_t>(number_of.size())).first->second);
  }
  return numbers;
}

std::vector<std::int32_t> AllPairs(const std::vector<ComponentCentroid>& components, const ClusteringParams& params) {
  const CompatibilityRule rule(params);
  UnionFind sets(components.size());
  for (std::size_t i = 0; i < components.size(); ++i) {
    for (std::size_t j = i + 1; j < components.size(); ++j) {
      if (rule.AreCompatible(components[i], components[j])) sets.Join(static_cast<std::int32_t>(i), static_cast<std::int32_t>(j));
    }
  }
  return Numbered(sets, components.size());
}

ComponentCentroid At(double range_m, double azimuth_rad, double elevation_rad) {
  return ComponentCentroid({range_m * std::cos(elevation_rad) * std::cos(azimuth_rad), -range_m * std::cos(elevation_rad) * std::sin(azimuth_rad),
                            range_m * std::sin(elevation_rad)});
}

TEST(ClusterComponentsProperty, IsExactlyWhatAllPairsGive) {
  constexpr std::uint64_t kSeed = 11;
  Random random(kSeed);
  std::size_t num_clusters = 0;
  for (int round = 0; round < 400; ++round) {
    // Parameters from one end of their ranges to the other, the extremes too.
    ClusteringParams params;
    params.e1_cosine = std::vector{0.95, 0.6, 0.999, 1.0, 0.0, -1.0, random.Uniform(-1.0, 1.0)}[static_cast<std::size_t>(random.Integer(0, 6))];
    params.e2_angle_rad =
        DegToRad(std::vector{50.0, 10.0, 85.0, 0.0, 90.0, random.Uniform(0.0, 90.0)}[static_cast<std::size_t>(random.Integer(0, 5))]);
    params.e3_distance_m = std::vector{3.5, 0.0, 1.0, 50.0}[static_cast<std::size_t>(random.Integer(0, 3))];
    params.e2_max_distance_m = std::vector{0.0, 10.0, 0.5}[static_cast<std::size_t>(random.Integer(0, 2))];
    const double max_range_m = std::vector{5.0, 30.0, 120.0}[static_cast<std::size_t>(random.Integer(0, 2))];
    const double max_elevation_rad = DegToRad(std::vector{0.0, 15.0, 45.0, 90.0}[static_cast<std::size_t>(random.Integer(0, 3))]);
    const double width_rad = std::vector{kTwoPi, kPi, 0.2}[static_cast<std::size_t>(random.Integer(0, 2))];
    const int count = std::vector{2, 5, 30, 150, 500}[static_cast<std::size_t>(random.Integer(0, 4))];
    std::vector<ComponentCentroid> components;
    for (int i = 0; i < count; ++i) {
      components.push_back(
          At(random.Uniform(0.0, max_range_m), random.Uniform(-width_rad / 2, width_rad / 2), random.Uniform(-max_elevation_rad, max_elevation_rad)));
    }
    const auto clusters = ClusterComponents(components, params);
    ASSERT_EQ(clusters, AllPairs(components, params)) << "seed " << kSeed << ", round " << round;
    num_clusters += static_cast<std::size_t>(*std::ranges::max_element(clusters)) + 1;
  }
  EXPECT_GT(num_clusters, 1000U);
}

TEST(ClusterComponentsProperty, IsExactlyWhatAllPairsGiveOnHardSets) {
  std::vector<std::vector<ComponentCentroid>> sets(6);
  Random random(12);
  // Rain, 3000 drops.
  for (int i = 0; i < 3000; ++i) {
    sets[0].push_back(At(1.0 + 24.0 * random.Uniform(0, 1) * random.Uniform(0, 1), random.Uniform(0, kTwoPi), random.Uniform(-0.26, 0.26)));
  }
  // Beams in which everything is behind everything: many in a cell, few compatible.
  for (int beam = 0; beam < 20; ++beam) {
    for (int i = 0; i < 100; ++i) sets[1].push_back(At(2.0 + i * 1.07, beam * 0.33, 0.0));
  }
  // Rings whose members are just within and just beyond the reach of each other, across the seam.
  for (int ring = 1; ring <= 10; ++ring) {
    for (int i = 0; i < 20; ++i) sets[2].push_back(At(10.0 * ring, i * std::acos(0.95) * (ring % 2 == 0 ? 0.999 : 1.001), 0.0));
  }
  // Twins at one place, and the sensor itself.
  for (int i = 0; i < 50; ++i) sets[3].push_back(At(10.0, 0.1 * (i % 5), 0.0));
  sets[3].emplace_back(Eigen::Vector3d::Zero());
  sets[3].emplace_back(Eigen::Vector3d::Zero());
  // Straight up and down.
  for (int i = 0; i < 200; ++i)
    sets[4].push_back(At(random.Uniform(1, 20), random.Uniform(0, kTwoPi), (i % 2 == 0 ? 1 : -1) * random.Uniform(1.4, kPi / 2)));
  // Spirals: neighbours are compatible one by one, round and round.
  for (int i = 0; i < 1500; ++i) sets[5].push_back(At(5.0 + 0.05 * i, 0.21 * i, 0.0));
  for (std::size_t set = 0; set < sets.size(); ++set) {
    for (const double e2_max_distance_m : {0.0, 10.0}) {
      for (const double e1_cosine : {0.95, 0.6}) {
        const ClusteringParams params{.e1_cosine = e1_cosine, .e2_max_distance_m = e2_max_distance_m};
        ASSERT_EQ(ClusterComponents(sets[set], params), AllPairs(sets[set], params)) << "set " << set;
      }
    }
  }
}

Scan RandomScan(Random& random, int num_returns) {
  auto scan = test::EmptyScan({.num_columns = random.Integer(1, 200), .num_rings = random.Integer(1, 16), .num_returns = num_returns});
  for (auto& ring : scan.head.rings) ring.azimuth_offset_rad = static_cast<float>(random.Uniform(0.0, 0.02));
  const double density = random.Uniform(0.1, 1.0);
  const double depth_m = random.Uniform(0.1, 20.0);
  for (auto& range : scan.columns.range) {
    if (random.Uniform(0, 1) < density) range = static_cast<std::uint16_t>((5.0 + random.Uniform(0.0, depth_m)) / test::kRangeUnitM);
  }
  return scan;
}

TEST(SearchComponentsProperty, IsWhatUnionFindOverAllEdgesGives) {
  constexpr std::uint64_t kSeed = 13;
  Random random(kSeed);
  for (int round = 0; round < 300; ++round) {
    const auto scan = RandomScan(random, 1 + round % 2);
    const SearchParams params{.angle_rad = DegToRad(random.Uniform(0.0, 90.0)), .distance_m = random.Uniform(0.0, 3.0)};
    const auto returns = ClassifyReturns(scan, {}).returns;
    const auto image = ProjectToOwnColumns(scan, returns);
    const JoinRule rule(params);
    UnionFind sets(returns.size());
    const int num_columns = scan.columns.size();
    // Written from the definition, over all pairs of returns.
    for (std::size_t i = 0; i < returns.size(); ++i) {
      for (std::size_t j = i + 1; j < returns.size(); ++j) {
        const auto &one = returns[i], &other = returns[j];
        bool joins = false;
        if (one.ring == other.ring && (one.column + 1) % num_columns == other.column % num_columns) {
          const auto& step = image.to_next_column[static_cast<std::size_t>(one.column)];
          joins = joins || (step.is_neighbour && rule.Joins(one, other, step));
        }
        if (one.ring == other.ring && (other.column + 1) % num_columns == one.column % num_columns) {
          const auto& step = image.to_next_column[static_cast<std::size_t>(other.column)];
          joins = joins || (step.is_neighbour && rule.Joins(one, other, step));
        }
        if (one.column == other.column && std::abs(one.ring - other.ring) == 1) {
          joins = joins || rule.Joins(one, other, image.to_higher_ring[static_cast<std::size_t>(std::min(one.ring, other.ring))]);
        }
        if (one.column == other.column && one.ring == other.ring) joins = joins || rule.Joins(one, other, BeamStep{});
        if (joins) sets.Join(static_cast<std::int32_t>(i), static_cast<std::int32_t>(j));
      }
    }
    ASSERT_EQ(SearchComponents(image, returns, params).of_return, Numbered(sets, returns.size())) << "seed " << kSeed << ", round " << round;
  }
}

TEST(ConvexHullProperty, HoldsAllPointsAndTurnsLeftAtEveryCorner) {
  constexpr std::uint64_t kSeed = 14;
  Random random(kSeed);
  for (int round = 0; round < 300; ++round) {
    std::vector<FootprintPoint> points;
    const int count = random.Integer(1, 400);
    const double width_m = random.Uniform(0.0, 1.0) < 0.3 ? 0.0 : random.Uniform(0.0, 10.0);
    const bool is_gridded = random.Integer(0, 1) == 1;  // many at one place, many on lines
    for (int i = 0; i < count; ++i) {
      const double x_m = random.Uniform(-width_m, width_m), y_m = random.Uniform(-5.0, 5.0);
      points.push_back({static_cast<float>(is_gridded ? std::round(x_m) : x_m), static_cast<float>(is_gridded ? std::round(y_m) : y_m), i});
    }
    const auto hull = ConvexHull(points);
    const auto turn = [](const FootprintPoint& a, const FootprintPoint& b, const FootprintPoint& c) {
      return (double{b.x_m} - a.x_m) * (double{c.y_m} - a.y_m) - (double{b.y_m} - a.y_m) * (double{c.x_m} - a.x_m);
    };
    ASSERT_GE(hull.size(), 1U);
    for (std::size_t i = 0; hull.size() > 2 && i < hull.size(); ++i) {
      const auto &a = hull[i], &b = hull[(i + 1) % hull.size()];
      ASSERT_GT(turn(a, b, hull[(i + 2) % hull.size()]), 0.0) << "seed " << kSeed << ", round " << round;
      for (const auto& point : points) ASSERT_GE(turn(a, b, point), 0.0) << "seed " << kSeed << ", round " << round;
    }
    for (const auto& corner : hull) {
      const auto first = std::ranges::find_if(points, [&](const FootprintPoint& p) { return p.x_m == corner.x_m && p.y_m == corner.y_m; });
      ASSERT_EQ(first->return_index, corner.return_index);
    }
    // The least-area rectangle against turning through all angles.
    const auto rectangle = LeastAreaRectangle(hull);
    for (int step = 0; step < 90; ++step) {
      const double c = std::cos(DegToRad(step)), s = std::sin(DegToRad(step));
      double min_u = 1e9, max_u = -1e9, min_v = 1e9, max_v = -1e9;
      for (const auto& p : hull) {
        min_u = std::min(min_u, c * p.x_m + s * p.y_m);
        max_u = std::max(max_u, c * p.x_m + s * p.y_m);
        min_v = std::min(min_v, c * p.y_m - s * p.x_m);
        max_v = std::max(max_v, c * p.y_m - s * p.x_m);
      }
      ASSERT_LE(double{rectangle.length_m} * rectangle.width_m, (max_u - min_u) * (max_v - min_v) + 1e-4) << "seed " << kSeed << ", round " << round;
    }
    ASSERT_GE(rectangle.length_m, rectangle.width_m);
  }
}

}  // namespace
}  // namespace lookout::segmenter
