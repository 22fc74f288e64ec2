// Logs that follow each other, and disks with faults: each event is in one log, or counted.
#include "tests/unit/recorder/rotation.hpp"

namespace lookout::recorder {
namespace {

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
    EXPECT_EQ(support::CountOf(service, "lost"), 0);
    EXPECT_EQ(support::CountOf(service, "files"), static_cast<std::int64_t>(Files().size()));
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
    EXPECT_EQ(support::CountOf(service, "lost_disk_full"), 10);
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
    EXPECT_EQ(support::CountOf(service, "lost"), 3);
    EXPECT_EQ(support::CountOf(service, "write_faults"), 1);
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
  EXPECT_EQ(support::CountOf(service, "files"), 1);
  EXPECT_EQ(support::CountOf(service, "files_disturbed"), 0) << service.Report().reason;
  EXPECT_EQ(support::CountOf(service, "write_faults"), 6);
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
  kept_bytes = support::CountOf(service, "bytes");
  log = service.log_file();
  Send(20);
  service.Flush();
  is_broken = true;
  Send(1);
  service.Flush();
  EXPECT_EQ(static_cast<std::int64_t>(fs::file_size(log)), kept_bytes);
  EXPECT_EQ(support::CountOf(service, "events"), 11);
  EXPECT_EQ(support::CountOf(service, "bytes"), kept_bytes);
  EXPECT_EQ(support::CountOf(service, "lost"), 21);
  EXPECT_EQ(support::CountOf(service, "files_disturbed"), 1);
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
  EXPECT_EQ(support::CountOf(service, "lost"), 0);
  EXPECT_EQ(service.Report().state, HealthState::kDegraded);
  EXPECT_EQ(support::CountOf(service, "write_faults"), 1);
  const auto warnings = service.TakeWarnings();
  ASSERT_FALSE(warnings.empty());
  EXPECT_NE(warnings.back().find("is written on"), std::string::npos) << warnings.back();
  fs::remove(folder_);
  service.AdvanceTo(now_);
  Send(5);
  service.Flush();
  EXPECT_EQ(support::CountOf(service, "lost"), 0);
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
  const auto kept_bytes = support::CountOf(service, "bytes");
  const auto num_kept = support::CountOf(service, "events");
  is_broken = true;
  Send(4);
  service.Flush();
  EXPECT_EQ(support::CountOf(service, "lost"), 4);
  EXPECT_EQ(support::CountOf(service, "bytes"), kept_bytes);
  EXPECT_EQ(support::CountOf(service, "events"), num_kept);
  EXPECT_GT(support::CountOf(service, "lost_bytes"), 0);
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
  EXPECT_GT(support::CountOf(service, "queue_bytes"), 1'000'000);
  EXPECT_EQ(service.Report().state, HealthState::kOk) << service.Report().reason;
  // Two seconds, the time after which it says so.
  while (service.Report().state == HealthState::kOk) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(service.Report().state, HealthState::kFailed);
  EXPECT_TRUE(service.Report().reason.starts_with("not recording: the disk has stood still for 2 s; ")) << service.Report().reason;
  standing.Stand(false);
  service.Flush();
  EXPECT_EQ(service.Report().state, HealthState::kOk) << service.Report().reason;
  EXPECT_EQ(support::CountOf(service, "lost"), 0);
  EXPECT_EQ(support::CountOf(service, "queue_bytes"), 0);
  EXPECT_GT(support::CountOf(service, "queue_peak_bytes"), 1'000'000);
  EXPECT_EQ(Recorded(), UpTo(3000));
}

TEST_F(Rotation, BeyondTheQueueEventsAreCountedNotKept) {
  StandingDisk standing;
  params_.queue_bytes = 1'000'000;
  Service service = Make(standing.Make());
  standing.Stand(true);
  Send(5000);
  const auto num_lost = support::CountOf(service, "lost_queue_full");
  EXPECT_GT(num_lost, 1000);
  EXPECT_LE(support::CountOf(service, "queue_peak_bytes"), 1'000'000);
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
  EXPECT_EQ(support::CountOf(service, "missing"), 4);
  EXPECT_EQ(support::CountOf(service, "raw_missing"), 1);
  EXPECT_EQ(bus_.input_traffic()["POSE"].num_lost, 3);
  EXPECT_EQ(bus_.input_traffic()["POSE"].num_messages, 3);
  EXPECT_EQ(bus_.input_traffic()["NAV_RAW"].num_lost, 1);
}

}  // namespace
}  // namespace lookout::recorder
