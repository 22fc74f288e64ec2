// lookout-vlp16 on its sources: sockets, an interface, captures; and SIGHUP. Runs in a network namespace of its own, as its root.
#include <arpa/inet.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <sys/socket.h>

#include <atomic>
#include <filesystem>
#include <functional>
#include <gtest/gtest.h>

#include "common/bus/lcm_bus.hpp"
#include "lookout/health_t.hpp"
#include "lookout/lidar_packets_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "tests/system/child.hpp"
#include "tests/unit/vlp16/packet_maker.hpp"

namespace lookout::system_test {
namespace {

namespace fs = std::filesystem;
namespace sensor = vlp16::test;
using std::chrono::milliseconds;
using std::chrono::seconds;
using Payload = std::vector<std::uint8_t>;

// Sends packets at the pace of a sensor from an address to another until it is destroyed.
class Lidar {
 public:
  Lidar(const std::string& from, const std::string& to) : socket_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    inet_pton(AF_INET, from.c_str(), &address.sin_addr);
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    setsockopt(socket_, IPPROTO_IP, IP_MULTICAST_IF, &address.sin_addr, sizeof address.sin_addr);
    address.sin_port = htons(2368);
    inet_pton(AF_INET, to.c_str(), &address.sin_addr);
    thread_ = std::thread([this, address] {
      sensor::SpinningSensor source;
      auto next = std::chrono::steady_clock::now();
      while (!is_over_) {
        const auto packet = source.Next();
        sendto(socket_, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&address), sizeof address);
        next += source.period();
        std::this_thread::sleep_until(next);
      }
    });
  }
  ~Lidar() {
    is_over_ = true;
    thread_.join();
    close(socket_);
  }
  Lidar(const Lidar&) = delete;
  Lidar& operator=(const Lidar&) = delete;

 private:
  int socket_;
  std::atomic<bool> is_over_ = false;
  std::thread thread_;
};

// Raw IP, as a pcap with microseconds.
void WriteCapture(const fs::path& file, const std::vector<Payload>& payloads, std::uint32_t start_s) {
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

std::vector<Payload> Packets(int count, double azimuth_deg) {
  sensor::SpinningSensor source;
  source.azimuth_deg = azimuth_deg;
  std::vector<Payload> packets;
  for (int i = 0; i < count; ++i) packets.push_back(source.Next());
  return packets;
}

class SourcesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              ("lookout_sources_" + std::to_string(getpid()) + "_" + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
    fs::copy(fs::path(LOOKOUT_SOURCE_DIR) / "config/demo/boat.txtpb", folder_ / "boat.txtpb");
    bus_.emplace(bus::DefaultLcmUrl());
    bus::Subscribe<lidar_packets_t>(*bus_, bus::kLidarPackets, [this](const lidar_packets_t& message) { OnPackets(message); });
    bus::Subscribe<lidar_scan_t>(*bus_, bus::kLidarScan, [this](const lidar_scan_t&) { ++num_scans_; });
    bus::Subscribe<health_t>(*bus_, bus::kHealth, [this](const health_t& message) { health_ = message; });
    bus_->HandleOnce(milliseconds(0));  // joins LCM's group
  }
  void TearDown() override {
    child_.reset();
    if (!HasFailure()) fs::remove_all(folder_);
  }

  void OnPackets(const lidar_packets_t& message) {
    if ((message.marks & lidar_packets_t::MARK_START) != 0) starts_.push_back(message.seq);
    if ((message.marks & lidar_packets_t::MARK_END) != 0) ++num_ends_;
    auto place = message.payload.begin();
    for (const auto size : message.size_bytes) {
      payloads_.emplace_back(place, place + size);
      place += size;
    }
  }

  void WriteConfig(const std::string& text) const { std::ofstream(folder_ / "vlp16.txtpb") << text << '\n'; }
  std::string Program() const { return std::string(LOOKOUT_BIN_DIR) + "/lookout-vlp16"; }
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

  bool WaitUntil(const std::function<bool()>& is_true, seconds timeout = seconds(15)) {
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    while (!is_true() && std::chrono::steady_clock::now() < deadline) bus_->HandleOnce(milliseconds(20));
    return is_true();
  }
  bool WaitForScans(int count) {
    const int goal = num_scans_ + count;
    return WaitUntil([&] { return num_scans_ >= goal; });
  }
  bool WaitForOutput(const std::string& text) {
    return WaitUntil([&] { return child_->Output().find(text) != std::string::npos; });
  }
  std::int64_t Counter(const std::string& name) const {
    for (const auto& counter : health_.counters) {
      if (counter.name == name) return counter.count;
    }
    return -1;
  }

  fs::path folder_;
  std::optional<bus::LcmBus> bus_;
  std::unique_ptr<Child> child_;
  std::vector<Payload> payloads_;
  std::vector<std::int64_t> starts_;
  int num_ends_ = 0;
  int num_scans_ = 0;
  health_t health_{};
};

TEST_F(SourcesTest, RefuseAndCountASensorThatIsNotAllowed) {
  Start("source: UDP bind_address: '0.0.0.0' cut_azimuth_deg: 0 allowed_source_address: '127.0.0.1'");
  ASSERT_TRUE(WaitForOutput("starts"));
  {
    const Lidar other("127.0.0.2", "127.0.0.1");
    ASSERT_TRUE(WaitUntil([&] { return Counter("data_source_refused") > 100; })) << child_->Output();
  }
  EXPECT_TRUE(payloads_.empty());
  const Lidar lidar("127.0.0.1", "127.0.0.1");
  EXPECT_TRUE(WaitForScans(3));
}

TEST_F(SourcesTest, JoinAMulticastGroup) {
  Start("source: UDP bind_address: '0.0.0.0' cut_azimuth_deg: 0 interface: 'lo' multicast_group: '239.9.9.9'");
  ASSERT_TRUE(WaitForOutput("starts"));
  const Lidar lidar("127.0.0.1", "239.9.9.9");
  EXPECT_TRUE(WaitForScans(3)) << child_->Output();
}

TEST_F(SourcesTest, CaptureOnAnInterface) {
  Start("source: INTERFACE interface: 'lo' cut_azimuth_deg: 0 allowed_source_address: '127.0.0.1'");
  ASSERT_TRUE(WaitForOutput("starts"));
  const Lidar other("127.0.0.2", "127.0.0.1");
  const Lidar lidar("127.0.0.1", "127.0.0.1");
  EXPECT_TRUE(WaitForScans(10)) << child_->Output();
  ASSERT_TRUE(WaitUntil([&] { return Counter("frames_datagram") > 700; })) << child_->Output();
  EXPECT_GT(Counter("capture_source_refused"), 100);
  EXPECT_EQ(Counter("capture_kernel_drops"), 0);
  EXPECT_EQ(Counter("capture_interface_drops"), 0);
  EXPECT_EQ(Counter("data_duplicate"), 0);  // loopback shows each frame twice
}

// A pair of interfaces joined by a cable: what goes into sim0 comes out of lidar0.
class CableTest : public SourcesTest {
 protected:
  void SetUp() override {
    SourcesTest::SetUp();
    if (!Plug()) GTEST_SKIP() << "this kernel makes no veth interfaces";
  }
  void TearDown() override {
    Unplug();
    SourcesTest::TearDown();
  }
  static bool Plug() {
    return System(
               "ip link add lidar0 type veth peer name sim0 && ip addr add 10.7.7.1/24 dev sim0 && ip link set sim0 up && ip link set lidar0 up") ==
           0;
  }
  static void Unplug() { System("ip link del lidar0"); }

  // A frame as a switch hands it on, to everybody.
  static void SendFrame(const std::vector<std::uint8_t>& tag, const Payload& payload) {
    std::vector<std::uint8_t> frame(6, 0xFF);
    frame.insert(frame.end(), {2, 0, 0, 0, 0, 1});
    frame.insert(frame.end(), tag.begin(), tag.end());
    const auto size = payload.size();
    const auto high = [](std::size_t number) { return static_cast<std::uint8_t>(number >> 8); };
    const auto low = [](std::size_t number) { return static_cast<std::uint8_t>(number & 0xFF); };
    frame.insert(frame.end(), {0x08, 0x00, 0x45, 0, high(size + 28), low(size + 28), 0, 0, 0, 0, 64, 17, 0, 0, 10, 7, 7, 1, 255, 255, 255, 255});
    frame.insert(frame.end(), {0x09, 0x40, 0x09, 0x40, high(size + 8), low(size + 8), 0, 0});
    frame.insert(frame.end(), payload.begin(), payload.end());
    const int sender = socket(AF_PACKET, SOCK_RAW | SOCK_CLOEXEC, 0);
    sockaddr_ll address{};
    address.sll_family = AF_PACKET;
    address.sll_ifindex = static_cast<int>(if_nametoindex("sim0"));
    EXPECT_EQ(sendto(sender, frame.data(), frame.size(), 0, reinterpret_cast<const sockaddr*>(&address), sizeof address),
              static_cast<ssize_t>(frame.size()));
    close(sender);
  }

  void ComesBackAfter(const std::function<void()>& break_it, const std::function<void()>& mend_it, const std::string& group = "224.0.0.1") {
    {
      const Lidar lidar("10.7.7.1", group);
      ASSERT_TRUE(WaitForScans(3)) << child_->Output();
    }
    break_it();
    ASSERT_TRUE(WaitUntil([&] { return health_.state == health_t::STATE_DEGRADED; })) << child_->Output();
    mend_it();
    const Lidar lidar("10.7.7.1", group);
    EXPECT_TRUE(WaitForScans(3)) << child_->Output();
    EXPECT_TRUE(WaitUntil([&] { return health_.state == health_t::STATE_OK; })) << health_.reason;
    EXPECT_TRUE(child_->IsRunning());
  }
};

const char* const kOnLidar0 = "source: INTERFACE interface: 'lidar0' cut_azimuth_deg: 0";

TEST_F(CableTest, VlanTaggedFramesAreSeen) {
  Start(kOnLidar0);
  ASSERT_TRUE(WaitForOutput("starts"));
  const auto packets = Packets(3, 0.0);
  SendFrame({}, packets[0]);
  SendFrame({0x81, 0x00, 0x00, 0x05}, packets[1]);
  SendFrame({0x88, 0xA8, 0x00, 0x07, 0x81, 0x00, 0x00, 0x05}, packets[2]);
  EXPECT_TRUE(WaitUntil([&] { return payloads_.size() == 3; })) << payloads_.size();
  EXPECT_TRUE(payloads_ == packets);
}

TEST_F(CableTest, CaptureComesBackAfterTheInterfaceWasDown) {
  Start(kOnLidar0);
  ASSERT_TRUE(WaitForOutput("starts"));
  ComesBackAfter([] { System("ip link set lidar0 down"); }, [] { System("ip link set lidar0 up"); });
  EXPECT_EQ(Counter("capture_outages"), 1);
  EXPECT_NE(child_->Output().find("interface 'lidar0' is down"), std::string::npos) << child_->Output();
}

TEST_F(CableTest, CaptureComesBackAfterTheInterfaceWasPulled) {
  Start(kOnLidar0);
  ASSERT_TRUE(WaitForOutput("starts"));
  ComesBackAfter([] { Unplug(); }, [] { Plug(); });
  EXPECT_EQ(Counter("capture_outages"), 1);
}

TEST_F(CableTest, SocketComesBackAfterTheInterfaceWasPulled) {
  // Both ends are this computer: its own address as a source passes only when that is allowed.
  const auto prepare = [] {
    System("ip addr add 10.7.7.2/24 dev lidar0");
    System("echo 1 > /proc/sys/net/ipv4/conf/lidar0/accept_local; echo 0 > /proc/sys/net/ipv4/conf/lidar0/rp_filter");
    System("echo 0 > /proc/sys/net/ipv4/conf/all/rp_filter");
  };
  prepare();
  Start("source: UDP bind_address: '0.0.0.0' cut_azimuth_deg: 0 interface: 'lidar0' multicast_group: '239.9.9.9'");
  ASSERT_TRUE(WaitForOutput("starts"));
  ComesBackAfter([] { Unplug(); },
                 [&] {
                   Plug();
                   prepare();
                 },
                 "239.9.9.9");
  EXPECT_EQ(Counter("sockets_reopened"), 2);
}

TEST_F(CableTest, CaptureWaitsForAnInterfaceThatIsDownAtTheStart) {
  System("ip link set lidar0 down");
  Start(kOnLidar0);
  ASSERT_TRUE(WaitForOutput("is down; waiting for it"));
  System("ip link set lidar0 up");
  const Lidar lidar("10.7.7.1", "224.0.0.1");
  EXPECT_TRUE(WaitForScans(3)) << child_->Output();
}

TEST_F(SourcesTest, CaptureWithoutTheRightNamesTheLineThatGivesIt) {
  const std::vector<std::string> without{"setpriv", "--bounding-set", "-net_raw", "--inh-caps", "-net_raw", Program()};
  if (System("setpriv --bounding-set -net_raw --inh-caps -net_raw true") != 0) GTEST_SKIP() << "setpriv cannot drop CAP_NET_RAW here";
  const auto result = Run("source: INTERFACE interface: 'lo' cut_azimuth_deg: 0", without);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.output.find("sudo setcap cap_net_raw=ep " + fs::canonical(Program()).string() + "\n"), std::string::npos) << result.output;
}

TEST_F(SourcesTest, EachFaultIsNamedAtTheStartAndByCheck) {
  const auto result =
      Run("source: UDP\nbind_address: 'eth0'\ncut_azimuth_deg: 0\nallowed_source_address: 'lidar.local'\nmulticast_group: '192.168.1.201'",
          {Program(), "--check"});
  EXPECT_EQ(result.exit_code, 2);
  for (const char* fault : {":2: bind_address:", ":4: allowed_source_address: 'lidar.local'", ":5: multicast_group:"}) {
    EXPECT_NE(result.output.find(fault), std::string::npos) << result.output;
  }
  const auto filter = Run("source: INTERFACE\ninterface: 'lo'\ncut_azimuth_deg: 0\nbpf_filter: 'udp and port'", {Program(), "--check"});
  EXPECT_EQ(filter.exit_code, 2);
  EXPECT_NE(filter.output.find(":4: bpf_filter:"), std::string::npos) << filter.output;
  EXPECT_EQ(Run("source: INTERFACE interface: 'nosuch0' cut_azimuth_deg: 0", {Program()}).exit_code, 1);
}

TEST_F(SourcesTest, CapturesGiveTheSamePacketsInOrderAtAnySpeed) {
  const auto first = Packets(90, 0.0);
  const auto second = Packets(60, 200.0);
  WriteCapture(folder_ / "first.pcap", first, 1'000);
  WriteCapture(folder_ / "second.pcap", second, 500);  // its stamps are before the first's
  auto expected = first;
  expected.insert(expected.end(), second.begin(), second.end());
  for (const char* speed : {"0", "10", "1"}) {
    payloads_.clear();
    Start("source: CAPTURE capture_file: 'first.pcap' capture_file: 'second.pcap' cut_azimuth_deg: 0 capture_speed: " + std::string(speed));
    EXPECT_EQ(child_->Wait(seconds(10)).value_or(-1), 0) << child_->Output();
    WaitUntil([&] { return payloads_.size() == expected.size(); }, seconds(2));
    EXPECT_TRUE(payloads_ == expected) << "speed " << speed << ": " << payloads_.size();
  }
  const auto result = Run("source: CAPTURE capture_file: 'first.pcap' capture_file: 'third.pcap' cut_azimuth_deg: 0", {Program()});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.output.find("third.pcap"), std::string::npos) << result.output;
  WaitUntil([] { return false; }, seconds(1));
  EXPECT_EQ(payloads_.size(), expected.size());  // nothing was published before the fault
}

TEST_F(SourcesTest, HangupWithAWrongConfigGoesOnAndWithARightOneStartsAgain) {
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
  EXPECT_TRUE(WaitForOutput("goes on with the old one"));
  for (const char* fault : {"cut_azimuth_deg: must be", "receive_buffer_bytes: must be"}) {
    EXPECT_NE(child_->Output().find(fault), std::string::npos) << child_->Output();
  }
  EXPECT_TRUE(WaitForScans(3));
  EXPECT_EQ(starts_.size(), 1U);
  EXPECT_EQ(num_ends_, 0);

  for (int round = 1; round <= 3; ++round) {
    WriteConfig(config + std::to_string(90 * round));
    child_->Signal(SIGHUP);
    ASSERT_TRUE(WaitUntil([&] { return starts_.size() == static_cast<std::size_t>(round + 1); })) << child_->Output();
    EXPECT_EQ(starts_.back(), 0);
    EXPECT_EQ(num_ends_, round);
    health_ = {};
    EXPECT_TRUE(WaitForScans(3));
    EXPECT_TRUE(WaitUntil([&] { return health_.pid == pid; })) << health_.pid;
  }
  // Nothing of the starts before is left open.
  const auto num_open = std::distance(fs::directory_iterator("/proc/" + std::to_string(pid) + "/fd"), fs::directory_iterator{});
  EXPECT_LT(num_open, 12);
  EXPECT_EQ(child_->Terminate().value_or(-1), 0) << child_->Output();
}

TEST_F(SourcesTest, ATerminationDuringANewStartIsNotLost) {
  Start("source: UDP bind_address: '0.0.0.0' cut_azimuth_deg: 0");
  ASSERT_TRUE(WaitForOutput("starts"));
  child_->Signal(SIGSTOP);
  child_->Signal(SIGHUP);
  child_->Signal(SIGTERM);
  child_->Signal(SIGCONT);
  EXPECT_EQ(child_->Wait(seconds(5)).value_or(-1), 0) << child_->Output();
}

}  // namespace
}  // namespace lookout::system_test
