// The kernel runs the program on real sockets; what it should take is said once more, as a plain function.
#include "common/bus/datagram_filter.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <gtest/gtest.h>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/bus/guarded_bind.hpp"
#include "common/bus/lcm_url.hpp"
#include "tests/support/socket.hpp"
#include "tests/system/lcm_datagrams.hpp"

namespace lookout::bus {
namespace {

using system_test::Datagram;
using system_test::FragmentDatagram;
using system_test::HostileDatagrams;
using system_test::Mutated;
using system_test::Named;
using system_test::ShortDatagram;
using system_test::SoundDatagrams;

std::uint64_t Number(const Datagram& datagram, std::size_t place, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) value = value << 8 | datagram[place + i];
  return value;
}

// Bytes of the name at `place` with its NUL; 0 when it is none.
std::size_t NameBytes(const Datagram& datagram, std::size_t place) {
  for (std::size_t i = 0; i <= 63 && place + i < datagram.size(); ++i) {
    const auto letter = datagram[place + i];
    if (letter == 0) return i == 0 ? 0 : i + 1;
    if (letter < 0x20 || letter > 0x7E) return 0;
  }
  return 0;
}

// What LCM's receiver is safe with.
bool IsSound(const Datagram& datagram) {
  if (datagram.size() < 8) return false;
  const auto magic = Number(datagram, 0, 4);
  if (magic == 0x4c433032) return NameBytes(datagram, 8) > 0;
  if (magic != 0x4c433033 || datagram.size() < 20) return false;
  const auto size = Number(datagram, 8, 4);
  const auto offset = Number(datagram, 12, 4);
  const auto fragment = Number(datagram, 16, 2);
  const auto num_fragments = Number(datagram, 18, 2);
  if (fragment >= num_fragments || size > 16U * 1024 * 1024 || size > num_fragments * 65'487) return false;
  std::uint64_t num_bytes = datagram.size() - 20;
  if (fragment == 0) {
    const auto name_bytes = NameBytes(datagram, 20);
    if (name_bytes == 0) return false;
    num_bytes -= name_bytes;
  }
  return offset + num_bytes <= size;
}

// A socket of 127.0.0.1 with the filter, and one that sends to it. For the program any address is a group.
class FilteredSocket {
 public:
  explicit FilteredSocket(DatagramPolicy policy, std::uint16_t port_of_policy = 0) {
    receiver_.Set(SO_RCVBUF, 8 << 20);
    EXPECT_TRUE(receiver_.Bind(0));
    policy.port = port_of_policy != 0 ? port_of_policy : static_cast<std::uint16_t>(receiver_.port());
    auto program = DatagramFilter(policy);
    const sock_fprog filter{static_cast<unsigned short>(program.size()), program.data()};
    EXPECT_EQ(setsockopt(receiver_.descriptor(), SOL_SOCKET, SO_ATTACH_FILTER, &filter, sizeof filter), 0) << "the kernel refuses the program";
  }

  // Another datagram behind it says when it would have arrived.
  bool IsTaken(const Datagram& datagram) {
    Send(datagram);
    const auto last = ShortDatagram(0xFFFFFFFF, Named("LAST"), 0);
    Send(last);
    bool is_taken = false;
    Datagram received(65'536);
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (std::chrono::steady_clock::now() < deadline) {
      const auto size = recv(receiver_.descriptor(), received.data(), received.size(), MSG_DONTWAIT);
      if (size < 0) {
        std::this_thread::yield();
        continue;
      }
      const Datagram one(received.begin(), received.begin() + size);
      if (one == last) return is_taken;
      is_taken = true;
      EXPECT_EQ(one, datagram);
    }
    ADD_FAILURE() << "the last datagram did not arrive";
    return is_taken;
  }

  int receiver() const { return receiver_.descriptor(); }

  void Send(const Datagram& datagram) const { EXPECT_TRUE(sender_.SendTo(support::Ipv4("127.0.0.1", receiver_.port()), datagram)); }

 private:
  support::Socket receiver_{SOCK_DGRAM};
  support::Socket sender_{SOCK_DGRAM};
};

std::string Hex(const Datagram& datagram) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(datagram.size(), 40); ++i) {
    constexpr const char* kDigits = "0123456789abcdef";
    text += {kDigits[datagram[i] >> 4], kDigits[datagram[i] & 0xF]};
  }
  return text + " of " + std::to_string(datagram.size());
}

TEST(DatagramFilter, TakesWhatIsSoundAndDropsWhatIsNot) {
  FilteredSocket socket({.group = INADDR_LOOPBACK, .port = 0, .is_this_computer_only = true});
  for (const auto& datagram : SoundDatagrams()) {
    EXPECT_TRUE(IsSound(datagram)) << Hex(datagram);
    EXPECT_TRUE(socket.IsTaken(datagram)) << Hex(datagram);
  }
  for (const auto& hostile : HostileDatagrams()) {
    EXPECT_FALSE(IsSound(hostile.datagram)) << hostile.what;
    EXPECT_FALSE(socket.IsTaken(hostile.datagram)) << hostile.what;
  }
  EXPECT_EQ(NumDropped(socket.receiver()), static_cast<std::int64_t>(HostileDatagrams().size()));
}

TEST(DatagramFilter, IsExactAtEachEdge) {
  FilteredSocket socket({.group = INADDR_LOOPBACK, .port = 0, .is_this_computer_only = false});
  constexpr std::uint32_t kMost = 16U * 1024 * 1024;
  int num_taken = 0;
  const auto check = [&](const Datagram& datagram) {
    const bool is_sound = IsSound(datagram);
    num_taken += is_sound ? 1 : 0;
    EXPECT_EQ(socket.IsTaken(datagram), is_sound) << Hex(datagram);
  };
  for (std::size_t size = 0; size <= 66; ++size) {
    check(ShortDatagram(1, std::string(size, 'N'), 0));
    check(ShortDatagram(1, Named(std::string(size, 'N')), 0));
    check(FragmentDatagram({1, 3, 0, 0, 1}, Named(std::string(size, 'N')), 3));
    check(FragmentDatagram({1, 3, 0, 0, 1}, std::string(size, 'N'), 0));
  }
  for (int letter = 0; letter < 256; ++letter) check(ShortDatagram(1, Named(std::string("A") + static_cast<char>(letter) + "B"), 2));
  for (std::size_t size = 0; size <= 30; ++size) {
    auto fragment = FragmentDatagram({1, 9, 0, 1, 2}, "", 10);
    fragment.resize(size);
    check(fragment);
  }
  for (const std::uint32_t size : {0U, 1U, 65'487U, 65'488U, kMost - 1, kMost, kMost + 1, 0x7FFFFFFFU, 0x80000000U, 0xFFFFFFFFU}) {
    for (const std::uint32_t offset : {0U, 1U, size - 11, size - 10, size - 9, size, size + 1, 0x7FFFFFFFU, 0x80000000U, 0U - 10, 0U - 1}) {
      for (const std::uint16_t num_fragments : {0, 1, 2, 257, 65'535}) {
        for (const std::uint16_t fragment : {0, 1, 256, 65'534, 65'535}) {
          check(FragmentDatagram({1, size, offset, fragment, num_fragments}, fragment == 0 ? Named("A") : "", 10));
        }
      }
    }
  }
  // The largest that UDP carries.
  check(FragmentDatagram({1, kMost, 0, 0, 300}, Named("A"), 65'487 - 2));
  check(ShortDatagram(1, Named("A"), 65'507 - 10));
  EXPECT_GT(num_taken, 300);
}

TEST(DatagramFilter, DecidesAsThePlainFunctionOnRandomDatagrams) {
  FilteredSocket socket({.group = INADDR_LOOPBACK, .port = 0, .is_this_computer_only = false});
  const auto sound = SoundDatagrams();
  std::mt19937 random(20'261'122);
  int num_taken = 0;
  constexpr int kNumDatagrams = 30'000;
  for (int i = 0; i < kNumDatagrams; ++i) {
    const auto datagram = Mutated(sound, random);
    const bool is_sound = IsSound(datagram);
    num_taken += is_sound ? 1 : 0;
    ASSERT_EQ(socket.IsTaken(datagram), is_sound) << Hex(datagram);
  }
  EXPECT_GT(num_taken, kNumDatagrams / 5);
  EXPECT_LT(num_taken, kNumDatagrams * 4 / 5);
}

// @return whether one datagram of this computer arrives within a moment
bool Arrives(const DatagramPolicy& policy, std::uint16_t port_of_policy = 0) {
  FilteredSocket socket(policy, port_of_policy);
  socket.Send(SoundDatagrams().front());
  for (int i = 0; i < 50; ++i) {
    Datagram received(65'536);
    if (recv(socket.receiver(), received.data(), received.size(), MSG_DONTWAIT) >= 0) return true;
    if (NumDropped(socket.receiver()) > 0) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return false;
}

TEST(DatagramFilter, TakesNothingThatWasSentElsewhereOrCameByAnotherInterface) {
  EXPECT_TRUE(Arrives({.group = INADDR_LOOPBACK, .is_this_computer_only = true}));
  EXPECT_FALSE(Arrives({.group = 0xEFFF4C43}));
  EXPECT_FALSE(Arrives({.group = INADDR_LOOPBACK}, 7));
  // As if lo were another interface.
  EXPECT_FALSE(Arrives({.group = INADDR_LOOPBACK, .is_this_computer_only = true, .loopback_index = 99}));
  EXPECT_TRUE(Arrives({.group = INADDR_LOOPBACK, .is_this_computer_only = false, .loopback_index = 99}));
}

TEST(BindGuard, PutsAFilterOnWhatIsBoundBeforeItIsBound) {
  std::vector<sock_filter> nothing{{BPF_RET | BPF_K, 0, 0, 0}};
  const int udp = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const int tcp = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int later = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  {
    BindGuard guard(nothing);
    EXPECT_EQ(bind(udp, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(bind(tcp, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(guard.sockets(), std::vector<int>{udp});
    EXPECT_EQ(guard.fault(), "");
    EXPECT_NE(setsockopt(udp, SOL_SOCKET, SO_DETACH_FILTER, nullptr, 0), 0) << "the filter is not locked";
    // Another thread's sockets are its own.
    std::thread([&] { EXPECT_EQ(bind(later, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0); }).join();
    EXPECT_EQ(guard.sockets().size(), 1U);
  }
  EXPECT_EQ(bind(-1, reinterpret_cast<const sockaddr*>(&address), sizeof address), -1);
  EXPECT_EQ(errno, EBADF);
  for (const int descriptor : {udp, tcp, later}) close(descriptor);
}

TEST(BindGuard, SaysWhyTheKernelTakesNoFilter) {
  BindGuard guard({{BPF_LD | BPF_IMM, 0, 0, 0}});  // a program without an end
  const int udp = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  guard.OnBind(udp);
  EXPECT_NE(guard.fault().find("takes no filter"), std::string::npos) << guard.fault();
  EXPECT_TRUE(guard.sockets().empty());
  close(udp);
}

TEST(LcmUrl, TakesWhatABusCanBe) {
  for (const char* url : {"udpm://239.255.76.67:7667?ttl=0", "udpm://", "udpm://239.1.2.3", "udpm://?ttl=1",
                          "udpm://224.0.0.1:1?ttl=255&recv_buf_size=65536", "tcpq://localhost:7700"}) {
    EXPECT_EQ(LcmUrlFault(url), "");
  }
  const auto address = ParseMulticast("udpm://239.1.2.3:7000?recv_buf_size=1&ttl=7");
  ASSERT_TRUE(address);
  EXPECT_EQ(address->group, "239.1.2.3");
  EXPECT_EQ(address->port, 7000);
  EXPECT_EQ(address->time_to_live, 7);
  EXPECT_FALSE(ParseMulticast("tcpq://localhost:7700"));
}

TEST(LcmUrl, RefusesTheOthersWithAReason) {
  const std::vector<std::pair<std::string, std::string>> wrong{{"memq://", "stays inside one process"},
                                                               {"file:///tmp/a.lcmlog?mode=r", "is a log"},
                                                               {"mpudpm://239.255.76.67:7667", "port per channel"},
                                                               {"", "neither udpm:// nor tcpq://"},
                                                               {"239.255.76.67:7667", "neither udpm:// nor tcpq://"},
                                                               {"udpm://239.255.76.67:7667?ttl=256", "ttl=256"},  // LCM takes it for 0
                                                               {"udpm://239.255.76.67:7667?ttl=-1", "ttl=-1"},
                                                               {"udpm://239.255.76.67:7667?ttl=one", "ttl=one"},
                                                               {"udpm://239.255.76.67:7667?ttl=", "ttl="},
                                                               {"udpm://239.255.76.67:7667?ttl", "ttl="},
                                                               {"udpm://239.255.76.67:7667?ttl=1x", "ttl=1x"},
                                                               {"udpm://239.255.76.67:7667?tll=1", "\"tll\""},
                                                               {"udpm://239.255.76.67:7667?ttl=1,recv_buf_size=9", "ttl=1,"},
                                                               {"udpm://239.255.76.67:7667?recv_buf_size=0", "recv_buf_size=0"},
                                                               {"udpm://239.255.76.67:0", "port \"0\""},
                                                               {"udpm://239.255.76.67:70000", "port \"70000\""},
                                                               {"udpm://239.255.76.67:07667", "port \"07667\""},  // to LCM 4023
                                                               {"udpm://239.255.76.67:", "port \"\""},
                                                               {"udpm://192.168.1.10:7667", "192.168.1.10 is no IPv4 multicast group"},
                                                               {"udpm://[ff02::1]:7667", "no IPv4 multicast group"},
                                                               {"udpm://\x1b[2J:7667", "?[2J"}};
  for (const auto& [url, reason] : wrong) {
    EXPECT_NE(LcmUrlFault(url).find(reason), std::string::npos) << url << ": " << LcmUrlFault(url);
    EXPECT_FALSE(ParseMulticast(url)) << url;
  }
  EXPECT_LT(LcmUrlFault("udpm://239.255.76.67:7667?ttl=" + std::string(100'000, '9')).size(), 1000U) << "is printed at each start";
}

}  // namespace
}  // namespace lookout::bus
