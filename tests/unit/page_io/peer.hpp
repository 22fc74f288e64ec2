// A server of the page, and browsers made of plain sockets of this computer: they can say anything.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <gtest/gtest.h>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "services/page/io/server.hpp"

namespace lookout::page::test {

using namespace std::chrono_literals;

/// Whether it becomes so in time.
inline bool Until(const std::function<bool()>& is_so, std::chrono::milliseconds longest = 10s) {
  const auto end = std::chrono::steady_clock::now() + longest;
  while (!is_so()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(2ms);
  }
  return true;
}

inline Bytes BytesOf(std::string_view text) { return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}; }

inline std::int64_t CountOf(const Server& server, std::string_view name) {
  const auto counts = server.Counts();
  const auto found = counts.find(name);
  return found == counts.end() ? 0 : found->second;
}

/// A connection to the server. Nothing that it does takes longer than 10 s.
class Peer {
 public:
  /// @param buffer_bytes  of what it has received and not read; 0: as the system says
  explicit Peer(int port, int buffer_bytes = 0) : port_(port), descriptor_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    if (buffer_bytes > 0) setsockopt(descriptor_, SOL_SOCKET, SO_RCVBUF, &buffer_bytes, sizeof buffer_bytes);
    const int is_on = 1;
    setsockopt(descriptor_, IPPROTO_TCP, TCP_NODELAY, &is_on, sizeof is_on);
    const timeval patience{10, 0};
    setsockopt(descriptor_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  ~Peer() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  Peer(Peer&& other) noexcept : port_(other.port_), descriptor_(std::exchange(other.descriptor_, -1)), read_(std::move(other.read_)) {}
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;
  Peer& operator=(Peer&&) = delete;

  /// @return false when the other side has closed it
  bool Write(std::string_view bytes) {
    while (!bytes.empty()) {
      const auto size = send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (size <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(size));
    }
    return true;
  }

  /// @return false when the other side does not take it in time
  bool WriteNow(std::string_view bytes, std::chrono::milliseconds longest) {
    pollfd waiting{descriptor_, POLLOUT, 0};
    return poll(&waiting, 1, static_cast<int>(longest.count())) > 0 &&
           send(descriptor_, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size());
  }

  /// Reads on. @return false at the end, or when nothing comes in time
  bool ReadSome(std::chrono::milliseconds longest = 10s) {
    pollfd waiting{descriptor_, POLLIN, 0};
    if (poll(&waiting, 1, static_cast<int>(longest.count())) <= 0) return false;
    char bytes[65536];
    const auto size = recv(descriptor_, bytes, sizeof bytes, 0);
    has_ended_ = size <= 0;
    if (size > 0) read_.append(bytes, static_cast<std::size_t>(size));
    return size > 0;
  }

  /// Whether the other side closes it in time.
  bool Ends(std::chrono::milliseconds longest = 10s) {
    const auto end = std::chrono::steady_clock::now() + longest;
    while (!has_ended_ && std::chrono::steady_clock::now() < end) ReadSome(50ms);
    return has_ended_;
  }

  /// An answer of HTTP: head and body. Empty when none comes.
  std::string ReadAnswer(bool has_body = true) {
    std::size_t end = 0;
    while ((end = read_.find("\r\n\r\n")) == std::string::npos) {
      if (!ReadSome()) return {};
    }
    end += 4;
    const auto length = read_.find("Content-Length: ");
    if (has_body && length < end) end += std::stoul(read_.substr(length + 16));
    while (read_.size() < end) {
      if (!ReadSome()) return {};
    }
    auto answer = read_.substr(0, end);
    read_.erase(0, end);
    return answer;
  }

  std::string Ask(const std::string& head, const std::string& body = {}) {
    Write(head + "\r\n" + (body.empty() ? "" : "Content-Length: " + std::to_string(body.size()) + "\r\n") + "\r\n" + body);
    return ReadAnswer(!head.starts_with("HEAD"));
  }

  std::string host() const { return "127.0.0.1:" + std::to_string(port_); }
  std::string Get(const std::string& path, const std::string& more = {}) { return Ask("GET " + path + " HTTP/1.1\r\nHost: " + host() + more); }

  /// Head of a request for a WebSocket.
  std::string Upgrade(const std::string& origin, const std::string& protocol = "lookout.page.v1") const {
    return "GET /socket HTTP/1.1\r\nHost: " + host() + "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n" +
           "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: " + protocol + (origin.empty() ? "" : "\r\nOrigin: " + origin);
  }

 protected:
  int port_;
  int descriptor_;
  std::string read_;
  bool has_ended_ = false;
};

/// A message of the server, or of nobody.
struct FromServer {
  int kind = -1;  // 1 text, 2 binary, 8 close, 9 ping; -1: nothing came
  std::string bytes;

  bool Holds(std::string_view part) const { return bytes.find(part) != std::string::npos; }
  int close_code() const {
    return kind == 8 && bytes.size() >= 2 ? static_cast<unsigned char>(bytes[0]) << 8 | static_cast<unsigned char>(bytes[1]) : -1;
  }
};

inline std::string ClientFrame(int first_byte, const std::string& payload, std::uint64_t claimed_bytes, bool is_masked = true) {
  std::string frame(1, static_cast<char>(first_byte));
  const int mask_bit = is_masked ? 0x80 : 0;
  if (claimed_bytes < 126) {
    frame += static_cast<char>(mask_bit | static_cast<int>(claimed_bytes));
  } else if (claimed_bytes < 65536) {
    frame += static_cast<char>(mask_bit | 126);
    frame += static_cast<char>(claimed_bytes >> 8);
    frame += static_cast<char>(claimed_bytes & 0xFF);
  } else {
    frame += static_cast<char>(mask_bit | 127);
    for (int shift = 56; shift >= 0; shift -= 8) frame += static_cast<char>(claimed_bytes >> shift & 0xFF);
  }
  if (is_masked) frame.append(4, '\0');  // a mask of zeros changes nothing
  return frame + payload;
}

/// A browser's WebSocket.
class Browser : public Peer {
 public:
  explicit Browser(int port, int buffer_bytes = 0) : Peer(port, buffer_bytes) {
    answer_ = Ask(Upgrade("http://" + host()));
    if (answer_.starts_with("HTTP/1.1 101")) hello_ = Next();
  }

  /// One of another protocol. @param origin  empty: none, as of a program
  Browser(int port, int buffer_bytes, const std::string& origin, const std::string& protocol) : Peer(port, buffer_bytes) {
    answer_ = Ask(Upgrade(origin, protocol));
    if (answer_.starts_with("HTTP/1.1 101")) hello_ = Next();
  }

  const std::string& answer() const { return answer_; }
  const FromServer& hello() const { return hello_; }

  bool SayBinary(const std::string& bytes) { return Write(ClientFrame(0x82, bytes, bytes.size())); }
  bool Say(const std::string& text) { return Write(ClientFrame(0x81, text, text.size())); }
  void Watch(const std::string& channels) { Say(R"({"op":"watch","channels":[)" + channels + "]}"); }
  void Confirm(int num_frames) { Say(R"({"op":"got","frames":)" + std::to_string(num_frames) + "}"); }

  /// The next message but pings; of kind -1 when none comes.
  FromServer Next(std::chrono::milliseconds longest = 10s) {
    const auto end = std::chrono::steady_clock::now() + longest;
    while (true) {
      auto message = Cut();
      if (message.kind == 9) continue;
      if (message.kind != -1) return message;
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
      if (left <= 0ms || !ReadSome(left)) return {};
    }
  }

 private:
  FromServer Cut() {
    const auto byte = [&](std::size_t i) { return static_cast<std::size_t>(static_cast<unsigned char>(read_[i])); };
    if (read_.size() < 2) return {};
    const std::size_t num_length_bytes = byte(1) == 126 ? 2 : byte(1) == 127 ? 8 : 0;
    if (read_.size() < 2 + num_length_bytes) return {};
    std::size_t size = num_length_bytes == 0 ? byte(1) : 0;
    for (std::size_t i = 0; i < num_length_bytes; ++i) size = size << 8 | byte(2 + i);
    const std::size_t begin = 2 + num_length_bytes;
    if (read_.size() < begin + size) return {};
    FromServer message{static_cast<int>(byte(0) & 0x0F), read_.substr(begin, size)};
    read_.erase(0, begin + size);
    return message;
  }

  std::string answer_;
  FromServer hello_;
};

inline ChannelIndex IndexOf(std::string_view name) {
  const auto& names = ChannelNames();
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == name) return static_cast<ChannelIndex>(i);
  }
  ADD_FAILURE() << "no channel " << name;
  return 0;
}

}  // namespace lookout::page::test
