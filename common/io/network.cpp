#include "common/io/network.hpp"

#include <arpa/inet.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>

namespace lookout::io {

namespace {

constexpr std::array<std::uint8_t, 12> kMappedPrefix{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF};  // RFC 4291, 2.5.5.2

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

bool InterfaceTimer::IsDue(Utime now) {
  // A clock that was set back makes no pause longer.
  if (now >= last_ && now - last_ < std::chrono::seconds(1)) return false;
  last_ = now;
  return true;
}

}  // namespace lookout::io
