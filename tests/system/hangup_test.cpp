// SIGHUP: a config that is read again, or checked and kept, and a terminal that closes.
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <pty.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <thread>

#include "tests/system/sources.hpp"

namespace lookout::system_test {
namespace {

using namespace support;

// An interactive shell on a terminal of its own.
class Terminal {
 public:
  Terminal() {
    pid_ = forkpty(&descriptor_, nullptr, nullptr, nullptr);
    if (pid_ != 0) return;
    signal(SIGHUP, SIG_DFL);
    execlp("bash", "bash", "--norc", "-i", nullptr);
    _exit(127);
  }
  ~Terminal() {
    Close();
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  bool is_open() const { return pid_ > 0; }
  void Type(const std::string& line) const {
    EXPECT_EQ(write(descriptor_, (line + "\n").c_str(), line.size() + 1), static_cast<ssize_t>(line.size() + 1));
  }
  void Close() {
    if (descriptor_ >= 0) close(descriptor_);
    descriptor_ = -1;
  }

 private:
  pid_t pid_ = -1;
  int descriptor_ = -1;
};

// For this thread and what it starts. @return whether it may
bool RefuseCloseRange() {
  std::array<sock_filter, 4> program{{BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
                                      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_close_range, 0, 1),
                                      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EINVAL), BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)}};
  const sock_fprog filter{static_cast<unsigned short>(program.size()), program.data()};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) == 0;
}

class HangupTest : public SourcesTest {
 protected:
  std::string OutputFile() const { return (folder_ / "out").string(); }
  std::vector<std::string> Command() const { return {Program(), "--config", folder_.string()}; }
  std::string Text() const {
    std::ifstream in(OutputFile());
    return {std::istreambuf_iterator<char>(in), {}};
  }
  // What /proc says behind a key of the status of the child.
  std::string Status(const std::string& key) const {
    std::ifstream status("/proc/" + std::to_string(child_->pid()) + "/status");
    for (std::string line; std::getline(status, line);) {
      if (line.rfind(key, 0) == 0) return line.substr(line.find_first_not_of(" \t", key.size()));
    }
    return {};
  }
  // Stops the child after it has blocked its signals, and before it reads them. @return false when it was past that
  bool HoldAtItsStart() {
    const auto is_stopped = [this] { return Status("State:").rfind('T', 0) == 0; };
    const auto blocked = [this] { return std::stoull("0" + Status("SigBlk:"), nullptr, 16); };
    const auto reads_signals = [this] {
      std::error_code error;
      for (const auto& entry : fs::directory_iterator("/proc/" + std::to_string(child_->pid()) + "/fd", error)) {
        if (fs::read_symlink(entry.path(), error).string().find("signalfd") != std::string::npos) return true;
      }
      return false;
    };
    for (;;) {
      child_->Signal(SIGSTOP);
      if (!WaitUntil(is_stopped, seconds(5))) return false;
      if (reads_signals()) break;
      if ((blocked() >> (SIGHUP - 1) & 1) != 0) return true;
      child_->Signal(SIGCONT);
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
    child_->Signal(SIGCONT);
    return false;
  }
  // As many starts as that, and no more.
  bool WaitForStarts(int count) {
    const auto num_starts = [this] {
      const auto text = Text();
      int num = 0;
      for (auto place = text.find(": starts, version"); place != std::string::npos; place = text.find(": starts, version", place + 1)) ++num;
      return num;
    };
    return WaitUntil([&] { return num_starts() >= count; }) && num_starts() == count;
  }
  static std::ptrdiff_t NumOpen(pid_t pid) {
    return std::distance(fs::directory_iterator("/proc/" + std::to_string(pid) + "/fd"), fs::directory_iterator{});
  }
  // Also when nobody has asked for its exit code.
  static bool HasEnded(pid_t pid) {
    std::error_code error;
    return fs::read_symlink("/proc/" + std::to_string(pid) + "/exe", error).empty();
  }
};

TEST_F(HangupTest, AHangupWithAWrongConfigGoesOnAndWithARightOneStartsAgain) {
  const std::string config = "source: UDP bind_address: '0.0.0.0' cut_azimuth_deg: ";
  Start(config + "0");
  ASSERT_TRUE(WaitForOutput("starts"));
  const Lidar lidar("127.0.0.1", "127.0.0.1");
  ASSERT_TRUE(WaitForScans(3));
  ASSERT_TRUE(WaitUntil([&] { return health_.pid != 0; }));
  const auto pid = health_.pid;
  ASSERT_EQ(starts_, (std::vector<std::int64_t>{0}));

  WriteConfig(config + "400 receive_buffer_bytes: 1");
  child_->Signal(SIGHUP);
  EXPECT_TRUE(WaitForOutput("the old one stays in force"));
  for (const char* fault : {"cut_azimuth_deg: must be", "receive_buffer_bytes: must be"}) {
    EXPECT_NE(child_->Output().find(fault), std::string::npos) << child_->Output();
  }
  EXPECT_TRUE(WaitForScans(3));
  EXPECT_EQ(starts_.size(), 1U);
  EXPECT_EQ(num_ends_, 0);

  // What only opening the sources tells: no such interface, a port that is taken.
  const Lidar other("127.0.0.1", "127.0.0.1");  // holds a port
  for (const auto& fault : {std::string("interface: 'eht0'"), "data_port: " + std::to_string(other.port())}) {
    const auto length = child_->Output().size();
    WriteConfig(config + "90 " + fault);
    child_->Signal(SIGHUP);
    EXPECT_TRUE(WaitUntil([&] { return child_->Output().find("the old one stays in force", length) != std::string::npos; })) << child_->Output();
  }
  EXPECT_TRUE(WaitForScans(3));
  EXPECT_EQ(starts_.size(), 1U);
  std::ptrdiff_t num_open = 0;

  for (int round = 1; round <= 3; ++round) {
    WriteConfig(config + std::to_string(90 * round));
    child_->Signal(SIGHUP);
    ASSERT_TRUE(WaitUntil([&] { return starts_.size() == static_cast<std::size_t>(round + 1); })) << child_->Output();
    EXPECT_EQ(starts_.back(), 0);
    EXPECT_EQ(num_ends_, round);
    health_ = {};
    EXPECT_TRUE(WaitForScans(3));
    EXPECT_TRUE(WaitUntil([&] { return health_.pid == pid; })) << health_.pid;
    // Nothing of the start before is left open. The first one had what it inherited from this test.
    if (round == 1) num_open = NumOpen(pid);
    EXPECT_EQ(NumOpen(pid), num_open);
  }
  EXPECT_EQ(child_->Terminate().value_or(-1), 0) << child_->Output();
}

TEST_F(HangupTest, ThoseWithoutSourcesCheckANewConfigAndKeepTheOldOne) {
  for (const std::string name : {"segmenter", "georeferencer", "tracker", "plotter", "page"}) {
    const auto file = folder_ / (name + ".txtpb");
    fs::copy_file(kDemoConfig / "segmenter.txtpb", folder_ / "segmenter.txtpb", fs::copy_options::overwrite_existing);  // which the tracker reads too
    fs::copy_file(kDemoConfig / (name + ".txtpb"), file, fs::copy_options::overwrite_existing);
    child_ = std::make_unique<Child>(std::vector<std::string>{Bin(name), "--config", folder_.string()}, OutputFile());
    ASSERT_TRUE(WaitForOutput("starts"));
    child_->Signal(SIGHUP);
    EXPECT_TRUE(WaitForOutput("it takes effect at the next start")) << child_->Output();
    std::ofstream(file) << "\nno_such_field: 1\n";
    child_->Signal(SIGHUP);
    EXPECT_TRUE(WaitForOutput("the new config is wrong; the old one stays in force")) << child_->Output();
    EXPECT_NE(child_->Output().find(name + ".txtpb:2: "), std::string::npos) << child_->Output();
    health_ = {};
    EXPECT_TRUE(WaitUntil([&] { return health_.pid == child_->pid(); })) << "it ended";
    EXPECT_TRUE(WaitForStarts(1)) << child_->Output();
    EXPECT_EQ(child_->Terminate().value_or(-1), 0) << child_->Output();
  }
}

TEST_F(HangupTest, ATerminationDuringANewStartIsNotLost) {
  Start("source: UDP bind_address: '0.0.0.0' cut_azimuth_deg: 0");
  ASSERT_TRUE(WaitForOutput("starts"));
  child_->Signal(SIGSTOP);
  child_->Signal(SIGHUP);
  child_->Signal(SIGTERM);
  child_->Signal(SIGCONT);
  EXPECT_EQ(child_->Wait(seconds(5)).value_or(-1), 0) << child_->Output();
  EXPECT_NE(child_->Output().find("starts again"), std::string::npos) << child_->Output();
}

TEST_F(HangupTest, AHangupBeforeTheProcessIsReadyDoesNotEndIt) {
  WriteConfig("source: UDP bind_address: '0.0.0.0' cut_azimuth_deg: 0");
  constexpr int kMaxTries = 200;
  bool is_held = false;
  for (int i = 0; i < kMaxTries && !is_held; ++i) {
    child_.reset();
    fs::remove(OutputFile());
    child_ = std::make_unique<Child>(Command(), OutputFile());
    is_held = HoldAtItsStart();
  }
  ASSERT_TRUE(is_held) << "never caught between blocking its signals and reading them";
  child_->Signal(SIGHUP);
  child_->Signal(SIGCONT);
  EXPECT_TRUE(WaitForStarts(2)) << child_->Output();
  EXPECT_NE(child_->Output().find("starts again"), std::string::npos) << child_->Output();
}

// Before Linux 5.11 there is no CLOSE_RANGE_CLOEXEC.
TEST_F(HangupTest, ANewStartDoesNotNeedCloseRange) {
  WriteConfig("source: UDP bind_address: '0.0.0.0' cut_azimuth_deg: 0");
  // A thread, so that the filter ends with it.
  std::thread([this] {
    if (RefuseCloseRange()) child_ = std::make_unique<Child>(Command(), OutputFile());
  }).join();
  if (!child_) GTEST_SKIP() << "this computer does not permit filters of system calls";
  ASSERT_TRUE(WaitForStarts(1)) << child_->Output();
  std::ptrdiff_t num_open = 0;
  for (int round = 2; round <= 4; ++round) {
    child_->Signal(SIGHUP);
    ASSERT_TRUE(WaitForStarts(round)) << child_->Output();
    if (round == 2) num_open = NumOpen(child_->pid());  // the first start had what it inherited from this test
    EXPECT_EQ(NumOpen(child_->pid()), num_open);
  }
}

TEST_F(HangupTest, ItEndsWithItsTerminalAndNotBefore) {
  WriteConfig("source: UDP bind_address: '0.0.0.0' cut_azimuth_deg: 0");
  for (const std::string ground : {"", " &"}) {
    Terminal terminal;
    if (!terminal.is_open()) GTEST_SKIP() << "this computer gives no terminals";
    fs::remove(OutputFile());
    health_ = {};
    terminal.Type(Program() + " --config " + folder_.string() + " >" + OutputFile() + " 2>&1" + ground);
    ASSERT_TRUE(WaitUntil([&] { return health_.pid != 0; })) << Text();
    const auto pid = health_.pid;
    kill(pid, SIGHUP);
    ASSERT_TRUE(WaitForStarts(2)) << Text();
    terminal.Close();
    EXPECT_TRUE(WaitUntil([&] { return HasEnded(pid); }, seconds(5))) << Text();
    EXPECT_TRUE(WaitForStarts(2)) << Text();
    kill(pid, SIGKILL);  // when it did not
  }
}

TEST_F(HangupTest, UnderNohupItOutlivesItsTerminal) {
  WriteConfig("source: UDP bind_address: '0.0.0.0' cut_azimuth_deg: 0");
  Terminal terminal;
  if (!terminal.is_open()) GTEST_SKIP() << "this computer gives no terminals";
  terminal.Type("nohup " + Program() + " --config " + folder_.string() + " >" + OutputFile() + " 2>&1 &");
  ASSERT_TRUE(WaitUntil([&] { return health_.pid != 0; })) << Text();
  const auto pid = health_.pid;
  terminal.Close();
  WaitUntil([] { return false; }, seconds(1));
  const auto last_us = health_.utime_us;
  EXPECT_TRUE(WaitUntil([&] { return health_.utime_us > last_us; })) << Text();
  EXPECT_TRUE(WaitForStarts(1)) << Text();
  kill(pid, SIGTERM);
  EXPECT_TRUE(WaitUntil([&] { return HasEnded(pid); }, seconds(5))) << Text();
}

}  // namespace
}  // namespace lookout::system_test
