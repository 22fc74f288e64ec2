#include "common/messages/part_assembler.hpp"

#include <array>
#include <gtest/gtest.h>

namespace lookout::messages {
namespace {

lidar_scan_t Part(std::int64_t seq, int part_index, int num_parts) {
  lidar_scan_t part{};
  part.seq = seq;
  part.part_index = part_index;
  part.num_parts = num_parts;
  part.elevation_rad = {0.0F};
  return part;
}

void ExpectWhole(const std::vector<lidar_scan_t>& parts, int num_parts) {
  ASSERT_EQ(parts.size(), static_cast<std::size_t>(num_parts));
  for (int index = 0; index < num_parts; ++index) EXPECT_EQ(parts[static_cast<std::size_t>(index)].part_index, index);
}

TEST(PartAssembler, HandsOnAScanOfOnePartAtOnceEachTimeItComes) {
  PartAssembler<lidar_scan_t> assembler;
  for (int i = 0; i < 2; ++i) ExpectWhole(assembler.Add(Part(7, 0, 1)).whole, 1);
  EXPECT_EQ(assembler.counts().duplicate_parts, 0);
}

TEST(PartAssembler, JoinsPartsInAnyOrder) {
  for (const auto& order : {std::vector{0, 1, 2}, {2, 1, 0}, {1, 2, 0}}) {
    PartAssembler<lidar_scan_t> assembler;
    std::vector<lidar_scan_t> whole;
    for (const int part : order) {
      EXPECT_TRUE(whole.empty());
      whole = assembler.Add(Part(7, part, 3)).whole;
    }
    ExpectWhole(whole, 3);
  }
}

TEST(PartAssembler, HandsOnAndCountsAnIncompleteScanWhenTheNextBegins) {
  PartAssembler<lidar_scan_t> assembler;
  EXPECT_TRUE(assembler.Add(Part(7, 1, 2)).incomplete.empty());
  const auto ended = assembler.Add(Part(8, 0, 2));
  EXPECT_TRUE(ended.whole.empty());
  ASSERT_EQ(ended.incomplete.size(), 1U);
  EXPECT_EQ(ended.incomplete[0].seq, 7);
  EXPECT_EQ(assembler.counts().incomplete_scans, 1);
  ExpectWhole(assembler.Add(Part(8, 1, 2)).whole, 2);
  EXPECT_TRUE(assembler.Add(Part(7, 0, 2)).whole.empty());  // too late
}

TEST(PartAssembler, TakesTheSameNumberAtAnotherTimeForAnotherScan) {
  // The publisher was started again.
  PartAssembler<lidar_scan_t> assembler;
  assembler.Add(Part(0, 0, 2));
  auto part = Part(0, 0, 2);
  part.utime_us += 9'000'000;
  EXPECT_EQ(assembler.Add(part).incomplete.size(), 1U);
  EXPECT_EQ(assembler.counts().incomplete_scans, 1);
}

TEST(PartAssembler, RefusesAPartThatCameBefore) {
  PartAssembler<lidar_scan_t> assembler;
  assembler.Add(Part(7, 0, 2));
  EXPECT_TRUE(assembler.Add(Part(7, 0, 2)).whole.empty());
  EXPECT_EQ(assembler.counts().duplicate_parts, 1);
  ExpectWhole(assembler.Add(Part(7, 1, 2)).whole, 2);
}

TEST(PartAssembler, RefusesAPartThatDisagreesAboutTheScan) {
  PartAssembler<lidar_scan_t> assembler;
  assembler.Add(Part(7, 0, 2));
  auto other = Part(7, 1, 2);
  other.elevation_rad[0] = 0.1F;
  EXPECT_TRUE(assembler.Add(other).whole.empty());
  EXPECT_TRUE(assembler.Add(Part(7, 1, 3)).whole.empty());
  EXPECT_EQ(assembler.counts().inconsistent_parts, 2);
  ExpectWhole(assembler.Add(Part(7, 1, 2)).whole, 2);
}

TEST(PartAssembler, LooksAtAllThatPartsShare) {
  using Change = void (*)(lidar_scan_t&);
  const auto changes =
      std::to_array<Change>({[](lidar_scan_t& part) { ++part.end_utime_us; }, [](lidar_scan_t& part) { ++part.raw_seq; },
                             [](lidar_scan_t& part) { part.flags = lidar_scan_t::FLAG_HOLE; }, [](lidar_scan_t& part) { ++part.num_parts; },
                             [](lidar_scan_t& part) { part.range_unit_m = 0.004; },
                             [](lidar_scan_t& part) {
                               part.elevation_rad = {0.0F, 0.1F};
                             },
                             [](lidar_scan_t& part) { part.azimuth_offset_rad = {0.1F}; }, [](lidar_scan_t& part) { part.time_offset_ns = {1}; },
                             [](lidar_scan_t& part) { part.origin_height_m = {0.1F}; }, [](lidar_scan_t& part) { part.num_returns = 2; },
                             [](lidar_scan_t& part) { ++part.num_turn_columns; }});
  for (std::size_t i = 0; i < changes.size(); ++i) {
    PartAssembler<lidar_scan_t> assembler;
    assembler.Add(Part(7, 0, 2));
    auto other = Part(7, 1, 2);
    changes[i](other);
    EXPECT_TRUE(assembler.Add(other).whole.empty()) << "case " << i;
    EXPECT_EQ(assembler.counts().inconsistent_parts, 1) << "case " << i;
  }
}

// What a process keeps of a message has no more than its place.
TEST(PartAssembler, JoinsAnythingThatHasAPlace) {
  struct Kept {
    std::int64_t utime_us, seq;
    std::int32_t part_index, num_parts;
    int value;
  };
  PartAssembler<Kept> assembler;
  EXPECT_TRUE(assembler.Add({1, 2, 1, 2, 30}).whole.empty());
  const auto whole = assembler.Add({1, 2, 0, 2, 40}).whole;
  ASSERT_EQ(whole.size(), 2U);
  EXPECT_EQ(whole[0].value, 40);
}

}  // namespace
}  // namespace lookout::messages
