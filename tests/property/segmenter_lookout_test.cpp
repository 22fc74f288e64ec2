// Laws of the lookout method: what may change nothing but the numbers of segments, and what may change nothing at all.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <optional>
#include <random>
#include <set>

#include "common/bus/bus.hpp"
#include "services/segmenter/core/segmenter.hpp"
#include "services/segmenter/wire.hpp"
#include "tests/unit/segmenter/scan_maker.hpp"

namespace lookout::segmenter {
namespace {

using test::Shape;

// A coast in pieces, of which some show their trees alone, with docks that touch it, islets, and boats at berths and afloat.
std::vector<test::Wall> Coast(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&random](double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); };
  std::vector<test::Wall> walls;
  const auto add = [&](double range_m, double azimuth_rad, double length_m, double width_m, double bottom_m, double top_m) {
    test::AddBoat(walls, range_m * std::cos(azimuth_rad), range_m * std::sin(azimuth_rad), azimuth_rad + uniform(-0.4, 0.4), length_m, width_m,
                  bottom_m, top_m);
  };
  for (double azimuth_rad = uniform(0.0, 0.4); azimuth_rad < 4.0; azimuth_rad += uniform(0.1, 0.35)) {
    const double range_m = uniform(22.0, 45.0);
    if (uniform(0.0, 1.0) < 0.6) add(range_m, azimuth_rad, uniform(1.0, 3.0), uniform(3.0, 14.0), -1.0, uniform(-0.5, 1.5));
    for (int tree = 0; tree < 3; ++tree) {
      add(range_m + uniform(2.0, 14.0), azimuth_rad + uniform(-0.15, 0.15), uniform(1.0, 4.0), uniform(1.0, 4.0), 0.5, uniform(3.0, 9.0));
    }
    if (uniform(0.0, 1.0) < 0.4) add(range_m - 4.0, azimuth_rad, 9.0, 2.0, -1.0, -0.4);
  }
  for (double azimuth_rad = 4.2; azimuth_rad < 6.0; azimuth_rad += uniform(0.15, 0.3)) {
    add(uniform(9.0, 20.0), azimuth_rad, uniform(3.0, 8.0), uniform(1.0, 2.5), -1.0, uniform(-0.3, 1.5));
  }
  return walls;
}

std::vector<test::Wall> SceneOf(std::uint64_t seed) { return seed % 3 == 0 ? test::Lake(seed) : Coast(seed); }

Scan Scene(std::uint64_t seed, const Shape& shape) {
  auto scan = test::EmptyScan(shape);
  test::Look(scan, SceneOf(seed), 0.03, seed);
  if (seed % 2 == 0) test::AddRain(scan, shape.num_columns / 3, seed);
  return scan;
}

std::size_t CellsPerColumn(const Scan& scan) { return static_cast<std::size_t>(scan.head.num_rings() * scan.head.num_returns); }

// What is seen in column c of the new scan was seen in column from(c); azimuths stay. For scans of evenly spaced columns.
template <typename From>
Scan Moved(const Scan& scan, From from) {
  Scan moved = scan;
  const auto per_column = static_cast<std::ptrdiff_t>(CellsPerColumn(scan));
  for (int column = 0; column < scan.columns.size(); ++column) {
    const auto take = [&](const auto& values, auto& to) {
      std::copy_n(values.begin() + per_column * from(column), per_column, to.begin() + per_column * column);
    };
    take(scan.columns.range, moved.columns.range);
    take(scan.columns.reflectivity, moved.columns.reflectivity);
  }
  return moved;
}

// nullopt when one is the other up to numbering, and the same is said of each segment.
template <typename From>
std::optional<std::string> Difference(const Scan& scan, const Segments& one, const Segments& other, From from) {
  if (one.segments.size() != other.segments.size()) {
    return std::to_string(one.segments.size()) + " and " + std::to_string(other.segments.size()) + " segments";
  }
  std::map<int, int> forth;
  std::map<int, int> back;
  std::map<int, int> pieces_forth;
  std::map<int, int> pieces_back;
  const auto per_column = CellsPerColumn(scan);
  for (std::size_t cell = 0; cell < scan.num_cells(); ++cell) {
    const auto column = static_cast<int>(cell / per_column);
    const int was = one.label[static_cast<std::size_t>(from(column)) * per_column + cell % per_column];
    const int is = other.label[cell];
    if (forth.try_emplace(was, is).first->second != is || back.try_emplace(is, was).first->second != was || ((was <= 0 || is <= 0) && was != is)) {
      return "label " + std::to_string(was) + " and " + std::to_string(is) + " in cell " + std::to_string(cell);
    }
    const int piece_was = one.piece[static_cast<std::size_t>(from(column)) * per_column + cell % per_column];
    const int piece_is = other.piece[cell];
    if (pieces_forth.try_emplace(piece_was, piece_is).first->second != piece_is ||
        pieces_back.try_emplace(piece_is, piece_was).first->second != piece_was) {
      return "piece " + std::to_string(piece_was) + " and " + std::to_string(piece_is) + " in cell " + std::to_string(cell);
    }
  }
  for (const auto& segment : one.segments) {
    const auto& same = other.segments.at(static_cast<std::size_t>(forth.at(segment.id) - 1));
    if (segment.num_points != same.num_points || segment.kind != same.kind || segment.grounds != same.grounds ||
        segment.seen_share != same.seen_share || segment.confidence != same.confidence || segment.thing_probability != same.thing_probability ||
        segment.land_probability != same.land_probability) {
      return "what is said of segment " + std::to_string(segment.id) + " and " + std::to_string(same.id);
    }
  }
  return std::nullopt;
}

const std::vector<Shape>& Shapes() {
  static const std::vector<Shape> kShapes{{.num_columns = 1808}, {.num_columns = 512, .num_rings = 32}, {.num_columns = 900, .num_returns = 2}};
  return kShapes;
}

TEST(LookoutLaw, TurningTheSceneByWholeColumnsChangesNumbersOnly) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    for (const auto& shape : Shapes()) {
      const auto scan = Scene(seed, shape);
      const auto segments = SegmentScan(scan, {});
      for (const int on : {1, 77, shape.num_columns / 2, shape.num_columns - 1}) {
        const auto from = [&](int column) { return (column + on) % shape.num_columns; };
        const auto difference = Difference(scan, segments, SegmentScan(Moved(scan, from), {}), from);
        EXPECT_FALSE(difference.has_value()) << *difference << "; seed " << seed << ", " << shape.num_columns << " columns, turned by " << on;
      }
    }
  }
}

TEST(LookoutLaw, MirroringTheSceneChangesNumbersOnly) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    for (const auto& shape : Shapes()) {
      for (const double offset_rad : {0.0, 0.003}) {
        auto scan = test::EmptyScan(shape);
        for (std::size_t ring = 0; ring < scan.head.rings.size(); ++ring) {
          scan.head.rings[ring].azimuth_offset_rad = static_cast<float>(ring % 2 == 0 ? offset_rad : -offset_rad);
        }
        test::Look(scan, SceneOf(seed), 0.03, seed);
        const auto from = [&](int column) { return shape.num_columns - 1 - column; };
        auto mirrored = Moved(scan, from);
        for (auto& ring : mirrored.head.rings) ring.azimuth_offset_rad = -ring.azimuth_offset_rad;
        const auto difference = Difference(scan, SegmentScan(scan, {}), SegmentScan(mirrored, {}), from);
        EXPECT_FALSE(difference.has_value()) << *difference << "; seed " << seed << ", " << shape.num_columns << " columns, offset " << offset_rad;
      }
    }
  }
}

TEST(LookoutLaw, TurningTheMountingChangesNothing) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const auto scan = Scene(seed, {.num_columns = 1024});
    const auto segments = SegmentScan(scan, {});
    for (const double yaw_rad : {0.5, 2.0, -1.2, kPi}) {
      Params params;
      params.filter.T_vessel_lidar = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ());
      const auto difference = Difference(scan, segments, SegmentScan(scan, params), [](int column) { return column; });
      EXPECT_FALSE(difference.has_value()) << *difference << "; seed " << seed << ", yaw " << yaw_rad;
    }
  }
}

// In empty columns, 60 m off, and nothing else within 25 m.
TEST(LookoutLaw, AFarObjectChangesNothingNear) {
  int num_added = 0;
  for (std::uint64_t seed = 1; seed <= 18; ++seed) {
    const auto scan = Scene(seed, {});
    Params params;
    const auto returns = ClassifyReturns(scan, params.filter).returns;
    const auto segments = SegmentScan(scan, params);
    for (int first = 0; first + 40 <= 1808; first += 100) {
      constexpr double kFarM = 60.0;
      const double middle_rad = scan.columns.azimuth_rad[static_cast<std::size_t>(first) + 20];
      const double x_m = kFarM * std::cos(middle_rad);
      const double y_m = -kFarM * std::sin(middle_rad);
      const bool is_free = std::ranges::none_of(returns, [&](const Return& one) {
        return (one.column >= first && one.column < first + 40) || std::hypot(one.point.x_m - x_m, one.point.y_m - y_m) < 25.0;
      });
      if (!is_free) continue;
      ++num_added;
      auto with = scan;
      for (int column = first + 10; column < first + 30; ++column) {
        for (int ring = 7; ring < 10; ++ring) test::SetReturn(with, column, ring, kFarM);
      }
      const auto others = SegmentScan(with, params);
      ASSERT_EQ(others.segments.size(), segments.segments.size() + 1) << "seed " << seed << ", column " << first;
      std::map<int, int> forth;
      for (const auto& one : returns) {
        const auto cell = static_cast<std::size_t>(one.cell);
        ASSERT_EQ(forth.try_emplace(segments.label[cell], others.label[cell]).first->second, others.label[cell]) << "seed " << seed;
      }
      for (const auto& [was, is] : forth) {
        const auto& before = segments.segments.at(static_cast<std::size_t>(was - 1));
        const auto& after = others.segments.at(static_cast<std::size_t>(is - 1));
        ASSERT_EQ(before.num_points, after.num_points);
        ASSERT_EQ(before.kind, after.kind);
        ASSERT_EQ(before.grounds, after.grounds);
        ASSERT_EQ(before.land_probability, after.land_probability);
        ASSERT_EQ(before.length_m, after.length_m);
        ASSERT_EQ(before.waterline.size(), after.waterline.size());
      }
    }
  }
  EXPECT_GT(num_added, 10);
}

TEST(LookoutLaw, ATwiceReportedShotIsSaidTheSameOfAsASingleOne) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const auto single = Scene(seed, {.num_columns = 900});
    auto dual = test::EmptyScan({.num_columns = 900, .num_returns = 2});
    for (std::size_t cell = 0; cell < single.num_cells(); ++cell) {
      for (const std::size_t i : {0U, 1U}) dual.columns.range[2 * cell + i] = single.columns.range[cell];
    }
    const auto expected = SegmentScan(single, {}).segments;
    const auto segments = SegmentScan(dual, {}).segments;
    ASSERT_EQ(segments.size(), expected.size()) << "seed " << seed;
    for (std::size_t i = 0; i < segments.size(); ++i) {
      ASSERT_EQ(segments[i].num_points, expected[i].num_points);
      ASSERT_EQ(segments[i].kind, expected[i].kind);
      ASSERT_EQ(segments[i].grounds, expected[i].grounds);
      ASSERT_EQ(segments[i].seen_share, expected[i].seen_share);
      ASSERT_EQ(segments[i].waterline.size(), expected[i].waterline.size());
    }
  }
}

std::vector<std::string> BytesOf(const Scan& scan, const Segments& segments) {
  std::vector<std::string> bytes;
  for (const auto& message : ToMessages(scan, segments, bus::kMaxMessageBytes)) {
    const auto encoded = bus::Encode(message);
    bytes.emplace_back(reinterpret_cast<const char*>(encoded.data()), encoded.size());
  }
  return bytes;
}

TEST(LookoutLaw, WhatCameBeforeChangesNoByte) {
  Segmenter segmenter{Params{}};
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const auto scan = Scene(seed, Shapes()[seed % 3]);
    const auto bytes = BytesOf(scan, SegmentScan(scan, {}));
    EXPECT_EQ(BytesOf(scan, segmenter.Segment(scan)), bytes) << "seed " << seed;
    const auto between = Scene(seed + 20, Shapes()[(seed + 1) % 3]);
    segmenter.Segment(between);
    EXPECT_EQ(BytesOf(scan, segmenter.Segment(scan)), bytes) << "seed " << seed;
    segmenter.Segment(test::EmptyScan({}));
    EXPECT_EQ(BytesOf(scan, segmenter.Segment(scan)), bytes) << "seed " << seed;
  }
}

TEST(LookoutLaw, LogOddsOfABlockAreThoseOfEachToTheBit) {
  const auto evidences = DefaultEvidences();
  for (std::size_t sum = 0; sum < kNumSums; ++sum) {
    std::mt19937_64 random(sum);
    const std::size_t num_features = kEvidenceLayouts[sum].features.size();
    std::uniform_real_distribution<float> uniform(-2.0F, 30.0F);
    std::vector<std::vector<float>> features(Evidence::kBlock, std::vector<float>(num_features));
    Evidence::Block block{};
    for (std::size_t i = 0; i < features.size(); ++i) {
      for (float& feature : features[i]) feature = uniform(random);
      block[i] = features[i].data();
    }
    const auto log_odds = evidences[sum].Of(block);
    for (std::size_t i = 0; i < features.size(); ++i) ASSERT_EQ(log_odds[i], evidences[sum].Of(features[i])) << kEvidenceLayouts[sum].name;
  }
}

// A scan of ranges that no water has, and small facts of the head that are valid all the same.
Scan Garbage(std::mt19937_64& random) {
  const auto pick = [&random](std::initializer_list<int> values) { return *(values.begin() + random() % values.size()); };
  auto scan = test::EmptyScan({.num_columns = pick({3, 4, 7, 13, 100, 512, 900}),
                               .num_rings = pick({1, 2, 3, 16, 40}),
                               .num_returns = pick({1, 2}),
                               .first_azimuth_rad = 0.1 * static_cast<double>(random() % 60),
                               .width_rad = pick({1, 2, 0}) * kTwoPi / 4 + 0.01});
  const auto num_rings = scan.head.rings.size();
  for (std::size_t ring = 0; ring < num_rings; ++ring) {
    scan.head.rings[ring].elevation_rad = static_cast<float>(-0.5 + 1.0 * static_cast<double>(ring) / static_cast<double>(num_rings));
    if (random() % 4 == 0) scan.head.rings[ring].azimuth_offset_rad = static_cast<float>(random() % 100) / 1000.0F;
  }
  const int nearest = pick({1, 250, 500});
  const int farthest = nearest + pick({1, 50, 2000, 65000});
  const auto share = static_cast<std::uint64_t>(pick({1, 2, 10}));
  for (auto& range : scan.columns.range) {
    if (random() % share != 0) continue;
    range = static_cast<std::uint16_t>(nearest + static_cast<int>(random() % static_cast<std::uint64_t>(farthest - nearest)));
  }
  return scan;
}

TEST(LookoutLaw, GarbageHasLabelsAndFiniteSegmentsToo) {
  constexpr std::uint64_t kSeed = 31;
  std::mt19937_64 random(kSeed);
  Segmenter segmenter{Params{}};
  for (int round = 0; round < 150; ++round) {
    const auto scan = Garbage(random);
    const auto& segments = segmenter.Segment(scan);
    ASSERT_EQ(segments.label.size(), scan.num_cells());
    std::map<int, int> segment_of_piece;
    for (std::size_t cell = 0; cell < scan.num_cells(); ++cell) {
      ASSERT_EQ(segments.label[cell] == 0, scan.columns.range[cell] == 0);
      ASSERT_EQ(segments.piece[cell] > 0, segments.label[cell] > 0);
      if (segments.label[cell] <= 0) continue;
      ASSERT_EQ(segment_of_piece.try_emplace(segments.piece[cell], segments.label[cell]).first->second, segments.label[cell]);
    }
    for (const auto& segment : segments.segments) {
      ASSERT_GE(segment.num_points, 1);
      ASSERT_EQ(segment.confidence == Confidence::kSure, segment.grounds == 0);
      for (const float probability : {segment.thing_probability, segment.land_probability}) ASSERT_TRUE(probability >= 0.0F && probability <= 1.0F);
      ASSERT_GE(segment.seen_share, 0.0F);
      ASSERT_LE(segment.seen_share, 1.0F);
      ASSERT_EQ(segment.waterline.empty(), segment.kind == SegmentKind::kObstacle);
      ASSERT_LE(segment.waterline.size(), kMaxWaterlineCorners);
      for (const float value : {segment.box_center_x_m, segment.box_center_y_m, segment.length_m, segment.width_m, segment.length_azimuth_rad,
                                segment.top.z_m, segment.centroid.x_m}) {
        ASSERT_TRUE(std::isfinite(value)) << "round " << round;
      }
    }
  }
}

}  // namespace
}  // namespace lookout::segmenter
