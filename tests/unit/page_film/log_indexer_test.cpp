#include "services/page/film/log_indexer.hpp"

#include <gtest/gtest.h>

#include "lookout/lidar_packets_t.hpp"
#include "tests/unit/page_film/scene.hpp"

namespace lookout::page {
namespace {

class Indexer : public ::testing::Test {
 protected:
  support::TempDir folder_;
  std::filesystem::path log_ = folder_ / "a.lcmlog";

  LogPart Whole() {
    LogIndexer indexer(log_, false);
    LogPart part;
    while (indexer.Read(1'000'000, part)) {
    }
    num_refused_ = indexer.num_refused();
    return part;
  }
  static std::vector<std::string> TextsOf(const LogPart& part, FilmEventKind kind) {
    std::vector<std::string> texts;
    for (const auto& event : part.events) {
      if (event.kind == kind) texts.push_back(event.text);
    }
    return texts;
  }
  std::int64_t num_refused_ = 0;
};

TEST_F(Indexer, SaysWhereEachMessageStands) {
  WriteScans(log_, 0, 3);
  const auto part = Whole();
  ASSERT_EQ(part.entries.size(), 15U);
  bus::LogReader reader(log_);
  for (const auto& entry : part.entries) {
    reader.Seek(entry.offset_bytes);
    const auto event = reader.Next();
    ASSERT_TRUE(event);
    EXPECT_EQ(event->channel, bus::kChannels[entry.channel].name);
    EXPECT_EQ(event->bytes.size(), entry.size_bytes);
    EXPECT_EQ(event->time, entry.time);
    EXPECT_EQ(bus::ReadHeader(event->bytes)->utime_us, entry.utime_us);
  }
  EXPECT_EQ(part.entries[1].part, 0);
  EXPECT_EQ(part.entries[2].part, 1);
  EXPECT_EQ(part.entries[1].duration_us, kScanUs - 1);
  EXPECT_EQ(part.cells.front().num_tracks, 3);
}

TEST_F(Indexer, CountsWhatIsMissingInItsSecond) {
  {
    SceneLog log(log_);
    for (const std::int64_t seq : {0, 1, 12, 13}) log->Scan(seq);
  }
  const auto part = Whole();
  std::int64_t num_lost = 0;
  for (const auto& cell : part.cells) num_lost += cell.num_lost;
  EXPECT_EQ(num_lost, 40);  // 10 each of LIDAR_SCAN, TRACKS, ALERTS, POSE
  const auto losses = TextsOf(part, FilmEventKind::kLoss);
  EXPECT_NE(std::ranges::find(losses, "TRACKS: 10 messages lost"), losses.end());
}

TEST_F(Indexer, TellsAnAlertOnceAndAgainWhenItGrowsGraver) {
  {
    SceneLog log(log_);
    for (int seq = 0; seq < 4; ++seq) log->Scan(seq, 1, alert_t::LEVEL_CAUTION);
    for (int seq = 4; seq < 8; ++seq) log->Scan(seq, 1, alert_t::LEVEL_WARNING);
  }
  const auto part = Whole();
  ASSERT_EQ(TextsOf(part, FilmEventKind::kAlert).size(), 2U);
  EXPECT_EQ(part.events.front().level, 1);
  EXPECT_EQ(part.events.back().level, 2);
  EXPECT_EQ(part.events.back().text, "boat 17: closest approach 3 m");
}

TEST_F(Indexer, TellsWhatChangesInHealth) {
  {
    SceneLog log(log_);
    log->Health(kBeginUs, "lidar");
    log->Health(kBeginUs + 1'000'000, "lidar", health_t::STATE_FAILED, "no packets\x1b[2J");
    log->Health(kBeginUs + 2'000'000, "lidar", health_t::STATE_FAILED, "no packets");
    log->Health(kBeginUs + 3'000'000, "lidar");
  }
  EXPECT_EQ(TextsOf(Whole(), FilmEventKind::kHealth), (std::vector<std::string>{"lidar: failed: no packets?[2J", "lidar: OK"}));
}

TEST_F(Indexer, TellsMarksOfRawChannelsWithoutKeepingTheirMessages) {
  {
    SceneLog log(log_);
    lidar_packets_t packets{};
    packets.utime_us = kBeginUs;
    packets.marks = lidar_packets_t::MARK_START;
    log->Put(kBeginUs, bus::kLidarPackets, packets);
  }
  const auto part = Whole();
  EXPECT_TRUE(part.entries.empty());
  EXPECT_EQ(TextsOf(part, FilmEventKind::kStart).size(), 1U);
}

// Times that go back would make what stands behind them unreachable by time.
TEST_F(Indexer, ShowsLaterWhatAClockThatWasSetBackWrote) {
  {
    SceneLog log(log_);
    log->Scan(0);
    log->shift_us = -3'600'000'000;
    log->Scan(1);
    log->Scan(2);
  }
  const auto part = Whole();
  EXPECT_TRUE(std::ranges::is_sorted(part.entries, {}, &LogEntry::time));
  ASSERT_EQ(part.entries.size(), 15U);
  EXPECT_EQ(part.entries[14].time - part.entries[9].time, std::chrono::microseconds(kScanUs));
  ASSERT_EQ(TextsOf(part, FilmEventKind::kGap).size(), 1U);
  EXPECT_NE(TextsOf(part, FilmEventKind::kGap)[0].find("set back"), std::string::npos);
}

// Each time that it is set back adds to the shift of what follows.
TEST_F(Indexer, StaysWithinTheYearsOfAUtimeWhereTheClockGoesToAndFro) {
  {
    SceneLog log(log_);
    for (int seq = 0; seq < 8; ++seq) {
      log->shift_us = seq % 2 == 0 ? 0 : 5'400'000'000'000'000;
      log->Scan(seq);
    }
  }
  const auto part = Whole();
  ASSERT_EQ(part.entries.size(), 40U);
  EXPECT_LE(ToUtimeUs(part.entries.back().time), kMaxUtimeUs);
  EXPECT_TRUE(std::ranges::is_sorted(part.entries, {}, &LogEntry::time));
  EXPECT_TRUE(std::ranges::all_of(part.events, [](const FilmEvent& event) { return ToUtimeUs(event.time) <= kMaxUtimeUs; }));
}

// One wrong time would put all that follows a century on.
TEST_F(Indexer, DoesNotBelieveATimeThatTheNextEventDenies) {
  {
    SceneLog log(log_);
    log->Scan(0);
    log->shift_us = 3'000'000'000'000'000;
    log->Health(kBeginUs, "lidar");
    log->shift_us = 0;
    log->Scan(1);
  }
  const auto part = Whole();
  EXPECT_LT(part.entries.back().time, At_us(kBeginUs + 1'000'000));
  EXPECT_EQ(part.entries.size(), 11U);
  EXPECT_EQ(part.entries[5].channel, IndexOfChannel(bus::kHealth));
}

TEST_F(Indexer, SkipsDamageAndTellsIt) {
  WriteScans(log_, 0, 3);
  auto bytes = support::ReadFile(log_);
  const auto third = bytes.size() / 3;
  for (std::size_t i = third; i < third + 30'000; ++i) bytes[i] = 'x';
  support::WriteFile(log_, bytes.substr(0, bytes.size() - 10));
  const auto part = Whole();
  EXPECT_LT(part.entries.size(), 15U);
  EXPECT_GT(part.entries.size(), 8U);
  EXPECT_EQ(TextsOf(part, FilmEventKind::kGap).size(), 2U);
}

TEST_F(Indexer, RefusesMessagesOfAnotherTypeOrWithPartsThatCannotBe) {
  {
    SceneLog log(log_);
    log->Put(kBeginUs, bus::kLidarScan, pose_t{});
    tracks_t tracks{};
    tracks.utime_us = kBeginUs;
    tracks.part_index = 3;
    tracks.num_parts = 2;
    log->Put(kBeginUs, bus::kTracks, tracks);
    log(At_us(kBeginUs), "HEALTH", std::vector<std::uint8_t>(5));
    log(At_us(kBeginUs), "NOBODY_KNOWS", std::vector<std::uint8_t>(50));
  }
  EXPECT_TRUE(Whole().entries.empty());
  EXPECT_EQ(num_refused_, 3);
}

TEST_F(Indexer, TakesAForeignFileForDamage) {
  support::WriteFile(log_, std::string(200'000, 'z'));
  EXPECT_TRUE(Whole().entries.empty());
  support::WriteFile(log_, "");
  EXPECT_TRUE(Whole().entries.empty());
}

TEST_F(Indexer, ReadsOnInALogThatGrows) {
  WriteScans(log_, 0, 20);
  const auto bytes = support::ReadFile(log_);
  const auto growing = folder_ / "growing.lcmlog";
  support::WriteFile(growing, "");
  LogIndexer indexer(growing, true);
  LogPart part;
  for (std::size_t size = 0; size < bytes.size(); size += 77'777) {  // mostly within an event
    std::ofstream(growing, std::ios::binary | std::ios::in).write(bytes.data(), static_cast<std::streamsize>(size));
    while (indexer.Read(1'000'000, part)) {
    }
  }
  std::ofstream(growing, std::ios::binary | std::ios::in).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  indexer.Read(100'000'000, part);
  EXPECT_EQ(part.entries, Whole().entries);
  EXPECT_TRUE(TextsOf(part, FilmEventKind::kGap).empty());
}

}  // namespace
}  // namespace lookout::page
