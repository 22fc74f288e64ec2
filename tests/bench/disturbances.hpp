// What disturbs a look-out on the wire: packets of another lidar, and datagrams that no LCM would send.
#pragma once

#include <atomic>
#include <random>
#include <thread>

#include "tests/bench/bus_tap.hpp"
#include "tests/support/socket.hpp"
#include "tests/unit/lidar/packet_maker.hpp"

namespace lookout::bench {

using support::Ipv4;

/// Another VLP-16, which sees a wall 5 m off all round, sends to the same ports until this is destroyed.
class ForeignLidar {
 public:
  explicit ForeignLidar(double packets_per_s) : socket_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    const auto own = Ipv4("127.0.0.2", 23680);
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0) throw std::runtime_error("no second lidar: its port is taken");
    thread_ = std::thread([this, packets_per_s] { Send(packets_per_s); });
  }
  ~ForeignLidar() {
    is_over_ = true;
    thread_.join();
    close(socket_);
  }
  ForeignLidar(const ForeignLidar&) = delete;
  ForeignLidar& operator=(const ForeignLidar&) = delete;

 private:
  void Send(double packets_per_s) const {
    const auto data = Ipv4("127.0.0.1", 2368);
    const auto position = Ipv4("127.0.0.1", 8308);
    const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
    vlp16::test::SpinningSensor sensor;
    sensor.time_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(since_epoch % std::chrono::hours(1)).count();
    sensor.scene = [](double, int, int) { return vlp16::test::ReturnValue{2500, 60}; };
    const auto start = std::chrono::steady_clock::now();
    const auto send = [this](const auto& payload, const sockaddr_in& to) {
      sendto(socket_, payload.data(), payload.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
    };
    for (int i = 0; !is_over_; ++i) {
      send(sensor.Next(), data);
      if (i % 4 == 0) send(vlp16::test::MakePositionPacket(sensor.stamp_us(), 2, vlp16::test::kValidRmc), position);
      std::this_thread::sleep_until(start + std::chrono::duration<double>((i + 1) / packets_per_s));
    }
  }

  int socket_;
  std::atomic<bool> is_over_ = false;
  std::thread thread_;
};

/// Datagrams to port 7667 that no LCM would send. What they hold is never a message with other contents: whoever can send those is the suite itself.
class HostileSender {
 public:
  /// @param port          to send from, below kFirstPortOfProcesses
  /// @param destinations  addresses
  HostileSender(int port, std::uint64_t seed, const std::vector<std::string>& destinations)
      : socket_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)), random_(seed) {
    const int on = 1;
    setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    setsockopt(socket_, SOL_SOCKET, SO_BROADCAST, &on, sizeof on);
    const auto own = Ipv4("0.0.0.0", port);
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0) throw std::runtime_error("cannot send: the port is taken");
    for (const auto& address : destinations) destinations_.push_back(Ipv4(address, kBusPort));
  }
  ~HostileSender() { close(socket_); }
  HostileSender(const HostileSender&) = delete;
  HostileSender& operator=(const HostileSender&) = delete;

  /// @param samples  true datagrams; may be empty
  /// @return datagrams that the network took
  std::int64_t Send(int count, const std::deque<BusTap::Datagram>& samples) {
    std::int64_t num_sent = 0;
    for (int i = 0; i < count; ++i) {
      const auto datagram = Make(samples);
      for (const auto& to : destinations_) {
        num_sent += sendto(socket_, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to) >= 0 ? 1 : 0;
      }
      if (i % 10 == 9) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return num_sent;
  }

 private:
  using Datagram = BusTap::Datagram;

  std::uint32_t Below(std::uint32_t limit) { return static_cast<std::uint32_t>(random_() % limit); }

  static void Append(Datagram& datagram, std::uint32_t number, int num_bytes = 4) {
    for (int shift = 8 * (num_bytes - 1); shift >= 0; shift -= 8) datagram.push_back(static_cast<std::uint8_t>(number >> shift));
  }
  static Datagram Fragment(std::uint32_t number, std::uint32_t size, std::uint32_t offset, std::uint32_t index, std::uint32_t count,
                           const std::string& channel, std::size_t num_bytes) {
    Datagram datagram;
    for (const auto word : {kFragmentMagic, number, size, offset}) Append(datagram, word);
    Append(datagram, index, 2);
    Append(datagram, count, 2);
    if (!channel.empty()) datagram.insert(datagram.end(), channel.c_str(), channel.c_str() + channel.size() + 1);
    datagram.insert(datagram.end(), num_bytes, 0x41);
    return datagram;
  }

  Datagram Make(const std::deque<Datagram>& samples) {
    switch (Below(6)) {
      case 0: {  // offset and size overflow 32 bits, behind a first fragment that is right
        if (Below(2) == 0) return Fragment(number_, 3000, 0, 0, 2, "LIDAR_SCAN", 1000);
        return Fragment(number_++, 3000, 0xFFFFFFF0U + Below(16), 1, 2, "", 1000);
      }
      case 1: {  // a header alone, or less
        Datagram datagram;
        Append(datagram, Below(2) == 0 ? kShortMagic : kFragmentMagic);
        Append(datagram, Below(1000));
        datagram.resize(Below(3) == 0 ? Below(21) : kShortHeaderBytes);
        return datagram;
      }
      case 2: {  // sizes that cannot be
        constexpr std::array<std::uint32_t, 6> kSizes{0, 1, 17'000'000, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF};
        return Fragment(number_++, kSizes[Below(6)], kSizes[Below(6)], Below(4), Below(3) == 0 ? 0xFFFF : Below(4), Below(2) == 0 ? "POSE" : "",
                        Below(1400));
      }
      case 3: {  // a channel without an end, or too long
        Datagram datagram;
        Append(datagram, kShortMagic);
        Append(datagram, number_++);
        datagram.insert(datagram.end(), Below(2) == 0 ? Below(80) : 5000, 'P');
        return datagram;
      }
      case 4: {  // a channel of the suite with contents that are none
        Datagram datagram;
        Append(datagram, kShortMagic);
        Append(datagram, number_++);
        constexpr std::array<const char*, 5> kChannels{"POSE", "SEGMENTS", "LIDAR_SCAN", "LIDAR_PACKETS", "HEALTH"};
        const std::string channel = kChannels[Below(5)];
        datagram.insert(datagram.end(), channel.c_str(), channel.c_str() + channel.size() + 1);
        for (auto i = Below(200); i > 0; --i) datagram.push_back(static_cast<std::uint8_t>(Below(256)));
        return datagram;
      }
      default:
        return samples.empty() ? Datagram{} : Bent(samples[Below(static_cast<std::uint32_t>(samples.size()))]);
    }
  }

  // A true datagram with other bytes in LCM's header, the channel or the fingerprint, cut, or made longer.
  Datagram Bent(Datagram datagram) {
    std::size_t end = datagram[3] == '3' ? kFragmentHeaderBytes : kShortHeaderBytes;
    while (end < datagram.size() && datagram[end] != 0) ++end;
    end = std::min(datagram.size(), end + 9);
    for (auto i = 1 + Below(3); i > 0; --i) datagram[Below(static_cast<std::uint32_t>(end))] = static_cast<std::uint8_t>(Below(256));
    if (Below(3) == 0) datagram.resize(Below(static_cast<std::uint32_t>(datagram.size())));
    if (Below(6) == 0) datagram.resize(datagram.size() + Below(100), 0x5A);
    return datagram;
  }

  int socket_;
  std::mt19937_64 random_;
  std::vector<sockaddr_in> destinations_;
  std::uint32_t number_ = 1;
};

}  // namespace lookout::bench
