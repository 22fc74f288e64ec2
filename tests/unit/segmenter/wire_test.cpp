#include "services/segmenter/wire.hpp"

#include <functional>
#include <gtest/gtest.h>
#include <limits>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "services/segmenter/core/footprint.hpp"
#include "tests/unit/segmenter/message_maker.hpp"
#include "tests/unit/segmenter/scan_maker.hpp"

namespace lookout::segmenter {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

lidar_scan_t GoodMessage() {
  auto scan = test::EmptyScan({.num_columns = 20, .num_rings = 4});
  test::SetReturn(scan, 3, 2, 131.07);
  return test::ScanMessages(scan, 7, 2)[1];
}

std::optional<messages::Fault> FaultOf(const lidar_scan_t& message) { return messages::FaultOf(message, bus::kMaxMessageBytes); }

TEST(ToScan, CopiesGoodMessages) {
  auto scan = test::EmptyScan({.num_columns = 20, .num_rings = 4});
  test::SetReturn(scan, 13, 2, 131.07, 0, 255);
  const auto messages = test::ScanMessages(scan, 7, 2);
  const auto result = ToScan(messages);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->head.seq, 7);
  EXPECT_EQ(result->head.raw_seq, 12);
  EXPECT_EQ(result->head.time, test::kScanTime);
  EXPECT_EQ(result->head.end_time, scan.head.end_time);
  EXPECT_EQ(result->head.flags, lidar_scan_t::FLAG_HOLE);
  EXPECT_EQ(result->head.num_parts, 2);
  EXPECT_EQ(result->head.rings, scan.head.rings);
  ASSERT_EQ(result->parts.size(), 2U);
  EXPECT_EQ(result->parts[1].first_column, 10);
  EXPECT_EQ(result->parts[1].num_columns, 10);
  EXPECT_EQ(result->columns.azimuth_rad, scan.columns.azimuth_rad);
  EXPECT_EQ(result->columns.time_ns, scan.columns.time_ns);
  EXPECT_EQ(result->columns.range, scan.columns.range);
  EXPECT_EQ(result->columns.range[test::CellOf(scan, 13, 2)], 65535);  // above what 16 bits with a sign hold
  EXPECT_EQ(result->columns.reflectivity[test::CellOf(scan, 13, 2)], 255);
}

TEST(ToScan, RefusesColumnsThatOverlapOrLeaveGaps) {
  auto messages = test::ScanMessages(test::EmptyScan({.num_columns = 20, .num_rings = 4}), 7, 2);
  ASSERT_TRUE(ToScan(messages));
  for (const int first_column : {9, 11}) {
    messages[1].first_column = first_column;
    EXPECT_FALSE(ToScan(messages)) << first_column;
  }
  EXPECT_FALSE(ToScan({messages[0]}));  // too few columns
}

TEST(FaultOfScan, SaysWhatIsWrongWithAMessage) {
  struct Case {
    messages::Fault fault;
    std::function<void(lidar_scan_t&)> spoil;
  };
  const std::vector<Case> cases{
      {messages::kScanTime, [](lidar_scan_t& m) { m.utime_us = std::numeric_limits<std::int64_t>::max(); }},
      {messages::kScanTime, [](lidar_scan_t& m) { m.end_utime_us = std::numeric_limits<std::int64_t>::min(); }},
      {messages::kScanTime, [](lidar_scan_t& m) { m.end_utime_us = m.utime_us - 1; }},
      {messages::kScanCounts, [](lidar_scan_t& m) { m.elevation_rad.pop_back(); }},
      {messages::kScanCounts, [](lidar_scan_t& m) { m.azimuth_offset_rad.pop_back(); }},
      {messages::kScanCounts, [](lidar_scan_t& m) { m.time_offset_ns.push_back(0); }},
      {messages::kScanCounts, [](lidar_scan_t& m) { m.origin_height_m.clear(); }},
      {messages::kScanCounts, [](lidar_scan_t& m) { m.return_kind.push_back(2); }},
      {messages::kScanCounts, [](lidar_scan_t& m) { m.num_columns = 11; }},
      {messages::kScanCounts, [](lidar_scan_t& m) { m.num_columns = -1; }},
      {messages::kScanCounts, [](lidar_scan_t& m) { m.num_columns = std::numeric_limits<std::int32_t>::max(); }},
      {messages::kScanCounts, [](lidar_scan_t& m) { m.time_ns.pop_back(); }},
      {messages::kScanCounts, [](lidar_scan_t& m) { m.range.pop_back(); }},
      {messages::kScanCounts, [](lidar_scan_t& m) { m.reflectivity.pop_back(); }},
      {messages::kScanCounts,
       [](lidar_scan_t& m) {
         m.range.pop_back();
         m.reflectivity.pop_back();
         --m.num_cells;
       }},
      {messages::kScanSize, [](lidar_scan_t& m) { m.num_rings = 0; }},
      {messages::kScanSize, [](lidar_scan_t& m) { m.num_rings = 129; }},
      {messages::kScanSize, [](lidar_scan_t& m) { m.num_returns = 0; }},
      {messages::kScanSize, [](lidar_scan_t& m) { m.num_returns = 3; }},
      {messages::kScanSize, [](lidar_scan_t& m) { m.num_turn_columns = -1; }},
      {messages::kScanSize, [](lidar_scan_t& m) { m.num_turn_columns = 65537; }},
      {messages::kScanSize, [](lidar_scan_t& m) { m.model.assign(120'000, 'x'); }},
      {messages::kScanBeams, [](lidar_scan_t& m) { m.elevation_rad[1] = kNan; }},
      {messages::kScanBeams, [](lidar_scan_t& m) { m.elevation_rad[3] = 1.6F; }},
      {messages::kScanBeams, [](lidar_scan_t& m) { std::swap(m.elevation_rad[0], m.elevation_rad[1]); }},
      {messages::kScanBeams, [](lidar_scan_t& m) { m.azimuth_offset_rad[0] = kNan; }},
      {messages::kScanBeams, [](lidar_scan_t& m) { m.azimuth_offset_rad[0] = 7.0F; }},
      {messages::kScanBeams, [](lidar_scan_t& m) { m.origin_height_m[2] = std::numeric_limits<float>::infinity(); }},
      {messages::kScanRangeUnit, [](lidar_scan_t& m) { m.range_unit_m = 0.0; }},
      {messages::kScanRangeUnit, [](lidar_scan_t& m) { m.range_unit_m = -0.002; }},
      {messages::kScanRangeUnit, [](lidar_scan_t& m) { m.range_unit_m = std::numeric_limits<double>::quiet_NaN(); }},
      {messages::kScanRangeUnit, [](lidar_scan_t& m) { m.range_unit_m = std::numeric_limits<double>::infinity(); }},
      {messages::kScanPart, [](lidar_scan_t& m) { m.seq = -1; }},
      {messages::kScanPart, [](lidar_scan_t& m) { m.part_index = -1; }},
      {messages::kScanPart, [](lidar_scan_t& m) { m.part_index = 2; }},
      {messages::kScanPart, [](lidar_scan_t& m) { m.num_parts = 0; }},
      {messages::kScanPart, [](lidar_scan_t& m) { m.num_parts = 21; }},
      {messages::kScanPart, [](lidar_scan_t& m) { m.first_column = 11; }},
      {messages::kScanPart, [](lidar_scan_t& m) { m.first_column = -1; }},
      {messages::kScanPart, [](lidar_scan_t& m) { m.first_column = std::numeric_limits<std::int32_t>::max(); }},
      {messages::kScanPart,
       [](lidar_scan_t& m) {
         m.num_columns = m.num_cells = 0;
         m.azimuth_rad.clear();
         m.time_ns.clear();
         m.range.clear();
         m.reflectivity.clear();
       }},
      {messages::kScanAzimuth, [](lidar_scan_t& m) { m.azimuth_rad[0] = kNan; }},
      {messages::kScanAzimuth, [](lidar_scan_t& m) { m.azimuth_rad[9] = -0.001F; }},
      {messages::kScanAzimuth, [](lidar_scan_t& m) { m.azimuth_rad[5] = 6.2832F; }},
  };
  ASSERT_FALSE(FaultOf(GoodMessage()));
  for (std::size_t i = 0; i < cases.size(); ++i) {
    auto message = GoodMessage();
    cases[i].spoil(message);
    EXPECT_EQ(FaultOf(message), cases[i].fault) << "case " << i;
  }
}

TEST(FaultOfScan, AcceptsTheBoundsThemselves) {
  auto message = GoodMessage();
  message.azimuth_rad[0] = 0.0F;
  message.azimuth_rad[9] = static_cast<float>(kTwoPi);
  message.end_utime_us = message.utime_us;
  EXPECT_FALSE(FaultOf(message));
  EXPECT_FALSE(FaultOf(test::ScanMessages(test::EmptyScan({.num_columns = 0}), 0, 1)[0]));
}

// Segments with as many corners as there can be.
Segments ManySegments(std::size_t num_cells, int num_segments, std::size_t num_corners, std::size_t num_waterline_corners = 0) {
  Segments segments;
  segments.label.assign(num_cells, 1);
  segments.piece.assign(num_cells, 1);
  for (int id = 1; id <= num_segments; ++id) {
    Segment segment;
    segment.id = id;
    segment.hull.resize(num_corners);
    segment.waterline.resize(num_waterline_corners);
    segments.segments.push_back(segment);
  }
  return segments;
}

void ExpectGoodParts(const std::vector<segments_t>& parts, int num_segments) {
  int next_id = 1;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    EXPECT_LE(bus::Encode(parts[i]).size(), static_cast<std::size_t>(bus::kMaxMessageBytes));
    EXPECT_EQ(parts[i].part_index, static_cast<int>(i));
    EXPECT_EQ(parts[i].num_parts, static_cast<int>(parts.size()));
    EXPECT_EQ(parts[i].num_turn_segments, num_segments);
    EXPECT_EQ(parts[i].num_cells, parts[i].num_columns * parts[i].num_rings * parts[i].num_returns);
    EXPECT_EQ(parts[i].label.size(), static_cast<std::size_t>(parts[i].num_cells));
    EXPECT_TRUE(messages::IsWellFormed(parts[i]));
    for (const auto& segment : parts[i].segments) EXPECT_EQ(segment.id, next_id++);
  }
  EXPECT_EQ(next_id, num_segments + 1);
}

TEST(ToMessages, FollowsThePartsOfTheScan) {
  auto scan = test::EmptyScan({});
  scan.head.seq = 9;
  scan.head.raw_seq = 11;
  scan.head.flags = 5;
  scan.parts = {{0, 1000}, {1000, 808}};
  auto segments = ManySegments(scan.num_cells(), 3, 4);
  segments.label[16000] = -4;
  segments.piece[16000] = 0;
  segments.piece[0] = 3;
  segments.piece[16002] = 7;
  const auto parts = ToMessages(scan, segments, bus::kMaxMessageBytes);
  ASSERT_EQ(parts.size(), 2U);
  ExpectGoodParts(parts, 3);
  EXPECT_EQ(parts[0].utime_us, ToUtimeUs(test::kScanTime));
  EXPECT_EQ(parts[0].end_utime_us, ToUtimeUs(scan.head.end_time));
  EXPECT_EQ(parts[0].seq, 9);
  EXPECT_EQ(parts[1].raw_seq, 11);
  EXPECT_EQ(parts[1].scan_flags, 5);
  EXPECT_EQ(parts[1].first_column, 1000);
  EXPECT_EQ(parts[1].num_columns, 808);
  EXPECT_EQ(parts[1].label[0], -4);
  EXPECT_EQ(parts[0].num_labelled, 16000);
  EXPECT_EQ(parts[0].piece[0], 3);
  EXPECT_EQ(parts[1].num_labelled, 808 * 16 - 1);
  EXPECT_EQ(parts[1].piece[1], 7) << "of the second cell that has a label above 0";
  EXPECT_EQ(parts[0].num_segments, 3);
  EXPECT_EQ(parts[1].num_segments, 0);
}

TEST(ToMessages, PutsWhatDoesNotFitInFurtherPartsWithoutColumns) {
  const auto scan = test::EmptyScan({});
  for (const auto& [num_segments, num_corners] : {std::pair{5000, 1}, {100, 256}, {28928, 1}}) {
    const auto segments = ManySegments(scan.num_cells(), num_segments, static_cast<std::size_t>(num_corners));
    const auto parts = ToMessages(scan, segments, bus::kMaxMessageBytes);
    ASSERT_GT(parts.size(), 1U);
    ExpectGoodParts(parts, num_segments);
    EXPECT_EQ(parts[0].num_columns, 1808);
    for (std::size_t i = 1; i < parts.size(); ++i) {
      EXPECT_EQ(parts[i].num_columns, 0);
      EXPECT_GT(parts[i].num_segments, 0);
    }
  }
}

// 19 of these fill a message; counted without their waterline, 38 would be put into it.
TEST(ToMessages, CountsTheBytesOfWaterlines) {
  const auto scan = test::EmptyScan({.num_columns = 0});
  const auto segments = ManySegments(0, 100, kMaxHullCorners, kMaxWaterlineCorners);
  const auto parts = ToMessages(scan, segments, bus::kMaxMessageBytes);
  ASSERT_EQ(parts.size(), 6U);
  int next_id = 1;
  for (const auto& part : parts) {
    EXPECT_LE(bus::Encode(part).size(), static_cast<std::size_t>(bus::kMaxMessageBytes));
    for (const auto& segment : part.segments) EXPECT_EQ(segment.id, next_id++);
  }
  EXPECT_EQ(next_id, 101);
  EXPECT_EQ(parts[0].num_segments, 19);
}

// Two parts, of which only the second has too many labels: 40 000 bytes of them, and as many of pieces.
TEST(ToMessages, GoesWithoutPiecesWhereThoseOfOnePartDoNotFit) {
  constexpr int kMaxBytes = 60'000;
  auto scan = test::EmptyScan({});
  scan.parts = {{0, 558}, {558, 1250}};
  auto segments = ManySegments(scan.num_cells(), 3, 4);
  const auto all_fit = ToMessages(scan, segments, bus::kMaxMessageBytes);
  EXPECT_EQ(all_fit[0].num_labelled, all_fit[0].num_cells);
  EXPECT_EQ(all_fit[1].num_labelled, all_fit[1].num_cells);
  const auto parts = ToMessages(scan, segments, kMaxBytes);
  ExpectGoodParts(parts, 3);
  ASSERT_EQ(parts.size(), 2U);
  for (const auto& part : parts) {
    EXPECT_EQ(part.num_labelled, 0);
    EXPECT_LE(part.getEncodedSize(), kMaxBytes);
  }
}

TEST(ToMessages, OfAnEmptyTurnIsOnePart) {
  const auto parts = ToMessages(test::EmptyScan({.num_columns = 0}), {}, bus::kMaxMessageBytes);
  ASSERT_EQ(parts.size(), 1U);
  ExpectGoodParts(parts, 0);
}

TEST(ToMessages, CarriesEveryFieldOfASegment) {
  const auto scan = test::EmptyScan({.num_columns = 1, .num_rings = 1});
  Segments segments;
  segments.label = segments.piece = {1};
  segments.segments.push_back({.time = test::kScanTime + std::chrono::microseconds(3),
                               .id = 1,
                               .confidence = Confidence::kTentative,
                               .grounds = Ground::kFewReturns | Ground::kAtSurface,
                               .kind = SegmentKind::kLand,
                               .thing_probability = 0.25F,
                               .land_probability = 0.625F,
                               .num_points = 2,
                               .centroid = {1, 2, 3},
                               .nearest = {4, 5, 6},
                               .nearest_time = test::kScanTime + std::chrono::microseconds(4),
                               .top = {0.5F, 1.5F, 2.5F},
                               .box_center_x_m = 3.5F,
                               .box_center_y_m = 4.5F,
                               .length_m = 7,
                               .width_m = 8,
                               .length_azimuth_rad = 0.5F,
                               .min_z_m = -1,
                               .max_z_m = 9,
                               .min_reflectivity = 6,
                               .mean_reflectivity = 10.5F,
                               .max_reflectivity = 11,
                               .seen_share = 0.75F,
                               .hull = {{12, 13, 14}, {15, 16, 17}},
                               .waterline = {{18, 19, 20}, {21, 22, 23}, {24, 25, 26}}});
  const auto message = ToMessages(scan, segments, bus::kMaxMessageBytes).at(0).segments.at(0);
  EXPECT_EQ(message.utime_us, ToUtimeUs(test::kScanTime) + 3);
  EXPECT_EQ(message.id, 1);
  EXPECT_EQ(message.confidence, segment_t::CONFIDENCE_TENTATIVE);
  EXPECT_EQ(message.grounds, 1 + 4);
  EXPECT_EQ(message.kind, segment_t::KIND_LAND);
  EXPECT_EQ(message.thing_probability, 0.25F);
  EXPECT_EQ(message.land_probability, 0.625F);
  EXPECT_EQ(message.num_points, 2);
  EXPECT_EQ(std::vector<float>(message.centroid_m, message.centroid_m + 3), (std::vector<float>{1, 2, 3}));
  EXPECT_EQ(std::vector<float>(message.nearest_m, message.nearest_m + 3), (std::vector<float>{4, 5, 6}));
  EXPECT_EQ(message.nearest_utime_us, ToUtimeUs(test::kScanTime) + 4);
  EXPECT_EQ(std::vector<float>(message.top_m, message.top_m + 3), (std::vector<float>{0.5F, 1.5F, 2.5F}));
  EXPECT_EQ(message.box_center_m[0], 3.5F);
  EXPECT_EQ(message.box_center_m[1], 4.5F);
  EXPECT_EQ(message.length_m, 7.0F);
  EXPECT_EQ(message.width_m, 8.0F);
  EXPECT_EQ(message.length_azimuth_rad, 0.5F);
  EXPECT_EQ(message.min_z_m, -1.0F);
  EXPECT_EQ(message.max_z_m, 9.0F);
  EXPECT_EQ(message.min_reflectivity, 6);
  EXPECT_EQ(message.mean_reflectivity, 10.5F);
  EXPECT_EQ(message.max_reflectivity, 11);
  EXPECT_EQ(message.seen_share, 0.75F);
  EXPECT_EQ(message.num_hull, 2);
  EXPECT_EQ(message.hull_x_m, (std::vector<float>{12, 15}));
  EXPECT_EQ(message.hull_y_m, (std::vector<float>{13, 16}));
  EXPECT_EQ(message.hull_time_us, (std::vector<std::int32_t>{14, 17}));
  EXPECT_EQ(message.num_waterline, 3);
  EXPECT_EQ(message.waterline_x_m, (std::vector<float>{18, 21, 24}));
  EXPECT_EQ(message.waterline_y_m, (std::vector<float>{19, 22, 25}));
  EXPECT_EQ(message.waterline_time_us, (std::vector<std::int32_t>{20, 23, 26}));
}

}  // namespace
}  // namespace lookout::segmenter
