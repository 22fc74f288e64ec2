// Logs that somebody deletes, replaces, cuts, renames or writes to while they are recorded: each event is in one log, or counted.
#include "tests/unit/recorder/rotation.hpp"

namespace lookout::recorder {
namespace {

// A file that is deleted takes what was in it with it, however well the writes went.
TEST_F(Rotation, ALogThatIsDeletedIsFollowedByAnother) {
  Service service = Make();
  Send(10);
  service.Flush();
  EXPECT_EQ(support::CountOf(service, "events"), 11);
  const auto num_bytes = support::CountOf(service, "bytes");
  fs::remove_all(folder_);
  service.Flush();
  EXPECT_EQ(service.Report().state, HealthState::kFailed);
  EXPECT_NE(service.Report().reason.find("was deleted while it was recorded: 11 events"), std::string::npos) << service.Report().reason;
  EXPECT_EQ(support::CountOf(service, "events"), 0);
  EXPECT_EQ(support::CountOf(service, "bytes"), 0);
  EXPECT_EQ(support::CountOf(service, "lost"), 11);
  EXPECT_EQ(support::CountOf(service, "lost_bytes"), num_bytes);
  EXPECT_EQ(support::CountOf(service, "files_disturbed"), 1);
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
  EXPECT_EQ(support::CountOf(service, "lost"), 11);
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
  const auto kept = support::CountOf(service, "bytes");
  Send(20);
  service.Flush();
  const auto log = service.log_file();
  const auto size = static_cast<std::int64_t>(fs::file_size(log));
  fs::resize_file(log, static_cast<std::uintmax_t>(kept));
  Send(5);  // goes to the end of what is left
  service.Flush();
  EXPECT_EQ(support::CountOf(service, "lost"), 20);
  EXPECT_EQ(support::CountOf(service, "lost_bytes"), size - kept);
  EXPECT_EQ(support::CountOf(service, "events"), 1 + 15);
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

// Of a long log it is known more coarsely where its events end: what is lost is never said to be less than it is.
TEST_F(Rotation, ALongLogThatIsCutSaysWhatItLostToAShareOfIt) {
  auto disk = RealDisk();
  disk.sync = [](int) { return 0; };
  Service service = Make(disk);
  constexpr int kNumBlocks = 9000;
  std::int64_t half_bytes = 0;
  for (int i = 0; i < kNumBlocks; ++i) {
    Send(1);
    service.Flush();
    if (i + 1 == kNumBlocks / 2) half_bytes = support::CountOf(service, "bytes");
    if (i == 4094) {  // all marks are made, and one more comes of what is cut off of another program's bytes
      std::ofstream(service.log_file(), std::ios::app) << "of another program";
      service.Flush();
      fs::resize_file(service.log_file(), fs::file_size(service.log_file()) - 1);
      service.Flush();
      EXPECT_EQ(support::CountOf(service, "lost"), 0);
    }
  }
  fs::resize_file(service.log_file(), static_cast<std::uintmax_t>(half_bytes));
  service.Flush();
  EXPECT_GE(support::CountOf(service, "lost"), kNumBlocks / 2);
  EXPECT_LE(support::CountOf(service, "lost"), kNumBlocks / 2 + 8);
  EXPECT_EQ(support::CountOf(service, "lost") + support::CountOf(service, "events"), kNumBlocks + 1);
}

TEST_F(Rotation, ALogThatIsEmptiedIsLostWhole) {
  Service service = Make();
  Send(10);
  service.Flush();
  const auto num_bytes = support::CountOf(service, "bytes");
  fs::resize_file(service.log_file(), 0);
  service.Flush();
  EXPECT_EQ(support::CountOf(service, "lost"), 11);
  EXPECT_EQ(support::CountOf(service, "lost_bytes"), num_bytes);
  EXPECT_EQ(support::CountOf(service, "events"), 0);
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
  EXPECT_EQ(support::CountOf(service, "lost"), 0);
  EXPECT_EQ(support::CountOf(service, "files_disturbed"), 1);
  EXPECT_EQ(Files().size(), 2U);
  EXPECT_EQ(Recorded(), UpTo(20));
  EXPECT_EQ(service.Report().state, HealthState::kDegraded);
  EXPECT_NE(service.Report().reason.find("was moved or renamed: what was recorded is in it"), std::string::npos) << service.Report().reason;
}

TEST_F(Rotation, ALogThatIsWrittenToTwiceCountsOnce) {
  Service service = Make();
  Send(10);
  service.Flush();
  for (int i = 0; i < 2; ++i) {
    std::ofstream(service.log_file(), std::ios::app) << "of another program";
    Send(1);
    service.Flush();
  }
  EXPECT_EQ(support::CountOf(service, "files_disturbed"), 1);
  EXPECT_EQ(support::CountOf(service, "lost"), 0);
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
  EXPECT_EQ(support::CountOf(service, "lost"), 0);
  EXPECT_FALSE(is_asked_of_nothing);
  EXPECT_EQ(Recorded(), (std::vector<std::int64_t>{10, 11, 12, 13, 14}));
  fs::remove_all(folder_);
  fs::rename(moved, folder_);
  EXPECT_EQ(Recorded(), UpTo(10));
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
  EXPECT_EQ(support::CountOf(service, "lost"), 0);
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

}  // namespace
}  // namespace lookout::recorder
