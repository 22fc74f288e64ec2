// Whole runs: simulated, out of captures, and message by message.
#include "tools/eval/track_run.hpp"

#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <optional>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "tests/support/files.hpp"
#include "tools/eval/baselines/nearest_neighbour.hpp"
#include "tools/eval/track_sources.hpp"
#include "tools/eval/track_tables.hpp"
#include "tools/replay/chain.hpp"
#include "tools/sim/scene_file.hpp"

namespace lookout::eval {
namespace {

MultiObjectTrackers Plain() {
  MultiObjectTrackers trackers;
  trackers.push_back(std::make_unique<NearestNeighbour>());
  return trackers;
}

constexpr double kSeconds = 3.0;

// The crossing scene, tracked by the plain tracker; `also` sees every message before it.
class Crossing {
 public:
  using Also = std::function<void(TrackRun&, std::string_view channel, Bytes bytes)>;

  explicit Crossing(const Also& also = {}) {
    replay::Chain chain(support::kCatabotConfig, {}, [&](Utime, std::string_view channel, Bytes bytes) {
      EXPECT_TRUE(run->Add(channel, bytes));
      if (also) also(*run, channel, bytes);
    });
    const auto file = sim::FindScene("crossing", support::kCatabotConfig);
    SimulateRun(support::kCatabotConfig, file, 1, kSeconds, truth, [&](const replay::Datagram& datagram) {
      if (!run) run.emplace(truth, Plain(), TrackRun::Returns::kForgotten);
      chain.OnDatagram(datagram);
    });
    chain.Finish();
    run->Finish();
  }

  // Of one tracker.
  std::optional<TrackRun::Row> RowOf(const std::string& tracker) const {
    for (const auto& row : run->Rows()) {
      if (row.tracker == tracker) return row;
    }
    return std::nullopt;
  }

  Truth truth{1};
  std::optional<TrackRun> run;
};

TEST(TrackRun, ASimulatedRunIsScoredWithAllItsReturns) {
  const Crossing crossing;
  EXPECT_DOUBLE_EQ(crossing.run->JoinedShare(), 1.0);
  EXPECT_NEAR(static_cast<double>(crossing.run->num_scans()), 10.0 * kSeconds, 2.0);
  const auto row = crossing.RowOf("nearest neighbour");
  ASSERT_TRUE(row);
  EXPECT_GT(row->scores.num_expected, 50);
  EXPECT_GT(row->scores.Mota(), 0.7);
  EXPECT_LT(row->scores.Mota(), 1.0);  // it needs three scans for each thing
  EXPECT_GT(row->labels.segments.value(), 0.8);
  EXPECT_LE(row->labels.tracks_land_one.value(), row->labels.segments_land_one.value() + 1e-9);
}

TEST(TrackRun, IsTheSameEachTime) {
  const auto first = Crossing().RowOf("nearest neighbour");
  const auto second = Crossing().RowOf("nearest neighbour");
  EXPECT_EQ(first->scores.Mota(), second->scores.Mota());
  EXPECT_EQ(first->scores.gospa.Rms(), second->scores.gospa.Rms());
  EXPECT_EQ(first->labels.tracks_land_one.sum, second->labels.tracks_land_one.sum);
}

// TRACKS that say of each obstacle that it is a track of its own, in two parts: what the boat's tracker says is scored in a row of its own.
TEST(TrackRun, TracksOfTheBusAreScoredBesideTheOthers) {
  const Crossing crossing([](TrackRun& run, std::string_view channel, Bytes bytes) {
    if (channel != bus::kObstacles.name) return;
    const auto obstacles = bus::Decode<obstacles_t>(bytes);
    ASSERT_TRUE(obstacles);
    ASSERT_EQ(obstacles->num_parts, 1);
    for (const int part_index : {0, 1}) {
      tracks_t message{};
      message.utime_us = obstacles->utime_us;
      message.part_index = part_index;
      message.num_parts = 2;
      for (const auto& obstacle : obstacles->obstacles) {
        if (obstacle.id % 2 != part_index || obstacle.status != obstacle_t::STATUS_OK) continue;
        track_t track{};
        track.id = obstacle.id;
        track.status = track_t::STATUS_CONFIRMED;
        track.position_map_m[0] = obstacle.position_map_m[0];
        track.position_map_m[1] = obstacle.position_map_m[1];
        track.segment_ids = {obstacle.id};
        track.num_segments = 1;
        track.outline_east_m = obstacle.footprint_east_m;
        track.outline_north_m = obstacle.footprint_north_m;
        track.num_outline = obstacle.num_map;
        message.tracks.push_back(track);
      }
      message.num_tracks = static_cast<std::int32_t>(message.tracks.size());
      ASSERT_TRUE(run.Add(kTracksChannel, bus::Encode(message)));
    }
  });
  const auto row = crossing.RowOf("lookout");
  ASSERT_TRUE(row);
  EXPECT_LT(row->scores.num_missed, row->scores.num_expected / 20);  // two things in one segment
  // Every segment is a track: the labels are the same but for their names.
  EXPECT_DOUBLE_EQ(row->labels.tracks_land_one.value(), row->labels.segments_land_one.value());
  ASSERT_TRUE(crossing.RowOf("nearest neighbour"));
}

TEST(TrackRun, WhatCannotBeDecodedIsRefused) {
  Truth truth(1);
  truth.AddObject(0, {});
  TrackRun run(truth, Plain(), TrackRun::Returns::kForgotten);
  const std::vector<std::uint8_t> bytes(50, 7);
  for (const std::string_view channel : {std::string_view("OBSTACLES"), kTracksChannel}) EXPECT_FALSE(run.Add(channel, bytes)) << channel;
  EXPECT_TRUE(run.Add("GNSS_FIX", bytes));  // none of its channels
}

TEST(TrackRun, ACaptureIsScoredWithAllItsReturns) {
  const auto folder = support::kRecordings / "second_world";
  if (!std::filesystem::exists(folder / "sparse-11.pcap.xz")) GTEST_SKIP() << folder << " is not here";
  const auto captures = ListCaptures(folder);
  const auto files = std::ranges::find_if(captures, [](const auto& one) { return one.scene == "sparse"; });
  const ConfigOfCaptures config(folder, support::kCatabotConfig);
  const auto boat = config::LoadBoat(config.path());
  Truth truth(kCaptureToleranceUs);
  std::optional<TrackRun> run;
  replay::Chain chain(config.path(), {}, [&](Utime, std::string_view channel, Bytes bytes) { EXPECT_TRUE(run->Add(channel, bytes)); });
  ReadRun(*files, boat, truth, [&](const replay::Datagram& datagram) {
    if (!run) run.emplace(truth, Plain(), TrackRun::Returns::kForgotten);
    chain.OnDatagram(datagram);
  });
  chain.Finish();
  run->Finish();
  EXPECT_GT(run->JoinedShare(), 0.999);
  const auto row = run->Rows().front();
  EXPECT_GT(row.scores.Mota(), 0.5);
  EXPECT_GT(row.labels.segments.value(), 0.8);
}

TEST(TrackTables, RowsOfOneSceneAddUpAndAllStandLast) {
  TrackScores scores;
  scores.num_runs = 1;
  scores.seconds = 30.0;
  scores.num_expected = 10;
  const std::vector<TrackRow> runs{{"a", {"t", scores, {}}}, {"a", {"t", scores, {}}}, {"b", {"t", scores, {}}}};
  const auto rows = AddUp(runs);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].row.scores.num_expected, 20);
  const auto all = OverAll(rows, "all");
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].row.scores.num_runs, 3);
  const auto tables = TablesOf(rows);
  ASSERT_EQ(tables.size(), 4U);
  EXPECT_EQ(tables[0].table.rows().size(), 3U);
  EXPECT_TRUE(tables[3].table.empty());  // no scan had labels
}

}  // namespace
}  // namespace lookout::eval
