// Bus, route, buffers and interfaces, as the kernel tells them.
#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>

#include "common/bus/lcm_bus.hpp"
#include "tools/doctor/machine.hpp"

namespace lookout::doctor {

namespace {

class UdpSocket {
 public:
  UdpSocket() : descriptor_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}
  ~UdpSocket() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;

  // Bytes that the kernel keeps for waiting datagrams.
  std::int64_t ReceiveBuffer() const {
    int size = 0;
    socklen_t length = sizeof size;
    return getsockopt(descriptor_, SOL_SOCKET, SO_RCVBUF, &size, &length) == 0 ? size : 0;
  }
  void AskForReceiveBuffer(int size) const { setsockopt(descriptor_, SOL_SOCKET, SO_RCVBUF, &size, sizeof size); }

 private:
  int descriptor_;
};

std::string TextOfFile(const char* path) {
  std::ifstream in(path);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

InterfaceSeen ToInterface(const ifaddrs& entry) {
  InterfaceSeen interface;
  interface.name = entry.ifa_name;
  // RUNNING stands for the carrier.
  interface.has_carrier = (entry.ifa_flags & IFF_UP) != 0 && (entry.ifa_flags & IFF_RUNNING) != 0;
  interface.is_loopback = (entry.ifa_flags & IFF_LOOPBACK) != 0;
  return interface;
}

// Numeric; empty for what is no IP address.
std::string AddressText(const sockaddr* address) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (address == nullptr) return {};
  if (address->sa_family == AF_INET) {
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(address)->sin_addr, text.data(), text.size());
  } else if (address->sa_family == AF_INET6) {
    inet_ntop(AF_INET6, &reinterpret_cast<const sockaddr_in6*>(address)->sin6_addr, text.data(), text.size());
  }
  return text.data();
}

int PrefixBits(const sockaddr* netmask) {
  const auto mask = io::ParseIpAddress(AddressText(netmask));
  if (!mask) return 0;
  // An IPv4 mask is mapped behind 80 zeros and 16 ones, which are none of its own.
  int num_bits = netmask->sa_family == AF_INET ? -16 : 0;
  for (const auto byte : mask->bytes) num_bits += std::popcount(byte);
  return num_bits;
}

}  // namespace

BusSeen ReadBus(const std::string& url) {
  BusSeen bus;
  bus.url = url;
  bus.fault = bus::LcmUrlFault(url);
  if (!bus.fault.empty()) return bus;
  const auto multicast = bus::ParseMulticast(url);
  if (!multicast) return bus;
  bus.group = multicast->group;
  bus.time_to_live = multicast->time_to_live;
  if (!bus::HasRoute(*multicast)) {
    bus.fault = "there is no route for multicast to " + bus.group + ": no process can start";
    return bus;
  }
  bus.route_device = DeviceOfRoute(TextOfFile("/proc/net/route"), bus.group);
  return bus;
}

std::string DeviceOfRoute(const std::string& table, const std::string& address) {
  in_addr target{};
  if (inet_pton(AF_INET, address.c_str(), &target) != 1) return {};
  constexpr unsigned int kUp = 0x1;        // RTF_UP
  constexpr unsigned int kReject = 0x200;  // RTF_REJECT
  std::string best;
  int best_bits = -1;
  long best_metric = 0;
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string device;
    std::string gateway;
    std::uint32_t destination = 0;
    unsigned int flags = 0;
    long references = 0;
    long uses = 0;
    long metric = 0;
    std::uint32_t mask = 0;
    // Addresses stand there as numbers of this machine, so they compare with those in memory.
    if (!(words >> device >> std::hex >> destination >> gateway >> flags >> std::dec >> references >> uses >> metric >> std::hex >> mask)) continue;
    if ((flags & kUp) == 0 || (flags & kReject) != 0 || (target.s_addr & mask) != destination) continue;
    const int num_bits = std::popcount(mask);
    if (num_bits < best_bits || (num_bits == best_bits && metric >= best_metric)) continue;
    best = device;
    best_bits = num_bits;
    best_metric = metric;
  }
  return best;
}

BuffersSeen ReadBuffers(const ConfigSeen& config) {
  BuffersSeen buffers;
  buffers.asked = bus::kReceiveBufferBytes;
  if (config.lidar) buffers.asked = std::max<std::int64_t>(buffers.asked, config.lidar->sources.receive_buffer_bytes);
  const UdpSocket socket;
  buffers.by_default = socket.ReceiveBuffer();
  socket.AskForReceiveBuffer(static_cast<int>(buffers.asked));
  buffers.granted = socket.ReceiveBuffer() / 2;  // socket(7): the kernel doubles what is asked for, and tells that
  return buffers;
}

std::vector<InterfaceSeen> ReadInterfaces() {
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) return {};
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(first, &freeifaddrs);
  std::vector<InterfaceSeen> interfaces;
  for (const ifaddrs* entry = first; entry != nullptr; entry = entry->ifa_next) {
    auto interface = ToInterface(*entry);
    interface.address = io::ParseIpAddress(AddressText(entry->ifa_addr));
    if (interface.address) interface.prefix_bits = PrefixBits(entry->ifa_netmask);
    interfaces.push_back(std::move(interface));
  }
  // Each interface stands there once more for its link: that is told only where it has no address.
  std::vector<InterfaceSeen> told;
  for (const auto& interface : interfaces) {
    const bool has_address = std::ranges::any_of(interfaces, [&](const auto& other) { return other.name == interface.name && other.address; });
    if (interface.address || !has_address) told.push_back(interface);
  }
  return told;
}

}  // namespace lookout::doctor
