// A CAN interface as it is: on one of the kernel's own (vcan), in a network namespace that dies with this program. Without either it is skipped.
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sched.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <optional>

#include "tests/unit/plotter_io/links_test.hpp"

namespace lookout::plotter {
namespace {

// Empty: there is now a vcan0 that nobody else sees.
std::string MakeInterface() {
  if (unshare(CLONE_NEWNET) != 0 && unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) return std::string("no network namespace: ") + std::strerror(errno);
  const int descriptor = socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW);
  if (descriptor < 0) return std::string("this kernel has no SocketCAN: ") + std::strerror(errno);
  close(descriptor);
  const bool is_made = std::system("ip link add vcan0 type vcan && ip link set vcan0 up") == 0;
  return is_made ? "" : "this kernel has no vcan, or there is no ip";
}

// Another device of the network.
class Device {
 public:
  Device() : descriptor_(socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW)) {
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(if_nametoindex("vcan0"));
    EXPECT_EQ(bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  ~Device() { close(descriptor_); }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  void Send(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) const {
    can_frame frame{};
    frame.can_id = id;
    frame.can_dlc = static_cast<std::uint8_t>(bytes.size());
    std::copy(bytes.begin(), bytes.end(), frame.data);
    EXPECT_EQ(write(descriptor_, &frame, sizeof frame), static_cast<ssize_t>(sizeof frame));
  }
  std::optional<can_frame> Receive() const {
    can_frame frame{};
    return read(descriptor_, &frame, sizeof frame) == static_cast<ssize_t>(sizeof frame) ? std::optional(frame) : std::nullopt;
  }

 private:
  int descriptor_;
};

class CanLinkTest : public LinksTest {
 protected:
  void SetUp() override {
    static const std::string reason = MakeInterface();
    if (!reason.empty()) GTEST_SKIP() << reason;
    link_ = links_.Can({.name = "n2k", .interface = "vcan0"});
    ASSERT_TRUE(link_->is_open()) << link_->fault();
  }
  std::int64_t Of(const std::string& ending) const { return support::CountOf(*link_, "n2k_" + ending); }

  std::unique_ptr<Link> link_;
};

TEST_F(CanLinkTest, SendsAFrameForEachLine) {
  const Device other;
  link_->Send("18EEFF23 01 02 03\r\n09F80123\r\n");
  const auto first = other.Receive();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->can_id, 0x18EEFF23U | CAN_EFF_FLAG);
  EXPECT_EQ(first->can_dlc, 3);
  EXPECT_EQ(first->data[2], 3);
  const auto second = other.Receive();
  ASSERT_TRUE(second);
  EXPECT_EQ(second->can_id, 0x09F80123U | CAN_EFF_FLAG);
  EXPECT_EQ(second->can_dlc, 0);
  EXPECT_FALSE(other.Receive());
  EXPECT_EQ(Of("sent"), 2);
  link_->Send("no frame\r\n18EEFF23 01\r\n");
  EXPECT_FALSE(other.Receive());
  EXPECT_EQ(Of("dropped"), 1);
}

TEST_F(CanLinkTest, TellsOnlyOfWhatConcernsADevice) {
  const Device other;
  other.Send(0x09F80101 | CAN_EFF_FLAG, {1, 2});              // a position
  other.Send(0x6EA, {1, 2});                                  // of 11 bits
  other.Send(0x18EAFF01 | CAN_EFF_FLAG | CAN_RTR_FLAG, {});   // asks for a frame by hardware
  other.Send(0x18EAFF01 | CAN_EFF_FLAG, {0x00, 0xEE, 0x00});  // a request
  ASSERT_TRUE(Until([&] { return Of("received") > 0; }));
  PollFor(50ms);
  EXPECT_EQ(Of("received"), 1);
  EXPECT_EQ(link_->Receive(), "00:00:00.000 R 18EAFF01 00 EE 00");
  // Its own frames do not come back.
  link_->Send("18EEFF23 01\r\n");
  PollFor(50ms);
  EXPECT_FALSE(link_->Receive());
}

TEST_F(CanLinkTest, IsOpenedAgainWithItsInterface) {
  ASSERT_EQ(std::system("ip link set vcan0 down"), 0);
  EXPECT_TRUE(Until([&] { return !link_->is_open(); }));
  EXPECT_TRUE(Holds(link_->fault(), "CAN interface vcan0: ")) << link_->fault();
  ASSERT_EQ(std::system("ip link set vcan0 up"), 0);
  EXPECT_TRUE(Until([&] { return link_->is_open(); }));
  EXPECT_EQ(link_->fault(), "");
  EXPECT_EQ(link_->num_openings(), 2);
}

// Wherever it runs: with SocketCAN, and without.
TEST_F(LinksTest, SaysThatAnInterfaceIsNotThere) {
  const auto link = links_.Can({.name = "n2k", .interface = "can77"});
  EXPECT_FALSE(link->is_open());
  EXPECT_TRUE(link->fault().starts_with("CAN interface can77: ")) << link->fault();
  EXPECT_TRUE(Holds(link->fault(), "can77") && (Holds(link->fault(), "SocketCAN") || Holds(link->fault(), "interface"))) << link->fault();
  link->Send("18EEFF23 01\r\n");
  EXPECT_EQ(support::CountOf(*link, "n2k_unsent"), 1);
}

}  // namespace
}  // namespace lookout::plotter
