#include "common/io/udp_receiver.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <gtest/gtest.h>

namespace lookout::io {
namespace {

void Send(int port, const std::vector<std::uint8_t>& payload) {
  const int sender = socket(AF_INET, SOCK_DGRAM, 0);
  ASSERT_GE(sender, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(sendto(sender, payload.data(), payload.size(), 0, reinterpret_cast<const sockaddr*>(&address), sizeof address),
            static_cast<ssize_t>(payload.size()));
  close(sender);
}

std::optional<ReceivedDatagram> Wait(UdpReceiver& receiver) {
  pollfd descriptor{receiver.file_descriptor(), POLLIN, 0};
  poll(&descriptor, 1, 2000);
  return receiver.Receive();
}

TEST(UdpReceiver, GivesWhatWasSentWithTimeAndSource) {
  UdpReceiver receiver("127.0.0.1", 0, 1 << 16);
  EXPECT_GT(receiver.port(), 0);
  EXPECT_GE(receiver.receive_buffer_bytes(), 1 << 16);
  EXPECT_FALSE(receiver.Receive());
  Send(receiver.port(), {1, 2, 3});
  const auto datagram = Wait(receiver);
  ASSERT_TRUE(datagram);
  EXPECT_EQ(datagram->payload, (std::vector<std::uint8_t>{1, 2, 3}));
  EXPECT_EQ(datagram->source_address, "127.0.0.1");
  EXPECT_EQ(datagram->port, receiver.port());
  const auto age = std::chrono::system_clock::now() - datagram->host_time;
  EXPECT_LT(std::chrono::abs(age), std::chrono::seconds(5));
  EXPECT_FALSE(receiver.Receive());
}

TEST(UdpReceiver, TakesEmptyAndLargeDatagrams) {
  UdpReceiver receiver("0.0.0.0", 0, 1 << 18);
  Send(receiver.port(), {});
  Send(receiver.port(), std::vector<std::uint8_t>(60'000, 7));
  EXPECT_EQ(Wait(receiver)->payload.size(), 0U);
  EXPECT_EQ(Wait(receiver)->payload.size(), 60'000U);
}

TEST(UdpReceiver, CountsWhatTheKernelDropped) {
  UdpReceiver receiver("127.0.0.1", 0, 4096);
  constexpr int kNumSent = 500;
  for (int i = 0; i < kNumSent; ++i) Send(receiver.port(), std::vector<std::uint8_t>(1206, 1));
  int num_received = 0;
  while (receiver.Receive()) ++num_received;
  // The kernel says it with the next datagram that it takes.
  Send(receiver.port(), {9});
  ASSERT_TRUE(Wait(receiver));
  EXPECT_LT(num_received, kNumSent);
  EXPECT_EQ(receiver.num_kernel_drops(), kNumSent - num_received);
}

TEST(UdpReceiver, SaysWhyItCannotListen) {
  const UdpReceiver first("127.0.0.1", 0, 4096);
  try {
    const UdpReceiver second("127.0.0.1", first.port(), 4096);
    FAIL() << "two on one port";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find(std::to_string(first.port())), std::string::npos);
  }
  EXPECT_THROW(UdpReceiver("no address", 0, 4096), std::runtime_error);
}

}  // namespace
}  // namespace lookout::io
