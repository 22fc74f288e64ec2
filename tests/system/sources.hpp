// What the tests of lookout-lidar on its sources share. They run in a network namespace of their own, as its root.
#pragma once

#include <arpa/inet.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <filesystem>
#include <functional>
#include <gtest/gtest.h>

#include "common/bus/lcm_bus.hpp"
#include "lookout/health_t.hpp"
#include "lookout/lidar_packets_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "tests/support/child.hpp"
#include "tests/support/counters.hpp"
#include "tests/support/files.hpp"
#include "tests/support/live_bus.hpp"
#include "tests/support/socket.hpp"
#include "tests/unit/lidar/packet_maker.hpp"

namespace lookout::system_test {

using support::Child;
using support::RunProgram;
using support::RunResult;

namespace fs = std::filesystem;
namespace sensor = vlp16::test;
using std::chrono::milliseconds;
using std::chrono::seconds;
using Payload = std::vector<std::uint8_t>;

// Sends packets at the pace of a sensor from an address to another until it is destroyed.
class Lidar {
 public:
  Lidar(const std::string& from, const std::string& to) {
    EXPECT_TRUE(socket_.Bind(0, from));
    const auto interface = support::Ipv4(from, 0).sin_addr;
    setsockopt(socket_.descriptor(), IPPROTO_IP, IP_MULTICAST_IF, &interface, sizeof interface);
    thread_ = std::thread([this, address = support::Ipv4(to, 2368)] {
      sensor::SpinningSensor source;
      auto next = std::chrono::steady_clock::now();
      while (!is_over_) {
        socket_.SendTo(address, source.Next());
        next += source.period();
        std::this_thread::sleep_until(next);
      }
    });
  }
  ~Lidar() {
    is_over_ = true;
    thread_.join();
  }
  Lidar(const Lidar&) = delete;
  // From which it sends.
  int port() const { return socket_.port(); }
  Lidar& operator=(const Lidar&) = delete;

 private:
  support::Socket socket_{SOCK_DGRAM};
  std::atomic<bool> is_over_ = false;
  std::thread thread_;
};

// Sends datagrams of one byte to the data port of 127.0.0.1 until it is destroyed.
class Flood {
 public:
  // per_s 0 = as fast as it can
  Flood(const std::string& from, double per_s) {
    EXPECT_TRUE(socket_.Bind(0, from) && socket_.Connect(2368));
    thread_ = std::thread([this, per_s] { Send(per_s); });
  }
  ~Flood() {
    is_over_ = true;
    thread_.join();
  }
  Flood(const Flood&) = delete;
  Flood& operator=(const Flood&) = delete;

 private:
  void Send(double per_s) const {
    char byte = 0;
    iovec part{&byte, 1};
    std::array<mmsghdr, 64> messages{};
    for (auto& message : messages) {
      message.msg_hdr.msg_iov = &part;
      message.msg_hdr.msg_iovlen = 1;
    }
    // What a computer that stood still did not send is left out: sent all at once it would be another flood than the one that is asked for.
    constexpr double kMaxBehindS = 0.02;
    const auto start = std::chrono::steady_clock::now();
    for (double num_sent = 0; !is_over_;) {
      const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
      num_sent = std::max(num_sent, (elapsed.count() - kMaxBehindS) * per_s);
      if (per_s > 0 && num_sent > elapsed.count() * per_s) {
        std::this_thread::sleep_for(milliseconds(1));
      } else {
        num_sent += std::max(0, sendmmsg(socket_.descriptor(), messages.data(), messages.size(), 0));
      }
    }
  }

  support::Socket socket_{SOCK_DGRAM};
  std::atomic<bool> is_over_ = false;
  std::thread thread_;
};

// Raw IP, as a pcap with microseconds.
inline void WriteCapture(const fs::path& file, const std::vector<Payload>& payloads, std::uint32_t start_s) {
  std::string text;
  const auto append = [&text](std::initializer_list<std::uint32_t> words) {
    for (const auto word : words) {
      for (int shift = 0; shift < 32; shift += 8) text += static_cast<char>(word >> shift & 0xFF);
    }
  };
  const auto big = [](std::size_t number) { return std::string{static_cast<char>(number >> 8), static_cast<char>(number & 0xFF)}; };
  append({0xA1B2C3D4, 0x00040002, 0, 0, 65535, 101});
  std::uint32_t stamp_us = 0;
  for (const auto& payload : payloads) {
    const auto size = static_cast<std::uint32_t>(payload.size());
    append({start_s, stamp_us, size + 28, size + 28});
    stamp_us += 1327;
    text += std::string("\x45\0", 2) + big(payload.size() + 28) + std::string("\0\0\0\0\x40\x11\0\0\xC0\xA8\x01\xC9\xC0\xA8\x01\x4D", 16);
    text += std::string("\x09\x40\x09\x40", 4) + big(payload.size() + 8) + std::string("\0\0", 2);
    text.append(payload.begin(), payload.end());
  }
  std::ofstream(file, std::ios::binary) << text;
}

inline std::vector<Payload> Packets(int count, double azimuth_deg) {
  sensor::SpinningSensor source;
  source.azimuth_deg = azimuth_deg;
  std::vector<Payload> packets;
  for (int i = 0; i < count; ++i) packets.push_back(source.Next());
  return packets;
}

class SourcesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::copy(support::kDemoConfig / "boat.txtpb", folder_ / "boat.txtpb");
    bus_.emplace(bus::DefaultLcmUrl());
    bus::Subscribe<lidar_packets_t>(*bus_, bus::kLidarPackets, [this](const lidar_packets_t& message) { OnPackets(message); });
    bus::Subscribe<lidar_scan_t>(*bus_, bus::kLidarScan, [this](const lidar_scan_t&) { ++num_scans_; });
    bus::Subscribe<health_t>(*bus_, bus::kHealth, [this](const health_t& message) { health_ = message; });
    bus_->HandleOnce(milliseconds(0));  // joins LCM's group
  }
  void TearDown() override { child_.reset(); }

  void OnPackets(const lidar_packets_t& message) {
    if ((message.marks & lidar_packets_t::MARK_START) != 0) starts_.push_back(message.seq);
    if ((message.marks & lidar_packets_t::MARK_END) != 0) ++num_ends_;
    auto place = message.payload.begin();
    for (const auto size : message.size_bytes) {
      payloads_.emplace_back(place, place + size);
      place += size;
    }
  }

  void WriteConfig(const std::string& text) const { std::ofstream(folder_ / "lidar.txtpb") << text << '\n'; }
  std::string Program() const { return support::Bin("lidar"); }
  void Start(const std::string& config) {
    WriteConfig(config);
    child_ = std::make_unique<Child>(std::vector<std::string>{Program(), "--config", folder_.string()}, (folder_ / "out").string());
  }
  RunResult Run(const std::string& config, std::vector<std::string> command) const {
    WriteConfig(config);
    command.insert(command.end(), {"--config", folder_.string()});
    return RunProgram(command, (folder_ / "out").string());
  }
  static int System(const std::string& command) { return std::system((command + " 2>/dev/null").c_str()); }

  bool WaitUntil(const std::function<bool()>& is_true, seconds timeout = seconds(15)) { return support::HandleUntil(*bus_, is_true, timeout); }
  bool WaitForScans(int count) {
    const int goal = num_scans_ + count;
    return WaitUntil([&] { return num_scans_ >= goal; });
  }
  bool WaitForOutput(const std::string& text) {
    return WaitUntil([&] { return child_->Output().find(text) != std::string::npos; });
  }
  // Health that is made from now on.
  bool WaitForHealth(std::int32_t state, seconds timeout = seconds(15)) {
    using std::chrono::system_clock;
    const auto since_us = std::chrono::duration_cast<std::chrono::microseconds>(system_clock::now().time_since_epoch()).count();
    return WaitUntil([&] { return health_.utime_us > since_us && health_.state == state; }, timeout);
  }
  std::int64_t Counter(const std::string& name) const { return support::CountOf(health_, name); }

  support::TempDir folder_;
  std::optional<bus::LcmBus> bus_;
  std::unique_ptr<Child> child_;
  std::vector<Payload> payloads_;
  std::vector<std::int64_t> starts_;
  int num_ends_ = 0;
  int num_scans_ = 0;
  health_t health_{};
};

}  // namespace lookout::system_test
