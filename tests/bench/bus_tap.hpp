// The bus as it is on the wire, without LCM: what disturbs every LCM subscriber must not end who judges them.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <deque>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "common/core/bytes.hpp"

namespace lookout::bench {

inline constexpr const char* kGroup = "239.255.76.67";
inline constexpr int kBusPort = 7667;
inline constexpr std::uint32_t kShortMagic = 0x4C433032;     // "LC02": magic, number, channel with its 0, bytes
inline constexpr std::uint32_t kFragmentMagic = 0x4C433033;  // "LC03": magic, number, size, offset, fragment, fragments; the first one: channel
inline constexpr std::size_t kShortHeaderBytes = 8;
inline constexpr std::size_t kFragmentHeaderBytes = 20;
/// Whoever disturbs sends from ports below those that the kernel gives to the processes.
inline constexpr int kFirstPortOfProcesses = 32768;

inline std::uint32_t ReadU32Big(const std::uint8_t* bytes) {
  return std::uint32_t{bytes[0]} << 24 | std::uint32_t{bytes[1]} << 16 | std::uint32_t{bytes[2]} << 8 | std::uint32_t{bytes[3]};
}

class BusTap {
 public:
  using Datagram = std::vector<std::uint8_t>;
  using Handler = std::function<void(const std::string& channel, Bytes bytes)>;

  BusTap() : socket_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
    const int on = 1;
    const int size = 16 << 20;
    setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    if (setsockopt(socket_, SOL_SOCKET, SO_RCVBUFFORCE, &size, sizeof size) != 0) setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &size, sizeof size);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(kBusPort);
    // Bound to the group: what is sent to one address of this computer is for the processes.
    inet_pton(AF_INET, kGroup, &address.sin_addr);
    ip_mreq request{};
    request.imr_multiaddr = address.sin_addr;
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
        setsockopt(socket_, IPPROTO_IP, IP_ADD_MEMBERSHIP, &request, sizeof request) != 0) {
      throw std::runtime_error("cannot listen to the bus: " + std::string(std::strerror(errno)));
    }
  }
  ~BusTap() { close(socket_); }
  BusTap(const BusTap&) = delete;
  BusTap& operator=(const BusTap&) = delete;

  /// Waits for datagrams, so long at most, and hands whole messages of the processes on.
  void HandleFor(std::chrono::milliseconds timeout, const Handler& handler) {
    pollfd waited{socket_, POLLIN, 0};
    if (poll(&waited, 1, static_cast<int>(timeout.count())) <= 0) return;
    for (int i = 0; i < 200; ++i) {
      sockaddr_in source{};
      socklen_t source_size = sizeof source;
      const auto size = recvfrom(socket_, buffer_.data(), buffer_.size(), 0, reinterpret_cast<sockaddr*>(&source), &source_size);
      if (size < 0) return;
      const int port = ntohs(source.sin_port);
      if (port >= kFirstPortOfProcesses) Take(port, {buffer_.data(), static_cast<std::size_t>(size)}, handler);
    }
  }

  /// The last true datagrams, to be bent.
  const std::deque<Datagram>& samples() const { return samples_; }

 private:
  struct Message {
    std::string channel;
    std::vector<std::uint8_t> bytes;
    std::size_t num_missing = 0;
  };

  void Take(int port, Bytes datagram, const Handler& handler) {
    if (datagram.size() < kShortHeaderBytes) return;
    if (num_taken_++ % 17 == 0) {
      samples_.emplace_back(datagram.begin(), datagram.end());
      if (samples_.size() > 64) samples_.pop_front();
    }
    const auto magic = ReadU32Big(datagram.data());
    if (magic == kShortMagic) {
      auto [channel, bytes] = SplitChannel(datagram.subspan(kShortHeaderBytes));
      handler(channel, bytes);
    } else if (magic == kFragmentMagic && datagram.size() >= kFragmentHeaderBytes) {
      TakeFragment(port, datagram, handler);
    }
  }

  void TakeFragment(int port, Bytes datagram, const Handler& handler) {
    const auto key = std::pair(port, ReadU32Big(&datagram[4]));
    const std::size_t size = ReadU32Big(&datagram[8]);
    const std::size_t offset = ReadU32Big(&datagram[12]);
    const std::size_t number = std::size_t{datagram[16]} << 8 | datagram[17];
    const std::size_t count = std::size_t{datagram[18]} << 8 | datagram[19];
    if (size > (1U << 20)) return;
    while (messages_.size() > 16) messages_.erase(messages_.begin());
    auto& message = messages_[key];
    if (message.bytes.empty()) {
      message.bytes.resize(size);
      message.num_missing = count;
    }
    auto part = datagram.subspan(kFragmentHeaderBytes);
    if (number == 0) std::tie(message.channel, part) = SplitChannel(part);
    if (offset + part.size() > message.bytes.size() || message.num_missing == 0) return;
    std::copy(part.begin(), part.end(), message.bytes.begin() + static_cast<std::ptrdiff_t>(offset));
    if (--message.num_missing > 0) return;
    handler(message.channel, message.bytes);
    messages_.erase(key);
  }

  static std::pair<std::string, Bytes> SplitChannel(Bytes bytes) {
    std::size_t length = 0;
    while (length < bytes.size() && bytes[length] != 0) ++length;
    const std::string channel(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length));
    return {channel, bytes.subspan(std::min(length + 1, bytes.size()))};
  }

  int socket_;
  std::array<std::uint8_t, 65536> buffer_{};
  std::map<std::pair<int, std::uint32_t>, Message> messages_;
  std::deque<Datagram> samples_;
  std::size_t num_taken_ = 0;
};

}  // namespace lookout::bench
