// lookout-top on a live bus: as text for scripts, and on a terminal (a pseudo terminal) with a person's keys.
#include <poll.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <atomic>
#include <gtest/gtest.h>
#include <random>
#include <thread>

#include "common/bus/lcm_bus.hpp"
#include "lookout/alerts_t.hpp"
#include "lookout/health_t.hpp"
#include "lookout/obstacles_t.hpp"
#include "tests/support/child.hpp"
#include "tests/support/files.hpp"

namespace lookout::system_test {
namespace {

using namespace support;
using std::chrono::milliseconds;
using std::chrono::seconds;

const std::string kProgram = Bin("top");

// A bus with an alert, an obstacle 4.5 m ahead, and rubbish on every channel.
class Talk {
 public:
  Talk() : thread_([this] { Run(); }) {}
  ~Talk() {
    is_stopping_ = true;
    thread_.join();
  }
  Talk(const Talk&) = delete;
  Talk& operator=(const Talk&) = delete;

 private:
  void Run() {
    bus::LcmBus lcm(bus::DefaultLcmUrl());
    std::mt19937 random(1);
    health_t health{};
    health.process = "georeferencer";
    alerts_t alerts{};
    alerts.num_alerts = 1;
    alerts.alerts.resize(1);
    alerts.alerts[0].id = 1;
    alerts.alerts[0].cause = alert_t::CAUSE_GUARD_ZONE;
    alerts.alerts[0].level = alert_t::LEVEL_WARNING;
    alerts.alerts[0].state = alert_t::STATE_ACTIVE;
    alerts.alerts[0].text = "obstacle in the guard zone: 4.5 m, 12 deg to port";
    obstacles_t obstacles{};
    obstacles.num_parts = 1;
    obstacles.num_obstacles = 1;
    obstacles.obstacles.resize(1);
    obstacles.obstacles[0].id = 7;
    obstacles.obstacles[0].range_m = 4.5F;
    for (; !is_stopping_; ++health.seq, ++obstacles.seq, ++alerts.seq) {
      bus::Publish(lcm, bus::kHealth, health);
      bus::Publish(lcm, bus::kObstacles, obstacles);
      bus::Publish(lcm, bus::kAlerts, alerts);
      for (const auto& channel : bus::kChannels) {
        std::vector<std::uint8_t> rubbish(random() % 100);
        for (auto& byte : rubbish) byte = static_cast<std::uint8_t>(random());
        lcm.Publish(channel, rubbish);
      }
      std::this_thread::sleep_for(milliseconds(50));
    }
  }

  std::atomic<bool> is_stopping_ = false;
  std::thread thread_;
};

// A program on a terminal of its own, ended when the test ends.
class OnTerminal {
 public:
  explicit OnTerminal(const char* kind) {
    const winsize size{24, 80, 0, 0};
    pid_ = forkpty(&terminal_, nullptr, nullptr, &size);
    if (pid_ == 0) {
      setenv("TERM", kind, 1);
      execl(kProgram.c_str(), kProgram.c_str(), nullptr);
      _exit(127);
    }
  }
  ~OnTerminal() {
    if (!exit_code_) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
    close(terminal_);
  }
  OnTerminal(const OnTerminal&) = delete;
  OnTerminal& operator=(const OnTerminal&) = delete;

  /// Reads on until `piece` was printed since the last such call, at most for 20 s.
  bool Shows(const std::string& piece) {
    const auto deadline = std::chrono::steady_clock::now() + seconds(20);
    while (std::chrono::steady_clock::now() < deadline) {
      const auto found = printed_.find(piece);
      if (found != std::string::npos) {
        printed_.erase(0, found + piece.size());
        return true;
      }
      if (!Read()) return false;
    }
    return false;
  }

  void Press(char key) const { EXPECT_EQ(write(terminal_, &key, 1), 1); }
  void Resize(unsigned short rows, unsigned short columns) const {
    const winsize size{rows, columns, 0, 0};
    EXPECT_EQ(ioctl(terminal_, TIOCSWINSZ, &size), 0);
  }
  void Signal(int signal) const { kill(pid_, signal); }

  /// Reads what is printed to the end. @return the exit code; -1 when a signal ended it or it did not end within 20 s
  int ExitCode() {
    const auto deadline = std::chrono::steady_clock::now() + seconds(20);
    while (!exit_code_ && std::chrono::steady_clock::now() < deadline) {
      int status = 0;
      Read();
      if (waitpid(pid_, &status, WNOHANG) == pid_) exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    while (Read()) {
    }
    return exit_code_.value_or(-1);
  }
  const std::string& printed() const { return printed_; }

 private:
  // @return false when the other side is gone, or silent for 0.1 s after its end
  bool Read() {
    pollfd descriptor{terminal_, POLLIN, 0};
    if (poll(&descriptor, 1, 100) <= 0) return !exit_code_;
    char buffer[4096];
    const auto size = read(terminal_, buffer, sizeof buffer);
    if (size > 0) printed_.append(buffer, static_cast<std::size_t>(size));
    return size > 0;
  }

  int terminal_ = -1;
  pid_t pid_ = -1;
  std::string printed_;
  std::optional<int> exit_code_;
};

// What xterm prints to give the screen of before back.
const std::string kScreenOfBefore = "\x1b[?1049l";

TEST(Top, OncePrintsTheBusAsText) {
  const Talk talk;
  const TempDir folder;
  const auto result = RunProgram({kProgram, "--once", "--seconds", "2"}, (folder / "out").string());
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(result.output.rfind("WARNING: obstacle in the guard zone: 4.5 m, 12 deg to port\n", 0), 0U) << result.output;
  EXPECT_NE(result.output.find("\nLIDAR_SCAN "), std::string::npos) << result.output;
  EXPECT_NE(result.output.find(" georeferencer ok "), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("  1     7     4.5  000"), std::string::npos) << result.output;
  EXPECT_EQ(result.output.find('\x1b'), std::string::npos);
}

TEST(Top, WithoutATerminalItSaysHowToDoWithout) {
  const TempDir folder;
  const auto result = RunProgram({kProgram}, (folder / "out").string());
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.output.find("--once"), std::string::npos) << result.output;
}

TEST(Top, ATerminalThatIsNotKnownIsAnError) {
  OnTerminal top("no-such-terminal");
  EXPECT_TRUE(top.Shows("'no-such-terminal' (TERM) is not known"));
  EXPECT_EQ(top.ExitCode(), 1);
}

TEST(Top, TakesANewSizeAndEndsOnQ) {
  const Talk talk;
  OnTerminal top("xterm");
  EXPECT_TRUE(top.Shows("12 deg to port"));
  EXPECT_TRUE(top.Shows("4.5  000"));
  // Narrower and lower: drawn anew, the alert still on top.
  top.Resize(10, 60);
  EXPECT_TRUE(top.Shows("12 deg to port"));
  top.Press('s');
  EXPECT_TRUE(top.Shows("nothing sure in sight"));
  top.Press('q');
  EXPECT_EQ(top.ExitCode(), 0);
  EXPECT_NE(top.printed().find(kScreenOfBefore), std::string::npos);
}

TEST(Top, EndsOnSigtermAndGivesTheTerminalBack) {
  OnTerminal top("xterm");
  EXPECT_TRUE(top.Shows("nothing on the bus"));
  top.Signal(SIGTERM);
  EXPECT_EQ(top.ExitCode(), 0);
  EXPECT_NE(top.printed().find(kScreenOfBefore), std::string::npos);
}

}  // namespace
}  // namespace lookout::system_test
