#include "common/io/udp_receiver.hpp"

#include <arpa/inet.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <gtest/gtest.h>

#include "tests/support/socket.hpp"

namespace lookout::io {
namespace {

using Payload = std::vector<std::uint8_t>;

struct Route {
  std::string from = "127.0.0.1";
  std::string to = "127.0.0.1";
};

void Send(int port, const Payload& payload, const Route& route = {}) {
  const support::Socket sender(SOCK_DGRAM);
  EXPECT_TRUE(sender.Bind(0, route.from));
  const auto interface = support::Ipv4(route.from, 0).sin_addr;
  EXPECT_EQ(setsockopt(sender.descriptor(), IPPROTO_IP, IP_MULTICAST_IF, &interface, sizeof interface), 0);
  EXPECT_TRUE(sender.SendTo(support::Ipv4(route.to, port), payload));
}

UdpOptions On(const std::string& address, int receive_buffer_bytes = 1 << 16) {
  UdpOptions options;
  options.bind_address = address;
  options.receive_buffer_bytes = receive_buffer_bytes;
  return options;
}

std::optional<Source::Piece> Wait(UdpReceiver& receiver) {
  pollfd descriptor{receiver.file_descriptor(), POLLIN, 0};
  poll(&descriptor, 1, 2000);
  return receiver.Receive({});
}

std::string FaultOf(const UdpOptions& options) {
  try {
    const UdpReceiver receiver(options);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(UdpReceiver, GivesWhatWasSentWithTimeAndSource) {
  UdpReceiver receiver(On("127.0.0.1"));
  EXPECT_GT(receiver.port(), 0);
  EXPECT_GE(receiver.receive_buffer_bytes(), 1 << 16);
  EXPECT_FALSE(receiver.Receive({}));
  Send(receiver.port(), {1, 2, 3});
  const auto datagram = Wait(receiver);
  ASSERT_TRUE(datagram);
  EXPECT_EQ(Payload(datagram->bytes.begin(), datagram->bytes.end()), (Payload{1, 2, 3}));
  EXPECT_EQ(datagram->source_address, "127.0.0.1");
  EXPECT_EQ(datagram->port, receiver.port());
  const auto age = std::chrono::system_clock::now() - datagram->host_time;
  EXPECT_LT(std::chrono::abs(age), std::chrono::seconds(5));
  EXPECT_FALSE(receiver.Receive({}));
}

TEST(UdpReceiver, TakesEmptyAndLargeDatagrams) {
  UdpReceiver receiver(On("0.0.0.0", 1 << 18));
  Send(receiver.port(), {});
  Send(receiver.port(), Payload(60'000, 7));
  EXPECT_EQ(Wait(receiver)->bytes.size(), 0U);
  EXPECT_EQ(Wait(receiver)->bytes.size(), 60'000U);
}

TEST(UdpReceiver, CountsWhatTheKernelDropped) {
  UdpReceiver receiver(On("127.0.0.1", 4096));
  constexpr int kNumSent = 500;
  for (int i = 0; i < kNumSent; ++i) Send(receiver.port(), Payload(1206, 1));
  int num_received = 0;
  while (receiver.Receive({})) ++num_received;
  EXPECT_LT(num_received, kNumSent);
  EXPECT_EQ(receiver.num_kernel_drops(), kNumSent - num_received);  // at once, not with the next datagram
  EXPECT_EQ(receiver.num_kernel_drops(), kNumSent - num_received);
}

TEST(UdpReceiver, RefusesAndCountsOtherSources) {
  auto options = On("0.0.0.0");
  options.allowed_source_addresses = {"192.168.1.201", "127.0.0.2"};
  UdpReceiver receiver(options);
  Send(receiver.port(), {1});
  Send(receiver.port(), {2}, {.from = "127.0.0.2"});
  Send(receiver.port(), {3}, {.from = "127.0.0.3"});
  const auto datagram = Wait(receiver);
  ASSERT_TRUE(datagram);
  EXPECT_EQ(datagram->bytes[0], 2);
  EXPECT_EQ(datagram->source_address, "127.0.0.2");
  EXPECT_FALSE(receiver.Receive({}));
  EXPECT_EQ(receiver.num_source_refused(), 2);
}

TEST(UdpReceiver, KnowsAnAllowedIpv4SourceOnAnIpv6Socket) {
  auto options = On("::");
  options.allowed_source_addresses = {"127.0.0.1"};
  if (!FaultOf(options).empty()) GTEST_SKIP() << "this computer has no IPv6";
  UdpReceiver receiver(options);
  Send(receiver.port(), {1});
  EXPECT_TRUE(Wait(receiver));
}

TEST(UdpReceiver, LetsItsCallerGoInAFloodOfRefusedDatagrams) {
  auto options = On("127.0.0.1", 1 << 20);
  options.allowed_source_addresses = {"127.0.0.2"};
  UdpReceiver receiver(options);
  for (int i = 0; i < UdpReceiver::kMaxRefusedPerCall + 10; ++i) Send(receiver.port(), {1});
  EXPECT_FALSE(Wait(receiver));
  EXPECT_EQ(receiver.num_source_refused(), UdpReceiver::kMaxRefusedPerCall);
  EXPECT_FALSE(receiver.is_empty());
  EXPECT_LT(std::chrono::abs(std::chrono::system_clock::now() - receiver.last_time()), std::chrono::seconds(5));
  EXPECT_FALSE(receiver.Receive({}));
  EXPECT_EQ(receiver.num_source_refused(), UdpReceiver::kMaxRefusedPerCall + 10);
  EXPECT_TRUE(receiver.is_empty());
}

TEST(UdpReceiver, JoinsAMulticastGroupOfAnInterface) {
  auto options = On("0.0.0.0");
  options.interface = "lo";
  options.multicast_group = "239.1.2.3";
  UdpReceiver receiver(options);
  Send(receiver.port(), {5}, {.to = "239.1.2.3"});
  const auto datagram = Wait(receiver);
  ASSERT_TRUE(datagram);
  EXPECT_EQ(datagram->bytes[0], 5);
}

TEST(UdpReceiver, IsDeafToGroupsThatOthersHaveJoined) {
  auto options = On("0.0.0.0");
  options.interface = "lo";
  options.multicast_group = "239.1.2.4";
  UdpReceiver receiver(options);
  options.multicast_group = "239.1.2.5";
  const UdpReceiver other(options);
  Send(receiver.port(), {5}, {.to = "239.1.2.5"});
  pollfd descriptor{receiver.file_descriptor(), POLLIN, 0};
  EXPECT_EQ(poll(&descriptor, 1, 100), 0);
}

TEST(UdpReceiver, TakesDatagramsOfItsInterfaceAlone) {
  auto options = On("127.0.0.1");
  options.interface = "lo";
  UdpReceiver receiver(options);
  Send(receiver.port(), {1});
  EXPECT_TRUE(Wait(receiver));
  EXPECT_EQ(receiver.Poll(Utime(std::chrono::seconds(1))), "");
  EXPECT_EQ(receiver.num_reopened(), 0);
}

TEST(UdpReceiver, SaysWhyItCannotListen) {
  const UdpReceiver first(On("127.0.0.1"));
  auto options = On("127.0.0.1");
  options.port = first.port();
  const auto taken = FaultOf(options);
  EXPECT_NE(taken.find("'127.0.0.1' port " + std::to_string(first.port())), std::string::npos) << taken;
  EXPECT_NE(taken.find("ss -ulpn"), std::string::npos) << taken;
  EXPECT_NE(FaultOf(On("no address")).find("no address"), std::string::npos);
  EXPECT_NE(FaultOf(On("192.0.2.1")).find("ip address"), std::string::npos) << FaultOf(On("192.0.2.1"));
  options = On("0.0.0.0");
  options.interface = "nosuch0";
  EXPECT_NE(FaultOf(options).find("there is no interface 'nosuch0' now (there are: lo"), std::string::npos) << FaultOf(options);
  const auto without_zone = FaultOf(On("fe80::1"));
  if (without_zone.find("family not supported") == std::string::npos) {
    EXPECT_NE(without_zone.find("fe80::1%eth0"), std::string::npos) << without_zone;
  }
  EXPECT_NE(FaultOf(On("fe80::1%nosuch0")).find("there is no interface 'nosuch0' now"), std::string::npos) << FaultOf(On("fe80::1%nosuch0"));
  options = On("0.0.0.0");
  options.multicast_group = "ff02::1";
  EXPECT_NE(FaultOf(options).find("same family"), std::string::npos) << FaultOf(options);
  options = On("0.0.0.0");
  options.allowed_source_addresses = {"lidar.local"};
  EXPECT_NE(FaultOf(options).find("lidar.local"), std::string::npos);
}

}  // namespace
}  // namespace lookout::io
