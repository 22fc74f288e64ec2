#include "services/page/film/look_back.hpp"

#include <atomic>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/unit/page_film/scene.hpp"

namespace lookout::page {
namespace {

namespace fs = std::filesystem;

class OfLookBack : public ::testing::Test {
 protected:
  OfLookBack() { options_.spool_folder = folder_ / "spool"; }

  struct Feed {
    LookBack& back;
    void operator()(Utime time, std::string_view channel, Bytes bytes) const { back.Append(time, channel, bytes); }
  };
  static void Send(LookBack& back, std::int64_t first, std::int64_t end, std::int64_t shift_us = 0) {
    Feed feed{back};
    SceneWriter<Feed> writer(feed);
    writer.shift_us = shift_us;
    for (auto seq = first; seq < end; ++seq) writer.Scan(seq);
  }
  std::size_t NumFiles() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(options_.spool_folder), fs::directory_iterator()));
  }
  static bool WaitUntil(const std::function<bool()>& holds) {
    for (int i = 0; i < 1000; ++i) {
      if (holds()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }

  support::TempDir folder_;
  LookBackOptions options_;
};

TEST_F(OfLookBack, GivesWhatWasOnTheBus) {
  LookBack back(options_);
  EXPECT_FALSE(back.Find(AtTime(kBeginUs, {kScanChannel})).refusal.empty());  // nothing yet
  Send(back, 0, 50);
  back.Flush();
  const auto answer = back.Find(AtScan(kBeginUs + 20 * kScanUs, {kScanChannel, kTracksChannel}));
  EXPECT_EQ(answer.num_scans, 50);
  EXPECT_EQ(UtimesOf(answer, bus::kLidarScan).size(), 2U);
  EXPECT_EQ(UtimesOf(answer, bus::kTracks), std::vector{kBeginUs + 20 * kScanUs});
  EXPECT_EQ(back.Status().num_spooled, 250);
  EXPECT_EQ(back.Status().num_lost, 0);
  const auto source = nlohmann::json::parse(back.SourcesText())[0];
  EXPECT_EQ(source["is_growing"], true);
  EXPECT_EQ(source["num_scans"], 50);
}

TEST_F(OfLookBack, KeepsWhatAPageShows) {
  EXPECT_TRUE(LookBack::IsKept("LIDAR_SCAN"));
  EXPECT_TRUE(LookBack::IsKept("HEALTH"));
  EXPECT_FALSE(LookBack::IsKept("LIDAR_PACKETS"));
  EXPECT_FALSE(LookBack::IsKept("NAV_RAW"));
  EXPECT_FALSE(LookBack::IsKept("LIDAR_NMEA"));
  EXPECT_FALSE(LookBack::IsKept("NOBODY_KNOWS"));
}

TEST_F(OfLookBack, ForgetsWhatIsOlderThanItsSpan) {
  options_.span = std::chrono::seconds(120);
  LookBack back(options_);
  for (std::int64_t minute = 0; minute < 6; ++minute) {
    Send(back, minute * 600, minute * 600 + 20);
    back.Flush();
  }
  EXPECT_LE(NumFiles(), 4U);
  const auto source = nlohmann::json::parse(back.SourcesText())[0];
  EXPECT_EQ(source["end_utime_us"].get<std::int64_t>() - source["begin_utime_us"].get<std::int64_t>(), 120'000'000);
  EXPECT_EQ(source["num_scans"], 40);  // of the minutes 4 and 5, and none of 3, but for what lies within 120 s
  EXPECT_EQ(back.Find(AtScan(kBeginUs + 2405 * kScanUs, {kScanChannel})).messages.size(), 2U);
}

TEST_F(OfLookBack, HoldsTheSpoolWithinItsBytes) {
  options_.max_bytes = 2'000'000;
  LookBack back(options_);
  for (std::int64_t seq = 0; seq < 400; seq += 5) {  // 16 MB
    Send(back, seq, seq + 5);
    back.Flush();
  }
  std::uintmax_t num_bytes = 0;
  for (const auto& entry : fs::directory_iterator(options_.spool_folder)) num_bytes += entry.file_size();
  EXPECT_LT(num_bytes, 2'300'000U);
  EXPECT_GT(num_bytes, 1'000'000U);
  EXPECT_EQ(UtimesOf(back.Find(AtScan(kBeginUs + 399 * kScanUs, {kScanChannel})), bus::kLidarScan).size(), 2U);
}

// The spool began when the recorder stopped at its reserve, and ate it: 0 bytes were free.
TEST_F(OfLookBack, WritesNothingIntoTheReserveOfTheDiskAndSaysWhy) {
  std::atomic<std::int64_t> free_bytes = 1'000'000'000;
  options_.reserve = io::DiskReserve(1'000'000'000);
  options_.free_bytes = [&](const fs::path&) { return free_bytes.load(); };
  std::atomic<int> num_told = 0;
  options_.tell = [&](const std::string&) { ++num_told; };
  LookBack back(options_);
  for (std::int64_t seq = 0; seq < 20; seq += 5) {
    Send(back, seq, seq + 5);
    back.Flush();
  }
  EXPECT_EQ(NumFiles(), 0U);
  EXPECT_EQ(back.Status().fault, options_.spool_folder.string() + ": 1000 MB are free, 1000 MB of the disk are kept in reserve; move or delete logs");
  EXPECT_GT(back.Status().num_lost, 0);
  EXPECT_EQ(num_told, 1);
}

TEST_F(OfLookBack, GivesBackItsOldestMinutesWhereTheDiskFillsAndSaysSo) {
  std::atomic<std::int64_t> free_bytes = 4'000'000'000;
  options_.reserve = io::DiskReserve(1'000'000'000);
  options_.free_bytes = [&](const fs::path&) { return free_bytes.load(); };
  options_.max_bytes = 50'000'000;
  LookBack back(options_);
  const auto held = [&] {
    std::int64_t num_bytes = 0;
    for (const auto& entry : fs::directory_iterator(options_.spool_folder)) num_bytes += static_cast<std::int64_t>(entry.file_size());
    return num_bytes;
  };
  std::int64_t seq = 0;
  const auto send_until = [&](std::int64_t end) {
    for (; seq < end; seq += 5) {
      Send(back, seq, seq + 5);
      back.Flush();
    }
  };
  send_until(600);  // 24 MB
  EXPECT_GT(held(), 20'000'000);
  EXPECT_EQ(back.Status().shortage, "");
  free_bytes = options_.reserve.bytes_to_go_on() - 10'000'000;
  send_until(605);
  EXPECT_LT(held(), 18'000'000);
  EXPECT_NE(back.Status().shortage.find("kept in reserve"), std::string::npos);
  EXPECT_EQ(back.Status().fault, "");
  EXPECT_FALSE(back.Find(AtScan(kBeginUs + 604 * kScanUs, {kScanChannel})).messages.empty());
  free_bytes = 1'000'000'000;
  send_until(610);
  EXPECT_EQ(NumFiles(), 0U);
  EXPECT_NE(back.Status().fault, "");
  EXPECT_EQ(back.Status().shortage, "");
}

TEST_F(OfLookBack, RemovesItsSpoolAndWhatAKilledProcessLeft) {
  fs::create_directory(options_.spool_folder);
  support::WriteFile(options_.spool_folder / "look-back-000003.lcmlog.partial", "old");
  support::WriteFile(options_.spool_folder / "somebody's.txt", "stays");
  {
    LookBack back(options_);
    Send(back, 0, 5);
    back.Flush();
    EXPECT_EQ(NumFiles(), 2U);
  }
  EXPECT_EQ(NumFiles(), 1U);
  EXPECT_TRUE(fs::exists(options_.spool_folder / "somebody's.txt"));
}

// Two pages that were given the same folder: neither takes the other's files away.
TEST_F(OfLookBack, LeavesTheSpoolOfAnotherProcessAlone) {
  LookBack other(options_);
  Send(other, 0, 5);
  other.Flush();
  LookBack back(options_);
  EXPECT_EQ(NumFiles(), 1U);
  EXPECT_EQ(other.Find(AtScan(kBeginUs, {kScanChannel})).messages.size(), 2U);
  Send(back, 0, 5);
  back.Flush();
  EXPECT_EQ(back.Status().num_lost, 0) << back.Status().fault;
  EXPECT_EQ(NumFiles(), 2U);
}

TEST_F(OfLookBack, CountsWhatDoesNotFitIntoTheQueue) {
  options_.queue_bytes = 100'000;
  LookBack back(options_);
  Send(back, 0, 200);
  back.Flush();
  const auto status = back.Status();
  EXPECT_GT(status.num_lost, 0);
  EXPECT_EQ(status.num_lost + status.num_spooled, 1000);
}

TEST_F(OfLookBack, GoesOnWhenItsFolderIsTakenAway) {
  LookBack back(options_);
  fs::remove_all(options_.spool_folder);
  Send(back, 0, 5);
  back.Flush();
  EXPECT_FALSE(back.Status().fault.empty());
  EXPECT_EQ(back.Status().num_lost, 25);
}

TEST_F(OfLookBack, ShowsLaterWhatAClockThatWasSetBackGave) {
  LookBack back(options_);
  Send(back, 0, 10);
  back.Flush();
  Send(back, 10, 20, -3'600'000'000);
  back.Flush();
  EXPECT_EQ(back.Find(AtScan(kBeginUs + 15 * kScanUs, {kScanChannel})).num_scans, 20);
  EXPECT_EQ(UtimesOf(back.Find(AtScan(kBeginUs + 15 * kScanUs, {kScanChannel})), bus::kLidarScan).size(), 2U);
}

// They were removed at once, but stayed on the disk as long as they were shown, and nobody counted them.
TEST_F(OfLookBack, KeepsTheFilesThatItShowsWhereTheClockWasSetBack) {
  options_.span = std::chrono::seconds(10);
  options_.max_bytes = 20'000'000;  // in files of 2 MB, or 5 s
  LookBack back(options_);
  for (std::int64_t seq = 0; seq < 300; seq += 10) {
    Send(back, seq, seq + 10, seq < 50 ? 0 : -3'600'000'000);
    back.Flush();
  }
  EXPECT_GE(NumFiles(), 3U);
  EXPECT_LE(NumFiles(), 4U);
}

// Nothing is written twice.
TEST_F(OfLookBack, FollowsTheLogThatTheRecorderWritesAndSpoolsWhenItStops) {
  options_.recorder_folder = folder_ / "logs";
  fs::create_directory(*options_.recorder_folder);
  WriteScans(*options_.recorder_folder / "20260101T000000Z.lcmlog", 0, 10);
  LookBack back(options_);
  auto log = std::make_unique<SceneLog>(*options_.recorder_folder / "20260101T000001Z.lcmlog");
  std::int64_t seq = 10;
  const auto record = [&] {
    (*log)->Scan(seq++);
    log->Flush();
  };
  ASSERT_TRUE(WaitUntil([&] {
    record();
    return back.Status().is_following;
  }));
  Send(back, 5000, 5010);  // on the bus, too: the recorder has it
  back.Flush();
  EXPECT_EQ(back.Status().num_spooled, 0);
  EXPECT_EQ(NumFiles(), 0U);
  const auto first = back.Find(AtScan(kBeginUs, {kScanChannel}));
  EXPECT_EQ(ToUtimeUs(first.scan_time), kBeginUs);
  EXPECT_EQ(first.num_scans, seq);
  // The next log of the recorder.
  log = std::make_unique<SceneLog>(*options_.recorder_folder / "20260101T000002Z.lcmlog");
  record();
  back.Flush();
  EXPECT_EQ(back.Find(AtScan(kBeginUs, {kScanChannel})).num_scans, seq);
  ASSERT_TRUE(WaitUntil([&] { return !back.Status().is_following; }));
  Send(back, seq, seq + 10);
  back.Flush();
  EXPECT_EQ(back.Find(AtScan(kBeginUs, {kScanChannel})).num_scans, seq + 10);
  EXPECT_EQ(back.Status().num_spooled, 50);
}

TEST_F(OfLookBack, HasNoFaultOfItsSpoolWhileItFollowsTheRecorder) {
  options_.recorder_folder = folder_ / "logs";
  fs::create_directory(*options_.recorder_folder);
  LookBack back(options_);
  fs::remove_all(options_.spool_folder);
  Send(back, 0, 5);
  back.Flush();
  EXPECT_FALSE(back.Status().fault.empty());
  SceneLog log(*options_.recorder_folder / "20260101T000001Z.lcmlog");
  std::int64_t seq = 5;
  ASSERT_TRUE(WaitUntil([&] {
    log->Scan(seq++);
    log.Flush();
    return back.Status().is_following;
  }));
  back.Flush();
  EXPECT_EQ(back.Status().fault, "");
}

// The disk was full, a log was deleted, and nothing became free: the page had it open.
TEST_F(OfLookBack, LetsGoOfALogThatIsRemovedToMakeRoom) {
  options_.recorder_folder = folder_ / "logs";
  fs::create_directory(*options_.recorder_folder);
  LookBack back(options_);
  const auto file = *options_.recorder_folder / "20260101T000001Z.lcmlog";
  auto log = std::make_unique<SceneLog>(file);
  std::int64_t seq = 0;
  ASSERT_TRUE(WaitUntil([&] {
    (*log)->Scan(seq++);
    log->Flush();
    return back.Status().is_following;
  }));
  back.Flush();
  log.reset();
  ASSERT_TRUE(WaitUntil([&] { return !back.Status().is_following; }));
  const auto is_open = [&] {
    std::error_code gone;
    return std::ranges::any_of(fs::directory_iterator("/proc/self/fd"), [&](const auto& entry) {
      return fs::read_symlink(entry.path(), gone).string().find(file.filename().string()) != std::string::npos;
    });
  };
  EXPECT_TRUE(is_open()) << "what was read can be shown";
  fs::remove(file);
  EXPECT_TRUE(WaitUntil([&] { return !is_open(); }));
  EXPECT_TRUE(back.Find(AtScan(kBeginUs, {kScanChannel})).messages.empty());
}

// One that is removed, by hand or to make room, between its being seen and its being opened.
TEST_F(OfLookBack, FollowsTheOtherLogsWhereOneIsTakenAway) {
  options_.recorder_folder = folder_ / "logs";
  fs::create_directory(*options_.recorder_folder);
  const auto old = *options_.recorder_folder / "20260101T000000Z.lcmlog";
  WriteScans(old, 0, 10);
  std::atomic<LookBack*> there = nullptr;
  options_.on_sources = [&] {
    if (auto* back = there.load(); back != nullptr && back->Status().is_following) fs::remove(old);
  };
  LookBack back(options_);
  there = &back;
  Send(back, 100, 105);
  back.Flush();
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // the sources of the spool are told, so that there is something to be told anew
  SceneLog log(*options_.recorder_folder / "20260101T000001Z.lcmlog");
  std::int64_t seq = 10;
  ASSERT_TRUE(WaitUntil([&] {
    log->Scan(seq++);
    log.Flush();
    return back.Status().is_following;
  }));
  back.Flush();
  EXPECT_FALSE(fs::exists(old));
  EXPECT_EQ(back.Find(AtScan(kBeginUs + 10 * kScanUs, {kScanChannel})).num_scans, seq - 10);
}

}  // namespace
}  // namespace lookout::page
