// In how many parts a scan may come, so that who waits for them needs no memory without end.
#include <gtest/gtest.h>

#include "common/messages/checks.hpp"

namespace lookout::messages::part_limits {
namespace {

constexpr int kMaxBytes = 120'000;

template <typename Message>
Message LastPart(std::int32_t num_parts) {
  Message message{};
  message.utime_us = 1'800'000'000'000'000;
  message.num_parts = num_parts;
  message.part_index = num_parts - 1;
  return message;
}

// One column a part, of a scan that has more columns than it may have parts.
lidar_scan_t LastColumn(std::int32_t num_parts) {
  auto scan = LastPart<lidar_scan_t>(num_parts);
  scan.end_utime_us = scan.utime_us + 100'000;
  scan.num_rings = scan.num_returns = scan.num_columns = scan.num_cells = 1;
  scan.num_turn_columns = 3000;
  scan.first_column = num_parts - 1;
  scan.range_unit_m = 0.002;
  scan.elevation_rad = scan.azimuth_offset_rad = scan.origin_height_m = scan.azimuth_rad = {0.0F};
  scan.time_offset_ns = scan.time_ns = {0};
  scan.return_kind = {lidar_scan_t::RETURN_STRONGEST};
  scan.range = {1000};
  scan.reflectivity = {7};
  return scan;
}

// As many parts as it had columns were accepted, up to 65 536.
TEST(PartLimits, OfLidarScanAreAThousand) {
  EXPECT_EQ(FaultOf(LastColumn(1000), kMaxBytes), std::nullopt);
  EXPECT_EQ(FaultOf(LastColumn(1001), kMaxBytes), kScanPart);
}

TEST(PartLimits, OfSegmentsAreAThousand) {
  auto segments = LastPart<segments_t>(1000);
  segments.end_utime_us = segments.utime_us;
  EXPECT_EQ(FaultOf(segments, kMaxBytes), std::nullopt);
  ++segments.num_parts;
  EXPECT_EQ(FaultOf(segments, kMaxBytes), kSegmentsParts);
}

TEST(PartLimits, OfObstaclesAreTwoThousand) {
  auto obstacles = LastPart<obstacles_t>(2000);
  obstacles.end_utime_us = obstacles.utime_us;
  obstacles.datum_latitude_deg = obstacles.datum_longitude_deg = 0.0;
  EXPECT_EQ(FaultOf(obstacles, kMaxBytes), std::nullopt);
  ++obstacles.num_parts;
  EXPECT_EQ(FaultOf(obstacles, kMaxBytes), kObstaclesParts);
}

TEST(PartLimits, HoldForToolsToo) {
  EXPECT_TRUE(IsWellFormed(LastPart<lidar_scan_t>(1000)));
  EXPECT_FALSE(IsWellFormed(LastPart<lidar_scan_t>(1001)));
  EXPECT_TRUE(IsWellFormed(LastPart<segments_t>(1000)));
  EXPECT_FALSE(IsWellFormed(LastPart<segments_t>(1001)));
  EXPECT_TRUE(IsWellFormed(LastPart<obstacles_t>(2000)));
  EXPECT_FALSE(IsWellFormed(LastPart<obstacles_t>(2001)));
  EXPECT_TRUE(IsWellFormed(LastPart<tracks_t>(1000)));
  EXPECT_FALSE(IsWellFormed(LastPart<tracks_t>(1001)));
}

}  // namespace
}  // namespace lookout::messages::part_limits
