// lookout-lidar on its sources: sockets, an interface, captures.
#include "tests/system/sources.hpp"

namespace lookout::system_test {
namespace {

using namespace support;

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

// A call that only refused used to count as an empty socket: 64 datagrams in 5 ms.
TEST_F(SourcesTest, LoseNothingInAFloodThatIsRefused) {
  Start("source: UDP bind_address: '127.0.0.1' cut_azimuth_deg: 0 allowed_source_address: '127.0.0.1'");
  ASSERT_TRUE(WaitForOutput("starts"));
  const Lidar lidar("127.0.0.1", "127.0.0.1");
  ASSERT_TRUE(WaitForScans(3));
  {
    const Flood flood("127.0.0.2", 30'000);
    WaitUntil([] { return false; }, seconds(3));
  }
  ASSERT_TRUE(WaitForHealth(health_t::STATE_OK)) << health_.reason;
  EXPECT_GT(Counter("data_source_refused"), 50'000);
  EXPECT_EQ(Counter("data_kernel_drops"), 0);
  EXPECT_EQ(Counter("data_lost"), 0);
}

TEST_F(SourcesTest, CaptureLosesNothingInAFloodThatIsRefused) {
  Start("source: INTERFACE interface: 'lo' cut_azimuth_deg: 0 allowed_source_address: '127.0.0.1'");
  ASSERT_TRUE(WaitForOutput("starts"));
  const Lidar lidar("127.0.0.1", "127.0.0.1");
  ASSERT_TRUE(WaitForScans(3));
  {
    const Flood flood("127.0.0.2", 30'000);
    WaitUntil([] { return false; }, seconds(3));
  }
  ASSERT_TRUE(WaitForHealth(health_t::STATE_OK)) << health_.reason;
  EXPECT_GT(Counter("capture_source_refused"), 50'000);
  EXPECT_EQ(Counter("capture_kernel_drops"), 0);
  EXPECT_EQ(Counter("data_lost"), 0);
}

// A second lidar at the full rate beside the one that is taken, on either kind of source.
TEST_F(SourcesTest, TakeOneOfTwoLidarsWholeAndNameTheOther) {
  for (const char* source : {"source: UDP bind_address: '127.0.0.1' cut_azimuth_deg: 0", "source: INTERFACE interface: 'lo' cut_azimuth_deg: 0"}) {
    health_ = {};
    Start(source);
    ASSERT_TRUE(WaitForOutput("starts"));
    const Lidar lidar("127.0.0.1", "127.0.0.1");
    ASSERT_TRUE(WaitForScans(3)) << child_->Output();
    {
      const Lidar other("127.0.0.2", "127.0.0.1");
      WaitUntil([] { return false; }, seconds(3));
      ASSERT_TRUE(WaitForHealth(health_t::STATE_DEGRADED)) << source;
      EXPECT_NE(health_.reason.find("two lidars on one port: 127.0.0.2:" + std::to_string(other.port())), std::string::npos) << health_.reason;
      EXPECT_NE(health_.reason.find("127.0.0.1:" + std::to_string(lidar.port())), std::string::npos) << health_.reason;
    }
    ASSERT_TRUE(WaitForHealth(health_t::STATE_OK)) << health_.reason;
    EXPECT_GT(Counter("data_sender_refused"), 1000) << source;
    for (const char* counter : {"data_lost", "data_late", "data_overlapping", "data_azimuth_disagrees", "sensor_restarts", "sensor_clock_steps"}) {
      EXPECT_EQ(Counter(counter), 0) << source << ' ' << counter;
    }
    child_->Terminate();
  }
}

// A simulator or a forwarder sends from another port when it starts again.
TEST_F(SourcesTest, TakeTheSameAddressWithAnotherPortAfterASecond) {
  Start("source: UDP bind_address: '127.0.0.1' cut_azimuth_deg: 0");
  ASSERT_TRUE(WaitForOutput("starts"));
  {
    const Lidar lidar("127.0.0.1", "127.0.0.1");
    ASSERT_TRUE(WaitForScans(3)) << child_->Output();
  }
  const auto since = std::chrono::steady_clock::now();
  const Lidar again("127.0.0.1", "127.0.0.1");
  EXPECT_TRUE(WaitForScans(3)) << child_->Output();
  EXPECT_LT(std::chrono::steady_clock::now() - since, seconds(8));  // a second and the scans; another address would take ten
  EXPECT_TRUE(WaitUntil([&] { return Counter("lidar_changes") == 1; }));
}

TEST_F(SourcesTest, SayThatTheLidarIsSilentInAFloodThatNeverEnds) {
  Start("source: UDP bind_address: '127.0.0.1' cut_azimuth_deg: 0");
  ASSERT_TRUE(WaitForOutput("starts"));
  {
    const Lidar lidar("127.0.0.1", "127.0.0.1");
    ASSERT_TRUE(WaitForScans(3));
  }
  const Flood first("127.0.0.1", 0);
  const Flood second("127.0.0.2", 0);
  EXPECT_TRUE(WaitForHealth(health_t::STATE_DEGRADED, seconds(5))) << child_->Output();
  EXPECT_EQ(health_.reason.rfind("no lidar packets for ", 0), 0U) << health_.reason;
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
    ASSERT_TRUE(WaitForHealth(health_t::STATE_DEGRADED)) << child_->Output();
    mend_it();
    const Lidar lidar("10.7.7.1", group);
    EXPECT_TRUE(WaitForScans(3)) << child_->Output();
    EXPECT_TRUE(WaitForHealth(health_t::STATE_OK)) << health_.reason;
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

TEST_F(CableTest, CaptureTellsOfAnInterfaceThatWasPulledForAMoment) {
  Start(kOnLidar0);
  ASSERT_TRUE(WaitForOutput("starts"));
  Unplug();
  Plug();
  EXPECT_TRUE(WaitForOutput("captures again on interface 'lidar0'")) << child_->Output();
  EXPECT_TRUE(WaitUntil([&] { return Counter("capture_outages") == 1; })) << Counter("capture_outages");
}

TEST_F(CableTest, SocketSaysWhyItStaysDeaf) {
  System("ip addr add 10.7.7.2/24 dev lidar0");
  Start("source: UDP bind_address: '10.7.7.2' interface: 'lidar0' cut_azimuth_deg: 0");
  ASSERT_TRUE(WaitForOutput("hears only what is sent to 10.7.7.2"));
  System("ip link set lidar0 down");
  EXPECT_TRUE(WaitForOutput("interface 'lidar0' is down")) << child_->Output();
  Unplug();
  EXPECT_TRUE(WaitForOutput("interface 'lidar0' has gone")) << child_->Output();
  Plug();  // without its address
  EXPECT_TRUE(WaitForOutput("is back, but not ready")) << child_->Output();
  EXPECT_TRUE(WaitUntil([&] { return health_.reason.find("ip address lists") != std::string::npos; })) << health_.reason;
  System("ip addr add 10.7.7.2/24 dev lidar0");
  EXPECT_TRUE(WaitForOutput("interface 'lidar0' is back\n")) << child_->Output();
  EXPECT_TRUE(WaitUntil([&] { return Counter("sockets_reopened") == 2; })) << Counter("sockets_reopened");
}

TEST_F(CableTest, SocketFollowsTheInterfaceThatItsAddressNames) {
  const auto add_address = [] { return System("ip -6 addr add fe80::77/64 dev lidar0 nodad") == 0; };
  if (!add_address()) GTEST_SKIP() << "this computer has no IPv6";
  Start("source: UDP bind_address: 'fe80::77%lidar0' cut_azimuth_deg: 0");
  ASSERT_TRUE(WaitForOutput("starts"));
  Unplug();
  ASSERT_TRUE(WaitForOutput("interface 'lidar0' has gone")) << child_->Output();
  Plug();
  ASSERT_TRUE(add_address());
  EXPECT_TRUE(WaitUntil([&] { return Counter("sockets_reopened") == 2; })) << child_->Output();
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
  const auto absent = Run("source: INTERFACE interface: 'nosuch0' cut_azimuth_deg: 0", {Program()});
  EXPECT_EQ(absent.exit_code, 1);
  EXPECT_NE(absent.output.find("(there are: lo"), std::string::npos) << absent.output;
  EXPECT_EQ(absent.output.find("lidar: lidar:"), std::string::npos) << absent.output;
}

TEST_F(SourcesTest, FaultsOfAllKindsAreNamedAtOnce) {
  const auto result =
      Run("source: UDP\nbind_address: 'nonsense'\ndata_port: 8308\ncut_azimuth_deg: 0\nallowed_source_address: '192.168.1.201'\n"
          "allowed_source_address: '192.168.1.300'",
          {Program(), "--check"});
  EXPECT_EQ(result.exit_code, 2);
  for (const char* fault : {"Z critical lidar: ", ":2: bind_address:", ":3: data_port:", ":6: allowed_source_address: '192.168.1.300'"}) {
    EXPECT_NE(result.output.find(fault), std::string::npos) << fault << " is not in " << result.output;
  }
  const auto deaf = Run("source: UDP\nbind_address: '127.0.0.1'\nmulticast_group: '239.9.9.9'\ncut_azimuth_deg: 0", {Program(), "--check"});
  EXPECT_EQ(deaf.exit_code, 2);
  EXPECT_NE(deaf.output.find(":2: bind_address: must be 0.0.0.0"), std::string::npos) << deaf.output;
  const auto capture = Run("source: CAPTURE\ncut_azimuth_deg: 0\ncapture_file: 'missing.pcap'", {Program(), "--check"});
  EXPECT_EQ(capture.exit_code, 2);
  EXPECT_NE(capture.output.find(":3: capture_file:"), std::string::npos) << capture.output;
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
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.output.find("third.pcap"), std::string::npos) << result.output;
  WaitUntil([] { return false; }, seconds(1));
  EXPECT_EQ(payloads_.size(), expected.size());  // nothing was published before the fault
}

}  // namespace
}  // namespace lookout::system_test
