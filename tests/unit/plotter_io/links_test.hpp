// Links at work, and plain sockets of this computer as the other side.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <thread>

#include "services/plotter/io/links.hpp"

namespace lookout::plotter {

using namespace std::chrono_literals;

class LinksTest : public ::testing::Test {
 protected:
  // Polls until it is so.
  bool Until(const std::function<bool()>& is_so, std::chrono::milliseconds longest = 4s) {
    const auto end = std::chrono::steady_clock::now() + longest;
    while (std::chrono::steady_clock::now() < end) {
      links_.Poll();
      if (is_so()) return true;
      std::this_thread::sleep_for(5ms);
    }
    return false;
  }
  void PollFor(std::chrono::milliseconds time) {
    Until([] { return false; }, time);
  }
  static std::int64_t Count(const Link& link, std::string_view name) {
    for (const auto& counter : link.counters()) {
      if (counter.name == name) return counter.count;
    }
    ADD_FAILURE() << "no counter " << name;
    return -1;
  }
  static bool Holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

  Links links_;
};

// A socket of this computer, TCP or UDP, IPv4 loopback.
class Socket {
 public:
  explicit Socket(int type) : descriptor_(socket(AF_INET, type | SOCK_CLOEXEC, 0)) {}
  static Socket Of(int descriptor) { return Socket(descriptor, 0); }
  ~Socket() { Close(); }
  Socket(Socket&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  Socket& operator=(Socket&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }
  void Close() {
    if (descriptor_ >= 0) close(descriptor_);
    descriptor_ = -1;
  }
  // The other side sees a reset.
  void Reset() {
    const linger at_once{1, 0};
    setsockopt(descriptor_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
    Close();
  }
  void Set(int option, int value) const { setsockopt(descriptor_, SOL_SOCKET, option, &value, sizeof value); }
  bool Bind(int port) const {
    Set(SO_REUSEADDR, 1);
    const auto address = Loopback(port);
    return bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  bool Listen() const { return listen(descriptor_, 16) == 0; }
  bool Connect(int port) const {
    const auto address = Loopback(port);
    return connect(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  int port() const {
    sockaddr_in address{};
    socklen_t size = sizeof address;
    getsockname(descriptor_, reinterpret_cast<sockaddr*>(&address), &size);
    return ntohs(address.sin_port);
  }
  // nobody within 2 s: -1
  Socket Accept() const { return Of(IsReadable(2000) ? accept(descriptor_, nullptr, nullptr) : -1); }
  bool IsReadable(int timeout_ms = 0) const {
    pollfd waiting{descriptor_, POLLIN, 0};
    return poll(&waiting, 1, timeout_ms) > 0;
  }
  void Write(const std::string& text) const {
    EXPECT_EQ(send(descriptor_, text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
  }
  // What is there now. `has_ended`: by an end or a reset.
  std::string Read() {
    std::string text;
    char bytes[65536];
    ssize_t size = 0;
    while ((size = recv(descriptor_, bytes, sizeof bytes, MSG_DONTWAIT)) > 0) text.append(bytes, static_cast<std::size_t>(size));
    has_ended_ = size == 0 || (errno != EAGAIN && errno != EWOULDBLOCK);
    was_reset_ = size < 0 && errno == ECONNRESET;
    return text;
  }
  bool has_ended() const { return has_ended_; }
  bool was_reset() const { return was_reset_; }
  int descriptor() const { return descriptor_; }

 private:
  Socket(int descriptor, int) : descriptor_(descriptor) {}
  static sockaddr_in Loopback(int port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
  }

  int descriptor_ = -1;
  bool has_ended_ = false;
  bool was_reset_ = false;
};

// A port of this computer at which nobody is.
inline int FreePort(int type = SOCK_STREAM) {
  const Socket socket(type);
  EXPECT_TRUE(socket.Bind(0));
  return socket.port();
}

}  // namespace lookout::plotter
