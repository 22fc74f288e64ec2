// lookout-recorder as a boat runs it: on loopback LCM, in a network namespace of its own, with what may happen to it.
#include <sys/mount.h>
#include <sys/statvfs.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <gtest/gtest.h>
#include <lcm/eventlog.h>
#include <map>
#include <memory>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/decode.hpp"
#include "common/bus/lcm_bus.hpp"
#include "common/bus/log_file.hpp"
#include "lookout/health_counter_t.hpp"
#include "lookout/health_t.hpp"
#include "lookout/nav_raw_t.hpp"
#include "tests/support/child.hpp"
#include "tests/support/counters.hpp"
#include "tests/support/files.hpp"
#include "tests/support/live_bus.hpp"

namespace lookout::system_test {
namespace {

using namespace support;
namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;
using Clock = std::chrono::steady_clock;

class RecorderSystem : public ::testing::Test {
 protected:
  TempDir folder_;
  fs::path logs_;
  std::unique_ptr<Child> recorder_;
  std::unique_ptr<bus::LcmBus> bus_;
  std::int64_t seq_ = 0;

  void SetUp() override {
    logs_ = folder_ / "logs";
    fs::copy(kDemoConfig, folder_ / "config");
    bus_ = std::make_unique<bus::LcmBus>(bus::DefaultLcmUrl());
  }
  void TearDown() override { recorder_.reset(); }

  // Starts it and waits until it has its log, and takes what comes.
  void Start(const std::string& config = "reserve_bytes: 0") {
    std::ofstream(folder_ / "config/recorder.txtpb") << "log_folder: '" << logs_.string() << "'\n" << config << "\n";
    recorder_ =
        std::make_unique<Child>(std::vector<std::string>{Bin("recorder"), "--config", (folder_ / "config").string()}, (folder_ / "out").string());
    ASSERT_TRUE(WaitUntil([this] { return recorder_->Output().find(": starts, version") != std::string::npos; })) << recorder_->Output();
  }
  static bool WaitUntil(const std::function<bool()>& condition) {
    const auto deadline = Clock::now() + seconds(20);
    while (!condition()) {
      if (Clock::now() >= deadline) return false;
      std::this_thread::sleep_for(milliseconds(5));
    }
    return true;
  }
  void Send() {
    nav_raw_t message{};
    message.seq = seq_++;
    message.sentence = "$GPHDT,123.4,T*37";
    bus::Publish(*bus_, bus::kNavRaw, message);
  }

  std::vector<fs::path> Logs() const {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(logs_)) {
      if (entry.path().extension() == ".lcmlog") files.push_back(entry.path());
    }
    std::ranges::sort(files);
    return files;
  }
  // The seq of every NAV_RAW in the logs, in their order. LCM's own reader takes them; each begins with RUN_INFO.
  std::vector<std::int64_t> Recorded() const {
    std::vector<std::int64_t> seqs;
    for (const auto& file : Logs()) {
      lcm_eventlog_t* log = lcm_eventlog_create(file.c_str(), "r");
      bool is_first = true;
      while (lcm_eventlog_event_t* event = lcm_eventlog_read_next_event(log)) {
        EXPECT_TRUE(!is_first || std::string(event->channel) == "RUN_INFO") << file << ": " << event->channel;
        is_first = false;
        const Bytes bytes(static_cast<const std::uint8_t*>(event->data), static_cast<std::size_t>(event->datalen));
        if (event->channel == bus::kNavRaw.name) seqs.push_back(bus::ReadHeader(bytes)->seq);
        lcm_eventlog_free_event(event);
      }
      lcm_eventlog_destroy(log);
    }
    return seqs;
  }
  static std::vector<std::int64_t> UpTo(std::size_t count) {
    std::vector<std::int64_t> seqs(count);
    std::iota(seqs.begin(), seqs.end(), 0);
    return seqs;
  }
  std::int64_t RecordedBytes() const {
    std::int64_t sum = 0;
    for (const auto& file : Logs()) sum += static_cast<std::int64_t>(fs::file_size(file));
    return sum;
  }
};

// lcm-logger's queue holds 30.
TEST_F(RecorderSystem, BurstsOf150AreRecordedWhole) {
  Start();
  for (int burst = 1; burst <= 4; ++burst) {
    for (int i = 0; i < 150; ++i) Send();
    ASSERT_TRUE(WaitUntil([&] { return Recorded().size() == static_cast<std::size_t>(150 * burst); })) << Recorded().size();
  }
  EXPECT_EQ(recorder_->Terminate().value_or(-1), 0) << recorder_->Output();
  EXPECT_EQ(Recorded(), UpTo(600));
}

TEST_F(RecorderSystem, KilledAtAnyTimeItLosesNoMoreThanTheLastSecond) {
  Start();
  std::atomic<bool> stops = false;
  std::atomic<std::int64_t> num_sent = 0;
  std::vector<Clock::time_point> sent;
  std::thread sender([&] {
    while (!stops) {
      sent.push_back(Clock::now());
      Send();
      ++num_sent;
      std::this_thread::sleep_for(milliseconds(1));
    }
  });
  // Not just behind a hand-over to the disk: more than a second after one that was seen.
  EXPECT_TRUE(WaitUntil([&] { return Recorded().size() > 100; }));
  const auto goal = num_sent + 1500;
  EXPECT_TRUE(WaitUntil([&] { return num_sent > goal; }));
  const auto killed = Clock::now();
  recorder_->Signal(SIGKILL);
  EXPECT_EQ(recorder_->Wait(seconds(5)).value_or(-1), 128 + SIGKILL);
  stops = true;
  sender.join();
  const auto recorded = Recorded();
  EXPECT_EQ(recorded, UpTo(recorded.size()));
  const auto num_must = std::ranges::lower_bound(sent, killed - seconds(1)) - sent.begin();
  EXPECT_GE(static_cast<std::ptrdiff_t>(recorded.size()), num_must) << "of " << sent.size();
  bus::LogReader reader(Logs().front());
  std::size_t num_read = 0;
  while (const auto event = reader.Next()) num_read += event->channel == bus::kNavRaw.name ? 1 : 0;
  EXPECT_EQ(num_read, recorded.size()) << "LCM's reader and ours see the same";

  // The next start leaves that log as it is.
  const auto size = fs::file_size(Logs().front());
  Start();
  Send();
  EXPECT_TRUE(WaitUntil([&] { return Recorded().size() == recorded.size() + 1; }));
  EXPECT_EQ(recorder_->Terminate().value_or(-1), 0) << recorder_->Output();
  ASSERT_EQ(Logs().size(), 2U);
  EXPECT_EQ(fs::file_size(Logs().front()), size);
}

TEST_F(RecorderSystem, AHangupBeginsANewLogAndNothingIsLostOrDoubled) {
  Start();
  for (std::size_t num_logs = 2; num_logs <= 4; ++num_logs) {
    for (int i = 0; i < 50; ++i) Send();
    recorder_->Signal(SIGHUP);
    for (int i = 0; i < 50; ++i) Send();
    ASSERT_TRUE(WaitUntil([&] { return Logs().size() == num_logs && static_cast<std::int64_t>(Recorded().size()) == seq_; })) << Logs().size();
  }
  EXPECT_EQ(recorder_->Terminate().value_or(-1), 0) << recorder_->Output();
  EXPECT_EQ(Recorded(), UpTo(300));
  std::vector<std::int64_t> run_infos;
  for (const auto& file : Logs()) {
    bus::LogReader reader(file);
    while (const auto event = reader.Next()) {
      if (event->channel == "RUN_INFO") run_infos.push_back(bus::ReadHeader(event->bytes)->seq);
    }
    EXPECT_EQ(reader.num_damaged(), 0);
  }
  EXPECT_EQ(run_infos, UpTo(run_infos.size()));
}

// Raw channels through the recorder, in logs of 1 MB: they compute to what the one log computes to.
TEST_F(RecorderSystem, RotatedLogsReplayAsOne) {
  const auto config = (folder_ / "config").string();
  const auto file = [this](const char* name) { return (folder_ / name).string(); };
  const auto run = [&](const std::vector<std::string>& command) {
    const auto result = RunProgram(command, file("tool.out"));
    ASSERT_EQ(result.exit_code, 0) << result.output;
  };
  run({Bin("sim"), "--config", config, "--scene", "lake", "--seed", "4", "--seconds", "3", "--pcap", file("sim.pcap")});
  run({Bin("replay"), "--config", config, "--in", file("sim.pcap"), "--out", file("one")});
  Start("reserve_bytes: 0 max_file_bytes: 1000000");
  bus::LogReader reader(file("one"));
  std::int64_t num_sent_bytes = 0;
  std::int64_t num_waited_bytes = 0;
  while (const auto event = reader.Next()) {
    const auto* channel = bus::FindChannel(event->channel);
    if (channel == nullptr || !channel->is_raw) continue;
    bus_->Publish(*channel, event->bytes);
    num_sent_bytes += static_cast<std::int64_t>(event->bytes.size());
    // No more on the way than the smallest receive buffer of a kernel holds.
    if (num_sent_bytes - num_waited_bytes < 60'000) continue;
    num_waited_bytes = num_sent_bytes;
    ASSERT_TRUE(WaitUntil([&] { return RecordedBytes() >= num_sent_bytes; }));
  }
  EXPECT_EQ(recorder_->Terminate().value_or(-1), 0) << recorder_->Output();
  const auto logs = Logs();
  EXPECT_GE(logs.size(), 3U);
  std::vector<std::string> replay{Bin("replay"), "--config", config, "--out", file("again")};
  for (const auto& log : logs) {
    EXPECT_LE(fs::file_size(log), 1'000'000U);
    replay.insert(replay.end(), {"--in", log.string()});
  }
  run(replay);
  run({Bin("diff"), file("one"), file("again")});
  // And the tools see the rotated logs as one.
  std::vector<std::string> info{Bin("log"), "info"};
  std::vector<std::string> slice{Bin("log"), "slice", "--out", file("joined")};
  for (const auto& log : logs) {
    info.push_back(log.string());
    slice.insert(slice.end(), {"--in", log.string()});
  }
  run(info);
  run(slice);
  run({Bin("diff"), file("one"), file("joined"), "--channel", "NAV_RAW", "--channel", "LIDAR_PACKETS"});
  EXPECT_EQ(RunProgram({Bin("diff"), file("one"), file("joined")}, file("tool.out")).exit_code, 1) << "computed channels are only in one";
}

TEST_F(RecorderSystem, StopsBeforeTheDiskIsFullSaysSoAndGoesOnWhenThereIsRoom) {
  fs::create_directories(logs_);
  if (mount("tmpfs", logs_.c_str(), "tmpfs", 0, "size=8m") != 0) GTEST_SKIP() << "this computer does not permit to mount";
  const auto free_bytes = [this] {
    struct statvfs state {};
    statvfs(logs_.c_str(), &state);
    return static_cast<std::int64_t>(state.f_bavail * state.f_frsize);
  };
  std::ofstream(logs_ / "ballast") << std::string(4'000'000, 'x');
  health_t health{};
  bus::Subscribe<health_t>(*bus_, bus::kHealth, [&](const health_t& message) { health = message; });
  const auto wait_for = [&](std::int32_t state) { return HandleUntil(*bus_, [&] { return health.state == state; }); };
  Start("reserve_bytes: 2000000");
  // More than there is room for.
  const bus::Channel filler{"FILLER", "", "", 1, 1, false, false};
  for (int i = 0; i < 60; ++i) {
    bus_->Publish(filler, std::vector<std::uint8_t>(50'000));
    std::this_thread::sleep_for(milliseconds(2));
  }
  EXPECT_TRUE(wait_for(health_t::STATE_FAILED));
  EXPECT_EQ(health.reason.rfind("not recording: ", 0), 0U) << health.reason;
  EXPECT_GE(free_bytes(), 2'000'000);
  EXPECT_EQ(Logs().size(), 1U);
  EXPECT_GT(fs::file_size(Logs().front()), 1'000'000U);
  EXPECT_TRUE(fs::exists(logs_ / "ballast")) << "nothing is deleted";

  fs::remove(logs_ / "ballast");
  EXPECT_TRUE(wait_for(health_t::STATE_DEGRADED));
  EXPECT_EQ(health.reason.rfind("recording again; ", 0), 0U) << health.reason;
  Send();
  EXPECT_TRUE(WaitUntil([&] { return Recorded().size() == 1; }));
  EXPECT_EQ(recorder_->Terminate().value_or(-1), 0) << recorder_->Output();
  EXPECT_EQ(Logs().size(), 2U);
  for (const auto& log : Logs()) {
    bus::LogReader reader(log);
    while (reader.Next()) {
    }
    EXPECT_EQ(reader.num_damaged(), 0) << log;
  }
  EXPECT_EQ(umount2(logs_.c_str(), MNT_DETACH), 0);
}

// What was in a log that is cut or deleted used to count as recorded, with state ok.
TEST_F(RecorderSystem, SaysWhatBecameOfALogThatIsTouchedAndGoesOnInAnother) {
  health_t health{};
  bus::Subscribe<health_t>(*bus_, bus::kHealth, [&](const health_t& message) { health = message; });
  const auto wait_for = [&](const std::string& reason) {
    return HandleUntil(*bus_, [&] { return health.reason.find(reason) != std::string::npos; });
  };
  const auto count = [&](const std::string& name) { return CountOf(health, name); };
  const auto is_followed = [&](std::size_t num_logs) { return WaitUntil([&] { return Logs().size() == num_logs; }); };
  Start();
  for (int i = 0; i < 100; ++i) Send();
  ASSERT_TRUE(WaitUntil([&] { return Recorded().size() == 100; }));
  const auto first = Logs().front();
  health.state = health_t::STATE_STARTING;
  ASSERT_TRUE(HandleUntil(*bus_, [&] { return health.state == health_t::STATE_OK; })) << health.reason;

  fs::rename(first, folder_ / "moved");
  EXPECT_TRUE(is_followed(1));
  EXPECT_TRUE(wait_for("recording, nothing lost, but " + first.string() + ": was moved or renamed")) << health.reason;
  EXPECT_EQ(health.state, health_t::STATE_DEGRADED);
  EXPECT_EQ(count("lost"), 0);
  EXPECT_EQ(bus::LogReader(folder_ / "moved").size_bytes(), static_cast<std::int64_t>(fs::file_size(folder_ / "moved")));

  const auto second = Logs().front();
  for (int i = 0; i < 50; ++i) Send();
  ASSERT_TRUE(WaitUntil([&] { return Recorded().size() >= 50; }));
  fs::resize_file(second, 0);
  EXPECT_TRUE(is_followed(2));
  EXPECT_TRUE(wait_for("recording again; ")) << health.reason;
  EXPECT_NE(health.reason.find("was cut from "), std::string::npos) << health.reason;
  EXPECT_EQ(health.state, health_t::STATE_DEGRADED);
  EXPECT_GE(count("lost"), 50);
  EXPECT_GT(count("lost_bytes"), 0);
  EXPECT_EQ(count("files_disturbed"), 2);
  const auto num_lost = count("lost");

  fs::remove_all(logs_);
  EXPECT_TRUE(WaitUntil([&] { return fs::exists(logs_) && Logs().size() == 1; }));
  EXPECT_TRUE(wait_for("was deleted while it was recorded")) << health.reason;
  EXPECT_GT(count("lost"), num_lost);
  EXPECT_EQ(recorder_->Terminate().value_or(-1), 0) << recorder_->Output();
  for (const char* words : {"was moved or renamed", "was cut from ", "was deleted while it was recorded"}) {
    EXPECT_NE(recorder_->Output().find(words), std::string::npos) << recorder_->Output();
  }
}

}  // namespace
}  // namespace lookout::system_test
