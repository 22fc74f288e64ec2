// Whole runs: simulated, out of captures, and message by message.
#include "lab/eval/tracks/track_run.hpp"

#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <map>
#include <optional>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "lab/eval/baselines/nearest_neighbour.hpp"
#include "lab/eval/tracks/ablation.hpp"
#include "lab/eval/tracks/track_sources.hpp"
#include "lab/eval/tracks/track_tables.hpp"
#include "lab/eval/tracks/track_targets.hpp"
#include "lab/sim/scene_file.hpp"
#include "services/tracker/params.hpp"
#include "tests/support/files.hpp"
#include "tools/replay/chain.hpp"

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
  EXPECT_LE(row->labels.by_tracks.iou.value(), row->labels.single.iou.value() + 1e-9);
}

TEST(TrackRun, IsTheSameEachTime) {
  const auto first = Crossing().RowOf("nearest neighbour");
  const auto second = Crossing().RowOf("nearest neighbour");
  EXPECT_EQ(first->scores.Mota(), second->scores.Mota());
  EXPECT_EQ(first->scores.gospa.Rms(), second->scores.gospa.Rms());
  EXPECT_EQ(first->labels.by_tracks.iou.sum, second->labels.by_tracks.iou.sum);
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
  EXPECT_DOUBLE_EQ(row->labels.by_tracks.iou.value(), row->labels.single.iou.value());
  ASSERT_TRUE(crossing.RowOf("nearest neighbour"));
}

// TRACKS without tracks that say of each piece of SEGMENTS, in two slices, what `say` says of its segment.
TrackRun::Row RowOfPieces(const std::function<std::int64_t(std::int16_t segment)>& say) {
  std::map<std::int64_t, std::vector<std::int64_t>> said;  // by utime_us
  const Crossing crossing([&](TrackRun& run, std::string_view channel, Bytes bytes) {
    if (channel == bus::kSegments.name) {
      const auto segments = bus::Decode<segments_t>(bytes);
      auto& of_piece = said[segments->utime_us];
      std::size_t next = 0;
      for (const auto label : segments->label) {
        if (label <= 0) continue;
        const auto piece = static_cast<std::size_t>(segments->piece[next++]);
        if (of_piece.size() < piece) of_piece.resize(piece, tracks_t::PIECE_NO_TRACK);
        of_piece[piece - 1] = say(label);
      }
    }
    if (channel != bus::kObstacles.name) return;
    tracks_t message{};
    message.utime_us = bus::Decode<obstacles_t>(bytes)->utime_us;
    const auto of_piece = said[message.utime_us];
    const auto middle = of_piece.begin() + static_cast<std::ptrdiff_t>(of_piece.size() / 2);
    message.num_parts = 2;
    message.first_piece = 1;
    message.track_of_piece.assign(of_piece.begin(), middle);
    message.num_pieces = static_cast<std::int32_t>(message.track_of_piece.size());
    const auto second_piece = message.num_pieces + 1;
    ASSERT_TRUE(run.Add(kTracksChannel, bus::Encode(message)));
    message.part_index = 1;
    message.first_piece = second_piece;
    message.track_of_piece.assign(middle, of_piece.end());
    message.num_pieces = static_cast<std::int32_t>(message.track_of_piece.size());
    ASSERT_TRUE(run.Add(kTracksChannel, bus::Encode(message)));
  });
  const auto row = crossing.RowOf("lookout");
  EXPECT_TRUE(row);
  return row.value_or(TrackRun::Row{});
}

TEST(TrackRun, ReturnsAreLabelledByTheTrackOfTheirPiece) {
  const auto by_tracks = RowOfPieces([](std::int16_t segment) { return 1000 + segment; });
  const double of_segments = by_tracks.labels.single.iou.value();
  EXPECT_DOUBLE_EQ(by_tracks.labels.by_tracks.iou.value(), of_segments);
  // What is of no track, or of one that TRACKS do not have, keeps the label of its segment.
  for (const std::int64_t none : {tracks_t::PIECE_NO_TRACK, std::int64_t{-40}}) {
    EXPECT_DOUBLE_EQ(RowOfPieces([none](std::int16_t) { return none; }).labels.by_tracks.iou.value(), of_segments);
  }
  const auto as_one = RowOfPieces([](std::int16_t) { return std::int64_t{7}; });
  EXPECT_LT(as_one.labels.by_tracks.iou.value(), of_segments - 0.1);
  const auto as_land = RowOfPieces([](std::int16_t) { return tracks_t::PIECE_LAND; });
  EXPECT_DOUBLE_EQ(as_land.labels.by_tracks.iou.value(), as_one.labels.by_tracks.iou.value());
}

TEST(TrackRun, ATrackerOfWhichNothingIsLeftOutSaysWhatTheBoatsSays) {
  const auto params = tracker::LoadParams(support::kCatabotConfig);
  std::vector<std::vector<std::uint8_t>> own;
  std::vector<std::vector<std::uint8_t>> whole;
  std::vector<std::vector<std::uint8_t>> without_ledger;
  const auto into = [](auto& list) { return [&list](Bytes bytes) { list.emplace_back(bytes.begin(), bytes.end()); }; };
  AblatedTracker same(params, {}, into(whole));
  AblatedTracker other(params, {.ledger = true}, into(without_ledger));
  const Crossing crossing([&](TrackRun&, std::string_view channel, Bytes bytes) {
    same.Add(channel, bytes);
    other.Add(channel, bytes);
    if (channel == kTracksChannel) own.emplace_back(bytes.begin(), bytes.end());
  });
  same.Finish();
  ASSERT_FALSE(own.empty());
  EXPECT_EQ(whole, own);
  EXPECT_EQ(without_ledger.size(), own.size());
  EXPECT_NE(without_ledger, own);
}

TEST(TrackRun, EachVariantHasARowOfItsOwn) {
  Truth truth(1);
  truth.AddObject(0, {});
  TrackRun run(truth, Plain(), TrackRun::Returns::kForgotten, {}, {"a", "b"});
  tracks_t tracks{};
  tracks.num_parts = 1;
  EXPECT_TRUE(run.AddTracksOf("b", bus::Encode(tracks)));
  EXPECT_FALSE(run.AddTracksOf("c", bus::Encode(tracks))) << "nobody has said that there is one";
  EXPECT_FALSE(run.has_own_tracks());
  const auto rows = run.Rows();
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].tracker, "b");
}

TEST(TrackRun, WhereReturnsAreCountedNoLabelsAreScored) {
  Truth truth(1);
  std::optional<TrackRun> run;
  replay::Chain chain(support::kCatabotConfig, {}, [&](Utime, std::string_view channel, Bytes bytes) { EXPECT_TRUE(run->Add(channel, bytes)); });
  const auto file = sim::FindScene("crossing", support::kCatabotConfig);
  const auto count = [](const TruthSpan& scan) {
    EXPECT_NEAR(static_cast<double>(scan.end_us - scan.begin_us), 1e5, 1e4);
    return std::map<int, int>{{1, 7}};
  };
  SimulateRun(support::kCatabotConfig, file, 1, kSeconds, truth, [&](const replay::Datagram& datagram) {
    if (!run) run.emplace(truth, Plain(), TrackRun::Returns::kForgotten, ApproachLimits{}, std::vector<std::string>{}, count);
    chain.OnDatagram(datagram);
  });
  chain.Finish();
  run->Finish();
  const auto rows = run->Rows();
  EXPECT_NEAR(static_cast<double>(rows.front().scores.num_expected), 10.0 * kSeconds, 3.0) << "one thing in each scan has returns";
  EXPECT_EQ(rows.front().labels.segments.count, 0);
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
  ASSERT_EQ(tables.size(), 6U);
  EXPECT_EQ(tables[0].table.rows().size(), 3U);
  EXPECT_TRUE(tables.back().table.empty());  // no scan had labels
}

TEST(TrackTables, LabelsOfSingleScansHaveOneRowOfAScene) {
  TrackRow row{"a", {"t", {}, {}}};
  row.row.labels.segments.Add(0.7);
  row.row.labels.single.iou.Add(0.8);
  row.row.labels.single.land_too_many.Add(4.0);
  row.row.labels.by_tracks.iou.Add(0.9);
  auto other = row;
  other.row.tracker = "u";
  const auto table = TablesOf({row, other}).back().table;
  ASSERT_EQ(table.rows().size(), 4U);
  EXPECT_EQ(table.rows()[1], (Table::Row{"a", "single scans", "1", "70.0", "80.0", "-", "-", "4.0", "-", "-", "-", "-", "-", "-"}));
  EXPECT_EQ(table.rows()[2], (Table::Row{"a", "t", "1", "-", "90.0", "10.0", "-", "-", "-", "-", "-", "-", "-", "-"}));
  EXPECT_EQ(table.rows()[3][1], "u");
}

// A scene on which `tracker` found all but some of 1000 things, and the labels gain so much.
TrackRow RowWith(const std::string& scene, const std::string& tracker, std::int64_t num_missed, double gain) {
  TrackRow row{scene, {tracker, {}, {}}};
  row.row.scores.num_runs = 1;
  row.row.scores.seconds = 60.0;
  row.row.scores.num_expected = 1000;
  row.row.scores.num_missed = num_missed;
  row.row.labels.single.iou.Add(0.9);
  row.row.labels.by_tracks.iou.Add(0.9 + gain);
  return row;
}

// The cells behind "world" and "what" of a target.
Table::Row CellsOf(const Table& table, const std::string& what) {
  for (const auto& row : table.rows()) {
    if (row[1] == what) return {row.begin() + 2, row.end()};
  }
  return {};
}

TEST(TargetTable, SaysOfEachTargetWhetherItIsReachedAndWhereLeast) {
  const TrackWorld world{
      "w",
      {RowWith("lake", "a", 10, 0.01), RowWith("marina", "a", 30, -0.002), RowWith("waves", "a", 60, 0.02), RowWith("lake", "b", 500, 0.0)},
      "all"};
  const auto table = TargetTable({world}, "a", "b").table;
  EXPECT_EQ(CellsOf(table, "MOTA, %"), (Table::Row{">= 98.0", "98.0", "yes", "97.0 marina", "50.0"}));
  EXPECT_EQ(CellsOf(table, "MOTA in waves and rain, %"), (Table::Row{">= 96.0", "94.0", "MISSED", "94.0 waves", "-"}));
  EXPECT_EQ(CellsOf(table, "false tracks an hour, clear"), (Table::Row{"<= 6", "0", "yes", "0 lake", "0"}));
  // The mean of 1.0, -0.2 and 2.0 points, and the least.
  EXPECT_EQ(CellsOf(table, "labels by tracks: mIoU over single scans, points, mean"), (Table::Row{">= 2.5", "0.9", "MISSED", "-0.2 marina", "0.0"}));
  EXPECT_EQ(CellsOf(table, "labels by tracks: the same, least of a scene"), (Table::Row{">= 0.0", "-0.2", "MISSED", "-0.2 marina", "0.0"}));
  EXPECT_TRUE(CellsOf(table, "CPA 10 s before, mean, m").empty());  // no scene shows it
}

TEST(TargetTable, OfABandTheFarthestSceneIsByRatio) {
  const auto with_nees = [](const std::string& scene, double nees) {
    auto row = RowWith(scene, "a", 0, 0.0);
    row.row.scores.position_nees.Add(nees);
    return row;
  };
  const auto table = TargetTable({{"w", {with_nees("lake", 0.25), with_nees("marina", 2.75)}, "all"}}, "a", "b").table;
  EXPECT_EQ(CellsOf(table, "ANEES of position"), (Table::Row{"0.70 to 1.40", "1.50", "MISSED", "0.25 lake", "-"}));
}

TEST(TargetTable, BlackBuoysAreThoseOfTheirScene) {
  const auto with_buoys = [](const std::string& scene, double share) {
    auto row = RowWith(scene, "a", 0, 0.0);
    row.row.scores.near_buoy_tracked.Add({100, 100.0 * share});
    return row;
  };
  const auto table = TargetTable({{"w", {with_buoys("black_buoys", 0.91), with_buoys("lake", 0.2)}, "all"}}, "a", "b").table;
  EXPECT_EQ(CellsOf(table, "black buoys tracked within 2 s of coming within 25 m, %"), (Table::Row{">= 90", "91", "yes", "91 black_buoys", "-"}));
}

}  // namespace
}  // namespace lookout::eval
