// What systemd hears of a process.
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <gtest/gtest.h>
#include <string>

#include "common/runtime/health.hpp"
#include "common/runtime/process.hpp"
#include "tests/support/files.hpp"

namespace lookout::runtime {
namespace {

// The supervisor's end of NOTIFY_SOCKET.
class Notify : public ::testing::Test {
 protected:
  support::TempDir folder_;
  std::filesystem::path path_ = folder_ / "notify";
  int socket_ = -1;

  void SetUp() override {
    socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path_.c_str(), sizeof address.sun_path - 1);
    ASSERT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    setenv("NOTIFY_SOCKET", path_.c_str(), 1);
  }
  void TearDown() override {
    unsetenv("NOTIFY_SOCKET");
    close(socket_);
  }

  // The next message, empty when there is none.
  std::string Next() const {
    std::array<char, 4096> buffer{};
    const auto size = recv(socket_, buffer.data(), buffer.size(), 0);
    return size > 0 ? std::string(buffer.data(), static_cast<std::size_t>(size)) : "";
  }
};

health_t Health(std::int32_t state, const std::string& reason) {
  health_t message{};
  message.state = state;
  message.reason = reason;
  return message;
}

TEST_F(Notify, TellsStateAndReasonAndFeedsTheWatchdog) {
  NotifyAlive(Health(health_t::STATE_OK, ""));
  EXPECT_EQ(Next(), "WATCHDOG=1\nSTATUS=ok");
  NotifyAlive(Health(health_t::STATE_DEGRADED, "no heading"));
  EXPECT_EQ(Next(), "WATCHDOG=1\nSTATUS=degraded: no heading");
  NotifyAlive(Health(health_t::STATE_FAILED, "not recording"));
  EXPECT_EQ(Next(), "WATCHDOG=1\nSTATUS=failed: not recording");
}

// A reason holds texts from outside (names of devices, errors): none of them may give systemd orders.
TEST_F(Notify, AReasonCannotAddALine) {
  NotifyAlive(Health(health_t::STATE_DEGRADED, "bad\nMAINPID=1"));
  EXPECT_EQ(Next(), "WATCHDOG=1\nSTATUS=degraded: bad MAINPID=1");
}

TEST_F(Notify, IsReadyWhenItsLoopBeginsAndNotBefore) {
  Process process("test", "memq://");
  EXPECT_EQ(Next(), "");
  std::string at_first_turn;
  process.Every(std::chrono::milliseconds(1), [&] {
    at_first_turn = Next();
    process.Stop();
  });
  process.Run([] { return HealthReport{}; });
  EXPECT_EQ(at_first_turn, "READY=1\nSTATUS=started");
}

TEST_F(Notify, NothingIsSentWithoutASupervisor) {
  unsetenv("NOTIFY_SOCKET");
  NotifyReady();
  NotifyAlive(Health(health_t::STATE_OK, ""));
  EXPECT_EQ(Next(), "");
}

}  // namespace
}  // namespace lookout::runtime
