#include "common/io/network.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string_view>

namespace lookout::io {

namespace {

constexpr std::array<std::uint8_t, 12> kMappedPrefix{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF};  // RFC 4291, 2.5.5.2

// Numbers of the sockets that listen at a TCP port, as proc(5) tells them: local address, remote address, state, ..., inode.
std::set<std::string> ListeningSockets(int port) {
  constexpr std::string_view kListens = "0A";
  constexpr int kFieldsToInode = 5;  // queues, timer, retransmissions, user, timeout
  std::set<std::string> inodes;
  for (const char* file : {"/proc/net/tcp", "/proc/net/tcp6"}) {
    std::ifstream table(file);
    std::string line;
    std::getline(table, line);
    while (std::getline(table, line)) {
      std::istringstream fields(line);
      std::string number;
      std::string local;
      std::string remote;
      std::string state;
      fields >> number >> local >> remote >> state;
      if (state != kListens || local.size() < 4 || std::strtol(local.substr(local.size() - 4).c_str(), nullptr, 16) != port) continue;
      std::string field;
      for (int i = 0; i < kFieldsToInode; ++i) fields >> field;
      if (fields >> field) inodes.insert("socket:[" + field + "]");
    }
  }
  return inodes;
}

// "opencpn (pid 1234)"; empty where this user may not see it.
std::string HolderOf(int port) {
  namespace fs = std::filesystem;
  const auto sockets = ListeningSockets(port);
  if (sockets.empty()) return {};
  std::error_code error;
  for (fs::directory_iterator process("/proc", error), end; !error && process != end; process.increment(error)) {
    const auto pid = process->path().filename().string();
    if (!std::ranges::all_of(pid, [](char letter) { return letter >= '0' && letter <= '9'; })) continue;
    std::error_code no_right;
    for (fs::directory_iterator file(process->path() / "fd", no_right), last; !no_right && file != last; file.increment(no_right)) {
      std::error_code gone;
      if (!sockets.contains(fs::read_symlink(file->path(), gone).string())) continue;
      std::string name;
      std::getline(std::ifstream(process->path() / "comm"), name);
      return name.append(" (pid ").append(pid).append(")");
    }
  }
  return {};
}

}  // namespace

bool IpAddress::is_ipv4() const { return std::equal(kMappedPrefix.begin(), kMappedPrefix.end(), bytes.begin()); }

bool IpAddress::is_multicast() const {
  constexpr int kHighNibble = 0xF0;
  constexpr int kIpv4Multicast = 0xE0;  // RFC 5771: 224.0.0.0/4
  constexpr int kIpv6Multicast = 0xFF;  // RFC 4291: ff00::/8
  return is_ipv4() ? (bytes[kMappedPrefix.size()] & kHighNibble) == kIpv4Multicast : bytes[0] == kIpv6Multicast;
}

bool IpAddress::is_any() const {
  const auto begin = is_ipv4() ? bytes.begin() + kMappedPrefix.size() : bytes.begin();
  return std::all_of(begin, bytes.end(), [](std::uint8_t byte) { return byte == 0; });
}

std::optional<IpAddress> ParseIpAddress(const std::string& text) {
  IpAddress address;
  if (inet_pton(AF_INET6, text.c_str(), address.bytes.data()) == 1) return address;
  std::ranges::copy(kMappedPrefix, address.bytes.begin());
  if (inet_pton(AF_INET, text.c_str(), address.bytes.data() + kMappedPrefix.size()) == 1) return address;
  return std::nullopt;
}

std::string ToText(const IpAddress& address) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  const bool is_ipv4 = address.is_ipv4();
  const auto* bytes = address.bytes.data() + (is_ipv4 ? kMappedPrefix.size() : 0);
  return inet_ntop(is_ipv4 ? AF_INET : AF_INET6, bytes, text.data(), text.size()) != nullptr ? text.data() : "";
}

bool ReachesThisComputer(const std::string& text) {
  const auto address = ParseIpAddress(text);
  if (!address) return false;
  constexpr int kIpv4Loopback = 127;  // RFC 1122: 127.0.0.0/8
  const bool is_loopback = address->is_ipv4() ? address->bytes[kMappedPrefix.size()] == kIpv4Loopback : text == "::1";
  if (is_loopback || address->is_multicast() || address->is_any() || text.ends_with(".255")) return true;
  const auto is_it = [&address](const sockaddr* other) {
    if (other == nullptr) return false;
    std::array<char, INET6_ADDRSTRLEN> name{};
    const bool is_ipv4 = other->sa_family == AF_INET;
    if (!is_ipv4 && other->sa_family != AF_INET6) return false;
    const void* bytes = is_ipv4 ? static_cast<const void*>(&reinterpret_cast<const sockaddr_in*>(other)->sin_addr)
                                : static_cast<const void*>(&reinterpret_cast<const sockaddr_in6*>(other)->sin6_addr);
    return inet_ntop(other->sa_family, bytes, name.data(), name.size()) != nullptr && ParseIpAddress(name.data()) == address;
  };
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return false;
  bool reaches = false;
  for (const auto* item = list; item != nullptr; item = item->ifa_next) {
    reaches |= is_it(item->ifa_addr) || ((item->ifa_flags & IFF_BROADCAST) != 0 && is_it(item->ifa_broadaddr));
  }
  freeifaddrs(list);
  return reaches;
}

std::vector<IpAddress> OwnAddresses() {
  std::vector<IpAddress> addresses;
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return addresses;
  for (const auto* item = list; item != nullptr; item = item->ifa_next) {
    if (item->ifa_addr == nullptr || (item->ifa_flags & IFF_UP) == 0) continue;
    std::array<char, INET6_ADDRSTRLEN> text{};
    if (item->ifa_addr->sa_family == AF_INET) {
      inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(item->ifa_addr)->sin_addr, text.data(), text.size());
    } else if (item->ifa_addr->sa_family == AF_INET6) {
      inet_ntop(AF_INET6, &reinterpret_cast<const sockaddr_in6*>(item->ifa_addr)->sin6_addr, text.data(), text.size());
    }
    const auto address = ParseIpAddress(text.data());
    if (address && std::ranges::find(addresses, *address) == addresses.end()) addresses.push_back(*address);
  }
  freeifaddrs(list);
  return addresses;
}

bool IsLoopback(const IpAddress& address) {
  constexpr int kLoopbackNet = 127;
  if (address.is_ipv4()) return address.bytes[kMappedPrefix.size()] == kLoopbackNet;
  return address == ParseIpAddress("::1");
}

bool IsInterfaceUp(const std::string& interface) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return false;
  ifreq request{};
  interface.copy(request.ifr_name, IFNAMSIZ - 1);
  const bool is_up = ioctl(descriptor, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) != 0;
  close(descriptor);
  return is_up;
}

std::string NoInterfaceText(const std::string& interface) {
  std::string names;
  struct if_nameindex* const list = if_nameindex();
  for (auto* item = list; item != nullptr && item->if_index != 0; ++item) {
    names += names.empty() ? "" : ", ";
    names += item->if_name;
  }
  if (list != nullptr) if_freenameindex(list);
  return "there is no interface '" + interface + "' now (there are: " + names +
         "). When it comes late at boot, start after it; systemd: After=sys-subsystem-net-devices-" + interface + ".device";
}

std::string CannotListenText(int error, int port) {
  if (error == EADDRINUSE) {
    const auto holder = HolderOf(port);
    return "the port is taken by " + (holder.empty() ? "another program (ss -ltnp names it)" : holder) + ": end it, or give another port";
  }
  if (error == EADDRNOTAVAIL) return "no interface of this computer has that address now (ip address): it is waited for";
  if (error == EACCES || error == EPERM) return std::string(std::strerror(error)) + ": ports below 1024 need a right; give another port";
  return std::strerror(error);
}

bool InterfaceTimer::IsDue(Utime now) {
  // A clock that was set back makes no pause longer.
  if (now >= last_ && now - last_ < std::chrono::seconds(1)) return false;
  last_ = now;
  return true;
}

}  // namespace lookout::io
