// Numeric addresses of IPv4 and IPv6, compared in binary, as one address has many texts; and network interfaces of this computer, by name ("eth0").
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/core/utime.hpp"

namespace lookout::io {

/// 16 bytes in network order; IPv4 is mapped into IPv6 (::ffff:a.b.c.d).
struct IpAddress {
  std::array<std::uint8_t, 16> bytes{};

  bool is_ipv4() const;
  bool is_multicast() const;
  bool is_any() const;  // "0.0.0.0" or "::"
  bool operator==(const IpAddress&) const = default;
};

/// @param text  "192.168.1.201", "fe80::1"; no name of a host, no zone ("%eth0")
/// @return nullopt when it is no such address
std::optional<IpAddress> ParseIpAddress(const std::string& text);

/// The one text that the system writes for it: IPv4 where it is mapped.
std::string ToText(const IpAddress& address);

/// Whether a datagram to that address comes to this computer as well: loopback, a multicast group, one of its own addresses, a network's broadcast.
///
/// @param text  numeric; anything else does not
bool ReachesThisComputer(const std::string& text);

/// Addresses of this computer's interfaces that are up, loopback among them, each once.
std::vector<IpAddress> OwnAddresses();

/// Whether the address is of this computer alone: 127.0.0.0/8 or ::1.
bool IsLoopback(const IpAddress& address);

bool IsInterfaceUp(const std::string& interface);

/// For errors: that it is not there, which ones there are, and what to do when it comes late at boot.
std::string NoInterfaceText(const std::string& interface);

/// For errors: why nobody can listen at a TCP port now, and what to do. A port that is taken: by which program, as far as this user may see.
///
/// @param error  errno of bind or listen
std::string CannotListenText(int error, int port);

/// A port that could not be had is tried again after this: its holder ends, or an interface gets its address.
inline constexpr std::chrono::seconds kListenPause{3};

/// Says when an interface is to be looked at: about once a second.
class InterfaceTimer {
 public:
  bool IsDue(Utime now);

 private:
  Utime last_{};
};

}  // namespace lookout::io
