// Plain sockets of this computer, as the other side of what is tested.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <gtest/gtest.h>
#include <span>
#include <string>
#include <utility>

namespace lookout::support {

inline sockaddr_in Ipv4(const std::string& address, int port) {
  sockaddr_in result{};
  result.sin_family = AF_INET;
  result.sin_port = htons(static_cast<std::uint16_t>(port));
  inet_pton(AF_INET, address.c_str(), &result.sin_addr);
  return result;
}

/// TCP or UDP, IPv4. Where no address is named it is that of loopback.
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
  /// The other side sees a reset.
  void Reset() {
    const linger at_once{1, 0};
    setsockopt(descriptor_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
    Close();
  }
  void Set(int option, int value) const { setsockopt(descriptor_, SOL_SOCKET, option, &value, sizeof value); }
  bool Bind(int port, const std::string& address = "127.0.0.1") const {
    Set(SO_REUSEADDR, 1);
    const auto own = Ipv4(address, port);
    return bind(descriptor_, reinterpret_cast<const sockaddr*>(&own), sizeof own) == 0;
  }
  bool Listen() const { return listen(descriptor_, 16) == 0; }
  bool Connect(int port) const {
    const auto address = Ipv4("127.0.0.1", port);
    return connect(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  /// Sends one datagram.
  bool SendTo(const sockaddr_in& address, std::span<const std::uint8_t> bytes) const {
    return sendto(descriptor_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&address), sizeof address) ==
           static_cast<ssize_t>(bytes.size());
  }
  int port() const {
    sockaddr_in address{};
    socklen_t size = sizeof address;
    getsockname(descriptor_, reinterpret_cast<sockaddr*>(&address), &size);
    return ntohs(address.sin_port);
  }
  /// Nobody within 2 s: its descriptor is -1.
  Socket Accept() const { return Of(IsReadable(2000) ? accept(descriptor_, nullptr, nullptr) : -1); }
  bool IsReadable(int timeout_ms = 0) const {
    pollfd waiting{descriptor_, POLLIN, 0};
    return poll(&waiting, 1, timeout_ms) > 0;
  }
  void Write(const std::string& text) const {
    EXPECT_EQ(send(descriptor_, text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
  }
  /// What is there now. `has_ended`: by an end or a reset.
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
  int descriptor_ = -1;
  bool has_ended_ = false;
  bool was_reset_ = false;
};

/// A port of this computer at which nobody is.
inline int FreePort(int type = SOCK_STREAM) {
  const Socket socket(type);
  EXPECT_TRUE(socket.Bind(0));
  return socket.port();
}

}  // namespace lookout::support
