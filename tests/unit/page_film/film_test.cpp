#include "services/page/film/film.hpp"

#include <gtest/gtest.h>
#include <mutex>
#include <nlohmann/json.hpp>

#include "common/runtime/run_info.hpp"
#include "tests/unit/page_film/scene.hpp"

namespace lookout::page {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t UtimeOf(std::int64_t seq) { return kBeginUs + seq * kScanUs; }
// When the last of a scan's TRACKS stood in the log.
constexpr std::int64_t WholeAt(std::int64_t seq) { return UtimeOf(seq) + kDelayUs + 2 * kPartUs; }

class OfFilm : public ::testing::Test {
 protected:
  std::unique_ptr<Film> Open(std::vector<fs::path> logs, std::vector<fs::path> beside = {}) {
    FilmOptions options;
    options.logs = std::move(logs);
    options.beside = std::move(beside);
    options.tell = [this](const std::string& line) { told_.push_back(line); };
    auto film = std::make_unique<Film>(options);
    film->Wait();
    return film;
  }
  static nlohmann::json StripOf(Film& film, std::int64_t from_us, std::int64_t to_us, int num_buckets) {
    StripRequest request;
    request.id = 5;
    request.from = At_us(from_us);
    request.to = At_us(to_us);
    request.num_buckets = num_buckets;
    return nlohmann::json::parse(film.Strip(request));
  }

  support::TempDir folder_;
  fs::path a_ = folder_ / "a.lcmlog";
  fs::path b_ = folder_ / "b.lcmlog";
  std::vector<std::string> told_;
};

TEST_F(OfFilm, GivesTheLastScanThatWasWholeByATime) {
  WriteScans(a_, 0, 10);
  const auto film = Open({a_});
  auto answer = film->Find(AtTime(WholeAt(4), {kScanChannel, kTracksChannel, kAlertsChannel, kPoseChannel}));
  EXPECT_EQ(answer.refusal, "");
  EXPECT_EQ(answer.scan_index, 4);
  EXPECT_EQ(answer.num_scans, 10);
  EXPECT_EQ(ToUtimeUs(answer.time), WholeAt(4));
  EXPECT_EQ(ToUtimeUs(answer.scan_time), UtimeOf(4));
  EXPECT_EQ(UtimesOf(answer, bus::kLidarScan), (std::vector{UtimeOf(4), UtimeOf(4)}));
  EXPECT_EQ(UtimesOf(answer, bus::kTracks), std::vector{UtimeOf(4)});
  EXPECT_EQ(UtimesOf(answer, bus::kAlerts), std::vector{UtimeOf(4)});
  EXPECT_EQ(UtimesOf(answer, bus::kPose), std::vector{UtimeOf(4)});  // not that of its end, which is 1 us later than the scan
  answer = film->Find(AtTime(WholeAt(4) - 1, {kScanChannel}));
  EXPECT_EQ(answer.scan_index, 3);
  EXPECT_EQ(UtimesOf(answer, bus::kTracks), std::vector<std::int64_t>());  // was not asked for
}

TEST_F(OfFilm, GivesEachPoseOfAScan) {
  {
    SceneLog log(a_);
    for (std::int64_t seq = 0; seq < 5; ++seq) {
      for (const std::int64_t later_us : {30'000, 70'000}) {
        pose_t pose{};
        pose.utime_us = UtimeOf(seq) + later_us;
        log->Put(UtimeOf(seq) + 90'000, bus::kPose, pose);
      }
      log->Scan(seq);
    }
  }
  const auto film = Open({a_});
  const auto answer = film->Find(AtTime(WholeAt(2), {kPoseChannel}));
  EXPECT_EQ(UtimesOf(answer, bus::kPose), (std::vector{UtimeOf(2), UtimeOf(2) + 30'000, UtimeOf(2) + 70'000}));
}

TEST_F(OfFilm, GivesTheSecondLidarsScanThatEndedLastBeforeTheEndOfTheFirsts) {
  const auto second = IndexOfChannel(bus::kLidarScan2);
  {
    SceneLog log(a_);
    for (std::int64_t seq = 0; seq < 3; ++seq) {
      for (int part = 0; part < 2; ++part) {
        // It ends 40 ms before the first's, and the next 60 ms after.
        auto scan = support::OfScan<lidar_scan_t>(UtimeOf(seq) - 40'000, seq, kScanUs - 1);
        scan.part_index = part;
        scan.num_parts = 2;
        log->Put(UtimeOf(seq) + 70'000 + part * kPartUs, bus::kLidarScan2, scan);
      }
      log->Scan(seq);
    }
    for (std::int64_t seq = 3; seq < 12; ++seq) log->Scan(seq);
  }
  const auto film = Open({a_});
  EXPECT_EQ(UtimesOf(film->Find(AtTime(WholeAt(1), {second})), bus::kLidarScan2), (std::vector{UtimeOf(1) - 40'000, UtimeOf(1) - 40'000}));
  EXPECT_EQ(UtimesOf(film->Find(AtTime(WholeAt(3), {second})), bus::kLidarScan2), (std::vector{UtimeOf(2) - 40'000, UtimeOf(2) - 40'000}));
  EXPECT_TRUE(UtimesOf(film->Find(AtTime(WholeAt(11), {second})), bus::kLidarScan2).empty()) << "too old";
}

TEST_F(OfFilm, GivesTheScanNearestToATimeOfMeasurement) {
  WriteScans(a_, 0, 10);
  const auto film = Open({a_});
  EXPECT_EQ(film->Find(AtScan(UtimeOf(6) + 49'000, {kScanChannel})).scan_index, 6);
  EXPECT_EQ(film->Find(AtScan(UtimeOf(6) + 51'000, {kScanChannel})).scan_index, 7);
  EXPECT_EQ(film->Find(AtScan(0, {kScanChannel})).scan_index, 0);
}

TEST_F(OfFilm, StepsFromScanToScanAndStopsAtTheEnds) {
  WriteScans(a_, 0, 10);
  const auto film = Open({a_});
  auto time_us = WholeAt(4);
  for (const std::int64_t expected : {5, 6, 7, 8, 9, 9}) {
    const auto answer = film->Find(AtTime(time_us, {kScanChannel}, 1));
    EXPECT_EQ(answer.scan_index, expected);
    time_us = ToUtimeUs(answer.time);
  }
  EXPECT_EQ(film->Find(AtTime(time_us, {}, -1)).scan_index, 8);
  EXPECT_EQ(film->Find(AtTime(time_us, {}, -100)).scan_index, 0);
  EXPECT_EQ(film->Find(AtTime(kBeginUs, {}, 1)).scan_index, 0);  // before the first scan
}

TEST_F(OfFilm, BeforeTheFirstScanThereIsNone) {
  WriteScans(a_, 0, 3);
  const auto film = Open({a_});
  const auto answer = film->Find(AtTime(0, {kScanChannel, kTracksChannel, kPoseChannel}));
  EXPECT_EQ(answer.scan_index, -1);
  EXPECT_TRUE(UtimesOf(answer, bus::kLidarScan).empty());
}

// A page once opened a log on a scan of before the first POSE, and asked whether the tracker runs.
TEST_F(OfFilm, OpensOnTheFirstScanThatHasTracksAndAPose) {
  {
    SceneLog log(a_);
    for (std::int64_t seq = 0; seq < 3; ++seq) {
      lidar_scan_t scan{};
      scan.utime_us = UtimeOf(seq);
      scan.end_utime_us = UtimeOf(seq) + kScanUs - 1;
      scan.num_parts = 1;
      log->Put(UtimeOf(seq) + kDelayUs, bus::kLidarScan, scan);
    }
    for (std::int64_t seq = 3; seq < 6; ++seq) log->Scan(seq);  // the first POSE is of the end of the first of them
  }
  const auto film = Open({a_});
  const auto source = nlohmann::json::parse(film->SourcesText())[0];
  EXPECT_EQ(source["opens_utime_us"].get<std::int64_t>(), WholeAt(4));
  EXPECT_TRUE(source["has_pose"].get<bool>());
  EXPECT_TRUE(source["has_tracks"].get<bool>());
  const auto answer = film->Find(AtTime(WholeAt(4), {kTracksChannel, kPoseChannel}));
  EXPECT_EQ(UtimesOf(answer, bus::kTracks), std::vector{UtimeOf(4)});
  EXPECT_EQ(UtimesOf(answer, bus::kPose), std::vector{UtimeOf(4)});
}

TEST_F(OfFilm, OpensAtItsBeginWhereThereAreNoTracks) {
  {
    SceneLog log(a_);
    lidar_scan_t scan{};
    scan.utime_us = UtimeOf(0);
    scan.num_parts = 1;
    log->Put(UtimeOf(0) + kDelayUs, bus::kLidarScan, scan);
  }
  const auto film = Open({a_});
  const auto source = nlohmann::json::parse(film->SourcesText())[0];
  EXPECT_EQ(source["opens_utime_us"], source["begin_utime_us"]);
  EXPECT_FALSE(source["has_pose"].get<bool>());
  EXPECT_FALSE(source["has_tracks"].get<bool>());
}

TEST_F(OfFilm, GivesTheLastHealthOfEachProcessThatIsNotOld) {
  {
    SceneLog log(a_);
    log->Health(kBeginUs, "gone");
    for (int second = 1; second < 8; ++second) {
      log->Health(kBeginUs + second * 1'000'000, "lidar");
      log->Health(kBeginUs + second * 1'000'000 + 10, "tracker");
    }
  }
  const auto film = Open({a_});
  const auto answer = film->Find(AtTime(kBeginUs + 6'500'000, {kHealthChannel}));
  EXPECT_EQ(UtimesOf(answer, bus::kHealth), (std::vector<std::int64_t>{kBeginUs + 6'000'000, kBeginUs + 6'000'010}));
}

// The watch says "no look-out" in messages that name the last scan: a minute later the last of them counts.
TEST_F(OfFilm, GivesWhatTheWatchSaidAfterTheLastScan) {
  {
    SceneLog log(a_);
    log->Scan(0);
    for (int i = 1; i < 100; ++i) {
      alerts_t watch{};
      watch.utime_us = kBeginUs;
      watch.is_watch = 1;
      watch.begin_seq = i;
      log->Put(kBeginUs + 200'000 + i * 500'000, bus::kAlerts, watch);
    }
  }
  const auto film = Open({a_});
  const auto answer = film->Find(AtTime(kBeginUs + 200'000 + 40 * 500'000, {kAlertsChannel, kScanChannel}));
  EXPECT_EQ(answer.scan_index, 0);
  ASSERT_EQ(UtimesOf(answer, bus::kAlerts).size(), 1U);
  for (const auto& message : answer.messages) {
    if (message.channel == kAlertsChannel) {
      EXPECT_EQ(bus::Decode<alerts_t>(message.bytes)->begin_seq, 40);
    }
  }
}

TEST_F(OfFilm, JoinsLogsInTheOrderOfTheirTimesAndAScanThatIsInTwo) {
  WriteScans(a_, 10, 20);
  {
    SceneLog log(b_);
    for (int seq = 0; seq < 9; ++seq) log->Scan(seq);
    lidar_scan_t scan{};  // a scan of which the other log holds the rest
    scan.utime_us = UtimeOf(10);
    scan.seq = 10;
    scan.part_index = 2;
    scan.num_parts = 3;
    log->Put(UtimeOf(10) + kDelayUs - 2 * kPartUs, bus::kLidarScan, scan);
  }
  const auto film = Open({a_, b_});
  const auto answer = film->Find(AtScan(UtimeOf(10), {kScanChannel}));
  EXPECT_EQ(answer.num_scans, 19);
  EXPECT_EQ(UtimesOf(answer, bus::kLidarScan).size(), 3U);
  EXPECT_EQ(UtimesOf(film->Find(AtScan(UtimeOf(3), {kTracksChannel})), bus::kTracks), std::vector{UtimeOf(3)});
  EXPECT_TRUE(told_.empty());
}

TEST_F(OfFilm, ShowsALogThatOverlapsAnotherBehindItAndTellsIt) {
  WriteScans(a_, 0, 100);
  WriteScans(b_, 20, 60);
  const auto film = Open({a_, b_});
  EXPECT_EQ(film->Find(AtTime(kBeginUs, {kScanChannel})).num_scans, 140);
  const auto strip = StripOf(*film, kBeginUs, kBeginUs + 20'000'000, 10);
  ASSERT_EQ(strip["events"].size(), 1U) << strip;
  EXPECT_EQ(strip["events"][0]["kind"], "gap");
}

// The recorder begins a log each hour: shifting what follows by a second each time would let the clock of the page drift.
TEST_F(OfFilm, DoesNotShiftALogThatBeginsAMomentBeforeTheEndOfTheOneBefore) {
  WriteScans(a_, 0, 20);
  {
    SceneLog log(b_);
    log->shift_us = -105'000;  // before the end of the other, by 5 ms
    for (int seq = 20; seq < 40; ++seq) log->Scan(seq);
  }
  const auto film = Open({a_, b_});
  EXPECT_EQ(ToUtimeUs(film->Find(AtScan(UtimeOf(39), {kScanChannel})).time), WholeAt(39) - 105'000);
  EXPECT_TRUE(StripOf(*film, kBeginUs, kBeginUs + 20'000'000, 10)["events"].empty());
}

TEST_F(OfFilm, ShowsAnotherLogBesideIt) {
  WriteScans(a_, 0, 20);
  WriteScans(b_, 3, 8);
  const auto film = Open({a_}, {b_});
  auto request = AtScan(UtimeOf(4), {kTracksChannel});
  request.source = 1;
  EXPECT_EQ(film->Find(request).num_scans, 5);
  EXPECT_EQ(ToUtimeUs(film->Find(request).scan_time), UtimeOf(4));
  request.source = 2;
  EXPECT_FALSE(film->Find(request).refusal.empty());
  const auto sources = nlohmann::json::parse(film->SourcesText());
  ASSERT_EQ(sources.size(), 2U);
  EXPECT_EQ(sources[1]["num_scans"], 5);
  EXPECT_EQ(sources[1]["name"], "b.lcmlog");
  EXPECT_EQ(sources[0]["is_indexed"], true);
}

TEST_F(OfFilm, ThinsASpanWithThePartsOfAScanTogether) {
  WriteScans(a_, 0, 100);
  const auto film = Open({a_});
  Range range;
  range.channel = kTracksChannel;
  range.from = At_us(WholeAt(10));
  range.to = At_us(WholeAt(89));
  range.max_messages = 5000;
  EXPECT_EQ(film->Find(range).messages.size(), 80U);
  range.max_messages = 8;
  EXPECT_EQ(UtimesOf(film->Find(range), bus::kTracks),
            (std::vector{UtimeOf(10), UtimeOf(20), UtimeOf(30), UtimeOf(40), UtimeOf(50), UtimeOf(60), UtimeOf(70), UtimeOf(80)}));
  range.channel = kScanChannel;
  range.max_messages = 9;
  const auto scans = UtimesOf(film->Find(range), bus::kLidarScan);
  ASSERT_EQ(scans.size(), 8U);
  for (std::size_t i = 0; i < scans.size(); i += 2) EXPECT_EQ(scans[i], scans[i + 1]);
  range.channel = IndexOfChannel(bus::kNavRaw);
  EXPECT_FALSE(film->Find(range).refusal.empty());
}

TEST_F(OfFilm, DrawsTheStripFromSeconds) {
  {
    SceneLog log(a_);
    for (int seq = 0; seq < 100; ++seq) {
      if (seq >= 50 && seq < 60) continue;
      log->Scan(seq, seq < 50 ? 2 : 5, seq >= 80 ? std::optional(alert_t::LEVEL_WARNING) : std::nullopt);
      if (seq % 10 == 0) log->Health(UtimeOf(seq) + kDelayUs + 50'000, "lidar", seq == 70 ? 1 : 0, "rain");
    }
  }
  const auto film = Open({a_});
  const auto begin_us = kBeginUs + kDelayUs / 1'000'000 * 1'000'000;
  const auto strip = StripOf(*film, begin_us, begin_us + 10'000'000, 10);
  EXPECT_EQ(strip["id"], 5);
  EXPECT_EQ(strip["bucket_us"], 1'000'000);
  EXPECT_EQ(strip["num_tracks"].size(), 10U);
  EXPECT_EQ(strip["num_tracks"][1], 2);
  EXPECT_EQ(strip["num_tracks"][9], 5);
  EXPECT_EQ(strip["alert_level"][7], 0);
  EXPECT_EQ(strip["alert_level"][9], 2);
  EXPECT_EQ(strip["health"][7], 1);
  EXPECT_EQ(strip["health"][9], 0);
  int num_lost = 0;
  for (const auto& lost : strip["num_lost"]) num_lost += lost.get<int>();
  EXPECT_EQ(num_lost, 40);  // 10 each of LIDAR_SCAN, TRACKS, ALERTS, POSE
  const auto fine = StripOf(*film, begin_us, begin_us + 10'000'000, 100);
  int num_short = 0;
  for (const auto& lost : fine["num_lost"]) num_short += lost.get<int>();
  EXPECT_EQ(num_short, num_lost);
  std::set<std::string> kinds;
  for (const auto& event : strip["events"]) kinds.insert(event["kind"]);
  EXPECT_EQ(kinds, (std::set<std::string>{"alert", "health", "loss"}));
  EXPECT_EQ(StripOf(*film, begin_us, begin_us, 10)["type"], "refused");
}

TEST_F(OfFilm, KnowsTheBoatOutOfRunInfo) {
  {
    SceneLog log(a_);
    auto info = runtime::MakeRunInfo("recorder", support::kDemoConfig);
    info.utime_us = kBeginUs;
    log->Put(kBeginUs, bus::kRunInfo, info);
    log->Scan(0);
  }
  const auto film = Open({a_});
  const auto boat = nlohmann::json::parse(film->SourcesText())[0]["boat"];
  ASSERT_TRUE(boat.is_object());
  EXPECT_GT(boat["cpa_limit_m"].get<double>(), 0.0);
  EXPECT_TRUE(boat["lidar"]["yaw_deg"].is_number());
  EXPECT_TRUE(boat["lidar_2"].is_null());
  EXPECT_LT(boat["own_vessel"]["min_x_m"].get<double>(), boat["own_vessel"]["max_x_m"].get<double>());
  EXPECT_EQ(UtimesOf(film->Find(AtTime(kBeginUs + 10'000'000, {kRunInfoChannel})), bus::kRunInfo), std::vector{kBeginUs});
}

TEST_F(OfFilm, LeavesOutWhatIsNoLogAndGoesOn) {
  WriteScans(a_, 0, 5);
  support::WriteFile(b_, "this is no log");
  const auto film = Open({b_, a_});
  EXPECT_EQ(film->Find(AtTime(WholeAt(4), {kScanChannel})).num_scans, 5);
  EXPECT_THROW(Open({folder_ / "missing"}), std::runtime_error);
  EXPECT_THROW(Open({}), std::runtime_error);
  const auto empty = Open({b_});
  EXPECT_FALSE(empty->Find(AtTime(0, {kScanChannel})).refusal.empty());
  EXPECT_EQ(StripOf(*empty, kBeginUs, kBeginUs + 1'000'000, 2)["num_tracks"], (std::vector{-1, -1}));
}

TEST_F(OfFilm, GivesFewerMessagesWhereTheLogWasCutMeanwhile) {
  WriteScans(a_, 0, 10);
  const auto film = Open({a_});
  fs::resize_file(a_, fs::file_size(a_) / 2);
  EXPECT_TRUE(film->Find(AtScan(UtimeOf(9), {kScanChannel, kTracksChannel})).messages.empty());
  EXPECT_EQ(film->Find(AtScan(UtimeOf(2), {kScanChannel})).messages.size(), 2U);
}

TEST_F(OfFilm, RefusesWhileAnIndexIsBeingBuiltAndTellsHowFarItIs) {
  {
    SceneLog log(a_);
    for (int seq = 0; seq < 600; ++seq) log->Scan(seq);
  }
  std::mutex gate;
  std::vector<double> shares;
  std::optional<std::unique_lock<std::mutex>> closed(gate);
  FilmOptions options;
  options.logs = {a_};
  options.on_indexing = [&](int, double share) {
    const std::scoped_lock lock(gate);
    shares.push_back(share);
  };
  Film film(options);
  EXPECT_EQ(film.Find(AtTime(kBeginUs, {kScanChannel})).refusal, "the index is being built");
  EXPECT_EQ(nlohmann::json::parse(film.SourcesText())[0]["is_indexed"], false);
  closed.reset();
  film.Wait();
  EXPECT_EQ(film.Find(AtTime(kBeginUs, {kScanChannel})).num_scans, 600);
  ASSERT_GT(shares.size(), 2U);
  EXPECT_TRUE(std::ranges::is_sorted(shares));
  EXPECT_EQ(shares.back(), 1.0);
}

}  // namespace
}  // namespace lookout::page
