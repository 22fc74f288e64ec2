// A second lidar: its segments go out with the scan of the first during which they were seen, by its own mounting.
#include <chrono>
#include <gtest/gtest.h>
#include <vector>

#include "services/georeferencer/core/georeferencer.hpp"
#include "tests/support/counters.hpp"
#include "tests/unit/georeferencer/messages.hpp"

namespace lookout::georeferencer {
namespace {

using test::At;
using test::MakePart;
using test::MakePoint;
using test::MakePose;

constexpr std::int64_t kScanUs = 100'000;
constexpr std::int64_t kApartUs = 30'000;  // the second begins its scans so much later

// The second stands 5 m aft and looks aft.
Georeferencer MakeTwo() {
  Eigen::Isometry3d T_vessel_lidar_2 = Eigen::Isometry3d::Identity();
  T_vessel_lidar_2.linear() = Eigen::Vector3d(-1.0, -1.0, 1.0).asDiagonal();
  T_vessel_lidar_2.translation() = Eigen::Vector3d(-5.0, 0.0, 0.0);
  return {PlacementParams{}, std::chrono::milliseconds(500), T_vessel_lidar_2};
}

SegmentPart FirstScan(int number) { return MakePart(kScanUs * number, number, {MakePoint(kScanUs * number + 10'000, 10.0, 0.0, 0.0)}); }
// One thing is seen early in it, one late.
SegmentPart SecondScan(int number) {
  const auto begin_us = kScanUs * number + kApartUs;
  auto late = MakePoint(begin_us + 90'000, 30.0, 0.0, 0.0);
  late.id = 2;
  return MakePart(begin_us, 100 + number, {MakePoint(begin_us + 10'000, 20.0, 0.0, 0.0), late});
}

struct Feed {
  bool has_second = true;
  int first_without_second = 1000;  // from this scan on it is silent
};

// All of 40 scans, in the order of their ends; what went out. `ahead_us`: POSE comes so much later than it is measured.
std::vector<ObstaclePart> FeedBoth(Georeferencer& georeferencer, const Feed& feed, std::int64_t pose_delay_us = 0, std::int64_t second_delay_us = 0) {
  std::vector<ObstaclePart> all;
  const auto keep = [&all](std::vector<ObstaclePart> parts) {
    for (auto& part : parts) all.push_back(std::move(part));
  };
  for (std::int64_t now_us = 0; now_us < 41 * kScanUs + 1'500'000; now_us += 10'000) {
    const auto first = now_us / kScanUs - 1;
    if (now_us % kScanUs == 0 && first >= 0 && first < 40) keep(georeferencer.AddSegments(FirstScan(static_cast<int>(first))));
    const auto second_us = now_us - kApartUs - second_delay_us;
    const auto second = second_us / kScanUs - 1;
    if (feed.has_second && second_us % kScanUs == 0 && second >= 0 && second < feed.first_without_second && second < 40) {
      keep(georeferencer.AddSecond(SecondScan(static_cast<int>(second))));
    }
    if (now_us >= pose_delay_us && now_us % 20'000 == 0) keep(georeferencer.AddPose(MakePose(now_us - pose_delay_us)));
  }
  return all;
}

std::vector<ObstaclePart> OfScan(const std::vector<ObstaclePart>& all, int number) {
  std::vector<ObstaclePart> parts;
  for (const auto& part : all) {
    if (part.head.seq == number) parts.push_back(part);
  }
  return parts;
}

TEST(SecondLidar, AddsWhatItSawDuringAScanToThatScan) {
  auto georeferencer = MakeTwo();
  const auto all = FeedBoth(georeferencer, {});
  const auto parts = OfScan(all, 20);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].head.num_parts, 2);
  EXPECT_EQ(parts[1].head.num_parts, 2);
  EXPECT_EQ(parts[1].head.part_index, 1);
  EXPECT_EQ(parts[1].head.time, parts[0].head.time);
  EXPECT_EQ(parts[1].head.num_scan_segments, 3);
  ASSERT_EQ(parts[1].obstacles.size(), 2U);
  // Seen late by the scan before (20 ms into this one), and early by the one that began during it.
  EXPECT_EQ(parts[1].obstacles[0].time, At(20 * kScanUs + 20'000));
  EXPECT_EQ(parts[1].obstacles[1].time, At(20 * kScanUs + 40'000));
  EXPECT_EQ(parts[1].obstacles[0].id, Georeferencer::kSecondLidarId + 1);
  EXPECT_EQ(parts[1].obstacles[1].id, Georeferencer::kSecondLidarId + 2);
  EXPECT_EQ(parts[1].obstacles[1].status, ObstacleStatus::kOk);
  // 5 m aft of the vessel's origin, and 20 m aft of there.
  EXPECT_NEAR(parts[1].obstacles[1].center_vessel_m.x(), -25.0, 1e-9);
  EXPECT_NEAR(parts[0].obstacles[0].center_vessel_m.x(), 10.0, 1e-9);
  // Each of its segments goes out once, but for those before it counts and behind the last scan.
  std::size_t num_of_second = 0;
  for (const auto& part : all) {
    for (const auto& obstacle : part.obstacles) num_of_second += obstacle.id > Georeferencer::kSecondLidarId ? 1 : 0;
  }
  EXPECT_EQ(num_of_second, static_cast<std::size_t>(support::CountOf(georeferencer, "obstacles_of_second")));
  EXPECT_GE(num_of_second, 2U * 28U);
}

TEST(SecondLidar, ChangesNothingWhereItIsSilent) {
  auto georeferencer = MakeTwo();
  Georeferencer alone(PlacementParams{}, std::chrono::milliseconds(500));
  const auto with = FeedBoth(georeferencer, {.has_second = false});
  const auto without = FeedBoth(alone, {.has_second = false});
  ASSERT_EQ(with.size(), without.size());
  for (std::size_t i = 0; i < with.size(); ++i) {
    EXPECT_EQ(with[i].head.num_parts, without[i].head.num_parts);
    EXPECT_EQ(without[i].head.scan_flags, 0) << "with one lidar nobody expects a second";
  }
}

// Live or replayed, fast POSE or slow: the same scans have the same obstacles.
TEST(SecondLidar, GivesTheSameHoweverTheChannelsInterleave) {
  for (const int first_without_second : {1000, 25}) {
    const Feed feed{.has_second = true, .first_without_second = first_without_second};
    auto one = MakeTwo();
    const auto expected = FeedBoth(one, feed);
    for (const auto& [pose_delay_us, second_delay_us] : {std::pair<std::int64_t, std::int64_t>{200'000, 0}, {0, 200'000}, {400'000, 100'000}}) {
      auto other = MakeTwo();
      const auto all = FeedBoth(other, feed, pose_delay_us, second_delay_us);
      ASSERT_EQ(all.size(), expected.size()) << pose_delay_us << " " << second_delay_us << " " << first_without_second;
      for (std::size_t i = 0; i < all.size(); ++i) {
        EXPECT_EQ(all[i].head.seq, expected[i].head.seq);
        EXPECT_EQ(all[i].head.scan_flags, expected[i].head.scan_flags) << i;
        ASSERT_EQ(all[i].obstacles.size(), expected[i].obstacles.size()) << i;
        for (std::size_t k = 0; k < all[i].obstacles.size(); ++k) {
          EXPECT_EQ(all[i].obstacles[k].id, expected[i].obstacles[k].id);
          EXPECT_EQ(all[i].obstacles[k].time, expected[i].obstacles[k].time);
          EXPECT_EQ(all[i].obstacles[k].position_map_m, expected[i].obstacles[k].position_map_m);
        }
      }
    }
  }
}

constexpr auto kHoleFlag = static_cast<std::int32_t>(SecondSight::kHole);
constexpr auto kSilentFlag = static_cast<std::int32_t>(SecondSight::kSilent);

// Both run; what the second sends, by the number of its scan, is changed by the caller. The flags of each scan of the first, by its number.
template <typename Change>
std::vector<std::int32_t> FlagsWith(const Change& change, int num_scans = 80) {
  auto georeferencer = MakeTwo();
  std::vector<std::int32_t> flags(static_cast<std::size_t>(num_scans), -1);
  const auto keep = [&flags](const std::vector<ObstaclePart>& parts) {
    for (const auto& part : parts) {
      auto& known = flags.at(static_cast<std::size_t>(part.head.seq));
      EXPECT_TRUE(known < 0 || known == part.head.scan_flags) << "the parts of scan " << part.head.seq << " differ";
      known = part.head.scan_flags;
    }
  };
  for (int number = 0; number < num_scans; ++number) {
    keep(georeferencer.AddSegments(FirstScan(number)));
    if (auto part = SecondScan(number); change(number, part)) keep(georeferencer.AddSecond(part));
    for (std::int64_t at_us = kScanUs * number; at_us < kScanUs * (number + 1); at_us += 20'000) keep(georeferencer.AddPose(MakePose(at_us)));
  }
  for (int number = num_scans; number < num_scans + 10; ++number) {
    for (std::int64_t at_us = kScanUs * number; at_us < kScanUs * (number + 1); at_us += 20'000) keep(georeferencer.AddPose(MakePose(at_us)));
  }
  return flags;
}

TEST(SecondLidar, ThatLooksLeavesScansWhole) {
  const auto flags = FlagsWith([](int, SegmentPart&) { return true; });
  for (std::size_t i = 0; i + 2 < flags.size(); ++i) EXPECT_EQ(flags[i], 0) << i;
}

TEST(SecondLidar, ThatDiesIsSaidToBeSilentUntilItLooksAgain) {
  const auto flags = FlagsWith([](int number, SegmentPart&) { return number < 40 || number >= 60; });
  for (std::size_t i = 0; i < 39; ++i) EXPECT_EQ(flags[i], 0) << i;
  for (std::size_t i = 41; i < 47; ++i) EXPECT_EQ(flags[i], kHoleFlag) << i << ": it may be late";
  for (std::size_t i = 49; i < 68; ++i) EXPECT_EQ(flags[i], kSilentFlag) << i;
  for (std::size_t i = 72; i < 78; ++i) EXPECT_EQ(flags[i], 0) << i;
}

// The lidar is unplugged before the boat leaves.
TEST(SecondLidar, ThatNeverSpeaksIsExpectedAfterThreeSeconds) {
  const auto flags = FlagsWith([](int, SegmentPart&) { return false; });
  for (std::size_t i = 0; i < flags.size(); ++i) EXPECT_EQ(flags[i], i < 30 ? 0 : kSilentFlag) << i;
}

TEST(SecondLidar, WhoseScanHasAHoleMakesScansThatAreNotWhole) {
  // Seen from 5.03 to 5.129 s.
  const auto holed = FlagsWith([](int number, SegmentPart& part) {
    part.head.scan_flags = number == 50 ? 4 : 0;
    return true;
  });
  for (std::size_t i = 40; i < 60; ++i) EXPECT_EQ(holed[i], i == 50 || i == 51 ? kHoleFlag : 0) << i;
  // A scan that did not come is known by the next, which counts as holed, too.
  const auto lost = FlagsWith([](int number, SegmentPart&) { return number != 50; });
  for (std::size_t i = 40; i < 60; ++i) EXPECT_EQ(lost[i], i >= 50 && i <= 52 ? kHoleFlag : 0) << i;
}

// Its lasers fail, its packets go on.
TEST(SecondLidar, ThatSeesNothingAnyMoreIsNoLookOut) {
  const auto flags = FlagsWith([](int number, SegmentPart& part) {
    part.num_returns = number >= 40 && number < 60 ? 0 : 400;
    return true;
  });
  for (std::size_t i = 0; i < 40; ++i) EXPECT_EQ(flags[i], 0) << i;
  for (std::size_t i = 42; i < 48; ++i) EXPECT_EQ(flags[i], kHoleFlag) << i;
  for (std::size_t i = 50; i < 62; ++i) EXPECT_EQ(flags[i], kSilentFlag) << i;
  for (std::size_t i = 66; i < 78; ++i) EXPECT_EQ(flags[i], 0) << i;
  // Flat water from the start looks the same.
  const auto flat = FlagsWith([](int, SegmentPart& part) {
    part.num_returns = 0;
    return true;
  });
  for (std::size_t i = 0; i < 78; ++i) EXPECT_EQ(flat[i], 0) << i;
}

TEST(SecondLidar, WithAHoleInMostScansIsNoLookOut) {
  const auto flags = FlagsWith([](int number, SegmentPart& part) {
    part.head.scan_flags = number >= 40 && number % 5 != 0 ? 4 : 0;
    return true;
  });
  for (std::size_t i = 52; i < 78; ++i) EXPECT_EQ(flags[i], kSilentFlag) << i;
}

// Of a scan in two parts one is lost.
void LosePart(int lost_part, std::int64_t num_with_hole) {
  auto georeferencer = MakeTwo();
  std::vector<std::int32_t> flags(60);
  for (int number = 0; number < 60; ++number) {
    georeferencer.AddSegments(FirstScan(number));
    for (int i = 0; i < 2; ++i) {
      if (number == 50 && i == lost_part) continue;
      auto part = SecondScan(number);
      part.head.part_index = i;
      part.head.num_parts = 2;
      georeferencer.AddSecond(part);
    }
    for (std::int64_t at_us = kScanUs * number; at_us < kScanUs * (number + 1); at_us += 20'000) {
      for (const auto& part : georeferencer.AddPose(MakePose(at_us))) flags[static_cast<std::size_t>(part.head.seq)] = part.head.scan_flags;
    }
  }
  EXPECT_EQ(flags[49], 0);
  EXPECT_EQ(flags[50], kHoleFlag);
  EXPECT_EQ(flags[51], kHoleFlag);
  EXPECT_EQ(flags[53], 0);
  EXPECT_EQ(support::CountOf(georeferencer, "scans_with_hole_of_second"), num_with_hole);
  EXPECT_EQ(support::CountOf(georeferencer, "scans_without_second"), 0);
}

TEST(SecondLidar, WithoutItsFirstPartHasAHole) { LosePart(0, 2); }
// Known by the next scan, which counts as holed, too.
TEST(SecondLidar, WithoutItsLastPartHasAHole) { LosePart(1, 3); }

// One that dies costs half a second for two seconds, and then nothing.
TEST(SecondLidar, ThatDiesHoldsNothingUp) {
  auto georeferencer = MakeTwo();
  std::vector<ObstaclePart> all;
  for (int number = 0; number < 20; ++number) {
    georeferencer.AddSegments(FirstScan(number));
    georeferencer.AddSecond(SecondScan(number));
    for (std::int64_t at_us = kScanUs * number; at_us < kScanUs * (number + 1); at_us += 20'000) georeferencer.AddPose(MakePose(at_us));
  }
  std::int64_t released_at_us = 0;
  for (std::int64_t now_us = 20 * kScanUs; now_us < 60 * kScanUs; now_us += 20'000) {
    if (now_us % kScanUs == 0) georeferencer.AddSegments(FirstScan(static_cast<int>(now_us / kScanUs) - 1 + 1));
    const auto released = georeferencer.AddPose(MakePose(now_us));
    for (const auto& part : released) {
      released_at_us = now_us;
      const auto delay = At(now_us) - part.head.end_time;
      EXPECT_LE(delay, std::chrono::milliseconds(540));
      if (part.head.seq > 45) {
        EXPECT_LE(delay, std::chrono::milliseconds(40)) << part.head.seq;
      }
    }
  }
  EXPECT_GE(released_at_us, 59 * kScanUs);
}

TEST(SecondLidar, OfManySegmentsAddsSeveralPartsWithRisingNumbers) {
  auto georeferencer = MakeTwo();
  for (int number = 0; number < 30; ++number) {
    std::vector<Segment> segments;
    for (int i = 0; i < 50; ++i) {
      segments.push_back(MakePoint(kScanUs * number + 10'000 + 100 * i, 10.0, 1.0 * i, 0.0));
      segments.back().id = i + 1;
    }
    georeferencer.AddSecond(MakePart(kScanUs * number, number, segments));
    georeferencer.AddSegments(FirstScan(number));
  }
  std::vector<ObstaclePart> all;
  for (std::int64_t at_us = 0; at_us < 31 * kScanUs; at_us += 20'000) {
    for (auto& part : georeferencer.AddPose(MakePose(at_us))) all.push_back(std::move(part));
  }
  const auto parts = OfScan(all, 25);
  ASSERT_EQ(parts.size(), 4U) << "18, 18 and 14 of the second";
  std::int32_t last_id = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    EXPECT_EQ(parts[i].head.part_index, static_cast<std::int32_t>(i));
    EXPECT_EQ(parts[i].head.num_parts, 4);
    for (const auto& obstacle : parts[i].obstacles) {
      EXPECT_GT(obstacle.id, last_id);
      last_id = obstacle.id;
    }
  }
}

// The first fires into half the circle: what the second sees while it is dark goes out with the next scan, where it was when it was seen.
TEST(SecondLidar, IsHeardWhileTheFirstIsDark) {
  auto georeferencer = MakeTwo();
  constexpr double kSpeedMps = 10.0;  // of the boat, to the north
  std::vector<ObstaclePart> all;
  for (int number = 0; number < 30; ++number) {
    auto first = FirstScan(number);
    first.head.end_time = At(kScanUs * number + 50'000);
    georeferencer.AddSegments(first);
    georeferencer.AddSecond(MakePart(kScanUs * number, 100 + number, {MakePoint(kScanUs * number + 70'000, 20.0, 0.0, 0.0)}));
    for (std::int64_t at_us = kScanUs * number; at_us < kScanUs * (number + 1); at_us += 20'000) {
      auto pose = MakePose(at_us);
      pose.position_map_m = {0.0, kSpeedMps * 1e-6 * static_cast<double>(at_us), 0.0};
      for (auto& part : georeferencer.AddPose(pose)) all.push_back(std::move(part));
    }
  }
  for (int number = 15; number < 28; ++number) {
    const auto parts = OfScan(all, number);
    ASSERT_EQ(parts.size(), 2U) << number;
    ASSERT_EQ(parts[1].obstacles.size(), 1U);
    const auto& obstacle = parts[1].obstacles[0];
    EXPECT_EQ(obstacle.time, At(kScanUs * number)) << "on the wire within the scan";
    const double seen_s = 1e-6 * static_cast<double>(kScanUs * (number - 1) + 70'000);
    EXPECT_NEAR(obstacle.position_map_m.y(), kSpeedMps * seen_s - 25.0, 1e-6);
  }
  EXPECT_EQ(georeferencer.num_untimely(), 0);
}

// A scan of the second in two parts has come with the second of them. One whose last part is lost is covered by the next.
TEST(SecondLidar, CountsEveryPartOfAScan) {
  for (const bool has_last_part : {true, false}) {
    auto georeferencer = MakeTwo();
    std::vector<ObstaclePart> all;
    const auto keep = [&all](std::vector<ObstaclePart> parts) {
      for (auto& part : parts) all.push_back(std::move(part));
    };
    for (int number = 0; number < 30; ++number) {
      keep(georeferencer.AddSegments(FirstScan(number)));
      const auto begin_us = kScanUs * number + kApartUs;
      auto part = MakePart(begin_us, 100 + number, {MakePoint(begin_us + 10'000, 20.0, 0.0, 0.0)});
      part.head.num_parts = 2;
      auto last_part = part;
      last_part.head.part_index = 1;
      last_part.segments = {MakePoint(begin_us + 60'000, 30.0, 0.0, 0.0)};
      keep(georeferencer.AddSecond(part));
      // POSE is ahead before the last part comes.
      const auto end_us = kScanUs * (number + 1) + kApartUs + 40'000;
      for (std::int64_t at_us = end_us - kScanUs; at_us < end_us; at_us += 20'000) keep(georeferencer.AddPose(MakePose(at_us / 20'000 * 20'000)));
      if (has_last_part || number != 20) keep(georeferencer.AddSecond(last_part));
    }
    // Of 16 scans two each; of one the last part is lost.
    std::size_t num_seen = 0;
    for (int number = 12; number < 28; ++number) {
      for (const auto& part : OfScan(all, number)) {
        if (part.head.part_index > 0) num_seen += part.obstacles.size();
      }
    }
    EXPECT_EQ(num_seen, has_last_part ? 32U : 31U);
    EXPECT_EQ(georeferencer.num_untimely(), 0);
  }
}

// Its clock is behind that of the first, a little or much: all that it sees is dropped, and counted as such.
TEST(SecondLidar, WhoseTimesDoNotFitIsCounted) {
  for (const std::int64_t behind_us : {0, 1'000'000, 5'000'000}) {
    auto georeferencer = MakeTwo();
    for (int number = 0; number < 100; ++number) {
      georeferencer.AddSegments(FirstScan(number));
      if (kScanUs * number >= behind_us) georeferencer.AddSecond(SecondScan(number - static_cast<int>(behind_us / kScanUs)));
      for (std::int64_t at_us = kScanUs * number; at_us < kScanUs * (number + 1); at_us += 20'000) georeferencer.AddPose(MakePose(at_us));
    }
    EXPECT_EQ(georeferencer.num_untimely() > 20, behind_us > 0) << behind_us << " " << georeferencer.num_untimely();
    if (behind_us == 0) {
      EXPECT_EQ(georeferencer.num_untimely(), 0);
    }
  }
}

}  // namespace
}  // namespace lookout::georeferencer
