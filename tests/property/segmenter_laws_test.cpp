// Laws of the whole method on seeded scenes, and messages that lie.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <set>

#include "services/segmenter/service.hpp"
#include "services/segmenter/wire.hpp"
#include "tests/support/memory_bus.hpp"
#include "tests/unit/segmenter/message_maker.hpp"
#include "tests/unit/segmenter/scan_maker.hpp"

namespace lookout::segmenter {
namespace {

Scan LakeScene(std::uint64_t seed, const test::Shape& shape) {
  auto scan = test::EmptyScan(shape);
  test::Look(scan, test::Lake(seed), 0.05, seed);
  if (seed % 2 == 0) test::AddRain(scan, 300, seed);
  return scan;
}

// The same scan, cut elsewhere.
Scan Rotated(const Scan& scan, int num_columns) {
  Scan rotated = scan;
  const auto rotate = [num_columns](auto& values, std::size_t per_column) {
    std::rotate(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(num_columns) * per_column), values.end());
  };
  const auto cells_per_column = static_cast<std::size_t>(scan.head.num_rings() * scan.head.num_returns);
  rotate(rotated.columns.azimuth_rad, 1);
  rotate(rotated.columns.range, cells_per_column);
  rotate(rotated.columns.reflectivity, cells_per_column);
  return rotated;
}

// Whether two labellings are equal up to numbering.
bool AreEqualUpToNumbering(const std::vector<std::int16_t>& one, const std::vector<std::int16_t>& other) {
  if (one.size() != other.size()) return false;
  std::map<std::int16_t, std::int16_t> forth;
  std::map<std::int16_t, std::int16_t> back;
  for (std::size_t i = 0; i < one.size(); ++i) {
    if ((one[i] <= 0 || other[i] <= 0) && one[i] != other[i]) return false;
    if (forth.try_emplace(one[i], other[i]).first->second != other[i]) return false;
    if (back.try_emplace(other[i], one[i]).first->second != one[i]) return false;
  }
  return true;
}

Params Way(int image_columns, bool label_shadowed_returns = true) {
  Params params;
  params.method = Method::kPaper;
  params.labelling.image_columns = image_columns;
  params.labelling.label_shadowed_returns = label_shadowed_returns;
  params.clustering.e2_max_distance_m = 10.0;
  return params;
}

TEST(SegmentScanLaw, LabelsDoNotDependOnWhereTheScanIsCut) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    for (const auto& params : {Params{}, Way(0), Way(512), Way(512, false), Way(1800)}) {
      const auto scan = LakeScene(seed, {.num_columns = 900, .num_returns = 1 + static_cast<int>(seed % 2)});
      auto label = SegmentScan(scan, params).label;
      for (const int num_columns : {1, 123, 450, 899}) {
        const auto rotated = SegmentScan(Rotated(scan, num_columns), params).label;
        auto expected = label;
        std::rotate(expected.begin(), expected.begin() + static_cast<std::ptrdiff_t>(num_columns) * scan.head.num_rings() * scan.head.num_returns,
                    expected.end());
        EXPECT_TRUE(AreEqualUpToNumbering(rotated, expected))
            << "seed " << seed << ", columns " << params.labelling.image_columns << ", cut " << num_columns;
      }
    }
  }
}

TEST(SegmentScanLaw, AnImageWithAPixelPerColumnGivesWhatOwnColumnsGive) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const auto scan = LakeScene(seed, {.num_columns = 900});
    const auto own = SegmentScan(scan, Way(0));
    EXPECT_EQ(SegmentScan(scan, Way(900)).label, own.label) << "seed " << seed;
    EXPECT_EQ(SegmentScan(scan, Way(900, false)).label, own.label) << "seed " << seed;
  }
}

TEST(SegmentScanLaw, EveryReturnHasALabelAndEverySegmentIsFiniteAndHoldsItsReturns) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    for (const auto& params : {Params{}, Way(0), Way(512), Way(512, false), Way(1024), Way(8192)}) {
      const auto scan = LakeScene(seed, {.num_returns = 1 + static_cast<int>(seed % 2)});
      const auto segments = SegmentScan(scan, params);
      std::map<int, int> num_points;
      std::set<std::size_t> repeats;
      for (const auto& repeat : ClassifyReturns(scan, params.filter).repeats) repeats.insert(static_cast<std::size_t>(repeat.cell));
      ASSERT_EQ(static_cast<std::size_t>(segments.num_repeats), repeats.size());
      ASSERT_EQ(repeats.empty(), scan.head.num_returns == 1);
      for (std::size_t cell = 0; cell < scan.num_cells(); ++cell) {
        ASSERT_EQ(segments.label[cell] == 0, scan.columns.range[cell] == 0);
        if (segments.label[cell] > 0 && !repeats.contains(cell)) ++num_points[segments.label[cell]];
        ASSERT_TRUE(!params.labelling.label_shadowed_returns || segments.label[cell] != ToLabel(Reason::kShadowed));
      }
      ASSERT_EQ(num_points.size(), segments.segments.size());
      for (const auto& segment : segments.segments) {
        ASSERT_EQ(segment.num_points, num_points[segment.id]);
        for (const float value :
             {segment.centroid.x_m, segment.centroid.y_m, segment.centroid.z_m, segment.nearest.x_m, segment.nearest.y_m, segment.nearest.z_m,
              segment.length_m, segment.width_m, segment.length_azimuth_rad, segment.min_z_m, segment.max_z_m, segment.mean_reflectivity}) {
          ASSERT_TRUE(std::isfinite(value));
        }
        ASSERT_GE(segment.time, scan.head.time);
        ASSERT_LE(segment.time, scan.head.end_time);
        ASSERT_GE(segment.hull.size(), 1U);
        ASSERT_LE(segment.hull.size(), 256U);
        const double nearest_m = std::sqrt(SquaredDistance(segment.nearest, {}));
        constexpr double kRoundingM = 1e-4;  // numbers of the message have single precision
        ASSERT_LE(nearest_m - kRoundingM,
                  std::sqrt(SquaredDistance(segment.centroid, {})) + segment.length_m + segment.width_m + segment.max_z_m - segment.min_z_m);
      }
    }
  }
}

// In dual return a head that sees one echo per shot reports it twice: nothing but the labels of the second cells may differ from single return.
TEST(SegmentScanLaw, AScanWhoseShotsAllRepeatThemselvesGivesTheSegmentsOfSingleReturn) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    for (const auto& params : {Params{}, Way(0), Way(512), Way(512, false), Way(1800)}) {
      const auto single = LakeScene(seed, {.num_columns = 900});
      auto dual = test::EmptyScan({.num_columns = 900, .num_returns = 2});
      std::mt19937_64 random(seed);
      for (std::size_t cell = 0; cell < single.num_cells(); ++cell) {
        for (const std::size_t i : {0U, 1U}) dual.columns.reflectivity[2 * cell + i] = single.columns.reflectivity[cell];
        dual.columns.range[2 * cell] = single.columns.range[cell];
        if (single.columns.range[cell] == 0) continue;
        dual.columns.range[2 * cell + 1] = static_cast<std::uint16_t>(single.columns.range[cell] + random() % 101 - 50);  // up to 0.1 m
      }
      const auto expected = SegmentScan(single, params);
      const auto segments = SegmentScan(dual, params);
      ASSERT_EQ(segments.segments.size(), expected.segments.size()) << "seed " << seed << ", method " << static_cast<int>(params.method);
      for (std::size_t i = 0; i < segments.segments.size(); ++i) {
        ASSERT_EQ(segments.segments[i].num_points, expected.segments[i].num_points) << "seed " << seed;
        ASSERT_EQ(segments.segments[i].centroid.x_m, expected.segments[i].centroid.x_m);
        ASSERT_EQ(segments.segments[i].mean_reflectivity, expected.segments[i].mean_reflectivity);
        ASSERT_EQ(segments.segments[i].length_m, expected.segments[i].length_m);
      }
      for (std::size_t cell = 0; cell < single.num_cells(); ++cell) {
        ASSERT_EQ(segments.label[2 * cell], expected.label[cell]) << "seed " << seed;
        ASSERT_EQ(segments.label[2 * cell + 1], expected.label[cell]) << "seed " << seed;
      }
    }
  }
}

TEST(SegmentScanLaw, SingleReturnDoesNotDependOnTheGapOfRepeats) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto scan = LakeScene(seed, {});
    auto params = Way(0);
    const auto segments = SegmentScan(scan, params);
    params.filter.max_repeat_gap_m = 10.0;
    const auto others = SegmentScan(scan, params);
    const auto one = ToMessages(scan, segments, bus::kMaxMessageBytes);
    const auto other = ToMessages(scan, others, bus::kMaxMessageBytes);
    ASSERT_EQ(one.size(), other.size());
    for (std::size_t part = 0; part < one.size(); ++part) EXPECT_EQ(bus::Encode(one[part]), bus::Encode(other[part])) << "seed " << seed;
    EXPECT_EQ(segments.num_repeats, 0);
  }
}

TEST(SegmentScanLaw, LessIsJoinedWhereRulesAreStricter) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const auto scan = LakeScene(seed, {});
    std::size_t last = 0;
    for (const double e3_distance_m : {20.0, 5.0, 3.5, 1.0, 0.0}) {
      auto params = Way(0);
      params.clustering.e3_distance_m = e3_distance_m;
      const auto count = SegmentScan(scan, params).segments.size();
      EXPECT_GE(count, last);
      last = count;
    }
    auto params = Way(0);
    params.component_clustering = false;
    EXPECT_GE(SegmentScan(scan, params).segments.size(), last);
  }
}

// Spoils a message so that it still decodes.
void Spoil(lidar_scan_t& message, std::mt19937_64& random) {
  const auto pick = [&random](std::size_t size) { return static_cast<std::size_t>(random() % size); };
  const std::int32_t numbers[]{-1, 0, 1, 2, 127, 129, 65537, 2147483647, static_cast<std::int32_t>(random() % 3000)};
  const std::int32_t number = numbers[pick(std::size(numbers))];
  const float floats[]{std::nanf(""), -1.0F, 7.0F, 1e30F, -1e-40F, 0.0F, 3.0F};
  const float value = floats[pick(std::size(floats))];
  const auto set = [&pick](auto& values, auto to) {
    if (!values.empty()) values[pick(values.size())] = to;
  };
  switch (pick(14)) {
    case 0:
      message.num_turn_columns = number;
      break;
    case 1:
      message.first_column = number;
      break;
    case 2:
      message.part_index = number;
      break;
    case 3:
      message.num_parts = number;
      break;
    case 4:
      set(message.azimuth_rad, value);
      break;
    case 5:
      set(message.elevation_rad, value);
      break;
    case 6:
      set(message.azimuth_offset_rad, value);
      break;
    case 7:
      set(message.origin_height_m, value);
      break;
    case 8:
      set(message.time_ns, number);
      break;
    case 9:
      set(message.time_offset_ns, number);
      break;
    case 10:
      message.range_unit_m = value;
      break;
    case 11:
      message.utime_us = static_cast<std::int64_t>(random());
      break;
    case 12:
      message.seq = number;
      break;
    default:
      for (auto& range : message.range) range = static_cast<std::int16_t>(random());
  }
}

TEST(SegmenterServiceLaw, MessagesThatLieAreRefusedAndNothingElseHappens) {
  bus::MemoryBus bus;
  const Service service(bus, Params{});
  std::int64_t num_answers = 0;
  bus.SubscribeRaw(bus::kSegments, [&](std::string_view, Bytes) { ++num_answers; });
  constexpr std::uint64_t kSeed = 21;
  std::mt19937_64 random(kSeed);
  std::vector<lidar_scan_t> good;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    for (const auto& message : test::ScanMessages(LakeScene(seed, {.num_columns = 200}), static_cast<std::int64_t>(seed), static_cast<int>(seed))) {
      good.push_back(message);
    }
  }
  for (int round = 0; round < 3000; ++round) {
    auto message = good[random() % good.size()];
    for (std::uint64_t spoils = random() % 3; spoils > 0; --spoils) Spoil(message, random);
    bus::Publish(bus, bus::kLidarScan, message);
    support::HandleAll(bus);
  }
  std::map<std::string_view, std::int64_t> counts;
  for (const auto& counter : service.Report().counters) counts[counter.name] = counter.count;
  EXPECT_GT(num_answers, 200);
  for (const auto* name : {"refused_time", "refused_size", "refused_beams", "refused_range_unit", "refused_part", "refused_azimuth",
                           "scans_incomplete", "parts_duplicate"}) {
    EXPECT_GT(counts[name], 0) << name;
  }
}

}  // namespace
}  // namespace lookout::segmenter
