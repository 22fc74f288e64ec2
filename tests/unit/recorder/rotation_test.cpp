// Logs that follow each other, and disks with faults: each event is in one log, or counted.
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <lcm/eventlog.h>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/header.hpp"
#include "common/bus/log_file.hpp"
#include "common/bus/memory_bus.hpp"
#include "lookout/nav_raw_t.hpp"
#include "lookout/pose_t.hpp"
#include "services/recorder/service.hpp"
#include "tests/support/files.hpp"

namespace lookout::recorder {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;

constexpr std::int64_t kPlenty = 1'000'000'000'000;

class Rotation : public ::testing::Test {
 protected:
  support::TempDir folder_;
  bus::MemoryBus bus_;
  Utime now_{seconds(1'800'000'000)};
  Params params_{.log_folder = folder_, .reserve_bytes = 0};
  std::int64_t seq_ = 0;

  Service Make(const Disk& disk = RealDisk()) {
    return Service(
        bus_, params_, run_info_t{}, [this] { return now_; }, disk);
  }
  void Send(int count = 1) {
    for (int i = 0; i < count; ++i) {
      pose_t message{};
      message.seq = seq_++;
      bus::Publish(bus_, bus::kPose, message);
    }
    while (bus_.HandleOnce()) {
    }
  }
  std::vector<fs::path> Files() const {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder_)) files.push_back(entry.path());
    std::ranges::sort(files);
    return files;
  }
  // The seq of every POSE of all logs in their order; each log must be whole, begin with RUN_INFO and number its events from 0.
  std::vector<std::int64_t> Recorded() const {
    std::vector<std::int64_t> seqs;
    for (const auto& file : Files()) {
      // LCM's own reader.
      lcm_eventlog_t* log = lcm_eventlog_create(file.c_str(), "r");
      std::int64_t number = 0;
      while (lcm_eventlog_event_t* event = lcm_eventlog_read_next_event(log)) {
        EXPECT_EQ(event->eventnum, number);
        EXPECT_TRUE(number > 0 || std::string(event->channel) == "RUN_INFO");
        ++number;
        const Bytes bytes(static_cast<const std::uint8_t*>(event->data), static_cast<std::size_t>(event->datalen));
        if (event->channel == bus::kPose.name) seqs.push_back(bus::ReadHeader(bytes)->seq);
        lcm_eventlog_free_event(event);
      }
      lcm_eventlog_destroy(log);
      bus::LogReader reader(file);
      std::int64_t num_events = 0;
      while (reader.Next()) ++num_events;
      EXPECT_EQ(reader.num_damaged(), 0) << file;
      EXPECT_EQ(num_events, number) << file;
    }
    return seqs;
  }
  static std::vector<std::int64_t> UpTo(std::int64_t count) {
    std::vector<std::int64_t> seqs;
    for (std::int64_t i = 0; i < count; ++i) seqs.push_back(i);
    return seqs;
  }
  static std::int64_t Count(const Service& service, std::string_view name) {
    for (const auto& counter : service.Report().counters) {
      if (counter.name == name) return counter.count;
    }
    return -1;
  }
};

TEST_F(Rotation, BySizeLosesAndDoublesNothing) {
  params_.max_file_bytes = 50'000;
  {
    Service service = Make();
    for (int i = 0; i < 20; ++i) {
      Send(25);  // some 1 kB each
      now_ += seconds(1);
      service.AdvanceTo(now_);
    }
    service.Flush();
    EXPECT_EQ(service.Report().state, HealthState::kOk) << service.Report().reason;
    EXPECT_EQ(Count(service, "lost"), 0);
    EXPECT_EQ(Count(service, "files"), static_cast<std::int64_t>(Files().size()));
  }
  EXPECT_GE(Files().size(), 8U);
  for (const auto& file : Files()) EXPECT_LE(fs::file_size(file), 50'000U);
  EXPECT_EQ(Recorded(), UpTo(500));
}

TEST_F(Rotation, OfALimitBelowOneMessageMakesALogForEach) {
  params_.max_file_bytes = 10;
  {
    const Service service = Make();
    Send(3);
  }
  EXPECT_EQ(Files().size(), 3U);
  EXPECT_EQ(Recorded(), UpTo(3));
}

TEST_F(Rotation, ByTimeAndByRequest) {
  params_.max_file_time = seconds(60);
  {
    Service service = Make();
    for (int i = 0; i < 125; ++i) {
      Send();
      if (i == 10) service.Rotate(now_);
      now_ += seconds(1);
      service.AdvanceTo(now_);
    }
  }
  ASSERT_EQ(Files().size(), 3U) << "from 0, 10, 70 s on; the clock begins anew with each";
  EXPECT_EQ(Files()[1].filename(), "20270115T080010Z.lcmlog");
  EXPECT_EQ(Files()[2].filename(), "20270115T080110Z.lcmlog");
  EXPECT_EQ(Recorded(), UpTo(125));
}

TEST_F(Rotation, ManyTimesAtOnceGivesEachLogItsOwnNameAndNoRunInfoTwice) {
  {
    Service service = Make();
    for (int i = 0; i < 5; ++i) service.Rotate(now_);
    Send(1);
  }
  EXPECT_EQ(Files().size(), 6U);
  std::vector<std::int64_t> seqs;
  for (const auto& file : Files()) {
    bus::LogReader reader(file);
    while (const auto event = reader.Next()) {
      if (event->channel == "RUN_INFO") seqs.push_back(bus::ReadHeader(event->bytes)->seq);
    }
  }
  std::ranges::sort(seqs);
  EXPECT_EQ(seqs, UpTo(6));
}

TEST_F(Rotation, AClockThatIsSetBackDoesNotHoldUpTheNextLog) {
  params_.max_file_time = seconds(60);
  Service service = Make();
  now_ -= seconds(7200);
  service.AdvanceTo(now_);
  now_ += seconds(61);
  service.AdvanceTo(now_);
  service.Flush();
  EXPECT_EQ(Files().size(), 2U);
}

TEST_F(Rotation, StopsBeforeTheDiskIsFullDeletesNothingAndGoesOnWhenThereIsRoom) {
  std::atomic<std::int64_t> free_bytes = kPlenty;
  auto disk = RealDisk();
  disk.free_bytes = [&](const fs::path&) { return free_bytes.load(); };
  params_.reserve_bytes = 1'000'000;
  {
    Service service = Make(disk);
    Send(10);
    service.Flush();
    EXPECT_EQ(service.Report().state, HealthState::kOk);
    free_bytes = 1'000'100;
    Send(10);
    service.Flush();
    service.AdvanceTo(now_);
    service.Flush();
    const auto full = service.Report();
    EXPECT_EQ(full.state, HealthState::kFailed);
    EXPECT_EQ(full.reason.rfind("not recording: ", 0), 0U) << full.reason;
    EXPECT_NE(full.reason.find("1 MB are free"), std::string::npos) << full.reason;
    EXPECT_EQ(Count(service, "lost_disk_full"), 10);
    EXPECT_EQ(service.TakeWarnings().size(), 1U);
    EXPECT_EQ(Files().size(), 1U) << "no log is begun that could hold nothing";

    free_bytes = 3'000'000;  // a little more is not yet room
    service.AdvanceTo(now_);
    service.Flush();
    EXPECT_EQ(service.Report().state, HealthState::kFailed);

    free_bytes = 3'500'000;
    service.AdvanceTo(now_);
    service.Flush();
    EXPECT_EQ(service.Report().state, HealthState::kDegraded);
    EXPECT_EQ(service.Report().reason.rfind("recording again; 10 events lost", 0), 0U) << service.Report().reason;
    Send(10);
  }
  ASSERT_EQ(Files().size(), 2U);
  auto expected = UpTo(30);
  expected.erase(expected.begin() + 10, expected.begin() + 20);
  EXPECT_EQ(Recorded(), expected);
}

TEST_F(Rotation, OnADiskWithoutRoomAtTheStartWaitsForIt) {
  std::atomic<std::int64_t> free_bytes = 5;
  auto disk = RealDisk();
  disk.free_bytes = [&](const fs::path&) { return free_bytes.load(); };
  params_.reserve_bytes = 1000;
  Service service = Make(disk);
  EXPECT_EQ(service.Report().state, HealthState::kFailed);
  EXPECT_TRUE(Files().empty());
  free_bytes = kPlenty;
  service.AdvanceTo(now_);
  service.Flush();
  EXPECT_EQ(service.Report().state, HealthState::kOk) << service.Report().reason;
  EXPECT_EQ(Files().size(), 1U);
}

// Half of a block is taken, then nothing: as a real disk does when it is full.
TEST_F(Rotation, ATornWriteIsCutOffAndWhatItHeldIsCounted) {
  std::atomic<bool> is_broken = false;
  auto disk = RealDisk();
  disk.write = [&](int descriptor, const void* data, std::size_t size) -> ssize_t {
    if (!is_broken) return ::write(descriptor, data, size);
    if (size > 700) return ::write(descriptor, data, 700);
    errno = ENOSPC;
    return -1;
  };
  {
    Service service = Make(disk);
    Send(10);
    service.Flush();
    is_broken = true;
    Send(3);
    service.Flush();
    EXPECT_EQ(Count(service, "lost"), 3);
    EXPECT_EQ(Count(service, "write_faults"), 1);
    is_broken = false;
    service.AdvanceTo(now_);
    Send(2);
  }
  EXPECT_EQ(Files().size(), 2U);
  auto expected = UpTo(15);
  expected.erase(expected.begin() + 10, expected.begin() + 13);
  EXPECT_EQ(Recorded(), expected);
}

// The disk takes half of the first block, again and again.
TEST_F(Rotation, AttemptsThatFailInTheirFirstBlockLeaveNoFile) {
  std::atomic<bool> is_broken = false;
  auto disk = RealDisk();
  disk.write = [&](int descriptor, const void* data, std::size_t size) -> ssize_t {
    if (!is_broken) return ::write(descriptor, data, size);
    if (size > 20) return ::write(descriptor, data, 20);
    errno = ENOSPC;
    return -1;
  };
  Service service = Make(disk);
  Send(10);
  service.Flush();
  is_broken = true;
  Send(1);
  service.Flush();
  for (int i = 0; i < 5; ++i) {
    service.AdvanceTo(now_);
    service.Flush();
  }
  EXPECT_EQ(Files().size(), 1U);
  EXPECT_EQ(Count(service, "files"), 1);
  EXPECT_EQ(Count(service, "files_disturbed"), 0) << service.Report().reason;
  EXPECT_EQ(Count(service, "write_faults"), 6);
  is_broken = false;
  service.AdvanceTo(now_);
  Send(1);
  service.Flush();
  EXPECT_EQ(Recorded(), (std::vector<std::int64_t>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 11}));
}

// Cut by somebody, and the disk fails before the next look: zeros in the place of what was cut would count as recorded.
TEST_F(Rotation, AWriteFaultAfterACutMakesTheLogNoLongerAndCountsBoth) {
  std::atomic<bool> is_broken = false;
  std::int64_t kept_bytes = 0;
  bool is_cut = false;
  fs::path log;
  auto disk = RealDisk();
  disk.write = [&](int descriptor, const void* data, std::size_t size) -> ssize_t {
    if (!is_broken) return ::write(descriptor, data, size);
    if (!std::exchange(is_cut, true)) {
      fs::resize_file(log, static_cast<std::uintmax_t>(kept_bytes));
      return ::write(descriptor, data, 300);
    }
    errno = ENOSPC;
    return -1;
  };
  Service service = Make(disk);
  Send(10);
  service.Flush();
  kept_bytes = Count(service, "bytes");
  log = service.log_file();
  Send(20);
  service.Flush();
  is_broken = true;
  Send(1);
  service.Flush();
  EXPECT_EQ(static_cast<std::int64_t>(fs::file_size(log)), kept_bytes);
  EXPECT_EQ(Count(service, "events"), 11);
  EXPECT_EQ(Count(service, "bytes"), kept_bytes);
  EXPECT_EQ(Count(service, "lost"), 21);
  EXPECT_EQ(Count(service, "files_disturbed"), 1);
  EXPECT_EQ(Recorded(), UpTo(10));
}

TEST_F(Rotation, ALogIsWrittenOnWhereTheNextCannotBeMade) {
  Service service = Make();
  Send(10);
  service.Flush();
  const auto moved = folder_.string() + "_moved";
  fs::remove_all(moved);
  fs::rename(folder_, moved);
  std::ofstream(folder_.string()) << "no folder";  // to root nothing is forbidden
  Send(5);
  service.Rotate(now_);
  Send(5);
  service.Flush();
  EXPECT_EQ(Count(service, "lost"), 0);
  EXPECT_EQ(service.Report().state, HealthState::kDegraded);
  EXPECT_EQ(Count(service, "write_faults"), 1);
  const auto warnings = service.TakeWarnings();
  ASSERT_FALSE(warnings.empty());
  EXPECT_NE(warnings.back().find("is written on"), std::string::npos) << warnings.back();
  fs::remove(folder_);
  service.AdvanceTo(now_);
  Send(5);
  service.Flush();
  EXPECT_EQ(Count(service, "lost"), 0);
  EXPECT_EQ(Recorded(), (std::vector<std::int64_t>{20, 21, 22, 23, 24}));
  std::vector<std::int64_t> seqs;
  for (const auto& entry : fs::directory_iterator(moved)) {
    bus::LogReader reader(entry.path());
    while (const auto event = reader.Next()) {
      if (event->channel == bus::kPose.name) seqs.push_back(bus::ReadHeader(event->bytes)->seq);
    }
    EXPECT_EQ(reader.num_damaged(), 0);
  }
  EXPECT_EQ(seqs, UpTo(20));
  fs::remove_all(moved);
}

TEST_F(Rotation, WhatTheDiskCouldNotKeepIsLost) {
  std::atomic<bool> is_broken = false;
  auto disk = RealDisk();
  disk.sync = [&](int) {
    errno = EIO;
    return is_broken ? -1 : 0;
  };
  Service service = Make(disk);
  Send(10);
  service.Flush();
  const auto kept_bytes = Count(service, "bytes");
  is_broken = true;
  Send(4);
  service.Flush();
  EXPECT_EQ(Count(service, "lost"), 4);
  EXPECT_EQ(Count(service, "bytes"), kept_bytes);
  EXPECT_GT(Count(service, "lost_bytes"), 0);
  EXPECT_EQ(service.Report().state, HealthState::kFailed);
  is_broken = false;
  service.AdvanceTo(now_);
  service.Flush();
  EXPECT_EQ(service.Report().state, HealthState::kDegraded);
}

// A disk that stands still until it is let go.
class StandingDisk {
 public:
  Disk Make() {
    auto disk = RealDisk();
    disk.write = [this](int descriptor, const void* data, std::size_t size) {
      std::unique_lock lock(mutex_);
      moves_.wait(lock, [this] { return !stands_; });
      return ::write(descriptor, data, size);
    };
    return disk;
  }
  void Stand(bool stands) {
    const std::lock_guard lock(mutex_);
    stands_ = stands;
    moves_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable moves_;
  bool stands_ = false;
};

TEST_F(Rotation, ADiskThatStandsStillHoldsUpNobodyAndLosesNothingThatTheQueueHolds) {
  StandingDisk standing;
  Service service = Make(standing.Make());
  standing.Stand(true);
  Send(2000);  // returns: the receiver does not wait
  service.AdvanceTo(now_);
  service.Rotate(now_);
  Send(1000);
  EXPECT_GT(Count(service, "queue_bytes"), 1'000'000);
  EXPECT_EQ(service.Report().state, HealthState::kOk) << service.Report().reason;
  standing.Stand(false);
  service.Flush();
  EXPECT_EQ(Count(service, "lost"), 0);
  EXPECT_EQ(Count(service, "queue_bytes"), 0);
  EXPECT_GT(Count(service, "queue_peak_bytes"), 1'000'000);
  EXPECT_EQ(Recorded(), UpTo(3000));
}

TEST_F(Rotation, BeyondTheQueueEventsAreCountedNotKept) {
  StandingDisk standing;
  params_.queue_bytes = 1'000'000;
  Service service = Make(standing.Make());
  standing.Stand(true);
  Send(5000);
  const auto num_lost = Count(service, "lost_queue_full");
  EXPECT_GT(num_lost, 1000);
  EXPECT_LE(Count(service, "queue_peak_bytes"), 1'000'000);
  ASSERT_EQ(service.TakeWarnings().size(), 1U);
  EXPECT_TRUE(service.TakeWarnings().empty());
  standing.Stand(false);
  service.Flush();
  EXPECT_EQ(service.Report().state, HealthState::kDegraded);
  Send(1);
  service.Flush();
  const auto recorded = Recorded();
  EXPECT_EQ(static_cast<std::int64_t>(recorded.size()), 5001 - num_lost) << "each is there or counted";
  EXPECT_EQ(recorded.back(), 5000) << "in the same log, which is whole";
}

// A file that is deleted takes what was in it with it, however well the writes went.
TEST_F(Rotation, ALogThatIsDeletedIsFollowedByAnother) {
  Service service = Make();
  Send(10);
  service.Flush();
  EXPECT_EQ(Count(service, "events"), 11);
  const auto num_bytes = Count(service, "bytes");
  fs::remove_all(folder_.path());
  service.Flush();
  EXPECT_EQ(service.Report().state, HealthState::kFailed);
  EXPECT_NE(service.Report().reason.find("was deleted while it was recorded: 11 events"), std::string::npos) << service.Report().reason;
  EXPECT_EQ(Count(service, "events"), 0);
  EXPECT_EQ(Count(service, "bytes"), 0);
  EXPECT_EQ(Count(service, "lost"), 11);
  EXPECT_EQ(Count(service, "lost_bytes"), num_bytes);
  EXPECT_EQ(Count(service, "files_disturbed"), 1);
  service.AdvanceTo(now_);
  service.Flush();
  Send(1);
  service.Flush();
  EXPECT_EQ(Recorded(), (std::vector<std::int64_t>{10}));
  EXPECT_EQ(service.Report().state, HealthState::kDegraded);
  EXPECT_EQ(service.TakeWarnings().size(), 1U);
}

TEST_F(Rotation, ALogThatIsReplacedByAnotherFileIsLostAndTheOtherFileIsLeftAlone) {
  Service service = Make();
  Send(10);
  service.Flush();
  const auto log = service.log_file();
  std::ofstream(folder_ / "other") << "another file";
  fs::rename(folder_ / "other", log);
  service.Flush();
  EXPECT_NE(service.Report().reason.find("was replaced by another file"), std::string::npos) << service.Report().reason;
  EXPECT_EQ(Count(service, "lost"), 11);
  service.AdvanceTo(now_);
  Send(1);
  service.Flush();
  EXPECT_NE(service.log_file(), log);
  EXPECT_EQ(fs::file_size(log), 12U);
}

// Writes beyond the end of a file that was cut would have left a hole, and nobody would have known.
TEST_F(Rotation, ALogThatIsCutIsFollowedByAnotherAndWhatItLostIsCounted) {
  Service service = Make();
  Send(10);
  service.Flush();
  const auto kept = Count(service, "bytes");
  Send(20);
  service.Flush();
  const auto log = service.log_file();
  const auto size = static_cast<std::int64_t>(fs::file_size(log));
  fs::resize_file(log, static_cast<std::uintmax_t>(kept));
  Send(5);  // goes to the end of what is left
  service.Flush();
  EXPECT_EQ(Count(service, "lost"), 20);
  EXPECT_EQ(Count(service, "lost_bytes"), size - kept);
  EXPECT_EQ(Count(service, "events"), 1 + 15);
  EXPECT_EQ(service.Report().state, HealthState::kDegraded);
  EXPECT_NE(service.Report().reason.find("was cut from "), std::string::npos) << service.Report().reason;
  service.AdvanceTo(now_);
  Send(5);
  service.Flush();
  ASSERT_EQ(Files().size(), 2U);
  std::vector<std::int64_t> seqs;
  for (const auto& file : Files()) {
    bus::LogReader reader(file);
    while (const auto event = reader.Next()) {
      if (event->channel == bus::kPose.name) seqs.push_back(bus::ReadHeader(event->bytes)->seq);
    }
    EXPECT_EQ(reader.num_damaged(), 0);
  }
  auto expected = UpTo(40);
  expected.erase(expected.begin() + 10, expected.begin() + 30);
  EXPECT_EQ(seqs, expected);
  EXPECT_EQ(service.TakeWarnings().size(), 1U);
  EXPECT_TRUE(service.TakeWarnings().empty());
}

TEST_F(Rotation, ALogThatIsEmptiedIsLostWhole) {
  Service service = Make();
  Send(10);
  service.Flush();
  const auto num_bytes = Count(service, "bytes");
  fs::resize_file(service.log_file(), 0);
  service.Flush();
  EXPECT_EQ(Count(service, "lost"), 11);
  EXPECT_EQ(Count(service, "lost_bytes"), num_bytes);
  EXPECT_EQ(Count(service, "events"), 0);
}

TEST_F(Rotation, ALogThatIsRenamedLosesNothingAndIsFollowedByAnother) {
  Service service = Make();
  Send(10);
  service.Flush();
  const auto log = service.log_file();
  fs::rename(log, folder_ / "20270115T075959Z.lcmlog");
  Send(3);
  service.Flush();
  Send(3);
  service.AdvanceTo(now_);
  Send(4);
  service.Flush();
  EXPECT_EQ(Count(service, "lost"), 0);
  EXPECT_EQ(Count(service, "files_disturbed"), 1);
  EXPECT_EQ(Files().size(), 2U);
  EXPECT_EQ(Recorded(), UpTo(20));
  EXPECT_EQ(service.Report().state, HealthState::kDegraded);
  EXPECT_NE(service.Report().reason.find("was moved or renamed: what was recorded is in it"), std::string::npos) << service.Report().reason;
}

// The new folder may be on another disk: room is looked for there, before anything is written.
TEST_F(Rotation, AFolderThatIsRenamedIsMadeAnewAndItsReserveHolds) {
  const auto moved = folder_.string() + "_moved";
  fs::remove_all(moved);
  params_.reserve_bytes = 1'000'000;
  std::atomic<bool> is_asked_of_nothing = false;
  auto disk = RealDisk();
  disk.free_bytes = [&](const fs::path& folder) {
    if (!fs::exists(folder)) is_asked_of_nothing = true;
    return kPlenty;
  };
  Service service = Make(disk);
  Send(10);
  service.Flush();
  fs::rename(folder_, moved);
  service.Flush();
  service.AdvanceTo(now_);
  Send(5);
  service.Flush();
  EXPECT_EQ(Count(service, "lost"), 0);
  EXPECT_FALSE(is_asked_of_nothing);
  EXPECT_EQ(Recorded(), (std::vector<std::int64_t>{10, 11, 12, 13, 14}));
  const auto anew = std::exchange(folder_, fs::path(moved));
  EXPECT_EQ(Recorded(), UpTo(10));
  fs::remove_all(anew);
}

TEST_F(Rotation, ALogToWhichAnotherProgramWritesIsFollowedByAnother) {
  Service service = Make();
  Send(10);
  service.Flush();
  std::ofstream(service.log_file(), std::ios::app) << "words";
  service.Flush();
  EXPECT_NE(service.Report().reason.find("another program has written 5 bytes to it"), std::string::npos) << service.Report().reason;
  service.AdvanceTo(now_);
  Send(1);
  service.Flush();
  EXPECT_EQ(Files().size(), 2U);
  EXPECT_EQ(Count(service, "lost"), 0);
}

TEST_F(Rotation, ALogIsLockedWhileItIsRecorded) {
  Service service = Make();
  const int descriptor = open(service.log_file().c_str(), O_RDONLY);
  EXPECT_NE(flock(descriptor, LOCK_SH | LOCK_NB), 0);
  service.Rotate(now_);
  service.Flush();
  EXPECT_EQ(flock(descriptor, LOCK_SH | LOCK_NB), 0) << "no more, once the next has begun";
  close(descriptor);
}

TEST_F(Rotation, GapsInSeqAreCountedByChannel) {
  Service service = Make();
  Send(2);
  seq_ += 3;
  Send(1);
  nav_raw_t raw{};
  for (const std::int64_t seq : {0, 2}) {
    raw.seq = seq;
    bus::Publish(bus_, bus::kNavRaw, raw);
  }
  Send(0);
  EXPECT_EQ(Count(service, "missing"), 4);
  EXPECT_EQ(Count(service, "raw_missing"), 1);
  EXPECT_EQ(bus_.input_traffic()["POSE"].num_lost, 3);
  EXPECT_EQ(bus_.input_traffic()["POSE"].num_messages, 3);
  EXPECT_EQ(bus_.input_traffic()["NAV_RAW"].num_lost, 1);
}

}  // namespace
}  // namespace lookout::recorder
