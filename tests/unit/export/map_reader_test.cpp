// What logs say of each scan, for the boat's own map: TRACKS with what could have been seen.
#include "tools/export/map_reader.hpp"

#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "lookout/run_info_t.hpp"
#include "tests/support/files.hpp"
#include "tests/unit/export/map_tracks.hpp"
#include "tests/unit/tracker_shell/messages.hpp"

namespace lookout::exporter::map_reader {
namespace {

namespace shell = tracker::test;

constexpr std::int64_t kSecondUs = 1'000'000;
constexpr std::int64_t kDayUs = 86'400 * kSecondUs;
const Datum kDatum{43.7, -72.3, 100.0};

struct Days {
  MapMerge merge;
  MapReader reader{merge};

  template <typename Message>
  Taken Take(const bus::Channel& channel, const Message& message) {
    return reader.Take(channel.name, bus::Encode(message));
  }
  void TakeBoat() {
    run_info_t info{};
    info.program = "recorder";
    for (const auto* file : {"boat.txtpb", "segmenter.txtpb"}) {
      info.file_name.emplace_back(file);
      info.file_text.push_back(support::ReadFile(support::kDemoConfig / file));
    }
    info.num_files = 2;
    EXPECT_EQ(Take(bus::kRunInfo, info), Taken::kOk);
  }
  // A scan of a process that began with the day. The thing stands 10 m to the north.
  void TakeScan(int day, int second, bool has_thing, std::int32_t sight = tracks_t::SIGHT_KNOWN) {
    const auto offset_us = day * kDayUs + second * kSecondUs;
    tracks_t tracks{};
    tracks.utime_us = shell::kStartUs + offset_us;
    tracks.end_utime_us = tracks.utime_us + shell::kLastShotUs;
    tracks.seq = 10 * second;
    tracks.num_parts = 1;
    tracks.begin_utime_us = shell::kStartUs + day * kDayUs;
    tracks.sight = sight;
    tracks.datum_latitude_deg = kDatum.latitude_deg;
    tracks.datum_longitude_deg = kDatum.longitude_deg;
    tracks.datum_ellipsoid_height_m = kDatum.ellipsoid_height_m;
    if (has_thing) {
      const Utime seen{std::chrono::microseconds(tracks.end_utime_us)};
      tracks.tracks.push_back(test::StandingTrack(1, kDatum, {0.0, 10.0}, seen - std::chrono::seconds(30), seen));
    }
    tracks.num_tracks = tracks.num_scan_tracks = static_cast<std::int32_t>(tracks.tracks.size());
    EXPECT_EQ(Take(bus::kTracks, tracks), Taken::kOk);
  }
  void TakeBeams(int day, int second) {
    const auto offset_us = day * kDayUs + second * kSecondUs;
    EXPECT_EQ(Take(bus::kLidarScan, shell::MakeSweep(offset_us, 10 * second)), Taken::kOk);
    for (auto pose_us = offset_us; pose_us <= offset_us + shell::kScanUs; pose_us += 20'000) {
      EXPECT_EQ(Take(bus::kPose, shell::MakePose(pose_us, pose_us / 20'000)), Taken::kOk);
    }
  }
  OwnMap Map() {
    reader.Finish();
    return merge.Merged();
  }
};

TEST(MapReader, FindsGoneWhatStoodTheDayBefore) {
  Days days;
  days.TakeBoat();
  days.TakeScan(0, 0, true);
  for (int second = 0; second < 25; ++second) {
    days.TakeScan(1, second, false);  // it waits for its beams
    days.TakeBeams(1, second);
  }
  const auto map = days.Map();
  EXPECT_EQ(days.reader.num_looks(), 25);
  ASSERT_EQ(map.things.size(), 1U);
  EXPECT_EQ(map.things[0].days.size(), 1U);
  ASSERT_TRUE(map.things[0].gone);
  EXPECT_EQ(ToUtimeUs(*map.things[0].gone), shell::kStartUs + kDayUs + 19 * kSecondUs + shell::kLastShotUs) << "after twenty looks";
}

TEST(MapReader, FindsNothingGoneWithoutBeamsPosesTheBoatOrSight) {
  for (int lack = 0; lack < 4; ++lack) {
    Days days;
    if (lack != 0) days.TakeBoat();
    days.TakeScan(0, 0, true);
    for (int second = 0; second < 100; ++second) {
      days.TakeScan(1, second, false, lack == 1 ? std::int32_t{tracks_t::SIGHT_UNKNOWN} : std::int32_t{tracks_t::SIGHT_KNOWN});
      if (lack == 2) days.Take(bus::kLidarScan, shell::MakeSweep(kDayUs + second * kSecondUs, 10 * second));
      if (lack < 2) days.TakeBeams(1, second);
    }
    const auto map = days.Map();
    EXPECT_EQ(days.reader.num_looks(), 0) << lack;
    ASSERT_EQ(map.things.size(), 1U) << lack;
    EXPECT_EQ(map.things[0].gone, std::nullopt) << lack;
  }
}

TEST(MapReader, TakesAScanOnce) {
  Days days;
  for (int copy = 0; copy < 2; ++copy) {
    for (int second = 0; second < 5; ++second) days.TakeScan(0, second, true);
  }
  // A process that is over may come again, too.
  days.TakeScan(1, 0, true);
  days.TakeScan(0, 3, true);
  const auto map = days.Map();
  ASSERT_EQ(map.things.size(), 1U);
  ASSERT_EQ(map.things[0].days.size(), 2U);
  EXPECT_EQ(map.things[0].days[0].num_scans, 5);
  EXPECT_EQ(map.things[0].days[1].num_scans, 1);
}

TEST(MapReader, SaysWhatIsNoMessage) {
  Days days;
  const std::vector<std::uint8_t> nothing(7);
  for (const auto& channel : {bus::kTracks, bus::kLidarScan, bus::kPose, bus::kRunInfo}) {
    EXPECT_EQ(days.reader.Take(channel.name, nothing), Taken::kUndecodable) << channel.name;
  }
  auto scan = shell::MakeSweep(0, 1);
  scan.num_parts = 0;
  EXPECT_EQ(days.Take(bus::kLidarScan, scan), Taken::kInconsistent);
  run_info_t info{};
  info.num_files = 1;
  info.file_name = {"segmenter.txtpb"};
  info.file_text = {"max_range_m: many"};
  EXPECT_EQ(days.Take(bus::kRunInfo, info), Taken::kInconsistent);
}

}  // namespace
}  // namespace lookout::exporter::map_reader
